// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How deep the rays of a part of a depth map can meet anything but empty space.
#ifndef lacunaTileSpans_h
#define lacunaTileSpans_h

#include "lacunaExecution.h"
#include "lacunaFieldBounds.h"
#include "lacunaMatrix4.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <mutex>
#include <vector>

namespace lacuna
{
/// The part of a ray to follow, mm; before and behind it the field is empty.
struct RaySpan
{
  double First = std::numeric_limits<double>::infinity();
  double Last = -std::numeric_limits<double>::infinity();

  static RaySpan All()
  {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return { -infinity, infinity };
  }
  bool IsEmpty() const { return !(this->First <= this->Last); }
};

/// Projects the blocks that are not empty onto square tiles of pixels: most rays then begin near
/// the surface, and those that meet nothing need not be followed at all. For parallel projection.
/// A span reaches further than its blocks by what rounding may do, so that which tile a pixel is
/// in does not change what is found.
class TileSpans
{
public:
  static constexpr int TileWidth = 8;

  /// indexToPixel: voxel index to (column, row, depth). extent: first and last column, first and
  /// last row. isEmpty(minimum, maximum) is asked about the control points of blocks.
  template <class T, class IsEmpty>
  TileSpans(const FieldBounds<T>& bounds, const Matrix4& indexToPixel,
    const std::array<int, 4>& extent, const IsEmpty& isEmpty, Execution& execution)
    : TileSpans(indexToPixel, extent)
  {
    const auto& coarse = bounds.GetCoarse();
    const auto& fine = bounds.GetFine();
    const int shift = coarse.Shift - fine.Shift;
    std::mutex mutex;
    execution.For(coarse.Blocks[2], 1,
      [&](std::int64_t begin, std::int64_t end)
      {
        std::vector<RaySpan> spans(this->Spans.size());
        const auto occupied = [&](const auto& level, int i, int j, int k)
        {
          const T* bound = level.Bounds.data() + level.IndexOf(i, j, k);
          return !isEmpty(static_cast<double>(bound[0]), static_cast<double>(bound[1]));
        };
        const auto endOf = [&](int block, int a)
        { return std::min((block + 1) << shift, fine.Blocks[a]); };
        for (int k = static_cast<int>(begin); k < end; ++k)
        {
          for (int j = 0; j < coarse.Blocks[1]; ++j)
          {
            for (int i = 0; i < coarse.Blocks[0]; ++i)
            {
              if (!occupied(coarse, i, j, k))
              {
                continue;
              }
              for (int z = k << shift; z < endOf(k, 2); ++z)
              {
                for (int y = j << shift; y < endOf(j, 1); ++y)
                {
                  for (int x = i << shift; x < endOf(i, 0); ++x)
                  {
                    if (occupied(fine, x, y, z))
                    {
                      this->Add({ x, y, z }, fine.Shift, spans);
                    }
                  }
                }
              }
            }
          }
        }
        const std::lock_guard<std::mutex> lock(mutex);
        this->Merge(spans);
      });
  }

  RaySpan Get(int column, int row) const
  {
    return this
      ->Spans[static_cast<std::size_t>((row - this->Extent[2]) / TileWidth) * this->Across +
        (column - this->Extent[0]) / TileWidth];
  }

private:
  TileSpans(const Matrix4& indexToPixel, const std::array<int, 4>& extent);
  /// Widens the spans of the tiles on which a block of 2^shift cells is projected.
  void Add(const std::array<int, 3>& block, int shift, std::vector<RaySpan>& spans) const;
  void Merge(const std::vector<RaySpan>& spans);

  Matrix4 IndexToPixel;
  Vec3 CellSize; ///< half the columns, rows and depth that a cell takes, and a little more
  std::array<int, 4> Extent;
  std::size_t Across;
  std::vector<RaySpan> Spans;
};
}
#endif
