// SPDX-License-Identifier: BSD-3-Clause
#include "SpeckleOracle.h"
#include "lacunaLinearFilters.h"

#include <gtest/gtest.h>

using lacuna::Deviations;
using lacuna::VectorUnit;
using lacuna::Window;
using lacuna::WindowShape;
using oracle::Image;

namespace
{
/// Weighted mean of the numbers in reach, in long double.
template <class T>
std::vector<long double> Convolve(
  const Image<T>& image, const std::array<std::vector<double>, 3>& weights)
{
  std::vector<long double> result;
  std::array<int, 3> r;
  for (int a = 0; a < 3; ++a)
  {
    r[a] = static_cast<int>(weights[a].size() / 2);
  }
  for (int z = image.Box[4]; z <= image.Box[5]; ++z)
  {
    for (int y = image.Box[2]; y <= image.Box[3]; ++y)
    {
      for (int x = image.Box[0]; x <= image.Box[1]; ++x)
      {
        long double sum = 0;
        long double total = 0;
        for (int c = -r[2]; c <= r[2]; ++c)
        {
          for (int b = -r[1]; b <= r[1]; ++b)
          {
            for (int a = -r[0]; a <= r[0]; ++a)
            {
              const long double w = static_cast<long double>(weights[0][a + r[0]]) *
                weights[1][b + r[1]] * weights[2][c + r[2]];
              const T value = image.Nearest(x + a, y + b, z + c);
              if (value == value)
              {
                sum += w * value;
                total += w;
              }
            }
          }
        }
        result.push_back(std::is_floating_point_v<T> ? sum / total : sum);
      }
    }
  }
  return result;
}

std::array<std::vector<double>, 3> Gaussians(const Deviations& deviations)
{
  const lacuna::Reach reach = lacuna::GaussianReach(deviations);
  std::array<std::vector<double>, 3> weights;
  for (int a = 0; a < 3; ++a)
  {
    weights[a] = lacuna::GaussianWeights(deviations[a], reach.Lower[a]);
  }
  return weights;
}

template <class T>
Image<T> Mean(const Image<T>& image, const Window& window, VectorUnit set, int threads = 2)
{
  Image<T> result(image.Box);
  lacuna::ThreadExecution execution(threads);
  lacuna::FilterMean<T>(image.View(), result.View(), window, set, execution);
  return result;
}

template <class T>
Image<T> Gaussian(
  const Image<T>& image, const Deviations& deviations, VectorUnit set, int threads = 2)
{
  Image<T> result(image.Box);
  lacuna::ThreadExecution execution(threads);
  lacuna::FilterGaussian<T>(image.View(), result.View(), deviations, set, execution);
  return result;
}
}

template <class T>
class LinearFilterTest : public testing::Test
{
};
TYPED_TEST_SUITE(LinearFilterTest, oracle::AllTypes);

// Exactly: a long double holds the sums of up to 64 samples of 58 bits.
TYPED_TEST(LinearFilterTest, MeanEqualsItsDefinition)
{
  using T = TypeParam;
  Image<T> image = oracle::Random<T>(71, 9, 5, 1);
  for (T& sample : image.Samples)
  {
    sample = sizeof(T) == 8 ? sample / 64 : sample;
  }
  for (const std::array<int, 3>& size : std::vector<std::array<int, 3>>{
         { 1, 1, 1 }, { 3, 3, 1 }, { 2, 2, 1 }, { 5, 4, 3 }, { 1, 1, 4 }, { 7, 1, 1 } })
  {
    const Window window(size, WindowShape::Box);
    const Image<T> truth = oracle::Filter(image, window,
      [](const auto& samples, T)
      {
        long double sum = 0;
        for (const auto& s : samples)
        {
          sum += s.Value;
        }
        const long double mean = sum / samples.size();
        return static_cast<T>(std::is_floating_point_v<T> ? mean : std::floor(mean + 0.5L));
      });
    Image<T> first(0, 0, 0);
    for (const VectorUnit set : oracle::VectorUnits())
    {
      const Image<T> result = Mean(image, window, set);
      if (std::is_same_v<T, double>)
      {
        for (std::size_t i = 0; i < result.Samples.size(); ++i)
        {
          EXPECT_NEAR(result.Samples[i], truth.Samples[i], 1e-15 * 20);
        }
      }
      else
      {
        EXPECT_EQ(oracle::Differences(result, truth), 0u) << size[0] << size[1] << size[2];
      }
      if (first.Samples.empty())
      {
        first.Samples = result.Samples;
      }
      EXPECT_EQ(first.Samples, result.Samples) << "set " << int(set);
    }
  }
}

