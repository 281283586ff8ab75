// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFieldBounds.h"

#include "lacunaWide.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <type_traits>

namespace lacuna
{
namespace
{
constexpr int FineShift = 2;
constexpr int CoarseShift = 4;

template <class T>
constexpr T Lowest()
{
  return std::is_floating_point<T>::value ? -std::numeric_limits<T>::infinity()
                                          : std::numeric_limits<T>::lowest();
}

template <class T>
constexpr T Highest()
{
  return std::is_floating_point<T>::value ? std::numeric_limits<T>::infinity()
                                          : std::numeric_limits<T>::max();
}

/// Widens low[x]..high[x] by four rows. Plain loops, so that the compiler vectorises them.
template <class T>
LACUNA_INLINE void AccumulateFour(
  const std::array<const T*, 4>& rows, int n, T* __restrict low, T* __restrict high)
{
  const auto lesser = [](T a, T b) { return a < b ? a : b; };
  const auto greater = [](T a, T b) { return a > b ? a : b; };
  const T* a = rows[0];
  const T* b = rows[1];
  const T* c = rows[2];
  const T* d = rows[3];
  for (int x = 0; x < n; ++x)
  {
    low[x] = lesser(low[x], lesser(lesser(a[x], b[x]), lesser(c[x], d[x])));
    high[x] = greater(high[x], greater(greater(a[x], b[x]), greater(c[x], d[x])));
  }
}

template <class T>
void AccumulateFinite(
  const std::array<const T*, 4>& rows, int n, T* __restrict low, T* __restrict high)
{
  AccumulateFour(rows, n, low, high);
}

// the types that scanners and the spline filter write
LACUNA_WIDE void AccumulateFinite(const std::array<const std::int16_t*, 4>& rows, int n,
  std::int16_t* __restrict low, std::int16_t* __restrict high)
{
  AccumulateFour(rows, n, low, high);
}

LACUNA_WIDE void AccumulateFinite(
  const std::array<const float*, 4>& rows, int n, float* __restrict low, float* __restrict high)
{
  AccumulateFour(rows, n, low, high);
}

/// The same; guard: voxels that are not finite bound nothing.
template <class T>
void Accumulate(
  const std::array<const T*, 4>& rows, int n, bool guard, T* __restrict low, T* __restrict high)
{
  if constexpr (std::is_floating_point<T>::value)
  {
    if (guard)
    {
      for (const T* row : rows)
      {
        for (int x = 0; x < n; ++x)
        {
          const bool finite = std::isfinite(row[x]);
          low[x] = std::min(low[x], finite ? row[x] : Lowest<T>());
          high[x] = std::max(high[x], finite ? row[x] : Highest<T>());
        }
      }
      return;
    }
  }
  AccumulateFinite(rows, n, low, high);
}

/// Each element becomes the choice among width elements from it on; the last ones are used up.
template <class T, class Choose>
void Slide(std::vector<T>& line, int width, const Choose& choose)
{
  T* p = line.data();
  const std::size_t n = line.size();
  for (int done = 1; done < width;)
  {
    const int step = std::min(done, width - done);
    const T* q = p + step;
    for (std::size_t x = 0; x + step < n; ++x)
    {
      p[x] = choose(p[x], q[x]);
    }
    done += step;
  }
}

std::array<int, 3> CountBlocks(const std::array<int, 3>& size, int shift)
{
  std::array<int, 3> blocks;
  for (int a = 0; a < 3; ++a)
  {
    blocks[a] = (size[a] - 2 + (1 << shift)) >> shift; // size - 1 cells, rounded up
  }
  return blocks;
}

/// Voxels in the support of a block of cells, inside the volume.
struct Reach
{
  int First;
  int Last;
  Reach(int block, int shift, int size, int before, int after)
    : First(std::max(0, (block << shift) - before))
    , Last(std::min(size - 1, ((block + 1) << shift) - 1 + after))
  {
  }
};
}

template <class T>
FieldBounds<T>::FieldBounds(
  const T* voxels, const std::array<int, 3>& size, int before, int after, Execution& execution)
{
  this->FindRange(voxels, size, execution);
  this->Build(voxels, size, before, after, execution);
  if constexpr (std::is_integral<T>::value)
  {
    T low = Highest<T>();
    T high = Lowest<T>();
    for (std::size_t b = 0; b < this->Coarse.Bounds.size(); b += 2)
    {
      low = std::min(low, this->Coarse.Bounds[b]);
      high = std::max(high, this->Coarse.Bounds[b + 1]);
    }
    this->Minimum = static_cast<double>(low);
    this->Maximum = static_cast<double>(high);
  }
}

template <class T>
void FieldBounds<T>::FindRange(
  const T* voxels, const std::array<int, 3>& size, Execution& execution)
{
  this->Minimum = std::numeric_limits<double>::infinity();
  this->Maximum = -std::numeric_limits<double>::infinity();
  if constexpr (std::is_floating_point<T>::value)
  {
    const std::int64_t slice = static_cast<std::int64_t>(size[0]) * size[1];
    std::mutex mutex;
    execution.For(size[2], 1,
      [&](std::int64_t begin, std::int64_t end)
      {
        T low = Highest<T>();
        T high = Lowest<T>();
        std::int64_t count = 0;
        for (std::int64_t i = begin * slice; i < end * slice; ++i)
        {
          const T v = voxels[i];
          const bool finite = std::isfinite(v);
          count += !finite;
          low = finite && v < low ? v : low;
          high = finite && v > high ? v : high;
        }
        const std::lock_guard<std::mutex> lock(mutex);
        this->NumberOfNonFinite += count;
        this->Minimum = std::min(this->Minimum, static_cast<double>(low));
        this->Maximum = std::max(this->Maximum, static_cast<double>(high));
      });
  }
}

template <class T>
void FieldBounds<T>::Build(
  const T* voxels, const std::array<int, 3>& size, int before, int after, Execution& execution)
{
  Level& level = this->Fine;
  level.Shift = FineShift;
  level.Blocks = CountBlocks(size, FineShift);
  level.Bounds.resize(level.IndexOf(0, 0, level.Blocks[2]));
  constexpr int step = CoarseShift - FineShift;
  this->Coarse.Shift = CoarseShift;
  this->Coarse.Blocks = CountBlocks(size, CoarseShift);
  this->Coarse.Bounds.resize(this->Coarse.IndexOf(0, 0, this->Coarse.Blocks[2]));
  // Who builds the last layer of blocks in a coarse one builds that too.
  std::vector<std::atomic<int>> built(this->Coarse.Blocks[2]);
  const bool guard = this->NumberOfNonFinite > 0;
  execution.For(level.Blocks[2], 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      const int width = (1 << FineShift) + before + after;
      // voxel x is element x + before; those beyond the volume do not count
      const std::size_t length = (static_cast<std::size_t>(level.Blocks[0]) << FineShift) + width;
      std::vector<T> low(length);
      std::vector<T> high(length);
      // the bounds of a block's rows of voxels over the slices of its support; row y is number
      // y % Ring, and stays for the next block
      constexpr int ring = 8;
      const std::size_t row = size[0];
      std::vector<T> lows(ring * row);
      std::vector<T> highs(ring * row);
      const auto fold = [&](const T* first, std::int64_t stride, int count, T* l, T* h)
      {
        for (int n = 0; n < count; n += 4)
        {
          std::array<const T*, 4> rows;
          for (int m = 0; m < 4; ++m)
          {
            rows[m] = first + std::min(n + m, count - 1) * stride;
          }
          Accumulate(rows, size[0], guard, l, h);
        }
      };
      for (int k = static_cast<int>(begin); k < end; ++k)
      {
        const Reach rz(k, FineShift, size[2], before, after);
        int folded = 0; // rows before this one
        for (int j = 0; j < level.Blocks[1]; ++j)
        {
          const Reach ry(j, FineShift, size[1], before, after);
          for (; folded <= ry.Last; ++folded)
          {
            T* l = lows.data() + folded % ring * row;
            T* h = highs.data() + folded % ring * row;
            std::fill_n(l, row, Highest<T>());
            std::fill_n(h, row, Lowest<T>());
            fold(voxels + (static_cast<std::int64_t>(rz.First) * size[1] + folded) * size[0],
              static_cast<std::int64_t>(size[0]) * size[1], rz.Last - rz.First + 1, l, h);
          }
          std::fill(low.begin(), low.end(), Highest<T>());
          std::fill(high.begin(), high.end(), Lowest<T>());
          for (int y = ry.First; y <= ry.Last; ++y)
          {
            const T* l = lows.data() + y % ring * row;
            const T* h = highs.data() + y % ring * row;
            for (std::size_t x = 0; x < row; ++x)
            {
              low[before + x] = l[x] < low[before + x] ? l[x] : low[before + x];
              high[before + x] = h[x] > high[before + x] ? h[x] : high[before + x];
            }
          }
          Slide(low, width, [](T a, T b) { return a < b ? a : b; });
          Slide(high, width, [](T a, T b) { return a > b ? a : b; });
          T* bounds = level.Bounds.data() + level.IndexOf(0, j, k);
          for (int i = 0; i < level.Blocks[0]; ++i)
          {
            bounds[2 * i] = low[i << FineShift];
            bounds[2 * i + 1] = high[i << FineShift];
          }
        }
        const int layer = k >> step;
        const int layers = std::min(1 << step, level.Blocks[2] - (layer << step));
        if (++built[layer] == layers)
        {
          this->BuildCoarse(layer);
        }
      }
    });
}

