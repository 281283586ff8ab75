// SPDX-License-Identifier: BSD-3-Clause
/// How the swept volume behaves: the order and the grouping of the work, types, bad input.
#include "lacunaSyntheticSweep.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

using namespace lacuna;

namespace
{
SyntheticSweep<std::uint8_t> MakeSpeckleSweep(int count, unsigned int seed, bool hasFan = false)
{
  SyntheticSweep<std::uint8_t> sweep(61, 49, ScalarType::UInt8);
  const auto fan = std::make_shared<const FanMask>(
    Fan{ { 30, -10 }, { -35, 40 }, { 2, 6.5 } }, 61, 49, Vec2{ 0.155, 0.115 });
  std::mt19937 random(seed);
  for (const Matrix4& pose : MakeRandomPoses(count, seed, 0.1))
  {
    sweep.Add(pose * Matrix4::Scaling({ 0.5, 0.5, 1 }), [&](int, int) { return random() % 256; });
    if (hasFan)
    {
      sweep.Slices.back().Fan = fan;
    }
  }
  return sweep;
}

std::vector<SweptVolume::Options> GetAllOptions()
{
  std::vector<SweptVolume::Options> all;
  for (const Compounding compounding : { Compounding::Mean, Compounding::Maximum })
  {
    SweptVolume::Options options;
    options.Compound = compounding;
    for (const PixelSampling sampling :
      { PixelSampling::Footprint, PixelSampling::Bilinear, PixelSampling::Nearest })
    {
      options.Sampling = sampling;
      all.push_back(options);
    }
    options.Interpolation = SweptVolume::Method::NearestVoxel;
    all.push_back(options);
  }
  SweptVolume::Options across;
  across.FootprintScale = 2.5;
  across.FootprintAcrossSlices = true;
  all.push_back(across);
  return all;
}

std::string GetError(const std::vector<SliceImage>& slices)
{
  try
  {
    const VolumeGrid grid{ { 0, 0, 0 }, { 1, 1, 1 }, { 4, 4, 4 } };
    ThreadExecution execution(1);
    SweptVolume volume(grid, GetExtent(grid), {});
    volume.AddSlices(slices, execution);
  }
  catch (const std::invalid_argument& e)
  {
    return e.what();
  }
  return "no error";
}

// A volume of one voxel that holds the given grey level.
template <class T>
T WriteOne(double grey, unsigned int contributions = 1)
{
  SyntheticSweep<double> sweep(2, 2, ScalarType::Float64);
  sweep.Add({}, [&](int, int) { return grey; });
  sweep.Add(Matrix4::Translation({ 0, 0, 1 }), [&](int, int) { return grey; });
  const VolumeGrid grid{ { 0.5, 0.5, 0.5 }, { 1, 1, 1 }, { 1, 1, 1 } };
  SweptVolume::Options options;
  options.Sampling = PixelSampling::Bilinear;
  options.DoublePrecision = true;
  const auto volume = Reconstruct<T>(sweep.Slices, grid, GetExtent(grid), options);
  EXPECT_EQ(volume.Contributions[0], contributions);
  EXPECT_EQ(volume.Mask[0], contributions > 0 ? 1 : 0);
  return volume.Intensity[0];
}
}

TEST(SweptVolumeBehaviour, TheNumberOfThreadsDoesNotMatter)
{
  for (const bool hasFan : { false, true })
  {
    const auto sweep = MakeSpeckleSweep(40, 1, hasFan);
    const VolumeGrid grid = MakeGrid(sweep.Slices, { 0.3, 0.3, 0.3 });
    for (const SweptVolume::Options& options : GetAllOptions())
    {
      const auto one = Reconstruct<float>(sweep.Slices, grid, GetExtent(grid), options, 1);
      EXPECT_GT(std::count(one.Mask.begin(), one.Mask.end(), 1), 2000);
      EXPECT_TRUE(one == Reconstruct<float>(sweep.Slices, grid, GetExtent(grid), options, 2));
      EXPECT_TRUE(one == Reconstruct<float>(sweep.Slices, grid, GetExtent(grid), options, 5));
    }
  }
}

