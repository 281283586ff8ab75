// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The ellipsoid that fits a dome best, as a first guess of the surface over a hole.
#ifndef lacunaEllipsoidTrend_h
#define lacunaEllipsoidTrend_h

#include "lacunaVector.h"

#include <array>
#include <vector>

namespace lacuna
{
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
}
#endif
