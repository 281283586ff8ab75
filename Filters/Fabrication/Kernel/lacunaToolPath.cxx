// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaToolPath.h"

#include "lacunaExecution.h"
#include "lacunaMemory.h"
#include "lacunaParameterText.h"
#include "lacunaRaster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr double Infinity = std::numeric_limits<double>::infinity();
constexpr double Pi = 3.14159265358979323846;
constexpr double LargestLevels = 10000;
constexpr double LeastStepOver = 0.01; // mm

void Require(bool condition, const std::string& what)
{
  if (!condition)
  {
    throw std::invalid_argument(what);
  }
}

void CheckOptions(const ToolPathOptions& o)
{
  Properties properties;
  o.Describe(properties);
  properties.Check();
  const bool isAutomatic = o.RoughingStep == ToolPathOptions::AutomaticRoughing;
  Require(o.Finishing || o.RoughingStep > 0 || isAutomatic,
    "there is nothing to do: Finishing is off and RoughingStep is 0");
  Require(o.ScallopHeight < o.Tool.Radius,
    "ScallopHeight is " + FormatNumber(o.ScallopHeight) + " mm; it must be less than ToolRadius");
  Require(o.ScallopHeight == 0 || GetStepOver(o.Tool.Radius, o.ScallopHeight) >= LeastStepOver,
    "ScallopHeight is " + FormatNumber(o.ScallopHeight) +
      " mm, which takes finishing lines less than 0.01 mm apart");
  Require(o.ScallopHeight == 0 || o.Tool.Shape == ToolShape::Ball,
    "ScallopHeight is for ball ends; give StepOver for a flat end");
  const auto requireInTool = [&o](const char* name, double value)
  {
    Require(value <= 2 * o.Tool.Radius,
      std::string(name) + " is " + FormatNumber(value) +
        " mm; it must be at most the tool's diameter, " + FormatNumber(2 * o.Tool.Radius) + " mm");
  };
  requireInTool("StepOver", o.StepOver);
  requireInTool("RoughingStepOver", o.RoughingStepOver);
  Require(isAutomatic || o.RoughingStep == 0 || o.RoughingStep >= 0.01,
    "RoughingStep is " + FormatNumber(o.RoughingStep) +
      " mm; it must be -1 (automatic), 0 (no roughing) or from 0.01 to 1000 mm");
}

//------------------------------------------------------------------------------
// The tool's places at equal steps along a line.
using Samples = std::vector<Vec3>;

std::int64_t CountSamples(const Raster::Line& line, double step)
{
  // both ends at least, also of a line that all but touches a corner
  return static_cast<std::int64_t>(std::max(1.0, std::ceil(line.GetLength() / step - 1e-6))) + 1;
}

std::vector<Samples> DropLines(Execution& execution, const DropCutter& cutter, const Raster& raster,
  const std::vector<double>& offsets, double step, bool beyond)
{
  std::vector<Raster::Line> lines;
  double count = 0;
  for (const double offset : offsets)
  {
    lines.push_back(raster.GetLine(offset));
    count += std::ceil(lines.back().GetLength() / step) + 1;
  }
  RequireMemory("the tool path", count * 4 * sizeof(Vec3));
  std::vector<Samples> result(lines.size());
  execution.For(static_cast<std::int64_t>(lines.size()), 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      PathTracer tracer(cutter, 0, beyond);
      for (std::int64_t k = begin; k < end; ++k)
      {
        const Raster::Line& line = lines[k];
        if (line.GetLength() < 1e-6)
        {
          continue; // only touches a corner
        }
        const std::int64_t samples = CountSamples(line, step);
        result[k].reserve(samples);
        for (std::int64_t i = 0; i < samples; ++i)
        {
          const double t = static_cast<double>(i) / static_cast<double>(samples - 1);
          result[k].push_back(tracer.GetPosition(line.First[0] + t * (line.Last[0] - line.First[0]),
            line.First[1] + t * (line.Last[1] - line.First[1])));
        }
      }
    });
  return result;
}

