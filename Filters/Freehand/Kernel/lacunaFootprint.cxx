// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFootprint.h"

#include "lacunaWide.h"

#include <algorithm>
#include <cmath>

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
}