TEST(SweptVolumeBehaviour, SlicesMayComeOneByOneOrTogether)
{
  for (const bool hasFan : { false, true })
  {
    const auto sweep = MakeSpeckleSweep(40, 2, hasFan);
    const VolumeGrid grid = MakeGrid(sweep.Slices, { 0.3, 0.3, 0.3 });
    for (const SweptVolume::Options& options : GetAllOptions())
    {
      const auto together = Reconstruct<float>(sweep.Slices, grid, GetExtent(grid), options);
      for (const std::size_t group : { 1, 7 })
      {
        ThreadExecution execution(2);
        SweptVolume volume(grid, GetExtent(grid), options);
        for (std::size_t begin = 0; begin < sweep.Slices.size(); begin += group)
        {
          const std::size_t end = std::min(begin + group, sweep.Slices.size());
          // pixels that are gone after the call
          std::vector<SliceImage> slices(sweep.Slices.begin() + static_cast<std::ptrdiff_t>(begin),
            sweep.Slices.begin() + static_cast<std::ptrdiff_t>(end));
          std::vector<std::vector<std::uint8_t>> pixels;
          for (SliceImage& slice : slices)
          {
            const auto* source = static_cast<const std::uint8_t*>(slice.Pixels);
            pixels.emplace_back(source, source + slice.RowStride * slice.Height);
            slice.Pixels = pixels.back().data();
          }
          volume.AddSlices(slices, execution);
        }
        EXPECT_TRUE(together == Write<float>(volume, GetExtent(grid)));
      }
    }
  }
}

TEST(SweptVolumeBehaviour, PiecesMakeTheWhole)
{
  for (const bool hasFan : { false, true })
  {
    const auto sweep = MakeSpeckleSweep(20, 3, hasFan);
    const VolumeGrid grid = MakeGrid(sweep.Slices, { 0.3, 0.3, 0.3 });
    const std::array<int, 6> all = GetExtent(grid);
    for (const SweptVolume::Options& options : GetAllOptions())
    {
      const auto whole = Reconstruct<float>(sweep.Slices, grid, all, options);
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        // three unequal parts along the axis
        const int size = grid.Dimensions[axis];
        const std::array<int, 4> cuts{ 0, size / 5, size / 2, size };
        for (std::size_t part = 0; part < 3; ++part)
        {
          std::array<int, 6> extent = all;
          extent[2 * axis] = cuts[part];
          extent[2 * axis + 1] = cuts[part + 1] - 1;
          const auto piece = Reconstruct<float>(sweep.Slices, grid, extent, options);
          std::size_t n = 0;
          bool same = true;
          for (int k = extent[4]; k <= extent[5]; ++k)
          {
            for (int j = extent[2]; j <= extent[3]; ++j)
            {
              for (int i = extent[0]; i <= extent[1]; ++i, ++n)
              {
                const std::size_t m =
                  (static_cast<std::size_t>(k) * grid.Dimensions[1] + j) * grid.Dimensions[0] + i;
                same &= piece.Intensity[n] == whole.Intensity[m] &&
                  piece.Contributions[n] == whole.Contributions[m];
              }
            }
          }
          EXPECT_TRUE(same) << axis << " " << part;
        }
      }
    }
  }
}

TEST(SweptVolumeBehaviour, SweepsFormNoPairWithEachOther)
{
  SyntheticSweep<std::uint8_t> sweep(4, 4, ScalarType::UInt8);
  for (const int z : { 0, 1, 5, 6 })
  {
    sweep.Add(Matrix4::Translation({ 0, 0, static_cast<double>(z) }), [](int, int) { return 50; });
  }
  const VolumeGrid grid{ { 0, 0, 0.5 }, { 1, 1, 1 }, { 4, 4, 6 } };
  ThreadExecution execution(1);
  SweptVolume volume(grid, GetExtent(grid), {});
  volume.AddSlices({ sweep.Slices[0], sweep.Slices[1] }, execution);
  volume.BeginSweep();
  volume.AddSlices({ sweep.Slices[2], sweep.Slices[3] }, execution);
  EXPECT_EQ(volume.GetPairCounts().All, 2);
  const auto written = Write<std::uint8_t>(volume, GetExtent(grid));
  for (std::size_t n = 0; n < written.Mask.size(); ++n)
  {
    const std::size_t k = n / 16;
    EXPECT_EQ(written.Mask[n], k == 0 || k == 5 ? 1 : 0) << n;
  }
}

