// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSampledSlice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

using lacuna::AverageFootprints;
using lacuna::ContinueRaster;
using lacuna::FootprintAxis;

namespace
{
constexpr int Pixels = 60;

double GetPosition(const FootprintAxis& axis, int sample)
{
  return sample * axis.GetStep();
}

// Weight of pixel q in the value that voxels find at x between the samples.
double GetTotalWeight(const FootprintAxis& axis, double x, int q)
{
  const double s = x / axis.GetStep();
  const int left = std::min(static_cast<int>(s), axis.GetNumberOfSamples() - 2);
  double weight = 0;
  for (int n = 0; n < 2; ++n)
  {
    const int t = q - axis.GetStart(left + n);
    if (t >= 0 && t < axis.GetNumberOfTaps())
    {
      weight += (n == 0 ? 1 - (s - left) : s - left) * axis.GetWeights(left + n)[t];
    }
  }
  return weight;
}
}

TEST(Footprint, NarrowOnesLeaveThePixels)
{
  for (const double width : { 0.0, 0.5, 1.0, 1.414 })
  {
    const FootprintAxis axis(Pixels, width);
    EXPECT_EQ(axis.GetNumberOfTaps(), 1);
    EXPECT_EQ(axis.GetNumberOfSamples(), Pixels);
    EXPECT_EQ(axis.GetStep(), 1);
    EXPECT_EQ(axis.GetWeights(7)[0], 1);
    EXPECT_EQ(axis.GetStart(7), 7);
  }
}

TEST(Footprint, SamplesReachFromTheFirstPixelToTheLast)
{
  for (const double width : { 1.5, 2.0, 3.3, 4.0, 5.85, 17.0, 59.0, 400.0 })
  {
    const FootprintAxis axis(Pixels, width);
    EXPECT_NEAR(GetPosition(axis, axis.GetNumberOfSamples() - 1), Pixels - 1, 1e-12);
    EXPECT_LE(axis.GetStep(), std::max(1.0, width / 2) + 1e-12);
    // the ends are the end pixels themselves
    EXPECT_NEAR(GetTotalWeight(axis, 0, 0), 1, 1e-12);
    EXPECT_NEAR(GetTotalWeight(axis, Pixels - 1, Pixels - 1), 1, 1e-12);
  }
}

TEST(Footprint, EachSampleHasTheMomentsOfItsPlace)
{
  for (const double width : { 1.5, 2.0, 3.3, 4.0, 5.85, 17.0, 59.0, 400.0 })
  {
    const FootprintAxis axis(Pixels, width);
    for (int i = 0; i < axis.GetNumberOfSamples(); ++i)
    {
      double sum = 0;
      double mean = 0;
      for (int t = 0; t < axis.GetNumberOfTaps(); ++t)
      {
        EXPECT_GE(axis.GetWeights(i)[t], 0);
        ASSERT_GE(axis.GetStart(i) + t, 0);
        ASSERT_LT(axis.GetStart(i) + t, Pixels);
        sum += axis.GetWeights(i)[t];
        mean += axis.GetWeights(i)[t] * (axis.GetStart(i) + t);
      }
      EXPECT_NEAR(sum, 1, 1e-12);
      EXPECT_NEAR(mean, GetPosition(axis, i), 1e-10);
    }
  }
}

TEST(Footprint, WeighsPixelsWithTheSecondMomentOfTheFootprint)
{
  const int n = 2000;
  for (const double width : { 4.0, 5.85, 17.0, 30.0 })
  {
    const FootprintAxis axis(n, width);
    // mean over places between samples, far from the border
    double moment = 0;
    constexpr int places = 1000;
    for (int place = 0; place < places; ++place)
    {
      const double x = 900.123 + 137.77 * place / places;
      for (int q = static_cast<int>(x - 2 * width); q < x + 2 * width; ++q)
      {
        moment += GetTotalWeight(axis, x, q) * (q - x) * (q - x) / places;
      }
    }
    // 1/6 is the linear interpolation between pixels
    EXPECT_NEAR(moment, width * width / 12 + 1.0 / 6, 0.03 * moment) << width;
  }
}

