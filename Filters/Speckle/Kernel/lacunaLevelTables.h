// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Tables of cumulative counts, #{samples <= level} for each level, and sums of them.
#ifndef lacunaLevelTables_h
#define lacunaLevelTables_h

#include "lacunaVectorUnit.h"

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
}
#endif
