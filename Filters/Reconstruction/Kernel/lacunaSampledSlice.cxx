// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSampledSlice.h"

#include "lacunaWide.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

namespace lacuna
{
namespace
{
// Finer rasters come closer to an even mean, and cost their square. 2 halves an aliasing
// frequency's remainder already to what the box itself leaves.
constexpr double SamplesPerFootprint = 2;
// Only images smaller than a voxel would ask for more.
constexpr int MostSamplesOutside = 8;
// Lines reduced together, so that the inner loops run over neighbouring values.
constexpr int BlockSize = 8;

// Integral of the linear interpolation kernel (a hat of width 2) up to t.
double HatIntegral(double t)
{
  if (t <= -1)
  {
    return 0;
  }
  if (t >= 1)
  {
    return 1;
  }
  return t < 0 ? 0.5 * (1 + t) * (1 + t) : 1 - 0.5 * (1 - t) * (1 - t);
}

// Mean over [x - half, x + half] of the hat around pixel q.
double HatMean(double x, double half, int q)
{
  if (half < 1e-6)
  {
    return std::max(0.0, 1 - std::abs(x - q));
  }
  return (HatIntegral(x + half - q) - HatIntegral(x - half - q)) / (2 * half);
}
}

FootprintAxis::FootprintAxis(int n, double width)
{
  const double length = n - 1;
  width = std::min(width, 4.0 * n); // wider ones have the same mean
  int steps = n - 1;
  double box = 0;
  if (width > std::sqrt(2.0))
  {
    const double wanted = std::max(1.0, width / SamplesPerFootprint);
    steps = std::max(1, static_cast<int>(std::min(length, std::ceil(length / wanted - 1e-9))));
    this->Step = length / steps;
    box = std::sqrt(std::max(0.0, width * width - 2 * this->Step * this->Step));
  }
  this->Taps = box > 0 ? std::min(n, static_cast<int>(std::ceil(box)) + 2) : 1;
  this->Starts.resize(steps + 1);
  this->Weights.assign(static_cast<std::size_t>(steps + 1) * this->Taps, 0.0);
  for (int i = 0; i <= steps; ++i)
  {
    const double x = std::min(length, i * this->Step);
    const double half = std::min({ box / 2, x, length - x });
    const int start = std::clamp(static_cast<int>(std::floor(x - half)), 0, n - this->Taps);
    this->Starts[i] = start;
    double* weights = this->Weights.data() + static_cast<std::size_t>(this->Taps) * i;
    for (int t = 0; t < this->Taps; ++t)
    {
      weights[t] = HatMean(x, half, start + t);
    }
  }
}

double FootprintAxis::GetMargin(double voxelWidth) const
{
  return std::min(0.5 + voxelWidth / 2, MostSamplesOutside * this->Step);
}

int FootprintAxis::GetNumberOfSamplesOutside(double voxelWidth) const
{
  return static_cast<int>(std::ceil(this->GetMargin(voxelWidth) / this->Step - 1e-9));
}

namespace
{
// line = sum of count lines from pixels, weighted. A few lines at a time: the compiler turns the
// inner loops into vector code.
template <class T, class Real>
LACUNA_WIDE void WeighLines(
  const T* pixels, std::int64_t rowStride, int width, const double* weights, int count, Real* line)
{
  int t = 0;
  const auto w = [&](int i) { return static_cast<Real>(weights[i]); };
  const auto row = [&](int i) { return pixels + rowStride * i; };
  if (count >= 4)
  {
    const T *p0 = row(0), *p1 = row(1), *p2 = row(2), *p3 = row(3);
    const Real w0 = w(0), w1 = w(1), w2 = w(2), w3 = w(3);
    for (int x = 0; x < width; ++x)
    {
      line[x] = w0 * static_cast<Real>(p0[x]) + w1 * static_cast<Real>(p1[x]) +
        w2 * static_cast<Real>(p2[x]) + w3 * static_cast<Real>(p3[x]);
    }
    t = 4;
  }
  else
  {
    const T* p0 = row(0);
    const Real w0 = w(0);
    for (int x = 0; x < width; ++x)
    {
      line[x] = w0 * static_cast<Real>(p0[x]);
    }
    t = 1;
  }
  for (; t + 2 <= count; t += 2)
  {
    const T *p0 = row(t), *p1 = row(t + 1);
    const Real w0 = w(t), w1 = w(t + 1);
    for (int x = 0; x < width; ++x)
    {
      line[x] += w0 * static_cast<Real>(p0[x]) + w1 * static_cast<Real>(p1[x]);
    }
  }
  for (; t < count; ++t)
  {
    const T* p0 = row(t);
    const Real w0 = w(t);
    for (int x = 0; x < width; ++x)
    {
      line[x] += w0 * static_cast<Real>(p0[x]);
    }
  }
}

// weighRows(i, width, line) makes line i of the raster, still with all columns.
template <class Real, class WeighRows>
void Reduce(const FootprintAxis& columns, const FootprintAxis& rows, const WeighRows& weighRows,
  Real* means, std::int64_t meanStride)
{
  const int lastColumn = columns.GetNumberOfSamples() - 1;
  const int width = columns.GetStart(lastColumn) + columns.GetNumberOfTaps();
  const int numberOfLines = rows.GetNumberOfSamples();
  std::vector<Real> line(width);
  std::vector<Real> block(static_cast<std::size_t>(width) * BlockSize);
  for (int first = 0; first < numberOfLines; first += BlockSize)
  {
    const int lines = std::min(BlockSize, numberOfLines - first);
    for (int l = 0; l < lines; ++l)
    {
      weighRows(first + l, width, line.data());
      for (int x = 0; x < width; ++x)
      {
        block[static_cast<std::size_t>(x) * BlockSize + l] = line[x];
      }
    }
    for (int i = 0; i <= lastColumn; ++i)
    {
      const Real* source = block.data() + static_cast<std::size_t>(columns.GetStart(i)) * BlockSize;
      const double* weights = columns.GetWeights(i);
      Real sum[BlockSize] = {};
      for (int t = 0; t < columns.GetNumberOfTaps(); ++t)
      {
        const auto weight = static_cast<Real>(weights[t]);
        for (int l = 0; l < BlockSize; ++l)
        {
          sum[l] += weight * source[t * BlockSize + l];
        }
      }
      for (int l = 0; l < lines; ++l)
      {
        means[(first + l) * meanStride + i] = sum[l];
      }
    }
  }
}

// line = weighted sum of value(row, column) over the pixels of line i of the raster in the fan.
template <class Real, class Value>
void WeighRuns(
  const FootprintAxis& rows, int i, const FanMask& fan, int width, Real* line, const Value& value)
{
  std::fill(line, line + width, Real(0));
  for (int t = 0; t < rows.GetNumberOfTaps(); ++t)
  {
    const int row = rows.GetStart(i) + t;
    const auto weight = static_cast<Real>(rows.GetWeights(i)[t]);
    if (weight == 0)
    {
      continue;
    }
    for (const IndexInterval& run : fan.GetRuns(row))
    {
      const auto last = static_cast<int>(std::min<std::int64_t>(run.Last, width - 1));
      for (auto x = static_cast<int>(run.First); x <= last; ++x)
      {
        line[x] += weight * value(row, x);
      }
    }
  }
}
}

template <class T, class Real>
void AverageFootprints(const T* pixels, std::int64_t rowStride, const FootprintAxis& columns,
  const FootprintAxis& rows, Real* means, std::int64_t meanStride)
{
  Reduce(
    columns, rows,
    [&](int i, int width, Real* line)
    {
      WeighLines(pixels + rowStride * rows.GetStart(i), rowStride, width, rows.GetWeights(i),
        rows.GetNumberOfTaps(), line);
    },
    means, meanStride);
}

template <class T, class Real>
void AverageFootprintsInFan(const T* pixels, std::int64_t rowStride, const FootprintAxis& columns,
  const FootprintAxis& rows, const FanMask& fan, Real* sums, Real* weights, std::int64_t meanStride)
{
  Reduce(
    columns, rows,
    [&](int i, int width, Real* line)
    {
      WeighRuns(rows, i, fan, width, line,
        [=](int row, int x) { return static_cast<Real>(pixels[rowStride * row + x]); });
    },
    sums, meanStride);
  Reduce(
    columns, rows,
    [&](int i, int width, Real* line)
    { WeighRuns(rows, i, fan, width, line, [](int, int) { return Real(1); }); },
    weights, meanStride);
}

namespace
{
// The slope that leads on from a, b, c to what comes before them.
template <class Real>
Real GetSlope(Real a, Real b, Real c)
{
  const Real last = a - b;
  const Real before = b - c;
  return last * before > 0 ? (std::abs(last) < std::abs(before) ? last : before) : 0;
}

// Goes on from one border of a raster's inner part: lines, stride apart, each by steps values.
// inside leads from a value of the border to its inner neighbour.
struct Border
{
  std::int64_t Start, Stride, Inside;
  int Lines, Steps;
  std::int64_t Third; ///< from a value of the border to the third one
};

template <class Real>
void Continue(Real* raster, Real* weights, const Border& border)
{
  const std::int64_t second = border.Inside;
  const std::int64_t third = border.Third;
  for (int n = 0; n < border.Lines; ++n)
  {
    Real* const v = raster + border.Start + n * border.Stride;
    Real* const w = weights ? weights + border.Start + n * border.Stride : nullptr;
    Real slope = 0;
    if (!w)
    {
      slope = GetSlope(v[0], v[second], v[third]);
    }
    else if (w[0] > 0 && w[second] > 0 && w[third] > 0)
    {
      slope = w[0] * GetSlope(v[0] / w[0], v[second] / w[second], v[third] / w[third]);
    }
    for (int i = 1; i <= border.Steps; ++i)
    {
      v[-i * second] = v[0] + static_cast<Real>(i) * slope;
      if (w)
      {
        w[-i * second] = w[0];
      }
    }
  }
}
}

template <class Real>
void ContinueRaster(
  Real* raster, Real* weights, int width, int height, int columnsOutside, int rowsOutside)
{
  const std::int64_t down = width;
  const int columns = width - 2 * columnsOutside;
  const int rows = height - 2 * rowsOutside;
  // two samples have but one difference: the third is the second one, and there is no slope
  const int thirdColumn = std::min(columns, 3) - 1;
  const std::int64_t thirdRow = (std::min(rows, 3) - 1) * down;
  const std::int64_t corner = rowsOutside * down + columnsOutside;
  Continue(raster, weights, { corner, down, 1, rows, columnsOutside, thirdColumn });
  Continue(raster, weights, { corner + columns - 1, down, -1, rows, columnsOutside, -thirdColumn });
  const std::int64_t top = rowsOutside * down;
  Continue(raster, weights, { top, 1, down, width, rowsOutside, thirdRow });
  Continue(raster, weights, { top + (rows - 1) * down, 1, -down, width, rowsOutside, -thirdRow });
}

template void ContinueRaster(float*, float*, int, int, int, int);
template void ContinueRaster(double*, double*, int, int, int, int);

// NOLINTBEGIN(bugprone-macro-parentheses): types
#define LACUNA_INSTANTIATE(T, Real)                                                                \
  template void AverageFootprints(                                                                 \
    const T*, std::int64_t, const FootprintAxis&, const FootprintAxis&, Real*, std::int64_t);      \
  template void AverageFootprintsInFan(const T*, std::int64_t, const FootprintAxis&,               \
    const FootprintAxis&, const FanMask&, Real*, Real*, std::int64_t)
LACUNA_INSTANTIATE(std::int8_t, float);
LACUNA_INSTANTIATE(std::uint8_t, float);
LACUNA_INSTANTIATE(std::int16_t, float);
LACUNA_INSTANTIATE(std::uint16_t, float);
LACUNA_INSTANTIATE(float, float);
LACUNA_INSTANTIATE(std::int8_t, double);
LACUNA_INSTANTIATE(std::uint8_t, double);
LACUNA_INSTANTIATE(std::int16_t, double);
LACUNA_INSTANTIATE(std::uint16_t, double);
LACUNA_INSTANTIATE(std::int32_t, double);
LACUNA_INSTANTIATE(std::uint32_t, double);
LACUNA_INSTANTIATE(std::int64_t, double);
LACUNA_INSTANTIATE(std::uint64_t, double);
LACUNA_INSTANTIATE(float, double);
LACUNA_INSTANTIATE(double, double);
#undef LACUNA_INSTANTIATE
// NOLINTEND(bugprone-macro-parentheses)

//------------------------------------------------------------------------------
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

// Column, row and distance of a voxel as functions of its indices; throws where numbers cannot say them.
void SetFunctions(
  const SliceImage& slice, const VolumeGrid& grid, double footprintScale, SampledSlice& sampled)
{
  const Vec3 x = slice.PixelToReference.Column(0);
  const Vec3 y = slice.PixelToReference.Column(1);
  const Vec3 origin = slice.PixelToReference.Column(3);
  const Vec3 area = Cross(x, y);
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
  SampledSlice sampled;
  sampled.Label = slice.Label;
  SetFunctions(slice, grid, footprintScale, sampled);
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
