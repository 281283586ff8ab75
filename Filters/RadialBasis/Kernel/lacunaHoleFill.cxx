// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaHoleFill.h"

#include "lacunaBaseSurface.h"
#include "lacunaExecution.h"
#include "lacunaMemory.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace lacuna
{
namespace
{
constexpr double NotANumber = std::numeric_limits<double>::quiet_NaN();
std::array<double, 2> GetPosition(const MapGrid& grid, std::size_t pixel)
{
  return { static_cast<double>(grid.GetColumn(pixel)) * grid.Spacing[0],
    static_cast<double>(grid.GetRow(pixel)) * grid.Spacing[1] };
}

// Bounds of what is filled, used and controlled, grown by margin, in pixels of to.
std::array<int, 4> FindRectangle(
  const HoleFillInput& input, const MapMask& support, double margin, const MapGrid& to)
{
  double low[2] = { HUGE_VAL, HUGE_VAL };
  double high[2] = { -HUGE_VAL, -HUGE_VAL };
  const auto add = [&](double x, double y)
  {
    low[0] = std::min(low[0], x);
    high[0] = std::max(high[0], x);
    low[1] = std::min(low[1], y);
    high[1] = std::max(high[1], y);
  };
  for (std::size_t pixel = 0; pixel < support.size(); ++pixel)
  {
    if (input.Defect[pixel] || support[pixel])
    {
      const std::array<double, 2> p = GetPosition(input.Grid, pixel);
      add(p[0], p[1]);
    }
  }
  for (const Vec3& p : input.ControlPoints)
  {
    add(p[0], p[1]);
  }
  const int size[2] = { to.Width, to.Height };
  const int first[2] = { to.FirstColumn, to.FirstRow };
  std::array<int, 4> box{};
  for (std::size_t c = 0; c < 2; ++c)
  {
    // in double first: the margin may be larger than any map
    const double begin = std::floor((low[c] - margin) / to.Spacing[c] + PixelRounding) - first[c];
    const double end = std::ceil((high[c] + margin) / to.Spacing[c] - PixelRounding) - first[c];
    box[2 * c] = static_cast<int>(std::clamp(begin, 0.0, size[c] - 1.0));
    box[2 * c + 1] = static_cast<int>(std::clamp(end, 0.0, size[c] - 1.0));
  }
  return box;
}

// Control points in the map's plane and what the fit is to have there.
struct Control
{
  std::vector<std::array<double, 2>> Places;
  std::vector<double> Values;

  Control(const HoleFillInput& input, const BaseSurface& base, const MapGrid& grid)
  {
    for (std::size_t k = 0; k < input.ControlPoints.size(); ++k)
    {
      const Vec3& p = input.ControlPoints[k];
      const double i = p[0] / grid.Spacing[0] - grid.FirstColumn;
      const double j = p[1] / grid.Spacing[1] - grid.FirstRow;
      const auto fail = [k](const std::string& what)
      { throw std::invalid_argument("control point " + std::to_string(k) + " " + what); };
      if (!IsFinite(p))
      {
        fail("has a coordinate that is not a finite number");
      }
      if (!(i >= -0.5 && j >= -0.5 && i <= grid.Width - 0.5 && j <= grid.Height - 0.5))
      {
        fail("lies beside the map; points are in patient coordinates, mm");
      }
      const double below = base.Evaluate(p[0], p[1]);
      if (std::isnan(below))
      {
        fail("lies where the prior surface or the trend is missing");
      }
      this->Places.push_back({ p[0], p[1] });
      this->Values.push_back(p[2] - below);
    }
  }
};

void EvaluateRectangle(Execution& execution, const RadialBasis<2>& function, HoleFillResult& result)
{
  const auto& box = result.Rectangle;
  const MapGrid& grid = result.Grid;
  RegularGrid<2> part;
  part.Origin = { (grid.FirstColumn + box[0]) * grid.Spacing[0],
    (grid.FirstRow + box[2]) * grid.Spacing[1] };
  part.Spacing = { grid.Spacing[0], grid.Spacing[1] };
  part.Size = { box[1] - box[0] + 1, box[3] - box[2] + 1 };
  std::vector<double> values(static_cast<std::size_t>(part.GetNumberOfPoints()));
  function.EvaluateGrid(execution, part, values.data());
  for (std::size_t k = 0; k < values.size(); ++k)
  {
    const std::size_t column = box[0] + k % static_cast<std::size_t>(part.Size[0]);
    const std::size_t row = box[2] + k / static_cast<std::size_t>(part.Size[0]);
    result.Fitted[row * grid.Width + column] = values[k];
  }
}

void EvaluateGradients(Execution& execution, const RadialBasis<2>& function, HoleFillResult& result)
{
  std::vector<std::array<double, 2>> points;
  for (const std::size_t pixel : result.Filled)
  {
    points.push_back(GetPosition(result.Grid, pixel));
  }
  std::vector<double> values;
  function.Evaluate(execution, points, values, result.Gradients);
}

std::array<double, 3> FindPlane(const HoleFillInput& input, const MapMask& support,
  const BaseSurface& base, const RadialBasis<2>& function)
{
  MapMask region = input.Defect;
  std::transform(region.begin(), region.end(), support.begin(), region.begin(),
    [](unsigned char a, unsigned char b) { return a | b; });
  std::array<double, 3> plane = base.FitPlane(region);
  for (std::size_t c = 0; c < 3; ++c)
  {
    plane[c] += function.GetPolynomial()[c];
  }
  return plane;
}

// Adds base (empty: none) to the fit, and its differences to the gradients in the defect.
void AddBase(const std::vector<double>& base, HoleFillResult& result)
{
  if (base.empty())
  {
    return;
  }
  const auto width = static_cast<std::size_t>(result.Grid.Width);
  for (std::size_t k = 0; k < result.Filled.size(); ++k)
  {
    const std::size_t pixel = result.Filled[k];
    for (std::size_t c = 0; c < 2; ++c)
    {
      // central if it can be, else to one side
      const std::size_t step = c == 0 ? 1 : width;
      const std::size_t index = c == 0 ? pixel % width : pixel / width;
      const std::size_t count = c == 0 ? width : base.size() / width;
      const bool before = index > 0 && !std::isnan(base[pixel - step]);
      const bool after = index + 1 < count && !std::isnan(base[pixel + step]);
      if (before || after)
      {
        result.Gradients[k][c] +=
          (base[after ? pixel + step : pixel] - base[before ? pixel - step : pixel]) /
          ((before + after) * result.Grid.Spacing[c]);
      }
    }
  }
  for (std::size_t pixel = 0; pixel < base.size(); ++pixel)
  {
    result.Fitted[pixel] += base[pixel];
  }
}

// What the output has before any fit: the map.
HoleFillResult TransferInput(
  const HoleFillInput& input, const MapGrid& grid, const std::vector<SupportUse>& use)
{
  HoleFillResult result;
  result.Grid = grid;
  GridTransfer transfer =
    TransferMap(input.Grid, input.Depth, input.Valid, MaximumSupportSlope, grid);
  result.Nearest = std::move(transfer.Nearest);
  result.Depth = std::move(transfer.Depth);
  result.Fitted.assign(grid.GetSize(), NotANumber);
  result.Deviation.assign(grid.GetSize(), NotANumber);
  result.Use.assign(grid.GetSize(), SupportUse::None);
  for (std::size_t pixel = 0; pixel < result.Nearest.size(); ++pixel)
  {
    const std::int64_t from = result.Nearest[pixel];
    if (from >= 0)
    {
      result.Use[pixel] = use.empty() ? SupportUse::None : use[from];
      if (input.Defect[from])
      {
        result.Filled.push_back(pixel);
      }
    }
  }
  return result;
}

// On another lattice pixels beside the defect lie between pixels of the map that are in it: there
// Depth is interpolated in the filled map, and nothing was measured to compare with.
void InterpolateFilled(Execution& execution, const HoleFillInput& input,
  const RadialBasis<2>& function, const std::vector<double>& base, HoleFillResult& result)
{
  MarkedMap filled{ input.Grid, input.Depth, input.Valid, {}, {} };
  std::vector<std::size_t> pixels;
  std::vector<std::array<double, 2>> points;
  for (std::size_t pixel = 0; pixel < input.Defect.size(); ++pixel)
  {
    if (input.Defect[pixel])
    {
      pixels.push_back(pixel);
      points.push_back(GetPosition(input.Grid, pixel));
      filled.Valid[pixel] = 0;
    }
  }
  const std::vector<double> measured =
    TransferMap(input.Grid, input.Depth, filled.Valid, MaximumSupportSlope, result.Grid).Depth;
  std::vector<double> values;
  function.Evaluate(execution, points, values);
  for (std::size_t k = 0; k < pixels.size(); ++k)
  {
    filled.Depth[pixels[k]] = values[k] + (base.empty() ? 0 : base[pixels[k]]);
    filled.Valid[pixels[k]] = std::isfinite(filled.Depth[pixels[k]]);
  }
  result.Depth =
    TransferMap(input.Grid, filled.Depth, filled.Valid, MaximumSupportSlope, result.Grid).Depth;
  for (std::size_t pixel = 0; pixel < measured.size(); ++pixel)
  {
    result.Deviation[pixel] = std::isnan(measured[pixel]) ? NotANumber : result.Deviation[pixel];
  }
}

// Compares the fit with what was measured, and puts it into the defect.
void FinishDepth(Execution& execution, const HoleFillInput& input, const RadialBasis<2>& function,
  const std::vector<double>& base, HoleFillResult& result)
{
  for (std::size_t pixel = 0; pixel < result.Depth.size(); ++pixel)
  {
    if (result.Use[pixel] == SupportUse::Used || result.Use[pixel] == SupportUse::Steep ||
      result.Use[pixel] == SupportUse::NoPrior)
    {
      result.Deviation[pixel] = result.Fitted[pixel] - result.Depth[pixel];
    }
  }
  const std::vector<double> measured = result.Depth;
  if (result.Grid.Spacing != input.Grid.Spacing)
  {
    InterpolateFilled(execution, input, function, base, result);
  }
  const double pixelArea = result.Grid.Spacing[0] * result.Grid.Spacing[1];
  for (std::size_t k = 0; k < result.Filled.size(); ++k)
  {
    const std::size_t pixel = result.Filled[k];
    const std::array<double, 2>& g = result.Gradients[k];
    result.Deviation[pixel] = result.Fitted[pixel] - measured[pixel];
    result.Depth[pixel] = result.Fitted[pixel];
    result.DefectArea += pixelArea * std::sqrt(1 + g[0] * g[0] + g[1] * g[1]);
  }
}
}

//------------------------------------------------------------------------------
bool HoleFiller::Problem::operator==(const Problem& other) const
{
  const RadialBasisOptions& a = this->Options;
  const RadialBasisOptions& b = other.Options;
  return this->Nodes == other.Nodes && this->Values == other.Values && a.Kernel == b.Kernel &&
    a.Smoothing == b.Smoothing && a.Shape == b.Shape && a.Accuracy == b.Accuracy &&
    a.Solver == b.Solver && a.MaximumBytes == b.MaximumBytes && a.Controllable == b.Controllable;
}

//------------------------------------------------------------------------------
HoleFiller::Problem HoleFiller::MakeProblem(const HoleFillInput& input, const BaseSurface& base,
  const MapMask& support, const HoleFillOptions& options)
{
  Problem problem;
  for (const std::size_t pixel : ThinNodes(input.Grid, support, options.NodeSpacing))
  {
    const double below = base.Exists() ? base.GetOnMap()[pixel] : 0;
    if (std::isfinite(below)) // a trend may end before the support
    {
      problem.Nodes.push_back(GetPosition(input.Grid, pixel));
      problem.Values.push_back(input.Depth[pixel] - below);
    }
  }
  const auto pixels = static_cast<double>(std::count(support.begin(), support.end(), 1));
  problem.Options = GetFitOptions(options,
    pixels * input.Grid.Spacing[0] * input.Grid.Spacing[1] /
      std::max(1.0, static_cast<double>(problem.Nodes.size())),
    !input.ControlPoints.empty());
  return problem;
}

//------------------------------------------------------------------------------
void HoleFiller::Fit(Execution& execution, Problem problem, HoleFillResult& result)
{
  result.Reused = this->Function && this->Last == problem;
  if (result.Reused)
  {
    return;
  }
  this->Function.reset();
  try
  {
    this->Function =
      std::make_unique<RadialBasis<2>>(execution, problem.Nodes, problem.Values, problem.Options);
  }
  catch (const std::length_error& e)
  {
    throw std::length_error(
      std::string(e.what()) + "; raise NodeSpacing, lower SupportMargin, or set Solver to Auto");
  }
  catch (const std::invalid_argument& e)
  {
    throw std::invalid_argument(std::string("the surface around the defect does not determine a "
                                            "fit: ") +
      e.what() + "; raise SupportMargin or lower NodeSpacing");
  }
  this->Last = std::move(problem);
}

//------------------------------------------------------------------------------
HoleFillResult HoleFiller::Fill(
  Execution& execution, const HoleFillInput& input, const HoleFillOptions& options)
{
  const MapGrid grid = GetOutputGrid(input.Grid, options);
  if (std::find(input.Defect.begin(), input.Defect.end(), 1) == input.Defect.end())
  {
    return TransferInput(input, grid, {});
  }
  if (!input.Prior.Points.empty() && options.Trend != HoleTrend::None)
  {
    throw std::invalid_argument(
      "a prior surface and Trend exclude each other; set Trend to None or take the prior away");
  }
  execution.SetStage(0.1, 0.15);
  const SupportMargins margins{ options.SupportMargin, options.SupportStepMargin };
  BaseSurface base(execution, input.Prior, input, margins);
  execution.SetStage(0.15, 0.2);
  const SupportSelection selection = SelectSupport(execution, input, margins, base.GetOnMap());
  if (options.Trend == HoleTrend::Ellipsoid)
  {
    base.SetTrend(selection.Support);
  }
  HoleFillResult result = TransferInput(input, grid, selection.Use);
  result.Warnings = selection.Warnings;
  result.Rectangle = FindRectangle(input, selection.Support, options.OutputMargin, grid);
  base.Complete(execution, selection.Support,
    FindRectangle(input, selection.Support, options.OutputMargin, input.Grid), options,
    result.Warnings);

  Problem problem = MakeProblem(input, base, selection.Support, options);
  const Control control(input, base, grid);
  const auto start = std::chrono::steady_clock::now();
  execution.SetStage(0.2, 0.6);
  this->Fit(execution, std::move(problem), result);
  execution.SetStage(0.6, 0.7);
  if (!control.Places.empty())
  {
    this->Function->SetControlPoints(
      execution, control.Places, { control.Values }, options.NodeSpacing);
  }
  result.FitSeconds =
    std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result.Fit = this->Function->GetReport();

  execution.SetStage(0.7, 0.9);
  EvaluateRectangle(execution, *this->Function, result);
  execution.SetStage(0.9, 0.95);
  EvaluateGradients(execution, *this->Function, result);
  execution.SetStage(0.95, 1);
  AddBase(base.Evaluate(execution, grid, result.Nearest, result.Rectangle), result);
  FinishDepth(execution, input, *this->Function, base.GetOnMap(), result);
  result.Plane = FindPlane(input, selection.Support, base, *this->Function);
  if (input.ControlPoints.empty())
  {
    this->Function.reset(); // nothing is dragged
  }
  return result;
}
}
