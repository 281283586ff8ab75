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
  EXPECT_EQ(FastrakCommand::Unboresight(1), "b1\r");
  EXPECT_EQ(FastrakCommand::ResetAlignment(1), "R1\r");
  EXPECT_EQ(FastrakCommand::ButtonAsksForRecord(1, false), "e1,0\r");
  EXPECT_EQ(FastrakCommand::PositionFilterOff(), "x,1\r");
  EXPECT_EQ(FastrakCommand::AttitudeFilterOff(), "v,1\r");
  EXPECT_EQ(FastrakCommand::SerialRate(115200), "o1152,N,8,0\r");
}

TEST(FastrakCommand, RefusesWhatTheUnitWouldRefuse)
{
  EXPECT_THROW(FastrakCommand::Active(0, true), std::invalid_argument);
  EXPECT_THROW(FastrakCommand::Active(5, true), std::invalid_argument);
  EXPECT_THROW(FastrakCommand::Hemisphere(1, { std::numeric_limits<double>::quiet_NaN(), 0, 0 }),
    std::invalid_argument);
  EXPECT_THROW(FastrakCommand::SerialRate(14400), std::invalid_argument);
}
