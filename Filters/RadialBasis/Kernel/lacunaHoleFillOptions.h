// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How a hole in a depth map is filled, and what follows from it.
#ifndef lacunaHoleFillOptions_h
#define lacunaHoleFillOptions_h

#include "lacunaHoleSupport.h"
#include "lacunaProperties.h"
#include "lacunaRadialBasis.h"
#include "lacunaVector.h"

#include <array>
#include <cstdint>

namespace lacuna
{
enum class HoleTrend
{
  None = 0,
  Ellipsoid = 1 ///< the fit is of the difference to the best EllipsoidTrend
};
inline constexpr std::array<const char*, 2> HoleTrendNames{ "None", "Ellipsoid" };

struct HoleFillOptions
{
  RadialKernel Kernel = RadialKernel::ThinPlate;
  double KernelLength = 0; ///< mm, see RadialBasisOptions::Shape
  HoleTrend Trend = HoleTrend::None;
  double SupportMargin = 12;    ///< mm
  double SupportStepMargin = 0; ///< mm, see SupportMargins::Step
  double NodeSpacing = 1;       ///< mm
  double Smoothing = 0;         ///< see RadialBasisOptions
  double CutoffWavelength = 0;  ///< mm; above 0 it determines Smoothing, which must be 0
  double OutputMargin = 0;      ///< mm
  Vec2 OutputSpacing{ 0, 0 };   ///< mm; 0: that of the map
  double Accuracy = 1e-4;       ///< see RadialBasisOptions
  RadialSolver Solver = RadialSolver::Auto;
  std::uint64_t MaximumBytes = RadialBasisOptions().MaximumBytes;

  void Describe(Properties& properties) const; ///< with the ranges
};

/// In pixels: positions are products that round.
constexpr double PixelRounding = 1e-9;

/// The Smoothing with which a fit to nodes of areaPerNode mm^2 each transmits half the amplitude of
/// waves of this length, mm, and less of shorter ones: the spline filter of ISO 16610-22 for a
/// surface. phi has the Fourier transform F / k^(Power + 2), its energy is C times that of
/// |s^|^2 k^(Power + 2) / F, so the transmission is 1 / (1 + Smoothing C areaPerNode k^(Power + 2) /
/// F). Throws std::invalid_argument for kernels without a power (Gaussian, multiquadric).
double GetCutoffSmoothing(RadialKernel kernel, double wavelength, double areaPerNode);

/// Pixels of the spacing asked for, 0 the map's own, on the lattice through x = y = 0 that
/// lie in the map grown by OutputMargin on each side. Throws std::invalid_argument or
/// std::length_error when the options are bad or there are too many pixels.
MapGrid GetOutputGrid(const MapGrid& grid, const HoleFillOptions& options);

/// Of the fit to nodes of areaPerNode mm^2 each.
RadialBasisOptions GetFitOptions(
  const HoleFillOptions& options, double areaPerNode, bool controllable);
}
#endif
