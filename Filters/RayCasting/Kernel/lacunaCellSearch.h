// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Finds where a ray enters the solid within one cell.
#ifndef lacunaCellSearch_h
#define lacunaCellSearch_h

#include "lacunaRay.h"
#include "lacunaTensorCell.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lacuna
{
/// What is known of the field at a point of a ray.
enum class RayState
{
  Unknown,
  Outside,
  Inside
};

/// The point of a ray at t in the coordinates of a cell, 0..1.
inline Vec3 LocalPoint(const Ray& ray, const std::array<int, 3>& cell, double t)
{
  Vec3 local;
  for (int a = 0; a < 3; ++a)
  {
    local[a] = std::min(std::max(ray.A[a] + t * ray.B[a] - cell[a], 0.0), 1.0);
  }
  return local;
}

enum class CellFinding
{
  Nothing,
  Entry,
  Doubt ///< the field is zero but for rounding where the ray enters or leaves the cell
};

/// Looks for the first entry between from and to, p being the field along the ray between them.
/// state is that before the cell and becomes that behind it. s: 0 at from, 1 at to.
template <int Support>
bool FindEntryInCell(const TensorCell<Support>& cell, ScaledBernstein& p, Vec3 from, const Vec3& to,
  RayState& state, double& s)
{
  constexpr double noLength = 1e-9; // of the way through a cell
  double start = 0;
  if (p.A[0] >= 0 && state != RayState::Outside)
  {
    state = RayState::Inside;
    if (!FindFirstSignChange(p, start))
    {
      return false;
    }
    state = RayState::Outside;
    if (1 - start < noLength)
    {
      return false;
    }
    from = from + start * (to - from);
    p = cell.Along(from, to);
    p.A[0] = -std::numeric_limits<double>::min(); // zero but for rounding, and falling
  }
  else if (p.A[0] >= 0)
  {
    // The last cell ended outside, so this is zero but for rounding: an entry if the field rises
    // from here, and if it falls the exit that the last cell has seen already.
    p.A[0] = -std::numeric_limits<double>::min();
  }
  state = RayState::Outside;
  if (!FindFirstSignChange(p, s))
  {
    return false;
  }
  s = start + s * (1 - start);
  return true;
}

/// The same for a ray of which nothing is known. doubt: values of the field up to this are zero but
/// for rounding.
template <int Support>
CellFinding SearchCellAlone(const TensorCell<Support>& cell, ScaledBernstein& p, const Vec3& from,
  const Vec3& to, double doubt, double& s)
{
  if (!(std::abs(p.A[0]) > doubt && std::abs(p.A[p.Degree]) > doubt))
  {
    return CellFinding::Doubt;
  }
  RayState state = RayState::Unknown;
  return FindEntryInCell(cell, p, from, to, state, s) ? CellFinding::Entry : CellFinding::Nothing;
}
}
#endif