//------------------------------------------------------------------------------
// The cuts along a line, not lower than floor, where something lower than ceiling is to be cut,
// and one step on either side, so that nothing is left between.
std::vector<Samples> TraceLine(
  PathTracer& tracer, const Samples& samples, double floor, double ceiling, bool backwards)
{
  std::vector<Samples> spans;
  const std::size_t count = samples.size();
  bool open = false;
  for (std::size_t i = 0; i < count; ++i)
  {
    const auto at = [&](std::size_t k) -> const Vec3&
    { return samples[backwards ? count - 1 - k : k]; };
    const auto low = [&](std::size_t k) { return at(k)[2] < ceiling; };
    const bool wanted =
      std::isfinite(at(i)[2]) && (low(i) || (i > 0 && low(i - 1)) || (i + 1 < count && low(i + 1)));
    if (!wanted)
    {
      open = false;
      continue;
    }
    Vec3 p = at(i);
    p[2] = std::max(p[2], floor);
    if (!open)
    {
      spans.push_back({ p });
      open = true;
    }
    else
    {
      tracer.Connect(spans.back(), p, true);
    }
  }
  return spans;
}

//------------------------------------------------------------------------------
// Puts cuts, and the ways between them, together to a path.
class Assembler
{
public:
  Assembler(ToolPath& path, const ToolPathOptions& options)
    : Path(path)
    , Options(options)
  {
  }

  // Cuts along points, which it uses up. The tool stays down from the end of the cut before if
  // that is at most linkLimit away.
  void Cut(PathTracer& tracer, Samples& points, std::int32_t pass, double linkLimit, double step,
    bool leads)
  {
    this->Pass = pass;
    this->Tracer = &tracer;
    if (!this->Down || !this->Link(tracer, points.front(), linkLimit, step))
    {
      this->Retract(leads);
      Samples lead{ points.front() };
      if (leads)
      {
        lead = this->GetLead(points.front(), this->GetDirection(points, true));
        std::reverse(lead.begin(), lead.end());
      }
      this->Approach(lead.front());
      this->Follow(lead, Motion::Lead, 1);
    }
    this->Follow(points, Motion::Cut, 1);
    this->Exit = this->GetDirection(points, false);
    this->Down = true;
  }

  // Up to where rapid motions are.
  void Retract(bool leads)
  {
    if (!this->Down)
    {
      return;
    }
    if (leads)
    {
      const Samples lead = this->GetLead(this->Path.Points.back(), this->Exit);
      this->Path.Points.back() = lead.front(); // may have been lifted
      this->Follow(lead, Motion::Lead, 1);
    }
    const Vec3 p = this->Path.Points.back();
    this->Begin(Motion::Rapid);
    this->Add({ p[0], p[1], this->Path.SafeZ });
    this->Down = false;
  }

private:
  void Begin(Motion kind)
  {
    auto& runs = this->Path.Runs;
    if (!runs.empty() && runs.back().Kind == kind && runs.back().Pass == this->Pass)
    {
      return;
    }
    const auto size = static_cast<std::int64_t>(this->Path.Points.size());
    runs.push_back({ kind, this->Pass, size, 0 });
    if (size > 0)
    {
      this->Add(Vec3(this->Path.Points.back()));
    }
  }

  void Add(const Vec3& p)
  {
    this->Path.Points.push_back(p);
    ++this->Path.Runs.back().Count;
  }

  void Follow(const Samples& points, Motion kind, std::size_t first)
  {
    if (points.size() > first)
    {
      this->Begin(kind);
      for (std::size_t k = first; k < points.size(); ++k)
      {
        this->Add(points[k]);
      }
    }
  }

  // Above a point and down to it.
  void Approach(const Vec3& p)
  {
    const bool start = this->Path.Points.empty();
    this->Begin(start ? Motion::Plunge : Motion::Rapid);
    this->Add({ p[0], p[1], this->Path.SafeZ });
    this->Begin(Motion::Plunge);
    this->Add(p);
  }

