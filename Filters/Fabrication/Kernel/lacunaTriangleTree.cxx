// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaTriangleTree.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace lacuna
{
namespace
{
constexpr std::int32_t LeafSize = 4;

double GetSquaredDistanceToBox(const Vec3& x, const Vec3& low, const Vec3& high)
{
  double sum = 0;
  for (int k = 0; k < 3; ++k)
  {
    const double way = std::max({ low[k] - x[k], 0.0, x[k] - high[k] });
    sum += way * way;
  }
  return sum;
}

double GetOrientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d)
{
  return Dot(Cross(b - a, c - a), d - a);
}

// Whether the segment passes through the inside of the triangle.
bool Pierces(const Vec3& from, const Vec3& to, const Vec3& a, const Vec3& b, const Vec3& c)
{
  // what is nearer to zero than rounding makes it touches only
  const double size = Norm(to - from) + Norm(b - a) + Norm(c - a);
  const double zero = 1e-12 * size * size * size;
  const double first = GetOrientation(a, b, c, from);
  const double last = GetOrientation(a, b, c, to);
  if (!((first > zero && last < -zero) || (first < -zero && last > zero)))
  {
    return false;
  }
  const double one = GetOrientation(from, to, a, b);
  const double two = GetOrientation(from, to, b, c);
  const double three = GetOrientation(from, to, c, a);
  return (one > zero && two > zero && three > zero) ||
    (one < -zero && two < -zero && three < -zero);
}
}

//------------------------------------------------------------------------------
// Ericson, Real-Time Collision Detection (2005), 5.1.5.
double GetSquaredDistance(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c)
{
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 ax = x - a;
  const auto square = [&](const Vec3& way) { return Dot(way, way); };
  const double d1 = Dot(ab, ax);
  const double d2 = Dot(ac, ax);
  if (d1 <= 0 && d2 <= 0)
  {
    return square(ax);
  }
  const Vec3 bx = x - b;
  const double d3 = Dot(ab, bx);
  const double d4 = Dot(ac, bx);
  if (d3 >= 0 && d4 <= d3)
  {
    return square(bx);
  }
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3)
  {
    return square(ax - d1 / (d1 - d3) * ab);
  }
  const Vec3 cx = x - c;
  const double d5 = Dot(ab, cx);
  const double d6 = Dot(ac, cx);
  if (d6 >= 0 && d5 <= d6)
  {
    return square(cx);
  }
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6)
  {
    return square(ax - d2 / (d2 - d6) * ac);
  }
  const double va = d3 * d6 - d5 * d4;
  const double along = (d4 - d3) + (d5 - d6);
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0 && along > 0)
  {
    return square(bx - (d4 - d3) / along * (c - b));
  }
  const double whole = va + vb + vc;
  if (!(whole > 0)) // no area
  {
    return std::min({ square(ax), square(bx), square(cx) });
  }
  return square(ax - vb / whole * ab - vc / whole * ac);
}

//------------------------------------------------------------------------------
TriangleTree::TriangleTree(const ClosedMesh& mesh)
  : Mesh(mesh)
  , Order(mesh.Triangles.size())
{
  std::iota(this->Order.begin(), this->Order.end(), 0);
  this->Nodes.reserve(mesh.Triangles.size());
  this->Build(0, static_cast<std::int32_t>(this->Order.size()));
}

