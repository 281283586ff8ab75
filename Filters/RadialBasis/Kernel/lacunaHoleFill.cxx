// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaHoleFill.h"

#include "lacunaDepthDiscontinuity.h"
#include "lacunaExecution.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr double NotANumber = std::numeric_limits<double>::quiet_NaN();

void CheckOptions(const HoleFillOptions& options)
{
  const auto check = [](const char* name, double value, bool positive)
  {
    if (!std::isfinite(value) || value < 0 || (positive && value == 0))
    {
      std::ostringstream message;
      message << name << " is " << value << "; it must be a finite number of mm "
              << (positive ? "above 0" : ">= 0");
      throw std::invalid_argument(message.str());
    }
  };
  check("SupportMargin", options.SupportMargin, true);
  check("NodeSpacing", options.NodeSpacing, true);
  check("OutputMargin", options.OutputMargin, false);
  check("CutoffWavelength", options.CutoffWavelength, false);
  if (!std::isfinite(options.Smoothing) || options.Smoothing < 0)
  {
    throw std::invalid_argument("Smoothing must be a finite number >= 0");
  }
  if (options.Smoothing > 0 && options.CutoffWavelength > 0)
  {
    throw std::invalid_argument("Smoothing and CutoffWavelength are both above 0, and each "
                                "determines the other; set one of them to 0");
  }
}

MapMask SelectSupport(Execution& execution, const HoleFillInput& input,
  const HoleFillOptions& options, std::vector<std::string>& warnings)
{
  const bool painted = !input.Painted.empty();
  MapMask support(input.Grid.GetSize());
  for (std::size_t pixel = 0; pixel < support.size(); ++pixel)
  {
    support[pixel] =
      input.Valid[pixel] && !input.Defect[pixel] && (!painted || input.Painted[pixel]);
  }
  if (!painted)
  {
    support = SelectWithin(execution, input.Grid, input.Defect, options.SupportMargin, support);
  }
  if (std::find(support.begin(), support.end(), 1) == support.end())
  {
    std::ostringstream message;
    message << "there is no surface to fit: outside of the defect no pixel ";
    if (painted)
    {
      message << "that is marked as support has a depth";
    }
    else
    {
      message << "within SupportMargin = " << options.SupportMargin
              << " mm of it has a depth; raise SupportMargin or mark a smaller defect";
    }
    throw std::invalid_argument(message.str());
  }
  const StepReport steps = RemoveBeyondSteps(input.Grid, input.Depth, MaximumSupportSlope, support);
  if (steps.RemovedPixels > 0)
  {
    std::ostringstream message;
    message << steps.RemovedPixels << " pixels around the defect lie beyond a depth step of up to "
            << steps.LargestStep << " mm from the rest and were not used for the fit: a part that "
            << "is seen through the hole, or the far side of an edge. Mark them as defect if they "
            << "shall be replaced, or choose a view in which the surface is not so steep";
    warnings.push_back(message.str());
  }
  return support;
}

// Where the support is so steep that depths are uncertain: a small shift of the surface across the
// view is a large one along it.
void WarnOfSteepSupport(
  const HoleFillInput& input, const MapMask& support, std::vector<std::string>& warnings)
{
  const DiscontinuityLimits limits;
  const SlopeRule rule(limits);
  const auto width = static_cast<std::size_t>(input.Grid.Width);
  std::size_t count = 0;
  std::size_t first = 0;
  for (std::size_t pixel = 0; pixel < support.size(); ++pixel)
  {
    const auto isSteep = [&](bool inside, std::size_t neighbour, double spacing)
    {
      return inside && support[pixel] && support[neighbour] &&
        rule.IsSteep({ input.Depth[neighbour] - input.Depth[pixel], spacing });
    };
    if (isSteep((pixel + 1) % width != 0, pixel + 1, input.Grid.Spacing[0]) ||
      isSteep(pixel + width < support.size(), pixel + width, input.Grid.Spacing[1]))
    {
      first = count++ == 0 ? pixel : first;
    }
  }
  if (count > 0)
  {
    std::ostringstream message;
    message << "at " << count << " pixels around the defect, first at column "
            << input.Grid.GetColumn(first) << ", row " << input.Grid.GetRow(first)
            << ", the surface is steeper than " << limits.MaximumAngle
            << " degrees against the map: depths are uncertain there. Choose a view that faces the "
            << "defect, or leave these pixels out with SupportArray";
    warnings.push_back(message.str());
  }
}

