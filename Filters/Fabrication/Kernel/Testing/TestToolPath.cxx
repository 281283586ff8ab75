// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaToolPath.h"

#include "lacunaExecution.h"
#include "lacunaMaterialRemoval.h"
#include "lacunaMillScene.h"
#include "lacunaParameterText.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>

using namespace lacuna;
using lacunaMill::Judge;
using lacunaMill::Mould;
using lacunaMill::Surface;

namespace
{
constexpr double Infinity = std::numeric_limits<double>::infinity();
constexpr MillTool Ball{ ToolShape::Ball, 4 };
constexpr MillTool Flat{ ToolShape::Flat, 3 };

// Cliffs, spikes and pits beside level ground.
double Rough(double x, double y)
{
  const double cliff = x + 0.3 * y > 14 ? 6 : 0;
  const double spike = std::hypot(x - 5, y - 9) < 0.6 ? 5 : 0;
  const double pit = std::hypot(x - 21, y - 6) < 1.6 ? -4 : 0;
  return cliff + spike + pit;
}

// A grid whose columns and rows are neither straight nor even.
MillSurface Bent(const std::function<double(double, double)>& height)
{
  std::vector<Vec3> points;
  for (int j = 0; j < 30; ++j)
  {
    for (int i = 0; i < 40; ++i)
    {
      const double x = 0.7 * i + 0.012 * i * j + 0.2 * std::sin(j);
      const double y = 0.8 * j - 0.1 * i + 0.01 * i * i;
      points.push_back({ x, y, height(x, y) });
    }
  }
  return MillSurface({ 40, 30 }, std::move(points));
}

double Noise(double x, double y)
{
  return std::sin(2.1 * x + std::cos(1.7 * y)) + 0.8 * std::cos(3.3 * y - 0.9 * x);
}

// By many points of the triangles.
double SampledFlatDrop(const MillSurface& surface, double radius, double x, double y)
{
  double best = -Infinity;
  const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c)
  {
    constexpr int n = 40;
    for (int i = 0; i <= n; ++i)
    {
      for (int j = 0; i + j <= n; ++j)
      {
        const Vec3 v = a + (double(i) / n) * (b - a) + (double(j) / n) * (c - a);
        if (std::hypot(v[0] - x, v[1] - y) < radius)
        {
          best = std::max(best, v[2]);
        }
      }
    }
  };
  for (std::int64_t j = 0; j + 1 < surface.GetSize().Rows; ++j)
  {
    for (std::int64_t i = 0; i + 1 < surface.GetSize().Columns; ++i)
    {
      add(surface.At(i, j), surface.At(i + 1, j), surface.At(i + 1, j + 1));
      add(surface.At(i, j), surface.At(i + 1, j + 1), surface.At(i, j + 1));
    }
  }
  return best;
}

std::string Message(const std::function<void()>& action)
{
  try
  {
    action();
  }
  catch (const std::exception& error)
  {
    return error.what();
  }
  return "no error";
}

ToolPath Path(const MillSurface& surface, const ToolPathOptions& options, int threads = 2)
{
  ThreadExecution execution(threads);
  return MakeToolPath(execution, surface, options);
}

// What every path must keep to.
void CheckForm(const ToolPath& path)
{
  ASSERT_FALSE(path.Runs.empty());
  EXPECT_EQ(path.Runs.front().Kind, Motion::Plunge);
  EXPECT_EQ(path.Points.front()[2], path.SafeZ);
  EXPECT_EQ(path.Runs.back().Kind, Motion::Rapid);
  std::int64_t next = 0;
  for (std::size_t r = 0; r < path.Runs.size(); ++r)
  {
    const ToolPath::Run& run = path.Runs[r];
    EXPECT_EQ(run.First, next);
    next += run.Count;
    ASSERT_GE(run.Count, 2);
    ASSERT_TRUE(r == 0 || path.Points[run.First] == path.Points[run.First - 1]) << r;
    for (std::int64_t k = run.First; k < run.First + run.Count; ++k)
    {
      for (int c = 0; c < 3; ++c)
      {
        const double units = 1000 * path.Points[k][c];
        ASSERT_NEAR(units, std::round(units), 1e-6);
      }
      if (run.Kind == Motion::Rapid && k > run.First)
      {
        const Vec3 d = path.Points[k] - path.Points[k - 1];
        const bool upright = d[0] == 0 && d[1] == 0;
        ASSERT_TRUE(upright ? d[2] >= 0 : d[2] == 0 && path.Points[k][2] == path.SafeZ) << r;
      }
      ASSERT_LE(path.Points[k][2], path.SafeZ);
    }
  }
  EXPECT_EQ(next, static_cast<std::int64_t>(path.Points.size()));
}
}

