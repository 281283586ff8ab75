// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The missing part of a skull as a solid that fits into the hole.
#ifndef lacunaSkullImplant_h
#define lacunaSkullImplant_h

#include "lacunaBoneDistance.h"
#include "lacunaExecution.h"
#include "lacunaPlanarTriangulation.h"
#include "lacunaProperties.h"
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
  double EdgeClearance = 0.5; ///< mm between the wall of the implant and bone
  double TriangleSize = 1;    ///< mm; half of it along the edge; 0: 1 mm
  /// mm along the normal of the outer surface; 0: that of bone, along rays.
  double Thickness = 0;
  double MinimumThickness = 0; ///< mm: the inner surface is moved inwards where it is less
  /// The way in which it is put in; zero: that for which the walls have the most taper.
  Vec3 InsertionDirection{ 0, 0, 0 };
  /// mm along the normal of the outer surface, positive outwards; each fades to 0 at the rim over
  /// OffsetFade, mm. MinimumThickness is kept.
  double OuterOffset = 0;
  double InnerOffset = 0;
  double OffsetFade = 15;
  int Parts = 1; ///< divided along the way in, EdgeClearance apart
  /// Round holes along the normal of the outer surface: mm between their middles (0: none) and
  /// their diameters. Drainage holes are on a hexagonal lattice, those for sutures along the rim.
  double DrainageSpacing = 0;
  double DrainageDiameter = 2.5;
  double SutureSpacing = 0;
  double SutureDiameter = 1.5;
  int Plates = 0;             ///< as many screws in the implant, and in the bone beside it
  double ScrewDiameter = 1.5; ///< mm, of the holes in the implant
  double ScrewLength = 4;     ///< mm: bone should be as thick
  double RimDistance = 5;     ///< mm from the rim to the middles of holes
  /// Closed curves (mm, as read: x to the right, y up) of text that is engraved into the inner face, its top towards Up.
  std::vector<std::vector<Vec2>> Text;
  Vec3 Up{ 0, 0, 1 };

  void Describe(Properties& properties) const; ///< with the ranges, but for Level, Text and Up
};

/// What a triangle of the implant belongs to.
enum class SkullImplantFace : unsigned char
{
  Outer, ///< towards the scalp
  Inner, ///< towards the brain
  Edge,  ///< the edge and the walls of holes
  Text   ///< engraved into the inner face
};

constexpr double LeastHoleToRim = 1; ///< mm of material between the wall of a hole and the rim
constexpr double LeastPlateToRim =
  4; ///< mm, RimDistance of plates: screws break bone that is nearer to its edge

/// Standard error, mm, above which 95 % of errors are not within 1 mm.
constexpr double TrustedError = 1 / 1.959963984540054;

/// The screws of a plate that fastens an implant.
struct ImplantPlateScrews
{
  Vec3 OnImplant{ 0, 0, 0 }; ///< on the outer surface, world mm
  Vec3 OnBone{ 0, 0, 0 };    ///< on the outer table
  double BoneThickness = 0;  ///< mm, the least within 3 mm
  Vec2 Foot{};               ///< of OnImplant, in the chart
};

/// A closed, oriented triangle mesh (one a part) and what was measured on it.
struct SkullImplant
{
  std::vector<Vec3> Points;            ///< world mm
  std::vector<Triangle> Triangles;     ///< counterclockwise from outside
  std::vector<SkullImplantFace> Faces; ///< one per triangle
  std::vector<int> Parts;              ///< one per triangle, from 1
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
    0; ///< mm, least distance from bone on the way in, at most 3, or 2.5 more than EdgeClearance
  /// Free space beside the edge that cannot be filled when it is put in so: mm^3, its width in mm, and where.
  double UndercutVolume = 0;
  double UndercutWidth = 0;
  Vec3 UndercutPoint{ 0, 0, 0 };
  std::vector<ImplantPlateScrews> Plates;
  int Holes = 0; ///< for drainage, sutures and screws
  std::vector<std::string> Warnings;
};

/// Throws std::invalid_argument that names an option out of range.
void CheckSkullImplantOptions(const SkullImplantOptions& options);

/// The outer and inner surface are those of the shape. Between them the edge keeps the clearance from bone at each
/// depth, also on the way in: it follows the wall where that opens outwards, and goes along the direction where
/// bone is above free space. What into which no ball of 2 mm fits is left out, and so is all
/// but the largest of several free spaces.
/// defect: rays, as of FindDefects. Throws as CheckSkullImplantOptions, std::invalid_argument for an empty
/// defect, and std::runtime_error when no free space is left.
SkullImplant MakeSkullImplant(const VoxelVolume& volume, const SkullRays& rays,
  const std::vector<int>& defect, const SkullShape& shape, const BoneDistance& bone,
  const SkullImplantOptions& options, Execution& execution);
}
#endif
