// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPixelPlacing.h"

#include "lacunaWide.h"

#include <algorithm>
#include <array>

namespace lacuna
{
namespace
{
// The nearest whole number of one that is at least -0.5 but for a tolerance.
LACUNA_INLINE int RoundPositive(double x)
{
  return static_cast<int>(x + 0.5);
}

// A voxel index along a row of pixels.
struct Line
{
  double Start, Step;
  LACUNA_INLINE double At(double i) const { return this->Start + this->Step * i; }
};

// Pixels that are placed before they are put: in two loops, the first one with vectors.
constexpr int PixelsAtATime = 128;

// Where count pixels from first on lie, rounded.
LACUNA_WIDE void RoundAlong(Line line, int first, int count, std::int32_t* indices)
{
  for (int n = 0; n < count; ++n)
  {
    indices[n] = RoundPositive(line.At(static_cast<double>(first + n)));
  }
}

template <Compounding compounding, class T, class Real>
void PutPixelsOf(const SliceImage& slice, const T* pixels, const VolumeGrid& grid,
  IndexInterval layers, VoxelBlock<Voxel<Real>>& voxels)
{
  const std::array<int, 6>& extent = voxels.GetExtent();
  const std::array<IndexInterval, 3> range{ IndexInterval{ extent[0], extent[1] },
    IndexInterval{ extent[2], extent[3] }, layers };
  // The voxel index along each axis, a function of the pixel's column and row.
  std::array<AffineFunction, 3> index;
  VoxelRegion region; // of pixels
  constexpr double margin = 1e-6;
  for (int a = 0; a < 3; ++a)
  {
    const double scale = 1 / grid.Spacing[a];
    index[a] = { scale * slice.PixelToReference(a, 0), scale * slice.PixelToReference(a, 1), 0,
      scale * (slice.PixelToReference(a, 3) - grid.Origin[a]) };
    region.Add(index[a] + (0.5 + margin - static_cast<double>(range[a].First)));
    region.Add(-index[a] + (0.5 + margin + static_cast<double>(range[a].Last)));
  }
  const VoxelRegion::Layer layer = region.GetLayer(0, { 0, slice.Height - 1 });
  const std::int64_t lineSize = voxels.GetSize(0);
  const std::int64_t layerSize = lineSize * voxels.GetSize(1);
  Voxel<Real>* const data = voxels.GetData();
  const std::int64_t start = extent[4] * layerSize + extent[2] * lineSize + extent[0];
  std::array<std::array<std::int32_t, PixelsAtATime>, 3> v;
  const IndexInterval rows = layer.GetRows();
  for (std::int64_t j = rows.First; j <= rows.Last; ++j)
  {
    const IndexInterval columns = layer.GetRow(j, { 0, slice.Width - 1 });
    const FanMask::Runs runs =
      slice.Fan ? slice.Fan->GetRuns(j) : FanMask::Runs{ &columns, &columns + 1 };
    const T* const line = pixels + slice.RowStride * j;
    std::array<Line, 3> along{};
    for (int a = 0; a < 3; ++a)
    {
      along[a] = { index[a].C + index[a].J * static_cast<double>(j), index[a].I };
    }
    const auto isInside = [&](std::int64_t i)
    {
      bool inside = true;
      for (int a = 0; a < 3; ++a)
      {
        const int v = RoundPositive(along[a].At(static_cast<double>(i)));
        inside &= v >= range[a].First && v <= range[a].Last;
      }
      return inside;
    };
    for (const IndexInterval& run : runs)
    {
      // indices grow or fall along the row: the margin is at its ends
      std::int64_t first = std::max(run.First, columns.First);
      std::int64_t last = std::min(run.Last, columns.Last);
      while (first <= last && !isInside(first))
      {
        ++first;
      }
      while (first <= last && !isInside(last))
      {
        --last;
      }
      while (first <= last)
      {
        const int count = static_cast<int>(std::min<std::int64_t>(last - first + 1, PixelsAtATime));
        for (int a = 0; a < 3; ++a)
        {
          RoundAlong(along[a], static_cast<int>(first), count, v[a].data());
        }
        const T* const pixel = line + first;
        for (int n = 0; n < count; ++n)
        {
          data[v[2][n] * layerSize + v[1][n] * lineSize + v[0][n] - start]
            .template Put<compounding>(static_cast<Real>(pixel[n]));
        }
        first += count;
      }
    }
  }
}
}

template <class Real>
void PutPixels(const SliceImage& slice, const VolumeGrid& grid, IndexInterval layers,
  Compounding compounding, VoxelBlock<Voxel<Real>>& voxels)
{
  DispatchScalars(slice.Type, slice.Pixels,
    [&](const auto* pixels)
    {
      if (compounding == Compounding::Mean)
      {
        PutPixelsOf<Compounding::Mean>(slice, pixels, grid, layers, voxels);
      }
      else
      {
        PutPixelsOf<Compounding::Maximum>(slice, pixels, grid, layers, voxels);
      }
    });
}

template void PutPixels(
  const SliceImage&, const VolumeGrid&, IndexInterval, Compounding, VoxelBlock<Voxel<float>>&);
template void PutPixels(
  const SliceImage&, const VolumeGrid&, IndexInterval, Compounding, VoxelBlock<Voxel<double>>&);
}
