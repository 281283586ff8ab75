// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Casts rays on an iso-surface of a volume; the first hit is certified.
///
/// Between the voxels' centres the field is a tensor product of uniform cubic B-splines, or
/// trilinear. Along a ray and inside one cell it is then a polynomial of degree 9 (trilinear: 3),
/// whose Bernstein coefficients exclude or isolate its crossings with certainty; blocks whose
/// control points all lie on one side are skipped. There is no step size. Carr 1996, 3.2 and 3.3.3.
#ifndef lacunaIsoRayCaster_h
#define lacunaIsoRayCaster_h

#include "lacunaExecution.h"
#include "lacunaImagePlane.h"
#include "lacunaSolidSide.h"
#include "lacunaVoxelVolume.h"

#include <cstdint>
#include <memory>

namespace lacuna
{
enum class FieldInterpolation
{
  BSpline,              ///< cubic, the voxels are the control points: smooths
  InterpolatingBSpline, ///< cubic, goes through the voxels
  Trilinear
};

struct RayHit
{
  double Distance; ///< along the unit ray, mm
  Vec3 Normal;     ///< unit, world, out of the solid and so towards the viewer
};

/// Rules. The surface is where a ray passes from outside into the solid. A ray that is inside the
/// solid where it enters the volume has not met its surface there: it goes on until it has left the
/// solid and enters it again. The field ends at the centres of the outermost voxels; control points
/// beyond them are extrapolated linearly. Voxels that are not finite count as empty: they take the
/// value of the emptiest voxel (the least one when the solid is above the iso-value).
class IsoRayCaster
{
public:
  /// Prepares the bounds of blocks (and the coefficients of an interpolating spline, one float per
  /// voxel). Keeps a reference to the voxels. Throws std::invalid_argument when a side of the
  /// volume has fewer than two voxels or IndexToWorld is singular.
  IsoRayCaster(const VoxelVolume& volume, FieldInterpolation interpolation, SolidSide side,
    Execution& execution);
  ~IsoRayCaster();

  /// Least and greatest finite voxel; Minimum > Maximum when there is none.
  double GetMinimum() const;
  double GetMaximum() const;
  std::int64_t GetNumberOfNonFiniteVoxels() const;

  /// The first hit of the straight line origin + distance * direction (unit), wherever it is on the
  /// line: distances before the origin are negative. False when there is none.
  bool CastRay(const Vec3& origin, const Vec3& direction, double isoValue, RayHit& hit) const;

  /// Casts the rays of pixels.Extent. A pixel's result does not depend on the extent.
  void Cast(const ImagePlane& plane, double isoValue, const DepthPixels& pixels,
    Execution& execution) const;

  class Field;

private:
  std::unique_ptr<const Field> Implementation;
};
}
#endif
