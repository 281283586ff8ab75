// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaGCode.h"

#include "lacunaDropCutter.h"
#include "lacunaExecution.h"
#include "lacunaGCodeParser.h"
#include "lacunaMillScene.h"

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

namespace
{
const Vec3 Start{ 1.5, -2.25, 10 };

std::vector<GCodeMove> Path()
{
  return { { true, { 3, 4, 10 }, 0 }, { false, { 3, 4, -1.0004 }, 200 },
    { false, { 3.0004, 4.0006, -1.0004 }, 800 }, { false, { -0.0004, -12.5, 0 }, 800 },
    { true, { -0.0004, -12.5, 10 }, 0 } };
}

std::string Message(
  const std::vector<GCodeMove>& moves, const GCodeOptions& options, const Vec3& start = Start)
{
  try
  {
    MakeGCode(start, moves, options);
  }
  catch (const std::invalid_argument& error)
  {
    return error.what();
  }
  return "no error";
}

void ExpectError(const std::function<void(std::vector<GCodeMove>&, GCodeOptions&)>& change,
  const std::string& words)
{
  std::vector<GCodeMove> moves = Path();
  GCodeOptions options;
  change(moves, options);
  EXPECT_NE(Message(moves, options).find(words), std::string::npos) << Message(moves, options);
}
}

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

TEST(GCode, Templates)
{
  GCodeOptions options;
  options.Header = "(my mill)\r\nG21 G90\n\nT{TOOL} M06\nS{SPEED} M03\n";
  options.Footer = "G00 Z50.\nM30";
  const std::string text = MakeGCode(Start, Path(), options).Text;
  EXPECT_EQ(
    text.find("%\nO0001\nG21 G17 G40 G49 G80 G90 G94 G54\n(MY MILL)\nG21 G90\nT01 M06\nS6000 "
              "M03\nG00 X1.5 Y-2.25\n"),
    0u);
  EXPECT_NE(text.find("G00 Z50.\nM30\n%\n"), std::string::npos);
  const auto header = [](const std::string& h, const std::string& words)
  { ExpectError([&](auto&, auto& o) { o.Header = h; }, words); };
  header("G21 {SPINDLE}", "'{SPINDLE}'");
  header("G21 {SPEED", "placeholder");
  header("G00 Z100", "without a decimal point");
  header("G00 Z100 X5.", "'Z100.'");
  header("G21 %", "'%'");
  header("(a (b))", "'('");
  header("(a", "without its end");
  header("G21 \xc3\xa4", "not ASCII");
}

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

TEST(GCode, ArcsOfAllSensesAndPlanes)
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
TEST(GCode, ArcsNeitherGougeNorLeave)
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

TEST(GCode, ArcsStayWithinTheEnvelope)
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

// Whatever the templates say, the path's numbers mean millimetres from the work offset's zero.
TEST(GCode, TemplatesThatChangeTheMeaningOfThePathAreRefused)
{
  const auto header = [](const std::string& h, const std::string& words)
  { ExpectError([&](auto&, auto& o) { o.Header = h; }, words); };
  const auto footer = [](const std::string& f, const std::string& words)
  { ExpectError([&](auto&, auto& o) { o.Footer = f; }, words); };
  for (const char* g : { "G20", "G91", "G18", "G19", "G41", "G42", "G44", "G68", "G51", "G51.1",
         "G16", "G52", "G92", "G10", "G2", "G03", "G31", "G65", "G66", "G81", "G93", "G95" })
  {
    header(std::string("G21 G90 ") + g, std::string("has ") + g + ", which may give");
    footer(std::string("G28 ") + g + "\nM30", std::string("has ") + g + ", which may give");
  }
  header("g 9 1", "has G91");
  header("G21\n(G20) G090 G020", "has G020");
  header("(G20 G91)", "no error");
  header("G21 G90 G00 X#100", "has 'X'; outside of comments");
  header("#1=5.", "has '#1'");
  header("/G00 Z50.", "has '/'");
  header("G90 Z1.E3", "has 'E3'");
  header("N10 G21", "has 'N10'");
  header("X1.2.3", "has 'X1.2.3'");
  header("G55", "WorkOffset is 54");
  header("G54", "no error");
  header("M98 P100", "has M98");
  header("M30", "would not be run");
  footer("M05\nM02", "no error");
  footer("M99", "has M99");
  // without a header that says so, too
  ExpectError([](auto&, auto& o) { o.Header = "S{SPEED} M03"; }, "no error");
  GCodeOptions options;
  options.Header = "S{SPEED} M03\n";
  const GCodeParser parser(MakeGCode(Start, Path(), options).Text); // which asks for G21 and G90
  EXPECT_EQ(parser.Steps.back().To[2], 10);
}

