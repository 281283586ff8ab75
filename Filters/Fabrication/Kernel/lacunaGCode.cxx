// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaGCode.h"

#include "lacunaArcFit.h"
#include "lacunaExecution.h"
#include "lacunaGCodeTemplate.h"
#include "lacunaParameterText.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string_view>

namespace lacuna
{
namespace
{
constexpr std::size_t CommentLength = 64;
constexpr std::string_view CutSign = "..."; // where a comment goes on in the next one within a word
constexpr std::int64_t LargestUnits = 99999999; // eight digits of a micrometre
constexpr std::size_t MovesBetweenReports = 1000;
constexpr const char* AxisNames = "XYZ";
// What the path's numbers mean: mm, in the plane of x and y, no compensation, no length, no cycle,
// absolute, mm/min, and after these the work offset. Before the header, which cannot change it.
constexpr const char* SafeStart = "G21 G17 G40 G49 G80 G90 G94";

constexpr ValueRange SpindleSpeeds = ValueRange::Between(1, 99999, "1/min");

using Units = Micrometres;

[[noreturn]] void Throw(const std::string& what)
{
  throw std::invalid_argument(what);
}

std::string Place(const Vec3& p)
{
  return "x " + FormatNumber(p[0]) + ", y " + FormatNumber(p[1]) + ", z " + FormatNumber(p[2]);
}

//------------------------------------------------------------------------------
// Thousandths as a number with a decimal point: 12., -0.5
std::string FormatUnits(std::int64_t units)
{
  const std::int64_t size = std::abs(units);
  std::string text = (units < 0 ? "-" : "") + std::to_string(size / 1000) + ".";
  std::string decimals = std::to_string(1000 + size % 1000).substr(1);
  decimals.erase(decimals.find_last_not_of('0') + 1);
  return text + decimals;
}

std::string Digits(int value, std::size_t count)
{
  std::string text = std::to_string(value);
  return text.size() < count ? std::string(count - text.size(), '0') + text : text;
}

//------------------------------------------------------------------------------
// In the characters that controls know, in lines that they show whole.
void AddComment(std::string& program, const std::string& comment)
{
  std::string line;
  const auto add = [&program](const std::string& text) { program += "(" + text + ")\n"; };
  constexpr std::string_view known = " .,+-*/=:#[]";
  for (const char each : comment)
  {
    const auto c = static_cast<unsigned char>(each);
    if (c >= 0x80 && c < 0xC0)
    {
      continue; // the rest of a character in UTF-8
    }
    const char upper = static_cast<char>(std::toupper(c));
    const bool plain = (upper >= 'A' && upper <= 'Z') || (upper >= '0' && upper <= '9') ||
      known.find(upper) != std::string_view::npos;
    line += c == '(' ? '['
      : c == ')'     ? ']'
      : c == '_'     ? '-'
      : c == '\n'    ? ' '
      : plain        ? upper
                     : '*';
    if (line.size() > CommentLength)
    {
      // at a blank, or else behind a comma, so that no number is cut; what is cut says so
      const std::size_t blank = line.rfind(' ');
      const std::size_t comma = line.rfind(',', CommentLength - 1);
      if (blank != std::string::npos && blank > 0)
      {
        add(line.substr(0, blank));
        line.erase(0, blank + 1);
      }
      else if (comma != std::string::npos && comma > 0)
      {
        add(line.substr(0, comma + 1));
        line.erase(0, comma + 1);
      }
      else
      {
        add(line.substr(0, CommentLength - CutSign.size()) + std::string(CutSign));
        line = std::string(CutSign) + line.substr(CommentLength - CutSign.size());
      }
    }
  }
  if (!line.empty())
  {
    add(line);
  }
}

//------------------------------------------------------------------------------
void CheckOptions(const GCodeOptions& o)
{
  Properties properties;
  o.Describe(properties);
  properties.Check();
  SpindleSpeeds.Check("SpindleSpeed", o.SpindleSpeed);
  for (int c = 0; o.HasEnvelope && c < 3; ++c)
  {
    if (!(o.Envelope[2 * c] <= o.Envelope[2 * c + 1]))
    {
      Throw(std::string("Envelope is empty in ") + AxisNames[c]);
    }
  }
}

//------------------------------------------------------------------------------
// Motion number as users count them: 0 is the start.
Units Round(const Vec3& p, std::size_t number, const GCodeOptions& options)
{
  const std::string name = number == 0 ? "the path's start" : "motion " + std::to_string(number);
  Units units{};
  for (int c = 0; c < 3; ++c)
  {
    if (!std::isfinite(p[c]))
    {
      Throw(name + " has a coordinate that is not a number: " + Place(p));
    }
    const double scaled = 1000 * p[c];
    // z up, but for rounding of the product
    const double rounded = c == 2 ? std::ceil(scaled - 1e-6) : std::round(scaled);
    if (!(std::abs(rounded) <= static_cast<double>(LargestUnits)))
    {
      Throw(name + " goes beyond what the control can count (99999.999 mm): " + Place(p));
    }
    units[c] = static_cast<std::int64_t>(rounded);
    const double value = static_cast<double>(units[c]) / 1000;
    const double* range = options.Envelope + 2 * c;
    if (options.HasEnvelope && !(value >= range[0] && value <= range[1]))
    {
      Throw(name + " leaves the envelope (" + AxisNames[c] + " " + FormatNumber(range[0]) + " to " +
        FormatNumber(range[1]) + " mm): " + Place(p));
    }
  }
  return units;
}

//------------------------------------------------------------------------------
// Writes blocks and remembers what the control knows already.
class BlockWriter
{
public:
  BlockWriter(GCodeProgram& program, bool numbers)
    : Program(program)
    , Numbers(numbers)
  {
  }

