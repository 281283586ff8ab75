// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaGCode.h"

#include "lacunaExecution.h"
#include "lacunaGCodeParser.h"
#include "lacunaGCodeScene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <clocale>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

using namespace lacuna;
using namespace lacunaGCode;

TEST(GCode, WholeProgram)
{
  GCodeOptions options;
  options.ProgramNumber = 12;
  options.Comments = { "Lacuna 0.1 (a_b)" };
  const GCodeProgram program = MakeGCode(Start, Path(), options);
  EXPECT_EQ(program.Text,
    "%\nO0012\n(LACUNA 0.1 [A-B])\nG21 G17 G40 G49 G80 G90 G94 G54\nT01 M06\nS6000 M03\n"
    "G00 X1.5 Y-2.25\nG43 H01 Z10.\nG00 X1.5 Y-2.25\nZ10.\nX3. Y4.\nG01 Z-1. F200.\n"
    "Y4.001 F800.\nX0. Y-12.5 Z0.\nG00 Z10.\nM05\nM30\n%\n");
  EXPECT_EQ(program.Blocks, 14);
}

TEST(GCode, ReadsBackWithinAMicrometre)
{
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> xy(-300, 300);
  std::uniform_real_distribution<double> z(-40, 10);
  std::vector<GCodeMove> moves{ { true, { 0.1234567, 5, 20 }, 0 } };
  for (int k = 0; k < 20000; ++k)
  {
    moves.push_back({ false, { xy(random), xy(random), z(random) }, 100.0 + k % 3 });
  }
  Vec3 last = moves.back().To;
  last[2] = 20;
  moves.push_back({ true, last, 0 });
  GCodeOptions options;
  options.LineNumbers = true;
  const GCodeProgram program = MakeGCode({ 0, 0, 20 }, moves, options);
  const GCodeParser parser(program.Text);
  EXPECT_EQ(parser.Blocks, program.Blocks);
  EXPECT_EQ(parser.Numbers.size(), static_cast<std::size_t>(program.Blocks));
  EXPECT_EQ(parser.Numbers.front(), 10);
  // the header's and the writer's own way to the start come first
  ASSERT_GE(parser.Steps.size(), moves.size());
  const std::size_t skipped = parser.Steps.size() - moves.size();
  for (std::size_t k = 0; k < moves.size(); ++k)
  {
    const GCodeParser::Step& step = parser.Steps[skipped + k];
    ASSERT_EQ(step.Rapid, moves[k].Rapid);
    ASSERT_TRUE(step.Rapid || step.Feed == moves[k].Feed);
    ASSERT_NEAR(step.To[0], moves[k].To[0], 0.00050001);
    ASSERT_NEAR(step.To[1], moves[k].To[1], 0.00050001);
    ASSERT_GE(step.To[2], moves[k].To[2] - 1e-8) << "never deeper";
    ASSERT_LE(step.To[2], moves[k].To[2] + 0.001);
  }
}

TEST(GCode, CanBeStopped)
{
  std::vector<GCodeMove> moves(10001, { false, { 0, 0, 0 }, 100 });
  for (std::size_t k = 0; k < moves.size(); ++k)
  {
    moves[k].To = { 0.01 * static_cast<double>(k), 0, 5 };
  }
  moves.front().Rapid = moves.back().Rapid = true;
  std::vector<double> reports;
  ThreadExecution watched(1,
    [&](double fraction)
    {
      reports.push_back(fraction);
      return true;
    });
  EXPECT_EQ(
    MakeGCode({ 0, 0, 5 }, moves, {}, &watched).Text, MakeGCode({ 0, 0, 5 }, moves, {}).Text);
  EXPECT_GE(reports.size(), 9u);
  EXPECT_TRUE(std::is_sorted(reports.begin(), reports.end()));
  ThreadExecution stopped(1, [](double fraction) { return fraction < 0.5; });
  EXPECT_THROW(MakeGCode({ 0, 0, 5 }, moves, {}, &stopped), Aborted);
}

