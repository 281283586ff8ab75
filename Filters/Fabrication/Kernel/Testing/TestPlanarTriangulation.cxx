// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPlanarTriangulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <stdexcept>

using namespace lacuna;

namespace
{
using Loops = std::vector<std::vector<std::int32_t>>;

double Area(const Vec2& a, const Vec2& b, const Vec2& c)
{
  return 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
}

// Every triangle is counterclockwise, every edge but those of the loops has two sides. Returns the
// area.
double Check(
  const std::vector<Vec2>& points, const std::vector<Triangle>& triangles, const Loops& loops)
{
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  double area = 0;
  for (const Triangle& t : triangles)
  {
    const double a = Area(points[t[0]], points[t[1]], points[t[2]]);
    EXPECT_GT(a, 0);
    area += a;
    for (int k = 0; k < 3; ++k)
    {
      EXPECT_EQ(++edges[std::make_pair(t[k], t[(k + 1) % 3])], 1);
    }
  }
  std::map<std::pair<std::int32_t, std::int32_t>, int> border;
  for (const auto& loop : loops)
  {
    for (std::size_t k = 0; k < loop.size(); ++k)
    {
      const std::int32_t a = loop[k];
      const std::int32_t b = loop[(k + 1) % loop.size()];
      ++border[std::make_pair(std::min(a, b), std::max(a, b))];
    }
  }
  std::size_t open = 0;
  for (const auto& edge : edges)
  {
    const auto [a, b] = edge.first;
    if (!edges.count({ b, a }))
    {
      ++open;
      EXPECT_TRUE(border.count({ std::min(a, b), std::max(a, b) })) << a << " " << b;
    }
  }
  EXPECT_EQ(open, border.size());
  return area;
}

std::vector<std::int32_t> Sequence(std::int32_t first, std::int32_t count)
{
  std::vector<std::int32_t> loop(count);
  std::iota(loop.begin(), loop.end(), first);
  return loop;
}
}

TEST(PlanarTriangulation, RegionWithHole)
{
  std::vector<Vec2> points{ { 0, 0 }, { 10, 0 }, { 10, 8 }, { 0, 8 }, { 3, 3 }, { 3, 5 }, { 6, 5 },
    { 6, 3 } };
  const Loops loops{ Sequence(0, 4), Sequence(4, 4) };
  const auto triangles = TriangulateRegion(points, loops);
  EXPECT_EQ(triangles.size(), 8u);
  EXPECT_NEAR(Check(points, triangles, loops), 80 - 6, 1e-5);
}

TEST(PlanarTriangulation, SquareLatticeIsFullOfCocircularPoints)
{
  std::vector<Vec2> points{ { -1, -1 }, { 33, -1 }, { 33, 33 }, { -1, 33 } };
  for (int j = 0; j < 33; ++j)
  {
    for (int i = 0; i < 33; ++i)
    {
      points.push_back({ static_cast<double>(i), static_cast<double>(j) });
    }
  }
  const Loops loops{ Sequence(0, 4) };
  const auto triangles = TriangulateRegion(points, loops);
  EXPECT_EQ(triangles.size(), 2 * points.size() - 2 - 4);
  EXPECT_NEAR(Check(points, triangles, loops), 34 * 34, 1e-3);
}

// Long boundaries across points that a Delaunay triangulation alone would not keep.
TEST(PlanarTriangulation, BoundariesAreForced)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int trial = 0; trial < 30; ++trial)
  {
    // a comb with thin teeth
    std::vector<Vec2> points;
    for (int k = 0; k < 12; ++k)
    {
      points.push_back({ static_cast<double>(k), 0.01 * unit(random) });
      points.push_back({ k + 0.02 + 0.1 * unit(random), 50 + unit(random) });
    }
    points.push_back({ 13, -5 });
    points.push_back({ -1, -5 });
    // clockwise or not does not matter
    const Loops loops{ Sequence(0, static_cast<std::int32_t>(points.size())) };
    double expected = 0;
    for (std::size_t k = 0; k < points.size(); ++k)
    {
      expected += Area({ 0, 0 }, points[k], points[(k + 1) % points.size()]);
    }
    for (int k = 0; k < 200; ++k)
    {
      points.push_back({ -0.9 + 13.8 * unit(random), -4.9 + 4.8 * unit(random) });
    }
    const auto triangles = TriangulateRegion(points, loops);
    EXPECT_NEAR(Check(points, triangles, loops), std::abs(expected), 1e-2);
  }
}

TEST(PlanarTriangulation, RefusesWhatHasNoTriangles)
{
  std::vector<Vec2> twice{ { 0, 0 }, { 1, 0 }, { 1, 1 }, { 1, 0 } };
  EXPECT_THROW(TriangulateRegion(twice, { Sequence(0, 3) }), std::runtime_error);
  std::vector<Vec2> crossing{ { 0, 0 }, { 4, 4 }, { 4, 0 }, { 0, 4 } };
  EXPECT_THROW(TriangulateRegion(crossing, { Sequence(0, 4) }), std::runtime_error);
  std::vector<Vec2> touching{ { 0, 0 }, { 4, 0 }, { 4, 4 }, { 2, 0 } };
  EXPECT_THROW(TriangulateRegion(touching, { Sequence(0, 3) }), std::runtime_error);
  std::vector<Vec2> infinite{ { 0, 0 }, { std::numeric_limits<double>::infinity(), 0 }, { 1, 1 } };
  EXPECT_THROW(TriangulateRegion(infinite, { Sequence(0, 3) }), std::invalid_argument);
}
