// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaIncompleteShape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace lacuna
{
namespace
{
using Parameters = IncompleteShape::Parameters;

std::vector<unsigned char> Sample(const Parameters& parameters, int threads = 1)
{
  ThreadExecution execution(threads);
  return IncompleteShape(parameters).Sample(execution);
}

int Count(const std::vector<unsigned char>& voxels)
{
  return std::accumulate(voxels.begin(), voxels.end(), 0);
}

Parameters Make(IncompleteShape::Kind kind, int n)
{
  Parameters p;
  p.Shape = kind;
  p.Dimensions = { n, n, n };
  return p;
}
}

TEST(IncompleteShape, CubeHasTheFacesOfThe20Cube)
{
  // 44 = 20 + 2 * 12 voxels
  EXPECT_EQ(Count(Sample(Make(IncompleteShape::Cube, 44))), 20 * 20 * 20 - 18 * 18 * 18);
}

TEST(IncompleteShape, FractionsAreExact)
{
  Parameters p = Make(IncompleteShape::Sphere, 60);
  const int all = Count(Sample(p));
  p.PresentFraction = 0.1;
  EXPECT_EQ(Count(Sample(p)), std::llround(0.1 * all));
  p.Patches = true;
  p.PresentFraction = 0.4;
  const int patches = Count(Sample(p));
  EXPECT_LE(patches, 0.4 * all + 1);
  EXPECT_GT(patches, 0.3 * all);
  p.PatchRadii = { 1, 2 };
  EXPECT_NEAR(Count(Sample(p)), 0.4 * all, 20); // smaller ones come closer to the fraction
  for (const std::array<double, 2>& bad : { std::array<double, 2>{ -1, 2 }, { 3, 2 } })
  {
    p.PatchRadii = bad;
    EXPECT_THROW(IncompleteShape{ p }, std::invalid_argument);
  }
  p.PatchRadii = { 0, 0.9 }; // single voxels
  p.PresentFraction = 1e-9;
  EXPECT_EQ(Count(Sample(p)), 0);
  p.PresentFraction = 0.4;
  EXPECT_EQ(Count(Sample(p)), std::llround(0.4 * all));
  p.PatchRadii = { 3, 8 };
  std::vector<double> reports;
  lacuna::ThreadExecution stopped(1,
    [&](double fraction)
    {
      reports.push_back(fraction);
      return fraction < 0.5;
    });
  EXPECT_THROW(IncompleteShape(p).Sample(stopped), lacuna::Aborted);
  EXPECT_TRUE(std::is_sorted(reports.begin(), reports.end()));
  p.Patches = false;
  const int clean = Count(Sample(p));
  p.TissueFraction = 0.1;
  EXPECT_NEAR(Count(Sample(p)) - clean, 0.1 * 4.18879 * 17 * 17 * 17, 150); // radius 17.5
  p.TissueFraction = 1.5;
  EXPECT_THROW(IncompleteShape{ p }, std::invalid_argument);
  p.TissueFraction = 0;
  p.OutlierFraction = 0.2;
  EXPECT_NEAR(Count(Sample(p)), 1.2 * clean, 0.02 * clean);
}

TEST(IncompleteShape, GapIsAboutTheXAxis)
{
  Parameters p = Make(IncompleteShape::Circle, 200);
  const double all = Count(Sample(p));
  p.GapAngle = 40;
  const auto voxels = Sample(p);
  EXPECT_NEAR(Count(voxels) / all, 320.0 / 360, 0.01);
  for (int i = 150; i < 200; ++i)
  {
    EXPECT_EQ(voxels[100 * 200 + i], 0);
  }
  EXPECT_EQ(voxels[100 * 200 + 12], 1);
}

TEST(IncompleteShape, DoesNotDependOnThreads)
{
  Parameters p = Make(IncompleteShape::Kumara, 90);
  p.PresentFraction = 0.4;
  p.OutlierFraction = 0.02;
  EXPECT_EQ(Sample(p, 1), Sample(p, 5));
  Parameters other = p;
  other.Seed = 1;
  EXPECT_NE(Sample(p), Sample(other));
}

// Along a gradient the distance grows as fast as the point moves.
TEST(IncompleteShape, DistancesAreDistancesNearTheShape)
{
  for (auto kind : { IncompleteShape::Blob, IncompleteShape::Kumara, IncompleteShape::Cavity })
  {
    const IncompleteShape shape(Make(kind, 124));
    int near = 0;
    for (int s = 0; s < 4000; ++s)
    {
      const double x = std::fmod(s * 17.37, 100) - 50;
      const double y = std::fmod(s * 5.91, 80) - 40;
      const double z = shape.IsFlat() ? 0 : std::fmod(s * 3.13, 50) - 25;
      const double d = shape.GetDistance(x, y, z);
      if (std::abs(d) < 0.5)
      {
        const double e = 1e-4;
        const double gx =
          (shape.GetDistance(x + e, y, z) - shape.GetDistance(x - e, y, z)) / (2 * e);
        const double gy =
          (shape.GetDistance(x, y + e, z) - shape.GetDistance(x, y - e, z)) / (2 * e);
        const double gz = shape.IsFlat()
          ? 0
          : (shape.GetDistance(x, y, z + e) - shape.GetDistance(x, y, z - e)) / (2 * e);
        EXPECT_NEAR(std::sqrt(gx * gx + gy * gy + gz * gz), 1, 0.08);
        ++near;
      }
    }
    EXPECT_GT(near, 5);
  }
}

TEST(IncompleteShape, Content)
{
  EXPECT_NEAR(IncompleteShape(Make(IncompleteShape::Cube, 44)).GetContent(), 19 * 19 * 19, 1e-9);
  // the kumara: its cross-sections are ellipses of known area, bending does not change them
  Parameters p = Make(IncompleteShape::Kumara, 105);
  p.Dimensions = { 105, 90, 60 };
  const IncompleteShape kumara(p);
  const double a = 40;
  double volume = 0;
  for (double u = -0.9995; u < 1; u += 0.001)
  {
    const double taper = 1 - 0.25 * u;
    volume += 0.001 * a * M_PI * (0.35 * a * taper) * (0.30 * a * taper) * (1 - u * u);
  }
  EXPECT_NEAR(kumara.GetContent() / volume, 1, 2e-3);
}

// Not symmetric: a mirrored picture shows.
TEST(IncompleteShape, BlobAndKumaraAreNotSymmetric)
{
  const IncompleteShape blob(Make(IncompleteShape::Blob, 124));
  EXPECT_GT(std::abs(blob.GetDistance(30, 10, 0) - blob.GetDistance(30, -10, 0)), 1);
  EXPECT_GT(std::abs(blob.GetDistance(30, 10, 0) - blob.GetDistance(-30, 10, 0)), 1);
  const IncompleteShape kumara(Make(IncompleteShape::Kumara, 105));
  EXPECT_GT(std::abs(kumara.GetDistance(20, 0, 0) - kumara.GetDistance(-20, 0, 0)), 0.5);
  EXPECT_GT(kumara.GetDistance(0, 8, 0), 0);
  EXPECT_LT(kumara.GetDistance(0, -8, 0), 0);
}

TEST(IncompleteShape, RefusesBadParameters)
{
  const auto refused = [](auto change)
  {
    Parameters p;
    change(p);
    EXPECT_THROW(IncompleteShape shape(p), std::invalid_argument);
  };
  refused([](Parameters& p) { p.Shape = static_cast<IncompleteShape::Kind>(6); });
  refused([](Parameters& p) { p.Dimensions = { 27, 200, 200 }; });
  refused(
    [](Parameters& p)
    {
      p.Shape = IncompleteShape::Cube;
      p.Dimensions = { 200, 200, 27 };
    });
  refused([](Parameters& p) { p.PresentFraction = 0; });
  refused([](Parameters& p) { p.PresentFraction = 1.1; });
  refused([](Parameters& p) { p.GapAngle = 360; });
  refused([](Parameters& p) { p.OutlierFraction = -1; });
  refused([](Parameters& p) { p.PresentFraction = std::nan(""); });
  Parameters curve; // has two dimensions
  curve.Dimensions = { 200, 200, 1 };
  EXPECT_EQ(IncompleteShape(curve).GetDimensions()[2], 1);
}
}