TEST(LinearFilters, MeanRoundsHalvesUp)
{
  Image<std::int16_t> image(2, 1, 1);
  const Window pair({ 2, 1, 1 }, WindowShape::Box); // the sample and the one before it
  image.Samples = { -3, -2 };
  EXPECT_EQ(Mean(image, pair, VectorUnit::Baseline).Samples[1], -2);
  image.Samples = { 2, 3 };
  EXPECT_EQ(Mean(image, pair, VectorUnit::Baseline).Samples[1], 3);
}

TEST(LinearFilters, MeanOfExtremeValuesDoesNotOverflow)
{
  const Window large({ 255, 255, 255 }, WindowShape::Box);
  Image<std::uint8_t> bytes(3, 2, 2);
  std::fill(bytes.Samples.begin(), bytes.Samples.end(), std::uint8_t(255));
  EXPECT_EQ(Mean(bytes, large, lacuna::BestVectorUnit()).Samples, bytes.Samples);
  Image<std::int64_t> longs(2, 2, 2);
  for (const std::int64_t value :
    { std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max() })
  {
    std::fill(longs.Samples.begin(), longs.Samples.end(), value);
    EXPECT_EQ(Mean(longs, Window({ 9, 9, 9 }, WindowShape::Box), lacuna::BestVectorUnit()).Samples,
      longs.Samples);
  }
}

TEST(LinearFilters, MeanForgetsLargeSamplesBeyondTheirWindows)
{
  Image<float> image(60, 1, 1);
  std::fill(image.Samples.begin(), image.Samples.end(), 0.25f);
  image.Samples[10] = 1e30f;
  image.Samples[20] = std::numeric_limits<float>::infinity();
  image.Samples[30] = std::nanf("");
  const auto result = Mean(image, Window({ 5, 1, 1 }, WindowShape::Box), VectorUnit::Baseline);
  for (int i = 0; i < 60; ++i)
  {
    const bool far = std::abs(i - 10) > 2 && std::abs(i - 20) > 2;
    if (far && i != 30)
    {
      EXPECT_EQ(result.Samples[i], 0.25f) << i;
    }
  }
  EXPECT_TRUE(std::isnan(result.Samples[30]));
  EXPECT_TRUE(std::isinf(result.Samples[22]));
}

TYPED_TEST(LinearFilterTest, GaussianEqualsItsDefinition)
{
  using T = TypeParam;
  Image<T> image = oracle::Random<T>(37, 11, 7, 2);
  double size = 0;
  for (T& sample : image.Samples)
  {
    sample = sizeof(T) == 8 && std::is_integral_v<T> ? sample / 65536 : sample;
    size = std::max(size, std::abs(static_cast<double>(sample)));
  }
  const double rounding = std::is_floating_point_v<T> ? 0 : 0.5;
  const double epsilon = std::numeric_limits<lacuna::LinearType<T>>::epsilon();
  for (const Deviations& deviations : std::vector<Deviations>{
         { 1.4142, 1.4142, 0 }, { 0.8, 2, 0.7 }, { 0, 0, 1.1 }, { 0.05, 1, 0 } })
  {
    const std::vector<long double> truth = Convolve(image, Gaussians(deviations));
    Image<T> first(0, 0, 0);
    for (const VectorUnit set : oracle::VectorUnits())
    {
      const Image<T> result = Gaussian(image, deviations, set);
      for (std::size_t i = 0; i < truth.size(); ++i)
      {
        ASSERT_NEAR(
          static_cast<double>(result.Samples[i]), truth[i], rounding + 16 * epsilon * size);
      }
      if (first.Samples.empty())
      {
        first.Samples = result.Samples;
      }
      EXPECT_EQ(first.Samples, result.Samples) << "set " << int(set);
    }
  }
}

