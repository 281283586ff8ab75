// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The skull phantom: Hounsfield units in closed form.
#ifndef lacunaSkull_h
#define lacunaSkull_h

#include "lacunaExecution.h"
#include "lacunaPhantomSweep.h"
#include "lacunaProperties.h"
#include "lacunaVector.h"

#include <array>
#include <cstdint>

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

/// Layers along the outward normal at the nearest point of SkullSurface (signed distance d, mm):
/// air -1000 HU beyond the scalp (d > 6), scalp 0, outer table 1000 (0 > d > -2), diploe 520 to 680
/// (2.7 to 4.1 mm thick), inner table 1000 (1.5 mm), brain 35.
///
/// Partial-volume blur: each boundary is a SmoothStep of d, so wide that the blur has the variance
/// of the average over the voxel's box along the normal n: width^2 / 28 = sum (n_i s_i)^2 / 12.
/// For voxels of 1 x 1 x 2.3 mm it is 1.5 to 3.5 mm wide. A step of d is not shifted by curvature,
/// and the outer table is wider than half the blur: 500 HU lie exactly on the outer surface as long
/// as no spacing exceeds 2.6 mm; at 3, 4 and 5 mm they sink in by up to 0.003, 0.07 and 0.24 mm.
/// (The average over the box itself would move them by less than 0.015 mm at 1 x 1 x 2.3 mm.)
///
/// Defect: within a cylinder around DefectDirection through the centre, bone is replaced by soft
/// tissue of 0 HU through its full thickness. The outline is irregular, of mean DefectRadius R:
/// r(psi) = R (1 + 0.12 cos(2 psi + 0.5) + 0.08 cos(3 psi - 1.1) + 0.04 cos(5 psi + 2)).
///
/// Sutures (off by default): the coronal, the sagittal and the lambdoid one are jagged lines, 1.4 mm
/// wide, in which 90 % of the bone's outer part, down to the inner table, is soft tissue. There the
/// surface of 500 HU sinks in; elsewhere it stays where it is.
class Skull
{
public:
  struct Parameters
  {
    Vec3 Center = { 0, 0, 0 };                 ///< mm, LPS
    Vec3 Spacing = { 1, 1, 2.3 };              ///< voxel edges, mm
    double DefectRadius = 30;                  ///< mm, 0 = intact
    Vec3 DefectDirection = { 0.4, -0.2, 0.9 }; ///< not zero
    double NoiseLevel = 0;                     ///< HU, standard deviation
    std::uint64_t Seed = 0;
    bool Sutures = false;

    void Describe(Properties& properties) const; ///< with the ranges
  };
  static constexpr double MaximumDefectRadius = 40;

  /// Throws std::invalid_argument that names the parameter and says what would be right.
  explicit Skull(const Parameters& parameters);

  /// Position of voxel (0, 0, 0) and number of voxels; the head with 3 mm of air around it.
  Vec3 GetOrigin() const;
  std::array<int, 3> GetDimensions() const;

  /// HU at a point, blurred, without noise: of the skull as it was before the defect.
  double IntactValue(const Vec3& point) const;
  /// HU at a point, blurred, without noise: with the defect.
  double Value(const Vec3& point) const;
  /// True within the cylinder of the defect, at any depth on the side of DefectDirection.
  bool IsInDefect(const Vec3& point) const;
  /// SkullSurface::Intersect in patient coordinates.
  double IntersectOuterSurface(const Vec3& origin, const Vec3& direction) const;

  /// Voxels of an extent of the grid, rounded once; x fastest. A voxel depends neither on the
  /// extent nor on the threads.
  void Sample(Execution& execution, const Extent& extent, short* voxels) const;

private:
  /// Shares of the layers at a point.
  struct Layers;
  Layers Resolve(const Vec3& point) const;
  double WithSutures(const Layers& layers) const;
  double BlurWidth(const Vec3& normal) const;
  /// Distance inside of the defect's outline (first order) and its outward normal.
  double DefectDepth(const Vec3& point, Vec3& normal) const;

  Parameters P;
  Vec3 Axis;
  Vec3 Side1;
  Vec3 Side2;
};
}
#endif
