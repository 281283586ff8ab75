// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVoxelFilling.h"

#include "lacunaWide.h"

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

// Voxels of a line that are worked on at a time. First comes what can be computed side by side, by
// vectors: where their feet lie and what weighs how much; then grey levels are read and put.
constexpr int VoxelsAtATime = 64;

// Where feet lie in a raster: the pixel, and the way to its right and lower neighbours.
template <class Real>
struct Feet
{
  std::array<std::int32_t, VoxelsAtATime> Columns, Rows;
  std::array<Real, VoxelsAtATime> X, Y;
};

// Positions lie on the raster but for the tolerance of SlicePair: a truncated one is in range, or
// one too far. last: the last pixel that has a neighbour.
template <class T, class Real>
struct SampleFootprint
{
  LACUNA_INLINE static void Place(double position, int last, std::int32_t& pixel, Real& way)
  {
    const int p = std::min(static_cast<int>(position), last);
    pixel = p;
    way = static_cast<Real>(position - p);
  }
  static Real Read(const Raster<T>& raster, std::int32_t column, std::int32_t row, Real x, Real y)
  {
    const T* const p = raster.Pixels + (raster.RowStride * row + column);
    const T* const q = p + raster.RowStride;
    const Real upper = static_cast<Real>(p[0]) + x * static_cast<Real>(p[1] - p[0]);
    const Real lower = static_cast<Real>(q[0]) + x * static_cast<Real>(q[1] - q[0]);
    return upper + y * (lower - upper);
  }
};

// Outside of the outermost pixel centres their grey level goes on.
template <class T, class Real>
struct SampleBilinearly : SampleFootprint<T, Real>
{
  LACUNA_INLINE static void Place(double position, int last, std::int32_t& pixel, Real& way)
  {
    SampleFootprint<T, Real>::Place(
      std::min(std::max(position, 0.0), last + 1.0), last, pixel, way);
  }
};

// The nearest whole number of one that is at least -0.5 but for a tolerance.
LACUNA_INLINE int RoundPositive(double x)
{
  return static_cast<int>(x + 0.5);
}

template <class T, class Real>
struct SampleNearest
{
  LACUNA_INLINE static void Place(double position, int last, std::int32_t& pixel, Real& way)
  {
    pixel = std::min(RoundPositive(position), last + 1);
    way = 0;
  }
  static Real Read(const Raster<T>& raster, std::int32_t column, std::int32_t row, Real, Real)
  {
    return static_cast<Real>(raster.Pixels[raster.RowStride * row + column]);
  }
};

// Grey level at one position.
template <class Sampler, class T, class Real>
Real Sample(const Raster<T>& raster, double column, double row)
{
  std::int32_t c;
  std::int32_t r;
  Real x;
  Real y;
  Sampler::Place(column, raster.LastColumn, c, x);
  Sampler::Place(row, raster.LastRow, r, y);
  return Sampler::Read(raster, c, r, x, y);
}