TEST(SweptVolumeBehaviour, PixelsOutsideOfTheWindowDoNotExist)
{
  // garbage everywhere but in a window of 21 x 15 pixels at (5, 3)
  SyntheticSweep<std::uint8_t> sweep(40, 30, ScalarType::UInt8);
  const Matrix4 scale = Matrix4::Scaling({ 0.1, 0.1, 1 });
  for (const double z : { 0.0, 1.0 })
  {
    sweep.Add(Matrix4::Translation({ 0, 0, z }) * scale,
      [](int x, int y) { return x >= 5 && x < 26 && y >= 3 && y < 18 ? 80 : 255; });
  }
  std::vector<SliceImage> windows = sweep.Slices;
  for (SliceImage& window : windows)
  {
    window.Pixels = static_cast<const std::uint8_t*>(window.Pixels) + 3 * window.RowStride + 5;
    window.Width = 21;
    window.Height = 15;
    window.PixelToReference = window.PixelToReference * Matrix4::Translation({ 5, 3, 0 });
  }
  const VolumeGrid grid = MakeGrid(sweep.Slices, { 0.3, 0.3, 0.25 });
  for (const SweptVolume::Options& options : GetAllOptions())
  {
    const auto volume = Reconstruct<std::uint8_t>(windows, grid, GetExtent(grid), options);
    std::size_t n = 0;
    for (int k = 0; k < grid.Dimensions[2]; ++k)
    {
      for (int j = 0; j < grid.Dimensions[1]; ++j)
      {
        for (int i = 0; i < grid.Dimensions[0]; ++i, ++n)
        {
          // pixel centres in the window: 0.5..2.5 mm and 0.3..1.7 mm. Voxels overlap the pixels
          // 0.05 mm further outside, their footprints 0.2 mm.
          const bool inside = options.Sampling == PixelSampling::Footprint
            ? i >= 1 && i <= 9 && j >= 1 && j <= 6
            : i >= 2 && i <= 8 && j >= 1 && j <= 5;
          if (options.Interpolation == SweptVolume::Method::BetweenSlices)
          {
            EXPECT_EQ(volume.Mask[n], inside ? 1 : 0) << i << " " << j << " " << k;
          }
          EXPECT_EQ(volume.Intensity[n], volume.Mask[n] ? 80 : 0);
        }
      }
    }
  }
}

TEST(SweptVolumeBehaviour, NearestVoxelPutsEachPixelIntoOneVoxel)
{
  const auto sweep = MakeSpeckleSweep(9, 5);
  VolumeGridRequest request;
  request.Spacing = { 0.7, 0.6, 0.5 };
  VolumeGrid grid = MakeVolumeGrid(sweep.Slices, request);
  // cut a part off, so that pixels miss the grid
  grid.Dimensions[0] -= 3;
  grid.Dimensions[2] -= 4;
  std::vector<double> sum(GetNumberOfVoxels(GetExtent(grid)));
  std::vector<double> largest(sum.size());
  std::vector<unsigned int> count(sum.size());
  for (const SliceImage& slice : sweep.Slices)
  {
    for (int y = 0; y < slice.Height; ++y)
    {
      for (int x = 0; x < slice.Width; ++x)
      {
        const Vec3 p =
          slice.PixelToReference.Point({ static_cast<double>(x), static_cast<double>(y), 0 });
        std::array<int, 3> v;
        bool inside = true;
        for (int a = 0; a < 3; ++a)
        {
          v[a] = static_cast<int>(std::floor((p[a] - grid.Origin[a]) / grid.Spacing[a] + 0.5));
          inside &= v[a] >= 0 && v[a] < grid.Dimensions[a];
        }
        if (inside)
        {
          const std::size_t n =
            (static_cast<std::size_t>(v[2]) * grid.Dimensions[1] + v[1]) * grid.Dimensions[0] +
            v[0];
          const double grey =
            static_cast<const std::uint8_t*>(slice.Pixels)[y * slice.RowStride + x];
          sum[n] += grey;
          largest[n] = std::max(largest[n], grey);
          ++count[n];
        }
      }
    }
  }
  SweptVolume::Options options;
  options.Interpolation = SweptVolume::Method::NearestVoxel;
  const auto mean = Reconstruct<float>(sweep.Slices, grid, GetExtent(grid), options, 2);
  options.Compound = Compounding::Maximum;
  const auto maximum = Reconstruct<float>(sweep.Slices, grid, GetExtent(grid), options, 2);
  EXPECT_EQ(mean.Contributions, count);
  EXPECT_EQ(maximum.Contributions, count);
  for (std::size_t n = 0; n < count.size(); ++n)
  {
    EXPECT_FLOAT_EQ(mean.Intensity[n], count[n] ? static_cast<float>(sum[n] / count[n]) : 0.0F);
    EXPECT_EQ(maximum.Intensity[n], largest[n]);
  }
}

