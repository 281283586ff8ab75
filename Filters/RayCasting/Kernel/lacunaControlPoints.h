// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Reads the control points of cells and of blocks of cells from the voxels.
#ifndef lacunaControlPoints_h
#define lacunaControlPoints_h

#include "lacunaCellHulls.h"
#include "lacunaFieldBounds.h"
#include "lacunaTensorCell.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace lacuna
{
/// What a walker walks through.
template <class T>
struct WalkedField
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
class ControlPoints
{
public:
  using Index = std::array<int, 3>;

  ControlPoints(const WalkedField<T>& field, double isoValue)
    : Field(field)
    , Sign(field.SolidAbove ? 1 : -1)
    , Offset(-this->Sign * isoValue)
  {
  }

  void GetCell(const Index& cell, TensorCell<Support>& result) const
  {
    const Index first{ cell[0] - Before, cell[1] - Before, cell[2] - Before };
    if (this->IsPlain(first, Support, Support))
    {
      this->Read<Support>(first, Support, result.Points);
    }
    else
    {
      this->ReadGuarded<Support>(first, Support, result.Points);
    }
  }

  /// block: in blocks of 4^3 cells.
  void GetBlock(const Index& block, BlockPoints<Support>& result) const
  {
    constexpr int width = BlockPoints<Support>::Width;
    constexpr int rowSize = BlockPoints<Support>::RowSize;
    const Index first{ 4 * block[0] - Before, 4 * block[1] - Before, 4 * block[2] - Before };
    if (this->IsPlain(first, rowSize, width))
    {
      this->Read<rowSize>(first, width, &result.Values[0][0][0]);
    }
    else
    {
      this->ReadGuarded<rowSize>(first, width, &result.Values[0][0][0]);
    }
  }

  double GetOffset() const { return this->Offset; }

private:
  static constexpr int Before = TensorCell<Support>::Before;

  /// Nothing but finite voxels, rowSize along x and width along y and z.
  bool IsPlain(const Index& first, int rowSize, int width) const
  {
    const auto& size = this->Field.Size;
    return !this->Field.HasEmpty && first[0] >= 0 && first[1] >= 0 && first[2] >= 0 &&
      first[0] + rowSize <= size[0] && first[1] + width <= size[1] && first[2] + width <= size[2];
  }

  template <int RowSize, class Real>
  void Read(const Index& first, int width, Real* out) const
  {
    const std::int64_t row = this->Field.Size[0];
    const std::int64_t slice = row * this->Field.Size[1];
    const T* corner = this->Field.Voxels + first[2] * slice + first[1] * row + first[0];
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
    const auto& size = this->Field.Size;
    Real* out = points;
    for (int k = 0; k < width; ++k)
    {
      const int z = std::min(std::max(first[2] + k, 0), size[2] - 1);
      for (int j = 0; j < width; ++j)
      {
        const int y = std::min(std::max(first[1] + j, 0), size[1] - 1);
        const T* row = this->Field.Voxels + (static_cast<std::int64_t>(z) * size[1] + y) * size[0];
        for (int i = 0; i < RowSize; ++i)
        {
          const int x = std::min(std::max(first[0] + i, 0), size[0] - 1);
          const double v = static_cast<double>(row[x]);
          *out++ = static_cast<Real>(
            this->Sign * (std::isfinite(v) ? v : this->Field.Empty) + this->Offset);
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

  const WalkedField<T>& Field;
  double Sign;
  double Offset;
};
}
#endif
