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

TEST(Contrast, ComparesLargeIntegersExactly)
{
  // 2^53 + 1 is no double: as one it would reach 2^53 + 2, or 2^53 would reach it.
  const std::int64_t odd = (std::int64_t(1) << 53) + 1;
  Image<std::int64_t> image(5, 1, 1);
  image.Samples = { odd - 1, 0, odd, 0, odd + 1 };
  lacuna::ThreadExecution execution(1);
  const auto count = [&](double isoValue)
  { return lacuna::CountThresholdedRegions<std::int64_t>(image.View(), isoValue, execution); };
  EXPECT_EQ(count(9007199254740992.0), 3);
  EXPECT_EQ(count(9007199254740994.0), 1);
  EXPECT_EQ(count(-1e300), 1);
  EXPECT_EQ(count(9223372036854775808.0), 0);
  image.Samples[0] = std::numeric_limits<std::int64_t>::max();
  EXPECT_EQ(count(9223372036854774784.0), 1); // the greatest double below 2^63
  EXPECT_EQ(count(std::numeric_limits<double>::infinity()), 0);
  EXPECT_THROW(count(std::nan("")), std::invalid_argument);
  Image<std::uint8_t> bytes(3, 1, 1);
  bytes.Samples = { 255, 0, 255 };
  EXPECT_EQ(lacuna::CountThresholdedRegions<std::uint8_t>(bytes.View(), 254.5, execution), 2);
  EXPECT_EQ(lacuna::CountThresholdedRegions<std::uint8_t>(bytes.View(), 255.5, execution), 0);
}

TEST(Contrast, MarksRegionsByMasksAndBounds)
{
  const lacuna::Extent box{ -3, 4, 2, 6, 10, 12 };
  const std::int64_t n = lacuna::NumberOfSamples(box);
  std::vector<float> floats(n);
  std::vector<std::int64_t> longs(n);
  for (std::int64_t i = 0; i < n; ++i)
  {
    floats[i] = i % 3 == 0 ? 0.0f : i % 3 == 1 ? std::nanf("") : -0.25f;
    longs[i] = i % 2 == 0 ? std::int64_t(1) << 40 : 0;
  }
  // An image that is turned: x runs along world y, y along world -x.
  const lacuna::Matrix4 turned =
    lacuna::Matrix4::FromColumns({ 0, 0.1, 0 }, { -0.1, 0, 0 }, { 0, 0, 2 }, { 5, 0.3, -1 });
  lacuna::RegionRule rule;
  rule.Masks = { { lacuna::ScalarType::Float32, floats.data() },
    { lacuna::ScalarType::Int64, longs.data() } };
  rule.Bounds = { 4.4, 4.7, 0.1, 0.3, 19, 21 };
  for (const int threads : { 1, 2, 5 })
  {
    lacuna::ThreadExecution execution(threads);
    std::vector<std::uint8_t> regions(n, lacuna::NoRegion);
    regions[17] = lacuna::InsideRegion;
    lacuna::MarkRegion(box, turned, rule, lacuna::OutsideRegion, regions.data(), execution);
    std::int64_t i = 0;
    int marked = 0;
    for (int z = box[4]; z <= box[5]; ++z)
    {
      for (int y = box[2]; y <= box[3]; ++y)
      {
        for (int x = box[0]; x <= box[1]; ++x, ++i)
        {
          // 5 - 0.1 y in 4.4 ... 4.7, 0.3 + 0.1 x in 0.1 ... 0.3, 2 z - 1 in 19 ... 21
          const bool in = y >= 3 && y <= 6 && x >= -2 && x <= 0 && z >= 10 && z <= 11;
          const bool masked = floats[i] == -0.25f && longs[i] != 0;
          const int expected = i == 17 ? lacuna::InsideRegion
            : in && masked             ? lacuna::OutsideRegion
                                       : lacuna::NoRegion;
          EXPECT_EQ(regions[i], expected) << x << " " << y << " " << z;
          marked += regions[i] == lacuna::OutsideRegion;
        }
      }
    }
    EXPECT_GE(marked, 3);
  }
}

TEST(Contrast, ARuleOfNothingHoldsEverything)
{
  std::vector<std::uint8_t> regions(12, lacuna::NoRegion);
  lacuna::ThreadExecution execution(1);
  lacuna::MarkRegion({ 0, 3, 0, 2, 0, 0 }, {}, {}, lacuna::InsideRegion, regions.data(), execution);
  EXPECT_EQ(regions, std::vector<std::uint8_t>(12, lacuna::InsideRegion));
}
