// SPDX-License-Identifier: BSD-3-Clause
#include "SpeckleOracle.h"
#include "lacunaRankBlocks.h"
#include "lacunaRankFilter.h"
#include "lacunaSpeckleFilter.h"

#include <gtest/gtest.h>

using lacuna::VectorUnit;
using lacuna::Window;
using lacuna::WindowShape;
using oracle::Image;

namespace
{
template <class T>
Image<T> Filtered(const Image<T>& image, const Window& window, lacuna::RankParameters parameters,
  VectorUnit set, int threads = 2)
{
  parameters.Set = set;
  Image<T> result(image.Box);
  lacuna::ThreadExecution execution(threads);
  lacuna::FilterRank<T>(image.View(), result.View(), window, parameters, execution);
  return result;
}

template <class T>
void ExpectRanksAsDefined(const Image<T>& image, const Window& window)
{
  const std::string what = std::to_string(window.GetSize(0)) + "x" +
    std::to_string(window.GetSize(1)) + "x" + std::to_string(window.GetSize(2)) +
    (window.IsBox() ? " box" : " ellipsoid");
  lacuna::RankParameters mode;
  mode.Mode = true;
  const Image<T> trueMode = oracle::Mode(image, window);
  for (const VectorUnit set : oracle::VectorUnits())
  {
    EXPECT_EQ(oracle::Differences(Filtered(image, window, mode, set), trueMode), 0u)
      << "mode " << what << " set " << int(set);
  }
  for (const double percentile : { 50.0, 0.0, 23.0, 100.0 })
  {
    lacuna::RankParameters parameters;
    parameters.Percentile = percentile;
    const Image<T> truth = oracle::Rank(image, window, percentile);
    for (const VectorUnit set : oracle::VectorUnits())
    {
      EXPECT_EQ(oracle::Differences(Filtered(image, window, parameters, set), truth), 0u)
        << percentile << " % " << what << " set " << int(set);
    }
  }
}

const std::vector<std::array<int, 3>> Windows{ { 1, 1, 1 }, { 3, 1, 1 }, { 1, 5, 1 }, { 1, 1, 3 },
  { 3, 3, 1 }, { 5, 5, 1 }, { 3, 3, 3 }, { 2, 2, 1 }, { 4, 3, 2 }, { 5, 3, 7 }, { 11, 11, 1 },
  { 7, 7, 7 }, { 17, 17, 1 }, { 1, 1, 9 } };
}

template <class T>
class RankFilterTest : public testing::Test
{
};
TYPED_TEST_SUITE(RankFilterTest, oracle::AllTypes);

TYPED_TEST(RankFilterTest, EqualsItsDefinition)
{
  // The truncation limit of the oracle needs more digits than 64-bit integers' long double has to
  // spare: values of 62 bits are enough of a test.
  Image<TypeParam> image = oracle::Random<TypeParam>(21, 13, 6, 1);
  for (TypeParam& sample : image.Samples)
  {
    sample = sizeof(TypeParam) == 8 ? sample / 4 : sample;
  }
  for (const auto& size : Windows)
  {
    ExpectRanksAsDefined(image, Window(size, WindowShape::Box));
  }
  ExpectRanksAsDefined(image, Window({ 5, 5, 1 }, WindowShape::Ellipsoid));
  ExpectRanksAsDefined(image, Window({ 4, 5, 7 }, WindowShape::Ellipsoid));
}

TYPED_TEST(RankFilterTest, EqualsItsDefinitionWhereManySamplesAreEqual)
{
  const Image<TypeParam> image = oracle::Random<TypeParam>(19, 11, 5, 2, true);
  ExpectRanksAsDefined(image, Window({ 5, 5, 1 }, WindowShape::Box));
  ExpectRanksAsDefined(image, Window({ 6, 3, 3 }, WindowShape::Box));
  ExpectRanksAsDefined(image, Window({ 5, 3, 3 }, WindowShape::Ellipsoid));
}

// Blocks, their seams and the wider counters: larger images, fewer of them.
TYPED_TEST(RankFilterTest, EqualsItsDefinitionAcrossBlocks)
{
  lacuna::RankParameters median;
  const Image<TypeParam> flat = oracle::Random<TypeParam>(140, 70, 1, 3);
  for (const std::array<int, 3>& size :
    std::vector<std::array<int, 3>>{ { 5, 5, 1 }, { 9, 9, 1 }, { 16, 17, 1 } })
  {
    const Window window(size, WindowShape::Box);
    const Image<TypeParam> truth = oracle::Rank(flat, window, 50);
    for (const VectorUnit set : oracle::VectorUnits())
    {
      EXPECT_EQ(oracle::Differences(Filtered(flat, window, median, set), truth), 0u) << size[0];
    }
  }
  const Image<TypeParam> deep = oracle::Random<TypeParam>(37, 15, 35, 4);
  const Window window({ 7, 5, 8 }, WindowShape::Box);
  EXPECT_EQ(oracle::Differences(Filtered(deep, window, median, lacuna::BestVectorUnit()),
              oracle::Rank(deep, window, 50)),
    0u);
}

