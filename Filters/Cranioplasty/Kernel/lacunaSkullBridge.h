// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Small holes in the vault of a skull, closed between its outer and inner table.
#ifndef lacunaSkullBridge_h
#define lacunaSkullBridge_h

#include "lacunaExecution.h"
#include "lacunaVoxelVolume.h"

#include <cstdint>
#include <vector>

namespace lacuna
{
struct BridgedVoxel
{
  std::int64_t Index; ///< in the order of the voxels
  double Depth;       ///< mm within the bone that closes the hole; below 0 outside of it
};

/// The voxels in which bone closes the small holes of the vault, in the order of their indices: those in the bone
/// and those up to two voxels beside it.
///
/// A hole is a set of connected rays without bone. It is small when no circle of the diameter (mm) fits into it,
/// and of the vault when at least three quarters of the rays around it meet sound bone (an ear canal has less). Both tables go on across it as
/// membranes over the ellipsoid that fits the vault: no place of them is farther out or in than the rim. The bone
/// is at least as thick as a voxel is along the ray, so that it has no gap. The rim counts from where voxels do not
/// round it. Throws std::invalid_argument when TraceSkull does.
std::vector<BridgedVoxel> BridgeHoles(
  const VoxelVolume& volume, double level, double diameter, Execution& execution);
}
#endif