TEST(LinearFilters, GaussianLeavesNaNOutAndInPlace)
{
  Image<double> image = oracle::Random<double>(33, 12, 4, 3);
  const Image<double> whole = image;
  oracle::SprinkleNaN(image, 9);
  const Deviations deviations{ 1.2, 0.9, 0.6 };
  const std::vector<long double> truth = Convolve(image, Gaussians(deviations));
  const Image<double> result = Gaussian(image, deviations, lacuna::BestVectorUnit());
  for (std::size_t i = 0; i < truth.size(); ++i)
  {
    if (std::isnan(image.Samples[i]))
    {
      EXPECT_TRUE(std::isnan(result.Samples[i]));
    }
    else
    {
      EXPECT_NEAR(result.Samples[i], truth[i], 1e-14 * 20);
    }
  }
  // A NaN changes nothing out of its reach, not even a last digit.
  Image<double> one = whole;
  one.Samples[0] = std::nan("");
  const auto without = Gaussian(whole, deviations, lacuna::BestVectorUnit());
  const auto with = Gaussian(one, deviations, lacuna::BestVectorUnit());
  for (int x = 6; x < 33; ++x)
  {
    EXPECT_EQ(with.At(x, 7, 3), without.At(x, 7, 3));
  }
}

TEST(LinearFilters, GaussianKeepsConstantsAndTypeLimits)
{
  for (const std::uint64_t value : { std::uint64_t(7), std::numeric_limits<std::uint64_t>::max() })
  {
    Image<std::uint64_t> image(9, 9, 1);
    std::fill(image.Samples.begin(), image.Samples.end(), value);
    EXPECT_EQ(Gaussian(image, { 2, 2, 0 }, lacuna::BestVectorUnit()).Samples, image.Samples);
  }
}

TEST(LinearFilters, SecondDerivativeWeightsAreExactOnQuadratics)
{
  for (const double deviation : { 1e-200, 0.02, 0.15, 0.3, 0.7, 1.0, 1.4142, 5.0 })
  {
    const int radius = lacuna::LaplacianReach({ deviation, 0, 0 }).Lower[0];
    const std::vector<double> w = lacuna::SecondDerivativeWeights(deviation, radius);
    double zeroth = 0, second = 0;
    for (int i = -radius; i <= radius; ++i)
    {
      zeroth += w[i + radius];
      second += w[i + radius] * i * i;
    }
    EXPECT_NEAR(zeroth, 0, 1e-14);
    EXPECT_NEAR(second, 2, 1e-12);
  }
}

TEST(LinearFilters, NarrowGaussiansAreImpulsesAndTheirLaplaciansSecondDifferences)
{
  // As along the slices of a stack whose distance is many standard deviations.
  for (const double deviation : { 1e-200, 1e-8, 0.02, 0.04 })
  {
    const std::vector<double> g = lacuna::GaussianWeights(deviation, 2);
    EXPECT_EQ(g, (std::vector<double>{ 0, g[1], 1, g[1], 0 }));
    EXPECT_LT(g[1], 1e-80);
    const std::vector<double> w = lacuna::SecondDerivativeWeights(deviation, 2);
    EXPECT_NEAR(w[0], 0, 1e-80);
    EXPECT_DOUBLE_EQ(w[1], 1);
    EXPECT_DOUBLE_EQ(w[2], -2);
    EXPECT_DOUBLE_EQ(w[3], 1);
  }
}