template <class T>
void FieldBounds<T>::BuildCoarse(int layer)
{
  Level& level = this->Coarse;
  constexpr int step = CoarseShift - FineShift;
  for (std::size_t b = level.IndexOf(0, 0, layer); b < level.IndexOf(0, 0, layer + 1); b += 2)
  {
    level.Bounds[b] = Highest<T>();
    level.Bounds[b + 1] = Lowest<T>();
  }
  for (int k = layer << step; k < std::min((layer + 1) << step, this->Fine.Blocks[2]); ++k)
  {
    for (int j = 0; j < this->Fine.Blocks[1]; ++j)
    {
      for (int i = 0; i < this->Fine.Blocks[0]; ++i)
      {
        const T* fine = this->Fine.Bounds.data() + this->Fine.IndexOf(i, j, k);
        T* coarse = level.Bounds.data() + level.IndexOf(i >> step, j >> step, layer);
        coarse[0] = std::min(coarse[0], fine[0]);
        coarse[1] = std::max(coarse[1], fine[1]);
      }
    }
  }
}

template class FieldBounds<std::int8_t>;
template class FieldBounds<std::uint8_t>;
template class FieldBounds<std::int16_t>;
template class FieldBounds<std::uint16_t>;
template class FieldBounds<std::int32_t>;
template class FieldBounds<std::uint32_t>;
template class FieldBounds<std::int64_t>;
template class FieldBounds<std::uint64_t>;
template class FieldBounds<float>;
template class FieldBounds<double>;
}
