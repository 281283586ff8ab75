// SPDX-License-Identifier: BSD-3-Clause
#include "SpeckleOracle.h"
#include "lacunaContrast.h"

#include <gtest/gtest.h>

using oracle::Image;

TEST(Contrast, MeasuresTwoRegions)
{
  Image<float> image(4, 2, 1);
  image.Samples = { 1, 3, 10, 20, std::nanf(""), 5, 30, 1000 };
  const std::vector<std::uint8_t> regions{ lacuna::InsideRegion, lacuna::InsideRegion,
    lacuna::OutsideRegion, lacuna::OutsideRegion, lacuna::InsideRegion, lacuna::InsideRegion,
    lacuna::OutsideRegion, lacuna::NoRegion };
  lacuna::ThreadExecution execution(2);
  const auto s = lacuna::MeasureRegions<float>(image.View(), regions.data(), execution);
  EXPECT_EQ(s[0].Count, 3);
  EXPECT_DOUBLE_EQ(s[0].Mean, 3);
  EXPECT_DOUBLE_EQ(s[0].Variance, 8.0 / 3);
  EXPECT_EQ(s[1].Count, 3);
  EXPECT_DOUBLE_EQ(s[1].Mean, 20);
  EXPECT_DOUBLE_EQ(s[1].Variance, 200.0 / 3);
  EXPECT_DOUBLE_EQ(s[1].SignalToNoise(), 20 / std::sqrt(200.0 / 3));
  EXPECT_DOUBLE_EQ(lacuna::ContrastToSpeckle(s[0], s[1]), 17 / std::sqrt(208.0 / 3));
}

TEST(Contrast, OfConstantRegions)
{
  lacuna::RegionStatistics a{ 5, 10, 0 };
  lacuna::RegionStatistics b{ 5, 20, 0 };
  EXPECT_EQ(lacuna::ContrastToSpeckle(a, a), 0);
  EXPECT_TRUE(std::isinf(lacuna::ContrastToSpeckle(a, b)));
}

TEST(Contrast, VarianceOfLargeAlikeValuesLosesNoDigits)
{
  Image<double> image(1000, 1, 1);
  for (int i = 0; i < 1000; ++i)
  {
    image.Samples[i] = 1e9 + i % 2;
  }
  const std::vector<std::uint8_t> regions(1000, lacuna::InsideRegion);
  lacuna::ThreadExecution execution(1);
  const auto s = lacuna::MeasureRegions<double>(image.View(), regions.data(), execution);
  EXPECT_DOUBLE_EQ(s[0].Variance, 0.25);
}

namespace
{
/// Flood fill.
template <class T>
std::int64_t CountSlowly(const Image<T>& image, double isoValue)
{
  std::vector<char> seen(image.Samples.size(), 0);
  const int n[3] = { lacuna::SizeOf(image.Box, 0), lacuna::SizeOf(image.Box, 1),
    lacuna::SizeOf(image.Box, 2) };
  std::int64_t regions = 0;
  for (std::size_t start = 0; start < seen.size(); ++start)
  {
    if (seen[start] || !(image.Samples[start] >= isoValue))
    {
      continue;
    }
    ++regions;
    std::vector<std::size_t> stack{ start };
    seen[start] = 1;
    while (!stack.empty())
    {
      const std::size_t at = stack.back();
      stack.pop_back();
      const int p[3] = { static_cast<int>(at % n[0]), static_cast<int>(at / n[0] % n[1]),
        static_cast<int>(at / n[0] / n[1]) };
      for (int side = 0; side < 6; ++side)
      {
        int q[3] = { p[0], p[1], p[2] };
        q[side / 2] += side % 2 ? 1 : -1;
        if (q[side / 2] < 0 || q[side / 2] >= n[side / 2])
        {
          continue;
        }
        const std::size_t to = (std::size_t(q[2]) * n[1] + q[1]) * n[0] + q[0];
        if (!seen[to] && image.Samples[to] >= isoValue)
        {
          seen[to] = 1;
          stack.push_back(to);
        }
      }
    }
  }
  return regions;
}
}

TEST(Contrast, CountsRegionsAsAFloodFillDoes)
{
  lacuna::ThreadExecution execution(1);
  for (const int depth : { 1, 5 })
  {
    for (unsigned seed = 1; seed < 6; ++seed)
    {
      const auto image = oracle::Random<std::uint8_t>(41, 23, depth, seed);
      for (const double isoValue : { -1.0, 60.0, 100.5, 150.0, 200.0, 256.0 })
      {
        EXPECT_EQ(lacuna::CountThresholdedRegions<std::uint8_t>(image.View(), isoValue, execution),
          CountSlowly(image, isoValue))
          << depth << " " << seed << " " << isoValue;
      }
    }
  }
}

TEST(Contrast, RegionsThatTouchAtACornerAreSeparate)
{
  Image<std::int16_t> image(3, 3, 1);
  image.Samples = { 1, 0, 1, 0, 1, 0, 1, 0, 1 };
  lacuna::ThreadExecution execution(1);
  EXPECT_EQ(lacuna::CountThresholdedRegions<std::int16_t>(image.View(), 1, execution), 5);
  image.Samples = { 1, 1, 1, 0, 0, 1, 1, 1, 1 }; // a U on its side
  EXPECT_EQ(lacuna::CountThresholdedRegions<std::int16_t>(image.View(), 1, execution), 1);
}