  void Add(const std::string& block)
  {
    const bool comment = block.front() == '(';
    if (!comment)
    {
      ++this->Program.Blocks;
      if (this->Numbers)
      {
        this->Number = this->Number % 9990 + 10;
        this->Program.Text += "N" + std::to_string(this->Number) + " ";
      }
    }
    this->Program.Text += block;
    this->Program.Text += '\n';
  }

  // Axes from first up to last, without it, are spoken of; all of them when the control does not know
  // where it is.
  void Move(bool rapid, const Units& to, std::int64_t feed, int first, int last)
  {
    std::string block;
    for (int c = first; c < last; ++c)
    {
      if (to[c] != this->At[c])
      {
        AddWord(block, AxisNames[c] + FormatUnits(to[c]));
        this->At[c] = to[c];
      }
    }
    if (!block.empty())
    {
      this->AddMotion(rapid ? 0 : 1, block, rapid ? this->Feed : feed);
    }
  }

  // To a point from where it is.
  void MoveOnArc(const ArcFit::Motion& arc, const Units& to, std::int64_t feed)
  {
    const int along = 1 - arc.Normal;
    this->SetPlane(arc.Normal == 1 ? 18 : 19);
    // counter-clockwise (G03) seen from the end of the normal: from z to x, from y to z
    const bool forwards = to[along] > this->At[along];
    const bool counter = (arc.Normal == 1) == (forwards == arc.Upper);
    std::string block;
    for (const int c : { along, 2 })
    {
      AddWord(block, AxisNames[c] + FormatUnits(to[c]));
    }
    for (const int c : { along, 2 })
    {
      AddWord(block, "IJK"[c] + FormatUnits(arc.Centre[c] - this->At[c]));
    }
    this->At = to;
    this->AddMotion(counter ? 3 : 2, block, feed);
  }

  void SetPlane(int plane)
  {
    if (plane != this->Plane)
    {
      this->Add("G" + std::to_string(plane));
      this->Plane = plane;
    }
  }

private:
  static void AddWord(std::string& block, const std::string& word)
  {
    block += (block.empty() ? "" : " ") + word;
  }

  void AddMotion(int mode, std::string block, std::int64_t feed)
  {
    if (mode != this->Mode)
    {
      block.insert(0, "G0" + std::to_string(mode) + " ");
      this->Mode = mode;
    }
    if (feed != this->Feed)
    {
      AddWord(block, "F" + FormatUnits(feed));
      this->Feed = feed;
    }
    this->Add(block);
  }

