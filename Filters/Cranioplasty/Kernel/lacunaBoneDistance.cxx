// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaBoneDistance.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lacuna
{
namespace
{
constexpr double CellSize = 1.5; // mm

template <class Visit>
void ForCells(const std::array<std::int64_t, 3>& from, const std::array<std::int64_t, 3>& to,
  const std::array<std::int64_t, 3>& size, const Visit& visit)
{
  for (std::int64_t k = from[2]; k <= to[2]; ++k)
  {
    for (std::int64_t j = from[1]; j <= to[1]; ++j)
    {
      for (std::int64_t i = from[0]; i <= to[0]; ++i)
      {
        visit(i + size[0] * (j + size[1] * k));
      }
    }
  }
}
}

//------------------------------------------------------------------------------
Vec3 FindNearestOfTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c)
{
  const Vec3 normal = Cross(b - a, c - a);
  const double area = Dot(normal, normal);
  if (area > 0 && Dot(Cross(b - a, p - a), normal) >= 0 && Dot(Cross(c - b, p - b), normal) >= 0 &&
    Dot(Cross(a - c, p - c), normal) >= 0)
  {
    return p - (Dot(p - a, normal) / area) * normal;
  }
  Vec3 best = a;
  double least = Dot(p - a, p - a);
  for (const auto& edge : { std::array<Vec3, 2>{ a, b }, { b, c }, { c, a } })
  {
    const Vec3 along = edge[1] - edge[0];
    const double length = Dot(along, along);
    const double t = length > 0 ? std::clamp(Dot(p - edge[0], along) / length, 0.0, 1.0) : 0;
    const Vec3 foot = edge[0] + t * along;
    const double square = Dot(p - foot, p - foot);
    if (square < least)
    {
      least = square;
      best = foot;
    }
  }
  return best;
}

//------------------------------------------------------------------------------
TriangleBone::TriangleBone(TriangleSurface surface, std::function<bool(const Vec3&)> isBone)
  : Surface(std::move(surface))
  , IsBone(std::move(isBone))
{
  if (this->Surface.Triangles.empty())
  {
    this->First.assign(2, 0);
    return;
  }
  this->Low = this->High = this->Surface.Points[this->Surface.Triangles[0][0]];
  for (const auto& triangle : this->Surface.Triangles)
  {
    for (const std::int32_t corner : triangle)
    {
      for (int a = 0; a < 3; ++a)
      {
        this->Low[a] = std::min(this->Low[a], this->Surface.Points[corner][a]);
        this->High[a] = std::max(this->High[a], this->Surface.Points[corner][a]);
      }
    }
  }
  for (int a = 0; a < 3; ++a)
  {
    this->Size[a] = static_cast<std::int64_t>((this->High[a] - this->Low[a]) / CellSize) + 1;
  }
  this->First.assign(this->Size[0] * this->Size[1] * this->Size[2] + 1, 0);
  const auto forCells = [&](const auto& triangle, const auto& visit)
  {
    Vec3 low = this->Surface.Points[triangle[0]];
    Vec3 high = low;
    for (const std::int32_t corner : triangle)
    {
      for (int a = 0; a < 3; ++a)
      {
        low[a] = std::min(low[a], this->Surface.Points[corner][a]);
        high[a] = std::max(high[a], this->Surface.Points[corner][a]);
      }
    }
    ForCells(this->CellOf(low), this->CellOf(high), this->Size, visit);
  };
  for (const auto& triangle : this->Surface.Triangles)
  {
    forCells(triangle, [&](std::int64_t cell) { ++this->First[cell + 1]; });
  }
  for (std::size_t cell = 1; cell < this->First.size(); ++cell)
  {
    this->First[cell] += this->First[cell - 1];
  }
  this->Items.resize(this->First.back());
  std::vector<std::int64_t> at(this->First.begin(), this->First.end() - 1);
  for (std::size_t t = 0; t < this->Surface.Triangles.size(); ++t)
  {
    forCells(this->Surface.Triangles[t],
      [&](std::int64_t cell) { this->Items[at[cell]++] = static_cast<std::int32_t>(t); });
  }
}

//------------------------------------------------------------------------------
std::array<std::int64_t, 3> TriangleBone::CellOf(const Vec3& x) const
{
  std::array<std::int64_t, 3> cell{};
  for (int a = 0; a < 3; ++a)
  {
    // far away: before it becomes an integer
    const double place = std::clamp((x[a] - this->Low[a]) / CellSize, -1e6, 1e6);
    cell[a] =
      std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor(place)), 0, this->Size[a] - 1);
  }
  return cell;
}

//------------------------------------------------------------------------------
NearestBone TriangleBone::Find(const Vec3& x, double limit) const
{
  NearestBone nearest{ limit, x };
  double square = limit * limit;
  const auto look = [&](std::int64_t cell)
  {
    for (std::int64_t k = this->First[cell]; k < this->First[cell + 1]; ++k)
    {
      const auto& t = this->Surface.Triangles[this->Items[k]];
      const Vec3 foot = FindNearestOfTriangle(
        x, this->Surface.Points[t[0]], this->Surface.Points[t[1]], this->Surface.Points[t[2]]);
      const double distance = Dot(x - foot, x - foot);
      if (distance < square)
      {
        square = distance;
        nearest.Point = foot;
      }
    }
  };
  // the cells around x first: what they hold is mostly the nearest
  const double steps[] = { std::min(0.5 * CellSize, limit), limit };
  for (const double reach : steps)
  {
    if (square <= reach * reach && reach < limit)
    {
      break;
    }
    const double radius = std::min(reach, std::sqrt(square));
    const Vec3 aside{ radius, radius, radius };
    bool isBeside = false;
    for (int a = 0; a < 3; ++a)
    {
      isBeside = isBeside || x[a] + radius < this->Low[a] || x[a] - radius > this->High[a];
    }
    if (!isBeside)
    {
      ForCells(this->CellOf(x - aside), this->CellOf(x + aside), this->Size, look);
    }
    if (square <= reach * reach)
    {
      break;
    }
  }
  nearest.Distance = std::sqrt(square) * (this->IsBone(x) ? -1 : 1);
  return nearest;
}
}
