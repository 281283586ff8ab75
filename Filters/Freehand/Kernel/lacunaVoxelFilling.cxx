// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVoxelFilling.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace lacuna
{
namespace
{
template <class T>
struct Raster
{
  explicit Raster(const SampledSlice& slice)
    : Raster(slice, slice.Pixels)
  {
  }
  Raster(const SampledSlice& slice, const void* pixels)
    : Pixels(static_cast<const T*>(pixels))
    , RowStride(slice.RowStride)
    , LastColumn(slice.Width - 2)
    , LastRow(slice.Height - 2)
  {
  }

  const T* Pixels;
  std::int64_t RowStride;
  int LastColumn; ///< the last one that has a right neighbour
  int LastRow;
};

// Grey level at (column, row), which lies on the raster but for the tolerance of SlicePair: a
// truncated column is in range, or one too far.
template <class T, class Real>
struct SampleFootprint
{
  static Real At(const Raster<T>& raster, double column, double row)
  {
    const int c = std::min(static_cast<int>(column), raster.LastColumn);
    const int r = std::min(static_cast<int>(row), raster.LastRow);
    const auto x = static_cast<Real>(column - c);
    const auto y = static_cast<Real>(row - r);
    const T* const p = raster.Pixels + (raster.RowStride * r + c);
    const T* const q = p + raster.RowStride;
    const Real upper = static_cast<Real>(p[0]) + x * static_cast<Real>(p[1] - p[0]);
    const Real lower = static_cast<Real>(q[0]) + x * static_cast<Real>(q[1] - q[0]);
    return upper + y * (lower - upper);
  }
};

// Outside of the outermost pixel centres their grey level goes on.
template <class T, class Real>
struct SampleBilinearly
{
  static Real At(const Raster<T>& raster, double column, double row)
  {
    return SampleFootprint<T, Real>::At(raster,
      std::min(std::max(column, 0.0), raster.LastColumn + 1.0),
      std::min(std::max(row, 0.0), raster.LastRow + 1.0));
  }
};

// The nearest whole number of one that is at least -0.5 but for a tolerance.
int RoundPositive(double x)
{
  return static_cast<int>(x + 0.5);
}

template <class T, class Real>
struct SampleNearest
{
  static Real At(const Raster<T>& raster, double column, double row)
  {
    const int c = std::min(RoundPositive(column), raster.LastColumn + 1);
    const int r = std::min(RoundPositive(row), raster.LastRow + 1);
    return static_cast<Real>(raster.Pixels[raster.RowStride * r + c]);
  }
};

// A quantity along one line of voxels.
struct Line
{
  double Start, Step;
  double At(double i) const { return this->Start + this->Step * i; }
};

struct Lines
{
  Lines(const SlicePair::Functions& f, double j, double k)
    : Column(GetLine(f.Column, j, k))
    , Row(GetLine(f.Row, j, k))
    , Distance(GetLine(f.Distance, j, k))
    , FanX(GetLine(f.FanX, j, k))
    , FanY(GetLine(f.FanY, j, k))
  {
  }
  static Line GetLine(const AffineFunction& f, double j, double k)
  {
    return { f.C + f.K * k + f.J * j, f.I };
  }
  Line Column, Row, Distance, FanX, FanY;
};

// Puts the sample of a voxel whose feet have the grey levels x and y, at these signed distances
// from the first and the second slice: what the voxel's centre has.
template <Compounding compounding>
struct PutCentre
{
  explicit PutCentre(const SlicePair& pair)
    : Tolerance(pair.GetTolerance())
  {
  }
  template <class Real>
  void operator()(Voxel<Real>& voxel, Real x, Real y, double first, double second) const
  {
    const double a = std::abs(first);
    const double gap = a + std::abs(second);
    const double weight = gap > this->Tolerance ? a / gap : 0.5;
    voxel.template Put<compounding>(x + static_cast<Real>(weight) * (y - x));
  }
  double Tolerance;
};

// The mean over the part of the voxel's height that lies between the slices, weighted by its
// length.
struct PutHeight
{
  explicit PutHeight(const SlicePair& pair)
    : HalfHeight(pair.GetHalfHeight())
    , Tolerance(pair.GetTolerance())
  {
  }
  template <class Real>
  void operator()(WeightedVoxel<Real>& voxel, Real x, Real y, double first, double second) const
  {
    // along the normal, from the voxel's centre: the slices lie at -first and -second
    const double begin = std::max(std::min(-first, -second), -this->HalfHeight);
    const double end = std::min(std::max(-first, -second), this->HalfHeight);
    const bool holdsCentre = begin <= this->Tolerance && end >= -this->Tolerance;
    const double length = holdsCentre ? std::max(end - begin, this->Tolerance) : end - begin;
    if (length > 0)
    {
      // grey levels are linear between the slices: their mean is that in the middle
      const double gap = first - second;
      const double weight =
        std::abs(gap) > this->Tolerance ? (0.5 * (begin + end) + first) / gap : 0.5;
      voxel.Put(x + static_cast<Real>(weight) * (y - x), static_cast<float>(length), holdsCentre);
    }
  }
  double HalfHeight;
  double Tolerance;
};

// Voxels first..last of a line. Everything is computed from the voxel's own index, not from its
// predecessor, so that it does not matter where a piece of the volume begins.
template <template <class, class> class Sampler, class T, class Put, class VoxelType>
void FillLine(const Raster<T>& firstRaster, const Raster<T>& secondRaster, const Lines& first,
  const Lines& second, const Put& put, IndexInterval interval, VoxelType* voxel,
  std::int64_t stride)
{
  using Real = decltype(voxel->Value);
  for (std::int64_t n = interval.First; n <= interval.Last; ++n, voxel += stride)
  {
    const auto i = static_cast<double>(static_cast<int>(n));
    const Real x = Sampler<T, Real>::At(firstRaster, first.Column.At(i), first.Row.At(i));
    const Real y = Sampler<T, Real>::At(secondRaster, second.Column.At(i), second.Row.At(i));
    put(*voxel, x, y, first.Distance.At(i), second.Distance.At(i));
  }
}

// The grey level at a foot in a slice with a fan, from the raster of sums and that of weights.
// Returns false where there is none.
template <template <class, class> class Sampler, class Real>
bool SampleInFan(const Raster<Real>& sums, const Raster<Real>& weights, const FanMask& fan,
  const Lines& lines, double i, Real& grey)
{
  if (!fan.ContainsOffset(lines.FanX.At(i), lines.FanY.At(i)))
  {
    return false;
  }
  const double column = lines.Column.At(i);
  const double row = lines.Row.At(i);
  const Real weight = Sampler<Real, Real>::At(weights, column, row);
  if (!(weight > 0)) // a tip of the fan between the pixels
  {
    return false;
  }
  grey = Sampler<Real, Real>::At(sums, column, row) / weight;
  return true;
}

// FillLine for slices with fans.
template <template <class, class> class Sampler, class Put, class VoxelType>
void FillLineInFans(const SlicePair& pair, const Lines& first, const Lines& second, const Put& put,
  IndexInterval interval, VoxelType* voxel, std::int64_t stride)
{
  using Real = decltype(voxel->Value);
  const SampledSlice& firstSlice = pair.GetFirst();
  const SampledSlice& secondSlice = pair.GetSecond();
  const Raster<Real> firstSums(firstSlice);
  const Raster<Real> secondSums(secondSlice);
  const Raster<Real> firstWeights(firstSlice, firstSlice.Weights);
  const Raster<Real> secondWeights(secondSlice, secondSlice.Weights);
  for (std::int64_t n = interval.First; n <= interval.Last; ++n, voxel += stride)
  {
    const auto i = static_cast<double>(static_cast<int>(n));
    Real x;
    Real y;
    if (SampleInFan<Sampler>(firstSums, firstWeights, *firstSlice.Fan, first, i, x) &&
      SampleInFan<Sampler>(secondSums, secondWeights, *secondSlice.Fan, second, i, y))
    {
      put(*voxel, x, y, first.Distance.At(i), second.Distance.At(i));
    }
  }
}

// T is the type of the slices' rasters.
template <class T, template <class, class> class Sampler, class Put, class VoxelType>
void FillLayer(const SlicePair& pair, std::int64_t k, VoxelBlock<VoxelType>& voxels)
{
  const std::array<int, 6>& extent = voxels.GetExtent();
  const std::size_t iAxis = pair.IsTransposed() ? 1 : 0;
  const std::size_t jAxis = 1 - iAxis;
  const IndexInterval columns{ extent[2 * iAxis], extent[2 * iAxis + 1] };
  const IndexInterval rows{ extent[2 * jAxis], extent[2 * jAxis + 1] };
  const std::array<std::int64_t, 2> strides{ 1, voxels.GetSize(0) };
  VoxelType* const corner =
    voxels.GetData() + (k - extent[4]) * voxels.GetSize(0) * voxels.GetSize(1);

  VoxelRegion::Layer layers[2];
  IndexInterval all;
  for (int w = 0; w < pair.GetNumberOfWedges(); ++w)
  {
    if (!pair.HasLayer(w, k))
    {
      continue;
    }
    layers[w] = pair.GetWedge(w).GetLayer(k, rows);
    const IndexInterval own = layers[w].GetRows();
    if (!own.IsEmpty())
    {
      all = all.IsEmpty()
        ? own
        : IndexInterval{ std::min(all.First, own.First), std::max(all.Last, own.Last) };
    }
  }

  const Put put(pair);
  const bool hasFans = pair.GetFirst().Fan && pair.GetSecond().Fan;
  const Raster<T> firstRaster(pair.GetFirst());
  const Raster<T> secondRaster(pair.GetSecond());
  for (std::int64_t j = all.First; j <= all.Last; ++j)
  {
    IndexInterval parts[2];
    for (int w = 0; w < 2; ++w)
    {
      const IndexInterval own = layers[w].GetRows();
      if (j >= own.First && j <= own.Last)
      {
        parts[w] = layers[w].GetRow(j, columns);
      }
    }
    // The halves of a double wedge share the voxels on the line of intersection: count them once.
    if (!parts[0].IsEmpty() && !parts[1].IsEmpty() && parts[0].First <= parts[1].Last &&
      parts[1].First <= parts[0].Last)
    {
      parts[0] = { std::min(parts[0].First, parts[1].First),
        std::max(parts[0].Last, parts[1].Last) };
      parts[1] = {};
    }
    if (parts[0].IsEmpty() && parts[1].IsEmpty())
    {
      continue;
    }
    const auto row = static_cast<double>(j);
    const Lines first(pair.GetFirstFunctions(), row, static_cast<double>(k));
    const Lines second(pair.GetSecondFunctions(), row, static_cast<double>(k));
    VoxelType* const start = corner + (j - rows.First) * strides[jAxis];
    for (const IndexInterval& part : parts)
    {
      VoxelType* const voxel = start + (part.First - columns.First) * strides[iAxis];
      if (hasFans)
      {
        FillLineInFans<Sampler>(pair, first, second, put, part, voxel, strides[iAxis]);
      }
      else
      {
        FillLine<Sampler>(
          firstRaster, secondRaster, first, second, put, part, voxel, strides[iAxis]);
      }
    }
  }
}

template <class T, class Real>
void FillLayerOf(const SlicePair& pair, std::int64_t k, PixelSampling sampling,
  Compounding compounding, VoxelBlock<Voxel<Real>>& voxels)
{
  const auto fill = [&](auto compounded)
  {
    using Put = PutCentre<decltype(compounded)::value>;
    switch (sampling)
    {
      case PixelSampling::Footprint:
        // its rasters are always of type Real
        return FillLayer<Real, SampleFootprint, Put>(pair, k, voxels);
      case PixelSampling::Bilinear:
        return FillLayer<T, SampleBilinearly, Put>(pair, k, voxels);
      case PixelSampling::Nearest:
        return FillLayer<T, SampleNearest, Put>(pair, k, voxels);
    }
  };
  if (compounding == Compounding::Mean)
  {
    fill(std::integral_constant<Compounding, Compounding::Mean>{});
  }
  else
  {
    fill(std::integral_constant<Compounding, Compounding::Maximum>{});
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
  const IndexInterval rows = layer.GetRows();
  for (std::int64_t j = rows.First; j <= rows.Last; ++j)
  {
    const IndexInterval columns = layer.GetRow(j, { 0, slice.Width - 1 });
    const FanMask::Runs runs =
      slice.Fan ? slice.Fan->GetRuns(j) : FanMask::Runs{ &columns, &columns + 1 };
    const T* const line = pixels + slice.RowStride * j;
    std::array<Line, 3> along;
    for (int a = 0; a < 3; ++a)
    {
      along[a] = { index[a].C + index[a].J * static_cast<double>(j), index[a].I };
    }
    const auto put = [&](std::int64_t i)
    {
      std::array<std::int64_t, 3> v;
      bool inside = true;
      for (int a = 0; a < 3; ++a)
      {
        v[a] = RoundPositive(along[a].At(static_cast<double>(i)));
        inside &= v[a] >= range[a].First && v[a] <= range[a].Last;
      }
      if (inside)
      {
        voxels
          .GetData()[(v[2] - extent[4]) * layerSize + (v[1] - extent[2]) * lineSize +
            (v[0] - extent[0])]
          .template Put<compounding>(static_cast<Real>(line[i]));
      }
    };
    for (const IndexInterval& run : runs)
    {
      const std::int64_t last = std::min(run.Last, columns.Last);
      for (std::int64_t i = std::max(run.First, columns.First); i <= last; ++i)
      {
        put(i);
      }
    }
  }
}
}

template <class Real>
void FillBetween(const SlicePair& pair, std::int64_t k, PixelSampling sampling,
  Compounding compounding, VoxelBlock<Voxel<Real>>& voxels)
{
  if constexpr (std::is_same<Real, double>::value)
  {
    FillLayerOf<double>(pair, k, sampling, compounding, voxels);
  }
  else
  {
    switch (pair.GetFirst().Type)
    {
      case ScalarType::UInt8:
        return FillLayerOf<std::uint8_t>(pair, k, sampling, compounding, voxels);
      case ScalarType::Int16:
        return FillLayerOf<std::int16_t>(pair, k, sampling, compounding, voxels);
      case ScalarType::UInt16:
        return FillLayerOf<std::uint16_t>(pair, k, sampling, compounding, voxels);
      default:
        return FillLayerOf<float>(pair, k, sampling, compounding, voxels);
    }
  }
}

template <class Real>
void FillAcross(const SlicePair& pair, std::int64_t k, VoxelBlock<WeightedVoxel<Real>>& voxels)
{
  FillLayer<Real, SampleFootprint, PutHeight>(pair, k, voxels);
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

template void FillBetween(
  const SlicePair&, std::int64_t, PixelSampling, Compounding, VoxelBlock<Voxel<float>>&);
template void FillBetween(
  const SlicePair&, std::int64_t, PixelSampling, Compounding, VoxelBlock<Voxel<double>>&);
template void FillAcross(const SlicePair&, std::int64_t, VoxelBlock<WeightedVoxel<float>>&);
template void FillAcross(const SlicePair&, std::int64_t, VoxelBlock<WeightedVoxel<double>>&);
template void PutPixels(
  const SliceImage&, const VolumeGrid&, IndexInterval, Compounding, VoxelBlock<Voxel<float>>&);
template void PutPixels(
  const SliceImage&, const VolumeGrid&, IndexInterval, Compounding, VoxelBlock<Voxel<double>>&);
}
