// SPDX-License-Identifier: BSD-3-Clause
/// How the slice ray caster behaves: the order and the grouping of slices, parts, types, bad input.
#include "lacunaSliceRayOracle.h"

#include <gtest/gtest.h>

#include <numeric>

using namespace lacuna;

namespace
{
constexpr double Degree = 3.14159265358979323846 / 180;

// Speckle of 4 x 4 pixels on slices of random poses; some come twice.
template <class T>
SyntheticSweep<T> MakeSpeckle(int count, unsigned int seed, ScalarType type, bool holes)
{
  SyntheticSweep<T> sweep(37, 29, type);
  std::mt19937 random(seed);
  const std::vector<Matrix4> poses = MakeRandomPoses(count, seed, 0.5);
  for (int n = 0; n < count; ++n)
  {
    std::vector<double> grains(100);
    for (double& grain : grains)
    {
      grain = static_cast<double>(random() % 256);
    }
    sweep.Add(poses[n % 5 == 4 ? n - 1 : n],
      [&](int x, int y)
      {
        return holes && random() % 9 == 0 ? std::numeric_limits<double>::quiet_NaN()
                                          : grains[y / 4 * 10 + x / 4];
      });
  }
  return sweep;
}

std::vector<SliceImage> Reorder(
  const std::vector<SliceImage>& slices, const std::vector<int>& order)
{
  std::vector<SliceImage> reordered;
  for (const int n : order)
  {
    reordered.push_back(slices[n]);
  }
  return reordered;
}

// In groups of random size, the threads changing from group to group.
WrittenMap CastInGroups(const std::vector<SliceImage>& slices, const ImagePlane& plane,
  double isoValue, SolidSide side, std::mt19937& random)
{
  SliceRayCaster caster(plane, GetExtent(plane), isoValue, side);
  for (std::size_t begin = 0; begin < slices.size();)
  {
    const std::size_t end = std::min(slices.size(), begin + 1 + random() % 6);
    ThreadExecution execution(1 + static_cast<int>(random() % 3));
    caster.AddSlices({ slices.begin() + static_cast<std::ptrdiff_t>(begin),
                       slices.begin() + static_cast<std::ptrdiff_t>(end) },
      execution);
    begin = end;
  }
  return Write(caster, GetExtent(plane), 0, 2);
}

std::string GetError(const std::function<void()>& work)
{
  try
  {
    work();
  }
  catch (const std::exception& e)
  {
    return e.what();
  }
  return "no error";
}

class StoppedExecution : public ThreadExecution
{
public:
  StoppedExecution()
    : ThreadExecution(1, [](double) { return false; })
  {
  }
};
}

TEST(SliceRayCasterBehaviour, EveryOrderOfSixSlices)
{
  const auto sweep = MakeSpeckle<double>(6, 1, ScalarType::Float64, true);
  const ImagePlane plane = MakePlane(sweep.Slices, { 0.2, 0.1, -1 }, 0.4);
  for (const SolidSide side : { SolidSide::Above, SolidSide::Below })
  {
    const WrittenMap expected = Cast(sweep.Slices, plane, GetExtent(plane), 128, side);
    EXPECT_GT(expected.CountValid(), 100);
    std::vector<int> order{ 0, 1, 2, 3, 4, 5 };
    ThreadExecution execution(1);
    do
    {
      SliceRayCaster caster(plane, GetExtent(plane), 128, side);
      for (const SliceImage& slice : Reorder(sweep.Slices, order))
      {
        caster.AddSlices({ slice }, execution);
      }
      ASSERT_TRUE(expected == Write(caster, GetExtent(plane)));
    } while (std::next_permutation(order.begin(), order.end()));
  }
}

