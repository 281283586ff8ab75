// SPDX-License-Identifier: BSD-3-Clause
/// Gate signals between their samples, and around the end of a cycle.
#include "lacunaGateSignal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

using namespace lacuna;

namespace
{
constexpr double NotANumber = std::numeric_limits<double>::quiet_NaN();

// Smallest difference of two phases.
double GetDistance(double a, double b, double period)
{
  const double d = std::abs(std::remainder(a - b, period));
  return d;
}
}

TEST(GateSignal, ValuesChangeEvenly)
{
  const GateSignal signal(GateKind::Value, { 1, 2, 4 }, { 10, -10, 30 });
  EXPECT_EQ(signal.At(1), 10);
  EXPECT_EQ(signal.At(1.25), 5);
  EXPECT_EQ(signal.At(2), -10);
  EXPECT_EQ(signal.At(3), 10);
  EXPECT_EQ(signal.At(4), 30);
  EXPECT_TRUE(std::isnan(signal.At(0.999)));
  EXPECT_TRUE(std::isnan(signal.At(4.001)));
  EXPECT_EQ(signal.At(4 + 5e-7), 30); // rounded in a file
  EXPECT_TRUE(std::isnan(signal.At(NotANumber)));
}

TEST(GateSignal, PhasesTakeTheShorterWayAround)
{
  const GateSignal signal(GateKind::Phase, { 0, 1, 2, 3, 4 }, { 0.9, 0.2, 0.1, 0.9, 0.4 });
  EXPECT_NEAR(signal.At(1.0 / 6), 0.95, 1e-12);
  EXPECT_NEAR(signal.At(1.0 / 3), 0, 1e-12);
  EXPECT_NEAR(signal.At(2.0 / 3), 0.1, 1e-12);
  EXPECT_NEAR(signal.At(1.5), 0.15, 1e-12);  // a little backwards
  EXPECT_NEAR(signal.At(2.75), 0.95, 1e-12); // backwards over the beginning
  EXPECT_NEAR(signal.At(3.5), 0.15, 1e-12);  // half a period: forwards
  const GateSignal percent(GateKind::Phase, { 0, 1 }, { 350, 370 }, 360);
  EXPECT_NEAR(percent.At(0.25), 355, 1e-9);
  EXPECT_NEAR(percent.At(0.75), 5, 1e-9);
  EXPECT_EQ(percent.At(1), 10); // brought into the period
}

TEST(GateSignal, FollowsAHeart)
{
  // the rate drifts; sampled 25 times a second, asked for anywhere
  const auto phase = [](double t) { return t * 1.2 + 0.3 * std::sin(0.5 * t); };
  std::vector<double> times, values, triggers;
  for (int n = 0; n <= 250; ++n)
  {
    times.push_back(0.04 * n);
    values.push_back(phase(0.04 * n) - std::floor(phase(0.04 * n)));
  }
  for (double t = 0, next = 0; t < 10; t += 1e-5)
  {
    if (phase(t) >= next)
    {
      triggers.push_back(t);
      next += 1;
    }
  }
  const GateSignal sampled(GateKind::Phase, times, values);
  const GateSignal triggered(GateKind::Trigger, triggers, {});
  std::mt19937 random(1);
  std::uniform_real_distribution<double> when(0, triggers.back());
  for (int n = 0; n < 10000; ++n)
  {
    const double t = when(random);
    EXPECT_LT(GetDistance(sampled.At(t), phase(t), 1), 1e-4);
    EXPECT_LT(GetDistance(triggered.At(t), phase(t), 1), 0.02); // the rate changes within a beat
    EXPECT_GE(sampled.At(t), 0);
    EXPECT_LT(sampled.At(t), 1);
  }
}

TEST(GateSignal, TriggersBeginCycles)
{
  const GateSignal signal(GateKind::Trigger, { 1, 1.5, 2.5 }, {}, 100);
  EXPECT_EQ(signal.At(1), 0);
  EXPECT_NEAR(signal.At(1.25), 50, 1e-9);
  EXPECT_EQ(signal.At(1.5), 0);
  EXPECT_NEAR(signal.At(2.4), 90, 1e-9);
  EXPECT_EQ(signal.At(2.5), 0);
  EXPECT_TRUE(std::isnan(signal.At(2.6)));
}

