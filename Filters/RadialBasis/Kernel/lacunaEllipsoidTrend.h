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

  /// z at (x, y); NaN beside the ellipsoid.
  double GetDepth(double x, double y) const;

private:
  Vec3 Center{}; // of the points, and their extent: where the coordinates are about 1
  double Scale = 1;
  std::array<double, 6> Terms{}; // of x^2 - y^2, x y, x, y, z, 1
  double Side = 1;
};
}
#endif
