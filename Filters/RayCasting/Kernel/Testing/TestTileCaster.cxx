// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaIsoField.h"
#include "lacunaTestField.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <vector>

namespace
{
using namespace lacuna;

/// A camera at an eye, or a parallel projection, in index coordinates.
struct Camera
{
  RayGrid Rays;
  Matrix4 IndexToPixel;
};

Camera MakeCamera(std::mt19937& random, bool parallel, bool axial)
{
  std::uniform_real_distribution<double> uniform(-1, 1);
  Vec3 view = RandomUnit(random);
  if (axial)
  {
    view = { 0, 0, 0 };
    view[static_cast<int>(random() % 3)] = random() % 2 ? 1 : -1;
  }
  const Vec3 right = Normalized(Cross(view, RandomUnit(random)));
  const Vec3 down = Cross(view, right);
  const Vec3 origin{ 20 + 30 * uniform(random), 20 + 30 * uniform(random),
    20 + 30 * uniform(random) };
  const double pixel = parallel ? 0.7 : 0.02;
  Camera camera;
  camera.Rays.Parallel = parallel;
  const Vec3 zero{ 0, 0, 0 };
  if (parallel)
  {
    camera.Rays.First = { origin, view };
    camera.Rays.PerColumn = { pixel * right, zero };
    camera.Rays.PerRow = { pixel * down, zero };
  }
  else
  {
    // 0.5 off to both sides: pixels around the middle of the view
    camera.Rays.First = { origin, view - 0.5 * right - 0.5 * down };
    camera.Rays.PerColumn = { zero, pixel * right };
    camera.Rays.PerRow = { zero, pixel * down };
  }
  const double scale = 1 / pixel;
  const double shift = parallel ? 0 : 0.5 / pixel;
  const Vec3 rows[3] = { scale * right + shift * view, scale * down + shift * view, view };
  for (int r = 0; r < 3; ++r)
  {
    for (int a = 0; a < 3; ++a)
    {
      camera.IndexToPixel(r, a) = parallel && r < 2 ? (scale * (r ? down : right))[a] : rows[r][a];
    }
    const Vec3 row{ camera.IndexToPixel(r, 0), camera.IndexToPixel(r, 1),
      camera.IndexToPixel(r, 2) };
    camera.IndexToPixel(r, 3) = -Dot(row, origin);
  }
  return camera;
}
}

TEST(BlockProjection, EveryRayThroughABlockIsInItsBox)
{
  std::mt19937 random(5);
  std::uniform_int_distribution<int> pixel(0, 63);
  int met = 0;
  for (int trial = 0; trial < 3000; ++trial)
  {
    const bool parallel = trial % 2 == 0;
    const Camera camera = MakeCamera(random, parallel, trial % 3 == 0);
    const BlockProjection projection(camera.IndexToPixel, camera.Rays);
    const int column = pixel(random);
    const int row = pixel(random);
    const Ray ray = camera.Rays.Get(column, row);
    const int shift = 2 * (trial % 5 / 2);
    const std::array<int, 4> extent{ 0, 63, 0, 63 };
    // blocks along the ray, in the order in which it meets them
    std::vector<std::array<int, 3>> way;
    for (double t = parallel ? -80 : 1e-3; t < 80; t += 0.01 * (1 << shift))
    {
      std::array<int, 3> block;
      bool within = true;
      for (int a = 0; a < 3; ++a)
      {
        block[a] = static_cast<int>(std::floor(ray.A[a] + t * ray.B[a])) >> shift;
        within = within && block[a] >= 0 && block[a] < (64 >> shift);
      }
      if (within && (way.empty() || way.back() != block))
      {
        way.push_back(block);
      }
    }
    std::array<std::map<int, int>, 3> place;
    for (int a = 0; a < 3; ++a)
    {
      const FrontToBack order = projection.Order(a, 0, (64 >> shift) - 1, shift);
      ASSERT_EQ(order.Count(), 64 >> shift);
      for (int n = 0; n < order.Count(); ++n)
      {
        place[a][order[n]] = n;
      }
      ASSERT_EQ(place[a].size(), static_cast<std::size_t>(64 >> shift)) << "each index once";
    }
    for (std::size_t n = 0; n < way.size(); ++n)
    {
      const PixelBox box = projection.Find(way[n], shift, extent);
      ASSERT_TRUE(!box.IsEmpty() && box.FirstColumn <= column && column <= box.LastColumn &&
        box.FirstRow <= row && row <= box.LastRow)
        << trial;
      ++met;
      for (int a = 0; n > 0 && a < 3; ++a)
      {
        ASSERT_GE(place[a][way[n][a]], place[a][way[n - 1][a]]) << trial;
      }
    }
  }
  EXPECT_GT(met, 10000);
}

