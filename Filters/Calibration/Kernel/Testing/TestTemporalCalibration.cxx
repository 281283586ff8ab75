// SPDX-License-Identifier: BSD-3-Clause
/// Known lags are found from motions such as a hand makes.
#include "lacunaTemporalCalibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>

using namespace lacuna;

namespace
{
using Sample = TemporalCalibration::Sample;

// To and fro, never quite the same.
double Height(double time)
{
  return 12 * std::sin(6.6 * time) + 5 * std::sin(4.1 * time + 1) + 2 * std::sin(11 * time + 2);
}

// Twelve seconds at 25 slices a second; what is seen is late by lag.
std::vector<Sample> Record(
  double lag, double noise, unsigned seed, const std::function<double(double)>& height = Height)
{
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 1);
  const Vec3 up = Normalized({ 0.3, -0.8, 0.5 });
  std::vector<Sample> samples;
  for (int i = 0; i < 300; ++i)
  {
    const double time = 7 + 0.04 * i + 0.002 * std::sin(i); // cameras are not quite regular
    Vec3 position = Vec3{ 100, 40, -20 } + height(time) * up;
    for (int axis = 0; axis < 3; ++axis)
    {
      position[axis] += 0.1 * noise * normal(random);
    }
    // 5 pixels a mm, growing as the probe goes down
    const double row = 250 - 5 * height(time - lag) + noise * normal(random);
    samples.push_back({ time, row, Matrix4::Translation(position), true });
  }
  return samples;
}

void ExpectRefused(
  const std::vector<Sample>& samples, const std::string& part, double maximumLag = 0.5)
{
  try
  {
    const TemporalCalibration found = TemporalCalibration::Solve(samples, maximumLag);
    ADD_FAILURE() << "taken: " << part << ", lag " << found.Lag;
  }
  catch (const std::invalid_argument& error)
  {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}
}

TEST(TemporalCalibration, LagsAreFoundWithinTwoMilliseconds)
{
  for (const double lag : { 0.0, 0.0131, 0.044, 0.1, 0.1575, 0.2, -0.06 })
  {
    for (unsigned seed = 0; seed < 5; ++seed)
    {
      const TemporalCalibration found = TemporalCalibration::Solve(Record(lag, 1, seed));
      EXPECT_NEAR(found.Lag, lag, 0.002) << seed;
      EXPECT_GT(found.Correlation, 0.99);
      EXPECT_LT(found.Spread, 0.001);
      EXPECT_GT(found.Spread, 0.0001);
      EXPECT_EQ(found.Lags.size(), found.Correlations.size());
      // the curve's peak is where the lag is
      const auto peak = std::max_element(found.Correlations.begin(), found.Correlations.end());
      EXPECT_NEAR(found.Lags[std::size_t(peak - found.Correlations.begin())], found.Lag, 0.0051);
    }
  }
}

TEST(TemporalCalibration, SpreadIsThatOfRepeatedMeasurements)
{
  double square = 0, expected = 0;
  constexpr int times = 60;
  for (unsigned seed = 0; seed < times; ++seed)
  {
    const TemporalCalibration found = TemporalCalibration::Solve(Record(0.08, 3, 100 + seed), 0.3);
    square += std::pow(found.Lag - 0.08, 2) / times;
    expected += std::pow(found.Spread, 2) / times;
  }
  EXPECT_NEAR(std::sqrt(square / expected), 1, 0.3);
}

TEST(TemporalCalibration, RegularMotionIsNotTakenForHalfACycleLater)
{
  for (const double frequency : { 1.0, 1.1, 1.3, 1.6 })
  {
    const double turn = 2 * std::acos(-1.0) * frequency;
    for (unsigned seed = 0; seed < 5; ++seed)
    {
      const auto sine = [&](double time) { return 12 * std::sin(turn * time); };
      ExpectRefused(Record(0.12, 1, seed, sine), "two lags fit alike, ");
      const double known = 0.25 / frequency; // within a quarter of a cycle there is but one
      EXPECT_NEAR(TemporalCalibration::Solve(Record(0.12, 1, seed, sine), known).Lag, 0.12, 0.002)
        << frequency;
      // as a hand moves: found, and right
      const auto wandering = [&](double time)
      { return (12 + 2 * std::sin(0.7 * time)) * std::sin(turn * time + 0.4 * std::sin(time)); };
      EXPECT_NEAR(TemporalCalibration::Solve(Record(0.12, 1, seed, wandering)).Lag, 0.12, 0.002)
        << frequency;
    }
  }
}

TEST(TemporalCalibration, SlicesWithoutWallOrPoseAreLeftOut)
{
  std::vector<Sample> samples = Record(0.1, 0.5, 3);
  for (std::size_t i = 0; i < samples.size(); i += 7)
  {
    samples[i].Value = std::numeric_limits<double>::quiet_NaN();
    samples[i + 1].HasPose = false;
  }
  const TemporalCalibration found = TemporalCalibration::Solve(samples);
  EXPECT_NEAR(found.Lag, 0.1, 0.002);
  EXPECT_LT(found.Frames, 245u);
}

TEST(TemporalCalibration, RefusesWhatCannotTell)
{
  const auto refused = [](const char* part, const std::function<void(std::vector<Sample>&)>& spoil,
                         double maximumLag = 0.5)
  {
    std::vector<Sample> samples = Record(0.1, 0.5, 4);
    spoil(samples);
    ExpectRefused(samples, part, maximumLag);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused("only 0 slices", [](auto& samples) { samples.clear(); });
  refused("only", [](auto& samples) { samples.resize(40); });
  refused("the time of slice 5 is not after", [](auto& samples) { samples[5].Time = 1; });
  refused("the time of slice 5 is not finite", [&](auto& samples) { samples[5].Time = nan; });
  refused("stands still",
    [](auto& samples)
    {
      for (Sample& sample : samples)
      {
        sample.ProbeToTracker = Matrix4();
      }
    });
  refused("do not move together",
    [](auto& samples)
    {
      for (std::size_t i = 0; i < samples.size(); ++i)
      {
        samples[i].Value = std::sin(0.37 * double(i * i));
      }
    });
  refused(
    "end of the range", [](auto&) {}, 0.05);
  refused(
    "MaximumLag", [](auto&) {}, nan);
  refused(
    "MaximumLag", [](auto&) {}, 3);
}
