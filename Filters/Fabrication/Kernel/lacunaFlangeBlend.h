// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A smooth weight that is 1 around closed curves and fades to 0.
#ifndef lacunaFlangeBlend_h
#define lacunaFlangeBlend_h

#include "lacunaPlanarCurves.h"

#include <cstdint>
#include <vector>

namespace lacuna
{
class Execution;

/// Distances in the plane from the inside of closed curves, overlapping or not.
class LoopDistance
{
public:
  explicit LoopDistance(const std::vector<Loop>& loops);
  /// mm; 0 inside, limit when farther away.
  double Find(const Vec2& p, double limit) const;
  /// The same at the points x, x + step, ... of a row.
  void FindRow(
    const Vec2& first, double step, std::int64_t count, double limit, double* distances) const;

  /// Corners of the rectangle around all curves.
  const Vec2& GetLow() const { return this->Low; }
  const Vec2& GetHigh() const { return this->High; }

private:
  std::vector<Loop> Loops;
  CurveIndex Index;
  Vec2 Low{};
  Vec2 High{};
};

/// A C2 function of the plane between 0 and 1: exactly 1 within margin mm of the inside of curves,
/// exactly 0 from margin + width mm on. It is the set of the points within margin + width / 2,
/// convolved with a round kernel on a lattice; the values there are the control points of a bicubic
/// B-spline.
class FlangeBlend
{
public:
  /// margin >= 0, width > 0, mm. Throws std::runtime_error when the lattice would be too large.
  FlangeBlend(Execution& execution, const LoopDistance& curves, double margin, double width);

  struct Value
  {
    double Weight;
    Vec2 Gradient; ///< 1/mm
  };
  Value Evaluate(const Vec2& p) const;

private:
  void CoverCurves(const LoopDistance& curves, double middle, double width);
  // The set of the points within middle, with an edge that is one step of the lattice wide.
  std::vector<double> FindSet(
    Execution& execution, const LoopDistance& curves, double middle) const;
  void Smooth(Execution& execution, const std::vector<double>& set);

  PlanarGrid Lattice;
  std::vector<double> Coefficients;
};
}
#endif
