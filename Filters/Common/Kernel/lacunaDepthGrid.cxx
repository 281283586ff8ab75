// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDepthGrid.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace lacuna
{
namespace
{
constexpr int RowGrain = 16;

struct Box
{
  Vec3 Low{ std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
    std::numeric_limits<double>::infinity() };
  Vec3 High = -1 * Low;

  void Add(const Vec3& low, const Vec3& high)
  {
    for (int a = 0; a < 3; ++a)
    {
      this->Low[a] = std::min(this->Low[a], low[a]);
      this->High[a] = std::max(this->High[a], high[a]);
    }
  }
};
}

Vec3 DepthGrid::RayOf(int column, int row) const
{
  const Matrix4& m = this->ImageToWorld;
  return Normalized(this->Perspective
      ? m.Point({ static_cast<double>(column), static_cast<double>(row), 0 }) - this->Eye
      : m.Column(2));
}

Vec3 DepthGrid::PointOf(int column, int row) const
{
  const Vec3 pixel =
    this->ImageToWorld.Point({ static_cast<double>(column), static_cast<double>(row), 0 });
  return pixel + this->Depth[this->PixelOf(column, row)] * this->RayOf(column, row);
}

DepthEdge DepthGrid::EdgeBetween(const Vec3& from, const Vec3& to) const
{
  const Vec3 ray =
    Normalized(this->Perspective ? 0.5 * (from + to) - this->Eye : this->ImageToWorld.Column(2));
  DepthEdge edge;
  edge.Step = to - from;
  edge.Along = Dot(edge.Step, ray);
  edge.Across = Norm(edge.Step - edge.Along * ray);
  return edge;
}

DepthEdge DepthGrid::EdgeFrom(int column, int row, int right, int down) const
{
  if (!this->IsDefined(column, row) || !this->IsDefined(column + right, row + down))
  {
    return DepthEdge::Missing();
  }
  return this->EdgeBetween(this->PointOf(column, row), this->PointOf(column + right, row + down));
}

Sphere CircumscribedSphere(const DepthGrid& grid, Execution& execution)
{
  const auto& e = grid.Extent;
  const std::int64_t rows = std::max<std::int64_t>(0, static_cast<std::int64_t>(e[3]) - e[2] + 1);
  std::vector<Box> boxes(rows);
  execution.For(rows, RowGrain,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t r = begin; r < end; ++r)
      {
        const int row = static_cast<int>(e[2] + r);
        for (int column = e[0]; column <= e[1]; ++column)
        {
          if (grid.IsDefined(column, row))
          {
            const Vec3 p = grid.PointOf(column, row);
            boxes[r].Add(p, p);
          }
        }
      }
    });
  Box all;
  for (const Box& box : boxes)
  {
    all.Add(box.Low, box.High);
  }
  if (!(all.Low[0] <= all.High[0]))
  {
    return Sphere();
  }
  return { 0.5 * all.Low + 0.5 * all.High, 0.5 * Norm(all.High - all.Low) };
}
}
