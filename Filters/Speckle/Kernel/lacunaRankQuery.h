// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a rank filter asks the counts of a window (BoxCounts or EllipsoidCounts) for.
#ifndef lacunaRankQuery_h
#define lacunaRankQuery_h

#include "lacunaRankFilter.h"
#include "lacunaRankTile.h"
#include "lacunaVectorUnit.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace lacuna
{
/// The 0-based rank that parameters mean among n samples.
inline std::int64_t RankAmong(std::int64_t n, const RankParameters& parameters)
{
  return std::min<std::int64_t>(
    n - 1, static_cast<std::int64_t>(static_cast<double>(n) * parameters.Percentile / 100));
}

/// Where results go: the place of the result of each window, x fastest.
struct RankResults
{
  int Size[2]; ///< windows along x and y
  std::uint32_t* Places;

  std::uint32_t& At(int x, int y, int z) const
  {
    return this->Places[(std::size_t(z) * this->Size[1] + y) * this->Size[0] + x];
  }
};

/// The place of the k-th sample (0-based) in the window.
template <class Counts>
LACUNA_INLINE std::uint32_t SelectInLevel(
  const Counts& counts, const RankTile& tile, int level, std::int64_t k)
{
  return tile.Exact ? static_cast<std::uint32_t>(level)
                    : counts.Find(level, k - counts.Below(level));
}

/// One rank, the same in all windows.
struct FixedRankQuery
{
  const RankTile& Tile;
  RankResults Results;
  std::int64_t Rank;

  template <class Counts>
  LACUNA_INLINE void Visit(const Counts& counts, int x, int y, int z, int level)
  {
    this->Results.At(x, y, z) = SelectInLevel(counts, this->Tile, level, this->Rank);
  }
};

/// Which samples a truncated median keeps: [first, second) of the places.
class Truncation
{
public:
  virtual ~Truncation() = default;
  virtual std::pair<std::uint32_t, std::uint32_t> Keep(
    std::uint32_t least, std::uint32_t median, std::uint32_t greatest) const = 0;
};

/// Any rank query, also where NaN is about and for the mode.
struct GeneralRankQuery
{
  const RankTile& Tile;
  RankResults Results;
  const RankParameters& Parameters;
  std::int64_t Samples; ///< in a window
  const Truncation& Mode;

  template <class Counts>
  LACUNA_INLINE void Visit(const Counts& counts, int x, int y, int z, int)
  {
    const std::int64_t n = this->CountBefore(counts, this->Tile.Numbers);
    std::uint32_t& place = this->Results.At(x, y, z);
    if (n == 0)
    {
      place = this->Tile.Numbers; // all NaN
      return;
    }
    if (!this->Parameters.Mode)
    {
      place = this->Select(counts, RankAmong(n, this->Parameters));
      return;
    }
    const auto kept = this->Mode.Keep(
      this->Select(counts, 0), this->Select(counts, n / 2), this->Select(counts, n - 1));
    const std::int64_t first = this->CountBefore(counts, kept.first);
    const std::int64_t last = this->CountBefore(counts, kept.second);
    place = this->Select(counts, first + (last - first) / 2);
  }

private:
  template <class Counts>
  LACUNA_INLINE std::uint32_t Select(const Counts& counts, std::int64_t k) const
  {
    return SelectInLevel(counts, this->Tile, counts.FindLevel(k), k);
  }

  /// Samples of the window whose place is before the given one.
  template <class Counts>
  LACUNA_INLINE std::int64_t CountBefore(const Counts& counts, std::uint32_t place) const
  {
    if (place >= this->Tile.Places)
    {
      return this->Samples;
    }
    const int level = static_cast<int>(this->Tile.LevelOf(place));
    return counts.Below(level) + (this->Tile.Exact ? 0 : counts.CountUntil(level, place));
  }
};
}
#endif
