// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDepthMapMesher.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace
{
using namespace lacuna;

struct Map
{
  int Width;
  int Height;
  std::vector<double> Depth;
  DepthGrid Grid;

  Map(int width, int height, double spacing, const std::function<double(double, double)>& depth)
    : Width(width)
    , Height(height)
  {
    for (int r = 0; r < height; ++r)
    {
      for (int c = 0; c < width; ++c)
      {
        this->Depth.push_back(depth(c * spacing, r * spacing));
      }
    }
    this->Grid.Extent = { 0, width - 1, 0, height - 1 };
    // seen from the top: right = x, down = -y, view = -z
    this->Grid.ImageToWorld =
      Matrix4::FromColumns({ spacing, 0, 0 }, { 0, -spacing, 0 }, { 0, 0, -1 }, { 5, 6, 7 });
  }
};

struct Mesh
{
  std::vector<double> Points;
  std::vector<long long> Pixels;
  std::vector<long long> Corners;

  Mesh(const Map& map, const DiscontinuityRule& rule, int threads = 1)
  {
    ThreadExecution execution(threads);
    DepthGrid grid = map.Grid;
    grid.Depth = map.Depth.data();
    const DepthMapMesher mesher(grid, rule, 0, map.Height - 1, execution);
    this->Points.resize(3 * mesher.GetNumberOfPoints());
    this->Pixels.resize(mesher.GetNumberOfPoints());
    this->Corners.resize(3 * mesher.GetNumberOfTriangles());
    mesher.FillPoints(this->Points.data(), this->Pixels.data(), execution);
    mesher.FillTriangles(this->Corners.data(), execution);
  }

  std::size_t Triangles() const { return this->Corners.size() / 3; }
  Vec3 Point(std::int64_t i) const
  {
    return { this->Points[3 * i], this->Points[3 * i + 1], this->Points[3 * i + 2] };
  }
  /// Longest edge.
  double Longest() const
  {
    double longest = 0;
    for (std::size_t i = 0; i < this->Corners.size(); ++i)
    {
      const std::size_t next = i % 3 == 2 ? i - 2 : i + 1;
      longest =
        std::max(longest, Norm(this->Point(this->Corners[i]) - this->Point(this->Corners[next])));
    }
    return longest;
  }
};

constexpr double None = std::numeric_limits<double>::quiet_NaN();
}

TEST(DepthMapMesher, PlaneIsCoveredOnceTowardsTheViewer)
{
  const Map map(13, 9, 0.5, [](double x, double y) { return 20 + 0.3 * x - 0.2 * y; });
  const Mesh mesh(map, DiscontinuityRule());
  ASSERT_EQ(mesh.Pixels.size(), 13u * 9);
  ASSERT_EQ(mesh.Triangles(), 2u * 12 * 8);
  double area = 0;
  std::map<std::pair<std::int64_t, std::int64_t>, int> edges;
  for (std::size_t t = 0; t < mesh.Triangles(); ++t)
  {
    const long long* c = mesh.Corners.data() + 3 * t;
    const Vec3 n = Cross(mesh.Point(c[1]) - mesh.Point(c[0]), mesh.Point(c[2]) - mesh.Point(c[0]));
    EXPECT_GT(n[2], 0) << "the viewer is above";
    area += 0.5 * n[2];
    for (int e = 0; e < 3; ++e)
    {
      ++edges[{ c[e], c[(e + 1) % 3] }];
    }
  }
  EXPECT_NEAR(area, 6 * 4, 1e-12);
  for (const auto& edge : edges)
  {
    EXPECT_EQ(edge.second, 1) << "each edge once in each direction";
  }
  // pixel (3, 2): x = 5 + 1.5, y = 6 - 1, z = 7 - depth
  const std::int64_t i = 3 + 13 * 2;
  EXPECT_EQ(mesh.Pixels[i], i);
  EXPECT_NEAR(Norm(mesh.Point(i) - Vec3{ 6.5, 5, 7 - (20 + 0.45 - 0.2) }), 0, 1e-12);
}

TEST(DepthMapMesher, HolesStayOpen)
{
  Map map(4, 3, 1, [](double, double) { return 1; });
  map.Depth[1 + 4 * 1] = None;
  const Mesh mesh(map, DiscontinuityRule());
  EXPECT_EQ(mesh.Pixels.size(), 11u);
  // the four squares around the hole keep the triangle that avoids it
  EXPECT_EQ(mesh.Triangles(), 4u + 2 * 2);
  for (const long long c : mesh.Corners)
  {
    ASSERT_LT(c, 11);
    EXPECT_NE(mesh.Pixels[c], 5);
  }
}

