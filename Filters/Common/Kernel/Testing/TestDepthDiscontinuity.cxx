// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDepthDiscontinuity.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

using namespace lacuna;

namespace
{
constexpr double Nothing = std::numeric_limits<double>::quiet_NaN();
constexpr double Degree = 3.14159265358979323846 / 180;
const SlopeRule Rule{ DiscontinuityLimits() };

// The slope between pixels that lie at the given angles from the one in the middle.
double FromAngles(double backward, double forward, double spacing = 1)
{
  return Rule.SlopeAt(5 - spacing * std::tan(backward * Degree), 5,
    5 + spacing * std::tan(forward * Degree), spacing);
}

// The nine cases in the thesis's own words.
double ByTheBook(double before, double here, double after, double spacing)
{
  const double b = std::atan((here - before) / spacing) / Degree;
  const double f = std::atan((after - here) / spacing) / Degree;
  const double c = std::atan((after - before) / (2 * spacing)) / Degree;
  const bool noBefore = std::isnan(before);
  const bool noAfter = std::isnan(after);
  const auto tangent = [](double degrees) { return std::tan(degrees * Degree); };
  if (noBefore && noAfter)
  {
    return 0;
  }
  if (noBefore)
  {
    return tangent(f);
  }
  if (noAfter)
  {
    return tangent(b);
  }
  if (std::abs(b - f) < 20)
  {
    return tangent(c);
  }
  if (std::abs(f) > 65 && std::abs(b) > 65)
  {
    return f * b < 0 ? 0 : tangent(c);
  }
  if (std::abs(f) > 65)
  {
    return tangent(b);
  }
  return tangent(std::abs(b) > 65 ? f : c);
}

/// Figure 3.8 read aloud, with the mended cases 2 and 3.
int CaseByTheBook(double back, double forward, double limit, double change)
{
  const bool left = !std::isnan(back);
  const bool right = !std::isnan(forward);
  if (!left && !right)
    return 1;
  if (!left)
    return 2;
  if (!right)
    return 3;
  if (std::fabs(back - forward) < change)
    return 4;
  if (std::fabs(forward) > limit && std::fabs(back) > limit && forward * back < 0)
    return 5;
  if (std::fabs(forward) > limit && std::fabs(back) > limit && forward * back >= 0)
    return 6;
  if (std::fabs(forward) > limit)
    return 7;
  if (std::fabs(back) > limit)
    return 8;
  return 9;
}
}

TEST(SlopeAt, NineCases)
{
  const auto tangent = [](double degrees) { return std::tan(degrees * Degree); };
  EXPECT_EQ(Rule.SlopeAt(Nothing, 5, Nothing, 0.5), 0);
  EXPECT_DOUBLE_EQ(Rule.SlopeAt(Nothing, 5, 8, 0.5), 6);
  EXPECT_DOUBLE_EQ(Rule.SlopeAt(3, 5, Nothing, 0.5), 4);
  EXPECT_NEAR(FromAngles(70, 80), 0.5 * (tangent(70) + tangent(80)), 1e-12);
  EXPECT_EQ(FromAngles(-70, 80), 0);
  EXPECT_NEAR(FromAngles(-88, -66), 0.5 * (tangent(-88) + tangent(-66)), 1e-9);
  EXPECT_NEAR(FromAngles(10, 80), tangent(10), 1e-12);
  EXPECT_NEAR(FromAngles(10, -80), tangent(10), 1e-12);
  EXPECT_NEAR(FromAngles(-89, -5), tangent(-5), 1e-12);
  EXPECT_NEAR(FromAngles(-30, 60), 0.5 * (tangent(-30) + tangent(60)), 1e-12);
}