// Neither the zero nor the side nor the tool's length.
TEST(GCode, TemplatesThatMoveThePathAreRefused)
{
  const auto header = [](const std::string& h, const std::string& words)
  { ExpectError([&](auto&, auto& o) { o.Header = h; }, words); };
  const auto footer = [](const std::string& f, const std::string& words)
  { ExpectError([&](auto&, auto& o) { o.Footer = f; }, words); };
  header("G54 P2", "has P2 with a work offset");
  header("P2 G54", "has P2 with a work offset");
  header("{OFFSET} G04 P2", "has P2 with a work offset");
  header("{OFFSET} M19 P2", "has P2 with a work offset");
  header("G54\nP2", "has P2, which means nothing there");
  header("G04 P500\nG54\nM19 P90\nG43 H1", "no error");
  footer("G30 P2 Z50.\nG28 P3\nM30", "no error");
  for (const char* m : { "M21", "M22", "m021" })
  {
    header(m, "mirrors the path");
    footer(m, "mirrors the path");
  }
  header("M08\nM23\nM211", "no error");
  header("G00 A180.", "has A180., which turns the part");
  footer("B90.", "has B90., which turns the part");
  header("C0.", "has C0.");
  header("G53 A0.\nG28 B0.\nG30 C0.", "no error");
  header("G43 H1 Z20.\nG49", "has G49 with or after G43");
  header("G43 H1 G49", "has G49 with or after G43");
  header("G49\nG43 H1", "no error");
  header("G43 H00", "has H00 with G43");
  header("G43 H1\nH0", "has H0 without G43");
  footer("G49\nG28 Z20.", "has Z20. with or after G49");
  footer("G49 G28 Z20.", "has Z20. with or after G49");
  footer("G28 Z20.\nG49\nG53 Z0.\nM30", "no error");

  // whatever the header, the work offset is the property's
  GCodeOptions other;
  other.WorkOffset = 57;
  other.Header = "G43 H1";
  EXPECT_EQ(MakeGCode(Start, Path(), other)
              .Text.find("%\nO0001\nG21 G17 G40 G49 G80 G90 G94 G57\nG43 H1\nG00"),
    0u);

  // the tool, whose length makes Z the tip's
  const auto tool = [](bool first, const std::string& text, const std::string& words)
  {
    ExpectError(
      [&](auto&, auto& o)
      {
        o.ToolNumber = 7;
        (first ? o.Header : o.Footer) = text;
      },
      words);
  };
  tool(true, "T{TOOL} M06\nG43 H{TOOL} Z{Z}", "no error");
  tool(true, "M06 T7\nG43 H07", "no error");
  tool(true, "T7 M06\nG43 H1", "has H1, and ToolNumber is 7");
  tool(true, "T9 M06\nG43 H7", "has T9, and ToolNumber is 7");
  tool(true, "G43 H7 Z{Z}\nT7 M06", "has T7 with or after G43");
  tool(true, "T7\nG43 H7 M06", "has M06 with or after G43");
  tool(true, "M6", "has M6 without T before it");
  tool(true, "T7\nM6", "no error");
  tool(false, "G43 H2 Z50.\nM30", "has H2, and ToolNumber is 7");
  tool(false, "G00 Z50.\nT9 M06\nG53 Z0.\nX0. Y0.\nM30", "no error");
  tool(false, "T9 M06\nG00 Z50.\nM30", "has Z50. with or after M06");
  tool(false, "G28 Z50. M06\nM30", "has Z50. with or after M06");

  const auto warnings = [](const std::string& h)
  {
    GCodeOptions options;
    options.Header = h;
    return MakeGCode(Start, Path(), options).Warnings;
  };
  EXPECT_TRUE(MakeGCode(Start, Path(), {}).Warnings.empty());
  EXPECT_TRUE(warnings("G21 g43 z50. h 1").empty());
  for (const char* h : { "S100 M03", "(G43 H1)", "G43 Z50." })
  {
    const std::vector<std::string> told = warnings(h);
    ASSERT_EQ(told.size(), 1u) << h;
    EXPECT_NE(told[0].find("Z is the spindle nose's"), std::string::npos);
  }
}

