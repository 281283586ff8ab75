// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Casts the rays of a tile of pixels together.
#ifndef lacunaTileCaster_h
#define lacunaTileCaster_h

#include "lacunaBlockProjection.h"
#include "lacunaCellSearch.h"
#include "lacunaFieldBlocks.h"
#include "lacunaRayBatch.h"
#include "lacunaSurfaceBlocks.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lacuna
{
/// What the rays of a tile of pixels have met; row r, column c of the tile is element Width r + c.
struct TileEntries
{
  static constexpr int Width = 64;
  std::array<std::uint64_t, Width> Found; ///< bit c of element r
  std::vector<RayEntry> Entries = std::vector<RayEntry>(Width * Width);
};

/// Offers blocks, and then cells, that may hold surface to the rays that cross them, front to back.
/// What is read from the voxels and found out about a cell serves all its rays, and space without
/// surface costs nothing. A cell is crossed between two of the six points at which a ray meets its
/// planes, each computed from the plane's integer coordinate: the cells of a ray leave no gaps.
///
/// Between the cells a ray is offered, the field has no zero; so what the ray has met before need
/// not be known. Where a ray enters or leaves a cell at a zero of the field but for rounding, that
/// is in doubt: it is then followed alone, by FieldWalker.
template <int Support>
class TileCaster
{
public:
  static constexpr int Width = TileEntries::Width;
  using Index = std::array<int, 3>;

  /// One per thread. field and projection must outlive this object.
  TileCaster(
    const FieldBlocks<Support>& field, const RayGrid& rays, const BlockProjection& projection);

  /// extent: first and last column, first and last row; at most Width of each. spans: of each pixel
  /// of the tile, or null for whole rays.
  void Cast(const std::array<int, 4>& extent, const RaySpan* spans, TileEntries& result);

private:
  /// What is found out about a cell when its first ray asks for it.
  struct CellAtWork
  {
    Index Cell;
    Vec3 Low;
    Vec3 High;
    CellPlanes Planes;
    bool HasPlanes = false;
    TensorCell<Support> Points;
    bool HasPoints = false;
  };

  void CastBlock(const Index& block, const PixelBox& box);
  void CastCell(const Index& cell, const PixelBox& box);
  void CastBatch(CellAtWork& work, RayBatch& batch);
  template <class Body>
  void ForEach(std::uint64_t set, const Index& bigger, int shift, const Body& body) const;

  /// Whether a ray of the box still looks for its entry.
  bool IsOpen(const PixelBox& box) const
  {
    const std::uint64_t columns = this->Columns(box);
    std::uint64_t open = 0;
    for (int row = box.FirstRow; row <= box.LastRow; ++row)
    {
      open |= this->Open[row - this->Extent[2]];
    }
    return (open & columns) != 0;
  }

  std::uint64_t Columns(const PixelBox& box) const
  {
    return ~std::uint64_t(0) >> (Width - 1 - (box.LastColumn - box.FirstColumn))
      << (box.FirstColumn - this->Extent[0]);
  }

  const FieldBlocks<Support>& Field;
  RayGrid Rays;
  const BlockProjection& Projection;
  std::array<bool, 3> StandsStill; ///< along an axis parallel rays move by rounding only
  int Axis = -1;                   ///< parallel rays go along this one alone
  SurfaceBlocks<Support> Blocks;   ///< for rays followed alone
  BlockPoints<Support> Points;     ///< of the block at work
  std::array<std::uint64_t, Width> Open;
  std::array<int, 4> Extent;
  const RaySpan* Spans = nullptr;
  TileEntries* Out = nullptr;
};

extern template class TileCaster<2>;
extern template class TileCaster<4>;
}
#endif