TEST(RankFilter, CountsWindowsLargerThanTheImage)
{
  for (const std::array<int, 3>& size : std::vector<std::array<int, 3>>{ { 255, 255, 1 },
         { 41, 41, 41 }, { 3, 101, 101 }, { 255, 3, 3 }, { 3, 255, 255 },
         // on both sides of the limits of the counters: 255 | 256 samples, 255 | 256 in a plane,
         // 65025 | 65536 samples
         { 15, 17, 1 }, { 16, 16, 1 }, { 3, 15, 17 }, { 3, 16, 16 }, { 64, 32, 32 } })
  {
    const Window window(size, WindowShape::Box);
    const Image<std::uint8_t> bytes = oracle::Random<std::uint8_t>(3, 3, 2, 6);
    const Image<float> floats = oracle::Random<float>(3, 3, 2, 6);
    for (const VectorUnit set : oracle::VectorUnits())
    {
      EXPECT_EQ(
        oracle::Differences(Filtered(bytes, window, {}, set, 1), oracle::Rank(bytes, window, 50)),
        0u)
        << size[0] << " " << size[1] << " " << size[2];
    }
    EXPECT_EQ(oracle::Differences(Filtered(floats, window, {}, lacuna::BestVectorUnit(), 1),
                oracle::Rank(floats, window, 50)),
      0u);
  }
}

// A block with its margin just fits the bytes that positions in it are kept in.
TEST(RankFilter, LongWindowsInLongImages)
{
  const Image<float> wide = oracle::Random<float>(300, 5, 2, 12);
  const Image<float> high = oracle::Random<float>(5, 300, 2, 13);
  const Image<float> deep = oracle::Random<float>(3, 2, 300, 14);
  for (const int length : { 130, 200, 254 })
  {
    for (const auto& [image, window] :
      { std::pair(wide, Window({ length, 3, 1 }, WindowShape::Box)),
        std::pair(high, Window({ 3, length, 1 }, WindowShape::Ellipsoid)),
        std::pair(deep, Window({ 2, 1, length }, WindowShape::Box)) })
    {
      EXPECT_EQ(oracle::Differences(Filtered(image, window, {}, lacuna::BestVectorUnit()),
                  oracle::Rank(image, window, 50)),
        0u)
        << length;
    }
  }
}

TEST(RankFilter, LeavesNaNOutAndInPlace)
{
  for (const unsigned one_in : { 2u, 20u })
  {
    Image<float> image = oracle::Random<float>(31, 17, 5, 7);
    oracle::SprinkleNaN(image, one_in);
    for (const std::array<int, 3>& size :
      std::vector<std::array<int, 3>>{ { 3, 3, 1 }, { 5, 5, 3 }, { 2, 3, 1 } })
    {
      ExpectRanksAsDefined(image, Window(size, WindowShape::Box));
      ExpectRanksAsDefined(image, Window(size, WindowShape::Ellipsoid));
    }
  }
  Image<double> nothing(5, 5, 1);
  std::fill(nothing.Samples.begin(), nothing.Samples.end(), std::nan(""));
  ExpectRanksAsDefined(nothing, Window({ 3, 3, 1 }, WindowShape::Box));
}

TEST(RankFilter, RanksInfinities)
{
  Image<double> image = oracle::Random<double>(17, 9, 3, 8);
  for (std::size_t i = 0; i < image.Samples.size(); i += 5)
  {
    image.Samples[i] = (i % 2 ? 1 : -1) * std::numeric_limits<double>::infinity();
  }
  const Window window({ 5, 3, 3 }, WindowShape::Box);
  EXPECT_EQ(oracle::Differences(Filtered(image, window, {}, lacuna::BestVectorUnit()),
              oracle::Rank(image, window, 50)),
    0u);
}

TEST(RankFilter, ModeFindsThePeakOfASkewedDistribution)
{
  // 0 1 1 1 2 2 5 9 9 in a row of nine: median 2, range 0 ... 9, truncated above 4: 0 1 1 1 2 2.
  Image<std::uint8_t> image(9, 1, 1);
  image.Samples = { 9, 1, 2, 5, 1, 0, 2, 1, 9 };
  lacuna::RankParameters mode;
  mode.Mode = true;
  const auto result =
    Filtered(image, Window({ 9, 1, 1 }, WindowShape::Box), mode, VectorUnit::Baseline);
  EXPECT_EQ(result.Samples[4], 1);
}

TEST(RankFilter, RefusesKernelsWithTooManySamples)
{
  const Image<float> image(3, 3, 3);
  EXPECT_THROW(
    Filtered(image, Window({ 255, 255, 255 }, WindowShape::Box), {}, VectorUnit::Baseline),
    std::invalid_argument);
}

TYPED_TEST(RankFilterTest, AdaptiveMedianEqualsItsDefinition)
{
  lacuna::ThreadExecution execution(2);
  for (const bool few : { false, true })
  {
    Image<TypeParam> image = oracle::Random<TypeParam>(70, 9, 4, 9, few);
    if constexpr (std::is_floating_point_v<TypeParam>)
    {
      oracle::SprinkleNaN(image, 30);
    }
    for (const double strength : { 0.0, 0.3, 10.0 })
    {
      for (const WindowShape shape : { WindowShape::Box, WindowShape::Ellipsoid })
      {
        const Window window({ 5, 4, 3 }, shape);
        Image<TypeParam> result(image.Box);
        lacuna::FilterAdaptiveMedian<TypeParam>(
          image.View(), result.View(), window, strength, execution);
        EXPECT_EQ(oracle::Differences(result, oracle::Adaptive(image, window, strength)), 0u)
          << strength;
        if (strength == 0)
        {
          EXPECT_EQ(oracle::Differences(result, oracle::Rank(image, window, 50)), 0u);
        }
      }
    }
  }
}

TEST(RankFilter, BlocksAreSmallWhereEachWindowCosts)
{
  for (const int width : { 3, 9, 31, 101 })
  {
    const Window window({ width, width, width }, WindowShape::Box);
    const std::array<int, 3> block = lacuna::ChooseExhaustiveBlock(window, 1);
    EXPECT_LE(window.GetNumberOfSamples() * block[0] * block[1] * block[2], 1 << 25);
    EXPECT_GE(std::min({ block[0], block[1], block[2] }), 2);
  }
}