TEST(GCode, IncrementsLeadToTheReferencePointOnly)
{
  const auto footer = [](const std::string& f, const std::string& words)
  { ExpectError([&](auto&, auto& o) { o.Footer = f; }, words); };
  footer("G91 G28 Z0.\nG90\nM30", "no error");
  footer("G49\nG91 G28 X0. Y0. Z0.\nG30 P2 Z0.\nG04 X1.5\nG90 G00 X5.\nM30", "no error");
  footer("G91 G28 Z0.\nG00 Z-5.", "has Z-5. behind G91");
  footer("G91 G28 Z0.\nX0.", "has X0. behind G91");
  footer("G91 G28 Z0.\nG53 Z0.", "has Z0. behind G91");
  footer("G91 G28 Z0.\nG28 X0. Y-5.", "has Y-5. behind G91");
  footer("G91 G28 Z0.\nG90 G28 Z0.", "has Z0., below where the path ends");
  footer("G91 G28 Z0.\nG91 Z0.", "has G91, which may give");
  footer("G91 G28 Z-1.", "has G91, which may give");
  footer("G91 G90 G28 Z0.", "has G91, which may give");
  footer("G91 G53 G28 Z0.", "has G91, which may give");
  footer("G91 Z0.", "has G91, which may give");
  footer("G91\nG28 Z0.", "has G91, which may give");
  ExpectError([](auto&, auto& o) { o.Header = "G91 G28 Z0.\nG90"; }, "has G91, which may give");
}

TEST(GCode, BlanksAndTabs)
{
  GCodeOptions options;
  options.Header = " \n\t\n\tG21\tG90\n  (a\tb)\nG43\tH1\n";
  options.LineNumbers = true;
  const GCodeProgram program = MakeGCode(Start, Path(), options);
  EXPECT_EQ(program.Text.find("%\nO0001\nN10 G21 G17 G40 G49 G80 G90 G94 G54\nN20 G21 G90\n(A B)\n"
                              "N30 G43 H1\nN40 G00 X1.5"),
    0u)
    << program.Text.substr(0, 200);
  EXPECT_TRUE(program.Warnings.empty());
  const std::int64_t blocks = program.Blocks;
  options.Header = "G21 G90\n(A)\nG43 H1";
  EXPECT_EQ(MakeGCode(Start, Path(), options).Blocks, blocks);
}

TEST(GCode, TemplatesStayAboveThePathAndInTheEnvelope)
{
  const auto expect =
    [](bool first, const std::string& text, const std::string& words, bool envelope = false)
  {
    ExpectError(
      [&](auto&, auto& o)
      {
        (first ? o.Header : o.Footer) = text;
        o.HasEnvelope = envelope;
        const double values[6] = { -20, 20, -12.5, 20, -5, 40 };
        std::copy_n(values, 6, o.Envelope);
      },
      words);
  };
  // the path starts and ends at Z 10
  expect(false, "G00 Z-50.\nM30", "has Z-50., below where the path ends (Z 10)");
  expect(true, "G00 Z9.999", "has Z9.999, below where the path starts (Z 10)");
  expect(true, "G00 Z10. (Z-5.)", "no error");
  expect(false, "G28 Z0.\nM30", "has Z0., below where the path ends");
  expect(false, "G53 Z0.\nM30", "no error");
  expect(false, "G04 X1.5\nG00 Z12.", "no error");
  expect(false, "G04 X1.5 Z-2.", "has Z-2.");
  expect(false, "G00 X500.", "no error");
  expect(false, "G00 X20.001", "has X20.001, which leaves the envelope (X -20 to 20 mm)", true);
  expect(false, "G00 X20. Y-12.5 Z40.", "no error", true);
  expect(false, "G00 Y -12.6", "has Y-12.6, which leaves the envelope (Y", true);
  expect(true, "G00 Z40.1", "has Z40.1, which leaves the envelope (Z -5 to 40 mm)", true);
  expect(false, "G53 Z100.", "no error", true);
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
