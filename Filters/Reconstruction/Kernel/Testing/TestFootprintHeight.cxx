// SPDX-License-Identifier: BSD-3-Clause
/// Footprints of any scale, and such that reach across slices.
#include "lacunaSyntheticSweep.h"

#include <gtest/gtest.h>

#include <algorithm>

using namespace lacuna;

namespace
{
SweptVolume::Options MakeOptions(double scale, bool acrossSlices, bool doublePrecision = false)
{
  SweptVolume::Options options;
  options.FootprintScale = scale;
  options.FootprintAcrossSlices = acrossSlices;
  options.DoublePrecision = doublePrecision;
  return options;
}

// Grey levels linear in column and row, of another slope on each slice: footprints of any width
// have the grey level of their middle, also where the raster goes on.
double GetGrey(std::size_t slice, double column, double row)
{
  const auto n = static_cast<double>(slice);
  return 50 + 40 * std::sin(2.1 * n) + 0.9 * std::cos(n) * column + 0.7 * std::sin(3 * n) * row;
}

// (column, row, mm) of the foot of p on a slice.
Vec3 GetFoot(const SliceImage& slice, const Vec3& p)
{
  const Vec3 x = slice.PixelToReference.Column(0);
  const Vec3 y = slice.PixelToReference.Column(1);
  return Matrix4::FromColumns(x, y, Normalized(Cross(x, y)), slice.PixelToReference.Column(3))
    .Inverse()
    .Point(p);
}

struct Integral
{
  double Sum = 0;
  double Length = 0;
  int Pairs = 0;            ///< between which the centre lies
  bool IsDoubtful = false;  ///< rounding decides about a pair
  bool MeetsSlices = false; ///< both feet lie on the images, for some pair
};

// The grey levels over the height of a voxel, step by step.
Integral Integrate(const std::vector<SliceImage>& slices, const VolumeGrid& grid, const Vec3& p,
  double scale, double maximumGap)
{
  Integral result;
  for (std::size_t s = 0; s + 1 < slices.size(); ++s)
  {
    bool isInside = true;
    std::array<double, 2> distance;
    std::array<double, 2> grey;
    double height = 0;
    for (std::size_t i = 0; i < 2; ++i)
    {
      const SliceImage& slice = slices[s + i];
      const Vec3 foot = GetFoot(slice, p);
      std::array<double, 3> width{};
      for (int a = 0; a < 3; ++a)
      {
        Vec3 q = p;
        q[a] += grid.Spacing[a];
        for (int b = 0; b < 3; ++b)
        {
          width[b] += (GetFoot(slice, q)[b] - foot[b]) * (GetFoot(slice, q)[b] - foot[b]);
        }
      }
      for (int b = 0; b < 2; ++b)
      {
        const double size = b == 0 ? slice.Width : slice.Height;
        const double margin = 0.5 + 0.5 * std::sqrt(width[b]);
        isInside &= foot[b] >= -margin && foot[b] <= size - 1 + margin;
        result.IsDoubtful |=
          std::abs(foot[b] + margin) < 1e-5 || std::abs(size - 1 + margin - foot[b]) < 1e-5;
      }
      height = i == 0 ? scale * std::sqrt(width[2]) : height;
      distance[i] = foot[2];
      grey[i] = GetGrey(s + i, foot[0], foot[1]);
      result.IsDoubtful |= std::abs(foot[2]) < 1e-5;
    }
    const double gap = std::abs(distance[0] - distance[1]);
    result.IsDoubtful |= gap < 1e-3 || std::abs(gap - maximumGap) < 1e-5;
    if (!isInside || (maximumGap > 0 && gap > maximumGap))
    {
      continue;
    }
    result.Pairs += distance[0] * distance[1] <= 0 ? 1 : 0;
    constexpr int steps = 4000;
    for (int n = 0; n < steps; ++n)
    {
      const double t = height * ((n + 0.5) / steps - 0.5);
      const double a = distance[0] + t;
      const double b = distance[1] + t;
      if (a * b <= 0)
      {
        result.Sum += (a * grey[1] - b * grey[0]) / (a - b) * height / steps;
        result.Length += height / steps;
      }
    }
  }
  return result;
}
}

