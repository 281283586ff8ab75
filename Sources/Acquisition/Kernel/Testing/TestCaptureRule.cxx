// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSweepTaking.h"

#include <gtest/gtest.h>

using namespace lacuna;

namespace
{
constexpr double Degree = 3.14159265358979323846 / 180;

CaptureRule MakeRule(std::vector<Vec3> points)
{
  return CaptureRule(CaptureMode::Movement, 0.5, 23, std::move(points));
}
}

TEST(CaptureRule, CornersAreTheOuterOnesOfTheWindow)
{
  const Matrix4 imageToProbe =
    Matrix4::Translation({ 5, 0, 7 }) * Matrix4::Scaling({ 0.1, 0.2, 1 });
  const std::vector<Vec3> corners = GetViewCorners(imageToProbe, { 10, 20, 100, 50 });
  ASSERT_EQ(corners.size(), 4u);
  for (const auto& [column, row] :
    { std::pair<double, double>{ 9.5, 19.5 }, { 109.5, 19.5 }, { 9.5, 69.5 }, { 109.5, 69.5 } })
  {
    int found = 0;
    for (const Vec3& corner : corners)
    {
      found += Norm(corner - imageToProbe.Point({ column, row, 0 })) < 1e-12 ? 1 : 0;
    }
    EXPECT_EQ(found, 1) << column << " " << row;
  }
}

TEST(CaptureRule, TakesAFrameWhenACornerHasMovedSinceTheLastThatWasTaken)
{
  CaptureRule rule =
    MakeRule(GetViewCorners(Matrix4::Scaling({ 0.1, 0.1, 1 }), { 0, 0, 400, 300 }));
  double x = 0;
  double last = 0;
  int taken = 0;
  for (int i = 0; i < 1000; ++i, x += 0.013) // mm
  {
    const auto verdict = rule.Judge(Matrix4::Translation({ x, 0, 0 }), 0.04 * i);
    EXPECT_EQ(verdict.Take, i == 0 || x - last > 0.5) << i;
    if (verdict.Take)
    {
      rule.Take();
      last = x;
      ++taken;
    }
    EXPECT_FALSE(verdict.TooFast);
  }
  EXPECT_EQ(taken, 26); // each 0.507 mm of 13
  // what would have been taken and was not does not count
  EXPECT_TRUE(rule.Judge(Matrix4::Translation({ last + 0.6, 0, 0 }), 50).Take);
  EXPECT_TRUE(rule.Judge(Matrix4::Translation({ last + 0.6, 0, 0 }), 50.04).Take);
  // turning by 1 degree about the receiver moves the far corner by 0.87 mm, and its axis not at all
  rule.Take();
  const Matrix4 there = Matrix4::Translation({ last + 0.6, 0, 0 });
  EXPECT_TRUE(rule.Judge(there * Matrix4::Rotation({ 0, 0, 1 }, Degree), 51).Take);
  EXPECT_FALSE(rule.Judge(there * Matrix4::Rotation({ 0, 0, 1 }, Degree / 2), 51).Take);
  rule.BeginSweep();
  EXPECT_TRUE(rule.Judge(there, 52).Take);
}

TEST(CaptureRule, AnotherRuleGoesOnFromTheLastSlice)
{
  CaptureRule first = MakeRule({ { 0, 0, 0 } });
  first.Judge(Matrix4(), 0);
  first.Take();
  CaptureRule rule(CaptureMode::Movement, 2, 10, { { 0, 0, 0 } });
  rule.Continue(first);
  const auto near = rule.Judge(Matrix4::Translation({ 1.9, 0, 0 }), 0.1);
  EXPECT_FALSE(near.Take);
  EXPECT_TRUE(near.TooFast); // since the frame before, which the first rule saw
  EXPECT_TRUE(rule.Judge(Matrix4::Translation({ 2.1, 0, 0 }), 0.2).Take);
}

TEST(CaptureRule, WithoutCalibrationTheReceiverAndItsTurnsCount)
{
  CaptureRule rule = MakeRule(GetReceiverPoints());
  rule.Judge(Matrix4(), 0);
  rule.Take();
  for (int axis = 0; axis < 3; ++axis)
  {
    Vec3 direction{ 0, 0, 0 };
    direction[axis] = 1;
    EXPECT_TRUE(rule.Judge(Matrix4::Translation(0.51 * direction), 1).Take);
    EXPECT_FALSE(rule.Judge(Matrix4::Translation(0.49 * direction), 1).Take);
    EXPECT_TRUE(rule.Judge(Matrix4::Rotation(direction, 0.0051), 1).Take); // 0.51 mm at 100 mm
    EXPECT_FALSE(rule.Judge(Matrix4::Rotation(direction, 0.0049), 1).Take);
  }
}

TEST(CaptureRule, WatchesTheSpeedOfTheFastestPoint)
{
  CaptureRule rule = MakeRule({ { 0, 0, 0 }, { 100, 0, 0 } });
  EXPECT_FALSE(rule.Judge(Matrix4(), 0).Speed);
  const auto slow = rule.Judge(Matrix4::Translation({ 0, 0.9, 0 }), 0.04);
  EXPECT_NEAR(slow.Speed.value(), 22.5, 1e-9);
  EXPECT_FALSE(slow.TooFast);
  // the far point goes a hundred times the angle
  const auto fast =
    rule.Judge(Matrix4::Translation({ 0, 0.9, 0 }) * Matrix4::Rotation({ 0, 0, 1 }, 0.01), 0.08);
  EXPECT_NEAR(fast.Speed.value(), 25, 1e-3);
  EXPECT_TRUE(fast.TooFast);
  EXPECT_FALSE(rule.Judge(Matrix4(), 0.6).Speed); // after half a second it says nothing
  CaptureRule free(CaptureMode::EveryFrame, 0, 0, GetReceiverPoints());
  free.Judge(Matrix4(), 0);
  const auto verdict = free.Judge(Matrix4::Translation({ 500, 0, 0 }), 0.04);
  EXPECT_TRUE(verdict.Take);
  EXPECT_FALSE(verdict.TooFast); // no limit
}
