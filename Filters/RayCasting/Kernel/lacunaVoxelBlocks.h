// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reads the control points of cells and of blocks of cells from voxels of any type.
#ifndef lacunaVoxelBlocks_h
#define lacunaVoxelBlocks_h

#include "lacunaFieldBlocks.h"
#include "lacunaFieldBounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace lacuna
{
/// A volume and which of its sides is solid. Owns nothing.
template <class T>
struct SolidVoxels
{
  const T* Voxels;
  std::array<int, 3> Size;
  const FieldBounds<T>* Bounds;
  bool SolidAbove;
  bool HasEmpty; ///< some voxels are not finite
  double Empty;  ///< and count as this
};

/// The control points of a field less an iso-value, positive in the solid. Points beyond the border
/// continue the voxels linearly; voxels that are not finite are empty.
template <class T, int Support>
class VoxelBlocks final : public FieldBlocks<Support>
{
public:
  using Base = FieldBlocks<Support>;
  using Index = typename Base::Index;

  /// solid: must outlive this object.
  VoxelBlocks(const SolidVoxels<T>& solid, double isoValue)
    : Base(solid.Size)
    , Solid(solid)
    , IsoValue(isoValue)
    , Sign(solid.SolidAbove ? 1 : -1)
    , Offset(-this->Sign * isoValue)
  {
  }

  typename Base::Class GetCoarseClass(const Index& coarse) const override
  {
    const auto& level = this->Solid.Bounds->GetCoarse();
    const T* bounds = level.Bounds.data() + level.IndexOf(coarse[0], coarse[1], coarse[2]);
    return { this->IsOutside(bounds), this->IsInside(bounds) };
  }

  CellHulls GetBlockClasses(const Index& coarse) const override
  {
    const auto& level = this->Solid.Bounds->GetFine();
    CellHulls classes;
    for (int k = 0; k < 4; ++k)
    {
      for (int j = 0; j < 4; ++j)
      {
        const int x = 4 * coarse[0];
        const int y = 4 * coarse[1] + j;
        const int z = 4 * coarse[2] + k;
        const int bit = CellHulls::BitOf(0, j, k);
        if (y >= level.Blocks[1] || z >= level.Blocks[2])
        {
          classes.Outside |= std::uint64_t(15) << bit;
          classes.Inside |= std::uint64_t(15) << bit;
          continue;
        }
        const T* bounds = level.Bounds.data() + level.IndexOf(x, y, z);
        for (int i = 0; i < 4; ++i)
        {
          const bool beyond = x + i >= level.Blocks[0];
          const bool outside = beyond || this->IsOutside(bounds + 2 * i);
          const bool inside = beyond || this->IsInside(bounds + 2 * i);
          classes.Outside |= static_cast<std::uint64_t>(outside) << (bit + i);
          classes.Inside |= static_cast<std::uint64_t>(inside) << (bit + i);
        }
      }
    }
    return classes;
  }

  void GetBlock(const Index& block, BlockPoints<Support>& result) const override
  {
    constexpr int width = BlockPoints<Support>::Width;
    constexpr int rowSize = BlockPoints<Support>::RowSize;
    const Index first{ 4 * block[0] - Before, 4 * block[1] - Before, 4 * block[2] - Before };
    if (this->IsPlain(first, rowSize, width))
    {
      this->template Read<rowSize>(first, width, &result.Values[0][0][0]);
    }
    else
    {
      this->template ReadGuarded<rowSize>(first, width, &result.Values[0][0][0]);
    }
    result.SetTolerance(static_cast<float>(std::abs(this->Offset)));
  }

  void GetCell(const Index& cell, TensorCell<Support>& result) const override
  {
    const Index first{ cell[0] - Before, cell[1] - Before, cell[2] - Before };
    if (this->IsPlain(first, Support, Support))
    {
      this->template Read<Support>(first, Support, result.Points);
    }
    else
    {
      this->template ReadGuarded<Support>(first, Support, result.Points);
    }
  }

private:
  static constexpr int Before = TensorCell<Support>::Before;

  bool IsOutside(const T* bounds) const
  {
    return this->Solid.SolidAbove ? static_cast<double>(bounds[1]) < this->IsoValue
                                  : static_cast<double>(bounds[0]) > this->IsoValue;
  }

  bool IsInside(const T* bounds) const
  {
    return this->Solid.SolidAbove ? static_cast<double>(bounds[0]) >= this->IsoValue
                                  : static_cast<double>(bounds[1]) <= this->IsoValue;
  }

  /// Nothing but finite voxels, rowSize along x and width along y and z.
  bool IsPlain(const Index& first, int rowSize, int width) const
  {
    const auto& size = this->Solid.Size;
    return !this->Solid.HasEmpty && first[0] >= 0 && first[1] >= 0 && first[2] >= 0 &&
      first[0] + rowSize <= size[0] && first[1] + width <= size[1] && first[2] + width <= size[2];
  }

  template <int RowSize, class Real>
  void Read(const Index& first, int width, Real* out) const
  {
    const std::int64_t row = this->Solid.Size[0];
    const std::int64_t slice = row * this->Solid.Size[1];
    const T* corner = this->Solid.Voxels + first[2] * slice + first[1] * row + first[0];
    // Small integers are exact in float as well.
    using Number = std::conditional_t<sizeof(T) <= 2, Real, double>;
    const auto sign = static_cast<Number>(this->Sign);
    const auto offset = static_cast<Number>(this->Offset);
    for (int k = 0; k < width; ++k)
    {
      for (int j = 0; j < width; ++j)
      {
        const T* in = corner + k * slice + j * row;
        for (int i = 0; i < RowSize; ++i)
        {
          out[i] = static_cast<Real>(sign * static_cast<Number>(in[i]) + offset);
        }
        out += RowSize;
      }
    }
  }

  template <int RowSize, class Real>
  void ReadGuarded(const Index& first, int width, Real* points) const
  {
    const auto& size = this->Solid.Size;
    Real* out = points;
    for (int k = 0; k < width; ++k)
    {
      const int z = std::min(std::max(first[2] + k, 0), size[2] - 1);
      for (int j = 0; j < width; ++j)
      {
        const int y = std::min(std::max(first[1] + j, 0), size[1] - 1);
        const T* row = this->Solid.Voxels + (static_cast<std::int64_t>(z) * size[1] + y) * size[0];
        for (int i = 0; i < RowSize; ++i)
        {
          const int x = std::min(std::max(first[0] + i, 0), size[0] - 1);
          const double v = static_cast<double>(row[x]);
          *out++ = static_cast<Real>(
            this->Sign * (std::isfinite(v) ? v : this->Solid.Empty) + this->Offset);
        }
      }
    }
    if constexpr (Support == 4)
    {
      const std::ptrdiff_t strides[3] = { 1, RowSize,
        static_cast<std::ptrdiff_t>(RowSize) * width };
      const int lengths[3] = { RowSize, width, width };
      for (int a = 0; a < 3; ++a)
      {
        const int u = a == 0 ? 1 : 0;
        const int v = a == 2 ? 1 : 2;
        const std::ptrdiff_t s = strides[a];
        const int end = size[a] - first[a]; // the first one beyond
        for (int n = 0; n < lengths[v]; ++n)
        {
          for (int m = 0; m < lengths[u]; ++m)
          {
            Real* p = points + m * strides[u] + n * strides[v];
            if (first[a] < 0)
            {
              p[0] = 2 * p[s] - p[2 * s];
            }
            if (end < lengths[a])
            {
              p[end * s] = 2 * p[(end - 1) * s] - p[(end - 2) * s];
            }
          }
        }
      }
    }
  }

  const SolidVoxels<T>& Solid;
  double IsoValue;
  double Sign;
  double Offset;
};
}
#endif
