// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaGridChecks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <stdexcept>

namespace lacuna
{
//------------------------------------------------------------------------------
void CheckSize(GridSize size, std::size_t samples)
{
  if (size.Columns < 4 || size.Rows < 4)
  {
    std::ostringstream message;
    message << "a bicubic surface needs at least 4 x 4 samples, these are " << size.Columns << " x "
            << size.Rows;
    throw std::invalid_argument(message.str());
  }
  if (samples != static_cast<std::size_t>(size.Columns) * static_cast<std::size_t>(size.Rows))
  {
    throw std::invalid_argument("the number of samples is not columns x rows");
  }
}

//------------------------------------------------------------------------------
void ThrowAt(GridSize size, std::size_t index, const std::string& what)
{
  std::ostringstream message;
  message << what << " at column " << static_cast<std::int64_t>(index) % size.Columns << ", row "
          << static_cast<std::int64_t>(index) / size.Columns;
  throw std::invalid_argument(message.str());
}

//------------------------------------------------------------------------------
void CheckRegular(GridSize size, const std::vector<Vec3>& points)
{
  CheckSize(size, points.size());
  const std::int64_t columns = size.Columns;
  double extent = 0;
  for (std::size_t k = 0; k < points.size(); ++k)
  {
    if (!IsFinite(points[k]))
    {
      ThrowAt(size, k, "the point is not finite");
    }
    extent = std::max(extent, Norm(points[k] - points.front()));
  }
  const auto at = [&](std::int64_t i, std::int64_t j) -> const Vec3&
  { return points[i + columns * j]; };
  const auto check = [&](std::int64_t i, std::int64_t j, const Vec3& neighbour)
  {
    if (!(Norm(at(i, j) - neighbour) > 1e-9 * extent))
    {
      ThrowAt(size, i + columns * j, "the point coincides with a neighbour");
    }
  };
  for (std::int64_t j = 0; j < size.Rows; ++j)
  {
    for (std::int64_t i = 0; i < columns; ++i)
    {
      if (i + 1 < columns)
      {
        check(i, j, at(i + 1, j));
      }
      if (j + 1 < size.Rows)
      {
        check(i, j, at(i, j + 1));
      }
    }
  }
  // Directions of the facet (i, j) as its corners see them; nearly the same for a flat one.
  const auto corners = [&](std::int64_t i, std::int64_t j) -> std::array<Vec3, 4>
  {
    const Vec3 top = at(i + 1, j) - at(i, j);
    const Vec3 bottom = at(i + 1, j + 1) - at(i, j + 1);
    const Vec3 left = at(i, j + 1) - at(i, j);
    const Vec3 right = at(i + 1, j + 1) - at(i + 1, j);
    return { Normalized(Cross(top, left)), Normalized(Cross(top, right)),
      Normalized(Cross(bottom, left)), Normalized(Cross(bottom, right)) };
  };
  for (std::int64_t j = 0; j + 1 < size.Rows; ++j)
  {
    for (std::int64_t i = 0; i + 1 < columns; ++i)
    {
      const std::array<Vec3, 4> own = corners(i, j);
      bool folded = false;
      for (const Vec3& n : own)
      {
        if (!(Dot(n, n) > 0))
        {
          ThrowAt(size, i + columns * j, "the facet has no area");
        }
        folded = folded || Dot(n, own[0]) < -0.5;
      }
      folded = folded || (i + 2 < columns && Dot(own[0], corners(i + 1, j)[0]) < -0.5) ||
        (j + 2 < size.Rows && Dot(own[0], corners(i, j + 1)[0]) < -0.5);
      if (folded)
      {
        ThrowAt(
          size, i + columns * j, "the surface folds back (facets turn by more than 120 degrees)");
      }
    }
  }
}
}
