// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaGCode.h"

#include "lacunaGCodeParser.h"
#include "lacunaGCodeScene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

using namespace lacuna;
using namespace lacunaGCode;

TEST(GCodeTemplates, Templates)
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

// Whatever the templates say, the path's numbers mean millimetres from the work offset's zero.
TEST(GCodeTemplates, TemplatesThatChangeTheMeaningOfThePathAreRefused)
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
  header("G00 X1. X2.", "has X1. and X2. in one line");
  header("S3000 M03 S4000", "has S3000 and S4000 in one line");
  header("M03 M08 G21 G90", "no error");
  header("(" + std::string(73, 'A') + ")", "a line of 75 characters, more than the 74");
  header("(" + std::string(72, 'A') + ")", "no error");
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
TEST(GCodeTemplates, TemplatesThatMoveThePathAreRefused)
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
  EXPECT_TRUE(warnings("M3 G21 g43 z50. h 1").empty());
  for (const char* h : { "S100 M03", "(G43 H1)\nM03", "G43 Z50. M03" })
  {
    const std::vector<std::string> told = warnings(h);
    ASSERT_EQ(told.size(), 1u) << h;
    EXPECT_NE(told[0].find("Z is the spindle nose's"), std::string::npos);
  }
  for (const char* h : { "M03\nT1 M06\nG43 H1", "T1 M06\nS900\nG43 H1", "(M03)\nG43 H1",
         "M04 G43 H1", "M03\nM05\nG43 H1", "G43 H1 M13\nM14", "M07\nG43 H1", "S0 M03\nG43 H1",
         "S900 M03\nG43 H1\nS0" })
  {
    const std::vector<std::string> told = warnings(h);
    ASSERT_EQ(told.size(), 1u) << h;
    EXPECT_NE(told[0].find("spindle turning clockwise"), std::string::npos) << told[0];
  }
  EXPECT_TRUE(warnings("S0\nG43 H1\nM03\nS900").empty());
  EXPECT_TRUE(warnings("M05\nT1 M06\nM04\nS900 M03 M08\nG43 H1").empty());
  EXPECT_TRUE(warnings("T1 M06\nM13\nG43 H1\nM09").empty());
}

TEST(GCodeTemplates, IncrementsLeadToTheReferencePointOnly)
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

TEST(GCodeTemplates, BlanksAndTabs)
{
  GCodeOptions options;
  options.Header = " \n\t\n\tG21\tG90\n  (a\tb)\nG43\tH1 M03\n";
  options.LineNumbers = true;
  const GCodeProgram program = MakeGCode(Start, Path(), options);
  EXPECT_EQ(program.Text.find("%\nO0001\nN10 G21 G17 G40 G49 G80 G90 G94 G54\nN20 G21 G90\n(A B)\n"
                              "N30 G43 H1 M03\nN40 G00 X1.5"),
    0u)
    << program.Text.substr(0, 200);
  EXPECT_TRUE(program.Warnings.empty());
  const std::int64_t blocks = program.Blocks;
  options.Header = "G21 G90\n(A)\nG43 H1 M03";
  EXPECT_EQ(MakeGCode(Start, Path(), options).Blocks, blocks);
}

TEST(GCodeTemplates, TemplatesStayAboveThePathAndInTheEnvelope)
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
