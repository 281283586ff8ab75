// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A volume's mirror image on its own voxels.
#ifndef lacunaMirroredVolume_h
#define lacunaMirroredVolume_h

#include "lacunaExecution.h"
#include "lacunaMirrorPlane.h"
#include "lacunaRanks.h"
#include "lacunaVolumeSymmetry.h"

#include <array>
#include <vector>

namespace lacuna
{
/// How grey levels between voxels are found.
enum class MirrorInterpolation
{
  BSpline, ///< the cubic B-spline through all voxels (natural at the ends)
  Linear,
  Nearest ///< for labels
};
inline constexpr std::array<const char*, 3> MirrorInterpolationNames{ "BSpline", "Linear",
  "Nearest" };

/// First and last voxel along each axis; none where a first one is beyond its last one.
using VolumePart = std::array<int, 6>;

/// A part of a mirror image, and what is found of all of it.
struct MirroredVolume
{
  /// In the type of the volume, one per voxel; the lowest finite value where Valid is 0.
  std::vector<unsigned char> Voxels;
  /// 1 where the voxel shows a place between valid voxels.
  std::vector<char> Valid;
  /// Given minus mirrored; NaN where there is none of both.
  std::vector<float> Asymmetry;
  // of the whole volume, unless nothing was to be found
  double Score = 0;   ///< Concordance of given and mirrored voxels where there are both; may be NaN
  double RMS = 0;     ///< of Asymmetry
  double Overlap = 0; ///< part of the valid voxels where there are both
};

/// The volume's mirror image in a plane (world mm) on the volume's own voxels. Integers are rounded
/// to the nearest and clamped. Memory: the size of
/// the voxels and up to 10 bytes per voxel besides.
MirroredVolume MirrorVolume(const MaskedVolume& volume, const MirrorPlane& plane,
  MirrorInterpolation interpolation, Execution& execution);

/// The same for a part, with the same bits; of the memory, 5 bytes per voxel are for the whole volume.
/// judges: whether to find the score, RMS and overlap of the whole, which ranks do together: all of
/// them must call this, whatever part they want.
MirroredVolume MirrorVolume(const MaskedVolume& volume, const MirrorPlane& plane,
  MirrorInterpolation interpolation, const VolumePart& part, bool judges, const Ranks& ranks,
  Execution& execution);
}
#endif
