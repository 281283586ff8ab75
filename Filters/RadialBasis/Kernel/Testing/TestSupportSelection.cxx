// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSupportSelection.h"

#include "lacunaExecution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace
{
using lacuna::MarkedMap;
using lacuna::SupportUse;

// A plane of 60 x 70 pixels of 1.5 x 1 mm with a hole as defect, a burr hole, and a plateau 3 mm
// nearer, whose edges are steeper than 65 degrees along y (71.6) and not along x (63.4).
MarkedMap MakeMap()
{
  MarkedMap map;
  map.Grid.Width = 60;
  map.Grid.Height = 70;
  map.Grid.Spacing = { 1.5, 1 };
  map.Grid.FirstColumn = -7;
  for (std::size_t pixel = 0; pixel < map.Grid.GetSize(); ++pixel)
  {
    const double x = 1.5 * static_cast<double>(pixel % 60);
    const std::size_t row = pixel / 60;
    const auto y = static_cast<double>(row);
    const bool burr = std::hypot(x - 66, y - 40) <= 2;
    const bool plateau = x > 30 && x < 55 && y > 53.5;
    map.Valid.push_back(!burr);
    map.Depth.push_back(burr ? NAN : plateau ? 17 : 20);
    map.Defect.push_back(std::hypot(x - 45, y - 30) <= 15);
  }
  return map;
}

lacuna::SupportSelection Select(const MarkedMap& map, double stepMargin)
{
  lacuna::ThreadExecution execution(2);
  return lacuna::SelectSupport(execution, map, { 12, stepMargin }, {});
}

// Of two pixels, mm.
double GetDistance(std::size_t a, std::size_t b)
{
  const auto difference = [](std::size_t m, std::size_t n)
  { return static_cast<double>(m) - static_cast<double>(n); };
  return std::hypot(1.5 * difference(a % 60, b % 60), difference(a / 60, b / 60));
}

// A plane inclined by 17 degrees with a hole as defect, from which the bone falls to a far side:
// fall(x, y) is by how much, mm, NaN: no depth. x and y are mm from the centre of the hole.
template <class Fall>
MarkedMap MakeFall(const Fall& fall)
{
  MarkedMap map;
  map.Grid.Width = 80;
  map.Grid.Height = 60;
  for (std::size_t pixel = 0; pixel < map.Grid.GetSize(); ++pixel)
  {
    const double x = static_cast<double>(pixel % 80) - 35;
    const std::size_t row = pixel / 80;
    const double y = static_cast<double>(row) - 30;
    const double depth = 20 + 0.3 * x + fall(x, y);
    map.Defect.push_back(std::hypot(x, y) <= 15);
    map.Valid.push_back(!map.Defect.back() && std::isfinite(depth));
    map.Depth.push_back(depth);
  }
  return map;
}

// Nothing that has fallen carries the fit, the user hears of it, and the bone beside it stays.
template <class Fall>
void ExpectDivided(const Fall& fall, double stepMargin)
{
  const MarkedMap map = MakeFall(fall);
  const lacuna::SupportSelection selection = Select(map, stepMargin);
  std::size_t beyond = 0;
  std::size_t used = 0;
  for (std::size_t pixel = 0; pixel < map.Grid.GetSize(); ++pixel)
  {
    const double fallen = map.Depth[pixel] - 20 - 0.3 * (static_cast<double>(pixel % 80) - 35);
    beyond += selection.Use[pixel] == SupportUse::BeyondStep;
    used += selection.Support[pixel] && fallen == 0;
    EXPECT_FALSE(selection.Support[pixel] && fallen > 1) << pixel % 80 << " " << pixel / 80;
  }
  EXPECT_GT(beyond, 0U);
  EXPECT_GT(used, 200U);
  ASSERT_FALSE(selection.Warnings.empty());
  EXPECT_EQ(
    selection.Warnings[0].find(std::to_string(beyond) + " pixels around the defect, first"), 0U)
    << selection.Warnings[0];
  EXPECT_NE(selection.Warnings[0].find("beyond a depth step"), std::string::npos);
}
}

TEST(SupportSelection, LeavesOutAFarSideWiderThanTheMargin)
{
  for (const double depth : { 10.0, 30.0, 34.0, 60.0 })
  {
    SCOPED_TRACE(depth);
    const auto island = [depth](double x, double y)
    { return std::hypot(x - 22, y) < 7 ? depth : 0; };
    ExpectDivided(island, 0);
    ExpectDivided(island, 3);
    const auto ledge = [depth](double x, double) { return x > 19 ? depth : 0; };
    ExpectDivided(ledge, 0);
    ExpectDivided(ledge, 3);
    const auto ringed = [depth](double x, double y)
    {
      const double radius = std::hypot(x - 22, y);
      return radius < 5.5 ? 6 * depth : radius < 7 ? NAN : 0;
    };
    ExpectDivided(ringed, 0);
    ExpectDivided(ringed, 3);
  }
}

TEST(SupportSelection, LeavesOutWhatASteepGapDivides)
{
  // 68 to 76 degrees over pixels without a depth
  for (const auto& [depth, gap] : { std::pair{ 10.0, 2.5 }, { 15.0, 3.0 }, { 20.0, 4.0 } })
  {
    SCOPED_TRACE(depth);
    const auto island = [depth = depth, gap = gap](double x, double y)
    {
      const double radius = std::hypot(x - 22, y);
      return radius < 4 ? depth : radius < 4 + gap ? NAN : 0;
    };
    ExpectDivided(island, 0);
    ExpectDivided(island, 0.5);
  }
  // 45 degrees: a saw cut beside a flap that has sunk
  const auto flap = [](double x, double) { return x < 19 ? 0 : x < 22 ? NAN : 4.0; };
  const lacuna::SupportSelection selection = Select(MakeFall(flap), 0);
  EXPECT_TRUE(selection.Warnings.empty());
  EXPECT_TRUE(selection.Support[30 * 80 + 35 + 24]);
}