TEST(SliceRayCasterBehaviour, AnyOrderAndGroupingOfManySlices)
{
  for (unsigned int seed = 2; seed < 4; ++seed)
  {
    const auto bytes = MakeSpeckle<std::uint8_t>(50, seed, ScalarType::UInt8, false);
    const auto floats = MakeSpeckle<float>(50, seed, ScalarType::Float32, true);
    auto fans = bytes.Slices;
    const auto fan = std::make_shared<FanMask>(
      Fan{ { 18, -5 }, { -40, 45 }, { 2, 7 } }, 37, 29, Vec2{ 0.31, 0.23 });
    for (SliceImage& slice : fans)
    {
      slice.Fan = fan;
    }
    std::mt19937 random(seed);
    for (const std::vector<SliceImage>& slices : { bytes.Slices, floats.Slices, fans })
    {
      for (const Vec3& direction : { Vec3{ 0, 0, 1 }, Vec3{ 0, 0, -1 }, Vec3{ 1, 0.2, 0.1 } })
      {
        const ImagePlane plane = MakePlane(slices, direction, 0.3);
        // 240: solid samples are rare, so front samples are displaced many times before one comes
        for (const double isoValue : { 128.0, 240.0 })
        {
          const WrittenMap expected = Cast(slices, plane, GetExtent(plane), isoValue);
          EXPECT_GT(expected.CountValid(), 150);
          std::vector<int> order(slices.size());
          std::iota(order.begin(), order.end(), 0);
          for (int trial = 0; trial < 5; ++trial)
          {
            if (trial == 1)
            {
              std::reverse(order.begin(), order.end());
            }
            else if (trial > 1)
            {
              std::shuffle(order.begin(), order.end(), random);
            }
            ASSERT_TRUE(expected ==
              CastInGroups(Reorder(slices, order), plane, isoValue, SolidSide::Above, random))
              << seed << " " << isoValue << " " << trial;
          }
        }
      }
    }
  }
}

TEST(SliceRayCasterBehaviour, TheNumberOfThreadsDoesNotMatter)
{
  const auto sweep = MakeSpeckle<std::uint8_t>(60, 5, ScalarType::UInt8, false);
  const ImagePlane plane = MakePlane(sweep.Slices, { 0.3, 0, 1 }, 0.2);
  const auto cast = [&](int threads)
  { return Cast(sweep.Slices, plane, GetExtent(plane), 200, SolidSide::Above, 1.5, threads); };
  const WrittenMap one = cast(1);
  EXPECT_GT(one.CountValid(), 1000);
  EXPECT_TRUE(one == cast(2));
  EXPECT_TRUE(one == cast(5));
}

TEST(SliceRayCasterBehaviour, PartsAreThoseOfTheWhole)
{
  const auto sweep = MakeSpeckle<std::uint8_t>(20, 6, ScalarType::UInt8, false);
  const ImagePlane plane = MakePlane(sweep.Slices, { 0.3, 0, 1 }, 0.4);
  const WrittenMap whole = Cast(sweep.Slices, plane, GetExtent(plane), 150);
  const int right = plane.Size[0] - 1;
  const int bottom = plane.Size[1] - 1;
  for (const std::array<int, 4>& extent :
    { std::array<int, 4>{ 0, right, 3, 3 }, std::array<int, 4>{ 5, 9, 0, bottom },
      std::array<int, 4>{ right, right, bottom, bottom }, std::array<int, 4>{ 7, 20, 5, 14 } })
  {
    const WrittenMap part = Cast(sweep.Slices, plane, extent, 150);
    WrittenMap expected(extent);
    for (int j = extent[2]; j <= extent[3]; ++j)
    {
      for (int i = extent[0]; i <= extent[1]; ++i)
      {
        const int to = (j - extent[2]) * part.Width + i - extent[0];
        const int from = j * whole.Width + i;
        expected.Depth[to] = whole.Depth[from];
        expected.Valid[to] = whole.Valid[from];
        std::copy_n(&whole.Normals[3 * from], 3, &expected.Normals[3 * to]);
      }
    }
    EXPECT_TRUE(part == expected) << "also the normals along the borders";
  }
}

