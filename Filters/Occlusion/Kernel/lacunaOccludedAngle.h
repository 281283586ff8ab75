// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Occluded angles of images (Carr 1996, chapter 5).
#ifndef lacunaOccludedAngle_h
#define lacunaOccludedAngle_h

#include "lacunaAttenuationField.h"
#include "lacunaExecution.h"
#include "lacunaProperties.h"
#include "lacunaRanks.h"
#include "lacunaVector.h"

#include <vector>

namespace lacuna
{
/// Unit vectors along count lines in the xy plane at equal angles, (i + 1/2) pi / count from the
/// x axis. With their opposites they are 2 count directions at equal angles.
std::vector<Vec3> EqualAngleLines(int count);

/// Unit vectors along count lines in space, each standing for the same solid angle: a Fibonacci
/// spiral of low discrepancy on the upper half sphere. With their opposites they are 2 count
/// directions. Deterministic. (Carr 1996, section 5.8 uses random directions.)
std::vector<Vec3> EqualAreaLines(int count);

/// Above, voxels would close gaps that are as wide as they are.
inline constexpr ValueRange DilationRange = ValueRange::Between(0, 0.9, "voxels");

/// How rays see.
struct OccludedAngleOptions
{
  /// A ray is hidden as soon as it meets a voxel that attenuates; else by 1 - exp(-path).
  bool Binary = false;
  /// In all directions, even: a line serves both of its directions.
  int Directions = 1000;
  /// Rays end at this distance (mm); 0: at the end of the reconstruction space.
  double Radius = 0;
  /// In Binary mode voxels hide as if they were larger by this, in voxels: then gaps of that width
  /// between them are closed.
  double Dilation = 0;
  /// The part of the whole progress that this is.
  double FirstProgress = 0;
  double LastProgress = 1;
};

/// 2 pi for a flat field, else 4 pi.
double GetFullAngle(const AttenuationField& field);

/// The angle (radians, or steradians when the field is not flat) under which each voxel centre is
/// hidden from the boundary of the reconstruction space: the whole grid, less the voxels that hold
/// AttenuationField::OutsideSpace().
///
/// For each line the rays run one voxel apart along the grid axis nearest to it. Their path
/// lengths through voxels are exact; a voxel sees half of itself and, beyond, the bilinear
/// interpolation between the four rays that enclose it:
/// - of their paths (Carr 1996, section 5.4). In the mean over ray positions this is attenuation
///   interpolated linearly between voxel centres.
/// - in Binary mode of whether they are hidden, after the exact path of the voxel's own ray
///   through the next layer. In the mean voxels are cubes.
/// A voxel outside the space gets 0.
///
/// Directions are shared among ranks that have the same field; each gets all of the angle. Sums over
/// directions are of whole numbers (HiddenUnits), so that the result depends neither on the number
/// of threads nor on that of ranks, and a small part is not lost beside a large sum.
///
/// angle has a value per voxel, x fastest. The field is unchanged in the end (its axes are swapped
/// meanwhile). Cost: voxels times directions, divided by the ranks. Memory: a few megabytes per
/// thread, and GetOccludedAngleMemory. Throws std::invalid_argument for an odd or
/// non-positive number of directions and for a radius below the shortest voxel edge.
void ComputeOccludedAngle(AttenuationField& field, const OccludedAngleOptions& options,
  float* angle, Execution& execution, const Ranks& ranks = Ranks());

/// Bytes that it needs for each voxel of a large field meanwhile.
int GetOccludedAngleMemory(int directions);
}
#endif
