// SPDX-License-Identifier: BSD-3-Clause
/// Depth maps of slices against the definition taken at its word, and against known surfaces.
#include "lacunaSliceRayOracle.h"

#include <gtest/gtest.h>

using namespace lacuna;

namespace
{
constexpr double Degree = 3.14159265358979323846 / 180;
constexpr double Nothing = std::numeric_limits<double>::quiet_NaN();

// Level slices of 3 x 3 pixels of 1 mm at the given heights, each of one grey level.
struct Stack
{
  void Add(double height, double grey, bool beginsSweep = false)
  {
    this->Sweep.Add(Matrix4::Translation({ -1, -1, height }), [=](int, int) { return grey; });
    this->Sweep.Slices.back().BeginsSweep = beginsSweep;
  }
  /// Depth below height 10 of what is seen from the top.
  double Cast(double isoValue, SolidSide side = SolidSide::Above, double maximumGap = 0) const
  {
    ImagePlane plane;
    plane.Origin = { 0, 0, 10 };
    plane.Right = { 1, 0, 0 };
    plane.Down = { 0, -1, 0 };
    plane.View = { 0, 0, -1 };
    plane.PixelSpacing = 1;
    plane.Size = { 1, 1 };
    return lacuna::Cast(this->Sweep.Slices, plane, { 0, 0, 0, 0 }, isoValue, side, maximumGap)
      .At(0, 0);
  }

  SyntheticSweep<double> Sweep{ 3, 3, ScalarType::Float64 };
};

template <class T>
void CompareWithOracle(const SyntheticSweep<T>& sweep, const Vec3& direction, double isoValue)
{
  const ImagePlane plane = MakePlane(sweep.Slices, direction, 0.25);
  for (const SolidSide side : { SolidSide::Above, SolidSide::Below })
  {
    for (const double maximumGap : { 0.0, 0.8 })
    {
      const WrittenMap map =
        Cast(sweep.Slices, plane, GetExtent(plane), isoValue, side, maximumGap);
      std::int64_t different = 0;
      std::int64_t solid = 0;
      for (int j = 0; j < plane.Size[1]; ++j)
      {
        for (int i = 0; i < plane.Size[0]; ++i)
        {
          const double expected =
            CastOneRay<T>(sweep.Slices, plane, i, j, isoValue, side, maximumGap);
          const double depth = map.At(i, j);
          const bool same =
            std::isnan(expected) ? std::isnan(depth) : std::abs(depth - expected) < 1e-8;
          different += same ? 0 : 1;
          solid += std::isnan(expected) ? 0 : 1;
          ASSERT_EQ(std::isnan(depth), map.Valid[j * map.Width + i] == 0);
        }
      }
      // a ray through the very border of a slice may be counted in or out
      EXPECT_LE(different, 2) << "of " << map.Depth.size();
      EXPECT_GT(solid, 100);
    }
  }
}
}

TEST(SliceRayCaster, CrossingBetweenTwoSlices)
{
  Stack stack;
  stack.Add(6, 0);
  stack.Add(2, 100);
  EXPECT_DOUBLE_EQ(stack.Cast(25), 5);
  EXPECT_DOUBLE_EQ(stack.Cast(75), 7);
  EXPECT_DOUBLE_EQ(stack.Cast(100), 8) << "equal is solid";
  EXPECT_TRUE(std::isnan(stack.Cast(100.5)));
  EXPECT_DOUBLE_EQ(stack.Cast(0), 4) << "equal is solid, and nothing lies in front";
}

TEST(SliceRayCaster, SolidBelow)
{
  Stack stack;
  stack.Add(6, 100);
  stack.Add(2, 0);
  EXPECT_DOUBLE_EQ(stack.Cast(75, SolidSide::Below), 5);
  EXPECT_DOUBLE_EQ(stack.Cast(25, SolidSide::Below), 7);
  EXPECT_DOUBLE_EQ(stack.Cast(0, SolidSide::Below), 8);
  EXPECT_DOUBLE_EQ(stack.Cast(100, SolidSide::Below), 4);
  EXPECT_TRUE(std::isnan(stack.Cast(-1, SolidSide::Below)));
}

