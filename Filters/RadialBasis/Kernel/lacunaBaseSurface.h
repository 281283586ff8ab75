// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The surface to which a hole is filled by a difference: a prior, a trend, or none.
#ifndef lacunaBaseSurface_h
#define lacunaBaseSurface_h

#include "lacunaEllipsoidTrend.h"
#include "lacunaMapResampling.h"

#include <array>
#include <memory>
#include <vector>

namespace lacuna
{
class Execution;

class BaseSurface
{
public:
  /// The prior, seen on grid; no points: none. prior must outlive this.
  BaseSurface(Execution& execution, const SurfaceSheet& prior, const MapGrid& grid);
  /// Makes it the trend of a surface: of the pixels of support.
  void SetTrend(const std::vector<double>& depth, const MapMask& support);

  bool Exists() const { return this->Trend || !this->OnMap.empty(); }
  /// Depths at the pixels of grid, NaN where there is none; empty when it does not exist.
  const std::vector<double>& GetOnMap() const { return this->OnMap; }
  std::vector<double> Evaluate(Execution& execution, const MapGrid& grid) const;
  /// Depth at (x, y) between the pixels of the map; 0 when it does not exist.
  double Evaluate(double x, double y) const;
  /// c0 + c1 x + c2 y that fits it best at the pixels of mask; 0 when it does not exist.
  std::array<double, 3> FitPlane(const MapMask& mask) const;

private:
  const SurfaceSheet& Prior;
  MapGrid Grid;
  std::vector<double> OnMap;
  std::unique_ptr<EllipsoidTrend> Trend;
};
}
#endif
