// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A skull as seen along rays from its middle: tables, sound bone, defects.
#ifndef lacunaSkullRays_h
#define lacunaSkullRays_h

#include "lacunaExecution.h"
#include "lacunaMirrorPlane.h"
#include "lacunaSkullShape.h"
#include "lacunaVector.h"
#include "lacunaVoxelVolume.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace lacuna
{
/// The skull is between these, mm from its middle.
constexpr double LeastSkullRadius = 25;
constexpr double MostSkullRadius = 160;
constexpr double MostBoneThickness = 20; ///< mm: within which crossings belong to one bone

enum class SkullRayKind : std::uint8_t
{
  Sound,  ///< bone whose outer table is smooth, like that of the rays around
  Rough,  ///< bone at a step, an edge or in the skull base
  Open,   ///< no bone where the skull would have it
  Unknown ///< the scan ends where the skull would be
};

/// One element a ray in each array.
struct SkullRays
{
  Vec3 Center{ 0, 0, 0 };       ///< world mm
  std::vector<Vec3> Directions; ///< unit, evenly spread
  double Spacing = 0;           ///< of neighbours, radians
  double RoundedEdge = 0;       ///< mm beside a hole where voxels round bone off
  std::vector<double> Outer;    ///< mm from the centre; NaN without bone
  std::vector<double> Inner;    ///< the same
  std::vector<SkullRayKind> Kinds;
};

/// A point within the skull, on the plane: the middle of the sphere through its vault, found by rays from
/// the mean of all voxels at or above the level. Throws std::invalid_argument when there is no such voxel.
Vec3 FindSkullCenter(
  const VoxelVolume& volume, double level, const MirrorPlane& plane, Execution& execution);

/// The mean of all voxels at or above the level. Throws as FindSkullCenter does.
Vec3 FindMeanOfBone(const VoxelVolume& volume, double level, Execution& execution);

/// Of the sphere that is closest to points around a centre, by least squares.
Vec3 FindSphereMiddle(const Vec3& center, const std::vector<Vec3>& points);

/// Unit, evenly spread over the sphere, radians apart, in the order of one of the axes (columns; the fourth does not
/// count): neighbours are found in a band.
std::vector<Vec3> SpreadDirections(double spacing, const Matrix4& axes);

/// Follows rays from the centre, spaced so many mm at 90 mm from it. The outer table is the outermost crossing
/// of the level; the inner one the innermost within 20 mm of it (diploe below the level is bone). What is
/// not skull (head holder, table) has to be below the level. Rays are the same in the volume's own axes: a
/// volume that is turned by its direction matrix has the same tables. Throws std::invalid_argument for a
/// centre outside the volume, for fewer than two voxels along an axis, or for too little bone.
SkullRays TraceSkull(const VoxelVolume& volume, double level, const Vec3& center, double spacing,
  Execution& execution);

/// mm from a point along rays; NaN without bone.
struct RayRadii
{
  std::vector<double> Outer;
  std::vector<double> Inner;
};

/// The same tables along any unit directions. NaN also where bone goes on at the end of the volume.
RayRadii TraceRays(const VoxelVolume& volume, double level, const Vec3& center,
  const std::vector<Vec3>& directions, Execution& execution);

/// TraceSkull's kinds of rays for radii that came from elsewhere. directions, spacing: of SkullRays. Without a table
/// the ray is open. Inner radii may be NaN.
SkullRays ClassifySkull(
  const Vec3& center, const std::vector<Vec3>& directions, double spacing, RayRadii radii);

/// A part of a ray, mm from the centre.
struct RaySegment
{
  Vec3 Direction; ///< unit
  double From;
  double To;
};

/// For each segment the largest value that it meets (trilinear, about twice a voxel). What is outside of the
/// volume does not count; infinity when From is outside.
std::vector<double> FindLargestAlong(const VoxelVolume& volume, const Vec3& center,
  const std::vector<RaySegment>& segments, Execution& execution);

/// For each direction of SkullRays those within an angle (radians), itself not.
std::vector<std::vector<int>> FindNeighbors(const std::vector<Vec3>& directions, double angle);

/// Connected rays that are all chosen: parts, the most rays first. neighbors: of FindNeighbors.
std::vector<std::vector<int>> FindParts(
  const std::vector<std::vector<int>>& neighbors, const std::function<bool(int)>& chosen);

/// The sound rays without those at rounded edges.
SoundBone GetSoundBone(const SkullRays& rays);

/// Connected open rays, of at least leastArea (mm^2), with sound bone around them (half of the rays within four spacings;
/// the open base of a skull has less): lists of rays, the largest first. A defect that opens into an orbit ends
/// where the opening is narrower than 20 mm.
std::vector<std::vector<int>> FindDefects(const SkullRays& rays, double leastArea = 100);

/// The rays within a closed curve on the skull (world mm), as seen from the centre. Throws std::invalid_argument
/// for fewer than three points, a curve that crosses itself, or one around more than about half of the skull.
std::vector<int> FindRaysWithin(const SkullRays& rays, const std::vector<Vec3>& curve);
}
#endif
