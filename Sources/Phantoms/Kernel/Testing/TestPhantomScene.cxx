// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCounterNoise.h"
#include "lacunaPhantomScene.h"
#include "lacunaSmoothStep.h"
#include "lacunaVolumeScene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

using lacuna::Anatomy;
using lacuna::Vec3;

namespace
{
struct Box
{
  Vec3 Low;
  Vec3 High;
};

// What the default sweep covers, and a box around the kumara.
constexpr Box SweptBox{ { { -32, -24, -25 } }, { { 32, 24, 25 } } };
constexpr Box KumaraBox{ { { -60, -60, -110 } }, { { 60, 60, 110 } } };

// Values at the cell centres of a regular division of the box; returns the volume of a cell.
double ForEachCell(const lacuna::PhantomScene& scene, const Box& box, double h,
  const std::function<void(const Vec3&, double)>& body)
{
  int n[3];
  for (int i = 0; i < 3; ++i)
  {
    n[i] = static_cast<int>(std::lround((box.High[i] - box.Low[i]) / h));
  }
  std::vector<double> row(n[0]);
  for (int k = 0; k < n[2]; ++k)
  {
    for (int j = 0; j < n[1]; ++j)
    {
      const Vec3 start = box.Low + Vec3{ 0.5 * h, (j + 0.5) * h, (k + 0.5) * h };
      scene.SampleRow(start, { h, 0, 0 }, 0, n[0], row.data());
      for (int i = 0; i < n[0]; ++i)
      {
        body(start + Vec3{ i * h, 0, 0 }, row[i]);
      }
    }
  }
  return h * h * h;
}

// The box of the cells whose value is chosen.
Box BoundsOf(const lacuna::PhantomScene& scene, const Box& within, double h,
  const std::function<bool(double)>& chosen)
{
  Box box{ { { 1e9, 1e9, 1e9 } }, { { -1e9, -1e9, -1e9 } } };
  ForEachCell(scene, within, h,
    [&](const Vec3& p, double v)
    {
      if (chosen(v))
      {
        for (int i = 0; i < 3; ++i)
        {
          box.Low[i] = std::min(box.Low[i], p[i] - 0.5 * h);
          box.High[i] = std::max(box.High[i], p[i] + 0.5 * h);
        }
      }
    });
  return box;
}

Vec3 RandomPoint(const lacuna::CounterNoise& noise, const Box& box, int i)
{
  Vec3 p;
  for (int a = 0; a < 3; ++a)
  {
    p[a] = box.Low[a] + (box.High[a] - box.Low[a]) * noise.Uniform(3 * i + a);
  }
  return p;
}

const Box& BoxOf(Anatomy anatomy)
{
  return anatomy == Anatomy::Kumara ? KumaraBox : SweptBox;
}
}

TEST(SmoothStep, IsTheStatedQuintic)
{
  EXPECT_EQ(lacuna::SmoothStep(-0.75, 1.5), 0);
  EXPECT_EQ(lacuna::SmoothStep(0.75, 1.5), 1);
  EXPECT_EQ(lacuna::SmoothStep(0, 1.5), 0.5);
  EXPECT_EQ(lacuna::SmoothStep(std::nan(""), 1), 0);
  constexpr double H = 1e-4;
  double mean = 0;
  double variance = 0;
  for (double x = -1; x < 1; x += H)
  {
    const double density = (lacuna::SmoothStep(x + H, 2) - lacuna::SmoothStep(x, 2)) / H;
    EXPECT_GE(density, -1e-12);
    EXPECT_LE(density, 1.875 / 2 + 1e-6);
    mean += density * (x + 0.5 * H) * H;
    variance += density * (x + 0.5 * H) * (x + 0.5 * H) * H;
    EXPECT_NEAR(lacuna::SmoothStep(x, 2) + lacuna::SmoothStep(-x, 2), 1, 1e-14);
  }
  EXPECT_NEAR(mean, 0, 1e-8);
  EXPECT_NEAR(variance, 4.0 / 28, 1e-7);
}

