// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaHoleFillOptions.h"

#include "lacunaMemory.h"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace lacuna
{
namespace
{
void CheckOptions(const HoleFillOptions& options)
{
  Properties properties;
  options.Describe(properties);
  properties.Check();
  if (options.Smoothing > 0 && options.CutoffWavelength > 0)
  {
    throw std::invalid_argument("Smoothing and CutoffWavelength are both above 0, and each "
                                "determines the other; set one of them to 0");
  }
  if (options.CutoffWavelength > 0 && IsRadialShaped(options.Kernel))
  {
    throw std::invalid_argument("CutoffWavelength needs a kernel that is a power of distance: "
                                "ThinPlate, Linear, Cubic or Triharmonic; with kernels that have "
                                "a KernelLength set it to 0 and use Smoothing");
  }
  if (options.Accuracy == 1)
  {
    throw std::invalid_argument("Accuracy is 1; it must be less");
  }
  if (options.Solver == RadialSolver::Fast && options.Accuracy == 0)
  {
    throw std::invalid_argument("Solver Fast iterates and needs an Accuracy above 0, such as 1e-6; "
                                "for a fit exact up to round-off set Solver to Direct");
  }
}
}

//------------------------------------------------------------------------------
void HoleFillOptions::Describe(Properties& properties) const
{
  constexpr ValueRange size = ValueRange::Above(0, "mm");
  properties.Add("Kernel", static_cast<int>(this->Kernel), RadialKernelNames)
    .Add("KernelLength", this->KernelLength, size.OrZero("automatic"))
    .Add("Trend", static_cast<int>(this->Trend), HoleTrendNames)
    .Add("SupportMargin", this->SupportMargin, size)
    .Add("SupportStepMargin", this->SupportStepMargin, size.OrZero("off"))
    .Add("NodeSpacing", this->NodeSpacing, size)
    .Add("Smoothing", this->Smoothing, ValueRange::Above(0, "mm^2").OrZero("through the nodes"))
    .Add("CutoffWavelength", this->CutoffWavelength, size.OrZero("off"))
    .Add("OutputMargin", this->OutputMargin, ValueRange::AtLeast(0, "mm"))
    .Add("OutputSpacing", this->OutputSpacing, size.OrZero("of the map"))
    .Add("Accuracy", this->Accuracy, ValueRange::Between(0, 1))
    .Add("Solver", static_cast<int>(this->Solver), RadialSolverNames);
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
MapGrid GetOutputGrid(const MapGrid& grid, const HoleFillOptions& options)
{
  CheckOptions(options);
  MapGrid to;
  const int first[2] = { grid.FirstColumn, grid.FirstRow };
  const int size[2] = { grid.Width, grid.Height };
  double begin[2], count[2];
  for (std::size_t c = 0; c < 2; ++c)
  {
    to.Spacing[c] = options.OutputSpacing[c] > 0 ? options.OutputSpacing[c] : grid.Spacing[c];
    const double low = first[c] * grid.Spacing[c] - options.OutputMargin;
    const double high = (first[c] + (size[c] - 1)) * grid.Spacing[c] + options.OutputMargin;
    begin[c] = std::ceil(low / to.Spacing[c] - PixelRounding);
    count[c] = std::floor(high / to.Spacing[c] + PixelRounding) - begin[c] + 1;
    if (count[c] < 1)
    {
      throw std::invalid_argument("OutputSpacing is larger than the map; lower it");
    }
  }
  RequireMemory(
    "the filled map (raise OutputSpacing or lower OutputMargin)", 100 * count[0] * count[1]);
  int* const newFirst[2] = { &to.FirstColumn, &to.FirstRow };
  int* const newSize[2] = { &to.Width, &to.Height };
  for (std::size_t c = 0; c < 2; ++c)
  {
    const double limit = std::numeric_limits<int>::max() / 2;
    if (!(std::abs(begin[c]) < limit) || !(count[c] < limit))
    {
      throw std::length_error(
        "the output would have too many pixels; raise OutputSpacing or lower OutputMargin");
    }
    *newFirst[c] = static_cast<int>(begin[c]);
    *newSize[c] = static_cast<int>(count[c]);
  }
  return to;
}

//------------------------------------------------------------------------------
RadialBasisOptions GetFitOptions(
  const HoleFillOptions& options, double areaPerNode, bool controllable)
{
  RadialBasisOptions fit;
  fit.Words.Smoothing = "Smoothing or CutoffWavelength";
  fit.Kernel = options.Kernel;
  fit.Shape = options.KernelLength;
  fit.Smoothing = options.CutoffWavelength > 0
    ? GetCutoffSmoothing(options.Kernel, options.CutoffWavelength, areaPerNode)
    : options.Smoothing;
  fit.Accuracy = options.Accuracy;
  fit.Solver = options.Solver;
  fit.MaximumBytes = options.MaximumBytes;
  fit.Controllable = controllable;
  return fit;
}
}