TEST(SliceRayCaster, MaximumGap)
{
  Stack stack;
  stack.Add(6, 0);
  stack.Add(2, 100);
  EXPECT_DOUBLE_EQ(stack.Cast(25, SolidSide::Above, 0), 5) << "no limit";
  EXPECT_DOUBLE_EQ(stack.Cast(25, SolidSide::Above, 4), 5) << "not further apart than that";
  EXPECT_DOUBLE_EQ(stack.Cast(25, SolidSide::Above, 3.999), 8) << "the solid sample's depth";
  stack.Add(3, 20);
  EXPECT_DOUBLE_EQ(stack.Cast(25, SolidSide::Above, 3.999), 7.0625);
}

TEST(SliceRayCaster, OnlyTheSampleJustInFrontCounts)
{
  Stack stack;
  stack.Add(9, 90);
  stack.Add(6, 0);
  stack.Add(2, 100);
  stack.Add(1, 0);
  stack.Add(0, 200);
  EXPECT_DOUBLE_EQ(stack.Cast(100), 8);
  EXPECT_DOUBLE_EQ(stack.Cast(50), 1) << "the nearest sample of all is solid";
  EXPECT_DOUBLE_EQ(stack.Cast(95), 7.8);
  EXPECT_DOUBLE_EQ(stack.Cast(150), 9.75);
}

TEST(SliceRayCaster, TheMostSolidOfSamplesAtOneDepthCounts)
{
  Stack stack;
  stack.Add(6, 10);
  stack.Add(2, 60);
  stack.Add(2, 40);
  stack.Add(2, 110);
  stack.Add(6, 20);
  EXPECT_DOUBLE_EQ(stack.Cast(50), 4 + 4 * 30.0 / 90);
  EXPECT_DOUBLE_EQ(stack.Cast(100), 4 + 4 * 80.0 / 90);
  EXPECT_DOUBLE_EQ(stack.Cast(15), 4);
  EXPECT_DOUBLE_EQ(stack.Cast(50, SolidSide::Below), 4);
  EXPECT_DOUBLE_EQ(stack.Cast(15, SolidSide::Below), 4);
}

TEST(SliceRayCaster, NothingIsInterpolatedBetweenSweeps)
{
  Stack stack;
  stack.Add(6, 0);
  stack.Add(2, 100, true);
  EXPECT_DOUBLE_EQ(stack.Cast(25), 8) << "nothing of its sweep lies in front of the solid sample";
  stack.Add(3, 20);
  EXPECT_DOUBLE_EQ(stack.Cast(25), 7.0625);
  EXPECT_DOUBLE_EQ(stack.Cast(10), 7) << "both of the second sweep are solid";
}

TEST(SliceRayCaster, SweepsThatOverlapAreInterpolatedEachForItself)
{
  Stack stack;
  stack.Add(2, 100);
  stack.Add(6, 0);
  stack.Add(1, 100, true);
  stack.Add(5, 20);
  EXPECT_DOUBLE_EQ(stack.Cast(50), 6) << "of the first sweep, in spite of the other slice between";
  stack.Add(3, 60);
  EXPECT_DOUBLE_EQ(stack.Cast(50), 6.5) << "of the second sweep, which now is nearer";
  EXPECT_DOUBLE_EQ(stack.Cast(80), 7.2) << "again of the first sweep";
  stack.Add(7, 100, true);
  stack.Add(9, 0);
  EXPECT_DOUBLE_EQ(stack.Cast(50), 2);
  stack.Add(7, 200, true);
  stack.Add(8, 0);
  EXPECT_DOUBLE_EQ(stack.Cast(50), 2) << "of solid samples at one depth that of the first sweep";
}

