// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaShadowCaster.h"

#include "lacunaRay.h"

#include <algorithm>

namespace lacuna
{
ShadowProbe::ShadowProbe(const ShadowCaster& shadows)
  : Shadows(shadows)
{
  const IsoRayCaster* caster = shadows.Caster;
  if (caster && caster->GetMinimum() <= caster->GetMaximum()) // else no voxel is finite
  {
    this->WorldToIndex = caster->GetVolume().IndexToWorld.Inverse();
    this->Follower = caster->GetField().Follow(shadows.IsoValue);
  }
}

bool ShadowProbe::IsInSolid(const Ray& ray, double t) const
{
  return this->Follower->Value(ray.A + t * ray.B) >= 0;
}

bool ShadowProbe::IsShadowed(const Vec3& point, const Vec3& towardsLight, double distance) const
{
  if (!this->Follower)
  {
    return false;
  }
  // t counts mm from the point on, along the light: the light is at -distance
  const Vec3 direction = -1 * towardsLight;
  const Ray ray{ this->WorldToIndex.Point(point), this->WorldToIndex.Vector(direction) };
  RaySpan whole;
  if (!ClipToVolume(ray, this->Shadows.Caster->GetVolume().Size, whole))
  {
    return false;
  }
  const bool entersVolume = whole.First > -distance;
  RaySpan part{ std::max(whole.First, -distance), std::min(whole.Last, -this->Shadows.Bias) };
  if (!(part.First < part.Last))
  {
    return false;
  }
  RayEntry entry;
  bool isCapped = entersVolume && this->Shadows.CapBoundary;
  const auto isBlocked = [&](const RaySpan& span)
  {
    return (isCapped && this->IsInSolid(ray, span.First)) ||
      this->Follower->FindEntry(ray, span, entry);
  };
  if (this->Shadows.CutAway)
  {
    for (const RaySpan& cut : this->Shadows.CutAway->Find(point, direction, part))
    {
      if (cut.First > part.First && isBlocked({ part.First, cut.First }))
      {
        return true;
      }
      part.First = cut.Last;
      isCapped = this->Shadows.CapCutAway;
    }
  }
  return part.First < part.Last && isBlocked(part);
}
}
