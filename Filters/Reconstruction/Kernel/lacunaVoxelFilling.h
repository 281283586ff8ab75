// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The inner loops of SweptVolume.
#ifndef lacunaVoxelFilling_h
#define lacunaVoxelFilling_h

#include "lacunaSlicePair.h"
#include "lacunaVoxelBlock.h"

namespace lacuna
{
/// Adds the samples of layer k that lie between the two slices of pair. Both slices' rasters have
/// the same type: any but Float64 where Real is float, Float64 where it is double.
template <class Real>
void FillBetween(const SlicePair& pair, std::int64_t k, PixelSampling sampling,
  Compounding compounding, VoxelBlock<Voxel<Real>>& voxels);

/// The same for footprints that reach across slices.
template <class Real>
void FillAcross(const SlicePair& pair, std::int64_t k, VoxelBlock<WeightedVoxel<Real>>& voxels);
}
#endif