TEST(Footprint, WhatIsFinerThanAVoxelAveragesOut)
{
  // Stripes of one and of two pixels vanish in a footprint of eight; pixels alone would alias.
  std::vector<std::uint8_t> stripes(std::size_t(Pixels) * Pixels);
  for (int period : { 2, 4 })
  {
    for (int y = 0; y < Pixels; ++y)
    {
      for (int x = 0; x < Pixels; ++x)
      {
        stripes[y * Pixels + x] = x % period < period / 2 ? 200 : 0;
      }
    }
    const FootprintAxis axis(Pixels, 8);
    const int samples = axis.GetNumberOfSamples();
    std::vector<float> means(std::size_t(1) * samples * samples);
    AverageFootprints(stripes.data(), Pixels, axis, axis, means.data(), samples);
    for (int y = 0; y < samples; ++y)
    {
      for (int x = 2; x < samples - 2; ++x)
      {
        EXPECT_NEAR(means[y * samples + x], 100, 16) << period << " " << x << " " << y;
      }
    }
  }
}

TEST(Footprint, MeansAreTheWeightedSumsOfPixels)
{
  std::mt19937 random(5);
  const int width = 37;
  const int height = 29;
  const int stride = 41;
  std::vector<std::int16_t> pixels(std::size_t(stride) * height);
  for (std::int16_t& p : pixels)
  {
    p = static_cast<std::int16_t>(random() % 4000 - 2000);
  }
  for (const double w : { 0.3, 1.6, 2.7, 4.0, 9.9, 80.0 })
  {
    const FootprintAxis columns(width, w);
    const FootprintAxis rows(height, 0.7 * w);
    std::vector<double> means(
      std::size_t(1) * columns.GetNumberOfSamples() * rows.GetNumberOfSamples());
    std::vector<float> floats(means.size());
    AverageFootprints(
      pixels.data(), stride, columns, rows, means.data(), columns.GetNumberOfSamples());
    AverageFootprints(
      pixels.data(), stride, columns, rows, floats.data(), columns.GetNumberOfSamples());
    for (int r = 0; r < rows.GetNumberOfSamples(); ++r)
    {
      for (int c = 0; c < columns.GetNumberOfSamples(); ++c)
      {
        double sum = 0;
        for (int t = 0; t < rows.GetNumberOfTaps(); ++t)
        {
          for (int s = 0; s < columns.GetNumberOfTaps(); ++s)
          {
            sum += rows.GetWeights(r)[t] * columns.GetWeights(c)[s] *
              pixels[(rows.GetStart(r) + t) * stride + columns.GetStart(c) + s];
          }
        }
        const int n = r * columns.GetNumberOfSamples() + c;
        EXPECT_NEAR(means[n], sum, 1e-9);
        EXPECT_NEAR(floats[n], sum, 2e-3);
      }
    }
  }
}

TEST(Footprint, SamplesAreIntegralsOfTheInterpolatedLine)
{
  // numerical integration over the box of the third sample, which lies far from the border
  const double width = 7.3;
  const FootprintAxis axis(Pixels, width);
  const int sample = axis.GetNumberOfSamples() / 2;
  const double box = std::sqrt(width * width - 2 * axis.GetStep() * axis.GetStep());
  for (int t = 0; t < axis.GetNumberOfTaps(); ++t)
  {
    double integral = 0;
    constexpr int parts = 100000;
    for (int n = 0; n < parts; ++n)
    {
      const double x = GetPosition(axis, sample) + box * ((n + 0.5) / parts - 0.5);
      integral += std::max(0.0, 1 - std::abs(x - (axis.GetStart(sample) + t))) / parts;
    }
    EXPECT_NEAR(axis.GetWeights(sample)[t], integral, 1e-7);
  }
}

