// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The skull phantom: Hounsfield units in closed form.
#ifndef lacunaSkull_h
#define lacunaSkull_h

#include "lacunaExecution.h"
#include "lacunaPhantomSweep.h"
#include "lacunaVector.h"

#include <array>
#include <cstdint>

namespace lacuna
{
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
    Vec3 Center = { 0, 0, 0 };    ///< mm, LPS
    Vec3 Spacing = { 1, 1, 2.3 }; ///< voxel edges, mm
    double DefectRadius = 30;     ///< mm, 0 = intact
    Vec3 DefectDirection = { 0.4, -0.2, 0.9 };
    double NoiseLevel = 0; ///< HU, standard deviation
    std::uint64_t Seed = 0;
    bool Sutures = false;
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
