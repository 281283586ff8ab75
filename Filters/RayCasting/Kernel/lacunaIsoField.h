// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What of an iso ray caster depends on the type of voxels and on the interpolation.
#ifndef lacunaIsoField_h
#define lacunaIsoField_h

#include "lacunaBlockProjection.h"
#include "lacunaIsoRayCaster.h"
#include "lacunaRay.h"
#include "lacunaTileCaster.h"

#include <array>
#include <functional>
#include <memory>

namespace lacuna
{
/// Follows single rays at one iso-value; one per thread.
class RayFollower
{
public:
  virtual ~RayFollower() = default;

  /// The first entry of the ray into the solid within span. What lies before is not known: a ray
  /// that starts in the solid leaves it first.
  virtual bool FindEntry(const Ray& ray, const RaySpan& span, RayEntry& entry) = 0;

  /// Where the ray, in the solid behind t0, leaves it; false when the volume or span ends before.
  virtual bool FindExit(const Ray& ray, double t0, const RaySpan& span, double& t) = 0;

  /// The field less the iso-value at an index point in the volume, not negative in the solid.
  virtual double Value(const Vec3& index) = 0;
};

class IsoField
{
public:
  virtual ~IsoField() = default;

  virtual std::unique_ptr<RayFollower> Follow(double isoValue) const = 0;

  /// What is done with the tiles of a map, from any thread.
  struct TileWork
  {
    /// Sets the spans of the tile's rays, see TileCaster. Empty: whole lines.
    std::function<void(const std::array<int, 4>& tile, RayFollower& follower, RaySpan* spans)>
      Prepare;
    std::function<void(const std::array<int, 4>& tile, RayFollower& follower, const TileEntries&)>
      Take;
  };
  virtual void CastTiles(const RayGrid& rays, const BlockProjection& projection,
    const std::array<int, 4>& extent, double isoValue, const TileWork& work,
    Execution& execution) const = 0;

  double Minimum = 0;
  double Maximum = 0;
  std::int64_t NumberOfNonFinite = 0;
};

/// volume: must outlive the result.
std::unique_ptr<const IsoField> MakeIsoField(const VoxelVolume& volume,
  FieldInterpolation interpolation, SolidSide side, Execution& execution);
}
#endif
