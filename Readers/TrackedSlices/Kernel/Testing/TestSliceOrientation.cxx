// SPDX-License-Identifier: BSD-3-Clause
#include "SequenceFile.h"
#include "lacunaSliceOrientation.h"

#include <gtest/gtest.h>

#include <cstring>

using namespace lacuna;

namespace
{
std::string Describe(const std::string& orientation, const std::string& type = {})
{
  const SliceFlips flips = GetSliceFlips(orientation, type);
  return std::string(flips.X ? "x" : "-") + (flips.Y ? "y" : "-") + (flips.Lines ? "l" : "");
}
}

TEST(SliceOrientation, Pixels)
{
  for (const char* type : { "", "BRIGHTNESS", "RGB_COLOR", "US_IMG_BRIGHTNESS" })
  {
    EXPECT_EQ(Describe("MF", type), "--");
    EXPECT_EQ(Describe("MFA", type), "--");
    EXPECT_EQ(Describe("MFD", type), "--"); // the third axis is not one of a slice
    EXPECT_EQ(Describe("UF", type), "x-");
    EXPECT_EQ(Describe("UFD", type), "x-");
    EXPECT_EQ(Describe("MN", type), "-y");
    EXPECT_EQ(Describe("UNA", type), "xy");
    EXPECT_EQ(Describe(" US_IMG_ORIENT_UN ", type), "xy");
    EXPECT_EQ(Describe("un", type), "xy");
    // what PLUS takes as the same
    EXPECT_EQ(Describe("MN", type), Describe("MND", type));
    EXPECT_EQ(Describe("UF", type), Describe("UFA", type));
    EXPECT_EQ(Describe("UN", type), Describe("UND", type));
  }
}

TEST(SliceOrientation, Lines)
{
  // grey levels before scan conversion are lines as signals are
  for (const char* type : { "RF_REAL", "BRIGHTNESS", "", "US_IMG_BRIGHTNESS", "RGB_COLOR", "XX" })
  {
    EXPECT_EQ(Describe("FM", type), "--l") << type;
    EXPECT_EQ(Describe("NM", type), "x-l") << type;
    EXPECT_EQ(Describe("FU", type), "-yl") << type;
    EXPECT_EQ(Describe("US_IMG_ORIENT_NU", type), "xyl") << type;
    EXPECT_EQ(Describe("FMA", type), "--l") << type;
    EXPECT_EQ(Describe("NUD", type), "xyl") << type;
  }
  EXPECT_EQ(Describe("FM", "RF_IQ_LINE"), "--l");
  EXPECT_EQ(Describe("FM", "RF_I_LINE_Q_LINE"), "--l");
  EXPECT_EQ(Describe("NM", "RF_I_LINE_Q_LINE"), "x-l"); // a row has I alone, or Q
}

TEST(SliceOrientation, RefusesWhatCannotBeRight)
{
  const auto error = [](const char* orientation, const char* type)
  { return GetError([&] { GetSliceFlips(orientation, type); }); };
  EXPECT_NE(error("MF", "RF_REAL").find("known are FM"), std::string::npos);
  EXPECT_NE(error("MF", "DOPPLER").find("'DOPPLER' is unknown"), std::string::npos);
  EXPECT_NE(error("NM", "RF_IQ_LINE").find("complex"), std::string::npos);
  EXPECT_NE(error("FU", "RF_I_LINE_Q_LINE").find("complex"), std::string::npos);
  for (const char* bad : { "", "M", "XX", "??", "MFX", "FMX", "MFAA", "AMF", "AUN", "MM", "FN" })
  {
    EXPECT_NE(error(bad, ""), "") << bad;
  }
}

TEST(SliceOrientation, NamesThatOthersWriteWhenTheyDoNotKnow)
{
  for (const char* unknown : { "", " ", "XX", "??", "US_IMG_ORIENT_XX" })
  {
    EXPECT_FALSE(IsKnownOrientation(unknown)) << unknown;
  }
  EXPECT_TRUE(IsKnownOrientation("MF"));
  EXPECT_TRUE(IsKnownOrientation("AMF")); // known, but not read
  EXPECT_EQ(GetImageTypeName("BRIGHTNESSBRIGHTNESS"), "BRIGHTNESS");
  EXPECT_EQ(GetImageTypeName("BRIGHTNESSRF_REAL"), "RF_REAL");
  EXPECT_EQ(GetImageTypeName(" US_IMG_BRIGHTNESS "), "BRIGHTNESS");
}

TEST(SliceOrientation, FlipsEverySizeOfPixel)
{
  for (const std::size_t size : { 1, 2, 3, 4, 8, 12 })
  {
    for (const int columns : { 1, 4, 5 })
    {
      const int rows = 3;
      const auto byte = [&](int column, int row, std::size_t k)
      {
        return static_cast<unsigned char>(
          1 + k + size * static_cast<std::size_t>(column + columns * row));
      };
      for (int f = 0; f < 4; ++f)
      {
        std::vector<unsigned char> pixels;
        for (int i = 0; i < columns * rows; ++i)
        {
          for (std::size_t k = 0; k < size; ++k)
          {
            pixels.push_back(byte(i % columns, i / columns, k));
          }
        }
        const SliceFlips flips{ (f & 1) != 0, (f & 2) != 0 };
        FlipSlice(pixels.data(), columns, rows, size, flips);
        for (int i = 0; i < columns * rows; ++i)
        {
          const int column = flips.X ? columns - 1 - i % columns : i % columns;
          const int row = flips.Y ? rows - 1 - i / columns : i / columns;
          for (std::size_t k = 0; k < size; ++k)
          {
            ASSERT_EQ(pixels[static_cast<std::size_t>(i) * size + k], byte(column, row, k))
              << size << " " << columns << " " << f;
          }
        }
      }
    }
  }
}
