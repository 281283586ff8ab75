// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Closed cubic B-spline curves.
#ifndef lacunaBSplineCurve_h
#define lacunaBSplineCurve_h

#include "lacunaVector.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace lacuna
{
/// A polynomial cubic curve over [Knots.front(), Knots.back()].
struct BSplineCurve
{
  std::vector<double> Knots; ///< ControlPoints.size() + 4, clamped
  std::vector<Vec3> ControlPoints;

  double GetLast() const { return this->Knots.back(); }
  /// The point at t, which is clamped to the interval.
  Vec3 Evaluate(double t) const;
  /// Whether the first and the last point are the same.
  bool IsClosed() const;
  /// Rounds the control points to so many digits after the point.
  void Round(int decimals);
};

/// The closed C2 cubic through at least three points, at t = 0, step, 2 step, ...; C2 also where it
/// ends.
BSplineCurve InterpolateClosed(const std::vector<Vec3>& points, double step);

/// The closed C2 cubic through count points at equal steps of a closed curve over [0, length].
/// count is the first of first, grow(first), ... with which no point of it, as seen at eight places
/// between neighbours, lies farther than tolerance from the point of the curve at the same t, scaled
/// to [0, length of the result]. With unitSteps the result's t goes from 0 to count, otherwise to
/// length. Throws std::runtime_error when a hundred thousand points do not do.
BSplineCurve FitClosedCurve(const std::function<Vec3(double)>& curve, double length,
  double tolerance, std::int64_t first, const std::function<std::int64_t(std::int64_t)>& grow,
  bool unitSteps);
}
#endif
