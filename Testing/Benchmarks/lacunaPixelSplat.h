// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A yardstick: what takes each pixel in turn and shares it among the eight voxels around it.
///
/// The usual way to reconstruct freehand sweeps ("pixel nearest neighbour" with linear weights).
/// Written plainly, but with care: steps along a row, no branches but the one that keeps it inside
/// the volume, sums in float. Holes are not filled. One thread.
#ifndef lacunaPixelSplat_h
#define lacunaPixelSplat_h

#include "lacunaSliceImage.h"
#include "lacunaVolumeGrid.h"

#include <cstddef>
#include <vector>

namespace lacuna
{
struct SplatVoxel
{
  float Sum, Weight;
};

template <class T>
void SplatPixels(
  const std::vector<SliceImage>& slices, const VolumeGrid& grid, std::vector<SplatVoxel>& voxels)
{
  const std::ptrdiff_t dy = grid.Dimensions[0];
  const std::ptrdiff_t dz = dy * grid.Dimensions[1];
  for (const SliceImage& slice : slices)
  {
    const auto* const pixels = static_cast<const T*>(slice.Pixels);
    Vec3 step;
    for (int a = 0; a < 3; ++a)
    {
      step[a] = slice.PixelToReference(a, 0) / grid.Spacing[a];
    }
    for (int row = 0; row < slice.Height; ++row)
    {
      Vec3 start = slice.PixelToReference.Point({ 0, static_cast<double>(row), 0 });
      for (int a = 0; a < 3; ++a)
      {
        start[a] = (start[a] - grid.Origin[a]) / grid.Spacing[a];
      }
      const T* const line = pixels + slice.RowStride * row;
      for (int column = 0; column < slice.Width; ++column)
      {
        const double x = start[0] + column * step[0];
        const double y = start[1] + column * step[1];
        const double z = start[2] + column * step[2];
        const int i = static_cast<int>(x);
        const int j = static_cast<int>(y);
        const int k = static_cast<int>(z);
        if (!(x >= 0 && y >= 0 && z >= 0 && i + 1 < grid.Dimensions[0] &&
              j + 1 < grid.Dimensions[1] && k + 1 < grid.Dimensions[2]))
        {
          continue;
        }
        const auto fx = static_cast<float>(x - i);
        const auto fy = static_cast<float>(y - j);
        const auto fz = static_cast<float>(z - k);
        const auto grey = static_cast<float>(line[column]);
        SplatVoxel* const v = voxels.data() + (dz * k + dy * j + i);
        const auto put = [grey](SplatVoxel& voxel, float weight)
        {
          voxel.Sum += weight * grey;
          voxel.Weight += weight;
        };
        put(v[0], (1 - fx) * (1 - fy) * (1 - fz));
        put(v[1], fx * (1 - fy) * (1 - fz));
        put(v[dy], (1 - fx) * fy * (1 - fz));
        put(v[dy + 1], fx * fy * (1 - fz));
        put(v[dz], (1 - fx) * (1 - fy) * fz);
        put(v[dz + 1], fx * (1 - fy) * fz);
        put(v[dz + dy], (1 - fx) * fy * fz);
        put(v[dz + dy + 1], fx * fy * fz);
      }
    }
  }
}
}
#endif
