// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRayBatch.h"

#include "lacunaWide.h"

#include <limits>

namespace lacuna
{
namespace
{
LACUNA_INLINE Four Clamp(const Four& a)
{
  return Lesser(Greater(a, All(0)), All(1));
}

template <bool Parallel>
LACUNA_INLINE unsigned Clip(const RayGrid& rays, const std::array<int, 3>& cell, const Vec3& low,
  const Vec3& high, RayBatch& batch)
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Four column = batch.Column;
  const Four row = batch.Row;
  Four first = batch.First;
  Four last = batch.Last;
  for (int a = 0; a < 3; ++a)
  {
    // as RayGrid::Get
    const Four start =
      (All(rays.First.A[a]) + row * All(rays.PerRow.A[a])) + column * All(rays.PerColumn.A[a]);
    const Four step =
      (All(rays.First.B[a]) + row * All(rays.PerRow.B[a])) + column * All(rays.PerColumn.B[a]);
    batch.A[a] = start;
    batch.B[a] = step;
    const Four inverse = Parallel ? All(1 / rays.First.B[a]) : All(1) / step;
    const Four u = (All(low[a]) - start) * inverse;
    const Four v = (All(high[a]) - start) * inverse;
    Four enters = Lesser(u, v);
    Four leaves = Greater(u, v);
    if (!Parallel || rays.First.B[a] == 0)
    {
      // a ray that does not move along the axis is between the faces throughout, or never
      const Four beyond =
        ((start >= All(low[a])) & (start < All(high[a]))) ? All(infinity) : All(-infinity);
      enters = step == All(0) ? -beyond : enters;
      leaves = step == All(0) ? beyond : leaves;
    }
    first = Greater(first, enters);
    last = Lesser(last, leaves);
  }
  for (int a = 0; a < 3; ++a)
  {
    const Four corner = All(cell[a]);
    batch.From[a] = Clamp(batch.A[a] + first * batch.B[a] - corner);
    batch.To[a] = Clamp(batch.A[a] + last * batch.B[a] - corner);
  }
  batch.First = first;
  batch.Last = last;
  return ToBits(first < last);
}

LACUNA_WIDE unsigned ClipParallel(const RayGrid& rays, const std::array<int, 3>& cell,
  const Vec3& low, const Vec3& high, RayBatch& batch)
{
  return Clip<true>(rays, cell, low, high, batch);
}

LACUNA_WIDE unsigned ClipPerspective(const RayGrid& rays, const std::array<int, 3>& cell,
  const Vec3& low, const Vec3& high, RayBatch& batch)
{
  return Clip<false>(rays, cell, low, high, batch);
}

LACUNA_WIDE unsigned LanesBetween(const CellPlanes& planes, const RayBatch& batch)
{
  const Four x = All(planes.Slope[0]);
  const Four y = All(planes.Slope[1]);
  const Four z = All(planes.Slope[2]);
  const Four u = x * batch.From[0] + y * batch.From[1] + z * batch.From[2];
  const Four v = x * batch.To[0] + y * batch.To[1] + z * batch.To[2];
  return ToBits(
    (Greater(u, v) + All(planes.High) >= All(0)) & (Lesser(u, v) + All(planes.Low) <= All(0)));
}

LACUNA_WIDE unsigned LanesThatChange(const Four* coefficients, int count, double doubt)
{
  Four low = coefficients[0];
  Four high = coefficients[0];
  for (int m = 1; m < count; ++m)
  {
    low = Lesser(low, coefficients[m]);
    high = Greater(high, coefficients[m]);
  }
  const Four first = coefficients[0];
  const Four last = coefficients[count - 1];
  const FourMask signs = (low < All(0)) & (high >= All(0));
  const FourMask doubtful = (Lesser(Greater(first, -first), Greater(last, -last)) <= All(doubt));
  return ToBits(signs | doubtful);
}
}

unsigned RayBatch::Clip(
  const RayGrid& rays, const std::array<int, 3>& cell, const Vec3& low, const Vec3& high)
{
  const unsigned lanes = rays.Parallel ? ClipParallel(rays, cell, low, high, *this)
                                       : ClipPerspective(rays, cell, low, high, *this);
  return lanes & ((1U << this->Count) - 1);
}

unsigned RayBatch::FindChanges(const Four* coefficients, int count, double doubt)
{
  return LanesThatChange(coefficients, count, doubt);
}

unsigned RayBatch::FindBetween(const CellPlanes& planes) const
{
  return LanesBetween(planes, *this);
}
}
