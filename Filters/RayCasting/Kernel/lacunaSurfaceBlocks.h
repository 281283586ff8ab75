// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Remembers for the blocks that neighbouring rays meet which of their cells hold no surface.
#ifndef lacunaSurfaceBlocks_h
#define lacunaSurfaceBlocks_h

#include "lacunaFieldBlocks.h"

#include <array>
#include <vector>

namespace lacuna
{
/// The hulls of the cells at one iso-value, found when asked for. A table of fixed size, in which
/// blocks that are neighbours do not displace each other; one per thread. What it answers does not
/// depend on what was asked before.
template <int Support>
class SurfaceBlocks
{
public:
  using Index = std::array<int, 3>;

  /// field: must outlive this object.
  explicit SurfaceBlocks(const FieldBlocks<Support>& field)
    : Field(field)
    , Table(TableSize)
  {
  }

  /// block: in blocks of 4^3 cells.
  const CellHulls& Get(const Index& block)
  {
    Entry& entry = this->Table[(block[0] & 7) | (block[1] & 7) << 3 | (block[2] & 3) << 6];
    if (entry.Block != block)
    {
      BlockPoints<Support> points;
      entry.Hulls = this->Field.Classify(block, points);
      entry.Block = block;
    }
    return entry.Hulls;
  }

  const FieldBlocks<Support>& GetField() const { return this->Field; }

private:
  static constexpr int TableSize = 256;
  struct Entry
  {
    Index Block{ -1, -1, -1 };
    CellHulls Hulls;
  };

  const FieldBlocks<Support>& Field;
  std::vector<Entry> Table;
};
}
#endif
