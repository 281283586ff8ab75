// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Counts of levels in a box that slides over a RankTile, in constant time per sample.
///
/// For each window the table of all cumulative counts, #{samples <= level}, is kept. It is the sum
/// of the tables of the window's x positions ("planes"), so a step along x adds one plane and
/// takes one away; each plane is likewise a sum of columns along z; and a column changes by one
/// sample when z does. All of it is adding tables, which vectors do well, without a branch: the
/// cost depends neither on the window nor on the data. (The scheme of Perreault & Hebert 2007,
/// one dimension up, with cumulative instead of plain histograms so that a rank is found by
/// counting the levels not above it.)
#ifndef lacunaBoxSlide_h
#define lacunaBoxSlide_h

#include "lacunaRankTile.h"
#include "lacunaVectorUnit.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <type_traits>
#include <vector>

namespace lacuna
{
/// -128 ... 127: the levels 0 ... 255 for signed comparison.
alignas(64) inline constexpr std::array<std::int8_t, 256> LevelRamp = []
{
  std::array<std::int8_t, 256> ramp{};
  for (int i = 0; i < 256; ++i)
  {
    ramp[i] = static_cast<std::int8_t>(i - 128);
  }
  return ramp;
}();

/// Zeroed memory that begins at a cache line, so that no vector of a table straddles two.
template <class T>
class AlignedTable
{
public:
  explicit AlignedTable(std::size_t size)
    : Memory(size + Line / sizeof(T), T(0))
  {
    void* begin = this->Memory.data();
    std::size_t space = this->Memory.size() * sizeof(T);
    this->Begin = static_cast<T*>(std::align(Line, size * sizeof(T), begin, space));
  }
  T* data() { return this->Begin; }

private:
  static constexpr std::size_t Line = 64;
  std::vector<T> Memory;
  T* Begin;
};

/// counts += table, over a number of levels that is a multiple of the vectors' length.
template <int Bytes, class Count, class Plane>
LACUNA_INLINE void AddTable(Count* counts, const Plane* table, int levels)
{
  using Counts = typename Vector<Count, Bytes>::Type;
  constexpr int Lanes = Vector<Count, Bytes>::Lanes;
  using Planes = typename Vector<Plane, Lanes * sizeof(Plane)>::Type;
  for (int i = 0; i < levels; i += Lanes)
  {
    Planes a;
    Counts c;
    LoadVector(a, table + i);
    LoadVector(c, counts + i);
    c += __builtin_convertvector(a, Counts);
    StoreVector(counts + i, c);
  }
}

namespace detail
{
/// table[t] += [in <= t] - [out <= t], the latter only with TakeAway.
template <int Bytes, bool TakeAway, class T>
LACUNA_INLINE void ChangeTable(T* table, int levels, std::uint8_t in, std::uint8_t out)
{
  using Flags = typename Vector<std::int8_t, Bytes / sizeof(T)>::Type;
  using Table = typename Vector<T, Bytes>::Type;
  using Signed = typename Vector<std::make_signed_t<T>, Bytes>::Type;
  constexpr int Lanes = Vector<T, Bytes>::Lanes;
  const Flags inLevel = Flags{} + static_cast<std::int8_t>(in ^ 0x80);
  const Flags outLevel = Flags{} + static_cast<std::int8_t>(out ^ 0x80);
  for (int i = 0; i < levels; i += Lanes)
  {
    Flags level;
    LoadVector(level, LevelRamp.data() + i);
    Table c;
    LoadVector(c, table + i);
    // A comparison gives -1 where true: [in <= t] = 1 + (in > t).
    Flags change = (Flags)(inLevel > level);
    if constexpr (TakeAway)
    {
      change -= (Flags)(outLevel > level);
    }
    else
    {
      change += 1;
    }
    c += (Table) __builtin_convertvector(change, Signed);
    StoreVector(table + i, c);
  }
}
}

/// Counts one more sample.
template <int Bytes, class T>
LACUNA_INLINE void AddSample(T* table, int levels, std::uint8_t level)
{
  detail::ChangeTable<Bytes, false>(table, levels, level, 0);
}

/// Counts the sample in instead of the sample out.
template <int Bytes, class T>
LACUNA_INLINE void ExchangeSample(T* table, int levels, std::uint8_t in, std::uint8_t out)
{
  detail::ChangeTable<Bytes, true>(table, levels, in, out);
}

/// Sum of the lanes of a vector whose lanes are small and not negative.
template <class T, int Bytes>
LACUNA_INLINE int SumLanes(const typename Vector<T, Bytes>::Type& v)
{
  if constexpr (Bytes > 16)
  {
    T lanes[Vector<T, Bytes>::Lanes];
    StoreVector(lanes, v);
    typename Vector<T, Bytes / 2>::Type low, high;
    LoadVector(low, lanes);
    LoadVector(high, lanes + Vector<T, Bytes / 2>::Lanes);
    low += high;
    return SumLanes<T, Bytes / 2>(low);
  }
  else
  {
    std::uint64_t half[2];
    std::memcpy(half, &v, 16);
    std::uint64_t sum = half[0] + half[1];
    if constexpr (sizeof(T) == 1)
    {
      sum = (sum & 0x00ff00ff00ff00ffu) + ((sum >> 8) & 0x00ff00ff00ff00ffu);
    }
    if constexpr (sizeof(T) <= 2)
    {
      return static_cast<int>((sum * 0x0001000100010001u) >> 48);
    }
    else
    {
      return static_cast<int>((sum & 0xffffffffu) + (sum >> 32));
    }
  }
}

/// The window's table while it slides; the interface of queries (see WindowQuery). Count is a
/// signed integer; counts are stored from its least value upwards, because signed comparison is
/// what all vector units have.
template <class Count, int Bytes>
class BoxCounts
{
public:
  static constexpr std::int64_t Bias =
    -(std::int64_t(1) << (8 * sizeof(Count) - 1)); ///< the least value of Count
  using Counts = typename Vector<Count, Bytes>::Type;
  static constexpr int Lanes = Vector<Count, Bytes>::Lanes;