bool TouchesBorder(const MapGrid& grid, const MapMask& mask)
{
  const auto width = static_cast<std::size_t>(grid.Width);
  for (std::size_t pixel = 0; pixel < mask.size(); ++pixel)
  {
    const std::size_t i = pixel % width;
    const std::size_t j = pixel / width;
    if (mask[pixel] &&
      (i == 0 || j == 0 || i + 1 == width || j + 1 == static_cast<std::size_t>(grid.Height)))
    {
      return true;
    }
  }
  return false;
}

std::array<int, 4> FindRectangle(
  const MapGrid& grid, const MapMask& defect, const MapMask& support, double margin)
{
  std::array<int, 4> box{ grid.Width, -1, grid.Height, -1 };
  for (std::size_t pixel = 0; pixel < defect.size(); ++pixel)
  {
    if (defect[pixel] || support[pixel])
    {
      const int i = static_cast<int>(pixel % grid.Width);
      const int j = static_cast<int>(pixel / grid.Width);
      box = { std::min(box[0], i), std::max(box[1], i), std::min(box[2], j), std::max(box[3], j) };
    }
  }
  const int size[2] = { grid.Width, grid.Height };
  for (std::size_t c = 0; c < 2; ++c)
  {
    // in double first: the margin may be larger than any map
    const double grow = std::min<double>(size[c], std::ceil(margin / grid.Spacing[c] - 1e-9));
    box[2 * c] = std::max(0, box[2 * c] - static_cast<int>(grow));
    box[2 * c + 1] = std::min(size[c] - 1, box[2 * c + 1] + static_cast<int>(grow));
  }
  return box;
}

std::array<double, 2> GetPosition(const MapGrid& grid, std::size_t pixel)
{
  return { static_cast<double>(grid.GetColumn(pixel)) * grid.Spacing[0],
    static_cast<double>(grid.GetRow(pixel)) * grid.Spacing[1] };
}

RadialBasis<2> Fit(Execution& execution, const HoleFillInput& input, const HoleFillOptions& options,
  const MapMask& support)
{
  std::vector<std::array<double, 2>> nodes;
  std::vector<double> values;
  for (const std::size_t pixel : ThinNodes(input.Grid, support, options.NodeSpacing))
  {
    nodes.push_back(GetPosition(input.Grid, pixel));
    values.push_back(input.Depth[pixel]);
  }
  try
  {
    RadialBasisOptions fit;
    fit.Kernel = options.Kernel;
    fit.Smoothing = options.Smoothing;
    if (options.CutoffWavelength > 0 && !nodes.empty())
    {
      const auto pixels = static_cast<double>(std::count(support.begin(), support.end(), 1));
      fit.Smoothing = GetCutoffSmoothing(options.Kernel, options.CutoffWavelength,
        pixels * input.Grid.Spacing[0] * input.Grid.Spacing[1] / static_cast<double>(nodes.size()));
    }
    fit.MaximumBytes = options.MaximumBytes;
    return RadialBasis<2>(execution, nodes, values, fit);
  }
  catch (const std::length_error& e)
  {
    throw std::length_error(std::string(e.what()) + "; raise NodeSpacing or lower SupportMargin");
  }
  catch (const std::invalid_argument& e)
  {
    throw std::invalid_argument(std::string("the surface around the defect does not determine a "
                                            "fit: ") +
      e.what() + "; raise SupportMargin or lower NodeSpacing");
  }
}

