// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFastrakCommand.h"

#include <gtest/gtest.h>

#include <limits>

using namespace lacuna;

TEST(FastrakCommand, BytesAreThoseOfTheManual)
{
  EXPECT_EQ(FastrakCommand::OutputList(1, FastrakLayout::FromNumbers({ 2, 4 })), "O1,2,4\r");
  EXPECT_EQ(FastrakCommand::OutputList(4, FastrakLayout()), "O4,2,4,1\r");
  EXPECT_EQ(FastrakCommand::Hemisphere(2, { 0, 0, 1 }), "H2,0.0000,0.0000,1.0000\r");
  EXPECT_EQ(FastrakCommand::Active(3, false), "l3,0\r");
  EXPECT_EQ(FastrakCommand::Boresight(1), "B1\r");
  EXPECT_EQ(FastrakCommand::Unboresight(1), "b1\r");
  EXPECT_EQ(FastrakCommand::ResetAlignment(1), "R1\r");
  EXPECT_EQ(FastrakCommand::ReferenceAngles(1, { 1, -2, 3 }), "G1,1.0000,-2.0000,3.0000\r");
  EXPECT_EQ(FastrakCommand::Mounting(1, { 1, -2, 3 }), "r1,1.0000,-2.0000,3.0000\r");
  EXPECT_EQ(
    FastrakCommand::Alignment(1, { 0, 0, 0 }, { 100, 0, 0 }, { 0, 100, 0 }, LengthUnit::Centimetre),
    "A1,0.0000,0.0000,0.0000,10.0000,0.0000,0.0000,0.0000,10.0000,0.0000\r");
  EXPECT_EQ(FastrakCommand::TipOffset(1, { 25.4, 0, -50.8 }, LengthUnit::Inch),
    "N1,1.0000,0.0000,-2.0000\r");
  EXPECT_EQ(FastrakCommand::Increment(1, 5, LengthUnit::Centimetre), "I1,0.5000\r");
  EXPECT_EQ(FastrakCommand::PositionEnvelope(
              1, { 100, 200, 300 }, { -100, -200, -300 }, LengthUnit::Centimetre),
    "V1,10.0000,20.0000,30.0000,-10.0000,-20.0000,-30.0000\r");
  EXPECT_EQ(FastrakCommand::AngularEnvelope(1, { 180, 90, 180 }, { -180, -90, -180 }),
    "Q1,180.0000,90.0000,180.0000,-180.0000,-90.0000,-180.0000\r");
  EXPECT_EQ(FastrakCommand::ButtonAsksForRecord(1, false), "e1,0\r");
  EXPECT_EQ(
    FastrakCommand::PositionFilter({ 0.2, 0.2, 0.8, 0.95 }), "x0.2000,0.2000,0.8000,0.9500\r");
  EXPECT_EQ(FastrakCommand::PositionFilterOff(), "x,1\r");
  EXPECT_EQ(FastrakCommand::AttitudeFilter({ 0, 0, 1, 1 }), "v0.0000,0.0000,1.0000,1.0000\r");
  EXPECT_EQ(FastrakCommand::AttitudeFilterOff(), "v,1\r");
  EXPECT_EQ(FastrakCommand::SerialRate(115200), "o1152,N,8,0\r");
  EXPECT_EQ(FastrakCommand::Ask('H', 2), "H2\r");
}

TEST(FastrakCommand, RefusesWhatTheUnitWouldRefuse)
{
  EXPECT_THROW(FastrakCommand::Active(0, true), std::invalid_argument);
  EXPECT_THROW(FastrakCommand::Active(5, true), std::invalid_argument);
  EXPECT_THROW(FastrakCommand::Hemisphere(1, { std::numeric_limits<double>::quiet_NaN(), 0, 0 }),
    std::invalid_argument);
  EXPECT_THROW(FastrakCommand::PositionFilter({ 0.2, 0.2, 1.8, 0.95 }), std::invalid_argument);
  EXPECT_THROW(FastrakCommand::SerialRate(14400), std::invalid_argument);
}
