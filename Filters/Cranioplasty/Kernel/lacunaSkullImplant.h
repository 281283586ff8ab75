// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The missing part of a skull as a solid that fits into the hole.
#ifndef lacunaSkullImplant_h
#define lacunaSkullImplant_h

#include "lacunaBoneDistance.h"
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
  /// mm along the normal of the outer surface, 0.5..20; 0: that of bone, along rays.
  double Thickness = 0;
  double MinimumThickness = 0; ///< mm, 0..10: the inner surface is moved inwards where it is less
  /// The way in which it is put in; zero: that for which the walls have the most taper.
  Vec3 InsertionDirection{ 0, 0, 0 };
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
  double MinimumThickness = 0; ///< mm, least distance between the outer points and the inner face
  Vec3 ThinnestPoint{ 0, 0, 0 };
  Vec3 InsertionDirection{ 0, 0, 0 }; ///< unit, the way in which it is put in
  double LeastTaper = 0; ///< degrees, least angle between it and the walls of the implant
  double InsertionClearance =
    0; ///< mm, least distance of points from bone on the way in, at most 3
  /// Free space beside the edge that cannot be filled when it is put in so: mm^3, its width in mm, and where.
  double UndercutVolume = 0;
  double UndercutWidth = 0;
  Vec3 UndercutPoint{ 0, 0, 0 };
  std::vector<std::string> Warnings;
};

/// The outer and inner surface are those of the shape. Between them the edge keeps the clearance from bone at each
/// depth, also on the way in: it follows the wall where that opens outwards, and goes along the direction where
/// bone is above free space. Parts into which no ball of 2 mm fits then are left out, and so is all
/// but the largest of several free spaces.
/// defect: rays, as of FindDefects. Throws std::invalid_argument when an option is out of range or the defect is
/// empty, and std::runtime_error when no free space is left.
SkullImplant MakeSkullImplant(const VoxelVolume& volume, const SkullRays& rays,
  const std::vector<int>& defect, const SkullShape& shape, const BoneDistance& bone,
  const SkullImplantOptions& options, Execution& execution);
}
#endif
