// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Four rays at once in one cell, lane by lane. What comes out of a lane does not depend on the
/// others.
#ifndef lacunaRayBatch_h
#define lacunaRayBatch_h

#include "lacunaCellHulls.h"
#include "lacunaFour.h"
#include "lacunaRay.h"

#include <array>

namespace lacuna
{
struct RayBatch
{
  static constexpr int Lanes = 4;

  int Count = 0; ///< lanes in use
  Four Column{};
  Four Row{};
  Four A[3];
  Four B[3];
  /// First the part of the ray to follow, then that in the cell.
  Four First{};
  Four Last{};
  /// Where the ray enters and leaves the cell, in the coordinates of the cell, 0..1.
  Four From[3];
  Four To[3];

  /// Sets all but columns, rows, First and Last of the lanes in use. low, high: the cell's faces,
  /// from which the local coordinates count from cell on. Returns the lanes that cross the cell, as
  /// bits.
  unsigned Clip(
    const RayGrid& rays, const std::array<int, 3>& cell, const Vec3& low, const Vec3& high);

  /// The lanes that planes do not exclude from holding a zero.
  unsigned FindBetween(const CellPlanes& planes) const;

  /// The lanes whose polynomial, of count Bernstein coefficients, may change its sign or is zero at
  /// an end but for doubt.
  static unsigned FindChanges(const Four* coefficients, int count, double doubt);

  Ray GetRay(int lane) const
  {
    return { { this->A[0][lane], this->A[1][lane], this->A[2][lane] },
      { this->B[0][lane], this->B[1][lane], this->B[2][lane] } };
  }
  Vec3 GetFrom(int lane) const
  {
    return { this->From[0][lane], this->From[1][lane], this->From[2][lane] };
  }
  Vec3 GetTo(int lane) const { return { this->To[0][lane], this->To[1][lane], this->To[2][lane] }; }
};
}
#endif