TEST(DropCutter, BallAgainstDistancesOfAllTriangles)
{
  std::mt19937 random(3);
  for (const MillTool tool :
    { Ball, MillTool{ ToolShape::Ball, 0.4 }, MillTool{ ToolShape::Ball, 9 } })
  {
    for (const bool bent : { false, true })
    {
      const MillSurface surface = bent ? Bent(Noise) : Surface(36, 26, 0.75, Rough);
      const DropCutter cutter(surface, tool);
      DropCutter::Scratch scratch;
      Judge judge(surface, tool);
      judge.Margin = 12;
      std::uniform_real_distribution<double> x(
        surface.GetLowest()[0] + 1, surface.GetHighest()[0] - 1);
      std::uniform_real_distribution<double> y(3, 12);
      int found = 0;
      for (int k = 0; k < 60; ++k)
      {
        const double px = x(random);
        const double py = y(random);
        const double z = cutter.Drop(px, py, scratch);
        if (!std::isfinite(z))
        {
          EXPECT_LE(judge.Depth({ px, py, -3.0 }), 0) << px << " " << py;
          continue;
        }
        // it touches, cuts when a little lower and is free everywhere above
        ++found;
        EXPECT_NEAR(judge.Depth({ px, py, z }), 0, 1e-9) << px << " " << py << " " << bent;
        EXPECT_GT(judge.Depth({ px, py, z - 1e-4 }), 0) << px << " " << py << " " << bent;
        for (int i = 1; i < 40; ++i)
        {
          EXPECT_LE(judge.Depth({ px, py, z + 0.3 * i }), 1e-9) << px << " " << py << " " << bent;
        }
      }
      EXPECT_GT(found, 30);
    }
  }
}

TEST(DropCutter, FlatAgainstManyPoints)
{
  std::mt19937 random(3);
  const MillSurface surface = Bent(Noise);
  const DropCutter cutter(surface, Flat);
  DropCutter::Scratch scratch;
  std::uniform_real_distribution<double> x(3, 22);
  std::uniform_real_distribution<double> y(3, 12);
  for (int k = 0; k < 40; ++k)
  {
    const double px = x(random);
    const double py = y(random);
    const double z = cutter.Drop(px, py, scratch);
    const double sampled = SampledFlatDrop(surface, Flat.Radius, px, py);
    EXPECT_GE(z, sampled - 1e-9);
    EXPECT_LT(z, sampled + 0.05);
  }
}

TEST(DropCutter, OnAPlane)
{
  const MillSurface plane = Surface(9, 7, 2, [](double x, double y) { return 0.3 * x - 0.4 * y; });
  DropCutter::Scratch scratch;
  // the ball's centre is a radius away from the plane, along its normal
  const double ball = 0.3 * 7 - 0.4 * 5 + 4 * std::sqrt(1.25) - 4;
  EXPECT_NEAR(DropCutter(plane, Ball).Drop(7, 5, scratch), ball, 1e-12);
  EXPECT_NEAR(DropCutter(plane, Flat).Drop(7, 5, scratch), 0.3 * 7 - 0.4 * 5 + 3 * 0.5, 1e-12);
  // allowance: along the normal for a ball, at least that for a flat end
  EXPECT_NEAR(
    DropCutter(plane, Ball, 0.5).Drop(7, 5, scratch), ball + 0.5 * std::sqrt(1.25), 1e-12);
  EXPECT_NEAR(DropCutter(plane, Flat, 0.5).Drop(7, 5, scratch), 0.1 + 3.5 * 0.5 + 0.5, 1e-12);
  EXPECT_EQ(DropCutter(plane, Ball).Drop(-4.1, 5, scratch), -Infinity);
  EXPECT_EQ(DropCutter(plane, Ball).Drop(1000, -1000, scratch), -Infinity);
}

