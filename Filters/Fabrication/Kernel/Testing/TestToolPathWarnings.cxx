// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaToolPath.h"

#include "lacunaMaterialRemoval.h"
#include "lacunaParameterText.h"
#include "lacunaToolPathScene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

using namespace lacuna;
using namespace lacunaMill;

//------------------------------------------------------------------------------
TEST(ToolPathWarnings, SaysWhereTheToolDoesNotFit)
{
  // a groove with a round bottom of radius 2.5
  const auto groove = [](double x, double)
  {
    const double d = std::abs(x - 10);
    return d < 2 ? -std::sqrt(6.25 - d * d) + 1.5 : 0;
  };
  const MillSurface surface = Surface(201, 41, 0.1, groove);
  ThreadExecution execution(2);
  const std::vector<double> fits = FindUnreachable(execution, surface, { ToolShape::Ball, 2 });
  EXPECT_LT(*std::max_element(fits.begin(), fits.end()), 0.01);
  const std::vector<double> large = FindUnreachable(execution, surface, Ball);
  const auto worst = std::max_element(large.begin(), large.end()) - large.begin();
  EXPECT_NEAR(surface.GetPoints()[worst][0], 10, 0.11);
  // the ball rests on the edges, 2 mm to either side: its tip is at 4 - sqrt(16 - 4) below them
  EXPECT_NEAR(large[worst], 1 - (4 - std::sqrt(12.0)), 0.01);
  const std::vector<double> flat = FindUnreachable(execution, surface, Flat);
  EXPECT_NEAR(*std::max_element(flat.begin(), flat.end()), 1, 1e-6);
}

//------------------------------------------------------------------------------
// A full cut into solid stock is told, with how deep and where.
TEST(ToolPathWarnings, WarnsOfDeepCutsWithoutRoughing)
{
  double lowest = 0;
  const auto warnings = [&lowest](double depth, const std::function<void(ToolPathOptions&)>& change)
  {
    const MillSurface surface = Surface(41, 31, 1,
      [&](double x, double y) { return -depth * std::exp(-std::hypot(x - 30, y - 10) / 9); });
    ToolPathOptions options;
    change(options);
    std::string all;
    const ToolPath path = Path(surface, options);
    lowest = 0;
    for (const Vec3& p : path.Points)
    {
      lowest = std::min(lowest, p[2]);
    }
    for (const std::string& warning : path.Warnings)
    {
      all += warning + "\n";
    }
    return all;
  };
  const auto nothing = [](ToolPathOptions&) {};
  // the ball does not reach the tip
  const std::string told = warnings(18, nothing);
  EXPECT_LT(lowest, -12);
  EXPECT_NE(told.find("takes off up to " + FormatNumber(std::round(-100 * lowest) / 100) + " mm"),
    std::string::npos)
    << told;
  EXPECT_NE(told.find("z 0, to x 30, y 10"), std::string::npos) << told;
  EXPECT_EQ(warnings(4, nothing), "");
  // from the top of the stock, and as much as the tool's radius
  EXPECT_NE(
    warnings(4, [](auto& o) { o.StockTop = 3; }).find("(from StockTop, z 3,"), std::string::npos);
  EXPECT_EQ(warnings(4, [](auto& o) { o.StockTop = 0.1; }), "");
  EXPECT_NE(warnings(4, [](auto& o) { o.Tool.Radius = 2; }), "");
  // roughing in levels that are too deep
  const auto rough = [&](double step, double radius)
  {
    return warnings(18,
      [=](ToolPathOptions& o)
      {
        o.RoughingStep = step;
        o.Tool.Radius = radius;
      });
  };
  EXPECT_EQ(rough(4, 4), "");
  EXPECT_NE(
    rough(4.1, 4).find("a level of roughing takes off up to 4.1 mm at once"), std::string::npos);
  EXPECT_NE(rough(6, 2).find("a level of roughing takes off up to 6 mm"), std::string::npos);
  // all of it in one
  const std::string all = rough(100, 4);
  EXPECT_NE(all.find("a level of roughing takes off up to 1"), std::string::npos) << all;
  EXPECT_EQ(all.find("100"), std::string::npos) << all;
  EXPECT_EQ(warnings(4, [](auto& o) { o.RoughingStep = 100; }), "");
  EXPECT_EQ(warnings(18, [](auto& o) { o.RoughingStep = 2; }), "");
  EXPECT_EQ(warnings(18,
              [](auto& o)
              {
                o.RoughingStep = 2;
                o.Finishing = false;
              }),
    "");
}

//------------------------------------------------------------------------------
// By itself it roughs where the tool would be in over its radius, and there only.
TEST(ToolPathWarnings, RoughsByItself)
{
  const auto make = [](double depth, double step, bool finishing = true)
  {
    const MillSurface surface = Surface(41, 31, 1,
      [&](double x, double y) { return -depth * std::exp(-std::hypot(x - 30, y - 10) / 9); });
    ToolPathOptions options;
    options.RoughingStep = step;
    options.Finishing = finishing;
    return Path(surface, options);
  };
  constexpr double automatic = ToolPathOptions::AutomaticRoughing;
  const ToolPath deep = make(18, automatic);
  EXPECT_TRUE(deep.Warnings.empty());
  EXPECT_GT(deep.Levels, 3);
  EXPECT_EQ(deep.Points, make(18, 2).Points); // half of the radius of 4 mm
  const ToolPath shallow = make(3, automatic);
  EXPECT_EQ(shallow.Levels, 0);
  EXPECT_TRUE(shallow.Warnings.empty());
  EXPECT_EQ(shallow.Points, make(3, 0).Points);
  EXPECT_EQ(make(3, automatic, false).Points, make(3, 2, false).Points);
}