TEST(Footprint, MarginIsHalfAVoxelAndHalfAPixel)
{
  for (const double width : { 0.3, 1.0, 1.5, 4.0, 5.85, 17.0 })
  {
    EXPECT_NEAR(FootprintAxis(Pixels, width).GetMargin(width), 0.5 + width / 2, 1e-12);
  }
  // never so far that an image of some pixels becomes a huge raster
  for (const int n : { 2, 3, 5, 20 })
  {
    for (const double width : { 1.5, 3.0, 17.0, 400.0 })
    {
      const FootprintAxis axis(n, width);
      const int samples = axis.GetNumberOfSamplesOutside(width);
      EXPECT_GE(samples, 1);
      EXPECT_LE(samples, 8);
      EXPECT_LE(axis.GetMargin(width), samples * axis.GetStep() + 1e-6);
      EXPECT_GT(axis.GetMargin(width), (samples - 1) * axis.GetStep());
    }
  }
}

TEST(Footprint, RasterGoesOnAlongItsSlope)
{
  const int width = 9;
  const int height = 11;
  const auto plane = [](int x, int y) { return 3 + 1.5 * x - 2.25 * y; };
  std::vector<double> raster(std::size_t(1) * width * height, 1e9);
  std::vector<double> sums(raster.size(), 1e9);
  std::vector<double> weights(raster.size(), 1e9);
  for (int y = 3; y < height - 3; ++y)
  {
    for (int x = 2; x < width - 2; ++x)
    {
      raster[y * width + x] = plane(x, y);
      weights[y * width + x] = 0.25 * (1 + x % 3);
      sums[y * width + x] = plane(x, y) * weights[y * width + x];
    }
  }
  ContinueRaster<double>(raster.data(), nullptr, width, height, 2, 3);
  ContinueRaster(sums.data(), weights.data(), width, height, 2, 3);
  for (int y = 0; y < height; ++y)
  {
    for (int x = 0; x < width; ++x)
    {
      EXPECT_NEAR(raster[y * width + x], plane(x, y), 1e-12) << x << " " << y;
      EXPECT_NEAR(sums[y * width + x] / weights[y * width + x], plane(x, y), 1e-12);
    }
  }
}

TEST(Footprint, RasterGoesOnNoSteeperThanBefore)
{
  // one line: first two inner values, the third, and what must come before the first
  struct Case
  {
    std::array<double, 3> Inner;
    double Expected;
  };
  const double inf = std::numeric_limits<double>::infinity();
  const double nan = std::nan("");
  for (const Case& c : { Case{ { 5, 4, 2 }, 6 }, Case{ { 5, 3, 2 }, 6 }, Case{ { -5, -3, -2 }, -6 },
         Case{ { 0, 200, 200 }, 0 }, Case{ { 0, 0, 200 }, 0 }, Case{ { 5, 9, 2 }, 5 },
         Case{ { 5, 1, 2 }, 5 }, Case{ { 5, nan, 2 }, 5 }, Case{ { inf, 1, 0 }, inf } })
  {
    std::vector<double> raster(25, 0);
    for (int y = 1; y < 4; ++y)
    {
      std::copy(c.Inner.begin(), c.Inner.end(), raster.begin() + 5 * y + 1);
    }
    ContinueRaster<double>(raster.data(), nullptr, 5, 5, 1, 1);
    for (int y = 0; y < 5; ++y)
    {
      EXPECT_EQ(raster[5 * y], c.Expected);
    }
  }
  // where the next ones lie outside of the fan, and where there are but two
  std::vector<float> sums(25, 7);
  std::vector<float> weights(25, 0.5F);
  sums[6] = 9;
  sums[7] = 8;
  weights[8] = 0;
  ContinueRaster(sums.data(), weights.data(), 5, 5, 1, 1);
  EXPECT_EQ(sums[5], 9);
  EXPECT_EQ(weights[5], 0.5F);
  std::vector<float> two{ 0, 0, 0, 0, 0, 4, 3, 0, 0, 2, 1, 0, 0, 0, 0, 0 };
  ContinueRaster<float>(two.data(), nullptr, 4, 4, 1, 1);
  EXPECT_EQ(two, (std::vector<float>{ 4, 4, 3, 3, 4, 4, 3, 3, 2, 2, 1, 1, 2, 2, 1, 1 }));
}