TEST(SliceRayCasterBehaviour, AllTypesOfPixels)
{
  WrittenMap expected({ 0, 0, 0, 0 });
  const auto check = [&](auto zero, ScalarType type)
  {
    using T = decltype(zero);
    SyntheticSweep<T> sweep(9, 8, type);
    for (int n = 0; n < 5; ++n)
    {
      sweep.Add(
        Matrix4::Translation({ 0.1 * n, 0, 1.0 * n }) * Matrix4::Rotation({ 1, 0, 0 }, 0.1 * n),
        [=](int x, int y) { return x + 2 * y + 15 * n; });
    }
    const ImagePlane plane = MakePlane(sweep.Slices, { 0, 0, 1 }, 0.6);
    const WrittenMap map = Cast(sweep.Slices, plane, GetExtent(plane), 40);
    if (expected.Depth.size() == 1)
    {
      expected = map;
      EXPECT_GT(map.CountValid(), 50);
    }
    EXPECT_TRUE(map == expected) << static_cast<int>(type);
  };
  check(double(), ScalarType::Float64);
  check(float(), ScalarType::Float32);
  check(std::int8_t(), ScalarType::Int8);
  check(std::uint8_t(), ScalarType::UInt8);
  check(std::int16_t(), ScalarType::Int16);
  check(std::uint16_t(), ScalarType::UInt16);
  check(std::int32_t(), ScalarType::Int32);
  check(std::uint32_t(), ScalarType::UInt32);
  check(std::int64_t(), ScalarType::Int64);
  check(std::uint64_t(), ScalarType::UInt64);
}

TEST(SliceRayCasterBehaviour, SlicesSeenEdgeOnAreLeftOut)
{
  SyntheticSweep<std::uint8_t> sweep(21, 21, ScalarType::UInt8);
  const auto add = [&](double degrees)
  {
    sweep.Add(
      Matrix4::Rotation({ 1, 0, 0 }, degrees * Degree) * Matrix4::Translation({ -10, -10, 0 }),
      [](int, int) { return 200; });
  };
  add(90);
  add(89.5);
  add(-90.5);
  ImagePlane plane = MakePlane(sweep.Slices, { 0, 0, -1 }, 0.1, { 0, 1, 0 });
  ThreadExecution execution(1);
  SliceRayCaster caster(plane, GetExtent(plane), 100, SolidSide::Above);
  caster.AddSlices(sweep.Slices, execution);
  EXPECT_EQ(caster.GetNumberOfSlices(), 3);
  EXPECT_EQ(caster.GetNumberOfEdgeOnSlices(), 3);
  EXPECT_EQ(Write(caster, GetExtent(plane)).CountValid(), 0);
  add(88);
  caster.AddSlices({ sweep.Slices.back() }, execution);
  EXPECT_EQ(caster.GetNumberOfEdgeOnSlices(), 3);
  EXPECT_GT(Write(caster, GetExtent(plane)).CountValid(), 0) << "2 degrees are enough";
}

TEST(SliceRayCasterBehaviour, PixelsMayMove)
{
  const auto sweep = MakeSpeckle<std::uint8_t>(30, 7, ScalarType::UInt8, false);
  const ImagePlane plane = MakePlane(sweep.Slices, { 0, 0, 1 }, 0.5);
  const WrittenMap expected = Cast(sweep.Slices, plane, GetExtent(plane), 240);
  ThreadExecution execution(1);
  SliceRayCaster caster(plane, GetExtent(plane), 240, SolidSide::Above);
  std::vector<SliceImage> moved;
  std::vector<std::vector<std::uint8_t>> memory;
  for (const SliceImage& slice : Reorder(sweep.Slices, { 3, 25, 7, 18, 2, 29, 11, 0 }))
  {
    const auto* source = static_cast<const std::uint8_t*>(slice.Pixels);
    memory.emplace_back(source, source + slice.RowStride * slice.Height);
    moved.push_back(slice);
    moved.back().Pixels = memory.back().data();
  }
  caster.AddSlices(moved, execution);
  for (std::size_t n = 0; n < moved.size(); ++n)
  {
    memory[n].assign(memory[n].size(), 255); // what is still read there would be solid
  }
  const std::vector<SliceImage> first = Reorder(sweep.Slices, { 3, 25, 7, 18, 2, 29, 11, 0 });
  caster.MoveSlices(first);
  caster.AddSlices(sweep.Slices, execution);
  EXPECT_TRUE(expected == Write(caster, GetExtent(plane)));
  EXPECT_EQ(
    GetError([&] { caster.MoveSlices(first); }), "MoveSlices needs all slices that were added");
}

