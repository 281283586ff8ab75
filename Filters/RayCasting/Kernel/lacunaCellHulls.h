// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which cells of a block hold no surface: the hulls of their Bezier points.
#ifndef lacunaCellHulls_h
#define lacunaCellHulls_h

#include "lacunaVector.h"

#include <cstdint>

namespace lacuna
{
/// The classes of the 4^3 cells of a block, x fastest. A cell in neither set may hold surface.
struct CellHulls
{
  std::uint64_t Outside = 0; ///< negative throughout the cell
  std::uint64_t Inside = 0;  ///< positive throughout the cell

  static int BitOf(int i, int j, int k) { return (i & 3) | (j & 3) << 2 | (k & 3) << 4; }
};

/// Encloses the field in a cell between two parallel planes, in the cell's local coordinates x:
/// Low <= field - Slope . x <= High.
struct CellPlanes
{
  Vec3 Slope;
  double Low;
  double High;
};

/// The control points of a block of 4^3 cells with a tensor-product field: uniform cubic B-spline
/// (Support 4: points -1..5 along each axis) or trilinear (Support 2: 0..4).
template <int Support>
struct BlockPoints
{
  static constexpr int Width = Support + 3;
  static constexpr int RowSize = 8;
  /// [z][y][x]. Elements from Width on are no points.
  alignas(32) float Values[Width][Width][RowSize];
  float ReadTooFar[2]; ///< by vector code
  /// How far rounding may have moved a Bezier point. Infinite where float overflows or loses
  /// digits.
  float Tolerance;

  /// Sets the tolerance from the values. rounded: the greatest number that was rounded to float
  /// for them.
  void SetTolerance(float rounded);

  /// Inside a cell the field is a convex combination of the cell's Bezier points, which are much
  /// nearer to it than its control points. Cells with a Bezier point that may have another sign
  /// but for rounding are in neither set.
  CellHulls Classify() const;

  /// i, j, k: 0..3.
  CellPlanes FindPlanes(int i, int j, int k) const;
};

extern template struct BlockPoints<2>;
extern template struct BlockPoints<4>;
}
#endif
