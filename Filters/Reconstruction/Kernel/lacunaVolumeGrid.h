// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The voxel grid of a volume around slices.
#ifndef lacunaVolumeGrid_h
#define lacunaVolumeGrid_h

#include "lacunaProperties.h"
#include "lacunaSliceImage.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace lacuna
{
/// Voxels along the reference axes; voxel (i, j, k) is the point Origin + (i, j, k) * Spacing.
struct VolumeGrid
{
  Vec3 Origin{};
  Vec3 Spacing{};
  std::array<int, 3> Dimensions{};
  /// How the requested bounds miss the slices, so that all voxels stay empty; empty: they meet.
  std::string Miss{};
};

/// What the user wants of a grid.
struct VolumeGridRequest
{
  static constexpr ValueRange SpacingRange = ValueRange::Above(0, "mm").OrZero("automatic");

  /// mm; 0 on an axis takes the spacing from the data (see MakeVolumeGrid).
  Vec3 Spacing{ 0, 0, 0 };
  /// x, y, z minimum and maximum, mm; 1, -1 on an axis takes the bounds from the data.
  std::array<double, 6> Bounds{ 1, -1, 1, -1, 1, -1 };
  /// Memory that one voxel takes while the volume is made, and all there may be; 0 = no limit.
  std::int64_t BytesPerVoxel = 1;
  double MemoryLimit = 0;
};

/// The grid that holds the slices:
/// - box: the corner pixel centres of all slices, or the requested bounds;
/// - voxels along an axis: round(extent / spacing) + 1, the first one at the box's minimum;
/// - spacing from the data: the same on all axes, the largest pixel spacing of the slices, or more
///   if the box would then have over 2^23 voxels (about 203 x 203 x 203): the spacing that gives
///   this number, rounded up to two digits.
///
/// Throws std::invalid_argument for a spacing out of range, inverted bounds, and when the
/// volume would not fit into the memory limit; the text then says how many bytes it would take, which
/// spacing would do, and which slice lies far off, if one does.
VolumeGrid MakeVolumeGrid(const std::vector<SliceImage>& slices, const VolumeGridRequest& request);
}
#endif
