// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Remembers for the blocks that neighbouring rays meet which of their cells hold no surface.
#ifndef lacunaSurfaceBlocks_h
#define lacunaSurfaceBlocks_h

#include "lacunaControlPoints.h"

#include <vector>

namespace lacuna
{
/// The hulls of the cells at one iso-value, found when asked for. A table of fixed size, in which
/// blocks that are neighbours do not displace each other; one per thread. What it answers does not
/// depend on what was asked before.
template <class T, int Support>
class SurfaceBlocks
{
public:
  using Index = std::array<int, 3>;

  SurfaceBlocks(const WalkedField<T>& field, double isoValue)
    : Points(field, isoValue)
    , Table(TableSize)
  {
  }

  /// block: in blocks of 4^3 cells.
  const CellHulls& Get(const Index& block)
  {
    Entry& entry = this->Table[(block[0] & 7) | (block[1] & 7) << 3 | (block[2] & 15) << 6];
    if (entry.Block != block)
    {
      entry.Block = block;
      entry.Hulls = this->Find(block);
    }
    return entry.Hulls;
  }

  const ControlPoints<T, Support>& GetControlPoints() const { return this->Points; }

private:
  static constexpr int TableSize = 1024;
  struct Entry
  {
    Index Block{ -1, -1, -1 };
    CellHulls Hulls;
  };

  CellHulls Find(const Index& block) const
  {
    BlockPoints<Support> points;
    this->Points.GetBlock(block, points);
    const float* values = &points.Values[0][0][0];
    float greatest = static_cast<float>(std::abs(this->Points.GetOffset()));
    for (std::size_t i = 0; i < sizeof(points.Values) / sizeof(float); ++i)
    {
      greatest = std::max(greatest, std::abs(values[i]));
    }
    // Beyond these, float overflows or loses digits: every cell is then searched.
    if (!(greatest > 1e-30F && greatest < 1e35F))
    {
      return {};
    }
    // A Bezier point has been rounded some ten times, by 2^-24 each.
    constexpr float tolerance = 1.0F / (1 << 19);
    return points.Classify(tolerance * greatest);
  }

  ControlPoints<T, Support> Points;
  std::vector<Entry> Table;
};
}
#endif
