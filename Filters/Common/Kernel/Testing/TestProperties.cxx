// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaProperties.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <stdexcept>
#include <string>

namespace
{
using lacuna::Properties;
using lacuna::ValueRange;
constexpr std::array<const char*, 3> Sides{ "Automatic", "Outward", "Inward" };
constexpr std::array<const char*, 2> Places{ "Largest", "Nearest to Point" };

std::string GetError(const Properties& properties)
{
  try
  {
    properties.Check();
  }
  catch (const std::invalid_argument& error)
  {
    return error.what();
  }
  return "";
}
}

TEST(Properties, SaysWhatAChoiceMayBe)
{
  EXPECT_EQ(GetError(Properties().Add("Side", 0, Sides).Add("Side", 2, Sides)), "");
  for (const int wrong : { -1, 3 })
  {
    EXPECT_EQ(GetError(Properties().Add("Side", wrong, Sides)),
      "Side is " + std::to_string(wrong) + "; it must be 0 (Automatic), 1 (Outward) or 2 (Inward)");
  }
}

TEST(Properties, LeavesOutTheFirstChoices)
{
  constexpr std::array<const char*, 3> names{ "Refuse", "LeaveOut", "KeepOutliers" };
  const lacuna::Choices rules(names, 1);
  EXPECT_EQ(GetError(Properties().Add("BadPoses", 1, rules)), "");
  EXPECT_EQ(GetError(Properties().Add("BadPoses", 0, rules)),
    "BadPoses is 0; it must be 1 (LeaveOut) or 2 (KeepOutliers)");
}

TEST(Properties, SaysWhatANumberMayBe)
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  struct Case
  {
    ValueRange Allowed;
    const char* Text;
    std::array<double, 2> Right;
    std::array<double, 2> Wrong;
  };
  for (const Case& c :
    { Case{ ValueRange::Any("HU"), "a finite number", { -1e300, 0 }, { nan, infinity } },
      Case{ ValueRange::AtLeast(0, "mm"), "0 mm or more", { 0, 1e300 }, { -1e-300, infinity } },
      Case{ ValueRange::Above(0), "above 0", { 1e-300, 5 }, { 0, nan } },
      Case{
        ValueRange::Above(0, "mm").UpTo(5), "above 0 and at most 5 mm", { 1e-9, 5 }, { 0, 5.1 } },
      Case{ ValueRange::Between(-2, 0.5, "mm"), "from -2 to 0.5 mm", { -2, 0.5 }, { -2.1, 0.6 } },
      Case{ ValueRange::Any().UpTo(3), "at most 3", { -9, 3 }, { 3.1, -infinity } },
      Case{ ValueRange::Between(0.2, 5, "mm").OrZero("automatic"),
        "0 (automatic) or from 0.2 to 5 mm", { 0, 0.2 }, { 0.1, -0.1 } } })
  {
    EXPECT_EQ(c.Allowed.Describe(), c.Text);
    for (const double right : c.Right)
    {
      EXPECT_EQ(GetError(Properties().Add("Size", right, c.Allowed)), "") << c.Text << right;
    }
    for (const double wrong : c.Wrong)
    {
      const std::string unit = *c.Allowed.Unit ? std::string(" ") + c.Allowed.Unit : "";
      EXPECT_EQ(GetError(Properties().Add("Size", wrong, c.Allowed)),
        "Size is " + lacuna::FormatNumber(wrong) + unit + "; it must be " + c.Text);
    }
  }
}

TEST(Properties, RefusesAnyNumberOfAList)
{
  const double sizes[3] = { 1, 2, -3 };
  EXPECT_EQ(GetError(Properties().Add("Sizes", sizes, ValueRange::AtLeast(0, "mm"))),
    "Sizes is -3 mm; it must be 0 mm or more");
}

TEST(Properties, WritesNamesOfChoicesAndAllElseAsItIs)
{
  const double sizes[2] = { 0.1, 2 };
  EXPECT_EQ(Properties()
              .Add("Name", std::string("left side"))
              .Add("Side", 1, Sides)
              .Add("Place", 1, Places)
              .Add("Sizes", sizes, ValueRange::AtLeast(0))
              .Add("Count", 7, ValueRange::AtLeast(1))
              .GetText(),
    "Name=\"left side\" Side=Outward Place=\"Nearest to Point\" Sizes=0.1,2 Count=7");
}