TEST(FootprintHeight, AveragesWhatIsInterpolatedAlongTheNormal)
{
  for (unsigned int seed = 0; seed < 4; ++seed)
  {
    SyntheticSweep<double> sweep(31, 25, ScalarType::Float64);
    for (const Matrix4& pose : MakeRandomPoses(8, seed, 0.06 * seed))
    {
      const std::size_t n = sweep.Slices.size();
      sweep.Add(pose, [n](int x, int y) { return GetGrey(n, x, y); });
    }
    const VolumeGrid grid = MakeGrid(sweep.Slices, { 0.9, 0.8, 1.0 });
    for (const double scale : { 0.7, 1.0, 2.5 })
    {
      SweptVolume::Options options = MakeOptions(scale, true, true);
      options.MaximumSliceGap = seed == 3 ? 1.1 : 0;
      const auto volume = Reconstruct<double>(sweep.Slices, grid, GetExtent(grid), options, 2);
      int filled = 0;
      std::size_t n = 0;
      for (int k = 0; k < grid.Dimensions[2]; ++k)
      {
        for (int j = 0; j < grid.Dimensions[1]; ++j)
        {
          for (int i = 0; i < grid.Dimensions[0]; ++i, ++n)
          {
            const Integral expected = Integrate(
              sweep.Slices, grid, GetPoint(grid, i, j, k), scale, options.MaximumSliceGap);
            if (expected.IsDoubtful)
            {
              continue;
            }
            EXPECT_EQ(volume.Contributions[n], static_cast<unsigned int>(expected.Pairs));
            if (expected.Pairs > 0)
            {
              ++filled;
              // a step more or less at each of the slices
              EXPECT_NEAR(volume.Intensity[n], expected.Sum / expected.Length, 0.15)
                << i << " " << j << " " << k;
            }
          }
        }
      }
      EXPECT_GT(filled, 100);
    }
  }
}

TEST(FootprintHeight, FillsTheSameVoxels)
{
  for (unsigned int seed = 0; seed < 5; ++seed)
  {
    SyntheticSweep<std::uint8_t> sweep(31, 25, ScalarType::UInt8);
    for (const Matrix4& pose : MakeRandomPoses(9, seed, 0.1 * seed))
    {
      sweep.Add(pose, [](int, int) { return 90; });
    }
    const VolumeGrid grid = MakeGrid(sweep.Slices, { 0.5, 0.4, 0.45 });
    const auto plain =
      Reconstruct<float>(sweep.Slices, grid, GetExtent(grid), MakeOptions(1, false), 2);
    for (const double scale : { 0.5, 1.0, 3.0 })
    {
      for (const bool acrossSlices : { false, true })
      {
        const auto volume = Reconstruct<float>(
          sweep.Slices, grid, GetExtent(grid), MakeOptions(scale, acrossSlices), 2);
        EXPECT_EQ(volume.Contributions, plain.Contributions) << scale;
        for (std::size_t n = 0; n < volume.Mask.size(); ++n)
        {
          EXPECT_NEAR(volume.Intensity[n], volume.Mask[n] ? 90 : 0, 1e-4);
        }
      }
    }
  }
}

TEST(FootprintHeight, IsFilledOnTheLineInWhichSlicesIntersect)
{
  SyntheticSweep<float> sweep(41, 21, ScalarType::Float32);
  const Matrix4 pixels = Matrix4::Scaling({ 0.5, 0.5, 1 }) * Matrix4::Translation({ -20, 0, 0 });
  sweep.Add(pixels, [](int, int) { return 10; });
  sweep.Add(Matrix4::Rotation({ 0, 1, 0 }, -0.5) * pixels, [](int, int) { return 30; });
  const VolumeGrid grid{ { 0, 2, 0 }, { 0.5, 0.5, 0.5 }, { 1, 5, 1 } };
  const auto volume = Reconstruct<float>(sweep.Slices, grid, GetExtent(grid), MakeOptions(1, true));
  for (int n = 0; n < 5; ++n)
  {
    EXPECT_EQ(volume.Contributions[n], 1U);
    EXPECT_FLOAT_EQ(volume.Intensity[n], 20);
  }
}

