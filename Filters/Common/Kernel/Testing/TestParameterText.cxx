// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaParameterText.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

using namespace lacuna;

TEST(ParameterText, NumbersReadBackAsTheSame)
{
  constexpr double largest = std::numeric_limits<double>::max();
  for (const double x : { 0.1, 1.0 / 3, 123456.789, 1e-300, largest, -0.20000000000000001 })
  {
    EXPECT_EQ(std::stod(FormatNumber(x)), x);
    EXPECT_EQ(ParameterText().Add("X", x).Get(), "X=" + FormatNumber(x));
  }
  EXPECT_EQ(FormatNumber(0.1), "0.1");
  EXPECT_EQ(FormatNumber(0.1f), "0.1"); // not 0.10000000149011612
  EXPECT_EQ(FormatNumber(1234567.25), "1234567.25");
  EXPECT_EQ(FormatNumber(std::numeric_limits<double>::quiet_NaN()), "nan");
}

TEST(ParameterText, HasNamesValuesAndLists)
{
  const double spacing[3] = { 0.1, 1234567.25, 3 };
  const std::array<int, 2> size{ 640, 480 };
  const std::vector<std::string> columns{ "x", "y mm" };
  ParameterText text;
  text.Add("Spacing", spacing).Add("Size", size).Add("On", true).Add("Off", false);
  text.Add("Flags", static_cast<unsigned char>(7)).Add("Big", std::int64_t{ 1 } << 40);
  text.Add("Columns", columns).Add("None", std::vector<double>{});
  EXPECT_EQ(text.Get(),
    "Spacing=0.1,1234567.25,3 Size=640,480 On=on Off=off Flags=7 Big=1099511627776 "
    "Columns=x,\"y mm\" None=");
  EXPECT_EQ(ParameterText().Get(), "");
}

TEST(ParameterText, WordsAreQuotedWhereNeeded)
{
  EXPECT_EQ(QuoteWord("Gate"), "Gate");
  EXPECT_EQ(QuoteWord("sweep-01.mha"), "sweep-01.mha");
  EXPECT_EQ(QuoteWord(""), "\"\"");
  EXPECT_EQ(QuoteWord("a b"), "\"a b\"");
  EXPECT_EQ(QuoteWord("a=b"), "\"a=b\"");
  EXPECT_EQ(QuoteWord("1,2"), "\"1,2\"");
  EXPECT_EQ(QuoteWord("a\"b\\c"), "\"a\\\"b\\\\c\"");
  EXPECT_EQ(QuoteWord("a\nb\tc\r"), "\"a\\nb\\tc\\r\"");
  const char* null = nullptr;
  EXPECT_EQ(ParameterText().Add("Name", null).Add("Mode", "Mean").Get(), "Name=\"\" Mode=Mean");
}

TEST(ParameterText, HashesAreThoseOfFNV1a)
{
  EXPECT_EQ(HashText(""), "cbf29ce484222325"); // draft-eastlake-fnv, appendix C
  EXPECT_EQ(HashText("a"), "af63dc4c8601ec8c");
  EXPECT_EQ(HashText("foobar"), "85944171f73967e8");
}