TEST(SlopeAt, LimitsAreWhereTheyAreSaidToBe)
{
  // between 20 and 65 degrees all is central; so the limits show only near 65
  EXPECT_NEAR(FromAngles(50, 69.9), 0.5 * (std::tan(50 * Degree) + std::tan(69.9 * Degree)), 1e-12);
  EXPECT_NEAR(FromAngles(49.8, 69.9), std::tan(49.8 * Degree), 1e-12);
  EXPECT_NEAR(FromAngles(20, 64.9), 0.5 * (std::tan(20 * Degree) + std::tan(64.9 * Degree)), 1e-12);
  EXPECT_NEAR(FromAngles(20, 65.1), std::tan(20 * Degree), 1e-12);
}

TEST(SlopeAt, SameAsByAngles)
{
  std::mt19937 random(1);
  std::uniform_real_distribution<double> angle(-89.9, 89.9);
  for (int n = 0; n < 100000; ++n)
  {
    const double spacing = 0.1 + n % 7;
    const double before = n % 11 == 0 ? Nothing : spacing * std::tan(angle(random) * Degree);
    const double after = n % 13 == 0 ? Nothing : spacing * std::tan(angle(random) * Degree);
    const double expected = ByTheBook(before, 0.25, after, spacing);
    ASSERT_NEAR(
      Rule.SlopeAt(before, 0.25, after, spacing), expected, 1e-9 * (1 + expected * expected))
      << before << " " << after << " " << spacing;
  }
}

TEST(DepthDiscontinuity, ClassifiesByTheBook)
{
  const double limits[][2] = { { 65, 20 }, { 0, 0 }, { 90, 180 }, { 30, 75 } };
  int seen[10] = {};
  for (const auto& limit : limits)
  {
    const SlopeRule rule({ limit[0], limit[1] });
    for (int i = -91; i < 90; ++i)
    {
      for (int j = -91; j < 90; ++j)
      {
        // never at a limit, where rounding decides
        const double back = i < -90 ? Nothing : i + 0.25;
        const double forward = j < -90 ? Nothing : j + 0.7;
        const int expected = CaseByTheBook(back, forward, limit[0], limit[1]);
        const auto step = [](double degrees, double length) {
          return DepthStep{ length * std::sin(degrees * Degree),
            length * std::cos(degrees * Degree) };
        };
        const SlopeCase found = rule.Classify(step(back, 0.3), step(forward, 20));
        ASSERT_EQ(static_cast<int>(found), expected) << back << " " << forward;
        ASSERT_EQ(IsTornForward(found), expected == 5 || expected == 7);
        ASSERT_EQ(IsTornBackward(found), expected == 5 || expected == 8);
        ++seen[expected];
      }
    }
  }
  for (int c = 1; c <= 9; ++c)
  {
    EXPECT_GT(seen[c], 0) << c;
  }
}

TEST(DepthDiscontinuity, StepsAlongTheRayAndLimitsAtTheirEnds)
{
  const DepthStep away{ 2, 0 };
  const DepthStep back{ -3, 0 };
  const DepthStep flat{ 0, 1 };
  const SlopeRule usual{ DiscontinuityLimits() };
  EXPECT_EQ(usual.Classify(away, back), SlopeCase::Spike);
  EXPECT_EQ(usual.Classify(away, away), SlopeCase::Smooth);
  EXPECT_EQ(usual.Classify(flat, away), SlopeCase::TornForward);
  EXPECT_EQ(usual.Classify(back, flat), SlopeCase::TornBackward);
  const SlopeRule nothingIsSteep({ 90, 20 });
  EXPECT_FALSE(nothingIsSteep.IsSteep(away));
  EXPECT_EQ(nothingIsSteep.Classify(away, back), SlopeCase::Crease);
  const SlopeRule noChangeIsSmall({ 65, 0 });
  EXPECT_EQ(noChangeIsSmall.Classify(flat, flat), SlopeCase::Crease);
  EXPECT_EQ(noChangeIsSmall.Classify(away, away), SlopeCase::Steep);
  const SlopeRule anyChangeIsSmall({ 0, 180 });
  EXPECT_EQ(anyChangeIsSmall.Classify(away, { -2, 1e-3 }), SlopeCase::Smooth);
  EXPECT_EQ(anyChangeIsSmall.Classify(away, away), SlopeCase::Smooth);
}
