// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSurfaceDistance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lacuna
{
namespace
{
// Nearest place of a triangle.
Vec3 FindFoot(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal)
{
  const double area = Dot(normal, normal);
  if (area > 0 && Dot(Cross(b - a, p - a), normal) >= 0 && Dot(Cross(c - b, p - b), normal) >= 0 &&
    Dot(Cross(a - c, p - c), normal) >= 0)
  {
    return p - (Dot(p - a, normal) / area) * normal;
  }
  Vec3 best = a;
  for (const auto& edge : { std::array<Vec3, 2>{ a, b }, { b, c }, { c, a } })
  {
    const Vec3 along = edge[1] - edge[0];
    const double length = Dot(along, along);
    const double t = length > 0 ? std::clamp(Dot(p - edge[0], along) / length, 0.0, 1.0) : 0;
    const Vec3 foot = edge[0] + t * along;
    best = Norm(p - foot) < Norm(p - best) ? foot : best;
  }
  return best;
}
}

//------------------------------------------------------------------------------
SurfaceDistance::SurfaceDistance(const TriangleSurface& surface)
  : Surface(surface)
  , Neighbors(surface.Points)
  , Firsts(surface.Points.size() + 1, 0)
{
  for (const auto& triangle : surface.Triangles)
  {
    for (const std::int32_t p : triangle)
    {
      ++this->Firsts[p + 1];
    }
  }
  for (std::size_t i = 1; i < this->Firsts.size(); ++i)
  {
    this->Firsts[i] += this->Firsts[i - 1];
  }
  this->Around.resize(this->Firsts.back());
  std::vector<std::size_t> at(this->Firsts.begin(), this->Firsts.end() - 1);
  for (std::size_t t = 0; t < surface.Triangles.size(); ++t)
  {
    for (const std::int32_t p : surface.Triangles[t])
    {
      this->Around[at[p]++] = t;
    }
  }
}

//------------------------------------------------------------------------------
double SurfaceDistance::Get(const Vec3& x) const
{
  constexpr std::size_t count = 6;
  std::vector<std::size_t> nearest;
  this->Neighbors.Find(x, count, nearest);
  double least = std::numeric_limits<double>::infinity();
  double facing =
    0; // of the triangles with the least distance the one that is seen most from the front
  double side = 1;
  for (const std::size_t p : nearest)
  {
    for (std::size_t k = this->Firsts[p]; k < this->Firsts[p + 1]; ++k)
    {
      const auto& t = this->Surface.Triangles[this->Around[k]];
      const Vec3& a = this->Surface.Points[t[0]];
      const Vec3& b = this->Surface.Points[t[1]];
      const Vec3& c = this->Surface.Points[t[2]];
      const Vec3 normal = Cross(b - a, c - a);
      const Vec3 way = x - FindFoot(x, a, b, c, normal);
      const double distance = Norm(way);
      const double height = Dot(way, normal) / Norm(normal);
      constexpr double same = 1e-9;
      const bool nearer = distance < least * (1 - same);
      if (nearer || (distance <= least * (1 + same) && std::abs(height) > facing))
      {
        least = nearer ? distance : least;
        facing = std::abs(height);
        side = height < 0 ? -1 : 1;
      }
    }
  }
  return side * least;
}
}
