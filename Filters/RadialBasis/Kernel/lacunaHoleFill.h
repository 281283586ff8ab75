// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Fills a hole in a depth map with a radial basis function fitted to the surface around it (Carr
/// 1996, section 6.4).
#ifndef lacunaHoleFill_h
#define lacunaHoleFill_h

#include "lacunaHoleFillOptions.h"
#include "lacunaMapResampling.h"
#include "lacunaRadialBasis.h"
#include "lacunaSupportSelection.h"

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace lacuna
{
class BaseSurface;
class Execution;

/// The map and what else shapes the surface that fills its hole.
struct HoleFillInput : MarkedMap
{
  SurfaceSheet Prior; ///< the fit is of the difference to it (BaseSurface); no points: none
  /// x, y, depth in the map's axes, mm: the surface passes through them.
  std::vector<Vec3> ControlPoints;
};

/// The rim of a hole in CT is rounded over about a voxel by the partial volume effect: what
/// FindHoles adds to a hole, mm.
constexpr double HoleRim = 2;

/// Arrays are on Grid, which GetOutputGrid gives.
struct HoleFillResult
{
  MapGrid Grid;
  std::vector<std::int64_t> Nearest; ///< the pixel of the input, -1 beside it
  /// Measured outside of the defect, fitted inside; on another lattice than the map's interpolated
  /// in the filled map.
  std::vector<double> Depth;
  std::vector<double> Fitted; ///< the fit over Rectangle, NaN elsewhere
  /// Fitted - measured where support or defect has a depth; NaN beside the defect on another
  /// lattice, where interpolation needs a pixel of the defect.
  std::vector<double> Deviation;
  std::vector<SupportUse> Use;
  /// Pixels of the defect, ascending, and the derivatives of the fit along x and y there.
  std::vector<std::size_t> Filled;
  std::vector<std::array<double, 2>> Gradients;
  std::array<int, 4> Rectangle{}; ///< first and last column, first and last row
  /// c0 + c1 x + c2 y, map axes, mm: the polynomial part, with the plane that fits prior or trend
  /// best over defect and support.
  std::array<double, 3> Plane{};
  double DefectArea = 0; ///< mm^2, on the filled surface
  RadialBasisReport Fit;
  double FitSeconds = 0;             ///< for the equations, less what was known from the last fill
  bool Reused = false;               ///< only the control points were new
  std::vector<std::string> Warnings; ///< sentences for the user
};

/// Nodes are the support thinned by ThinNodes (see SelectSupport). Rectangle bounds defect, support
/// and control points, grown by OutputMargin. Control points are met exactly; nodes within
/// NodeSpacing of one are left out.
class HoleFiller
{
public:
  /// Of an empty defect the result is the map. What was solved for the last fill is kept while it
  /// has control points, so that moving one is quick; the result does not depend on it. Progress
  /// runs from 0.1, so that the caller can report finding the defect before. Throws
  /// std::invalid_argument, std::length_error or std::runtime_error with a sentence that says what
  /// to change.
  HoleFillResult Fill(
    Execution& execution, const HoleFillInput& input, const HoleFillOptions& options);

private:
  struct Problem
  {
    std::vector<std::array<double, 2>> Nodes;
    std::vector<double> Values;
    RadialBasisOptions Options;

    bool operator==(const Problem& other) const;
  };

  static Problem MakeProblem(const HoleFillInput& input, const BaseSurface& base,
    const MapMask& support, const HoleFillOptions& options);
  void Fit(Execution& execution, Problem problem, HoleFillResult& result);

  Problem Last;
  std::unique_ptr<RadialBasis<2>> Function; // of Last
};
}
#endif
