// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where blocks of cells are seen in an image, and in which order along its rays.
#ifndef lacunaBlockProjection_h
#define lacunaBlockProjection_h

#include "lacunaMatrix4.h"
#include "lacunaRay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lacuna
{
/// A rectangle of pixels.
struct PixelBox
{
  int FirstColumn;
  int LastColumn;
  int FirstRow;
  int LastRow;

  bool IsEmpty() const
  {
    return this->FirstColumn > this->LastColumn || this->FirstRow > this->LastRow;
  }
};

/// An order of the indices from first to last in which all rays meet them: those in front of the
/// eye first, going away from it, then those behind.
class FrontToBack
{
public:
  FrontToBack(int first, int last, int turn)
    : First(first)
    , Last(last)
    , Turn(std::min(std::max(turn, first), last + 1))
  {
  }
  int Count() const { return this->Last - this->First + 1; }
  int operator[](int n) const
  {
    const int upwards = this->Last - this->Turn + 1;
    return n < upwards ? this->Turn + n : this->Turn - 1 - (n - upwards);
  }

private:
  int First;
  int Last;
  int Turn;
};

class BlockProjection
{
public:
  /// indexToPixel: (i, j, k, 1) to (column, row, .) in a parallel projection, otherwise to
  /// (column z, row z, z) with z > 0 before the eye.
  BlockProjection(const Matrix4& indexToPixel, const RayGrid& rays)
    : IndexToPixel(indexToPixel)
    , Parallel(rays.Parallel)
  {
    // What rounding may do must not leave out a pixel.
    constexpr double more = 1 + 1e-6;
    for (int a = 0; a < 3; ++a)
    {
      this->HalfCell[a] = 0.5 * more *
        (std::abs(indexToPixel(a, 0)) + std::abs(indexToPixel(a, 1)) +
          std::abs(indexToPixel(a, 2)));
      const double infinity = std::numeric_limits<double>::infinity();
      this->Eye[a] =
        !this->Parallel ? rays.First.A[a] : (rays.First.B[a] < 0 ? infinity : -infinity);
    }
  }

  /// The pixels of extent (first and last column, first and last row) that may see a block which
  /// is 2^shift cells wide; with many pixels before the eye and its plane.
  PixelBox Find(const std::array<int, 3>& block, int shift, const std::array<int, 4>& extent) const
  {
    const double width = 1 << shift;
    const Vec3 centre{ (block[0] + 0.5) * width, (block[1] + 0.5) * width,
      (block[2] + 0.5) * width };
    const Matrix4& m = this->IndexToPixel;
    double low[2];
    double high[2];
    for (int a = 0; a < 2; ++a)
    {
      const double middle =
        m(a, 0) * centre[0] + m(a, 1) * centre[1] + m(a, 2) * centre[2] + m(a, 3);
      low[a] = middle - width * this->HalfCell[a];
      high[a] = middle + width * this->HalfCell[a];
    }
    if (!this->Parallel)
    {
      const double z = m(2, 0) * centre[0] + m(2, 1) * centre[1] + m(2, 2) * centre[2] + m(2, 3);
      const double near = z - width * this->HalfCell[2];
      const double far = z + width * this->HalfCell[2];
      if (!(far > 0))
      {
        return { 0, -1, 0, -1 };
      }
      if (!(near > 0))
      {
        return { extent[0], extent[1], extent[2], extent[3] };
      }
      for (int a = 0; a < 2; ++a)
      {
        low[a] /= low[a] < 0 ? near : far;
        high[a] /= high[a] < 0 ? far : near;
      }
    }
    constexpr double margin = 1e-6; // pixels
    int box[4];
    for (int a = 0; a < 2; ++a)
    {
      // not floor and ceil, which are calls on old processors
      const double size = 1.0 * extent[2 * a + 1] - extent[2 * a];
      const double from = std::max(low[a] - margin - extent[2 * a], 0.0);
      const double to = std::min(high[a] + margin - extent[2 * a], size);
      if (!(from <= to))
      {
        return { 0, -1, 0, -1 };
      }
      const int first = static_cast<int>(from);
      box[2 * a] = extent[2 * a] + first + (first < from);
      box[2 * a + 1] = extent[2 * a] + static_cast<int>(to);
    }
    return { box[0], box[1], box[2], box[3] };
  }

  /// The order along an axis of blocks 2^shift cells wide.
  FrontToBack Order(int axis, int first, int last, int shift) const
  {
    const double eye = this->Eye[axis] / (1 << shift);
    const int turn = eye <= first ? first : (eye >= last + 1 ? last + 1 : static_cast<int>(eye));
    return { first, last, turn };
  }

private:
  Matrix4 IndexToPixel;
  Vec3 HalfCell;
  Vec3 Eye; ///< voxels
  bool Parallel;
};
}
#endif