// A quantity along one line of voxels.
struct Line
{
  double Start, Step;
  LACUNA_INLINE double At(double i) const { return this->Start + this->Step * i; }
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

// Everything is computed from the voxel's own index, not from its predecessor, so that it does not
// matter where a piece of the volume begins.
template <class Sampler, class Real>
LACUNA_WIDE void FindFeet(
  Line column, Line row, int lastColumn, int lastRow, int first, int count, Feet<Real>& feet)
{
  for (int n = 0; n < count; ++n)
  {
    Sampler::Place(
      column.At(static_cast<double>(first + n)), lastColumn, feet.Columns[n], feet.X[n]);
  }
  for (int n = 0; n < count; ++n)
  {
    Sampler::Place(row.At(static_cast<double>(first + n)), lastRow, feet.Rows[n], feet.Y[n]);
  }
}

// What the sample of a voxel is made of, whose feet have the grey levels x and y: x + Weight (y -
// x).
struct Share
{
  double Weight;
  double Length;    ///< mm of the voxel's height; 0 for nothing
  bool HoldsCentre; ///< the voxel's centre lies between the slices
};

// part / gap, or a half where slices intersect. Without branches, for vectors.
LACUNA_INLINE double Divide(double part, double gap, double tolerance)
{
  const bool isGap = std::abs(gap) > tolerance;
  return (isGap ? part : 0.5) / (isGap ? gap : 1);
}

// Puts what the voxel's centre has. first and second: its signed distances from the slices.
template <Compounding compounding>
struct PutCentre
{
  explicit PutCentre(const SlicePair& pair)
    : Tolerance(pair.GetTolerance())
  {
  }
  LACUNA_INLINE Share GetShare(double first, double second) const
  {
    const double a = std::abs(first);
    const double gap = a + std::abs(second);
    return { Divide(a, gap, this->Tolerance), 1, true };
  }
  template <class Real>
  void operator()(Voxel<Real>& voxel, Real x, Real y, Real weight, float, bool) const
  {
    voxel.template Put<compounding>(x + weight * (y - x));
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
  LACUNA_INLINE Share GetShare(double first, double second) const
  {
    // along the normal, from the voxel's centre: the slices lie at -first and -second
    const double begin = std::max(std::min(-first, -second), -this->HalfHeight);
    const double end = std::min(std::max(-first, -second), this->HalfHeight);
    const bool holdsCentre = std::min(this->Tolerance - begin, end + this->Tolerance) >= 0;
    const double length = std::max(end - begin, holdsCentre ? this->Tolerance : 0.0);
    // grey levels are linear between the slices: their mean is that in the middle
    const double weight = Divide(0.5 * (begin + end) + first, first - second, this->Tolerance);
    return { weight, length, holdsCentre };
  }
  template <class Real>
  void operator()(
    WeightedVoxel<Real>& voxel, Real x, Real y, Real weight, float length, bool holdsCentre) const
  {
    if (length > 0) // else grey levels that are no numbers would still count
    {
      voxel.Put(x + weight * (y - x), length, holdsCentre);
    }
  }
  double HalfHeight;
  double Tolerance;
};

template <class Real>
struct Shares
{
  std::array<Real, VoxelsAtATime> Weights;
  std::array<float, VoxelsAtATime> Lengths;
  std::array<std::int32_t, VoxelsAtATime> HoldCentre;
};

template <class Put, class Real>
LACUNA_WIDE void FindShares(
  Put put, Line toFirst, Line toSecond, int first, int count, Shares<Real>& shares)
{
  for (int n = 0; n < count; ++n)
  {
    const auto i = static_cast<double>(first + n);
    const Share share = put.GetShare(toFirst.At(i), toSecond.At(i));
    shares.Weights[n] = static_cast<Real>(share.Weight);
    shares.Lengths[n] = static_cast<float>(share.Length);
    shares.HoldCentre[n] = share.HoldsCentre ? 1 : 0;
  }
}

// Voxels first..last of a line.
template <template <class, class> class Sampler, class T, class Put, class VoxelType>
void FillLine(const Raster<T>& firstRaster, const Raster<T>& secondRaster, const Lines& first,
  const Lines& second, const Put& put, IndexInterval interval, VoxelType* voxel,
  std::int64_t stride)
{
  using Real = decltype(voxel->Value);
  using Sample = Sampler<T, Real>;
  Feet<Real> a;
  Feet<Real> b;
  Shares<Real> shares;
  while (!interval.IsEmpty())
  {
    const auto begin = static_cast<int>(interval.First);
    const auto count =
      static_cast<int>(std::min<std::int64_t>(interval.Last - interval.First + 1, VoxelsAtATime));
    FindFeet<Sample>(
      first.Column, first.Row, firstRaster.LastColumn, firstRaster.LastRow, begin, count, a);
    FindFeet<Sample>(
      second.Column, second.Row, secondRaster.LastColumn, secondRaster.LastRow, begin, count, b);
    FindShares(put, first.Distance, second.Distance, begin, count, shares);
    for (int n = 0; n < count; ++n, voxel += stride)
    {
      const Real x = Sample::Read(firstRaster, a.Columns[n], a.Rows[n], a.X[n], a.Y[n]);
      const Real y = Sample::Read(secondRaster, b.Columns[n], b.Rows[n], b.X[n], b.Y[n]);
      put(*voxel, x, y, shares.Weights[n], shares.Lengths[n], shares.HoldCentre[n] != 0);
    }
    interval.First += count;
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
  const Real weight = Sample<Sampler<Real, Real>, Real, Real>(weights, column, row);
  if (!(weight > 0)) // a tip of the fan between the pixels
  {
    return false;
  }
  grey = Sample<Sampler<Real, Real>, Real, Real>(sums, column, row) / weight;
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
      const Share share = put.GetShare(first.Distance.At(i), second.Distance.At(i));
      put(*voxel, x, y, static_cast<Real>(share.Weight), static_cast<float>(share.Length),
        share.HoldsCentre);
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

template void FillBetween(
  const SlicePair&, std::int64_t, PixelSampling, Compounding, VoxelBlock<Voxel<float>>&);
template void FillBetween(
  const SlicePair&, std::int64_t, PixelSampling, Compounding, VoxelBlock<Voxel<double>>&);
template void FillAcross(const SlicePair&, std::int64_t, VoxelBlock<WeightedVoxel<float>>&);
template void FillAcross(const SlicePair&, std::int64_t, VoxelBlock<WeightedVoxel<double>>&);
}
