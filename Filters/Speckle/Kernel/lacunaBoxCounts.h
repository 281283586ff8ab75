// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Counts of levels in a box that lies in a RankTile, and what can be asked of them.
#ifndef lacunaBoxCounts_h
#define lacunaBoxCounts_h

#include "lacunaRankTile.h"
#include "lacunaVectorUnit.h"

#include <cstdint>
#include <limits>

namespace lacuna
{
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
}
#endif