//------------------------------------------------------------------------------
void TriangleTree::Build(std::int32_t first, std::int32_t last)
{
  constexpr double Infinity = std::numeric_limits<double>::infinity();
  const std::size_t number = this->Nodes.size();
  Node node{ { Infinity, Infinity, Infinity }, { -Infinity, -Infinity, -Infinity }, first,
    last - first };
  for (std::int32_t i = first; i < last; ++i)
  {
    for (const std::int32_t id : this->Mesh.Triangles[this->Order[i]])
    {
      for (int k = 0; k < 3; ++k)
      {
        node.Low[k] = std::min(node.Low[k], this->Mesh.Points[id][k]);
        node.High[k] = std::max(node.High[k], this->Mesh.Points[id][k]);
      }
    }
  }
  this->Nodes.push_back(node);
  if (node.Count <= LeafSize)
  {
    return;
  }
  const Vec3 size = node.High - node.Low;
  const int axis = size[0] >= size[1] && size[0] >= size[2] ? 0 : size[1] >= size[2] ? 1 : 2;
  const std::int32_t middle = first + (last - first) / 2;
  const auto place = [&](std::int32_t triangle)
  {
    const ClosedMesh::Triangle& ids = this->Mesh.Triangles[triangle];
    return this->Mesh.Points[ids[0]][axis] + this->Mesh.Points[ids[1]][axis] +
      this->Mesh.Points[ids[2]][axis];
  };
  std::nth_element(this->Order.begin() + first, this->Order.begin() + middle,
    this->Order.begin() + last,
    [&](std::int32_t a, std::int32_t b) { return place(a) < place(b); });
  this->Nodes[number].Count = 0;
  this->Build(first, middle);
  this->Nodes[number].First = static_cast<std::int32_t>(this->Nodes.size());
  this->Build(middle, last);
}

//------------------------------------------------------------------------------
double TriangleTree::GetDistance(const Vec3& x) const
{
  double best = std::numeric_limits<double>::infinity();
  std::int32_t stack[64]; // halves: a tree of 2^31 triangles is not deeper
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0)
  {
    const std::int32_t number = stack[--depth];
    const Node& node = this->Nodes[number];
    if (GetSquaredDistanceToBox(x, node.Low, node.High) >= best)
    {
      continue;
    }
    for (std::int32_t i = node.First; i < node.First + node.Count; ++i)
    {
      const ClosedMesh::Triangle& ids = this->Mesh.Triangles[this->Order[i]];
      best = std::min(best,
        GetSquaredDistance(
          x, this->Mesh.Points[ids[0]], this->Mesh.Points[ids[1]], this->Mesh.Points[ids[2]]));
    }
    if (node.Count == 0)
    {
      const Node& one = this->Nodes[number + 1];
      const Node& two = this->Nodes[node.First];
      const bool oneFirst = GetSquaredDistanceToBox(x, one.Low, one.High) <
        GetSquaredDistanceToBox(x, two.Low, two.High);
      stack[depth++] = oneFirst ? node.First : number + 1;
      stack[depth++] = oneFirst ? number + 1 : node.First;
    }
  }
  return std::sqrt(best);
}

//------------------------------------------------------------------------------
std::int32_t TriangleTree::FindCrossing(std::int32_t triangle) const
{
  const ClosedMesh::Triangle& own = this->Mesh.Triangles[triangle];
  const Vec3 p[3] = { this->Mesh.Points[own[0]], this->Mesh.Points[own[1]],
    this->Mesh.Points[own[2]] };
  Vec3 low = p[0];
  Vec3 high = p[0];
  for (int k = 0; k < 3; ++k)
  {
    low[k] = std::min({ p[0][k], p[1][k], p[2][k] });
    high[k] = std::max({ p[0][k], p[1][k], p[2][k] });
  }
  std::int32_t stack[64];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0)
  {
    const std::int32_t number = stack[--depth];
    const Node& node = this->Nodes[number];
    bool apart = false;
    for (int k = 0; k < 3; ++k)
    {
      apart = apart || node.Low[k] > high[k] || node.High[k] < low[k];
    }
    if (apart)
    {
      continue;
    }
    if (node.Count == 0)
    {
      stack[depth++] = node.First;
      stack[depth++] = number + 1;
    }
    for (std::int32_t i = node.First; i < node.First + node.Count; ++i)
    {
      const std::int32_t other = this->Order[i];
      if (other <= triangle)
      {
        continue;
      }
      const ClosedMesh::Triangle& ids = this->Mesh.Triangles[other];
      const Vec3 q[3] = { this->Mesh.Points[ids[0]], this->Mesh.Points[ids[1]],
        this->Mesh.Points[ids[2]] };
      for (int k = 0; k < 3; ++k) // an edge that has a corner in common touches only
      {
        if (Pierces(p[k], p[(k + 1) % 3], q[0], q[1], q[2]) ||
          Pierces(q[k], q[(k + 1) % 3], p[0], p[1], p[2]))
        {
          return other;
        }
      }
    }
  }
  return -1;
}
}