  // On along the surface to the start of the next cut.
  bool Link(PathTracer& tracer, const Vec3& next, double limit, double step)
  {
    const Vec3 start = this->Path.Points.back();
    const double length = std::hypot(next[0] - start[0], next[1] - start[1]);
    if (length > limit)
    {
      return false;
    }
    Samples way{ start };
    const auto count = static_cast<std::int64_t>(std::max(1.0, std::ceil(length / step - 1e-6)));
    for (std::int64_t k = 1; k <= count; ++k)
    {
      const double t = static_cast<double>(k) / static_cast<double>(count);
      const Vec3 p = k == count ? next
                                : tracer.GetPosition(start[0] + t * (next[0] - start[0]),
                                    start[1] + t * (next[1] - start[1]));
      if (!std::isfinite(p[2]))
      {
        return false;
      }
      tracer.Connect(way, p, true);
    }
    // both ends may have been lifted
    this->Path.Points.back() = way.front();
    this->Follow(way, Motion::Cut, 1);
    return true;
  }

  // Unit vector along the first motion, or against the last one of the path.
  Vec3 GetDirection(const Samples& points, bool front) const
  {
    const std::size_t count = points.size();
    if (count < 2)
    {
      const double a = this->Options.Direction * Pi / 180;
      return { std::cos(a), std::sin(a), 0 };
    }
    return front ? Normalized(points[1] - points[0])
                 : Normalized(points[count - 2] - points[count - 1]);
  }

  // A quarter circle from p, where it touches direction, backwards and up.
  Samples GetLead(const Vec3& p, const Vec3& direction)
  {
    Samples lead{ p };
    const double flat = std::hypot(direction[0], direction[1]);
    const double radius = std::min(this->Options.LeadRadius, this->Path.SafeZ - p[2]);
    if (!(radius > 0.01) || !(flat > 1e-3))
    {
      return lead;
    }
    const Vec3 up{ -direction[2] * direction[0] / flat, -direction[2] * direction[1] / flat, flat };
    const double turn = 2 * std::acos(std::max(0.0, 1 - this->Options.Tolerance / radius));
    const int count = std::max(2, static_cast<int>(std::ceil(0.5 * Pi / turn)));
    for (int k = 1; k <= count; ++k)
    {
      const double angle = 0.5 * Pi * k / count;
      const Vec3 q =
        p + (-radius * std::sin(angle)) * direction + (radius * (1 - std::cos(angle))) * up;
      Vec3 place = ToMicrometres(q[0], q[1], q[2]);
      place[2] = std::max(place[2], this->Tracer->GetPosition(q[0], q[1])[2]);
      if (place[2] > this->Path.SafeZ)
      {
        break;
      }
      this->Tracer->Connect(lead, place, false);
    }
    return lead;
  }

  ToolPath& Path;
  const ToolPathOptions& Options;
  PathTracer* Tracer = nullptr; // of the last cut
  std::int32_t Pass = 0;
  Vec3 Exit{ 1, 0, 0 };
  bool Down = false;
};

//------------------------------------------------------------------------------
// One pass over a raster: all lines are traced in parallel, then linked one after the other.
struct Pass
{
  const DropCutter& Cutter;
  double Floor;
  double Ceiling;
  double LinkLimit;
  double Step;
  bool Leads;
};

void AddPass(Execution& execution, Assembler& assembler, const std::vector<Samples>& lines,
  const Pass& pass, std::int32_t number, const ToolPathOptions& options)
{
  std::vector<std::vector<Samples>> spans(lines.size());
  execution.For(static_cast<std::int64_t>(lines.size()), 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      PathTracer tracer(pass.Cutter, options.Tolerance, options.Overrun > 0, pass.Floor);
      for (std::int64_t k = begin; k < end; ++k)
      {
        spans[k] =
          TraceLine(tracer, lines[k], pass.Floor, pass.Ceiling, !options.OneWay && k % 2 == 1);
      }
    });
  PathTracer tracer(pass.Cutter, options.Tolerance, options.Overrun > 0, pass.Floor);
  for (std::vector<Samples>& line : spans)
  {
    for (Samples& span : line)
    {
      assembler.Cut(tracer, span, number, pass.LinkLimit, pass.Step, pass.Leads);
    }
    line = {};
  }
  assembler.Retract(pass.Leads);
}