/// Rays cast together against rays cast alone, for oblique and axial views of awkward volumes.
TEST(TileCaster, SameAsSingleRays)
{
  std::mt19937 random(17);
  std::normal_distribution<double> normal;
  ThreadExecution execution(2);
  int hits = 0;
  int misses = 0;
  int touches = 0;
  for (int trial = 0; trial < 24; ++trial)
  {
    const std::array<int, 3> size{ 9 + trial % 5, 21, 6 + trial };
    const bool plateaus = trial % 4 == 3; // values at the iso-value itself
    const TestField field(size,
      trial % 3 ? RandomFrame(random, { 1, 0.8, 2.1 }, trial % 2) : Matrix4(),
      [&](const Vec3&) { return plateaus ? std::floor(2 * normal(random)) : normal(random); });
    const auto interpolation = static_cast<FieldInterpolation>(trial % 2 ? 2 : 0);
    const IsoRayCaster caster(field.View(), interpolation, SolidSide::Above, execution);
    const double isoValue = plateaus ? 1 : 0.7;
    ViewSettings view;
    view.PixelSpacing = trial % 3 ? 0.37 : 0.5; // along voxel faces in every other ray
    view.Direction = trial % 3 ? RandomUnit(random) : Vec3{ 0, 0, -1 };
    view.Up = { 0.1, 1, 0.1 };
    if (trial % 3 == 0)
    {
      view.Up = { 0, 1, 0 };
    }
    const ImagePlane plane = MakeImagePlane(field.IndexToWorld, size, view);
    const std::size_t count = static_cast<std::size_t>(plane.Size[0]) * plane.Size[1];
    std::vector<double> depth(count);
    std::vector<char> valid(count);
    std::vector<float> normals(3 * count);
    caster.Cast(plane, isoValue,
      { { 0, plane.Size[0] - 1, 0, plane.Size[1] - 1 }, depth.data(), valid.data(),
        normals.data() },
      execution);
    for (int row = 0; row < plane.Size[1]; ++row)
    {
      for (int column = 0; column < plane.Size[0]; ++column)
      {
        const std::size_t i = column + static_cast<std::size_t>(row) * plane.Size[0];
        RayHit hit;
        const bool found =
          caster.CastRay(plane.PixelPosition(column, row), plane.View, isoValue, hit);
        (found ? hits : misses)++;
        if (found == (valid[i] != 0) && (!found || std::abs(hit.Distance - depth[i]) < 1e-7))
        {
          continue;
        }
        // The rays differ by rounding. That may decide where the field touches the iso-value only:
        // behind the nearer hit it is less again.
        const double nearer = std::min(found ? hit.Distance : 1e300, valid[i] ? depth[i] : 1e300);
        const Vec3 behind = plane.PixelPosition(column, row) + (nearer + 1e-6) * plane.View;
        const Vec3 index = field.IndexToWorld.Inverse().Point(behind);
        const double value = trial % 2 ? field.Trilinear(index) : field.BSpline(index);
        ASSERT_LT(value, isoValue + 1e-9) << trial << " " << column << " " << row;
        ++touches;
      }
    }
  }
  EXPECT_LT(touches, 20);
  EXPECT_GT(hits, 10000);
  EXPECT_GT(misses, 1000);
}
