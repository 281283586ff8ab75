// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The ellipsoid that fits a skull best: the base over which its shape varies little.
#ifndef lacunaSkullEllipsoid_h
#define lacunaSkullEllipsoid_h

#include "lacunaVector.h"

#include <array>
#include <vector>

namespace lacuna
{
/// x^T A x + b^T x = 1 about a centre within it, fitted to points by least squares of this equation.
class SkullEllipsoid
{
public:
  /// Points: world mm. Throws std::invalid_argument when they do not determine an ellipsoid around
  /// the centre.
  SkullEllipsoid(const Vec3& center, const std::vector<Vec3>& points);

  /// Distance from the centre to the ellipsoid along a unit direction, mm; NaN where the fitted
  /// surface is open.
  double GetRadius(const Vec3& direction) const;

private:
  double Scale = 1; ///< 1 / mean distance of the points
  std::array<double, 9> Terms{};
};
}
#endif