TEST(SliceRayCaster, TwoStripsSeenObliquely)
{
  // Two strips, 0.2 mm from slice to slice; the second one goes on 0.15 mm higher and 5 mm to the side.
  // Along rays at 80 degrees to the slices' normal the air is narrower than the limit that follows from
  // the steps, so that the limit alone lets them be joined.
  SyntheticSweep<double> strips(31, 25, ScalarType::Float64);
  const auto field = [](const Vec3& p)
  { return 100 + 40 * std::sin(0.9 * p[0]) * std::cos(0.7 * p[1]) - 6 * p[2]; };
  for (int strip = 0; strip < 2; ++strip)
  {
    for (int n = 0; n < 11; ++n)
    {
      strips.AddField(Matrix4::Translation({ 5.0 * strip, 0.5 * strip, 2.15 * strip + 0.2 * n }) *
          Matrix4::Rotation({ 1, 0, 0 }, 0.001 * n) * Matrix4::Scaling({ 0.3, 0.3, 1 }),
        field);
      strips.Slices.back().BeginsSweep = n == 0;
    }
  }
  std::int64_t joined = 0;
  for (const double way : { 1.0, -1.0 })
  {
    const ImagePlane plane = MakePlane(
      strips.Slices, { way * std::sin(80 * Degree), 0.05, way * std::cos(80 * Degree) }, 0.2);
    const double gap = GetWidestStepAlongRays(strips.Slices, plane);
    ASSERT_GT(gap, 1.15);
    for (const double maximumGap : { gap, 0.0 })
    {
      const WrittenMap map =
        Cast(strips.Slices, plane, GetExtent(plane), 95, SolidSide::Above, maximumGap);
      std::vector<SliceImage> one = strips.Slices;
      one[11].BeginsSweep = false;
      for (int j = 0; j < plane.Size[1]; ++j)
      {
        for (int i = 0; i < plane.Size[0]; ++i)
        {
          const auto cast = [&](const std::vector<SliceImage>& slices)
          { return CastOneRay<double>(slices, plane, i, j, 95, SolidSide::Above, maximumGap); };
          const double expected = cast(strips.Slices);
          ASSERT_TRUE(std::isnan(expected) ? std::isnan(map.At(i, j))
                                           : std::abs(map.At(i, j) - expected) < 1e-8)
            << i << " " << j << ": " << map.At(i, j) << " instead of " << expected;
          joined += cast(one) < expected - 0.1 ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(joined, 50) << "rays that would meet a surface in the air";
}

TEST(SliceRayCaster, SamplesThatAreNotFiniteDoNotExist)
{
  const double infinity = std::numeric_limits<double>::infinity();
  Stack stack;
  stack.Add(9, infinity);
  stack.Add(6, 0);
  stack.Add(5, Nothing);
  stack.Add(2, 100);
  stack.Add(1, -infinity);
  EXPECT_DOUBLE_EQ(stack.Cast(25), 5);
  EXPECT_DOUBLE_EQ(stack.Cast(75, SolidSide::Below), 4);
}

TEST(SliceRayCaster, InfiniteIsoValues)
{
  const double infinity = std::numeric_limits<double>::infinity();
  Stack stack;
  stack.Add(6, 0);
  stack.Add(2, 100);
  EXPECT_TRUE(std::isnan(stack.Cast(infinity)));
  EXPECT_DOUBLE_EQ(stack.Cast(-infinity), 4);
  EXPECT_TRUE(std::isnan(stack.Cast(-infinity, SolidSide::Below)));
}

TEST(SliceRayCaster, AgreesWithAllRaysTimesAllSlices)
{
  for (unsigned int seed = 1; seed <= 3; ++seed)
  {
    SyntheticSweep<std::uint8_t> bytes(31, 25, ScalarType::UInt8);
    SyntheticSweep<double> numbers(31, 25, ScalarType::Float64);
    std::mt19937 random(seed);
    for (const Matrix4& pose : MakeRandomPoses(12, seed, 0.4))
    {
      // speckle, rather solid in places
      const auto grey = [&](int x, int y)
      { return static_cast<double>(random() % 200) * (x * x + y * y < 300 ? 0.7 : 1); };
      bytes.Add(pose, grey);
      numbers.Add(pose, [&](int x, int y) { return x == 7 && y % 5 == 0 ? Nothing : grey(x, y); });
    }
    for (const Vec3& direction : { Vec3{ 0, 0, 1 }, Vec3{ 0.3, 0.2, -0.5 }, Vec3{ 1, 0.3, 0.1 } })
    {
      CompareWithOracle(bytes, direction, 120);
      CompareWithOracle(numbers, direction, 110.3);
    }
    for (const std::size_t n : { 0, 3, 4, 8 }) // sweeps that cross each other
    {
      bytes.Slices[n].BeginsSweep = numbers.Slices[n].BeginsSweep = true;
    }
    CompareWithOracle(bytes, { 0.3, 0.2, -0.5 }, 120);
    CompareWithOracle(numbers, { 1, 0.3, 0.1 }, 110.3);
    const auto fan = std::make_shared<FanMask>(
      Fan{ { 14.2, -3 }, { -40, 35 }, { 1.5, 6 } }, 31, 25, Vec2{ 0.31, 0.23 });
    for (std::size_t n = 0; n < numbers.Slices.size(); ++n)
    {
      bytes.Slices[n].Fan = numbers.Slices[n].Fan = n % 3 == 0 ? nullptr : fan;
    }
    CompareWithOracle(bytes, { 0.2, 0.1, 1 }, 120);
    CompareWithOracle(numbers, { 0.2, 0.1, 1 }, 110.3);
  }
}

TEST(SliceRayCaster, BallWithinHalfASliceDistance)
{
  // A ball of 10 mm with an edge 1 mm wide, and slices that turn and tilt, 0.5 mm apart.
  const Vec3 center{ 1, -2, 3 };
  const auto field = [&](const Vec3& p)
  { return 60 + 120 * std::clamp(10.5 - Norm(p - center), 0.0, 1.0); };
  SyntheticSweep<std::uint8_t> sweep(140, 140, ScalarType::UInt8);
  const double step = 0.5;
  for (int n = 0; n < 61; ++n)
  {
    const double t = (n - 30) / 30.0;
    const Matrix4 pose = Matrix4::Translation({ 0, 0, 3 + step * (n - 30) }) *
      Matrix4::Rotation({ 0, 1, 0 }, 0.1 * std::sin(3 * t)) *
      Matrix4::Rotation({ 1, 0, 0 }, 0.08 * std::cos(4 * t)) * Matrix4::Scaling({ 0.2, 0.2, 1 }) *
      Matrix4::Translation({ -70, -80, 0 });
    sweep.AddField(pose, field);
  }
  for (const Vec3& direction : { Vec3{ 0, 0, -1 }, Vec3{ 0, 0, 1 }, Vec3{ 0.5, -0.3, 1 } })
  {
    const ImagePlane plane = MakePlane(sweep.Slices, direction, 0.31);
    const WrittenMap map = Cast(sweep.Slices, plane, GetExtent(plane), 120);
    double sum = 0;
    double worst = 0;
    double sumOfTurns = 0;
    std::int64_t count = 0;
    for (int j = 0; j < plane.Size[1]; ++j)
    {
      for (int i = 0; i < plane.Size[0]; ++i)
      {
        const Vec3 toCenter = center - plane.PixelPosition(i, j);
        const double middle = Dot(toCenter, plane.View);
        const double square = Dot(toCenter, toCenter) - middle * middle;
        if (square > 12 * 12)
        {
          EXPECT_TRUE(std::isnan(map.At(i, j)));
        }
        if (square > 8 * 8) // seen at up to 53 degrees
        {
          continue;
        }
        const double truth = middle - std::sqrt(100 - square);
        const double error = map.At(i, j) - truth;
        ASSERT_FALSE(std::isnan(error));
        sum += error * error;
        worst = std::max(worst, std::abs(error));
        ++count;
        const float* n = map.Normals.data() + 3 * (static_cast<std::size_t>(j) * map.Width + i);
        const Vec3 normal{ n[0], n[1], n[2] };
        EXPECT_NEAR(Norm(normal), 1, 1e-6);
        EXPECT_LT(Dot(normal, plane.View), 0) << "towards the viewer";
        sumOfTurns += Dot(normal, 0.1 * (plane.PixelPosition(i, j) + truth * plane.View - center));
      }
    }
    EXPECT_GT(count, 1500);
    // the samples are at most so far apart along the ray, slices being inclined to it
    const double gap = step * 1.2 / std::min(1.0, std::abs(Dot(plane.View, { 0, 0, 1 })));
    EXPECT_LT(worst, 0.5 * gap + 0.02);
    EXPECT_LT(std::sqrt(sum / static_cast<double>(count)), 0.12 * gap);
    EXPECT_GT(sumOfTurns / static_cast<double>(count), std::cos(20 * Degree)) << "normals outwards";
  }
}

TEST(SliceRayCaster, LateralityAndNormalsOfAPlane)
{
  // A wedge: solid where z < 1 + 0.5 x - 0.25 y, marked by a tall block at one corner.
  const auto field = [](const Vec3& p)
  {
    const bool marker = p[0] > 3 && p[1] > 2 && p[2] < 6;
    return marker ? 100.0 : 50 + 20 * (1 + 0.5 * p[0] - 0.25 * p[1] - p[2]);
  };
  SyntheticSweep<double> sweep(41, 31, ScalarType::Float64);
  for (int n = 0; n < 61; ++n)
  {
    sweep.AddField(
      Matrix4::Translation({ -4, -3, 7 - 0.2 * n }) * Matrix4::Scaling({ 0.2, 0.2, 1 }), field);
  }
  const ImagePlane plane = MakePlane(sweep.Slices, { 0, 0, -1 }, 0.2, { 0, 1, 0 });
  ASSERT_EQ(plane.Size, (std::array<int, 2>{ 41, 31 }));
  const WrittenMap map = Cast(sweep.Slices, plane, GetExtent(plane), 50);
  // top right of the picture is greatest x and greatest y
  EXPECT_NEAR(map.At(39, 1), 1, 0.21);
  EXPECT_GT(map.At(1, 1), 5);
  EXPECT_GT(map.At(39, 29), 2.5);
  // linear in space, so exact: z = 1 + 0.5 x - 0.25 y at depth 7 - z
  for (const int j : { 14, 20, 29 })
  {
    for (const int i : { 1, 12, 30 })
    {
      const Vec3 p = plane.PixelPosition(i, j);
      EXPECT_NEAR(map.At(i, j), 7 - (1 + 0.5 * p[0] - 0.25 * p[1]), 1e-9);
      const float* normal = map.Normals.data() + 3 * (j * map.Width + i);
      const Vec3 expected = Normalized({ -0.5, 0.25, 1 });
      for (int a = 0; a < 3; ++a)
      {
        EXPECT_NEAR(normal[a], expected[a], 1e-6);
      }
    }
  }
  // of the border's pixels, by one-sided differences, and where nothing is, none
  EXPECT_NEAR(map.Normals[3 * (20 * map.Width)], Normalized({ -0.5, 0.25, 1 })[0], 1e-6);
  const WrittenMap empty = Cast(sweep.Slices, plane, GetExtent(plane), 5000);
  EXPECT_EQ(empty.CountValid(), 0);
  EXPECT_EQ(empty.Normals, std::vector<float>(empty.Normals.size(), 0));
}