TEST(DepthMapMesher, NoSkinBetweenNearAndFar)
{
  // a round ball in front of a wall: its rim is steep where it ends
  const auto ball = [](double x, double y)
  {
    const double r2 = (x - 10) * (x - 10) + (y - 10) * (y - 10);
    return r2 < 36 ? 20 - std::sqrt(36 - r2) : 50.0;
  };
  for (const double spacing : { 0.5, 0.23 })
  {
    const Map map(
      static_cast<int>(20 / spacing) + 1, static_cast<int>(20 / spacing) + 1, spacing, ball);
    const Mesh mesh(map, DiscontinuityRule());
    EXPECT_LT(mesh.Longest(), 6);
    std::size_t across = 0;
    for (std::size_t t = 0; t < mesh.Triangles(); ++t)
    {
      int far = 0;
      for (int c = 0; c < 3; ++c)
      {
        far += mesh.Point(mesh.Corners[3 * t + c])[2] < -35;
      }
      across += far == 1 || far == 2;
    }
    EXPECT_EQ(across, 0u);
    DiscontinuityRule joined;
    joined.Break = false;
    EXPECT_EQ(Mesh(map, joined).Triangles(), 2u * (map.Width - 1) * (map.Height - 1));
    EXPECT_GT(Mesh(map, joined).Longest(), 25);
  }
}

TEST(DepthMapMesher, NoSkinFromOneSteepSideToAnother)
{
  // 75 degrees, a jump of 20 mm the same way, 75 degrees
  const Map map(40, 6, 1, [](double x, double) { return 3.73 * x + (x > 19.5 ? 20 : 0); });
  const Mesh mesh(map, DiscontinuityRule());
  EXPECT_LT(mesh.Longest(), 6);
  EXPECT_EQ(mesh.Triangles(), 2u * 5 * 38);
}

TEST(DepthMapMesher, EachEndOfAnEdgeIsAsked)
{
  const auto triangles = [](const std::function<double(double)>& slope)
  {
    // slope(x): from x to x + 1
    const Map map(31, 6, 1,
      [&](double x, double)
      {
        double depth = 20;
        for (int i = 0; i < static_cast<int>(x + 0.5); ++i)
        {
          depth += slope(i);
        }
        return depth;
      });
    return Mesh(map, DiscontinuityRule()).Triangles();
  };
  const std::size_t whole = 2u * 5 * 30;
  const std::size_t column = 2u * 5;
  EXPECT_EQ(triangles([](double) { return 2.75; }), whole);
  // 45, 70, 45 degrees: cases 7 and 8 at the first and the last steep edge
  EXPECT_EQ(triangles([](double x) { return x < 10 || x > 19 ? 1 : 2.75; }), whole - 2 * column);
  EXPECT_EQ(triangles([](double x) { return x < 10 ? 1 : 2.75; }), whole - column);
  EXPECT_EQ(triangles([](double x) { return x > 19 ? 1 : 2.75; }), whole - column);
  // 75, 87, 75 degrees are all steep the same way; the steps tell where it jumps
  EXPECT_EQ(triangles([](double x) { return x < 10 || x > 19 ? 3.73 : 20; }), whole - 2 * column);
  EXPECT_EQ(triangles([](double x) { return x < 10 ? 3.73 : 20; }), whole - column);
  EXPECT_EQ(triangles([](double x) { return x > 19 ? 3.73 : 20; }), whole - column);
}

TEST(DepthMapMesher, SteepSidesThatBendSmoothlyStayWhole)
{
  // a ball of 80 mm at 0.45 mm against nothing: up to 87 degrees
  const auto ball = [](double x, double y)
  {
    const double r2 = (x - 100) * (x - 100) + (y - 100) * (y - 100);
    const double rim = 80 * std::sin(87 * 3.14159265358979 / 180);
    return r2 < rim * rim ? 90 - std::sqrt(6400 - r2) : None;
  };
  const Map map(445, 445, 0.45, ball);
  DiscontinuityRule joined;
  joined.Break = false;
  EXPECT_EQ(Mesh(map, DiscontinuityRule()).Triangles(), Mesh(map, joined).Triangles());
  // a straight ramp of 80 degrees between two flats stays whole in itself
  const Map ramp(
    30, 5, 1, [](double x, double) { return std::min(std::max(x - 10, 0.0), 10.0) * 5.67; });
  EXPECT_GE(Mesh(ramp, DiscontinuityRule()).Triangles(), 2u * 4 * (29 - 2));
  // with a larger angle it is one with its flats
  DiscontinuityRule steep;
  steep.Limits.MaximumAngle = 82;
  EXPECT_EQ(Mesh(ramp, steep).Triangles(), 2u * 4 * 29);
}

