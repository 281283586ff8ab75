// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaHoleFillOptions.h"

#include "lacunaMemory.h"

#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace lacuna
{
namespace
{
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
  check("SupportStepMargin", options.SupportStepMargin, false);
  check("NodeSpacing", options.NodeSpacing, true);
  check("OutputMargin", options.OutputMargin, false);
  check("CutoffWavelength", options.CutoffWavelength, false);
  check("KernelLength", options.KernelLength, false);
  check("OutputSpacing", options.OutputSpacing[0], false);
  check("OutputSpacing", options.OutputSpacing[1], false);
  if (!std::isfinite(options.Smoothing) || options.Smoothing < 0)
  {
    throw std::invalid_argument("Smoothing must be a finite number >= 0");
  }
  if (options.Smoothing > 0 && options.CutoffWavelength > 0)
  {
    throw std::invalid_argument("Smoothing and CutoffWavelength are both above 0, and each "
                                "determines the other; set one of them to 0");
  }
  if (options.CutoffWavelength > 0 &&
    (options.Kernel == RadialKernel::Gaussian || options.Kernel == RadialKernel::Multiquadric))
  {
    throw std::invalid_argument("CutoffWavelength needs a kernel that is a power of distance: "
                                "ThinPlate, Linear, Cubic or Triharmonic; with Gaussian and "
                                "Multiquadric set it to 0 and use Smoothing");
  }
  if (!(options.Accuracy >= 0) || !(options.Accuracy < 1))
  {
    std::ostringstream message;
    message << "Accuracy is " << options.Accuracy << "; it must be a number from 0 to less than 1";
    throw std::invalid_argument(message.str());
  }
  if (options.Solver == RadialSolver::Fast && options.Accuracy == 0)
  {
    throw std::invalid_argument("Solver Fast iterates and needs an Accuracy above 0, such as 1e-6; "
                                "for a fit exact up to round-off set Solver to Direct");
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
