// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaToolPath.h"

#include "lacunaMaterialRemoval.h"
#include "lacunaToolPathScene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace lacuna;
using namespace lacunaMill;

//------------------------------------------------------------------------------
TEST(ToolPath, FinishingOfTheGoal)
{
  const MillSurface surface = Surface(121, 121, 1, Mould);
  ToolPathOptions options;
  options.LeadRadius = 0;
  const ToolPath path = Path(surface, options);
  CheckForm(path);
  // down, to and fro on 121 lines without a break, up
  EXPECT_EQ(path.Runs.size(), 3u);
  EXPECT_EQ(path.Runs[1].Kind, Motion::Cut);
  EXPECT_GE(path.Runs[1].Count, 14641);
  EXPECT_DOUBLE_EQ(path.LargestStepOver, 1);
  Judge judge(surface, options.Tool);
  const double depth = judge.LargestDepth(path, 10000000);
  EXPECT_GE(judge.GetChecks(), 10000000);
  EXPECT_LE(depth, 0.001);
  EXPECT_GT(depth, -0.01) << "the tool touches";
}

//------------------------------------------------------------------------------
TEST(ToolPath, NoGougeOnWallsSpikesAndPits)
{
  for (const MillTool& tool : { Ball, Flat, MillTool{ ToolShape::Ball, 0.7 } })
  {
    for (const double direction : { 0.0, 90.0, 33.0, -120.0 })
    {
      for (const bool oneWay : { false, true })
      {
        const bool bent = direction == 33;
        const MillSurface surface = bent ? Bent(Noise) : Surface(36, 26, 0.75, Rough);
        ToolPathOptions options;
        options.Tool = tool;
        options.Direction = direction;
        options.OneWay = oneWay;
        options.StepOver = 1.1;
        options.RoughingStep = 2;
        options.RoughingStepOver = 1.3;
        options.StockTop = 8;
        const ToolPath path = Path(surface, options);
        CheckForm(path);
        Judge judge(surface, tool);
        EXPECT_LE(judge.LargestDepth(path, 150000), 0.001)
          << tool.Radius << " " << direction << " " << oneWay;
        ThreadExecution execution(2);
        const LeftOverMap map = MapLeftOver(execution, surface, tool, path, 0.2);
        EXPECT_LE(map.LargestGouge, 0.001);
      }
    }
  }
}

//------------------------------------------------------------------------------
TEST(ToolPath, LevelsLeaveTheAllowance)
{
  const MillSurface surface = Surface(41, 31, 1,
    [](double x, double y) { return 0.01 * (x - 20) * (x - 20) - 0.02 * (y - 9) * (y - 9) - 3; });
  for (const MillTool& tool : { Ball, Flat })
  {
    ToolPathOptions options;
    options.Tool = tool;
    options.Finishing = false;
    options.RoughingStep = 1.5;
    options.RoughingStepOver = 1;
    options.StockAllowance = 0.5;
    options.StockTop = 2;
    const ToolPath path = Path(surface, options);
    CheckForm(path);
    EXPECT_GE(path.Levels, 5);
    ThreadExecution execution(2);
    const LeftOverMap map = MapLeftOver(execution, surface, tool, path, 1);
    for (std::size_t k = 0; k < map.Points.size(); ++k)
    {
      const double left = map.LeftOver[k];
      ASSERT_GE(left, 0.5 - 0.001);
      // scallops of the ball, and the flat end's steps on slopes of up to 0.9; where the border
      // slopes down outwards the ball would have to leave the rectangle
      const bool within = std::abs(map.Points[k][1] - 15) < 11;
      ASSERT_LE(left, tool.Shape == ToolShape::Ball && within ? 0.6 : 3.6);
    }
    // no level is deeper than a step below the one before: what is cut stays within reach
    for (const ToolPath::Run& run : path.Runs)
    {
      for (std::int64_t k = run.First; run.Kind == Motion::Cut && k < run.First + run.Count; ++k)
      {
        ASSERT_GE(path.Points[k][2], 2 - 1.5 * (run.Pass + 1) - 1e-9);
      }
    }
  }
}