TEST(SweptVolumeBehaviour, TakesGreyLevelsOfAnyType)
{
  const auto reconstruct = [](auto zero, ScalarType type)
  {
    using T = decltype(zero);
    SyntheticSweep<T> sweep(9, 9, type);
    for (int n = 0; n < 3; ++n)
    {
      sweep.Add(Matrix4::Translation({ 0, 0, 1.5 * n }),
        [n](int x, int y) { return 10 + 3 * x + 2 * y + 5 * n; });
    }
    const VolumeGrid grid = MakeGrid(sweep.Slices, { 1, 1, 1 });
    std::vector<WrittenVolume<double>> volumes;
    for (SweptVolume::Options options : GetAllOptions())
    {
      options.DoublePrecision = NeedsDoublePrecision(type);
      volumes.push_back(Reconstruct<double>(sweep.Slices, grid, GetExtent(grid), options));
      options.DoublePrecision = true;
      const auto exact = Reconstruct<double>(sweep.Slices, grid, GetExtent(grid), options);
      for (std::size_t i = 0; i < exact.Intensity.size(); ++i)
      {
        EXPECT_NEAR(volumes.back().Intensity[i], exact.Intensity[i], 1e-5);
      }
    }
    return volumes;
  };
  const auto bytes = reconstruct(std::uint8_t(0), ScalarType::UInt8);
  for (const auto& volumes : { reconstruct(std::int8_t(0), ScalarType::Int8),
         reconstruct(std::int16_t(0), ScalarType::Int16),
         reconstruct(std::uint16_t(0), ScalarType::UInt16),
         reconstruct(std::int32_t(0), ScalarType::Int32),
         reconstruct(std::uint32_t(0), ScalarType::UInt32),
         reconstruct(std::int64_t(0), ScalarType::Int64),
         reconstruct(std::uint64_t(0), ScalarType::UInt64),
         reconstruct(float(0), ScalarType::Float32), reconstruct(double(0), ScalarType::Float64) })
  {
    for (std::size_t v = 0; v < bytes.size(); ++v)
    {
      EXPECT_EQ(volumes[v].Mask, bytes[v].Mask);
      for (std::size_t i = 0; i < bytes[v].Intensity.size(); ++i)
      {
        EXPECT_NEAR(volumes[v].Intensity[i], bytes[v].Intensity[i], 1e-5);
      }
    }
  }
}

TEST(SweptVolumeBehaviour, RoundsOnceAndStaysInTheRangeOfTheType)
{
  EXPECT_EQ(WriteOne<unsigned char>(41.49), 41);
  EXPECT_EQ(WriteOne<unsigned char>(41.5), 42);
  EXPECT_EQ(WriteOne<unsigned char>(255.6), 255);
  EXPECT_EQ(WriteOne<unsigned char>(-3), 0);
  EXPECT_EQ(WriteOne<short>(-41.5), -42);
  EXPECT_EQ(WriteOne<short>(-41.4), -41);
  EXPECT_EQ(WriteOne<short>(1e9), 32767);
  EXPECT_EQ(WriteOne<int>(-1e30), std::numeric_limits<int>::min());
  EXPECT_EQ(WriteOne<long long>(9.3e18), std::numeric_limits<long long>::max());
  EXPECT_EQ(WriteOne<long long>(4503599627370497.0), 4503599627370497LL);
  EXPECT_EQ(WriteOne<double>(0.1), 0.1);
  // what is not finite does not exist
  EXPECT_EQ(WriteOne<unsigned char>(std::nan(""), 0), 0);
  EXPECT_EQ(WriteOne<float>(std::nan(""), 0), 0);
  EXPECT_EQ(WriteOne<double>(std::numeric_limits<double>::infinity(), 0), 0);
  EXPECT_EQ(WriteOne<double>(1e300), 1e300);
  EXPECT_EQ(WriteOne<float>(1e300, 0), 0);
}