TEST(SupportSelection, LeavesOutTheFootOfARampWithTheMargin)
{
  // 73 and 77 degrees: steps to the margin, though not without it
  for (const auto& [depth, width] : { std::pair{ 9.0, 3.0 }, { 16.0, 4.0 } })
  {
    SCOPED_TRACE(depth);
    const auto ramp = [depth = depth, width = width](double x, double) {
      return x < 18 ? 0.0 : x < 18 + width ? (x - 18) / width * depth : depth;
    };
    ExpectDivided(ramp, 3);
    const lacuna::SupportSelection without = Select(MakeFall(ramp), 0);
    ASSERT_EQ(without.Warnings.size(), 1U);
    EXPECT_NE(without.Warnings[0].find("steeper than 65 degrees"), std::string::npos);
  }
}

TEST(SupportSelection, LeavesOutWhatIsNearStepsAndHoles)
{
  const MarkedMap map = MakeMap();
  std::vector<std::size_t> unsound;
  for (std::size_t pixel = 0; pixel < map.Grid.GetSize(); ++pixel)
  {
    const std::size_t row = pixel / 60;
    const bool edge = (row == 53 || row == 54) &&
      std::abs(map.Depth[row == 53 ? pixel + 60 : pixel - 60] - map.Depth[pixel]) > 1;
    if (!map.Valid[pixel] || edge)
    {
      unsound.push_back(pixel);
    }
  }
  ASSERT_GT(unsound.size(), 30U);
  const lacuna::SupportSelection all = Select(map, 0);
  for (const double margin : { 0.5, 3.0, 4.5 })
  {
    const lacuna::SupportSelection selection = Select(map, margin);
    int left = 0;
    for (std::size_t pixel = 0; pixel < map.Grid.GetSize(); ++pixel)
    {
      bool near = false;
      for (const std::size_t other : unsound)
      {
        near = near || GetDistance(pixel, other) <= margin;
      }
      left += near && all.Support[pixel];
      EXPECT_EQ(selection.Use[pixel],
        !all.Support[pixel] ? SupportUse::None
          : near            ? SupportUse::NearStep
                            : SupportUse::Used)
        << margin << ": " << pixel % 60 << " " << pixel / 60;
      EXPECT_EQ(selection.Support[pixel], all.Support[pixel] && !near);
    }
    EXPECT_GT(left, 10);
    EXPECT_TRUE(selection.Warnings.empty()) << "it was asked for";
  }
  EXPECT_EQ(all.Warnings.size(), 1U) << "of the steep edge of the plateau";
}

TEST(SupportSelection, StepsInTheDefectCountForItsRim)
{
  // The hole itself, marked exactly: its rim is left out.
  MarkedMap map = MakeMap();
  for (std::size_t pixel = 0; pixel < map.Grid.GetSize(); ++pixel)
  {
    map.Valid[pixel] = map.Valid[pixel] && !map.Defect[pixel];
  }
  const lacuna::SupportSelection selection = Select(map, 3);
  for (std::size_t pixel = 0; pixel < map.Grid.GetSize(); ++pixel)
  {
    const double x = 1.5 * static_cast<double>(pixel % 60);
    const std::size_t row = pixel / 60;
    const double radius = std::hypot(x - 45, static_cast<double>(row) - 30);
    if (radius < 16.5)
    {
      EXPECT_FALSE(selection.Support[pixel]);
    }
    else if (radius > 18 && radius < 20 && x < 45)
    {
      EXPECT_TRUE(selection.Support[pixel]) << pixel;
    }
  }
}

TEST(SupportSelection, WarnsOfNoSurfaceOnlyWhereNoneIs)
{
  // A hole in sound bone, and one that has bone on one side only: the step margin leaves half of the
  // rim, more or less.
  for (const auto& [margin, step] :
    { std::pair{ 12.0, 0.0 }, { 12.0, 3.0 }, { 12.0, 7.0 }, { 8.0, 4.0 }, { 5.0, 3.0 } })
  {
    SCOPED_TRACE(step);
    lacuna::ThreadExecution execution(2);
    const auto all = [](double, double) { return 0.0; };
    EXPECT_TRUE(
      lacuna::SelectSupport(execution, MakeFall(all), { margin, step }, {}).Warnings.empty());
    const auto half = [](double x, double) { return x > 0 ? NAN : 0.0; };
    const lacuna::SupportSelection open =
      lacuna::SelectSupport(execution, MakeFall(half), { margin, step }, {});
    ASSERT_EQ(open.Warnings.size(), 1U);
    EXPECT_NE(open.Warnings[0].find("the defect has no surface to fit"), std::string::npos);
  }
}

TEST(SupportSelection, HoldsForPaintedBone)
{
  MarkedMap map = MakeMap();
  map.Painted.assign(map.Grid.GetSize(), 1);
  const std::size_t beside = 40 * 60 + 46; // 3 mm from the centre of the burr hole
  EXPECT_EQ(Select(map, 0).Use[beside], SupportUse::Used);
  EXPECT_EQ(Select(map, 3).Use[beside], SupportUse::NearStep);
}

TEST(SupportSelection, RefusesAMarginThatLeavesNothing)
{
  try
  {
    Select(MakeMap(), 60);
    FAIL() << "nothing is left";
  }
  catch (const std::invalid_argument& e)
  {
    EXPECT_NE(std::string(e.what()).find("SupportStepMargin = 60 mm"), std::string::npos)
      << e.what();
  }
}