// Where the tool goes lowest; z is infinite when it goes nowhere.
Vec3 FindDeepest(const std::vector<Samples>& lines)
{
  Vec3 deepest{ 0, 0, Infinity };
  for (const Samples& line : lines)
  {
    for (const Vec3& p : line)
    {
      deepest = std::isfinite(p[2]) && p[2] < deepest[2] ? p : deepest;
    }
  }
  return deepest;
}

void AddRoughing(Execution& execution, ToolPath& path, Assembler& assembler,
  const MillSurface& surface, const ToolPathOptions& options, const Raster& raster, double along)
{
  const DropCutter cutter(surface, options.Tool, options.StockAllowance);
  const std::vector<double> offsets = raster.GetOffsets(
    options.RoughingStepOver > 0 ? options.RoughingStepOver : options.Tool.Radius);
  const double step = offsets[1] - offsets[0];
  const std::vector<Samples> lines =
    DropLines(execution, cutter, raster, offsets, along, options.Overrun > 0);
  const double deepest = FindDeepest(lines)[2];
  const bool isAutomatic = options.RoughingStep == ToolPathOptions::AutomaticRoughing;
  if (isAutomatic && options.Finishing &&
    path.StockTop - deepest + options.StockAllowance <= options.Tool.Radius)
  {
    return;
  }
  const double depthOfLevel = isAutomatic ? options.Tool.Radius / 2 : options.RoughingStep;
  const double levels = std::ceil((path.StockTop - deepest) / depthOfLevel - 1e-9);
  Require(levels <= LargestLevels,
    "RoughingStep gives " + FormatNumber(levels) + " levels; at most 10000 are possible");
  path.Levels = static_cast<std::int32_t>(std::max(0.0, levels));
  double cuts = 0; // positions that are cut, each on all levels above it
  for (const Samples& line : lines)
  {
    for (const Vec3& p : line)
    {
      cuts += std::isfinite(p[2]) && p[2] < path.StockTop
        ? std::ceil((path.StockTop - p[2]) / depthOfLevel)
        : 0;
    }
  }
  RequireMemory("the roughing path", cuts * 2 * sizeof(Vec3));
  for (std::int32_t level = 0; level < path.Levels; ++level)
  {
    execution.SetStage(0.1 + 0.4 * level / path.Levels, 0.1 + 0.4 * (level + 1) / path.Levels);
    const double ceiling = path.StockTop - level * depthOfLevel;
    const double floor = ToMicrometres(0, 0, std::max(deepest, ceiling - depthOfLevel))[2];
    AddPass(execution, assembler, lines,
      { cutter, floor, ceiling - 0.5 * MotionTolerance, options.OneWay ? 0 : 3 * step, along,
        false },
      level, options);
  }
  if (const double depth = std::min(depthOfLevel, path.StockTop - deepest);
      depth > options.Tool.Radius)
  {
    path.Warnings.push_back("a level of roughing takes off up to " +
      FormatNumber(std::round(100 * depth) / 100) +
      " mm at once, more than the tool's radius: it may break. Make RoughingStep smaller");
  }
  if (path.Levels == 0)
  {
    path.Warnings.emplace_back("there is nothing to rough: StockTop is not higher than the surface "
                               "with StockAllowance");
  }
}

