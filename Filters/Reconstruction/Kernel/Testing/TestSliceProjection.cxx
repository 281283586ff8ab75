// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSliceRayOracle.h"

#include <gtest/gtest.h>

using namespace lacuna;

namespace
{
constexpr double Degree = 3.14159265358979323846 / 180;

// A 5 x 4 slice of the plane z = 0 with its corner at the origin, pixels of 1 mm.
SyntheticSweep<double> MakeOneSlice(const Matrix4& pose)
{
  SyntheticSweep<double> sweep(5, 4, ScalarType::Float64);
  sweep.Add(pose, [](int x, int y) { return 10 * x + y; });
  return sweep;
}

// Seen from the top, pixels of 0.5 mm, the first one over (-1, 6).
ImagePlane FromTheTop()
{
  ImagePlane plane;
  plane.Origin = { -1, 6, 10 };
  plane.Right = { 1, 0, 0 };
  plane.Down = { 0, -1, 0 };
  plane.View = { 0, 0, -1 };
  plane.PixelSpacing = 0.5;
  plane.Size = { 20, 20 };
  return plane;
}
}

TEST(SliceProjection, FromTheTop)
{
  const auto sweep = MakeOneSlice({});
  const SliceProjection projection(sweep.Slices[0], FromTheTop());
  // column 2 of the map lies over x = 0, row 6 over y = 3 and row 12 over y = 0
  EXPECT_TRUE(projection.GetRow(5, { 0, 19 }).IsEmpty());
  EXPECT_TRUE(projection.GetRow(13, { 0, 19 }).IsEmpty());
  for (const std::int64_t row : { 6, 9, 12 })
  {
    EXPECT_EQ(projection.GetRow(row, { 0, 19 }).First, 2);
    EXPECT_EQ(projection.GetRow(row, { 0, 19 }).Last, 10);
    EXPECT_EQ(projection.GetRow(row, { 4, 7 }).First, 4);
    EXPECT_EQ(projection.GetRow(row, { 4, 7 }).Last, 7);
    EXPECT_TRUE(projection.GetRow(row, { 11, 19 }).IsEmpty());
    EXPECT_TRUE(projection.GetRow(row, { 0, 1 }).IsEmpty());
  }
  EXPECT_EQ(projection.GetDepth().At(projection.GetDepth().AtRow(7), 3), 10);
  const SliceProjection::RowSampler<double> sample(projection, 9);
  EXPECT_DOUBLE_EQ(sample(2), 1.5);
  EXPECT_DOUBLE_EQ(sample(5), 16.5);
  EXPECT_DOUBLE_EQ(sample(10), 41.5);
}

TEST(SliceProjection, RowsAreTheRaysThatMeetTheSlice)
{
  const ImagePlane plane = FromTheTop();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(-1, 1);
  std::int64_t meetings = 0;
  for (int n = 0; n < 3000; ++n)
  {
    // also slices whose rows or columns run along those of the map, as most do
    Matrix4 turn = Matrix4::Rotation({ 0, 0, 1 }, 90 * Degree * (n % 4)) *
      Matrix4::Rotation({ 1, 0, 0 }, n % 3 == 0 ? 0 : u(random));
    if (n % 2 == 0)
    {
      turn = Matrix4::Rotation({ u(random), u(random), u(random) }, 3 * u(random));
    }
    const auto sweep = MakeOneSlice(
      Matrix4::Translation({ 4 + 4 * u(random), 2 + 4 * u(random), u(random) }) * turn);
    const SliceImage& slice = sweep.Slices[0];
    if (SliceProjection::IsEdgeOn(slice, plane))
    {
      continue;
    }
    const SliceProjection projection(slice, plane);
    for (int j = 0; j < plane.Size[1]; ++j)
    {
      const IndexInterval row = projection.GetRow(j, { 0, plane.Size[0] - 1 });
      for (int i = 0; i < plane.Size[0]; ++i)
      {
        const bool inside = i >= row.First && i <= row.Last;
        ASSERT_EQ(inside, projection.Meets(i, j)) << n << " " << i << " " << j;
        double depth;
        double level;
        const bool expected =
          IntersectRay<double>(slice, plane.PixelPosition(i, j), plane.View, depth, level);
        if (inside != expected)
        {
          // only where rounding may decide
          const Matrix4& pose = slice.PixelToReference;
          const Vec3 hit =
            Matrix4::FromColumns(pose.Column(0), pose.Column(1), plane.View, pose.Column(3))
              .Inverse()
              .Point(plane.PixelPosition(i, j));
          const double border = std::min(
            { std::abs(hit[0]), std::abs(hit[0] - 4), std::abs(hit[1]), std::abs(hit[1] - 3) });
          ASSERT_LT(border, 2e-6);
          continue;
        }
        if (inside)
        {
          ++meetings;
          ASSERT_NEAR(projection.GetDepth().At(projection.GetDepth().AtRow(j), i), depth, 1e-9);
          ASSERT_NEAR(SliceProjection::RowSampler<double>(projection, j)(i), level, 1e-9);
        }
      }
    }
  }
  EXPECT_GT(meetings, 50000);
}

TEST(SliceProjection, HardlyInclinedSlices)
{
  // steps along a row so small that divisions by them say nothing, or overflow
  const ImagePlane plane = FromTheTop();
  for (const double angle : { 1e-5, 1e-9, 1e-13, 1e-17, 1e-200, 1e-310 })
  {
    for (const double sign : { -1.0, 1.0 })
    {
      Matrix4 pose;
      pose(0, 1) = sign * angle;
      pose(1, 0) = -sign * angle;
      for (const double y : { 0.0, -1e-6, 1e-6, 3e-6, -3e-6 })
      {
        const auto sweep = MakeOneSlice(Matrix4::Translation({ 0, y, 0 }) * pose);
        const SliceProjection projection(sweep.Slices[0], plane);
        for (int j = 0; j < plane.Size[1]; ++j)
        {
          const IndexInterval row = projection.GetRow(j, { 0, plane.Size[0] - 1 });
          for (int i = 0; i < plane.Size[0]; ++i)
          {
            ASSERT_EQ(i >= row.First && i <= row.Last, projection.Meets(i, j));
          }
        }
      }
    }
  }
}

TEST(SliceProjection, EdgeOnIsBelowOneDegree)
{
  const ImagePlane plane = FromTheTop();
  for (const double turn : { 0.0, 33.0, 180.0 })
  {
    for (const double degrees : { 0.0, 0.5, 0.999, 1.001, 5.0, 90.0 })
    {
      for (const double sign : { -1.0, 1.0 })
      {
        // the slice upright at 0 degrees
        const auto sweep = MakeOneSlice(Matrix4::Rotation({ 0, 0, 1 }, turn * Degree) *
          Matrix4::Rotation({ 1, 0, 0 }, sign * (90 - degrees) * Degree));
        EXPECT_EQ(SliceProjection::IsEdgeOn(sweep.Slices[0], plane), degrees < 1) << degrees;
      }
    }
  }
}

TEST(SliceProjection, RefusesWhatIsTooFarOff)
{
  const auto sweep =
    MakeOneSlice(Matrix4::Translation({ 1e308, 0, 0 }) * Matrix4::Scaling({ 1e-150, 1e-150, 1 }));
  try
  {
    const SliceProjection projection(sweep.Slices[0], FromTheTop());
    FAIL();
  }
  catch (const std::invalid_argument& e)
  {
    EXPECT_EQ(std::string(e.what()), "slice 0: its pose lies too far off to be seen");
  }
}
