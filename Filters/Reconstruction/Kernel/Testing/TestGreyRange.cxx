// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSliceRayCaster.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

using namespace lacuna;

namespace
{
// The window of 3 x 2 pixels at column 1 of 5 x 2.
template <class T>
SliceImage MakeWindow(const std::vector<T>& pixels)
{
  SliceImage slice;
  slice.Type = GetScalarType<T>();
  slice.Pixels = pixels.data() + 1;
  slice.RowStride = 5;
  slice.Width = 3;
  slice.Height = 2;
  return slice;
}

template <class T>
void ExpectRange(const std::vector<T>& pixels, double low, double high)
{
  GreyRange range;
  range.Update({ MakeWindow(pixels) });
  EXPECT_EQ(range.GetLow(), low);
  EXPECT_EQ(range.GetHigh(), high);
}
}

TEST(GreyRange, IsThatOfTheWindow)
{
  ExpectRange<std::uint8_t>({ 255, 9, 8, 7, 0, 255, 7, 12, 9, 0 }, 7, 12);
  ExpectRange<std::int8_t>({ 127, 9, -8, 7, -128, 127, 7, 12, 9, -128 }, -8, 12);
  ExpectRange<std::int16_t>({ 0, -9, -8, -7, 0, 0, -7, -12, -9, 0 }, -12, -7);
  ExpectRange<double>({ 9, 1, 2, 3, 9, 9, 0.5, 2, 1, 9 }, 0.5, 3);
}

TEST(GreyRange, LeavesOutWhatIsNotFinite)
{
  const float none = std::nanf("");
  const float infinity = std::numeric_limits<float>::infinity();
  ExpectRange<float>({ 9, 1, none, 3, 9, 9, infinity, -infinity, 2, 9 }, 1, 3);
  GreyRange range;
  EXPECT_FALSE(range.HasLevels());
  const std::vector<float> nothing(10, none);
  range.Update({ MakeWindow(nothing) });
  EXPECT_FALSE(range.HasLevels());
  EXPECT_FALSE(range.Contains(0));
}

TEST(GreyRange, LooksAtNewSlicesAlone)
{
  const std::vector<std::uint8_t> first(10, 50);
  const std::vector<std::uint8_t> second(10, 70);
  GreyRange range;
  range.Update({ MakeWindow(first) });
  SliceImage known = MakeWindow(first);
  known.Pixels = nullptr; // would crash
  range.Update({ known, MakeWindow(second) });
  EXPECT_TRUE(range.Contains(50));
  EXPECT_TRUE(range.Contains(70));
  EXPECT_FALSE(range.Contains(49));
  EXPECT_FALSE(range.Contains(71));
  known.Pixels = nullptr;
  range.Update({ known, known });
  EXPECT_EQ(range.GetHigh(), 70);
}
