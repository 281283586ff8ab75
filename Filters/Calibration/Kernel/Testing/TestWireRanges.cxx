// SPDX-License-Identifier: BSD-3-Clause
/// The text that says which wire is seen where.
#include "lacunaWireRanges.h"

#include <gtest/gtest.h>

#include <stdexcept>

using namespace lacuna;

TEST(WireRanges, WiresAndSlices)
{
  const std::vector<WireRange> ranges = ReadWireRanges("X 0-49, y50 - 98;Z 99\nX 100-149,", 150);
  ASSERT_EQ(ranges.size(), 4U);
  EXPECT_EQ(ranges[1].Wire, CalibrationTarget::WireY);
  EXPECT_EQ(ranges[1].First, 50);
  EXPECT_EQ(ranges[1].Last, 98);
  EXPECT_EQ(ranges[2].First, 99);
  EXPECT_EQ(ranges[2].Last, 99);
  EXPECT_EQ(*FindWire(ranges, 120), CalibrationTarget::WireX);
  EXPECT_EQ(*FindWire(ranges, 99), CalibrationTarget::WireZ);
  EXPECT_EQ(FindWire(ranges, 150), nullptr);
  EXPECT_TRUE(ReadWireRanges("", 5).empty());
  EXPECT_TRUE(ReadWireRanges(" , ", 5).empty());
}

TEST(WireRanges, WrongTextsAreNamed)
{
  for (const char* text : { "W 0-4", "X", "X -3", "X 0-", "X 4-2", "X 0-10", "X 0-4 Y 4-6",
         "X 0-4 5", "X 99999999999999999999", "X 1.5", "XY 0-3" })
  {
    EXPECT_THROW(ReadWireRanges(text, 10), std::invalid_argument) << text;
  }
  try
  {
    ReadWireRanges("X 0-4, Q 5-9", 10);
    FAIL();
  }
  catch (const std::invalid_argument& error)
  {
    EXPECT_NE(std::string(error.what()).find("'Q 5-9'"), std::string::npos) << error.what();
  }
}