// Grids of exact cells: the volume of the part above the iso-value, by an edge profile that is
// steeper than the grid is fine but smooth enough to integrate.
TEST(PhantomScene, ClosedFormVolumesAgreeWithIntegration)
{
  for (const Anatomy anatomy : { Anatomy::Ellipsoids, Anatomy::Kumara })
  {
    const auto scene = lacuna::MakePhantomScene(anatomy, 1.5);
    const bool small = anatomy == Anatomy::Ellipsoids;
    std::int64_t above = 0;
    const double cell = ForEachCell(*scene, BoxOf(anatomy), small ? 0.25 : 0.8,
      [&](const Vec3&, double v) { above += v > scene->IsoValue(); });
    // Counting cell centres converges faster than the surface times the cell edge.
    EXPECT_NEAR(above * cell / scene->TrueVolume(), 1, 2e-4);
  }
}

TEST(PhantomScene, LevelsAndSizesAreAsDocumented)
{
  struct Case
  {
    Anatomy Kind;
    double Lowest;
    double Highest;
  };
  for (const Case c : { Case{ Anatomy::Ellipsoids, 20, 240 }, Case{ Anatomy::Kumara, 20, 200 },
         Case{ Anatomy::Vessels, 25, 150 }, Case{ Anatomy::Linear, 20, 240 } })
  {
    for (const double width : { 0.5, 1.5, lacuna::MaximumEdgeWidth })
    {
      const auto scene = lacuna::MakePhantomScene(c.Kind, width);
      double low = 1e9;
      double high = -1e9;
      ForEachCell(*scene, BoxOf(c.Kind), c.Kind == Anatomy::Kumara ? 2 : 1,
        [&](const Vec3&, double v)
        {
          low = std::min(low, v);
          high = std::max(high, v);
        });
      EXPECT_GE(low, c.Lowest - 1e-12);
      EXPECT_LE(high, c.Highest + 1e-12);
      if (c.Kind != Anatomy::Linear)
      {
        EXPECT_NEAR(low, c.Lowest, 1e-9);
        EXPECT_NEAR(high, c.Highest, 1e-9);
      }
    }
  }
  // The kumara's box: 190 x 80 x 90 mm, about the origin.
  const auto kumara = lacuna::MakePhantomScene(Anatomy::Kumara, 1.5);
  const Box box = BoundsOf(*kumara, KumaraBox, 1, [&](double v) { return v > kumara->IsoValue(); });
  const double size[3] = { 80, 90, 190 };
  for (int i = 0; i < 3; ++i)
  {
    EXPECT_NEAR(box.High[i] - box.Low[i], size[i], 1) << i;
    EXPECT_NEAR(box.High[i] + box.Low[i], 0, 3) << i;
  }
}

// The object of interest is a closed surface inside of what two crossed default sweeps see.
TEST(PhantomScene, ObjectsLieInsideOfTheDefaultSweep)
{
  for (const Anatomy anatomy : { Anatomy::Ellipsoids, Anatomy::Vessels })
  {
    const auto scene = lacuna::MakePhantomScene(anatomy, 1.5);
    const double iso = scene->IsoValue();
    const bool bright = anatomy == Anatomy::Ellipsoids;
    const Box box =
      BoundsOf(*scene, SweptBox, 0.25, [&](double v) { return bright ? v > iso : v < iso; });
    for (int i = 0; i < 3; ++i)
    {
      // Reaches far enough to fill the sweep and leaves 2 mm free all round.
      EXPECT_LT(box.High[i], i == 1 ? 22 : 23) << i;
      EXPECT_GT(box.Low[i], i == 1 ? -22 : -23) << i;
      EXPECT_GT(box.High[i] - box.Low[i], 24) << i;
    }
  }
}

