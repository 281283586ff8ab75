// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaIsoRayCaster.h"

#include "lacunaIsoField.h"
#include "lacunaMapCaster.h"

namespace lacuna
{
IsoRayCaster::IsoRayCaster(
  const VoxelVolume& volume, FieldInterpolation interpolation, SolidSide side, Execution& execution)
  : Volume(volume)
  , Side(side)
{
  CheckVolumeSize(volume.Size);
  this->WorldToIndex = volume.IndexToWorld.Inverse();
  this->Field = MakeIsoField(this->Volume, interpolation, side, execution);
}

IsoRayCaster::~IsoRayCaster() = default;

double IsoRayCaster::GetMinimum() const
{
  return this->Field->Minimum;
}

double IsoRayCaster::GetMaximum() const
{
  return this->Field->Maximum;
}

std::int64_t IsoRayCaster::GetNumberOfNonFiniteVoxels() const
{
  return this->Field->NumberOfNonFinite;
}

Vec3 IsoRayCaster::NormalOf(const Vec3& gradient, const Vec3& direction) const
{
  // A gradient is a covector: it goes back with the transposed matrix.
  const Matrix4& m = this->WorldToIndex;
  const Vec3& g = gradient;
  const Vec3 world{ m(0, 0) * g[0] + m(1, 0) * g[1] + m(2, 0) * g[2],
    m(0, 1) * g[0] + m(1, 1) * g[1] + m(2, 1) * g[2],
    m(0, 2) * g[0] + m(1, 2) * g[1] + m(2, 2) * g[2] };
  const double length = Norm(world);
  // On a plateau at the iso-value the surface has no direction: show it to the viewer.
  return length > 0 ? (-1 / length) * world : -1 * Normalized(direction);
}

bool IsoRayCaster::CastRay(
  const Vec3& origin, const Vec3& direction, double isoValue, RayHit& hit) const
{
  if (!(this->Field->Minimum <= this->Field->Maximum))
  {
    return false; // no voxel is finite
  }
  const Ray ray{ this->WorldToIndex.Point(origin), this->WorldToIndex.Vector(direction) };
  RayEntry entry;
  if (!this->Field->Follow(isoValue)->FindEntry(ray, RaySpan{}, entry))
  {
    return false;
  }
  hit = { entry.T, this->NormalOf(entry.Gradient, direction) };
  return true;
}

void IsoRayCaster::Cast(const ImagePlane& plane, double isoValue, const DepthPixels& pixels,
  const RayRequest& request, Execution& execution) const
{
  const auto& e = pixels.Extent;
  if (e[1] >= e[0] && e[3] >= e[2])
  {
    MapCaster(*this, plane, pixels, request).Cast(isoValue, execution);
  }
}

void IsoRayCaster::Cast(
  const ImagePlane& plane, double isoValue, const DepthPixels& pixels, Execution& execution) const
{
  this->Cast(plane, isoValue, pixels, RayRequest{}, execution);
}
}
