// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFootprint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>

using lacuna::AverageFootprints;
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
    AverageFootprints(stripes.data(), Pixels, axis, axis, means.data());
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
    AverageFootprints(pixels.data(), stride, columns, rows, means.data());
    AverageFootprints(pixels.data(), stride, columns, rows, floats.data());
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
