// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSkullChart.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace lacuna
{
//------------------------------------------------------------------------------
PlanarGrid MakeGrid(const std::vector<Vec2>& points, double margin, double spacing)
{
  Vec2 low = points[0];
  Vec2 high = points[0];
  for (const Vec2& p : points)
  {
    for (int a = 0; a < 2; ++a)
    {
      low[a] = std::min(low[a], p[a] - margin);
      high[a] = std::max(high[a], p[a] + margin);
    }
  }
  PlanarGrid grid;
  grid.Origin = low;
  grid.Spacing = { spacing, spacing };
  grid.Columns = static_cast<std::int64_t>(std::ceil((high[0] - low[0]) / spacing)) + 2;
  grid.Rows = static_cast<std::int64_t>(std::ceil((high[1] - low[1]) / spacing)) + 2;
  return grid;
}

//------------------------------------------------------------------------------
std::vector<double> FindDistances(
  const PlanarGrid& grid, const std::vector<Vec2>& points, double limit)
{
  std::vector<double> distances(static_cast<std::size_t>(grid.Columns * grid.Rows), limit);
  const auto reach = static_cast<std::int64_t>(std::ceil(limit / grid.Spacing[0]));
  for (const Vec2& p : points)
  {
    const auto i = static_cast<std::int64_t>((p[0] - grid.Origin[0]) / grid.Spacing[0]);
    const auto j = static_cast<std::int64_t>((p[1] - grid.Origin[1]) / grid.Spacing[1]);
    for (std::int64_t n = std::max<std::int64_t>(0, j - reach);
         n <= std::min(grid.Rows - 1, j + reach + 1); ++n)
    {
      for (std::int64_t m = std::max<std::int64_t>(0, i - reach);
           m <= std::min(grid.Columns - 1, i + reach + 1); ++m)
      {
        const Vec2 node = grid.GetNode(m, n);
        double& distance = distances[m + grid.Columns * n];
        distance = std::min(distance, std::hypot(node[0] - p[0], node[1] - p[1]));
      }
    }
  }
  return distances;
}

//------------------------------------------------------------------------------
std::vector<std::vector<std::int64_t>> FindFreeParts(
  const PlanarGrid& grid, const std::vector<double>& values)
{
  std::vector<std::vector<std::int64_t>> parts;
  std::vector<bool> seen(values.size(), false);
  for (std::size_t start = 0; start < values.size(); ++start)
  {
    if (seen[start] || values[start] <= 0)
    {
      continue;
    }
    std::vector<std::int64_t> part{ static_cast<std::int64_t>(start) };
    seen[start] = true;
    for (std::size_t k = 0; k < part.size(); ++k)
    {
      for (const std::int64_t step :
        { std::int64_t{ -1 }, std::int64_t{ 1 }, -grid.Columns, grid.Columns })
      {
        const std::int64_t other = part[k] + step; // the border has no positive values
        if (!seen[other] && values[other] > 0)
        {
          seen[other] = true;
          part.push_back(other);
        }
      }
    }
    parts.push_back(std::move(part));
  }
  std::stable_sort(
    parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return parts;
}

//------------------------------------------------------------------------------
Loop Resample(const Loop& loop, double spacing)
{
  std::vector<double> along{ 0 };
  for (std::size_t k = 0; k < loop.size(); ++k)
  {
    const Vec2& a = loop[k];
    const Vec2& b = loop[(k + 1) % loop.size()];
    along.push_back(along.back() + std::hypot(b[0] - a[0], b[1] - a[1]));
  }
  const int count = std::max(8, static_cast<int>(std::lround(along.back() / spacing)));
  Loop points;
  std::size_t k = 0;
  for (int i = 0; i < count; ++i)
  {
    const double s = along.back() * i / count;
    while (k + 1 < loop.size() && along[k + 1] <= s)
    {
      ++k;
    }
    const Vec2& a = loop[k];
    const Vec2& b = loop[(k + 1) % loop.size()];
    const double t = along[k + 1] > along[k] ? (s - along[k]) / (along[k + 1] - along[k]) : 0;
    points.push_back({ a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]) });
  }
  return points;
}

//------------------------------------------------------------------------------
std::vector<Loop> KeepLargest(std::vector<Loop> loops)
{
  const auto largest = std::max_element(loops.begin(), loops.end(),
    [](const Loop& a, const Loop& b) { return SignedArea(a) < SignedArea(b); });
  if (largest == loops.end() || !(SignedArea(*largest) > 0))
  {
    return {};
  }
  std::vector<Loop> kept{ *largest };
  for (const Loop& loop : loops)
  {
    if (SignedArea(loop) < 0 && IsInside(std::vector<Loop>{ kept[0] }, loop[0]))
    {
      kept.push_back(loop);
    }
  }
  return kept;
}

//------------------------------------------------------------------------------
double GetArea(const std::vector<Loop>& loops)
{
  double area = 0;
  for (const Loop& loop : loops)
  {
    area += SignedArea(loop);
  }
  return area;
}

//------------------------------------------------------------------------------
bool CrossesItself(const Loop& loop)
{
  const auto turn = [](const Vec2& p, const Vec2& q, const Vec2& r)
  { return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]); };
  const std::size_t n = loop.size();
  for (std::size_t i = 0; i < n; ++i)
  {
    const Vec2& a = loop[i];
    const Vec2& b = loop[(i + 1) % n];
    for (std::size_t j = i + 2; j < n; ++j)
    {
      const Vec2& c = loop[j];
      const Vec2& d = loop[(j + 1) % n];
      if (turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0)
      {
        return true;
      }
    }
  }
  return false;
}
}