  BoxCounts(const RankTile& tile, const int window[3], Count* table)
    : Tile(tile)
    , Size(window)
    , Table(table)
  {
  }

  /// The level of the sample of rank k (0-based): the number of levels with at most k samples.
  LACUNA_INLINE int FindLevel(std::int64_t k) const
  {
    Counts above{};
    const Counts limit = Counts{} + static_cast<Count>(k + Bias);
    for (int i = 0; i < this->Tile.Levels; i += Lanes)
    {
      Counts c;
      LoadVector(c, this->Table + i);
      above -= (Counts)(c > limit);
    }
    return this->Tile.Levels - SumLanes<Count, Bytes>(above);
  }

  /// Samples below a level.
  LACUNA_INLINE std::int64_t Below(int level) const
  {
    return level > 0 ? this->Table[level - 1] - Bias : 0;
  }

  /// The place of the k-th sample (0-based) of level that lies in the window.
  LACUNA_INLINE std::uint32_t Find(int level, std::int64_t k) const
  {
    using Flags = typename Vector<std::uint8_t, Bytes>::Type;
    for (std::uint32_t place = this->Tile.First[level];; place += Bytes)
    {
      Flags in;
      this->Test(place, in);
      const int here = SumLanes<std::uint8_t, Bytes>(in);
      if (k < here)
      {
        return place + static_cast<std::uint32_t>(NthLane(in, static_cast<int>(k)));
      }
      k -= here;
    }
  }

  /// How many samples of level in the window have a place before end.
  LACUNA_INLINE std::int64_t CountUntil(int level, std::uint32_t end) const
  {
    std::int64_t n = 0;
    std::uint32_t place = this->Tile.First[level];
    for (; place + Bytes <= end; place += Bytes)
    {
      typename Vector<std::uint8_t, Bytes>::Type in;
      this->Test(place, in);
      n += SumLanes<std::uint8_t, Bytes>(in);
    }
    for (; place < end; ++place)
    {
      bool in = true;
      for (int a = 0; a < 3; ++a)
      {
        in = in &&
          static_cast<std::uint8_t>(this->Tile.Position[a][place] - this->Corner[a]) <
            this->Size[a];
      }
      n += in;
    }
    return n;
  }