TEST(FootprintHeight, SeesAllOfManySlices)
{
  // ten slices per voxel, black and white in turn: two of them say nothing
  SyntheticSweep<std::uint8_t> sweep(9, 9, ScalarType::UInt8);
  for (int n = 0; n <= 50; ++n)
  {
    sweep.Add(Matrix4::Translation({ 0, 0, 0.1 * n }), [n](int, int) { return n % 2 * 200; });
  }
  VolumeGridRequest request;
  request.Spacing = { 1, 1, 1 };
  VolumeGrid grid = MakeVolumeGrid(sweep.Slices, request);
  grid.Origin[2] += 0.02;
  grid.Dimensions[2] = 5;
  const auto plain = Reconstruct<float>(sweep.Slices, grid, GetExtent(grid), MakeOptions(1, false));
  const auto across = Reconstruct<float>(sweep.Slices, grid, GetExtent(grid), MakeOptions(1, true));
  for (std::size_t n = 81; n < across.Mask.size(); ++n)
  {
    EXPECT_NEAR(plain.Intensity[n], 40, 1e-3);
    EXPECT_NEAR(across.Intensity[n], 100, 2);
  }
}

TEST(FootprintHeight, ScaleWidensTheFootprint)
{
  // stripes of five pixels, voxels of five pixels: a scale of two averages them out
  SyntheticSweep<std::uint8_t> sweep(101, 41, ScalarType::UInt8);
  for (int n = 0; n < 2; ++n)
  {
    sweep.Add(Matrix4::Translation({ 0, 0, 1.0 * n }) * Matrix4::Scaling({ 0.2, 0.2, 1 }),
      [](int x, int) { return x / 5 % 2 * 200; });
  }
  VolumeGrid grid = MakeGrid(sweep.Slices, { 1, 1, 1 });
  grid.Origin[0] += 0.4; // the middle of a stripe
  const auto getContrast = [&](double scale)
  {
    const auto volume =
      Reconstruct<float>(sweep.Slices, grid, GetExtent(grid), MakeOptions(scale, false));
    const auto middle = volume.Intensity.begin() + 4 * grid.Dimensions[0];
    const auto range = std::minmax_element(middle + 5, middle + 15);
    return *range.second - *range.first;
  };
  EXPECT_GT(getContrast(0.25), 199);
  EXPECT_GT(getContrast(1), 120);
  EXPECT_LT(getContrast(2), 30);
}

TEST(FootprintHeight, HasNoPartInMaximaAndSingleSamples)
{
  SyntheticSweep<std::uint8_t> sweep(31, 25, ScalarType::UInt8);
  std::mt19937 random(3);
  for (const Matrix4& pose : MakeRandomPoses(9, 3, 0.1))
  {
    sweep.Add(pose, [&](int, int) { return random() % 256; });
  }
  const VolumeGrid grid = MakeGrid(sweep.Slices, { 0.5, 0.4, 0.45 });
  std::vector<SweptVolume::Options> all(4);
  all[0].Compound = Compounding::Maximum;
  all[1].Sampling = PixelSampling::Bilinear;
  all[2].Sampling = PixelSampling::Nearest;
  all[3].Interpolation = SweptVolume::Method::NearestVoxel;
  for (SweptVolume::Options options : all)
  {
    const auto plain = Reconstruct<float>(sweep.Slices, grid, GetExtent(grid), options);
    options.FootprintAcrossSlices = true;
    EXPECT_TRUE(plain == Reconstruct<float>(sweep.Slices, grid, GetExtent(grid), options));
  }
}
