// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Another skull, laid onto the one that has a hole.
#ifndef lacunaSkullTemplate_h
#define lacunaSkullTemplate_h

#include "lacunaExecution.h"
#include "lacunaMatrix4.h"
#include "lacunaMirrorPlane.h"
#include "lacunaShapeField.h"
#include "lacunaSkullRays.h"
#include "lacunaSkullShape.h"
#include "lacunaVector.h"
#include "lacunaVoxelVolume.h"

#include <vector>

namespace lacuna
{
/// A skull as rays meet it. Coordinates are its own, mm.
class SkullShell
{
public:
  virtual ~SkullShell() = default;
  /// Along unit directions from a point: mm to the outer and the inner table, as TraceSkull finds them; NaN without
  /// bone. A shell without inner table has NaN for all of these.
  virtual RayRadii Trace(
    const Vec3& center, const std::vector<Vec3>& directions, Execution& execution) const = 0;
  /// A point within the skull.
  virtual Vec3 GetMiddle(Execution& execution) const = 0;
};

/// A volume in which only bone is at or above the level.
class VolumeShell : public SkullShell
{
public:
  /// Keeps the volume's pointer to the voxels. Throws std::invalid_argument for a level that is not finite, or fewer
  /// than two voxels along an axis.
  VolumeShell(const VoxelVolume& volume, double level);
  RayRadii Trace(
    const Vec3& center, const std::vector<Vec3>& directions, Execution& execution) const override;
  /// The mean of all voxels at or above the level. Throws std::invalid_argument when there is none.
  Vec3 GetMiddle(Execution& execution) const override;

private:
  VoxelVolume Volume;
  double Level;
};

/// How a template lies on a skull.
struct TemplateFit
{
  Matrix4 TemplateToSkull; ///< turns, shifts and scales alike along all axes; never mirrors
  double Scale = 1;        ///< mm of the skull for one of the template
  double RMS = 0;          ///< mm, of the distances of the outer tables; outliers do not count
  double Covered = 0;      ///< part of the sound bone for which the template has bone
};

/// Turn, shift and scale that bring the template's outer table closest to sound bone, along the rays of the skull. The
/// best of all turns comes first, then least squares. Tukey's biweight keeps out holes and steps of both. Throws
/// std::invalid_argument when the template has too little of a vault.
/// Beaton and Tukey, Technometrics 16, 1974.
TemplateFit FitTemplate(const SkullShell& shell, const SoundBone& bone, Execution& execution);

/// The template along the rays of the skull, mm of the skull. Throws as TraceSkull does.
SkullRays PlaceTemplate(
  const SkullShell& shell, const TemplateFit& fit, const SkullRays& skull, Execution& execution);

/// What rays show of another skull, as smooth functions of the direction: the outer table over the skull's own
/// ellipsoid, and the thickness over its mean, mm, for variations longer than some 15 mm. They are the same on both sides
/// of the plane, as means of both: what one side of a template has of its own tells nothing of another skull. Gaps are
/// bridged from around them. Empty where that is nothing, as of a sphere, or of a shell without inner table. Throws
/// std::invalid_argument as SkullEllipsoid does.
struct SkullExamples
{
  SkullExamples() = default; ///< none
  SkullExamples(const SkullRays& rays, const MirrorPlane& plane);
  ShapeExample Outer;
  ShapeExample Thickness;
};
}
#endif
