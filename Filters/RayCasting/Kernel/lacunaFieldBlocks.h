// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A field less an iso-value, seen in blocks of cells.
#ifndef lacunaFieldBlocks_h
#define lacunaFieldBlocks_h

#include "lacunaCellHulls.h"
#include "lacunaTensorCell.h"

#include <array>

namespace lacuna
{
/// What those who look for a surface ask of a volume of any type: control points of the field less
/// the iso-value, positive in the solid. A block has 4^3 cells, a coarse block 4^3 blocks.
template <int Support>
class FieldBlocks
{
public:
  using Index = std::array<int, 3>;
  static constexpr int BlockShift = 2;
  static constexpr int CoarseShift = 4;

  virtual ~FieldBlocks() = default;

  /// The classes of a coarse block as a whole. Both when it may hold surface: none.
  struct Class
  {
    bool Outside; ///< negative throughout
    bool Inside;  ///< not negative throughout
  };
  virtual Class GetCoarseClass(const Index& coarse) const = 0;

  /// The classes of a coarse block's blocks. Those beyond the volume are in both sets.
  virtual CellHulls GetBlockClasses(const Index& coarse) const = 0;

  virtual void GetBlock(const Index& block, BlockPoints<Support>& result) const = 0;
  virtual void GetCell(const Index& cell, TensorCell<Support>& result) const = 0;

  /// Voxels along each axis.
  const Index& GetSize() const { return this->Size; }

  /// Coarse blocks along each axis.
  Index CountCoarse() const
  {
    Index count;
    for (int a = 0; a < 3; ++a)
    {
      count[a] = (this->Size[a] - 2 + (1 << CoarseShift)) >> CoarseShift;
    }
    return count;
  }

  /// The classes of a block's cells, and in points its control points and their tolerance. Cells
  /// beyond the volume are in both sets.
  CellHulls Classify(const Index& block, BlockPoints<Support>& points) const
  {
    this->GetBlock(block, points);
    CellHulls hulls = points.Classify();
    const std::uint64_t beyond = this->CellsBeyond(block);
    hulls.Outside |= beyond;
    hulls.Inside |= beyond;
    return hulls;
  }

protected:
  explicit FieldBlocks(const Index& size)
    : Size(size)
  {
  }

private:
  std::uint64_t CellsBeyond(const Index& block) const
  {
    // bits of the cells whose coordinate along an axis is at least 0, 1, 2, 3, 4
    static constexpr std::uint64_t from[3][5] = { { ~std::uint64_t(0), 0xEEEEEEEEEEEEEEEE,
                                                    0xCCCCCCCCCCCCCCCC, 0x8888888888888888, 0 },
      { ~std::uint64_t(0), 0xFFF0FFF0FFF0FFF0, 0xFF00FF00FF00FF00, 0xF000F000F000F000, 0 },
      { ~std::uint64_t(0), 0xFFFFFFFFFFFF0000, 0xFFFFFFFF00000000, 0xFFFF000000000000, 0 } };
    std::uint64_t beyond = 0;
    for (int a = 0; a < 3; ++a)
    {
      const int cells = this->Size[a] - 1 - 4 * block[a];
      beyond |= from[a][cells < 4 ? cells : 4];
    }
    return beyond;
  }

  Index Size;
};
}
#endif
