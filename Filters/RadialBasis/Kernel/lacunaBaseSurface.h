// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The surface to which a hole is filled by a difference: a prior, a trend, or none.
#ifndef lacunaBaseSurface_h
#define lacunaBaseSurface_h

#include "lacunaHoleFillOptions.h"
#include "lacunaMapResampling.h"
#include "lacunaRadialBasis.h"
#include "lacunaSupportSelection.h"
#include "lacunaVector.h"

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace lacuna
{
class Execution;

/// x^2 + y^2 + z^2 + a (x^2 - y^2) + b x y + linear terms = 0, fitted to points by least squares of
/// this sum: an ellipsoid with one axis along z, whose length is tied to the others (a sphere when
/// a = b = 0). z is a depth, positive away from the viewer; the sheet towards the viewer, or away
/// from him, is taken on whose side the points lie.
class EllipsoidTrend
{
public:
  /// Throws std::invalid_argument when the points do not determine an ellipsoid: fewer than 6, in a
  /// plane, or curved like a saddle.
  explicit EllipsoidTrend(const std::vector<Vec3>& points);

  /// z at (x, y). Near its outline and beside the ellipsoid, where it would be steeper than about
  /// 65 degrees, it goes on without a kink.
  double GetDepth(double x, double y) const;
  /// Whether (x, y) lies within the ellipsoid's outline.
  bool Covers(double x, double y) const { return this->GetRoot(x, y) >= 0; }

private:
  /// The square of half the chord along z, scaled; negative beside the ellipsoid.
  double GetRoot(double x, double y) const;

  Vec3 Center{}; // of the points, and their extent: where the coordinates are about 1
  double Scale = 1;
  std::array<double, 6> Terms{}; // of x^2 - y^2, x y, x, y, z, 1
  double Side = 1;
  double LeastRoot = 0; ///< below it the depth goes on
};

class BaseSurface
{
public:
  /// The prior, seen on the map's grid; no points: none. Both must outlive this. Of the prior only
  /// that counts which goes on without a step (65 degrees) from where it lies along the surface within
  /// margins.Defect of the defect, and not within margins.Step of its steps and holes.
  BaseSurface(Execution& execution, const SurfaceSheet& prior, const MarkedMap& map,
    const SupportMargins& margins);
  /// Makes it the trend of a surface: of the pixels of support. Throws std::invalid_argument when it
  /// ends in the defect.
  void SetTrend(const MapMask& support);
  /// Completes the prior in the rectangle (columns, rows of the map): by a thin plate through what is
  /// sound of it and, where it is not, through the bone of carried. With smoothing the prior is
  /// replaced by a fit like the surface's, of half its cut-off wavelength. Warns of what is missing in the defect.
  void Complete(Execution& execution, const MapMask& carried, const std::array<int, 4>& rectangle,
    const HoleFillOptions& options, std::vector<std::string>& warnings);

  bool Exists() const { return this->Trend || !this->OnMap.empty(); }
  /// Depths at the pixels of the map, NaN where there is none; empty when it does not exist.
  const std::vector<double>& GetOnMap() const { return this->OnMap; }
  /// Depths at the pixels of grid that lie in rectangle; NaN elsewhere, empty when it does not exist.
  /// nearest: the pixel of the map, -1 beside it.
  std::vector<double> Evaluate(Execution& execution, const MapGrid& grid,
    const std::vector<std::int64_t>& nearest, const std::array<int, 4>& rectangle) const;
  /// Depth at (x, y) between the pixels of the map; 0 when it does not exist.
  double Evaluate(double x, double y) const;
  /// c0 + c1 x + c2 y that fits it best at the pixels of mask; 0 when it does not exist.
  std::array<double, 3> FitPlane(const MapMask& mask) const;

private:
  void WarnOfGaps(std::vector<std::string>& warnings) const;
  // Whether the prior's depth at p is that of the surface which the map's nearest pixel shows.
  bool IsSoundAt(const Vec2& p, double depth, std::int64_t nearest) const;
  // Depths of the prior, and of the bone where it goes on for it: by their distance and angle elsewhere.
  std::vector<double> CarryOn(const MapMask& carried) const;
  // area: of all pixels that nodes stand for, mm^2
  void MakeFit(Execution& execution, const MapMask& nodes, const std::vector<double>& depth,
    double area, const HoleFillOptions& options);
  void TakeFit(Execution& execution, const std::array<int, 4>& rectangle);
  void EvaluateFit(Execution& execution, const std::vector<std::array<double, 2>>& points,
    std::vector<double>& values) const;

  const SurfaceSheet& Prior;
  const MarkedMap& Map;
  const MapGrid& Grid;
  std::vector<double> OnMap;
  MapMask Sound;       ///< where the prior is as it was given
  double Distance = 0; ///< mm, of prior and surface around the defect where they are nearest
  std::unique_ptr<EllipsoidTrend> Trend;
  std::unique_ptr<RadialBasis<2>> Fit; ///< of the prior; none: it is complete
  double Accuracy = 0;                 ///< of Fit, of its range
  bool IsSmooth = false;               ///< Fit replaces the prior everywhere
};
}
#endif