// The vessels are one tree: everything dark is reached from the trunk through dark neighbours.
TEST(PhantomScene, VesselsAreConnected)
{
  const auto scene = lacuna::MakePhantomScene(Anatomy::Vessels, 1.5);
  constexpr double H = 0.5;
  const int n[3] = { 128, 96, 100 };
  std::vector<char> dark;
  ForEachCell(
    *scene, SweptBox, H, [&](const Vec3&, double v) { dark.push_back(v < scene->IsoValue()); });
  const auto total = std::count(dark.begin(), dark.end(), 1);
  std::vector<std::int64_t> stack{ std::find(dark.begin(), dark.end(), 1) - dark.begin() };
  std::int64_t reached = 0;
  const std::int64_t steps[3] = { 1, n[0], static_cast<std::int64_t>(n[0]) * n[1] };
  dark[stack[0]] = 0;
  while (!stack.empty())
  {
    const std::int64_t at = stack.back();
    stack.pop_back();
    ++reached;
    for (const std::int64_t step : steps)
    {
      for (const std::int64_t next : { at - step, at + step })
      {
        if (next >= 0 && next < static_cast<std::int64_t>(dark.size()) && dark[next])
        {
          dark[next] = 0;
          stack.push_back(next);
        }
      }
    }
  }
  EXPECT_EQ(reached, total);
}

// Wider edges leave the iso-surface where it is, along rays through it.
TEST(PhantomScene, EdgeWidthDoesNotMoveSurfaces)
{
  const lacuna::CounterNoise noise(8, 0);
  for (const Anatomy anatomy : { Anatomy::Ellipsoids, Anatomy::Kumara, Anatomy::Vessels })
  {
    const auto sharp = lacuna::MakePhantomScene(anatomy, 0.01);
    const auto soft = lacuna::MakePhantomScene(anatomy, lacuna::MaximumEdgeWidth);
    int inside = 0;
    for (int i = 0; i < 100000; ++i)
    {
      const Vec3 p = RandomPoint(noise, BoxOf(anatomy), i);
      const double iso = sharp->IsoValue();
      ASSERT_EQ(sharp->Value(p) > iso, soft->Value(p) > iso);
      inside += (sharp->Value(p) > iso) == (anatomy != Anatomy::Vessels);
    }
    EXPECT_GT(inside, 1000);
  }
}

TEST(PhantomScene, IsNotItsOwnMirrorImage)
{
  for (const Anatomy anatomy :
    { Anatomy::Ellipsoids, Anatomy::Kumara, Anatomy::Vessels, Anatomy::Linear })
  {
    const auto scene = lacuna::MakePhantomScene(anatomy, 1.5);
    const lacuna::CounterNoise noise(11, 0);
    for (int axis = 0; axis < 3; ++axis)
    {
      int differing = 0;
      for (int i = 0; i < 20000; ++i)
      {
        const Vec3 p = RandomPoint(noise, BoxOf(anatomy), i);
        Vec3 mirrored = p;
        mirrored[axis] = -p[axis];
        differing += std::abs(scene->Value(p) - scene->Value(mirrored)) > 20;
      }
      EXPECT_GT(differing, 200) << static_cast<int>(anatomy) << " axis " << axis;
    }
  }
}

// Rows skip what is far away: that must change nothing, not even the last bit.
TEST(PhantomScene, RowsEqualPoints)
{
  const lacuna::CounterNoise noise(5, 0);
  for (const Anatomy anatomy :
    { Anatomy::Ellipsoids, Anatomy::Kumara, Anatomy::Vessels, Anatomy::Linear })
  {
    const auto scene = lacuna::MakePhantomScene(anatomy, 1.5);
    for (int r = 0; r < 300; ++r)
    {
      const Vec3 start = RandomPoint(noise, BoxOf(anatomy), 2 * r);
      const Vec3 end = RandomPoint(noise, BoxOf(anatomy), 2 * r + 1);
      constexpr int N = 101;
      const Vec3 step = (1.0 / N) * (end - start);
      std::vector<double> row(N);
      scene->SampleRow(start, step, -20, N, row.data());
      for (int i = 0; i < N; ++i)
      {
        ASSERT_EQ(row[i], scene->Value(start + static_cast<double>(i - 20) * step));
      }
    }
  }
}

