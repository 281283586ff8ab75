// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaHounsfield.h"

#include <gtest/gtest.h>

#include <cstring>
#include <stdexcept>
#include <vector>

using namespace lacuna;

namespace
{
CTFrame MakeFrame(int allocated, int stored, int high, bool isSigned)
{
  auto header = std::make_shared<CTFileHeader>();
  header->File = "/scan/IM1";
  header->Format = { allocated, stored, high, isSigned };
  CTFrame frame;
  frame.Header = header;
  frame.RescaleSlope = 1;
  frame.RescaleIntercept = 0;
  return frame;
}
}

// All positions of the stored bits, with garbage in the others.
TEST(Hounsfield, Bits)
{
  for (const int allocated : { 8, 16, 32 })
  {
    for (int stored = 1; stored <= std::min(allocated, 24); ++stored)
    {
      for (const int high : { stored - 1, allocated - 1, (stored - 1 + allocated - 1) / 2 })
      {
        for (const bool isSigned : { false, true })
        {
          const HounsfieldScale scale(MakeFrame(allocated, stored, high, isSigned), 0);
          const std::int64_t span = std::int64_t{ 1 } << stored;
          const std::int64_t lowest = isSigned ? -span / 2 : 0;
          EXPECT_EQ(scale.GetRange(),
            std::make_pair(static_cast<double>(lowest), static_cast<double>(lowest + span - 1)));
          for (const std::int64_t value :
            { lowest, lowest + 1, lowest + span / 3, lowest + span - 1 })
          {
            const int shift = high + 1 - stored;
            const std::uint64_t mask = static_cast<std::uint64_t>(span - 1) << shift;
            const std::uint64_t bits =
              ((static_cast<std::uint64_t>(value) << shift) & mask) | (0xA5A5A5A5U & ~mask);
            unsigned char bytes[8];
            std::memcpy(bytes, &bits, 8);
            std::int32_t result = 0;
            scale.Convert(bytes, 1, &result);
            EXPECT_EQ(result, value) << allocated << " " << stored << " " << high << isSigned;
          }
        }
      }
    }
  }
}

TEST(Hounsfield, RescaleAndPadding)
{
  CTFrame frame = MakeFrame(16, 16, 15, true);
  auto header = std::make_shared<CTFileHeader>(*frame.Header);
  header->Padding = -1000;
  header->PaddingLimit = -2000;
  frame.Header = header;
  frame.RescaleSlope = 0.5;
  frame.RescaleIntercept = -3;
  const std::int16_t stored[4] = { 7, -1000, -1500, -2001 };
  float values[4];
  HounsfieldScale(frame, -1024).Convert(reinterpret_cast<const unsigned char*>(stored), 4, values);
  EXPECT_EQ(values[0], 0.5F);
  EXPECT_EQ(values[1], -1024);
  EXPECT_EQ(values[2], -1024);
  EXPECT_EQ(values[3], -1003.5F);
}

// Whole numbers: every stored value of 16 bits, with padding, slope and values put where the pixels
// were; and pixels that are decoded as more than the header said.
TEST(Hounsfield, WholeNumbers)
{
  for (const int stored : { 11, 16 })
  {
    for (const bool isSigned : { false, true })
    {
      for (const int slope : { 1, -1, 3 })
      {
        CTFrame frame = MakeFrame(16, stored, stored - 1, isSigned);
        auto header = std::make_shared<CTFileHeader>(*frame.Header);
        header->Padding = isSigned ? -7 : 5;
        header->PaddingLimit = 70000; // beyond what can be stored
        frame.Header = slope == 3 ? header : frame.Header;
        frame.RescaleSlope = slope;
        frame.RescaleIntercept = -1024;
        const HounsfieldScale scale(frame, -5000);
        std::vector<std::int32_t> wide(1 << 16);
        std::vector<std::uint16_t> pixels(wide.size());
        for (std::size_t i = 0; i < pixels.size(); ++i)
        {
          pixels[i] = static_cast<std::uint16_t>(i);
        }
        const auto* bytes = reinterpret_cast<const unsigned char*>(pixels.data());
        scale.Convert(bytes, static_cast<std::int64_t>(pixels.size()), wide.data());
        const int span = 1 << stored;
        for (int i = 0; i < 1 << 16; ++i)
        {
          const int low = i % span;
          const int value = isSigned && low >= span / 2 ? low - span : low;
          const bool padded = slope == 3 && value >= *header->Padding;
          ASSERT_EQ(wide[i], padded ? -5000 : slope * value - 1024) << i;
        }
        if (stored == 11)
        {
          scale.Convert(bytes, static_cast<std::int64_t>(pixels.size()),
            reinterpret_cast<std::int16_t*>(pixels.data()));
          for (std::size_t i = 0; i < pixels.size(); ++i)
          {
            ASSERT_EQ(static_cast<std::int16_t>(pixels[i]), wide[i]);
          }
        }
      }
    }
  }
  const HounsfieldScale beyond(MakeFrame(16, 16, 15, false), 0);
  const std::uint16_t pixels[2] = { 7, 40000 };
  std::int16_t values[2];
  beyond.Convert(reinterpret_cast<const unsigned char*>(pixels), 1, values);
  EXPECT_EQ(values[0], 7);
  EXPECT_THROW(
    beyond.Convert(reinterpret_cast<const unsigned char*>(pixels), 2, values), std::runtime_error);
}

