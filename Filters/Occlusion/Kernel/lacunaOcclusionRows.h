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
/// rays pass, from voxel i on (n + 1 values are read). What a path lets through is T = exp(-path),
/// in Binary mode 0 where path > 0 and else 1. All implementations give the same bits.
struct OcclusionRows
{
  /// path += what the layer adds.
  void (*AddPath)(
    float* path, const float* m0, const float* m1, const PathLengths& lengths, std::int64_t n);

  /// root = square root of T(path - first, at least 0).
  void (*See)(const float* path, const float* first, float* root, std::int64_t n);

  /// What a voxel's ray meets on one side: the next layer, then what the rays around it let
  /// through. Voxel i lies fy of the way from ray row near to far, and fx of the way from ray i to
  /// ray i - 1 (the rows are read from -1 on).
  struct Side
  {
    const float* M0;
    const float* M1;
    PathLengths Lengths;
    const float* Near;
    const float* Far;
  };

  /// hidden += sum over both sides of 1 - T(half * own + path through the next layer) * root^2,
  /// root being interpolated bilinearly to the voxels.
  void (*Hide)(float* hidden, const float* own, float half, const Side& before, const Side& after,
    float fx, float fy, std::int64_t n);
  /// The same for one side.
  void (*HideSide)(float* hidden, const float* own, float half, const Side& side, float fx,
    float fy, std::int64_t n);
};

/// The operations for this processor's widest vectors.
const OcclusionRows& GetOcclusionRows(bool binary);

/// All implementations this processor can run, the plainest first, for tests and benchmarks.
std::vector<OcclusionRows> GetAllOcclusionRows(bool binary);
}
#endif