//------------------------------------------------------------------------------
// A mould with a flat border: the tool goes on at the border's height outside of it, on all sides and
// in all passes, and the block's rim is cut as if it were in the middle.
TEST(ToolPath, OverrunClearsTheBlocksEdge)
{
  const auto height = [](double x, double y)
  {
    const double r2 = std::min(1.0, (x - 16) * (x - 16) / 144 + (y - 13) * (y - 13) / 100);
    return -5 * (1 - r2) * (1 - r2);
  };
  const MillSurface surface = Surface(61, 41, 0.75, height, -3, -2);
  for (const MillTool& tool : { Ball, Flat })
  {
    for (const double direction : { 0.0, 90.0, 27.0 })
    {
      for (const double scallop : { 0.0, 0.02 })
      {
        ToolPathOptions options;
        options.Tool = tool;
        options.Direction = direction;
        options.ScallopHeight = tool.Shape == ToolShape::Ball ? scallop : 0;
        options.RoughingStep = 2;
        options.StockTop = 1;
        options.Overrun = 5;
        const ToolPath path = Path(surface, options);
        CheckForm(path);
        Judge judge(surface, tool);
        EXPECT_LE(judge.LargestDepth(path, 100000), 0.001);
        const MaterialRemoval removal(path, tool);
        std::int64_t nearest = -1;
        double highest = -1;
        double lowest = 1;
        // a frame of 4 mm within the border and 4 mm outside of it; where lines end aslant, the last
        // step is uneven
        for (double x = -7; x <= 46; x += 0.31)
        {
          for (double y = -6; y <= 32; y += 0.23)
          {
            if (x < 1 || x > 38 || y < 2 || y > 24)
            {
              const double z = removal.At({ x, y, 0 }, nearest).Height;
              highest = std::max(highest, z);
              lowest = std::min(lowest, z);
            }
          }
        }
        EXPECT_GE(lowest, -1e-9);
        EXPECT_LE(highest, tool.Shape == ToolShape::Ball ? (scallop > 0 ? 0.021 : 0.033) : 1e-9)
          << direction;
      }
    }
  }
  // slopes and cliffs at the border, whatever way they go
  for (const bool bent : { false, true })
  {
    const MillSurface rough = bent ? Bent(Noise) : Surface(36, 26, 0.75, Rough);
    for (const MillTool& tool : { Ball, Flat })
    {
      ToolPathOptions options;
      options.Tool = tool;
      options.Overrun = 3;
      options.Direction = 20;
      const ToolPath path = Path(rough, options);
      CheckForm(path);
      EXPECT_LE(Judge(rough, tool).LargestDepth(path, 150000), 0.001);
    }
  }
}

//------------------------------------------------------------------------------
// A border that slopes down, straight or bent, on all sides: a ball goes on outside of it until it has
// touched the edge, and no deeper than that takes, however far the lines go on.
TEST(ToolPath, OverrunReachesABorderThatSlopesDown)
{
  const auto left = [](const MillSurface& surface, double overrun)
  {
    ToolPathOptions options;
    options.StepOver = 0.5;
    options.Overrun = overrun;
    const ToolPath path = Path(surface, options);
    CheckForm(path);
    EXPECT_LE(Judge(surface, Ball).LargestDepth(path, 100000), 0.001);
    for (const Vec3& p : path.Points)
    {
      EXPECT_GE(p[2], surface.GetLowest()[2] - Ball.Radius);
    }
    ThreadExecution execution(2);
    const LeftOverMap map = MapLeftOver(execution, surface, Ball, path, 0.25);
    EXPECT_LT(map.LargestGouge, 0.001);
    double largest = 0;
    for (std::size_t k = 0; k < map.Points.size(); ++k)
    {
      largest = std::max(largest, map.LeftOver[k] - map.Unreachable[k]);
    }
    return largest;
  };
  const MillSurface roof = Surface(57, 45, 0.5,
    [](double x, double y) { return -0.8 * std::abs(x - 14) - 0.5 * std::abs(y - 11); });
  const MillSurface cap = Surface(57, 45, 0.5,
    [](double x, double y)
    { return std::sqrt(24.0 * 24.0 - (x - 14) * (x - 14) - (y - 11) * (y - 11)); });
  for (const MillSurface* surface : { &roof, &cap })
  {
    EXPECT_GT(left(*surface, 0), 0.3);
    EXPECT_LT(left(*surface, 4), 0.03);
    EXPECT_LT(left(*surface, 30), 0.03);
  }
  // a step down just inside of the border: no more than without
  const MillSurface step = Surface(57, 45, 0.5,
    [](double x, double y) { return x < 1 || x > 27 || y < 1 || y > 21 ? -6.0 : 0.0; });
  EXPECT_LE(left(step, 4), left(step, 0));
  for (const MillTool& tool : { Ball, Flat })
  {
    const DropCutter cutter(roof, tool);
    DropCutter::Scratch scratch;
    // a flat end touches the edge with its face: no deeper than that
    const double deepest = roof.GetLowest()[2] - (tool.Shape == ToolShape::Ball ? 4 : 0);
    for (double out = 0; out < 60; out += 0.7)
    {
      const double z = cutter.DropBeyond(-out, 3, scratch);
      EXPECT_GE(z, deepest) << out;
      EXPECT_GE(z, cutter.Drop(-out, 3, scratch)) << out;
    }
  }
}

