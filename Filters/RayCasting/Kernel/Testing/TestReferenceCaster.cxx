// SPDX-License-Identifier: BSD-3-Clause
/// Beside the thesis's algorithm: never farther from the truth, and nothing missed that it finds.
#include "lacunaCTHead.h"
#include "lacunaReferenceCaster.h"
#include "lacunaTestField.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace
{
using namespace lacuna;

constexpr double Nothing = std::numeric_limits<double>::quiet_NaN();

struct Tally
{
  int Both = 0;
  int OnlyOurs = 0;
  double Ours = 0;   ///< worst distance from the truth, voxels
  double Theirs = 0; ///< worst

  /// Distances along a ray, NaN where there is no hit.
  void Add(double truth, double ours, double theirs, double voxel)
  {
    if (std::isnan(theirs))
    {
      this->OnlyOurs += !std::isnan(ours);
      return;
    }
    ++this->Both;
    ASSERT_FALSE(std::isnan(ours)) << "missed what the thesis's algorithm finds at " << theirs;
    const double ourError = std::abs(ours - truth) / voxel;
    const double theirError = std::abs(theirs - truth) / voxel;
    ASSERT_LE(ourError, theirError + 1e-9) << "truth " << truth;
    this->Ours = std::max(this->Ours, ourError);
    this->Theirs = std::max(this->Theirs, theirError);
  }
};

double CastOurs(
  const IsoRayCaster& caster, const Vec3& origin, const Vec3& direction, double isoValue)
{
  RayHit hit;
  return caster.CastRay(origin, direction, isoValue, hit) ? hit.Distance : Nothing;
}
}

TEST(ReferenceCaster, ExactSpheres)
{
  // samples of -r^2 give the cubic field -r^2 - (a^2 + b^2 + c^2) / 3 for voxels of a x b x c
  std::mt19937 random(31);
  ThreadExecution execution(1);
  const Vec3 spacings[] = { { 1, 1, 1 }, { 1, 2, 1 }, { 1, 1, 3 }, { 2, 1, 1 } };
  const std::array<int, 3> size{ 30, 28, 26 };
  for (int trial = 0; trial < 8; ++trial)
  {
    const Vec3& spacing = spacings[trial % 4];
    const Matrix4 frame = RandomFrame(random, spacing, trial >= 4);
    const Vec3 middle{ 14, 13, 13 };
    std::vector<std::int16_t> voxels;
    for (int k = 0; k < size[2]; ++k)
    {
      for (int j = 0; j < size[1]; ++j)
      {
        for (int i = 0; i < size[0]; ++i)
        {
          const Vec3 p{ spacing[0] * (i - middle[0]), spacing[1] * (j - middle[1]),
            spacing[2] * (k - middle[2]) };
          voxels.push_back(static_cast<std::int16_t>(-Dot(p, p)));
        }
      }
    }
    VoxelVolume volume;
    volume.Voxels = voxels.data();
    volume.Type = ScalarType::Int16;
    volume.Size = size;
    volume.IndexToWorld = frame;
    const IsoRayCaster caster(volume, FieldInterpolation::BSpline, SolidSide::Above, execution);
    const ReferenceCaster reference(volume);
    const Vec3 centre = frame.Point(middle);
    Tally tally;
    for (int ray = 0; ray < 3000; ++ray)
    {
      const double radius = 0.1 * (30 + ray % 70); // mm, in the volume, away from its border
      const double isoValue = -radius * radius - Dot(spacing, spacing) / 3;
      const Vec3 direction = RandomUnit(random);
      const Vec3 aside = Cross(direction, RandomUnit(random));
      const Vec3 origin = centre + radius * aside - 80 * direction;
      const double truth = 80 - radius * std::sqrt(1 - Dot(aside, aside));
      Vec3 normal{ 0, 0, 0 };
      tally.Add(truth, CastOurs(caster, origin, direction, isoValue),
        reference.Distance(origin, direction, isoValue, normal), 1);
      ASSERT_FALSE(HasFatalFailure()) << "trial " << trial << " ray " << ray;
    }
    EXPECT_GT(tally.Both, 2900);
    EXPECT_LT(tally.Ours, 1e-9);
    EXPECT_GT(tally.Theirs, 1e-4) << "the thesis's algorithm interpolates linearly";
    RecordProperty("MissedByTheThesis" + std::to_string(trial), tally.OnlyOurs);
  }
}

