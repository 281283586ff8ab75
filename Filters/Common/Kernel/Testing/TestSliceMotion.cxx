// SPDX-License-Identifier: BSD-3-Clause
/// Speeds of slices, and the errors to be expected of a tracker.
#include "lacunaSliceMotion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace lacuna;

TEST(SliceMotion, FastrakAt300Millimetres)
{
  // Carr 1996, ch. 2: 1.9 mm RMS at 300 mm
  const TrackerAccuracy fastrak;
  EXPECT_NEAR(GetRegistrationError(fastrak, 300), 1.9, 0.05);
  EXPECT_NEAR(GetRegistrationError(fastrak, 300), 1.938476, 1e-6);
  EXPECT_DOUBLE_EQ(GetRegistrationError(fastrak, 0), 1.38);
  // 0.2 degrees at 300 mm are 1 mm
  EXPECT_NEAR(GetRegistrationError({ 0, 0.2 }, 300), 1.0472, 1e-4);
}

TEST(SliceMotion, SpeedIsThatOfTheFastestCorner)
{
  const std::array<Vec3, 4> corners{ Vec3{ 0, 0, 0 }, Vec3{ 10, 0, 0 }, Vec3{ 10, 20, 0 },
    Vec3{ 0, 20, 0 } };
  const double angle = 0.1;
  const std::vector<Matrix4> poses{ Matrix4(), Matrix4::Translation({ 3, 0, 4 }), Matrix4(),
    Matrix4::Translation({ 3, 0, 4 }),
    Matrix4::Translation({ 3, 0, 4 }) * Matrix4::Rotation({ 0, 1, 0 }, angle),
    Matrix4::Translation({ 3, 0, 4 }), Matrix4() };
  const std::vector<char> usable{ 0, 1, 0, 1, 1, 1, 1 };
  const std::vector<double> times{ 0, 1, 2, 3, 3.5, 3.5, 3.4 };
  const std::vector<double> speeds = GetSliceSpeeds(poses, usable, times, corners);
  EXPECT_TRUE(std::isnan(speeds[0]));
  EXPECT_DOUBLE_EQ(speeds[1], 0); // to slice 3
  EXPECT_TRUE(std::isnan(speeds[2]));
  EXPECT_DOUBLE_EQ(speeds[3], 0);
  // turned about the column at 0, the other one moves by a chord
  EXPECT_NEAR(speeds[4], 2 * 10 * std::sin(angle / 2) / 0.5, 1e-12);
  EXPECT_TRUE(std::isnan(speeds[5])); // no time
  EXPECT_TRUE(std::isnan(speeds[6])); // backwards
  EXPECT_DOUBLE_EQ(GetSliceSpeeds({ poses[0], poses[1] }, { 1, 1 }, { 0, 0.5 }, corners)[0], 10);
  EXPECT_TRUE(std::isnan(GetSliceSpeeds({ poses[0] }, { 1 }, { 0 }, corners)[0]));
  // a slice without a time is passed over
  for (const double none :
    { std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity() })
  {
    const std::vector<double> around =
      GetSliceSpeeds({ poses[0], poses[1], poses[1] }, { 1, 1, 1 }, { 0, none, 0.5 }, corners);
    EXPECT_TRUE(std::isnan(around[1]));
    EXPECT_DOUBLE_EQ(around[2], 10);
  }
}
