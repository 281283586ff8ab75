// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Pixels put into the voxels in which their centres lie.
#ifndef lacunaPixelPlacing_h
#define lacunaPixelPlacing_h

#include "lacunaSliceImage.h"
#include "lacunaVolumeGrid.h"
#include "lacunaVoxelBlock.h"
#include "lacunaVoxelRegion.h"

namespace lacuna
{
/// Adds the pixels of slice whose nearest voxels lie in layers; slice has passed CheckSlice.
template <class Real>
void PutPixels(const SliceImage& slice, const VolumeGrid& grid, IndexInterval layers,
  Compounding compounding, VoxelBlock<Voxel<Real>>& voxels);
}
#endif