  std::uint8_t Corner[3]{}; ///< the window's lowest sample in the tile

private:
  /// 1 in the lanes whose places lie in the window, else 0.
  template <class V>
  LACUNA_INLINE void Test(std::uint32_t place, V& in) const
  {
    V x, y, z;
    LoadVector(x, this->Tile.Position[0].data() + place);
    LoadVector(y, this->Tile.Position[1].data() + place);
    LoadVector(z, this->Tile.Position[2].data() + place);
    x -= this->Corner[0];
    y -= this->Corner[1];
    z -= this->Corner[2];
    const V all = (V)(x < static_cast<std::uint8_t>(this->Size[0])) &
      (V)(y < static_cast<std::uint8_t>(this->Size[1])) &
      (V)(z < static_cast<std::uint8_t>(this->Size[2]));
    in = all & 1;
  }

  /// The lane of the k-th 1.
  template <class V>
  static LACUNA_INLINE int NthLane(const V& in, int k)
  {
    std::uint64_t words[sizeof(V) / 8];
    std::memcpy(words, &in, sizeof(V));
    constexpr std::uint64_t Ones = 0x0101010101010101u;
    int word = 0;
    std::uint64_t running = words[0] * Ones; // byte i: the ones in bytes 0 ... i
    while (static_cast<int>(running >> 56) <= k)
    {
      k -= static_cast<int>(running >> 56);
      running = words[++word] * Ones;
    }
    // Bytes whose running count is at most k come before the lane: none exceeds 8, so bit 7 of
    // 128 + k - running tells without borrowing from a neighbour.
    const std::uint64_t before =
      ((Ones * static_cast<std::uint64_t>(128 + k)) - running) >> 7 & Ones;
    return 8 * word + static_cast<int>((before * Ones) >> 56);
  }

  const RankTile& Tile;
  const int* Size;
  Count* Table;
};

/// Slides a box over a tile. Plane is the unsigned type of the planes' counts (ky * kz samples at
/// most), Count the signed type that holds the window's.
template <class Plane, class Count, class Query>
struct BoxSlide
{
  const RankTile& Tile;
  const int* Size;   ///< of the window
  std::int64_t Rank; ///< looked up on the way; the queries that need others look for themselves
  Query& Visitor;    ///< Visit(counts, x, y, z, level of Rank) for each place of the window

  template <int Bytes>
  static LACUNA_INLINE void Run(BoxSlide& slide)
  {
    slide.template Slide<Bytes>();
  }

private:
  template <int Bytes>
  LACUNA_INLINE void Slide()
  {
    const int levels = this->Tile.Levels;
    const int nx = this->Tile.Size[0];
    const int ny = this->Tile.Size[1];
    const int outX = nx - this->Size[0] + 1;
    const int outY = ny - this->Size[1] + 1;
    const int outZ = this->Tile.Size[2] - this->Size[2] + 1;
    const bool deep = this->Size[2] > 1;
    AlignedTable<std::uint8_t> columns(deep ? std::size_t(nx) * ny * levels : 0);
    AlignedTable<Plane> planes(std::size_t(nx) * levels);
    AlignedTable<Plane> zeros(levels);
    AlignedTable<Count> table(levels);
    BoxCounts<Count, Bytes> counts(this->Tile, this->Size, table.data());

    for (int z = 0; z < outZ; ++z)
    {
      if (deep)
      {
        this->template MoveColumns<Bytes>(z, columns.data());
      }
      for (int y = 0; y < outY; ++y)
      {
        if (deep)
        {
          this->template MovePlanes<Bytes>(y, columns.data(), planes.data());
        }
        else
        {
          this->template MoveFlatPlanes<Bytes>(y, z, planes.data());
        }
        counts.Corner[1] = static_cast<std::uint8_t>(y);
        counts.Corner[2] = static_cast<std::uint8_t>(z);
        std::fill_n(table.data(), levels, std::numeric_limits<Count>::min());
        for (int x = 0; x < this->Size[0] - 1; ++x)
        {
          AddTable<Bytes>(table.data(), planes.data() + std::size_t(x) * levels, levels);
        }
        const Plane* out = zeros.data();
        const Plane* in = planes.data() + std::size_t(this->Size[0] - 1) * levels;
        for (int x = 0; x < outX; ++x, in += levels)
        {
          const int level = this->template Step<Bytes>(table.data(), in, out);
          counts.Corner[0] = static_cast<std::uint8_t>(x);
          this->Visitor.Visit(counts, x, y, z, level);
          out = planes.data() + std::size_t(x) * levels;
        }
      }
    }
  }