//------------------------------------------------------------------------------
TEST(ToolPath, ScallopsOnAPlane)
{
  const MillSurface plane = Surface(31, 31, 1, [](double, double) { return -2.0; });
  ToolPathOptions options;
  options.StepOver = 1;
  const ToolPath path = Path(plane, options);
  ThreadExecution execution(2);
  const LeftOverMap map = MapLeftOver(execution, plane, Ball, path, 0.1);
  EXPECT_EQ(map.Size.Columns, 301);
  const double scallop = 4 - std::sqrt(16 - 0.25);
  EXPECT_NEAR(map.LargestLeftOver, scallop, 0.01 * scallop);
  EXPECT_EQ(map.LargestGouge, 0);
  for (std::size_t k = 0; k < map.Points.size(); ++k)
  {
    if (std::abs(map.Points[k][0] - 15) > 14)
    {
      continue; // there the tool goes from line to line
    }
    const double away = map.Points[k][1] - std::round(map.Points[k][1]);
    ASSERT_NEAR(map.LeftOver[k], std::sqrt(16 + away * away) - 4, 1e-9);
    ASSERT_NEAR(map.Height[k], -2 + 4 - std::sqrt(16 - away * away), 1e-9);
    ASSERT_EQ(map.Unreachable[k], 0);
  }
}

//------------------------------------------------------------------------------
// The first line touches a corner; it is a micrometre long, and shorter still than a step.
TEST(ToolPath, LinesThatTouchACorner)
{
  const MillSurface plane = Surface(31, 31, 1, [](double, double) { return -2.0; });
  for (const double direction : { 1.0, 3.0, 5.0, 7.0, -5.0, 84.0, 95.0 })
  {
    for (const double step : { 0.3, 1.0, 1.2, 2.0, 5.0 })
    {
      ToolPathOptions options;
      options.Direction = direction;
      options.PathStep = step;
      const ToolPath path = Path(plane, options);
      CheckForm(path);
      EXPECT_TRUE(std::all_of(path.Points.begin(), path.Points.end(),
        [](const Vec3& p) { return std::isfinite(p[0] + p[1] + p[2]); }));
    }
  }
}

//------------------------------------------------------------------------------
TEST(ToolPath, StepOverFromScallopHeight)
{
  EXPECT_NEAR(GetStepOver(4, 0.01), 0.5655, 1e-3);
  // the slope grows across the lines, up to 45 degrees
  const auto slope = [](double, double y) { return 0.0125 * y * y; };
  const MillSurface surface = Surface(41, 81, 0.5, slope);
  ToolPathOptions options;
  options.ScallopHeight = 0.02;
  const ToolPath path = Path(surface, options);
  EXPECT_LT(path.SmallestStepOver, 0.75 * path.LargestStepOver);
  ThreadExecution execution(2);
  const LeftOverMap map = MapLeftOver(execution, surface, Ball, path, 0.05);
  double largest = 0;
  for (std::size_t k = 0; k < map.Points.size(); ++k)
  {
    const Vec3& p = map.Points[k];
    if (p[1] > 3 && p[1] < 37) // away from borders, where no line comes
    {
      largest = std::max(largest, map.LeftOver[k]);
    }
  }
  EXPECT_LE(largest, 0.0225);
  EXPECT_GE(largest, 0.015);
}

//------------------------------------------------------------------------------
TEST(ToolPath, SameBitsForAnyNumberOfThreads)
{
  const MillSurface surface = Surface(36, 26, 0.75, Rough);
  for (const double scallop : { 0.0, 0.05 })
  {
    ToolPathOptions options;
    options.RoughingStep = 2;
    options.ScallopHeight = scallop;
    const ToolPath expected = Path(surface, options, 1);
    for (const int threads : { 2, 5 })
    {
      const ToolPath path = Path(surface, options, threads);
      EXPECT_EQ(path.Points, expected.Points);
      EXPECT_EQ(path.Runs.size(), expected.Runs.size());
      ThreadExecution one(1);
      ThreadExecution execution(threads);
      EXPECT_EQ(MapLeftOver(execution, surface, Ball, path, 0.3).LeftOver,
        MapLeftOver(one, surface, Ball, expected, 0.3).LeftOver);
    }
  }
}