// A pixel that is not finite makes holes of the voxels that need it, and of no others.
TEST(SweptVolumeBehaviour, PixelsThatAreNotFiniteDoNotExist)
{
  for (const double bad : { std::nan(""), std::numeric_limits<double>::infinity() })
  {
    for (const int slice : { 0, 2, 4 })
    {
      const auto make = [&](double grey)
      {
        SyntheticSweep<float> sweep(21, 17, ScalarType::Float32);
        for (int n = 0; n < 5; ++n)
        {
          sweep.Add(Matrix4::Translation({ 0, 0, static_cast<double>(n) }),
            [&](int x, int y)
            { return n == slice && x == 10 && y == 8 ? grey : 100.0 + x + 3 * y + 20 * n; });
        }
        return sweep;
      };
      const auto sweep = make(bad);
      const auto good = make(50);
      for (const SweptVolume::Options& options : GetAllOptions())
      {
        const VolumeGrid grid = MakeGrid(sweep.Slices, { 1, 1, 0.5 });
        const auto volume = Reconstruct<float>(sweep.Slices, grid, GetExtent(grid), options);
        const auto other = Reconstruct<float>(good.Slices, grid, GetExtent(grid), options);
        int holes = 0;
        for (int k = 0; k < grid.Dimensions[2]; ++k)
        {
          for (int j = 0; j < grid.Dimensions[1]; ++j)
          {
            for (int i = 0; i < grid.Dimensions[0]; ++i)
            {
              const std::size_t v = i +
                static_cast<std::size_t>(grid.Dimensions[0]) *
                  (j + static_cast<std::size_t>(grid.Dimensions[1]) * k);
              if (volume.Mask[v] == other.Mask[v])
              {
                ASSERT_EQ(volume.Intensity[v], other.Intensity[v]);
                ASSERT_EQ(volume.Contributions[v], other.Contributions[v]);
                continue;
              }
              ++holes;
              ASSERT_EQ(volume.Intensity[v], 0);
              ASSERT_EQ(volume.Contributions[v], 0U);
              const double reach = 2 + 2 * options.FootprintScale;
              EXPECT_LE(std::abs(i - 10), reach);
              EXPECT_LE(std::abs(j - 8), reach);
              EXPECT_LE(std::abs(0.5 * k - slice), reach);
            }
          }
        }
        EXPECT_GT(holes, 0);
        EXPECT_EQ(volume.Faults, holes);
      }
    }
  }
}

// One voxel larger than all the world, at the corner of slices that lie 0.3 mm apart.
TEST(SweptVolumeBehaviour, VoxelsMayBeAbsurdlyLarge)
{
  SyntheticSweep<std::uint8_t> sweep(21, 11, ScalarType::UInt8);
  for (int n = 0; n < 3; ++n)
  {
    sweep.Add(Matrix4::Translation({ 5, 6, 0.3 * n }) * Matrix4::Scaling({ 0.2, 0.2, 1 }),
      [](int, int) { return 77; });
  }
  for (const double spacing : { 100.0, 1e7, 1e12, 1e300 })
  {
    const VolumeGrid grid = MakeGrid(sweep.Slices, { spacing, spacing, spacing });
    ASSERT_EQ(grid.Dimensions, (std::array<int, 3>{ 1, 1, 1 }));
    for (const SweptVolume::Options& options : GetAllOptions())
    {
      ThreadExecution execution(1);
      SweptVolume volume(grid, GetExtent(grid), options);
      volume.AddSlices(sweep.Slices, execution);
      EXPECT_EQ(volume.GetPairCounts().Coincident, 0) << spacing;
      const auto written = Write<float>(volume, GetExtent(grid));
      ASSERT_GT(written.Contributions[0], 0U) << spacing;
      EXPECT_NEAR(written.Intensity[0], 77, 1e-4) << spacing;
    }
  }
}

TEST(SweptVolumeBehaviour, RefusesVoxelsOfMorePixelsThanNumbersCanSay)
{
  SyntheticSweep<std::uint8_t> sweep(21, 11, ScalarType::UInt8);
  for (int n = 0; n < 3; ++n)
  {
    sweep.Add(Matrix4::Translation({ 5, 6, 0.3 * n }) * Matrix4::Scaling({ 0.2, 0.2, 1 }),
      [](int, int) { return 77; });
  }
  const double largest = std::numeric_limits<double>::max();
  for (const auto& spacing : { lacuna::Vec3{ largest, 1, 1 }, { 1, largest, 1 } })
  {
    const VolumeGrid grid = MakeGrid(sweep.Slices, spacing);
    for (SweptVolume::Options options : GetAllOptions())
    {
      if (options.Interpolation == SweptVolume::Method::NearestVoxel)
      {
        continue; // which counts voxels, not pixels
      }
      ThreadExecution execution(1);
      SweptVolume volume(grid, GetExtent(grid), options);
      EXPECT_THROW(volume.AddSlices(sweep.Slices, execution), std::invalid_argument);
    }
  }
}