TEST(LinearFilters, LaplacianOfAQuadraticInMillimetres)
{
  // f = x^2 + 3 y^2 - z^2/2 + x y + 5 z in mm has the Laplacian 2 + 6 - 1 = 7 everywhere.
  const std::array<double, 3> spacing{ 0.5, 0.25, 2 };
  Image<double> image(45, 61, 21);
  for (int k = 0; k < 21; ++k)
  {
    for (int j = 0; j < 61; ++j)
    {
      for (int i = 0; i < 45; ++i)
      {
        const double x = i * spacing[0], y = j * spacing[1], z = k * spacing[2];
        *image.View().At(i, j, k) = x * x + 3 * y * y - z * z / 2 + x * y + 5 * z;
      }
    }
  }
  Image<double> result(image.Box);
  lacuna::ThreadExecution execution(2);
  const Deviations deviations{ 1 / 0.5, 1 / 0.25, 1 / 2.0 };
  lacuna::FilterLaplacianOfGaussian<double>(
    image.View(), result.View(), deviations, spacing, lacuna::BestVectorUnit(), execution);
  EXPECT_NEAR(result.At(22, 30, 10), 7, 1e-9);
  EXPECT_NEAR(result.At(25, 27, 12), 7, 1e-9);
}

TEST(LinearFilters, LaplacianVanishesOnConstantsAndChangesSignAtAnEdge)
{
  Image<std::uint8_t> image(41, 9, 1);
  for (int y = 0; y < 9; ++y)
  {
    for (int x = 0; x < 41; ++x)
    {
      *image.View().At(x, y, 0) = x < 20 ? 20 : 220;
    }
  }
  Image<float> result(image.Box);
  lacuna::ThreadExecution execution(1);
  lacuna::FilterLaplacianOfGaussian<std::uint8_t>(
    image.View(), result.View(), { 1.5, 1.5, 0 }, { 1, 1, 1 }, lacuna::BestVectorUnit(), execution);
  EXPECT_NEAR(result.At(2, 4, 0), 0, 1e-4);
  EXPECT_NEAR(result.At(38, 4, 0), 0, 1e-4);
  EXPECT_GT(result.At(19, 4, 0), 5);
  EXPECT_NEAR(result.At(20, 4, 0), -result.At(19, 4, 0), 1e-3);
}

TEST(LinearFilters, ReachNoFurtherThanTheIntegers)
{
  constexpr int least = std::numeric_limits<int>::min();
  constexpr int greatest = std::numeric_limits<int>::max();
  const lacuna::Extent box{ least, 9, least + 1, greatest, 3, greatest - 1 };
  EXPECT_EQ(lacuna::GaussianReach({ 1, 1, 0.5 }).Grow(box, true, true),
    (lacuna::Extent{ least, 13, least, greatest, 1, greatest }));
  EXPECT_EQ(lacuna::LaplacianReach({ 1, 0, 1 }).Grow(box, true, true),
    (lacuna::Extent{ least, 15, least + 1, greatest, -3, greatest }));
}

TEST(LinearFilters, RefusesDeviationsThatMakeNoSense)
{
  for (const double bad : { -1.0, 1e9, std::nan(""), std::numeric_limits<double>::infinity() })
  {
    EXPECT_THROW(lacuna::GaussianReach({ 1, bad, 0 }), std::invalid_argument);
  }
  const Image<float> image(3, 3, 1);
  Image<float> result(image.Box);
  lacuna::ThreadExecution execution(1);
  EXPECT_THROW(lacuna::FilterLaplacianOfGaussian<float>(image.View(), result.View(), { 0, 0, 0 },
                 { 1, 1, 1 }, VectorUnit::Baseline, execution),
    std::invalid_argument);
}