void EvaluateRectangle(Execution& execution, const HoleFillInput& input,
  const RadialBasis<2>& function, HoleFillResult& result)
{
  const auto& box = result.Rectangle;
  std::vector<std::size_t> pixels;
  std::vector<std::array<double, 2>> points;
  for (int j = box[2]; j <= box[3]; ++j)
  {
    for (int i = box[0]; i <= box[1]; ++i)
    {
      pixels.push_back(static_cast<std::size_t>(j) * input.Grid.Width + i);
      points.push_back(GetPosition(input.Grid, pixels.back()));
    }
  }
  std::vector<double> values;
  function.Evaluate(execution, points, values);
  result.Fitted.assign(input.Grid.GetSize(), NotANumber);
  for (std::size_t k = 0; k < pixels.size(); ++k)
  {
    result.Fitted[pixels[k]] = values[k];
  }
}

void EvaluateDefect(Execution& execution, const HoleFillInput& input,
  const RadialBasis<2>& function, HoleFillResult& result)
{
  std::vector<std::array<double, 2>> points;
  for (std::size_t pixel = 0; pixel < input.Defect.size(); ++pixel)
  {
    if (input.Defect[pixel])
    {
      result.Filled.push_back(pixel);
      points.push_back(GetPosition(input.Grid, pixel));
    }
  }
  std::vector<double> values;
  function.Evaluate(execution, points, values, result.Gradients);
  const double pixelArea = input.Grid.Spacing[0] * input.Grid.Spacing[1];
  for (const std::array<double, 2>& g : result.Gradients)
  {
    result.DefectArea += pixelArea * std::sqrt(1 + g[0] * g[0] + g[1] * g[1]);
  }
}
}

//------------------------------------------------------------------------------
double GetCutoffSmoothing(RadialKernel kernel, double wavelength, double areaPerNode)
{
  constexpr double pi = 3.14159265358979323846;
  double transform = 0; // F
  switch (kernel)
  {
    case RadialKernel::ThinPlate:
      transform = 8 * pi;
      break;
    case RadialKernel::Linear:
      transform = 2 * pi;
      break;
    case RadialKernel::Triharmonic:
      transform = 128 * pi;
      break;
    case RadialKernel::Cubic:
      transform = 18 * pi;
      break;
    default:
      throw std::invalid_argument(
        "a cut-off wavelength needs a kernel that is a power of distance");
  }
  return transform / GetRadialEnergyFactor(kernel) / areaPerNode *
    std::pow(wavelength / (2 * pi), GetRadialPower(kernel) + 2);
}

//------------------------------------------------------------------------------
HoleFillResult FillHole(
  Execution& execution, const HoleFillInput& input, const HoleFillOptions& options)
{
  CheckOptions(options);
  HoleFillResult result;
  execution.SetStage(0.1, 0.2);
  result.Support = SelectSupport(execution, input, options, result.Warnings);
  WarnOfSteepSupport(input, result.Support, result.Warnings);
  if (TouchesBorder(input.Grid, input.Defect))
  {
    result.Warnings.emplace_back("the defect touches the border of the map: there is no surface "
                                 "on that side, and the fit extrapolates");
  }
  result.Rectangle = FindRectangle(input.Grid, input.Defect, result.Support, options.OutputMargin);
  execution.SetStage(0.2, 0.7);
  const RadialBasis<2> function = Fit(execution, input, options, result.Support);
  result.Fit = function.GetReport();
  result.Plane = function.GetPolynomial();
  execution.SetStage(0.7, 0.95);
  EvaluateRectangle(execution, input, function, result);
  execution.SetStage(0.95, 1);
  EvaluateDefect(execution, input, function, result);

  result.Deviation.assign(input.Grid.GetSize(), NotANumber);
  for (std::size_t pixel = 0; pixel < result.Deviation.size(); ++pixel)
  {
    if (input.Valid[pixel] && (input.Defect[pixel] || result.Support[pixel]))
    {
      result.Deviation[pixel] = result.Fitted[pixel] - input.Depth[pixel];
    }
  }
  return result;
}
}
