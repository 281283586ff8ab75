// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A regular array of voxels of any real type, seen by kernels.
#ifndef lacunaVoxelVolume_h
#define lacunaVoxelVolume_h

#include "lacunaImagePlane.h"
#include "lacunaMatrix4.h"
#include "lacunaScalarType.h"

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace lacuna
{
/// One value per voxel, x fastest, without gaps. Does not own the voxels.
struct VoxelVolume
{
  const void* Voxels = nullptr;
  ScalarType Type = ScalarType::Float64;
  std::array<int, 3> Size{};
  /// (i, j, k, 1) to world mm; index 0 0 0 is the first voxel's centre. May mirror.
  Matrix4 IndexToWorld;

  std::int64_t NumberOfVoxels() const
  {
    return static_cast<std::int64_t>(this->Size[0]) * this->Size[1] * this->Size[2];
  }
};

/// Throws std::invalid_argument unless there are voxels to interpolate between along each axis.
inline void CheckVolumeSize(const std::array<int, 3>& size)
{
  if (size[0] < 2 || size[1] < 2 || size[2] < 2)
  {
    throw std::invalid_argument("a volume of " + std::to_string(size[0]) + " x " +
      std::to_string(size[1]) + " x " + std::to_string(size[2]) +
      " voxels has no inside: at least two voxels are needed along each axis");
  }
}

/// The centres of the outermost voxels at the corners, world.
std::vector<Vec3> CornersOf(const Matrix4& indexToWorld, const std::array<int, 3>& size);
double SmallestEdgeOf(const Matrix4& indexToWorld);

/// The plane for looking at a box of size voxels: the centres of the outermost voxels are its
/// corners, its smallest voxel edge is the finest spacing. Throws also what CheckVolumeSize throws.
ImagePlane MakeImagePlane(
  const Matrix4& indexToWorld, const std::array<int, 3>& size, const ViewSettings& view);
}
#endif