TEST(SliceRayCasterBehaviour, BadInputIsRefused)
{
  const auto sweep = MakeSpeckle<std::uint8_t>(6, 8, ScalarType::UInt8, false);
  const ImagePlane plane = MakePlane(sweep.Slices, { 0, 0, 1 }, 0.5);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(GetError([&] { SliceRayCaster(plane, GetExtent(plane), nan, SolidSide::Above); }),
    "the iso-value is not a number");
  for (const std::array<int, 4>& extent :
    { std::array<int, 4>{ -1, 3, 0, 3 }, std::array<int, 4>{ 0, plane.Size[0], 0, 3 },
      std::array<int, 4>{ 0, 3, 2, 1 }, std::array<int, 4>{ 0, 3, 0, plane.Size[1] } })
  {
    EXPECT_EQ(GetError([&] { SliceRayCaster(plane, extent, 100, SolidSide::Above); }),
      "pixels outside of the depth map were asked for");
  }
  ImagePlane huge = plane;
  huge.Size = { 2000000000, 2000000000 };
  EXPECT_NE(GetError([&] { SliceRayCaster(huge, GetExtent(huge), 100, SolidSide::Above); })
              .find("would need"),
    std::string::npos);

  // one unusable slice, and none is added
  ThreadExecution execution(1);
  SliceRayCaster caster(plane, GetExtent(plane), 100, SolidSide::Above);
  std::vector<SliceImage> slices = sweep.Slices;
  slices[4].PixelToReference(1, 2) = 7; // the third column does not count
  slices[5].PixelToReference(1, 1) = nan;
  EXPECT_NE(
    GetError([&] { caster.AddSlices(slices, execution); }).find("slice 5"), std::string::npos);
  EXPECT_EQ(caster.GetNumberOfSlices(), 0);
  EXPECT_EQ(Write(caster, GetExtent(plane)).CountValid(), 0);
  slices.pop_back();
  caster.AddSlices(slices, execution);
  caster.AddSlices({}, execution);
  EXPECT_TRUE(Write(caster, GetExtent(plane)) ==
    Cast({ sweep.Slices.begin(), sweep.Slices.end() - 1 }, plane, GetExtent(plane), 100));
  EXPECT_EQ(GetError(
              [&] {
                caster.Write(0, { { 0, 1, 0, 1 }, nullptr, nullptr, nullptr }, execution);
              }),
    "a slice ray caster writes all of its extent");

  StoppedExecution stopped;
  EXPECT_THROW(caster.AddSlices(sweep.Slices, stopped), Aborted);
}

TEST(SliceRayCasterBehaviour, MaskAndNormalsMayBeLeftOut)
{
  const auto sweep = MakeSpeckle<std::uint8_t>(6, 9, ScalarType::UInt8, false);
  const ImagePlane plane = MakePlane(sweep.Slices, { 0, 0, 1 }, 0.5);
  const WrittenMap expected = Cast(sweep.Slices, plane, GetExtent(plane), 100);
  ThreadExecution execution(1);
  SliceRayCaster caster(plane, GetExtent(plane), 100, SolidSide::Above);
  caster.AddSlices(sweep.Slices, execution);
  WrittenMap map = expected;
  map.Depth.assign(map.Depth.size(), 0);
  caster.Write(0, { GetExtent(plane), map.Depth.data(), nullptr, nullptr }, execution);
  EXPECT_TRUE(map == expected);
}