void AddFinishing(Execution& execution, ToolPath& path, Assembler& assembler,
  const MillSurface& surface, const ToolPathOptions& options, const Raster& raster, double along)
{
  const DropCutter cutter(surface, options.Tool);
  execution.SetStage(0.5, 0.6);
  std::vector<double> offsets;
  if (options.ScallopHeight > 0)
  {
    const Execution::NestedStages nested(execution);
    offsets = raster.GetOffsets(
      execution, cutter, GetStepOver(options.Tool.Radius, options.ScallopHeight), along);
  }
  else
  {
    offsets = raster.GetOffsets(options.StepOver);
  }
  path.SmallestStepOver = Infinity;
  for (std::size_t k = 1; k < offsets.size(); ++k)
  {
    path.LargestStepOver = std::max(path.LargestStepOver, offsets[k] - offsets[k - 1]);
    path.SmallestStepOver = std::min(path.SmallestStepOver, offsets[k] - offsets[k - 1]);
  }
  execution.SetStage(0.6, 0.75);
  const std::vector<Samples> lines =
    DropLines(execution, cutter, raster, offsets, along, options.Overrun > 0);
  const Vec3 deepest = FindDeepest(lines);
  const double depth = path.StockTop - deepest[2];
  if (options.RoughingStep == 0 && depth > options.Tool.Radius)
  {
    const double top = path.StockTop + 0.0; // not -0
    path.Warnings.push_back("without roughing the first pass takes off up to " +
      FormatNumber(std::round(100 * depth) / 100) + " mm at once (from StockTop, z " +
      FormatNumber(top) + ", to x " + FormatNumber(deepest[0]) + ", y " + FormatNumber(deepest[1]) +
      "), more than the tool's radius: it may break. Give RoughingStep, "
      "unless the part has been roughed before");
  }
  execution.SetStage(0.75, 1);
  AddPass(execution, assembler, lines,
    { cutter, -Infinity, Infinity, options.OneWay ? 0 : 3 * path.LargestStepOver, along,
      options.LeadRadius > 0 },
    path.Levels, options);
}
}

//------------------------------------------------------------------------------
void ToolPathOptions::Describe(Properties& properties) const
{
  properties.Add("ToolShape", static_cast<int>(this->Tool.Shape), ToolShapeNames)
    .Add("ToolRadius", this->Tool.Radius, ValueRange::Above(0, "mm").UpTo(1000))
    .Add("StepOver", this->StepOver, ValueRange::AtLeast(LeastStepOver, "mm"))
    .Add("ScallopHeight", this->ScallopHeight, ValueRange::Above(0, "mm").OrZero("StepOver"))
    .Add("Overrun", this->Overrun, ValueRange::Between(0, 1000, "mm"))
    .Add("Direction", this->Direction, ValueRange::Between(-36000, 36000, "degrees"))
    .Add("Finishing", this->Finishing)
    .Add("RoughingStep", this->RoughingStep, ValueRange::Between(AutomaticRoughing, 1000, "mm"))
    .Add("RoughingStepOver", this->RoughingStepOver,
      ValueRange::AtLeast(0.01, "mm").OrZero("tool's radius"))
    .Add("StockAllowance", this->StockAllowance, ValueRange::Between(0, 100, "mm"))
    .Add("StockTop", this->StockTop, ValueRange::Between(-1e5, 1e5, "mm"))
    .Add("SafeHeight", this->SafeHeight, ValueRange::Between(0.1, 1000, "mm"))
    .Add(
      "LeadRadius", this->LeadRadius, ValueRange::Above(0, "mm").UpTo(1000).OrZero("straight down"))
    .Add("PathStep", this->PathStep, ValueRange::Between(0.01, 1000, "mm").OrZero("of the surface"))
    .Add("Tolerance", this->Tolerance, ValueRange::Between(0.0001, 10, "mm"));
}

//------------------------------------------------------------------------------
double GetStepOver(double radius, double height)
{
  return 2 * std::sqrt(height * (2 * radius - height));
}

//------------------------------------------------------------------------------
ToolPath MakeToolPath(
  Execution& execution, const MillSurface& surface, const ToolPathOptions& options)
{
  CheckOptions(options);
  const Execution::NestedStages nested(execution);
  ToolPath path;
  path.StockTop = ToMicrometres(0, 0, std::max(options.StockTop, surface.GetHighest()[2]))[2];
  path.SafeZ = ToMicrometres(0, 0, path.StockTop + options.SafeHeight)[2];
  const Raster raster(surface, options.Direction, options.Overrun);
  const double along =
    options.PathStep > 0 ? options.PathStep : std::max(0.01, surface.GetSpacing());
  Assembler assembler(path, options);
  execution.SetStage(0, 0.1);
  if (options.RoughingStep != 0)
  {
    AddRoughing(execution, path, assembler, surface, options, raster, along);
  }
  if (options.Finishing)
  {
    AddFinishing(execution, path, assembler, surface, options, raster, along);
  }
  return path;
}
}
