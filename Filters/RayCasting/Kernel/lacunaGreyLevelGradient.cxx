// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaGreyLevelGradient.h"

#include <algorithm>
#include <cmath>

namespace lacuna
{
namespace
{
template <class T>
Vec3 Interpolate(const T* voxels, const std::array<int, 3>& size, const Vec3& index, double empty)
{
  int cell[3];
  double x[3];
  for (int a = 0; a < 3; ++a)
  {
    cell[a] = std::min(std::max(static_cast<int>(index[a]), 0), size[a] - 2);
    x[a] = std::min(std::max(index[a] - cell[a], 0.0), 1.0);
  }
  const auto voxel = [&](const int at[3])
  {
    const double v = static_cast<double>(voxels[at[0] +
      static_cast<std::int64_t>(size[0]) * (at[1] + static_cast<std::int64_t>(size[1]) * at[2])]);
    return std::isfinite(v) ? v : empty;
  };
  Vec3 gradient{ 0, 0, 0 };
  for (int n = 0; n < 8; ++n)
  {
    const int corner[3] = { n & 1, n >> 1 & 1, n >> 2 };
    double weight = 1;
    for (int a = 0; a < 3; ++a)
    {
      weight *= corner[a] ? x[a] : 1 - x[a];
    }
    for (int a = 0; a < 3; ++a)
    {
      int low[3] = { cell[0] + corner[0], cell[1] + corner[1], cell[2] + corner[2] };
      int high[3] = { low[0], low[1], low[2] };
      low[a] = std::max(low[a] - 1, 0);
      high[a] = std::min(high[a] + 1, size[a] - 1);
      gradient[a] += weight * (voxel(high) - voxel(low)) / (high[a] - low[a]);
    }
  }
  return gradient;
}
}

Vec3 GreyLevelGradient(const VoxelVolume& volume, const Vec3& index, double empty)
{
  return DispatchScalars(volume.Type, volume.Voxels,
    [&](const auto* voxels) { return Interpolate(voxels, volume.Size, index, empty); });
}
}
