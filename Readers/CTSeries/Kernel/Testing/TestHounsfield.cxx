// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaHounsfield.h"

#include <gtest/gtest.h>

#include <cstring>
#include <stdexcept>

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

TEST(Hounsfield, RefusesWhatCannotBe)
{
  for (const CTFrame& bad :
    { MakeFrame(12, 12, 11, false), MakeFrame(16, 17, 16, false), MakeFrame(16, 12, 10, false),
      MakeFrame(16, 12, 16, false), MakeFrame(16, 0, 0, false), MakeFrame(0, 0, 0, false) })
  {
    EXPECT_THROW(HounsfieldScale(bad, 0), std::runtime_error);
  }
  CTFrame frame = MakeFrame(16, 12, 11, false);
  frame.RescaleIntercept.reset();
  EXPECT_THROW(HounsfieldScale(frame, 0), std::runtime_error);
}