TEST(Hounsfield, Types)
{
  CTFrame frame = MakeFrame(16, 12, 11, false);
  frame.RescaleIntercept = -1024;
  EXPECT_EQ(GetHounsfieldType({ frame }, -1024), ScalarType::Int16);
  EXPECT_EQ(GetHounsfieldType({ frame }, -1024.5), ScalarType::Float32);
  EXPECT_EQ(GetHounsfieldType({ frame }, -40000), ScalarType::Int32);
  CTFrame wide = MakeFrame(16, 16, 15, false);
  EXPECT_EQ(GetHounsfieldType({ frame, wide }, -1024), ScalarType::Int32);
  frame.RescaleSlope = 1.5;
  EXPECT_EQ(GetHounsfieldType({ frame }, -1024), ScalarType::Float32);
  EXPECT_EQ(GetHounsfieldType({ MakeFrame(32, 32, 31, false) }, 0), ScalarType::Float32);
}

TEST(Hounsfield, RescaleType)
{
  std::vector<CTFrame> frames(3, MakeFrame(16, 12, 11, false));
  EXPECT_EQ(CheckRescaleType(frames), "");
  frames[0].RescaleType = "HU";
  frames[2].RescaleType = "hu";
  EXPECT_EQ(CheckRescaleType(frames), "");
  for (const char* written : { "Hounsfield Unit", "HOUNSFIELD", "hounsfield units" })
  {
    frames[1].RescaleType = written;
    EXPECT_EQ(CheckRescaleType(frames), "");
  }
  for (const char* open : { "US", "HU_MOD" })
  {
    frames[1].RescaleType = open;
    EXPECT_EQ(CheckRescaleType(frames).find("IM1: Rescale Type (0028,1054) is " +
                std::string(open) + ", unspecified or modified units; its values are taken"),
      0U);
  }
  for (const char* other : { "OD", "Z_EFF", "ED", "MGML", "PCT", "HUGE", "no Hounsfield" })
  {
    frames[2].RescaleType = other;
    try
    {
      CheckRescaleType(frames);
      ADD_FAILURE() << other;
    }
    catch (const std::runtime_error& e)
    {
      EXPECT_EQ(std::string(e.what()).find("IM1: Rescale Type (0028,1054) is " +
                  std::string(other) + ", so its values are not Hounsfield units"),
        0U);
    }
  }
}

TEST(Hounsfield, RefusesWhatCannotBe)
{
  for (const CTFrame& bad :
    { MakeFrame(12, 12, 11, false), MakeFrame(16, 17, 16, false), MakeFrame(16, 12, 10, false),
      MakeFrame(16, 12, 16, false), MakeFrame(16, 0, 0, false), MakeFrame(0, 0, 0, false) })
  {
    EXPECT_THROW(HounsfieldScale(bad, 0), std::runtime_error);
  }
  CTFrame frame = MakeFrame(16, 12, 11, false);
  for (const double air : { HUGE_VAL, -1e300, std::nan("") })
  {
    EXPECT_THROW(GetHounsfieldType({ frame }, air), std::runtime_error) << air;
  }
  EXPECT_EQ(GetHounsfieldType({ frame }, 3e38), ScalarType::Float32);
  frame.RescaleSlope = 1e36; // 4095 of it are beyond a float
  EXPECT_THROW(GetHounsfieldType({ frame }, 0), std::runtime_error);
  frame.RescaleSlope = 1e300;
  EXPECT_THROW(GetHounsfieldType({ frame }, 0), std::runtime_error);
  frame.RescaleIntercept.reset();
  EXPECT_THROW(HounsfieldScale(frame, 0), std::runtime_error);
}
