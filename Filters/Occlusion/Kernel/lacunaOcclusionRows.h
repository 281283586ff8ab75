// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The inner loops of occluded angles: operations on rows of rays and of voxels.
#ifndef lacunaOcclusionRows_h
#define lacunaOcclusionRows_h

#include <array>
#include <cstdint>
#include <vector>

namespace lacuna
{
/// Path lengths (mm) of a ray inside one layer through the voxels (i, j), (i + 1, j), (i, j + 1),
/// (i + 1, j + 1); the same for all rays of a direction.
using PathLengths = std::array<float, 4>;

/// Attenuations beyond this let nothing through that a float's angle could show.
constexpr float LargestPath = 80;

/// Operations on rows of n values. `m0` and `m1` are the attenuations of the two voxel rows that
/// rays pass, from voxel i on (n + 1 values are read). Let through T is exp(-path), in Binary mode
/// 0 where path > 0 and else 1. Rows do not overlap. All implementations give the same bits.
struct OcclusionRows
{
  /// next = path + what the layer adds. next may be path.
  void (*AddPath)(const float* path, float* next, const float* m0, const float* m1,
    const PathLengths& lengths, std::int64_t n);

  /// through = T(path before this layer) + T(path after this layer up to total); path then becomes
  /// the one after this layer.
  void (*SeeBothWays)(float* path, const float* total, const float* m0, const float* m1,
    const PathLengths& lengths, float* through, std::int64_t n);

  /// through = T(|path - first|, at least 0).
  void (*See)(const float* path, const float* first, float* through, std::int64_t n);

  /// hidden += whole - T(half * own) * (through interpolated to the voxels): voxel i lies the
  /// fraction fx of a ray spacing beyond ray i - 1 towards... see the source; below and above are
  /// the rays of the two neighbouring rows, from ray i on, read from -1.
  void (*Hide)(float* hidden, const float* own, float half, const float* below, const float* above,
    float fx, float fy, float whole, std::int64_t n);
};

/// The operations for this processor's widest vectors.
const OcclusionRows& GetOcclusionRows(bool binary);

/// All implementations this processor can run, the plainest first, for tests and benchmarks.
std::vector<OcclusionRows> GetAllOcclusionRows(bool binary);
}
#endif