TEST(DropCutter, ExcessAgainstManyDrops)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<double> x(2, 24);
  std::uniform_real_distribution<double> y(2, 13);
  std::uniform_real_distribution<double> step(-1.5, 1.5);
  for (const MillTool& tool : { Ball, Flat })
  {
    for (const bool bent : { false, true })
    {
      const MillSurface surface = bent ? Bent(Noise) : Surface(36, 26, 0.75, Rough);
      const DropCutter cutter(surface, tool);
      DropCutter::Scratch scratch;
      for (int k = 0; k < 80; ++k)
      {
        Vec3 a{ x(random), y(random), 0 };
        Vec3 b = a + Vec3{ step(random), k % 5 == 0 ? 0 : step(random), 0 };
        a[2] = cutter.Drop(a[0], a[1], scratch);
        b[2] = cutter.Drop(b[0], b[1], scratch);
        if (!std::isfinite(a[2] + b[2]))
        {
          continue;
        }
        double sampled = 0;
        constexpr int n = 2000;
        for (int i = 1; i < n; ++i)
        {
          const Vec3 p = a + (double(i) / n) * (b - a);
          sampled = std::max(sampled, cutter.Drop(p[0], p[1], scratch) - p[2]);
        }
        const DropCutter::Excess excess = cutter.FindExcess(a, b, 1e-4);
        if (sampled > 1.5e-4 || excess.Height > 0)
        {
          EXPECT_GE(excess.Height, sampled - 1e-7) << k;
          // a wall may be met between two samples
          if (!bent)
          {
            continue;
          }
          EXPECT_LT(excess.Height, sampled + (tool.Shape == ToolShape::Ball ? 2e-4 : 0.02)) << k;
        }
      }
    }
  }
}

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

TEST(ToolPath, SaysWhereTheToolDoesNotFit)
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

// A full cut into solid stock is told, with how deep and where.
TEST(ToolPath, WarnsOfDeepCutsWithoutRoughing)
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

TEST(ToolPath, RefusesBadInput)
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
  EXPECT_NE(refuses([](auto& o) { o.StepOver = 9; }).find("StepOver"), std::string::npos);
  EXPECT_NE(refuses([](auto& o) { o.ScallopHeight = 4; }).find("ScallopHeight"), std::string::npos);
  EXPECT_NE(refuses([](auto& o) { o.Finishing = false; }).find("nothing to do"), std::string::npos);
  EXPECT_NE(refuses([](auto& o) { o.Overrun = -1; }).find("Overrun"), std::string::npos);
  EXPECT_NE(refuses([&](auto& o) { o.Overrun = nan; }).find("Overrun"), std::string::npos);
  EXPECT_NE(refuses([&](auto& o) { o.Direction = nan; }).find("Direction"), std::string::npos);
  EXPECT_NE(refuses([](auto& o) { o.PathStep = -1; }).find("PathStep"), std::string::npos);
  EXPECT_NE(refuses([](auto& o) { o.RoughingStep = -1; }).find("RoughingStep"), std::string::npos);
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

TEST(ToolPath, Stops)
{
  const MillSurface surface = Surface(121, 121, 1, Mould);
  ThreadExecution execution(2, [](double) { return false; });
  EXPECT_THROW(MakeToolPath(execution, surface, {}), Aborted);
}