TEST(GCode, IsTheSameInAnyLocale)
{
  const std::string expected = MakeGCode(Start, Path(), {}).Text;
  const std::string before = std::setlocale(LC_ALL, nullptr);
  for (const char* name : { "de_DE.UTF-8", "tr_TR.UTF-8", "C" })
  {
    if (std::setlocale(LC_ALL, name))
    {
      EXPECT_EQ(MakeGCode(Start, Path(), {}).Text, expected);
    }
  }
  std::setlocale(LC_ALL, before.c_str());
}

TEST(GCode, CommentsInTheControlsCharacters)
{
  GCodeOptions options;
  options.Comments = { "Gr\xc3\xb6\xc3\x9f"
                       "e 1% ;\n\t'x'",
    std::string(150, 'a'), "",
    "Made by: Transform=" + std::string(30, '0') + ",-12345.678901234567,0.12345678901234567,2" };
  const GCodeParser parser(MakeGCode(Start, Path(), options).Text);
  ASSERT_EQ(parser.Comments.size(), 7u);
  EXPECT_EQ(parser.Comments[0], "GR**E 1* * **X*");
  // a word that is cut says so, on both sides
  EXPECT_EQ(parser.Comments[1], std::string(61, 'A') + "...");
  EXPECT_EQ(parser.Comments[2], "..." + std::string(58, 'A') + "...");
  EXPECT_EQ(parser.Comments[3], "..." + std::string(31, 'A'));
  // numbers are whole
  EXPECT_EQ(parser.Comments[4], "MADE BY:");
  EXPECT_EQ(parser.Comments[5], "TRANSFORM=" + std::string(30, '0') + ",-12345.678901234567,");
  EXPECT_EQ(parser.Comments[6], "0.12345678901234567,2");
}

TEST(GCode, Refuses)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  ExpectError([](auto& m, auto&) { m.clear(); }, "no motions");
  ExpectError([&](auto& m, auto&) { m[2].To[1] = nan; }, "motion 3 has a coordinate that is not");
  ExpectError([&](auto& m, auto&) { m[2].To[2] = -infinity; }, "not a number");
  ExpectError([](auto& m, auto&) { m[2].To[0] = 1e5; }, "99999.999");
  ExpectError([](auto& m, auto&) { m[2].To[0] = -1e300; }, "99999.999");
  ExpectError([](auto& m, auto&) { m[2].Feed = 0; }, "feed of 0");
  ExpectError([&](auto& m, auto&) { m[2].Feed = nan; }, "feed");
  ExpectError([](auto& m, auto&) { m[4].To[0] = 3; }, "neither upright nor level");
  ExpectError([](auto& m, auto&) { m.pop_back(); }, "end with a rapid motion");
  ExpectError([](auto& m, auto&) { m.erase(m.begin()); }, "must start with a rapid");
  ExpectError([](auto&, auto& o) { o.ProgramNumber = 0; }, "ProgramNumber");
  ExpectError([](auto&, auto& o) { o.ToolNumber = 100; }, "ToolNumber");
  ExpectError([](auto&, auto& o) { o.WorkOffset = 60; }, "WorkOffset");
  ExpectError([&](auto&, auto& o) { o.SpindleSpeed = nan; }, "SpindleSpeed");
  ExpectError([](auto&, auto& o) { o.SpindleSpeed = 0; }, "SpindleSpeed is 0 1/min");
  ExpectError([&](auto&, auto& o) { o.ArcTolerance = nan; }, "ArcTolerance");
  ExpectError([](auto&, auto& o) { o.ArcTolerance = -0.01; }, "ArcTolerance");
  ExpectError([](auto&, auto& o) { o.ArcTolerance = 2; }, "ArcTolerance");
  const auto envelope = [](double zLow, double zHigh)
  {
    return [=](auto&, GCodeOptions& o)
    {
      o.HasEnvelope = true;
      const double values[6] = { -20, 20, -12.5, 20, zLow, zHigh };
      std::copy_n(values, 6, o.Envelope);
    };
  };
  ExpectError(envelope(-1, 10), "no error");
  ExpectError(envelope(-0.9, 10), "motion 2 leaves the envelope (Z -0.9 to 10 mm)");
  ExpectError(envelope(-1, 9), "the path's start leaves the envelope");
  ExpectError(envelope(1, -1), "empty in Z");
  ExpectError(envelope(nan, 1), "empty in Z");
}
