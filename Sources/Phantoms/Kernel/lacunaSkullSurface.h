// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The outer surface of the skull phantom in closed form.
#ifndef lacunaSkullSurface_h
#define lacunaSkullSurface_h

#include "lacunaVector.h"

namespace lacuna
{
/// A closed calvarium-like surface r = R(n) around the origin, n the unit direction; axes as in LPS
/// (x = left, y = posterior, z = superior), mm.
///
/// R(n) = E(n) m(n) + b(n): an ellipsoid E with half axes 71.5, 90 and 66; a polynomial m that
/// makes it wider behind, steepens the forehead, lowers the occiput and flattens the base, and
/// whose odd terms in x make the left side slightly larger; and a bony bump b of 2.5 mm on the left
/// forehead, so that a mirrored skull is seen at once. R is infinitely differentiable.
class SkullSurface
{
public:
  static constexpr double MinimumRadius = 60; ///< mm; R is larger everywhere
  static constexpr double MaximumRadius = 93; ///< mm; R is smaller everywhere
  /// The gradient of r - R(n) is at most this on and outside of the surface.
  static constexpr double MaximumSlope = 1.25;

  /// R at a unit direction.
  static double Radius(const Vec3& direction);
  /// r - R(n) at a point: negative inside, 0 on the surface; its gradient where not null.
  static double Implicit(const Vec3& point, Vec3* gradient = nullptr);

  /// The nearest surface point by iterated projection (to 1e-7 mm along the surface, hence the
  /// distance to about 1e-13 mm), for points from 15 mm inside to 12 mm outside of the surface.
  /// normal: outward unit normal there. Returns the signed distance, negative inside.
  static double SignedDistance(const Vec3& point, Vec3& foot, Vec3& normal);

  /// Distance from origin along the unit vector of direction to the first point of the surface,
  /// within 1e-9 mm; NaN when the ray misses or direction is zero or not finite. Steps are bounded
  /// by the distance to the surface, so that no crossing is skipped (but for a ray that dips less
  /// than 1e-9 mm into the bone).
  static double Intersect(const Vec3& origin, const Vec3& direction);
};
}
#endif