  /// Adds in, takes away out, returns the level of Rank.
  template <int Bytes>
  LACUNA_INLINE int Step(Count* table, const Plane* in, const Plane* out) const
  {
    using Counts = typename Vector<Count, Bytes>::Type;
    constexpr int Lanes = Vector<Count, Bytes>::Lanes;
    using Planes = typename Vector<Plane, Lanes * sizeof(Plane)>::Type;
    Counts above{};
    const Counts limit =
      Counts{} + static_cast<Count>(this->Rank + std::numeric_limits<Count>::min());
    for (int i = 0; i < this->Tile.Levels; i += Lanes)
    {
      Planes a, b;
      Counts c;
      LoadVector(a, in + i);
      LoadVector(b, out + i);
      LoadVector(c, table + i);
      c += __builtin_convertvector(a, Counts) - __builtin_convertvector(b, Counts);
      StoreVector(table + i, c);
      above -= (Counts)(c > limit);
    }
    return this->Tile.Levels - SumLanes<Count, Bytes>(above);
  }

  template <int Bytes>
  LACUNA_INLINE void MoveColumns(int z, std::uint8_t* columns) const
  {
    const int levels = this->Tile.Levels;
    const std::size_t slice = std::size_t(this->Tile.Size[0]) * this->Tile.Size[1];
    const std::uint8_t* first = this->Tile.Level.data();
    const int depth = this->Size[2];
    for (std::size_t i = 0; i < slice; ++i, columns += levels)
    {
      if (z == 0)
      {
        for (int k = 0; k < depth; ++k)
        {
          AddSample<Bytes>(columns, levels, first[i + k * slice]);
        }
      }
      else
      {
        ExchangeSample<Bytes>(
          columns, levels, first[i + (z + depth - 1) * slice], first[i + (z - 1) * slice]);
      }
    }
  }

  template <int Bytes>
  LACUNA_INLINE void MovePlanes(int y, const std::uint8_t* columns, Plane* planes) const
  {
    using Planes = typename Vector<Plane, Bytes>::Type;
    constexpr int Lanes = Vector<Plane, Bytes>::Lanes;
    using Columns = typename Vector<std::uint8_t, Lanes>::Type;
    const std::size_t row = std::size_t(this->Tile.Size[0]) * this->Tile.Levels;
    const int height = this->Size[1];
    if (y == 0)
    {
      std::fill(planes, planes + row, Plane(0));
    }
    const int from = y == 0 ? 0 : height - 1;
    for (int j = from; j < height; ++j)
    {
      const std::uint8_t* in = columns + (y + j) * row;
      const std::uint8_t* out = columns + (y - 1) * row;
      for (std::size_t i = 0; i < row; i += Lanes)
      {
        Planes p;
        Columns c;
        LoadVector(p, planes + i);
        LoadVector(c, in + i);
        p += __builtin_convertvector(c, Planes);
        if (y > 0)
        {
          LoadVector(c, out + i);
          p -= __builtin_convertvector(c, Planes);
        }
        StoreVector(planes + i, p);
      }
    }
  }

  /// As MovePlanes for a window of one slice: the columns are single samples.
  template <int Bytes>
  LACUNA_INLINE void MoveFlatPlanes(int y, int z, Plane* planes) const
  {
    const int levels = this->Tile.Levels;
    const int nx = this->Tile.Size[0];
    const std::uint8_t* row =
      this->Tile.Level.data() + (std::size_t(z) * this->Tile.Size[1] + y) * nx;
    if (y == 0)
    {
      std::fill(planes, planes + std::size_t(nx) * levels, Plane(0));
    }
    for (int x = 0; x < nx; ++x, planes += levels)
    {
      if (y == 0)
      {
        for (int j = 0; j < this->Size[1]; ++j)
        {
          AddSample<Bytes>(planes, levels, row[x + std::ptrdiff_t(j) * nx]);
        }
      }
      else
      {
        ExchangeSample<Bytes>(
          planes, levels, row[x + std::ptrdiff_t(this->Size[1] - 1) * nx], row[x - nx]);
      }
    }
  }
};
}
#endif
