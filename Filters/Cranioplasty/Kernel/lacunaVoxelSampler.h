// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Values of a volume between its voxels.
#ifndef lacunaVoxelSampler_h
#define lacunaVoxelSampler_h

#include "lacunaMatrix4.h"
#include "lacunaVector.h"
#include "lacunaVoxelVolume.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace lacuna
{
/// Trilinear values of a volume. Refers to its voxels.
template <class T>
class VoxelSampler
{
public:
  VoxelSampler(const VoxelVolume& volume, const T* voxels)
    : Volume(volume)
    , Voxels(voxels)
    , WorldToIndex(volume.IndexToWorld.Inverse())
  {
  }

  /// At a point, world mm; NaN outside.
  double operator()(const Vec3& world) const
  {
    const Vec3 index = this->WorldToIndex.Point(world);
    std::int64_t base = 0;
    std::int64_t stride = 1;
    std::int64_t next[3];
    double f[3];
    for (int a = 0; a < 3; ++a)
    {
      const int last = this->Volume.Size[a] - 1;
      if (!(index[a] >= 0 && index[a] <= last))
      {
        return std::numeric_limits<double>::quiet_NaN();
      }
      const int i = std::min(static_cast<int>(index[a]), last - 1);
      f[a] = index[a] - i;
      base += stride * i;
      next[a] = stride;
      stride *= this->Volume.Size[a];
    }
    const auto along = [&](std::int64_t at)
    {
      return (1 - f[0]) * static_cast<double>(this->Voxels[at]) +
        f[0] * static_cast<double>(this->Voxels[at + next[0]]);
    };
    const auto plane = [&](std::int64_t at)
    { return (1 - f[1]) * along(at) + f[1] * along(at + next[1]); };
    return (1 - f[2]) * plane(base) + f[2] * plane(base + next[2]);
  }

private:
  VoxelVolume Volume;
  const T* Voxels;
  Matrix4 WorldToIndex;
};
}
#endif