TEST(GateSignal, GapsOrderAndHoles)
{
  const GateSignal gap(GateKind::Value, { 0, 1, 5, 6 }, { 0, 1, 5, 6 }, 1, 2);
  EXPECT_EQ(gap.At(0.5), 0.5);
  EXPECT_TRUE(std::isnan(gap.At(3)));
  EXPECT_EQ(gap.At(5), 5);
  EXPECT_EQ(gap.At(5.5), 5.5);
  // any order, the first of equal times, samples without a value left out
  const GateSignal mixed(
    GateKind::Value, { 3, 1, 2, 1, 2.5 }, { 30, 10, NotANumber, 99, NotANumber });
  EXPECT_EQ(mixed.At(1), 10);
  EXPECT_EQ(mixed.At(2), 20);
  EXPECT_EQ(mixed.GetFirstTime(), 1);
  EXPECT_EQ(mixed.GetLastTime(), 3);
}

TEST(GateSignal, Refuses)
{
  EXPECT_THROW(GateSignal(GateKind::Value, {}, {}), std::invalid_argument);
  EXPECT_THROW(GateSignal(GateKind::Value, { 1 }, { NotANumber }), std::invalid_argument);
  EXPECT_THROW(GateSignal(GateKind::Value, { NotANumber }, { 1 }), std::invalid_argument);
  EXPECT_THROW(GateSignal(GateKind::Value, { 1, 2 }, { 1 }), std::invalid_argument);
  EXPECT_THROW(GateSignal(GateKind::Phase, { 1, 2 }, { 1, 2 }, 0), std::invalid_argument);
  EXPECT_THROW(GateSignal(GateKind::Phase, { 1, 2 }, { 1, 2 }, NotANumber), std::invalid_argument);
  EXPECT_THROW(GateSignal(GateKind::Trigger, { 1 }, {}), std::invalid_argument);
  EXPECT_THROW(GateRange(1, 0), std::invalid_argument);
  EXPECT_THROW(GateRange(NotANumber, 1, 1), std::invalid_argument);
}

TEST(GateRange, Plain)
{
  const GateRange range(-1, 2);
  EXPECT_TRUE(range.Accepts(-1) && range.Accepts(0) && range.Accepts(2));
  EXPECT_TRUE(GateRange(0.1, 0.3).Accepts(3 * 0.1));
  EXPECT_FALSE(range.Accepts(-1.001) || range.Accepts(2.001) || range.Accepts(NotANumber));
}

TEST(GateRange, WrapsAround)
{
  for (const GateRange& range : { GateRange(0.9, 0.2, 1), GateRange(-0.1, 0.2, 1),
         GateRange(1.9, 2.2, 1), GateRange(0.9, 1.2, 1) })
  {
    for (const double in : { 0.9, 0.95, 0.0, 0.1, 0.2, 1.0, -0.1, 7.15 })
    {
      EXPECT_TRUE(range.Accepts(in)) << in;
    }
    for (const double out : { 0.21, 0.5, 0.89, -0.2, 3.4, NotANumber })
    {
      EXPECT_FALSE(range.Accepts(out)) << out;
    }
  }
  const GateRange inner(0.2, 0.9, 1);
  EXPECT_TRUE(inner.Accepts(0.2) && inner.Accepts(0.5) && inner.Accepts(0.9));
  EXPECT_FALSE(inner.Accepts(0.95) || inner.Accepts(0.1) || inner.Accepts(0));
  const GateRange all(0, 1, 1);
  const GateRange more(-3, 4, 1);
  for (double value = -2; value < 2; value += 0.01)
  {
    EXPECT_TRUE(all.Accepts(value) && more.Accepts(value)) << value;
  }
  const GateRange point(0.5, 0.5, 1);
  EXPECT_TRUE(point.Accepts(0.5) && point.Accepts(1.5));
  EXPECT_FALSE(point.Accepts(0.51));
}
