// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The plane in which a volume agrees best with its mirror image.
#ifndef lacunaVolumeSymmetry_h
#define lacunaVolumeSymmetry_h

#include "lacunaExecution.h"
#include "lacunaMirrorPlane.h"
#include "lacunaSymmetrySearch.h"
#include "lacunaVoxelVolume.h"

#include <vector>

namespace lacuna
{
/// Which voxels count: those that are finite and, where there is a mask of as many bytes as voxels,
/// not 0 in it.
struct MaskedVolume
{
  VoxelVolume Volume;
  std::vector<unsigned char> Valid; ///< empty: all
};

/// The plane, world mm, in which a volume agrees best with its mirror image. Planes count that mirror
/// at least a third of the volume's variance (sum of squares about the mean) into the volume, so that it
/// may be cut off. The rating is the concordance of blocks of voxels; the last steps minimise Tukey's
/// biweight of the differences at strong edges, so that what is on one side only (a defect)
/// has no weight. A volume of one slice has its plane perpendicular to the slice. Throws
/// std::runtime_error for a volume without two different values, with axes that are not
/// perpendicular, or without extent along two axes.
SymmetryResult FindSymmetryPlane(const MaskedVolume& volume, Execution& execution);
}
#endif