TEST(SweptVolumeBehaviour, RefusesUnusableSlicesByName)
{
  const auto sweep = MakeSpeckleSweep(3, 1);
  const auto withPose = [&](const Matrix4& pose)
  {
    std::vector<SliceImage> slices = sweep.Slices;
    slices[1].PixelToReference = pose;
    return GetError(slices);
  };
  Matrix4 pose;
  pose(1, 2) = std::nan("");
  EXPECT_EQ(withPose(pose).find("slice 1: its pose has elements that are not finite"), 0U);
  pose = Matrix4::Scaling({ 0, 1, 1 });
  EXPECT_EQ(
    withPose(pose).find("slice 1: its pose is singular, the pixel spacing along columns is 0 mm"),
    0U)
    << withPose(pose);
  pose = Matrix4::Scaling({ 1, 0, 1 });
  EXPECT_NE(withPose(pose).find("along rows is 0 mm"), std::string::npos) << withPose(pose);
  pose = Matrix4::FromColumns({ 1, 2, 3 }, { 2, 4, 6 }, { 0, 0, 1 }, { 0, 0, 0 });
  EXPECT_NE(withPose(pose).find("rows and columns are parallel"), std::string::npos);
  pose = {};
  pose(3, 0) = 0.5;
  EXPECT_NE(withPose(pose).find("not affine"), std::string::npos);
  // the third column is not used
  EXPECT_EQ(withPose(Matrix4::Scaling({ 1, 1, 0 })), "no error");

  std::vector<SliceImage> slices = sweep.Slices;
  slices[2].Width = 1;
  EXPECT_NE(GetError(slices).find("slice 2 has 1 x 49 usable pixels"), std::string::npos);
  slices = sweep.Slices;
  slices[2].Type = ScalarType::Int8;
  EXPECT_NE(
    GetError(slices).find("slice 2: its grey levels are of another type"), std::string::npos);
  slices = sweep.Slices;
  for (SliceImage& slice : slices)
  {
    slice.Type = ScalarType::Int32;
  }
  EXPECT_NE(GetError(slices).find("double precision"), std::string::npos);
}

TEST(SweptVolumeBehaviour, RefusesAnExtentOutsideOfTheGridAndAFootprintOfNoSize)
{
  const VolumeGrid grid{ { 0, 0, 0 }, { 1, 1, 1 }, { 4, 4, 4 } };
  EXPECT_THROW(SweptVolume(grid, { 0, 4, 0, 3, 0, 3 }, {}), std::invalid_argument);
  EXPECT_THROW(SweptVolume(grid, { 0, 3, -1, 3, 0, 3 }, {}), std::invalid_argument);
  EXPECT_THROW(SweptVolume(grid, { 0, 3, 0, 3, 2, 1 }, {}), std::invalid_argument);
  for (const double scale : { 0.0, -1.0, std::nan(""), HUGE_VAL })
  {
    SweptVolume::Options options;
    options.FootprintScale = scale;
    EXPECT_THROW(SweptVolume(grid, { 0, 3, 0, 3, 0, 3 }, options), std::invalid_argument);
  }
}

TEST(SweptVolumeBehaviour, CanBeStopped)
{
  const auto sweep = MakeSpeckleSweep(40, 1);
  const VolumeGrid grid = MakeGrid(sweep.Slices, { 0.3, 0.3, 0.3 });
  double latest = 0;
  ThreadExecution execution(2,
    [&](double progress)
    {
      EXPECT_GE(progress, latest);
      EXPECT_LE(progress, 1);
      latest = progress;
      return progress < 0.5;
    });
  SweptVolume volume(grid, GetExtent(grid), {});
  EXPECT_THROW(volume.AddSlices(sweep.Slices, execution), Aborted);
  EXPECT_LT(latest, 0.9);
}
