// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSampledSlice.h"

#include "lacunaFootprint.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

namespace lacuna
{
namespace
{
// gradient . (voxel - point) as a function of the voxel's indices.
AffineFunction MakeFunction(const VolumeGrid& grid, const Vec3& gradient, const Vec3& point)
{
  return { gradient[0] * grid.Spacing[0], gradient[1] * grid.Spacing[1],
    gradient[2] * grid.Spacing[2], Dot(gradient, grid.Origin - point) };
}

// What a voxel covers along f's gradient, in f's unit: the width of the box that has the same
// second moment as the voxel. For cubic voxels it does not depend on the direction.
double GetVoxelWidth(const AffineFunction& f)
{
  return std::hypot(f.I, f.J, f.K); // finite for any spacing
}

// The raster of a slice, which goes on by some columns and rows on each side.
template <class Real>
void FillRaster(const SliceImage& slice, const FootprintAxis& columns, const FootprintAxis& rows,
  int columnsOutside, int rowsOutside, SampledSlice& sampled)
{
  sampled.Width = columns.GetNumberOfSamples() + 2 * columnsOutside;
  sampled.Height = rows.GetNumberOfSamples() + 2 * rowsOutside;
  sampled.RowStride = sampled.Width;
  sampled.Type = std::is_same<Real, float>::value ? ScalarType::Float32 : ScalarType::Float64;
  const auto count = static_cast<std::size_t>(sampled.Width) * sampled.Height;
  sampled.Storage.reset(new std::byte[(slice.Fan ? 2 : 1) * count * sizeof(Real)]);
  auto* const pixels = reinterpret_cast<Real*>(sampled.Storage.get());
  Real* const weights = slice.Fan ? pixels + count : nullptr;
  sampled.Pixels = pixels;
  sampled.Weights = weights;
  const std::int64_t start = rowsOutside * sampled.RowStride + columnsOutside;
  DispatchScalars(slice.Type, slice.Pixels,
    [&](const auto* source)
    {
      using T = std::remove_cv_t<std::remove_pointer_t<decltype(source)>>;
      if constexpr (std::is_same<Real, double>::value || sizeof(T) <= 2 ||
        std::is_same<T, float>::value)
      {
        slice.Fan ? AverageFootprintsInFan(source, slice.RowStride, columns, rows, *slice.Fan,
                      pixels + start, weights + start, sampled.RowStride)
                  : AverageFootprints(
                      source, slice.RowStride, columns, rows, pixels + start, sampled.RowStride);
      }
    });
  ContinueRaster(pixels, weights, sampled.Width, sampled.Height, columnsOutside, rowsOutside);
}

bool HasSampler(ScalarType type, bool doublePrecision)
{
  return doublePrecision ? type == ScalarType::Float64
                         : type == ScalarType::UInt8 || type == ScalarType::Int16 ||
      type == ScalarType::UInt16 || type == ScalarType::Float32;
}
}

bool NeedsDoublePrecision(ScalarType type)
{
  return GetScalarSize(type) > 2 && type != ScalarType::Float32;
}

SampledSlice SampleSlice(const SliceImage& slice, const VolumeGrid& grid, PixelSampling sampling,
  double footprintScale, bool doublePrecision)
{
  CheckSlice(slice);
  if (NeedsDoublePrecision(slice.Type) && !doublePrecision)
  {
    throw std::invalid_argument(slice.Label + ": grey levels of this type need double precision");
  }
  const Vec3 x = slice.PixelToReference.Column(0);
  const Vec3 y = slice.PixelToReference.Column(1);
  const Vec3 origin = slice.PixelToReference.Column(3);
  const Vec3 area = Cross(x, y);

  SampledSlice sampled;
  sampled.Label = slice.Label;
  sampled.Normal = Normalized(area);
  // the basis dual to (x, y, normal): rows and columns need not be at right angles
  sampled.Column = MakeFunction(grid, 1 / Norm(area) * Cross(y, sampled.Normal), origin);
  sampled.Row = MakeFunction(grid, 1 / Norm(area) * Cross(sampled.Normal, x), origin);
  sampled.Distance = MakeFunction(grid, sampled.Normal, origin);
  for (const AffineFunction* f : { &sampled.Column, &sampled.Row, &sampled.Distance })
  {
    if (!std::isfinite(std::max(1.0, footprintScale) * GetVoxelWidth(*f)) || !std::isfinite(f->C))
    {
      throw std::invalid_argument(slice.Label +
        ": a voxel is wider than numbers can say in its pixels; lower OutputSpacing, which is in "
        "mm");
    }
  }

  sampled.FootprintHeight = footprintScale * GetVoxelWidth(sampled.Distance);

  const bool footprint = sampling == PixelSampling::Footprint;
  const double voxelColumns = footprint ? GetVoxelWidth(sampled.Column) : 0;
  const double voxelRows = footprint ? GetVoxelWidth(sampled.Row) : 0;
  const FootprintAxis columns(slice.Width, footprintScale * voxelColumns);
  const FootprintAxis rows(slice.Height, footprintScale * voxelRows);
  const double right = slice.Width - 1;
  const double bottom = slice.Height - 1;
  // pixels that feet may lie outside
  const double dx = footprint ? columns.GetMargin(voxelColumns) : 0.5;
  const double dy = footprint ? rows.GetMargin(voxelRows) : 0.5;
  sampled.Corners = { slice.PixelToReference.Point({ -dx, -dy, 0 }),
    slice.PixelToReference.Point({ right + dx, -dy, 0 }),
    slice.PixelToReference.Point({ -dx, bottom + dy, 0 }),
    slice.PixelToReference.Point({ right + dx, bottom + dy, 0 }) };
  if (slice.Fan)
  {
    const Fan& fan = slice.Fan->GetFan();
    const Vec2& spacing = slice.Fan->GetPixelSpacing();
    sampled.Fan = slice.Fan;
    sampled.FanX = spacing[0] * (sampled.Column + -fan.Origin[0]);
    sampled.FanY = spacing[1] * (sampled.Row + -fan.Origin[1]);
  }

  // Footprints of some slices of a sweep may be narrower than a pixel: all get a raster, so that
  // all are of one type.
  const int left = footprint ? columns.GetNumberOfSamplesOutside(voxelColumns) : 0;
  const int above = footprint ? rows.GetNumberOfSamplesOutside(voxelRows) : 0;
  if (!footprint && !slice.Fan && HasSampler(slice.Type, doublePrecision))
  {
    sampled.Type = slice.Type;
    sampled.Pixels = slice.Pixels;
    sampled.RowStride = slice.RowStride;
    sampled.Width = slice.Width;
    sampled.Height = slice.Height;
  }
  else if (doublePrecision)
  {
    FillRaster<double>(slice, columns, rows, left, above, sampled);
  }
  else
  {
    FillRaster<float>(slice, columns, rows, left, above, sampled);
  }
  const double columnStep = columns.GetStep();
  const double rowStep = rows.GetStep();
  sampled.Column = 1 / columnStep * sampled.Column + left;
  sampled.Row = 1 / rowStep * sampled.Row + above;
  sampled.Columns = { left - dx / columnStep, left + (right + dx) / columnStep };
  sampled.Rows = { above - dy / rowStep, above + (bottom + dy) / rowStep };
  return sampled;
}

void OwnPixels(SampledSlice& slice)
{
  if (slice.Storage)
  {
    return;
  }
  const std::size_t size = GetScalarSize(slice.Type);
  const std::size_t line = size * static_cast<std::size_t>(slice.Width);
  slice.Storage.reset(new std::byte[line * static_cast<std::size_t>(slice.Height)]);
  for (int row = 0; row < slice.Height; ++row)
  {
    std::memcpy(slice.Storage.get() + line * static_cast<std::size_t>(row),
      static_cast<const std::byte*>(slice.Pixels) +
        static_cast<std::ptrdiff_t>(size) * slice.RowStride * row,
      line);
  }
  slice.Pixels = slice.Storage.get();
  slice.RowStride = slice.Width;
}
}
