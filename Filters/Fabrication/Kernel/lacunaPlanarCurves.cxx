// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPlanarCurves.h"

#include <algorithm>
#include <limits>

namespace lacuna
{
//------------------------------------------------------------------------------
double SignedArea(const Loop& loop)
{
  double twice = 0;
  for (std::size_t k = 0; k < loop.size(); ++k)
  {
    const Vec2& a = loop[k];
    const Vec2& b = loop[(k + 1) % loop.size()];
    twice += (a[0] - loop[0][0]) * (b[1] - loop[0][1]) - (a[1] - loop[0][1]) * (b[0] - loop[0][0]);
  }
  return 0.5 * twice;
}

//------------------------------------------------------------------------------
namespace
{
// Edges of a grid: 2 * node is from the node to the right, 2 * node + 1 the one down.
// Links the edges of a cell that a contour crosses, with the inside on its left.
void LinkCell(const PlanarGrid& grid, const std::vector<double>& values, double level,
  std::int64_t node, std::vector<std::int64_t>& next)
{
  const std::int64_t columns = grid.Columns;
  // corners around the cell, x to y
  const double v[4] = { values[node], values[node + 1], values[node + columns + 1],
    values[node + columns] };
  int mask = 0;
  for (int k = 0; k < 4; ++k)
  {
    mask |= (v[k] >= level) << k;
  }
  if (mask == 0 || mask == 15)
  {
    return;
  }
  // edges[k] is between corners k and k + 1
  const std::int64_t edges[4] = { 2 * node, 2 * (node + 1) + 1, 2 * (node + columns),
    2 * node + 1 };
  const bool joined = v[0] + v[1] + v[2] + v[3] >= 4 * level; // saddles: by the middle
  for (int k = 0; k < 4; ++k)
  {
    const bool here = mask >> k & 1;
    const bool after = mask >> ((k + 1) % 4) & 1;
    if (!here || after)
    {
      continue;
    }
    // The inside ends on edge k. With it on the left the contour starts here and leaves where
    // the inside starts: the edge before this run of inside corners; in a saddle whose middle
    // is inside, the one after the next outside corner.
    int to;
    if ((mask == 5 || mask == 10) && joined)
    {
      to = (k + 1) % 4;
    }
    else
    {
      to = (k + 3) % 4;
      while (mask >> to & 1)
      {
        to = (to + 3) % 4;
      }
    }
    next[edges[k]] = edges[to];
  }
}

// Where the level is on an edge.
Vec2 FindOnEdge(
  const PlanarGrid& grid, const std::vector<double>& values, double level, std::int64_t edge)
{
  const std::int64_t columns = grid.Columns;
  const std::int64_t node = edge / 2;
  const std::int64_t other = edge % 2 ? node + columns : node + 1;
  const double t = std::clamp((level - values[node]) / (values[other] - values[node]), 0.0, 1.0);
  Vec2 p = grid.GetNode(node % columns, node / columns);
  p[edge % 2] += t * grid.Spacing[edge % 2];
  return p;
}
}

//------------------------------------------------------------------------------
std::vector<Loop> FindContours(
  const PlanarGrid& grid, const std::vector<double>& values, double level)
{
  std::vector<std::int64_t> next(2 * values.size(), -1);
  for (std::int64_t j = 0; j + 1 < grid.Rows; ++j)
  {
    for (std::int64_t i = 0; i + 1 < grid.Columns; ++i)
    {
      LinkCell(grid, values, level, i + grid.Columns * j, next);
    }
  }
  std::vector<Loop> loops;
  for (std::size_t start = 0; start < next.size(); ++start)
  {
    if (next[start] < 0)
    {
      continue;
    }
    Loop loop;
    for (auto edge = static_cast<std::int64_t>(start); next[edge] >= 0;)
    {
      loop.push_back(FindOnEdge(grid, values, level, edge));
      const std::int64_t following = next[edge];
      next[edge] = -1;
      edge = following;
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

//------------------------------------------------------------------------------
std::vector<double> FindCrossings(const std::vector<Loop>& loops, double y)
{
  std::vector<double> crossings;
  for (const Loop& loop : loops)
  {
    for (std::size_t k = 0; k < loop.size(); ++k)
    {
      const Vec2& a = loop[k];
      const Vec2& b = loop[(k + 1) % loop.size()];
      if ((a[1] <= y) != (b[1] <= y))
      {
        crossings.push_back(a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
      }
    }
  }
  std::sort(crossings.begin(), crossings.end());
  return crossings;
}

bool IsInside(const std::vector<double>& crossings, double x)
{
  const auto passed = std::upper_bound(crossings.begin(), crossings.end(), x);
  return (passed - crossings.begin()) % 2 != 0;
}

bool IsInside(const std::vector<Loop>& loops, const Vec2& p)
{
  return IsInside(FindCrossings(loops, p[1]), p[0]);
}

//------------------------------------------------------------------------------
CurveIndex::CurveIndex(const std::vector<std::vector<Vec3>>& curves, double cell)
  : Cell(cell)
{
  const double infinity = std::numeric_limits<double>::infinity();
  this->Low = { infinity, infinity };
  this->High = { -infinity, -infinity };
  for (const auto& curve : curves)
  {
    for (std::size_t k = 0; k < curve.size(); ++k)
    {
      this->Edges.push_back({ curve[k], curve[(k + 1) % curve.size()] });
      for (int i = 0; i < 2; ++i)
      {
        this->Low[i] = std::min(this->Low[i], curve[k][i]);
        this->High[i] = std::max(this->High[i], curve[k][i]);
      }
    }
  }
  if (this->Edges.empty())
  {
    this->Low = this->High = { 0, 0 };
  }
  // no more than a few cells for each edge
  const double width = this->High[0] - this->Low[0];
  const double height = this->High[1] - this->Low[1];
  while ((width / this->Cell + 1) * (height / this->Cell + 1) >
    16.0 * static_cast<double>(this->Edges.size()) + 1024)
  {
    this->Cell *= 2;
  }
  this->Columns = static_cast<std::int64_t>(width / this->Cell) + 1;
  this->Rows = static_cast<std::int64_t>(height / this->Cell) + 1;
  const auto visit = [&](const Edge& edge, const auto& body)
  {
    std::int64_t range[4];
    for (int i = 0; i < 2; ++i)
    {
      const double low = std::min(edge.A[i], edge.B[i]) - this->Low[i];
      const double high = std::max(edge.A[i], edge.B[i]) - this->Low[i];
      range[2 * i] = static_cast<std::int64_t>(low / this->Cell);
      range[2 * i + 1] = static_cast<std::int64_t>(high / this->Cell);
    }
    for (std::int64_t j = range[2]; j <= range[3]; ++j)
    {
      for (std::int64_t i = range[0]; i <= range[1]; ++i)
      {
        body(i + this->Columns * j);
      }
    }
  };
  this->First.assign(static_cast<std::size_t>(this->Columns * this->Rows + 1), 0);
  for (const Edge& edge : this->Edges)
  {
    visit(edge, [&](std::int64_t c) { ++this->First[c + 1]; });
  }
  for (std::size_t c = 1; c < this->First.size(); ++c)
  {
    this->First[c] += this->First[c - 1];
  }
  this->Items.resize(static_cast<std::size_t>(this->First.back()));
  std::vector<std::int64_t> fill(this->First.begin(), this->First.end() - 1);
  for (std::size_t k = 0; k < this->Edges.size(); ++k)
  {
    visit(this->Edges[k],
      [&](std::int64_t c) { this->Items[fill[c]++] = static_cast<std::int32_t>(k); });
  }
}

//------------------------------------------------------------------------------
CurveIndex::Nearest CurveIndex::Find(const Vec3& p, double limit) const
{
  Nearest nearest{ limit, p };
  double best = limit * limit;
  const auto clampTo = [&](int i, std::int64_t count)
  {
    const double x = std::clamp(p[i], this->Low[i], this->High[i]) - this->Low[i];
    return std::min(static_cast<std::int64_t>(x / this->Cell), count - 1);
  };
  const std::int64_t column = clampTo(0, this->Columns);
  const std::int64_t row = clampTo(1, this->Rows);
  const auto search = [&](std::int64_t i, std::int64_t j)
  {
    const std::int64_t c = i + this->Columns * j;
    for (std::int64_t k = this->First[c]; k < this->First[c + 1]; ++k)
    {
      const Edge& edge = this->Edges[this->Items[k]];
      const Vec3 along = edge.B - edge.A;
      const double length = Dot(along, along);
      const double t = length > 0 ? std::clamp(Dot(p - edge.A, along) / length, 0.0, 1.0) : 0;
      const Vec3 q = edge.A + t * along;
      const double square = Dot(p - q, p - q);
      if (square < best)
      {
        best = square;
        nearest.Point = q;
      }
    }
  };
  const std::int64_t rings = std::max(this->Columns, this->Rows);
  for (std::int64_t ring = 0; ring <= rings; ++ring)
  {
    // what lies in this ring is at least so far away; p may be outside of the cells, then farther
    const double least = static_cast<double>(ring - 1) * this->Cell;
    if (ring > 0 && best <= least * least)
    {
      break;
    }
    const std::int64_t top = std::max<std::int64_t>(row - ring, 0);
    const std::int64_t bottom = std::min(row + ring, this->Rows - 1);
    for (std::int64_t j = top; j <= bottom; ++j)
    {
      const bool whole = j == row - ring || j == row + ring;
      const std::int64_t step = whole || ring == 0 ? 1 : 2 * ring;
      for (std::int64_t i = column - ring; i <= column + ring; i += step)
      {
        if (i >= 0 && i < this->Columns)
        {
          search(i, j);
        }
      }
    }
  }
  nearest.Distance = std::sqrt(best);
  return nearest;
}
}
