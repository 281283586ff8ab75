// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Fills a hole in a depth map with a radial basis function fitted to the surface around it (Carr
/// 1996, section 6.4).
#ifndef lacunaHoleFill_h
#define lacunaHoleFill_h

#include "lacunaHoleSupport.h"
#include "lacunaRadialBasis.h"

#include <array>
#include <string>
#include <vector>

namespace lacuna
{
class Execution;

/// A parallel depth map and what is marked on it. All arrays have Grid.GetSize() elements.
struct HoleFillInput
{
  MapGrid Grid;
  std::vector<double> Depth; ///< mm
  MapMask Valid;             ///< where Depth counts; it must be finite there
  MapMask Defect;            ///< what to replace and fill, valid or not
  /// Pixels that may carry the fit; empty means those within SupportMargin of the defect.
  MapMask Painted;
};

struct HoleFillOptions
{
  RadialKernel Kernel = RadialKernel::ThinPlate;
  double SupportMargin = 12;   ///< mm, > 0
  double NodeSpacing = 1;      ///< mm, > 0
  double Smoothing = 0;        ///< see RadialBasisOptions
  double CutoffWavelength = 0; ///< mm, >= 0; above 0 it determines Smoothing, which must be 0
  double OutputMargin = 0;     ///< mm, >= 0
  std::uint64_t MaximumBytes = RadialBasisOptions().MaximumBytes;
};

/// Two edge neighbours of the support whose depths differ by more than this times their distance
/// are taken to lie on different surfaces: 79 degrees, where Gordon's weights (Carr 1996,
/// section 3.3.2.1) also stop trusting a difference.
constexpr double MaximumSupportSlope = 5;

/// The rim of a hole in CT is rounded over about a voxel by the partial volume effect: what
/// FindHoles adds to a hole, mm.
constexpr double HoleRim = 2;

struct HoleFillResult
{
  std::vector<double> Fitted;    ///< the fit over Rectangle, NaN elsewhere
  std::vector<double> Deviation; ///< Fitted - Depth where the support or the defect has a depth
  MapMask Support;               ///< the pixels that carry the fit, before thinning
  /// Pixels of the defect, ascending, and the derivatives of the fit along x and y there.
  std::vector<std::size_t> Filled;
  std::vector<std::array<double, 2>> Gradients;
  std::array<int, 4> Rectangle{}; ///< first and last column, first and last row
  std::array<double, 3> Plane{};  ///< polynomial part c0 + c1 x + c2 y, map axes, mm
  double DefectArea = 0;          ///< mm^2, on the filled surface
  RadialBasisReport Fit;
  std::vector<std::string> Warnings; ///< sentences for the user
};

/// The Smoothing with which a fit to nodes of areaPerNode mm^2 each transmits half the amplitude of
/// waves of this length, mm, and less of shorter ones: the spline filter of ISO 16610-22 for a
/// surface. phi has the Fourier transform F / k^(Power + 2), its energy is C times that of
/// |s^|^2 k^(Power + 2) / F, so the transmission is 1 / (1 + Smoothing C areaPerNode k^(Power + 2) /
/// F). Throws std::invalid_argument for kernels without a power (Gaussian, multiquadric).
double GetCutoffSmoothing(RadialKernel kernel, double wavelength, double areaPerNode);

/// Nodes are the support thinned by ThinNodes; support is the painted pixels, or the valid ones
/// within SupportMargin of the defect, outside of the defect and not beyond a depth step
/// (RemoveBeyondSteps). Rectangle bounds defect and support, grown by OutputMargin, and ends at the
/// border of the map. The defect must not be empty. Progress runs from 0.1, so that the caller can
/// report finding the defect before. Throws std::invalid_argument,
/// std::length_error or std::runtime_error with a sentence that says what to change.
HoleFillResult FillHole(
  Execution& execution, const HoleFillInput& input, const HoleFillOptions& options);
}
#endif
