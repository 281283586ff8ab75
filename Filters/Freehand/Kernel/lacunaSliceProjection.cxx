// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSliceProjection.h"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace lacuna
{
namespace
{
constexpr double Degree = 3.14159265358979323846 / 180;

// (point - origin) . gradient as a function of the map's pixels.
PixelFunction MakeFunction(const ImagePlane& plane, const Vec3& origin, const Vec3& gradient)
{
  return { Dot(plane.Origin - origin, gradient), plane.PixelSpacing * Dot(plane.Right, gradient),
    plane.PixelSpacing * Dot(plane.Down, gradient) };
}

// The index of a real number, cut to columns and their neighbours.
std::int64_t ToIndex(double x, IndexInterval columns)
{
  return x > static_cast<double>(columns.First) - 1
    ? (x < static_cast<double>(columns.Last) + 1 ? static_cast<std::int64_t>(x) : columns.Last + 1)
    : columns.First - 1;
}

// Keeps the columns i with low <= atRow + step i <= high, just those at which this is so as
// computed: rounding keeps the order, so they form an interval.
IndexInterval Narrow(double atRow, double step, double low, double high, IndexInterval columns)
{
  if (step < 0)
  {
    atRow = -atRow;
    step = -step;
    low = -std::exchange(high, -low);
  }
  const auto at = [&](std::int64_t i) { return atRow + step * static_cast<double>(i); };
  // Divisions come within a pixel or so of both ends; then the comparisons decide.
  IndexInterval kept = columns;
  if (step > 0)
  {
    kept.First = std::max(columns.First, ToIndex(std::ceil((low - atRow) / step), columns));
    kept.Last = std::min(columns.Last, ToIndex(std::floor((high - atRow) / step), columns));
  }
  while (kept.First > columns.First && at(kept.First - 1) >= low)
  {
    --kept.First;
  }
  while (kept.First <= columns.Last && !(at(kept.First) >= low))
  {
    ++kept.First;
  }
  while (kept.Last < columns.Last && at(kept.Last + 1) <= high)
  {
    ++kept.Last;
  }
  while (kept.Last >= kept.First && !(at(kept.Last) <= high))
  {
    --kept.Last;
  }
  return kept;
}
}

bool SliceProjection::IsEdgeOn(const SliceImage& slice, const ImagePlane& plane)
{
  const Vec3 normal =
    Normalized(Cross(slice.PixelToReference.Column(0), slice.PixelToReference.Column(1)));
  return std::abs(Dot(normal, plane.View)) < std::sin(SmallestAngle * Degree);
}

SliceProjection::SliceProjection(const SliceImage& slice, const ImagePlane& plane)
  : Slice(slice)
  , LastColumn(slice.Width - 1)
  , LastRow(slice.Height - 1)
{
  // A ray's point is origin + column x + row y: what is perpendicular to the ray and to y tells the
  // column, what is perpendicular to the ray and to x the row, and the slice's normal the depth.
  const Vec3 x = slice.PixelToReference.Column(0);
  const Vec3 y = slice.PixelToReference.Column(1);
  const Vec3 origin = slice.PixelToReference.Column(3);
  const Vec3 area = Cross(x, y);
  const double towards = Dot(area, plane.View);
  this->Column = MakeFunction(plane, origin, (1 / towards) * Cross(y, plane.View));
  this->Row = MakeFunction(plane, origin, (1 / towards) * Cross(plane.View, x));
  this->Depth = MakeFunction(plane, origin, (-1 / towards) * area);
  for (const PixelFunction& f : { this->Column, this->Row, this->Depth })
  {
    if (!std::isfinite(f.C) || !std::isfinite(f.I) || !std::isfinite(f.J))
    {
      throw std::invalid_argument(slice.Label + ": its pose lies too far off to be seen");
    }
  }
}

IndexInterval SliceProjection::GetRow(std::int64_t j, IndexInterval columns) const
{
  columns = Narrow(
    this->Column.AtRow(j), this->Column.I, -Tolerance, this->LastColumn + Tolerance, columns);
  return Narrow(this->Row.AtRow(j), this->Row.I, -Tolerance, this->LastRow + Tolerance, columns);
}
}
