// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The grey-level gradient: differences of voxels, interpolated between them. Carr 1996, eq. 3.5.
#ifndef lacunaGreyLevelGradient_h
#define lacunaGreyLevelGradient_h

#include "lacunaVoxelVolume.h"

namespace lacuna
{
/// Central differences at the eight voxels round an index point, one-sided at the border,
/// interpolated trilinearly; per voxel step. Voxels that are not finite count as empty.
Vec3 GreyLevelGradient(const VoxelVolume& volume, const Vec3& index, double empty);
}
#endif
