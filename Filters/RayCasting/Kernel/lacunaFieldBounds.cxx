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

template <class T>
struct Support
{
  const T* Voxels;
  std::array<int, 3> Size;
  int Before; ///< voxels that count for a cell, below its first one and above it
  int After;
  bool Guard; ///< voxels may be not finite
};

/// Finds the bounds of the fine blocks, layer by layer: first over the slices, then the rows, then
/// along them.
template <class T>
class LayerBuilder
{
public:
  using Level = typename FieldBounds<T>::Level;

  LayerBuilder(const Support<T>& support, Level& level)
    : Of(support)
    , To(level)
    , Width((1 << FineShift) + support.Before + support.After)
    , Row(support.Size[0])
    , Low((static_cast<std::size_t>(level.Blocks[0]) << FineShift) + this->Width)
    , High(this->Low.size())
    , Lows(Ring * this->Row)
    , Highs(Ring * this->Row)
  {
  }

  void Build(int k)
  {
    const Reach rz(k, FineShift, this->Of.Size[2], this->Of.Before, this->Of.After);
    int folded = 0; // rows before this one
    for (int j = 0; j < this->To.Blocks[1]; ++j)
    {
      const Reach ry(j, FineShift, this->Of.Size[1], this->Of.Before, this->Of.After);
      for (; folded <= ry.Last; ++folded)
      {
        this->FoldSlices(rz, folded);
      }
      this->FoldRows(ry);
      Slide(this->Low, this->Width, [](T a, T b) { return a < b ? a : b; });
      Slide(this->High, this->Width, [](T a, T b) { return a > b ? a : b; });
      T* bounds = this->To.Bounds.data() + this->To.IndexOf(0, j, k);
      for (int i = 0; i < this->To.Blocks[0]; ++i)
      {
        bounds[2 * i] = this->Low[i << FineShift];
        bounds[2 * i + 1] = this->High[i << FineShift];
      }
    }
  }

private:
  static constexpr int Ring = 8;

  void FoldSlices(const Reach& slices, int y)
  {
    const auto columns = static_cast<std::int64_t>(this->Of.Size[0]);
    const std::int64_t stride = columns * this->Of.Size[1];
    const T* first = this->Of.Voxels + slices.First * stride + y * columns;
    const int count = slices.Last - slices.First + 1;
    T* low = this->Lows.data() + y % Ring * this->Row;
    T* high = this->Highs.data() + y % Ring * this->Row;
    std::fill_n(low, this->Row, Highest<T>());
    std::fill_n(high, this->Row, Lowest<T>());
    for (int n = 0; n < count; n += 4)
    {
      std::array<const T*, 4> rows;
      for (int m = 0; m < 4; ++m)
      {
        rows[m] = first + std::min(n + m, count - 1) * stride;
      }
      Accumulate(rows, this->Of.Size[0], this->Of.Guard, low, high);
    }
  }

  void FoldRows(const Reach& rows)
  {
    std::fill(this->Low.begin(), this->Low.end(), Highest<T>());
    std::fill(this->High.begin(), this->High.end(), Lowest<T>());
    T* low = this->Low.data() + this->Of.Before;
    T* high = this->High.data() + this->Of.Before;
    const std::size_t n = this->Row;
    for (int y = rows.First; y <= rows.Last; ++y)
    {
      const T* l = this->Lows.data() + y % Ring * n;
      const T* h = this->Highs.data() + y % Ring * n;
      for (std::size_t x = 0; x < n; ++x)
      {
        low[x] = l[x] < low[x] ? l[x] : low[x];
        high[x] = h[x] > high[x] ? h[x] : high[x];
      }
    }
  }

  const Support<T>& Of;
  Level& To;
  int Width; ///< of the support of a block
  std::size_t Row;
  /// Voxel x is element x + Before; those beyond the volume do not count.
  std::vector<T> Low;
  std::vector<T> High;
  /// The bounds of a block's rows of voxels over the slices of its support; row y is number y % Ring, and
  /// stays for the next block.
  std::vector<T> Lows;
  std::vector<T> Highs;
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
  const Support<T> support{ voxels, size, before, after, this->NumberOfNonFinite > 0 };
  execution.For(level.Blocks[2], 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      LayerBuilder<T> builder(support, level);
      for (int k = static_cast<int>(begin); k < end; ++k)
      {
        builder.Build(k);
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
