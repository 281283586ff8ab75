// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaGCode.h"

#include "lacunaDropCutter.h"
#include "lacunaExecution.h"
#include "lacunaGCodeParser.h"
#include "lacunaGCodeScene.h"
#include "lacunaMillScene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

using namespace lacuna;
using namespace lacunaGCode;

namespace
{
// A quarter circle of radius 20 in steps of 2 degrees, over (upper) or under its centre, in x or y,
// to and fro, between rapid motions.
std::vector<GCodeMove> QuarterCircle(int along, bool upper, bool forwards, Vec3& start)
{
  std::vector<GCodeMove> moves;
  const double pi = std::acos(-1.0);
  for (int k = 0; k <= 45; ++k)
  {
    const double angle = (forwards ? 135 - 2 * k : 45 + 2 * k) * pi / 180;
    Vec3 p{ 7, 7, 0 };
    p[along] = std::round(20000 * std::cos(angle)) / 1000;
    p[2] = std::ceil((upper ? 20000 : -20000) * std::sin(angle)) / 1000;
    if (k == 0)
    {
      start = { p[0], p[1], 30 };
    }
    moves.push_back({ false, p, 500 });
  }
  Vec3 up = moves.back().To;
  up[2] = 30;
  moves.push_back({ true, up, 0 });
  return moves;
}
}

TEST(GCodeArcs, ArcsOfAllSensesAndPlanes)
{
  for (const int along : { 0, 1 })
  {
    for (const bool upper : { false, true })
    {
      for (const bool forwards : { false, true })
      {
        Vec3 start{};
        const std::vector<GCodeMove> moves = QuarterCircle(along, upper, forwards, start);
        GCodeOptions options;
        EXPECT_EQ(GCodeParser(MakeGCode(start, moves, options).Text).Arcs, 0) << "off";
        options.ArcTolerance = 0.02;
        const GCodeProgram program = MakeGCode(start, moves, options);
        const GCodeParser parser(program.Text);
        // in a hollow arcs that are not below the motions leave them sooner
        EXPECT_GE(parser.Arcs, 1) << program.Text;
        EXPECT_LE(parser.Arcs, upper ? 1 : 8) << program.Text;
        EXPECT_EQ(parser.Plane, 17);
        // G03 turns from z to x (G18), from y to z (G19)
        const std::string words = std::string(along == 0 ? "G18\n" : "G19\n") +
          ((along == 0) == (upper == forwards) ? "G03" : "G02");
        EXPECT_NE(program.Text.find(words), std::string::npos) << words << program.Text;
        for (const GCodeParser::Step& step : parser.Steps)
        {
          const double r = std::hypot(step.To[along], step.To[2]);
          EXPECT_EQ(step.To[1 - along], 7);
          if (step.Arc)
          {
            EXPECT_NEAR(r, 20, 0.021);
            EXPECT_EQ(step.To[2] > 0, upper);
          }
        }
      }
    }
  }
}

// On the programs of real paths: no place of an arc is lower than the tool can go, none is further
// above the path than the tolerance, and the ends of all cuts are reached.
TEST(GCodeArcs, ArcsNeitherGougeNorLeave)
{
  const MillSurface mould = lacunaMill::Surface(61, 41, 1,
    [](double x, double y)
    { return lacunaMill::Mould(x + 30, y + 40) + 2 * std::sin(0.3 * x) * std::cos(0.4 * y); });
  const MillSurface cliffs = lacunaMill::Surface(41, 31, 0.7,
    [](double x, double y)
    { return (x > 12 ? 5.0 : 0) + (std::hypot(x - 6, y - 9) < 3 ? -3 : 0); });
  for (const MillSurface* surface : { &mould, &cliffs })
  {
    for (const double direction : { 0.0, 90.0 })
    {
      ToolPathOptions options;
      options.Direction = direction;
      options.RoughingStep = 3;
      ThreadExecution execution(2);
      const ToolPath path = MakeToolPath(execution, *surface, options);
      std::vector<GCodeMove> moves;
      for (const ToolPath::Run& run : path.Runs)
      {
        for (std::int64_t k = run.First + 1; k < run.First + run.Count; ++k)
        {
          moves.push_back({ run.Kind == Motion::Rapid, path.Points[k], 800 });
        }
      }
      GCodeOptions writing;
      const std::int64_t blocks = MakeGCode(path.Points[0], moves, writing).Blocks;
      writing.ArcTolerance = 0.005;
      const GCodeProgram program = MakeGCode(path.Points[0], moves, writing);
      EXPECT_LT(program.Blocks, 0.6 * static_cast<double>(blocks));
      const GCodeParser parser(program.Text);
      EXPECT_GT(parser.Arcs, 20);
      const DropCutter cutter(*surface, options.Tool);
      DropCutter::Scratch scratch;
      std::size_t next = 0; // motion that the program is on
      double deepest = -1;
      double furthest = 0;
      Vec3 from{};
      for (const GCodeParser::Step& step : parser.Steps)
      {
        const Vec3 to{ step.To[0], step.To[1], step.To[2] };
        if (&step == &parser.Steps.front())
        {
          from = to;
        }
        for (double t = step.Arc ? 1 : 0.05; !step.Rapid && t <= 1.001; t += 0.05)
        {
          const Vec3 p = from + t * (to - from);
          deepest = std::max(deepest, cutter.Drop(p[0], p[1], scratch) - p[2]);
        }
        // the nearest of the motions from here on
        double nearest = 1e9;
        std::size_t where = next;
        for (std::size_t k = next; k < std::min(moves.size(), next + 300); ++k)
        {
          const Vec3& a = k == 0 ? path.Points[0] : moves[k - 1].To;
          const Vec3 d = moves[k].To - a;
          const double length2 = Dot(d, d);
          const double t = length2 > 0 ? std::clamp(Dot(to - a, d) / length2, 0.0, 1.0) : 0;
          const double distance = Norm(to - a - t * d);
          if (distance < nearest - 1e-9)
          {
            nearest = distance;
            where = k;
          }
        }
        next = step.Arc ? next : where;
        furthest = std::max(furthest, nearest);
        from = to;
      }
      EXPECT_LE(deepest, 0.001);
      EXPECT_LE(furthest, 0.0055);
      EXPECT_EQ(next + 1, moves.size());
      EXPECT_EQ(from, moves.back().To);
    }
  }
}

TEST(GCodeArcs, ArcsStayWithinTheEnvelope)
{
  // a polygon whose arc is higher than its corners
  std::vector<GCodeMove> moves{ { false, { 0, 0, 0 }, 300 }, { false, { 4, 0, 1.5 }, 300 },
    { false, { 8, 0, 1.5 }, 300 }, { false, { 12, 0, 0 }, 300 }, { true, { 12, 0, 5 }, 0 } };
  GCodeOptions options;
  options.ArcTolerance = 0.5;
  EXPECT_EQ(GCodeParser(MakeGCode({ 0, 0, 5 }, moves, options).Text).Arcs, 1);
  moves.back().To[2] = 1.5;
  options.HasEnvelope = true;
  const double envelope[6] = { 0, 12, 0, 0, 0, 1.55 };
  std::copy_n(envelope, 6, options.Envelope);
  EXPECT_EQ(GCodeParser(MakeGCode({ 0, 0, 1.55 }, moves, options).Text).Arcs, 0);
}
