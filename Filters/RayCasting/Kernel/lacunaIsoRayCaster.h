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

#include "lacunaCutRegion.h"
#include "lacunaExecution.h"
#include "lacunaImagePlane.h"
#include "lacunaSolidSide.h"
#include "lacunaVoxelVolume.h"

#include <array>
#include <cstdint>
#include <memory>

namespace lacuna
{
class IsoField;

/// The plane perpendicular to view.Direction through view.PlaneOrigin, else through view.FocalPoint,
/// else through the corner of the data (within the convex hull of points) nearest the eye; when the
/// eye is among or close to the data, halfway to their end. The line from the eye along
/// view.Direction meets its middle. angle: which the rows span, degrees. view.PixelSpacing 0: from
/// the angle and the number of rows; both 0: finestSpacing. view.Size 0: as many rows as the angle
/// takes, and as many columns as rows. Given both the spacing and the number of rows, the angle
/// follows from them. Throws std::invalid_argument for what cannot be seen.
ImagePlane MakePerspectivePlane(const std::vector<Vec3>& points, double finestSpacing,
  const ViewSettings& view, const Vec3& eye, double angle);

/// The angle that the rows of a plane span at the eye, degrees.
double ViewAngleOf(const ImagePlane& plane, const Vec3& eye);

enum class FieldInterpolation
{
  BSpline,              ///< cubic, the voxels are the control points: smooths
  InterpolatingBSpline, ///< cubic, goes through the voxels
  Trilinear
};
inline constexpr std::array<const char*, 3> FieldInterpolationNames{ "BSpline",
  "InterpolatingBSpline", "Trilinear" };

enum class SurfaceNormal
{
  Analytic, ///< of the field
  GreyLevel ///< differences of voxels, interpolated trilinearly (Carr 1996, eq. 3.5)
};
inline constexpr std::array<const char*, 2> SurfaceNormalNames{ "Analytic", "GreyLevel" };

struct RayHit
{
  double Distance; ///< along the unit ray, mm
  Vec3 Normal;     ///< unit, world, out of the solid and so towards the viewer
};

/// What the rays of a map are asked besides where they first hit.
struct RayRequest
{
  /// Rays start here and go through the pixels; null: a parallel projection. Depths count from the
  /// pixels, those of surfaces between the eye and the image plane are negative.
  const Vec3* Eye = nullptr;
  /// Of the pixels of the extent: rays are followed from 1e-6 voxel behind these depths only, as if
  /// nothing were known of what lies before; not at all where NaN. Null: from the start.
  const double* StartDepth = nullptr;
  /// Not seen, nor what of the solid is in it; may be null. Must outlive the call.
  const CutRegion* CutAway = nullptr;
  bool CapCutAway = true;   ///< a ray that leaves CutAway into the solid hits there
  bool CapBoundary = false; ///< so does one that enters the volume in the solid
  SurfaceNormal Normals = SurfaceNormal::Analytic;
  /// For the pixels of the extent: mm from the hit to where the ray leaves the solid; NaN without a
  /// hit and where the volume ends before. Where the solid is cut away it ends. May be null.
  double* Thickness = nullptr;
};

/// Rules. The surface is where a ray passes from outside into the solid. A ray that is inside the
/// solid where it enters the volume has not met its surface there: it goes on until it has left the
/// solid and enters it again (unless capped, see RayRequest). The field ends at the centres of the
/// outermost voxels; control points beyond them are extrapolated linearly. Voxels that are not
/// finite count as empty: they take the value of the emptiest voxel (the least one when the solid
/// is above the iso-value).
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

  /// For rays that follow rules of their own.
  const VoxelVolume& GetVolume() const { return this->Volume; }
  const IsoField& GetField() const { return *this->Field; }

  /// The first hit of the straight line origin + distance * direction (unit), wherever it is on the
  /// line: distances before the origin are negative. False when there is none.
  bool CastRay(const Vec3& origin, const Vec3& direction, double isoValue, RayHit& hit) const;

  /// Casts the rays of pixels.Extent. A pixel's result does not depend on the extent. Throws
  /// std::invalid_argument when the eye is not before the plane.
  void Cast(const ImagePlane& plane, double isoValue, const DepthPixels& pixels,
    const RayRequest& request, Execution& execution) const;
  void Cast(const ImagePlane& plane, double isoValue, const DepthPixels& pixels,
    Execution& execution) const;

private:
  /// The normal of a surface with this index gradient towards the solid at a point of a ray.
  Vec3 NormalOf(const Vec3& gradient, const Vec3& direction) const;

  friend class MapCaster;

  VoxelVolume Volume;
  Matrix4 WorldToIndex;
  SolidSide Side;
  std::unique_ptr<const IsoField> Field;
};
}
#endif
