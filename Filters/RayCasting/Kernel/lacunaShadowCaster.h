// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Whether light reaches a point of a surface. Carr 1996, 3.3.
#ifndef lacunaShadowCaster_h
#define lacunaShadowCaster_h

#include "lacunaIsoField.h"
#include "lacunaIsoRayCaster.h"

#include <memory>
#include <vector>

namespace lacuna
{
/// What throws shadows: the solid that a depth map shows. See RayRequest for the cuts and caps.
struct ShadowCaster
{
  const IsoRayCaster* Caster = nullptr; ///< null: no shadows
  double IsoValue = 0;
  double Bias = 0; ///< mm: what is nearer to a point than this is the point's own surface
  const CutRegion* CutAway = nullptr; ///< what is in it throws no shadow; may be null
  bool CapCutAway = true;
  bool CapBoundary = false;
};

/// Follows the rays of light to points, one after the other; one object per thread. A ray runs from
/// its light by the rules of IsoRayCaster: if it starts in the solid (a lamp there, or where the
/// volume begins and is not capped) it leaves the solid first.
class ShadowProbe
{
public:
  /// shadows and what it points to must outlive this object.
  explicit ShadowProbe(const ShadowCaster& shadows);

  /// Whether the surface lies between a point and a light: towardsLight is unit, distance the light's
  /// in mm, infinite for parallel light.
  bool IsShadowed(const Vec3& point, const Vec3& towardsLight, double distance) const;

private:
  bool IsInSolid(const Ray& ray, double t) const;

  const ShadowCaster& Shadows;
  Matrix4 WorldToIndex;
  std::unique_ptr<RayFollower> Follower; ///< null: nothing throws shadows
};
}
#endif