TEST(DepthMapMesher, AnglesAreThoseOfPerspectiveRays)
{
  // a sphere around the eye is flat for its rays, however oblique to the image plane
  Map map(21, 21, 1, [](double, double) { return 0; });
  map.Grid.Perspective = true;
  map.Grid.Eye = map.Grid.ImageToWorld.Point({ 10, 10, -3 });
  for (int i = 0; i < 441; ++i)
  {
    const Vec3 pixel = map.Grid.ImageToWorld.Point({ 1.0 * (i % 21), 1.0 * (i / 21), 0 });
    map.Depth[i] = 100 - Norm(pixel - map.Grid.Eye);
  }
  DiscontinuityRule rule;
  rule.Limits.MaximumAngle = 1;
  rule.Limits.MaximumAngleChange = 0;
  const Mesh mesh(map, rule);
  EXPECT_EQ(mesh.Triangles(), 2u * 20 * 20);
  for (std::size_t i = 0; i < mesh.Pixels.size(); ++i)
  {
    EXPECT_NEAR(Norm(mesh.Point(i) - map.Grid.Eye), 100, 1e-10);
  }
}

TEST(DepthMapMesher, SameForAnyThreadsAndRows)
{
  const Map map(60, 50, 1,
    [](double x, double y)
    { return std::fmod(x * 7 + y * 13, 11) < 1 ? None : 5 * std::fmod(x * 3 + y * 5, 17); });
  const Mesh whole(map, DiscontinuityRule());
  for (const int threads : { 2, 5 })
  {
    const Mesh again(map, DiscontinuityRule(), threads);
    EXPECT_EQ(again.Points, whole.Points);
    EXPECT_EQ(again.Corners, whole.Corners);
  }
  // bands of rows, each given one row more on either side, add up to the whole
  ThreadExecution execution(2);
  std::vector<long long> corners;
  for (const auto& rows : { std::pair<int, int>(0, 17), { 17, 30 }, { 30, 49 } })
  {
    const int first = std::max(0, rows.first - 1);
    DepthGrid grid = map.Grid;
    grid.Depth = map.Depth.data() + 60 * first;
    grid.Extent = { 0, 59, first, std::min(49, rows.second + 1) };
    const DepthMapMesher mesher(grid, DiscontinuityRule(), rows.first, rows.second, execution);
    std::vector<double> points(3 * mesher.GetNumberOfPoints());
    std::vector<long long> pixels(mesher.GetNumberOfPoints());
    std::vector<long long> band(3 * mesher.GetNumberOfTriangles());
    mesher.FillPoints(points.data(), pixels.data(), execution);
    mesher.FillTriangles(band.data(), execution);
    for (const long long c : band)
    {
      corners.push_back(pixels[c] + 60 * first);
    }
  }
  ASSERT_EQ(corners.size(), whole.Corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i)
  {
    ASSERT_EQ(corners[i], whole.Pixels[whole.Corners[i]]);
  }
}

TEST(DepthMapMesher, SmallAndWrong)
{
  for (const auto& size : { std::pair<int, int>(1, 1), { 1, 5 }, { 5, 1 } })
  {
    const Map map(size.first, size.second, 1, [](double, double) { return 1; });
    const Mesh mesh(map, DiscontinuityRule());
    EXPECT_EQ(mesh.Pixels.size(), static_cast<std::size_t>(size.first) * size.second);
    EXPECT_EQ(mesh.Triangles(), 0u);
  }
  const Map map(4, 4, 1, [](double, double) { return 1; });
  DiscontinuityRule rule;
  rule.Limits.MaximumAngle = 91;
  EXPECT_THROW(Mesh(map, rule), std::invalid_argument);
  rule.Limits.MaximumAngle = None;
  EXPECT_THROW(Mesh(map, rule), std::invalid_argument);
  rule = DiscontinuityRule();
  rule.Limits.MaximumAngleChange = -1;
  EXPECT_THROW(Mesh(map, rule), std::invalid_argument);
}
