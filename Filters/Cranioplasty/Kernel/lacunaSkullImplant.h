// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The missing part of a skull as a solid that fits into the hole.
#ifndef lacunaSkullImplant_h
#define lacunaSkullImplant_h

#include "lacunaExecution.h"
#include "lacunaPlanarTriangulation.h"
#include "lacunaSkullRays.h"
#include "lacunaSkullShape.h"
#include "lacunaVector.h"
#include "lacunaVoxelVolume.h"

#include <cstddef>
#include <string>
#include <vector>

namespace lacuna
{
struct SkullImplantOptions
{
  double Level = 300;         ///< grey level of bone
  double EdgeClearance = 0.5; ///< mm between the wall of the implant and bone, 0..5
  double TriangleSize = 1;    ///< mm, 0.2..5; half of it along the edge
};

/// What a triangle of the implant belongs to.
enum class SkullImplantFace : unsigned char
{
  Outer, ///< towards the scalp
  Inner, ///< towards the brain
  Edge
};

/// Standard error, mm, above which 95 % of errors are not within 1 mm.
constexpr double TrustedError = 1 / 1.959963984540054;

/// A closed, oriented triangle mesh and what was measured on it.
struct SkullImplant
{
  std::vector<Vec3> Points;            ///< world mm
  std::vector<Triangle> Triangles;     ///< counterclockwise from outside
  std::vector<SkullImplantFace> Faces; ///< one per triangle
  /// One per point: standard error of the outer surface, thickness, standard error of the thickness; mm along
  /// the ray from the centre.
  std::vector<double> Errors;
  std::vector<double> Thickness;
  std::vector<double> ThicknessErrors;
  double Volume = 0;    ///< mm^3
  double OuterArea = 0; ///< mm^2
  double HoleArea = 0;  ///< mm^2, of the outer surface without clearance
  /// Root of the mean squared standard error, the largest one, and where (on the outer surface).
  double ErrorRMS = 0;
  double LargestError = 0;
  Vec3 LargestErrorPoint{ 0, 0, 0 };
  double DoubtfulArea = 0; ///< mm^2 of the outer surface that are expected to be more than 1 mm off
  /// Unit, the way in which it is put in, and the least angle between it and the walls, degrees: where it is
  /// negative bone stands in the way.
  Vec3 InsertionDirection{ 0, 0, 0 };
  double LeastTaper = 0;
  std::vector<std::string> Warnings;
};

/// The outer and inner surface are those of the shape. The edge runs along rays from the centre, so that the
/// implant grows wider outwards. Its outline is the one of the free space: no bone is met between the
/// surfaces, nor within the clearance of them, in the volume (trilinear). It is moved inwards by the
/// clearance, measured on the inner surface. Parts into which no ball of 2 mm fits then are left out, and so is all
/// but the largest of several free spaces.
/// defect: rays, as of FindDefects. Throws std::invalid_argument when an option is out of range or the defect is
/// empty, and std::runtime_error when no free space is left.
SkullImplant MakeSkullImplant(const VoxelVolume& volume, const SkullRays& rays,
  const std::vector<int>& defect, const SkullShape& shape, const SkullImplantOptions& options,
  Execution& execution);
}
#endif