// No jumps, and no kinks but the creases of the vessels: second differences stay below what the
// edge profile allows.
TEST(PhantomScene, IsSmooth)
{
  const lacuna::CounterNoise noise(6, 0);
  for (const Anatomy anatomy : { Anatomy::Ellipsoids, Anatomy::Kumara, Anatomy::Vessels })
  {
    const auto scene = lacuna::MakePhantomScene(anatomy, 1.5);
    for (int i = 0; i < 40000; ++i)
    {
      const Vec3 p = RandomPoint(noise, BoxOf(anatomy), i);
      constexpr double H = 0.01;
      for (int a = 0; a < 3; ++a)
      {
        Vec3 e{ 0, 0, 0 };
        e[a] = H;
        const double before = scene->Value(p - e);
        const double here = scene->Value(p);
        const double after = scene->Value(p + e);
        // |S'| <= 1.875/w and |S''| <= 5.78/w^2 for each edge of up to 180 levels; curvature of the
        // surfaces and crossing edges stay within a factor of two of that.
        ASSERT_LT(std::abs(after - here), 2 * 180 * 1.875 / 1.5 * H);
        if (anatomy != Anatomy::Vessels) // creases where tubes meet
        {
          ASSERT_LT(std::abs(after - 2 * here + before), 2 * 180 * 5.78 / (1.5 * 1.5) * H * H);
        }
      }
    }
  }
}

TEST(PhantomScene, LinearIsExact)
{
  const auto scene = lacuna::MakePhantomScene(Anatomy::Linear, 1);
  EXPECT_EQ(scene->Value({ 4, -2, 8 }), 130 + 5 - 3 - 8);
  EXPECT_TRUE(std::isnan(scene->IsoValue()));
  EXPECT_TRUE(std::isnan(scene->TrueVolume()));
}

TEST(PhantomScene, RefusesBadParameters)
{
  for (const double width : { 0.0, -1.0, 4.01, 1e300, std::nan("") })
  {
    EXPECT_THROW(lacuna::MakePhantomScene(Anatomy::Vessels, width), std::invalid_argument);
  }
  EXPECT_THROW(lacuna::MakePhantomScene(static_cast<Anatomy>(17), 1), std::invalid_argument);
}

TEST(VolumeScene, InterpolatesAndIsZeroOutside)
{
  // A linear field on a tilted, shifted grid with two components: the first one counts.
  const std::array<int, 3> n{ 5, 4, 3 };
  std::vector<float> voxels;
  const auto field = [](double i, double j, double k) { return 3 + 2 * i - j + 5 * k; };
  for (int k = 0; k < n[2]; ++k)
  {
    for (int j = 0; j < n[1]; ++j)
    {
      for (int i = 0; i < n[0]; ++i)
      {
        voxels.push_back(static_cast<float>(field(i, j, k)));
        voxels.push_back(-1000);
      }
    }
  }
  const lacuna::Matrix4 toReference = lacuna::Matrix4::Translation({ 7, -3, 2 }) *
    lacuna::Matrix4::Rotation({ 1, 2, 3 }, 0.7) * lacuna::Matrix4::Scaling({ 0.5, 2, 1.5 });
  const lacuna::VolumeScene<float> scene(voxels.data(), n, 2, toReference.Inverse());
  const lacuna::CounterNoise noise(3, 0);
  for (int i = 0; i < 1000; ++i)
  {
    const Vec3 p = RandomPoint(noise, { { -1, -1, -1 }, { 5, 4, 3 } }, i);
    const bool inside = p[0] >= 0 && p[0] <= 4 && p[1] >= 0 && p[1] <= 3 && p[2] >= 0 && p[2] <= 2;
    EXPECT_NEAR(scene.Value(toReference.Point(p)), inside ? field(p[0], p[1], p[2]) : 0, 1e-12);
  }
  for (const Vec3& corner : { Vec3{ 0, 0, 0 }, Vec3{ 4, 3, 2 }, Vec3{ 4, 0, 2 } })
  {
    EXPECT_NEAR(
      scene.Value(toReference.Point(corner)), field(corner[0], corner[1], corner[2]), 1e-6);
  }
  // One voxel thin: exists in its plane only.
  const std::array<int, 3> flat{ 5, 4, 1 };
  const lacuna::VolumeScene<float> plane(voxels.data(), flat, 2, lacuna::Matrix4());
  EXPECT_NEAR(plane.Value({ 1.5, 2, 0 }), field(1.5, 2, 0), 1e-12);
  EXPECT_EQ(plane.Value({ 1.5, 2, 0.01 }), 0);
  EXPECT_EQ(plane.Value({ std::nan(""), 2, 0 }), 0);
  EXPECT_EQ(plane.Value({ 1e300, 2, 0 }), 0);
}