TEST(ReferenceCaster, CTHead)
{
  if (Head().Voxels.empty())
  {
    GTEST_SKIP() << "no ct_head/head.mha in LACUNA_TEST_DATA";
  }
  // in air, so that no bone reaches the border, of which the two know different rules
  const std::array<int, 3>& size = Head().Volume.Size;
  const int margin = 3;
  TestField field({ 2, 2, 2 }, Head().Volume.IndexToWorld, [](const Vec3&) { return 0; });
  field.Size = { size[0] + 2 * margin, size[1] + 2 * margin, size[2] + 2 * margin };
  std::vector<std::int16_t> voxels(
    static_cast<std::size_t>(field.Size[0]) * field.Size[1] * field.Size[2], -1000);
  for (int k = 0; k < size[2]; ++k)
  {
    for (int j = 0; j < size[1]; ++j)
    {
      const auto* row =
        Head().Voxels.data() + static_cast<std::size_t>(size[0]) * (j + size[1] * k);
      std::copy_n(row, size[0],
        voxels.begin() + margin +
          static_cast<std::ptrdiff_t>(field.Size[0]) *
            (j + margin + static_cast<std::ptrdiff_t>(field.Size[1]) * (k + margin)));
    }
  }
  field.Voxels.assign(voxels.begin(), voxels.end());
  VoxelVolume volume = Head().Volume;
  volume.Voxels = voxels.data();
  volume.Size = field.Size;

  ThreadExecution execution(2);
  const IsoRayCaster caster(volume, FieldInterpolation::BSpline, SolidSide::Above, execution);
  const ReferenceCaster reference(volume);
  const Matrix4 worldToIndex = volume.IndexToWorld.Inverse();
  const double isoValue = 500;
  const double voxel = SmallestEdgeOf(volume.IndexToWorld);
  const double step = voxel / 16;
  std::mt19937 random(32);
  std::uniform_real_distribution<double> uniform(0.15, 0.85);
  Tally tally;
  int hits = 0;
  int earlier = 0; // our hits between the samples of the scan
  for (int ray = 0; ray < 1500; ++ray)
  {
    const Vec3 through = volume.IndexToWorld.Point({ uniform(random) * field.Size[0],
      uniform(random) * field.Size[1], uniform(random) * field.Size[2] });
    const Vec3 direction = RandomUnit(random);
    const Vec3 a = worldToIndex.Point(through);
    const Vec3 b = worldToIndex.Vector(direction);
    double first = -1e9;
    double last = 1e9;
    for (int i = 0; i < 3; ++i)
    {
      const double u = -a[i] / b[i];
      const double v = (field.Size[i] - 1 - a[i]) / b[i];
      first = std::max(first, std::min(u, v));
      last = std::min(last, std::max(u, v));
    }
    const auto isSolid = [&](double t) { return field.BSpline(a + t * b) >= isoValue; };
    const auto bisect = [&](double outside, double solid)
    {
      for (int i = 0; i < 50; ++i)
      {
        const double t = 0.5 * (outside + solid);
        (isSolid(t) ? solid : outside) = t;
      }
      return solid;
    };
    const double ours = CastOurs(caster, through, direction, isoValue);
    Vec3 normal{ 0, 0, 0 };
    const double theirs = reference.Distance(through, direction, isoValue, normal);
    // the first crossing that a fine scan sees, up to where ours should have been
    double truth = Nothing;
    const double end = std::isnan(ours) ? last : std::min(last, ours + 2 * step);
    for (double t = first; t < end && std::isnan(truth); t += step)
    {
      if (isSolid(t + step))
      {
        truth = bisect(t, t + step);
      }
    }
    if (!std::isnan(ours))
    {
      ++hits;
      ASSERT_FALSE(isSolid(ours - 1e-6 * voxel)) << "an entry, ray " << ray;
      if (std::isnan(truth) || ours < truth - 1e-6 * voxel)
      {
        // a wall or a part of one that lies between samples
        double inside = ours;
        for (double ahead = 1e-12; !isSolid(inside) && ahead < 1e-6; ahead *= 2)
        {
          inside = ours + ahead * voxel;
        }
        ASSERT_TRUE(isSolid(inside)) << "a crossing, ray " << ray;
        truth = bisect(ours - 1e-6 * voxel, inside);
        ++earlier;
      }
    }
    else
    {
      ASSERT_TRUE(std::isnan(truth)) << "missed at " << truth << ", ray " << ray;
    }
    tally.Add(truth, ours, theirs, voxel);
    ASSERT_FALSE(HasFatalFailure()) << "ray " << ray;
  }
  EXPECT_GT(tally.Both, 700);
  EXPECT_LT(tally.Ours, 1e-9);
  EXPECT_GT(tally.Theirs, 1e-3);
  EXPECT_LT(earlier, hits / 20) << "the scan is fine enough";
  RecordProperty("MissedByTheThesis", tally.OnlyOurs);
  std::printf("hits %d, missed by the thesis's algorithm %d, worst %.1e and %.1e voxel, between "
              "samples %d\n",
    hits, tally.OnlyOurs, tally.Ours, tally.Theirs, earlier);
}
