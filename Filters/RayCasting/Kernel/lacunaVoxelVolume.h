// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A regular array of voxels of any real type, seen by kernels.
#ifndef lacunaVoxelVolume_h
#define lacunaVoxelVolume_h

#include "lacunaMatrix4.h"

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace lacuna
{
enum class VoxelType
{
  Int8,
  UInt8,
  Int16,
  UInt16,
  Int32,
  UInt32,
  Int64,
  UInt64,
  Float32,
  Float64
};

/// One value per voxel, x fastest, without gaps. Does not own the voxels.
struct VoxelVolume
{
  const void* Voxels = nullptr;
  VoxelType Type = VoxelType::Float64;
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

/// Calls f with the volume's voxels as a pointer to their type.
template <class F>
auto DispatchVoxels(const VoxelVolume& volume, F&& f)
{
  switch (volume.Type)
  {
    case VoxelType::Int8:
      return f(static_cast<const std::int8_t*>(volume.Voxels));
    case VoxelType::UInt8:
      return f(static_cast<const std::uint8_t*>(volume.Voxels));
    case VoxelType::Int16:
      return f(static_cast<const std::int16_t*>(volume.Voxels));
    case VoxelType::UInt16:
      return f(static_cast<const std::uint16_t*>(volume.Voxels));
    case VoxelType::Int32:
      return f(static_cast<const std::int32_t*>(volume.Voxels));
    case VoxelType::UInt32:
      return f(static_cast<const std::uint32_t*>(volume.Voxels));
    case VoxelType::Int64:
      return f(static_cast<const std::int64_t*>(volume.Voxels));
    case VoxelType::UInt64:
      return f(static_cast<const std::uint64_t*>(volume.Voxels));
    case VoxelType::Float32:
      return f(static_cast<const float*>(volume.Voxels));
    case VoxelType::Float64:
      return f(static_cast<const double*>(volume.Voxels));
  }
  throw std::invalid_argument("unknown type of voxels");
}
}
#endif