//------------------------------------------------------------------------------
TEST(ToolPathWarnings, RefusesBadInput)
{
  const auto plane = [](double, double) { return 0.0; };
  const auto message = [&](const std::function<void(std::vector<Vec3>&)>& change)
  {
    std::vector<Vec3> points = Surface(6, 5, 1, plane).GetPoints();
    change(points);
    return Message([&] { MillSurface({ 6, 5 }, points); });
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message([&](auto& p) { p[8][2] = nan; }).find("hole"), std::string::npos);
  EXPECT_NE(message([&](auto& p) { p[8][2] = nan; }).find("column 2, row 1"), std::string::npos);
  EXPECT_NE(message([](auto& p) { p[8][0] = 4.5; }).find("folds back"), std::string::npos);
  EXPECT_NE(message([](auto& p) { p[8] = p[7]; }).find("no area"), std::string::npos);
  EXPECT_NE(message([](auto& p) { p.clear(); }).find("2 x 2"), std::string::npos);
  EXPECT_NE(message([](auto& p) { p[8][2] = 1e9; }).find("100 m"), std::string::npos);
  const MillSurface surface = Surface(6, 5, 1, plane);
  const auto refuses = [&](const std::function<void(ToolPathOptions&)>& change)
  {
    ToolPathOptions options;
    change(options);
    return Message([&] { Path(surface, options); });
  };
  EXPECT_EQ(refuses([](auto&) {}), "no error");
  EXPECT_NE(refuses([](auto& o) { o.Tool.Radius = 0; }).find("ToolRadius"), std::string::npos);
  EXPECT_NE(refuses([&](auto& o) { o.Tool.Radius = nan; }).find("ToolRadius"), std::string::npos);
  EXPECT_EQ(refuses([](auto& o) { o.StepOver = 9; }),
    "StepOver is 9 mm; it must be at most the tool's diameter, 8 mm");
  EXPECT_EQ(refuses([](auto& o) { o.RoughingStepOver = 9; }),
    "RoughingStepOver is 9 mm; it must be at most the tool's diameter, 8 mm");
  EXPECT_NE(refuses([](auto& o) { o.StepOver = 0; }).find("0.01 mm or more"), std::string::npos);
  EXPECT_NE(refuses([](auto& o) { o.RoughingStep = 0.005; }).find("0.01 to"), std::string::npos);
  EXPECT_NE(refuses([](auto& o) { o.ScallopHeight = 4; }).find("ScallopHeight"), std::string::npos);
  EXPECT_NE(
    refuses([](auto& o) { o.ScallopHeight = 1e-40; }).find("ScallopHeight"), std::string::npos);
  EXPECT_NE(refuses([](auto& o) { o.Direction = 1e308; }).find("Direction"), std::string::npos);
  EXPECT_NE(refuses([](auto& o) { o.Finishing = false; }).find("nothing to do"), std::string::npos);
  EXPECT_NE(refuses([](auto& o) { o.Overrun = -1; }).find("Overrun"), std::string::npos);
  EXPECT_NE(refuses([&](auto& o) { o.Overrun = nan; }).find("Overrun"), std::string::npos);
  EXPECT_NE(refuses([&](auto& o) { o.Direction = nan; }).find("Direction"), std::string::npos);
  EXPECT_NE(refuses([](auto& o) { o.PathStep = -1; }).find("PathStep"), std::string::npos);
  EXPECT_NE(refuses([](auto& o) { o.RoughingStep = -2; }).find("RoughingStep"), std::string::npos);
  EXPECT_NE(refuses([&](auto& o) { o.StockTop = nan; }).find("StockTop"), std::string::npos);
  EXPECT_NE(refuses([](auto& o) { o.SafeHeight = 0; }).find("SafeHeight"), std::string::npos);
  EXPECT_NE(refuses([](auto& o) { o.LeadRadius = -1; }).find("LeadRadius"), std::string::npos);
  EXPECT_NE(refuses([](auto& o) { o.Tolerance = 0; }).find("Tolerance"), std::string::npos);
  // 20 000 lines on 10 000 levels
  const MillSurface wide = Surface(2, 2, 20000, plane);
  ToolPathOptions endless;
  endless.RoughingStepOver = 1;
  endless.RoughingStep = 9.9;
  endless.PathStep = 100;
  endless.StockTop = 99000;
  EXPECT_NE(Message([&] { Path(wide, endless); }).find("the roughing path"), std::string::npos);
  // no width at all
  const auto squeezed = [](int axis)
  {
    std::vector<Vec3> points = Surface(6, 5, 1, [](double, double) { return 0.0; }).GetPoints();
    for (Vec3& p : points)
    {
      p[axis] = 0;
    }
    return Message([&] { MillSurface({ 6, 5 }, points); });
  };
  EXPECT_NE(squeezed(0).find("no area"), std::string::npos);
  EXPECT_NE(squeezed(1).find("no area"), std::string::npos);
  // a single tool position covers all of a small part
  ToolPathOptions large;
  large.Tool.Radius = 500;
  large.StepOver = 1;
  CheckForm(Path(surface, large));
}

//------------------------------------------------------------------------------
TEST(ToolPathWarnings, Stops)
{
  const MillSurface surface = Surface(121, 121, 1, Mould);
  ThreadExecution execution(2, [](double) { return false; });
  EXPECT_THROW(MakeToolPath(execution, surface, {}), Aborted);
}