  static constexpr std::int64_t Unknown = std::numeric_limits<std::int64_t>::min();
  GCodeProgram& Program;
  bool Numbers;
  int Number = 0;
  int Mode = -1;
  int Plane = 17; // what controls are in unless told otherwise
  Units At{ Unknown, Unknown, Unknown };
  std::int64_t Feed = Unknown;
};

//------------------------------------------------------------------------------
// Where the path is before, between and after the motions, which it judges.
std::vector<Units> GetPoints(
  const Units& first, const std::vector<GCodeMove>& moves, const GCodeOptions& options)
{
  std::vector<Units> points{ first };
  points.reserve(moves.size() + 1);
  for (std::size_t k = 0; k < moves.size(); ++k)
  {
    const GCodeMove& move = moves[k];
    const Units& at = points.back();
    const Units to = Round(move.To, k + 1, options);
    if (move.Rapid && to[2] != at[2] && (to[0] != at[0] || to[1] != at[1]))
    {
      Throw("motion " + std::to_string(k + 1) + ", to " + Place(move.To) +
        ", is rapid and neither upright nor level: a control does not run such a motion along a "
        "line. Go up first, then level, then down");
    }
    if (!move.Rapid && !(move.Feed >= 0.001 && move.Feed <= 99999))
    {
      Throw("motion " + std::to_string(k + 1) + ", to " + Place(move.To) + ", has a feed of " +
        FormatNumber(move.Feed) + " mm/min; it must be above 0 and at most 99999");
    }
    points.push_back(to);
  }
  return points;
}

//------------------------------------------------------------------------------
void AddMoves(BlockWriter& writer, const std::vector<Units>& points,
  const std::vector<GCodeMove>& moves, const GCodeOptions& options, Execution* execution)
{
  const ArcFit fit(points, 1000 * options.ArcTolerance);
  const double ceiling =
    options.HasEnvelope ? 1000 * options.Envelope[5] : std::numeric_limits<double>::infinity();
  std::size_t same = 0; // the end of the motions that are as fast as this one
  std::size_t reported = 0;
  for (std::size_t k = 0; k < moves.size();)
  {
    if (execution && k >= reported + MovesBetweenReports)
    {
      execution->Report(static_cast<double>(k) / static_cast<double>(moves.size()));
      reported = k;
    }
    const GCodeMove& move = moves[k];
    const std::int64_t feed = move.Rapid ? 0 : std::llround(1000 * move.Feed);
    if (!move.Rapid && options.ArcTolerance > 0)
    {
      for (same = std::max(same, k);
           same < moves.size() && !moves[same].Rapid && moves[same].Feed == move.Feed;)
      {
        ++same;
      }
      const std::optional<ArcFit::Motion> joined = fit.Find(k, same);
      if (joined && joined->Highest <= ceiling)
      {
        const Units& to = points[joined->Last];
        joined->Straight ? writer.Move(false, to, feed, 0, 3) : writer.MoveOnArc(*joined, to, feed);
        k = joined->Last;
        continue;
      }
    }
    writer.Move(move.Rapid, points[++k], feed, 0, 3);
  }
}
}

//------------------------------------------------------------------------------
GCodeOptions::GCodeOptions()
  : Header(DefaultHeader())
  , Footer(DefaultFooter())
{
}

void GCodeOptions::Describe(Properties& properties) const
{
  properties.Add("ProgramNumber", this->ProgramNumber, ValueRange::Between(1, 9999))
    .Add("ToolNumber", this->ToolNumber, ValueRange::Between(1, 99))
    .Add("WorkOffset", this->WorkOffset, ValueRange::Between(54, 59))
    .Add("SpindleSpeed", this->SpindleSpeed, SpindleSpeeds.OrZero("of the path"))
    .Add("LineNumbers", this->LineNumbers)
    .Add("ArcTolerance", this->ArcTolerance, ValueRange::Between(0.001, 1, "mm").OrZero("no arcs"));
}

const char* GCodeOptions::DefaultHeader()
{
  return "T{TOOL} M06\nS{SPEED} M03\nG00 X{X} Y{Y}\n"
         "G43 H{TOOL} Z{Z}\n";
}

const char* GCodeOptions::DefaultFooter()
{
  return "M05\nM30\n";
}

//------------------------------------------------------------------------------
GCodeProgram MakeGCode(const Vec3& start, const std::vector<GCodeMove>& moves,
  const GCodeOptions& options, Execution* execution)
{
  CheckOptions(options);
  if (moves.empty())
  {
    Throw("the path has no motions");
  }
  const Vec3& next = moves.front().To;
  const bool down = next[0] == start[0] && next[1] == start[1] && next[2] < start[2];
  if ((!moves.front().Rapid && !down) || !moves.back().Rapid)
  {
    Throw("the path must start with a rapid motion or straight down, and end with a rapid motion: "
          "the machine goes to its start and from its end through the air");
  }
  const Units first = Round(start, 0, options);
  const std::vector<std::pair<std::string, std::string>> values = {
    { "PROGRAM", Digits(options.ProgramNumber, 4) }, { "TOOL", Digits(options.ToolNumber, 2) },
    { "OFFSET", "G" + std::to_string(options.WorkOffset) },
    { "SPEED", std::to_string(std::llround(options.SpindleSpeed)) }, { "X", FormatUnits(first[0]) },
    { "Y", FormatUnits(first[1]) }, { "Z", FormatUnits(first[2]) }
  };
  const Units last = Round(moves.back().To, moves.size(), options);
  const auto z = [](const Units& units) { return static_cast<double>(units[2]) / 1000; };
  const FilledTemplate header =
    FillInTemplate({ "Header", options.Header, false, z(first) }, values, options);
  const FilledTemplate footer =
    FillInTemplate({ "Footer", options.Footer, true, z(last) }, values, options);

  GCodeProgram program;
  if (!header.HasToolLength)
  {
    program.Warnings.emplace_back(
      "Header has no G43 with a number, so there is no tool's length: Z is "
      "the spindle nose's, not the tip's. Write G43 H{TOOL} Z{Z}");
  }
  if (!header.SpindleTurns)
  {
    program.Warnings.emplace_back(
      "Header does not leave the spindle turning clockwise (no M03, M04, M05 or M06 behind it, or "
      "S0), so the tool would be dragged through the part. Write S{SPEED} M03 behind T{TOOL} M06");
  }
  program.Text = "%\nO" + values[0].second + "\n";
  for (const std::string& comment : options.Comments)
  {
    AddComment(program.Text, comment);
  }
  BlockWriter writer(program, options.LineNumbers);
  writer.Add(SafeStart + (" G" + std::to_string(options.WorkOffset)));
  for (const std::string& line : header.Lines)
  {
    writer.Add(line);
  }
  writer.Move(true, first, 0, 0, 2);
  writer.Move(true, first, 0, 2, 3);
  AddMoves(writer, GetPoints(first, moves, options), moves, options, execution);
  writer.SetPlane(17);
  for (const std::string& line : footer.Lines)
  {
    writer.Add(line);
  }
  program.Text += "%\n";
  return program;
}
}
