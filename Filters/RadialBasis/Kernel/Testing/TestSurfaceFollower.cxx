// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSurfaceFollower.h"

#include "lacunaExecution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <vector>

namespace
{
using lacuna::Vec3;

const double Pi = 3.14159265358979323846;

// A function given by its value; gradients by differences.
class Shape : public lacuna::ImplicitFunction
{
public:
  explicit Shape(std::function<double(const Vec3&)> value)
    : Value(std::move(value))
  {
  }

  void Evaluate(lacuna::Execution&, const std::vector<Vec3>& points, std::vector<double>& values,
    std::vector<Vec3>* gradients) const override
  {
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      values[i] = this->Value(points[i]);
      for (int c = 0; gradients && c < 3; ++c)
      {
        constexpr double step = 1e-5;
        Vec3 before = points[i];
        Vec3 after = points[i];
        before[c] -= step;
        after[c] += step;
        (*gradients)[i][c] = (this->Value(after) - this->Value(before)) / (2 * step);
      }
    }
  }

private:
  std::function<double(const Vec3&)> Value;
};

double Torus(const Vec3& x)
{
  return std::hypot(std::hypot(x[0], x[1]) - 14, x[2]) - 5;
}

double Sphere(const Vec3& x, const Vec3& center, double radius)
{
  return lacuna::Norm(x - center) - radius;
}

lacuna::SurfaceFollowerOptions Within(double half, double edge)
{
  lacuna::SurfaceFollowerOptions options;
  options.EdgeLength = edge;
  options.Tolerance = 1e-4;
  options.Bounds = { -half, half, -half, half, -half, half };
  return options;
}

lacuna::FollowedSurface Follow(const std::function<double(const Vec3&)>& value,
  const std::vector<Vec3>& seeds, const lacuna::SurfaceFollowerOptions& options, int threads = 2)
{
  lacuna::ThreadExecution execution(threads);
  return lacuna::FollowSurface(execution, Shape(value), seeds, options);
}

void ExpectGoodTriangles(const lacuna::FollowedSurface& followed, double edge)
{
  const lacuna::TriangleSurface& surface = followed.Surface;
  std::vector<double> lengths;
  std::vector<double> angles; // smallest of each triangle, degrees
  int turned = 0;
  for (const auto& t : surface.Triangles)
  {
    const Vec3& a = surface.Points[t[0]];
    const Vec3& b = surface.Points[t[1]];
    const Vec3& c = surface.Points[t[2]];
    const Vec3 normal = lacuna::Cross(b - a, c - a);
    const double area = lacuna::Norm(normal);
    for (int i = 0; i < 3; ++i)
    {
      lengths.push_back(lacuna::Norm(surface.Points[t[i]] - surface.Points[t[(i + 1) % 3]]));
      turned += lacuna::Dot(normal, followed.Normals[t[i]]) <= 0;
    }
    angles.push_back(180 / Pi *
      std::min(
        { std::atan2(area, lacuna::Dot(b - a, c - a)), std::atan2(area, lacuna::Dot(c - b, a - b)),
          std::atan2(area, lacuna::Dot(a - c, b - c)) }));
  }
  EXPECT_EQ(turned, 0);
  std::sort(lengths.begin(), lengths.end());
  std::sort(angles.begin(), angles.end());
  const double median = lengths[lengths.size() / 2];
  EXPECT_GT(median, 0.75 * edge);
  EXPECT_LT(median, 1.1 * edge);
  EXPECT_LT(lengths[lengths.size() - 1 - lengths.size() / 100], 1.6 * median);
  EXPECT_GT(lengths[lengths.size() / 100], 0.5 * median);
  EXPECT_GT(angles[angles.size() / 100], 25);
  EXPECT_GT(angles[angles.size() / 2], 40);
  EXPECT_GT(angles[0], 5);
}
}

TEST(SurfaceFollower, SphereIsClosedAndLiesOnIt)
{
  const Vec3 center{ 1, -2, 3 };
  const auto sphere = [&](const Vec3& x) { return Sphere(x, center, 10); };
  const auto followed = Follow(sphere, { { 11.3, -2, 3 } }, Within(20, 0.8));
  const auto topology = lacuna::FindTopology(followed.Surface);
  EXPECT_TRUE(topology.IsManifold());
  EXPECT_TRUE(topology.IsClosed());
  EXPECT_EQ(topology.Components, 1);
  EXPECT_EQ(topology.EulerNumber, 2);
  EXPECT_FALSE(followed.ReachesBounds);
  EXPECT_LE(followed.LargestDistance, 1e-4);
  for (std::size_t i = 0; i < followed.Surface.Points.size(); ++i)
  {
    const Vec3 radius = followed.Surface.Points[i] - center;
    ASSERT_NEAR(lacuna::Norm(radius), 10, 1.01e-4);
    ASSERT_NEAR(lacuna::Dot(followed.Normals[i], radius), 10, 1e-3);
  }
  // Triangles of a sphere lie inside of it, by a volume of about 4 pi r^2 e^2 / (8 r) x a third.
  const double volume = 4 * Pi / 3 * 1000;
  EXPECT_LT(followed.Surface.GetVolume(), volume);
  EXPECT_GT(followed.Surface.GetVolume(), 0.994 * volume);
  EXPECT_NEAR(followed.Surface.GetArea(), 400 * Pi, 0.005 * 400 * Pi);
  ExpectGoodTriangles(followed, 0.8);
}

TEST(SurfaceFollower, EvaluatesOnlyCellsNearTheSurface)
{
  const auto sphere = [](const Vec3& x) { return Sphere(x, { 0, 0, 0 }, 10); };
  const auto coarse = Follow(sphere, { { 10, 0, 0 } }, Within(100, 1));
  const auto fine = Follow(sphere, { { 10, 0, 0 } }, Within(100, 0.5));
  // A grid of the bounds would have 8 million nodes, one of the sphere's box 8 times as many for
  // half the edge.
  EXPECT_LT(coarse.Evaluations, 60000);
  EXPECT_LT(fine.Evaluations, 4.5 * coarse.Evaluations);
}

TEST(SurfaceFollower, TorusHasItsGenus)
{
  const auto followed = Follow(Torus, { { 19, 0, 0 } }, Within(30, 0.7));
  const auto topology = lacuna::FindTopology(followed.Surface);
  EXPECT_TRUE(topology.IsManifold());
  EXPECT_TRUE(topology.IsClosed());
  EXPECT_EQ(topology.EulerNumber, 0);
  const double volume = 2 * Pi * Pi * 14 * 25;
  EXPECT_NEAR(followed.Surface.GetVolume(), volume, 0.005 * volume);
  ExpectGoodTriangles(followed, 0.7);
}

TEST(SurfaceFollower, PartsWithoutSeedAreLeftOut)
{
  const auto two = [](const Vec3& x) {
    return std::min(Sphere(x, { -8, 0, 0 }, 5), Sphere(x, { 8, 0, 0 }, 6));
  };
  const auto both = Follow(two, { { -13, 0, 0 }, { 14, 0, 0 } }, Within(20, 0.7));
  EXPECT_EQ(lacuna::FindTopology(both.Surface).Components, 2);
  EXPECT_EQ(lacuna::FindTopology(both.Surface).EulerNumber, 4);
  const auto one = Follow(two, { { 14, 0, 0 } }, Within(20, 0.7));
  EXPECT_EQ(lacuna::FindTopology(one.Surface).Components, 1);
  EXPECT_NEAR(one.Surface.GetVolume(), 4 * Pi / 3 * 216, 0.01 * 4 * Pi / 3 * 216);
}

TEST(SurfaceFollower, ShellsHaveTwoSides)
{
  // a wall of 1 mm, in cells of 1 mm
  const auto shell = [](const Vec3& x) { return std::abs(Sphere(x, { 0, 0, 0 }, 10)) - 0.5; };
  const auto followed = Follow(shell, { { 10.5, 0, 0 }, { -9.5, 0, 0 } }, Within(20, 0.5));
  const auto topology = lacuna::FindTopology(followed.Surface);
  EXPECT_TRUE(topology.IsManifold());
  EXPECT_TRUE(topology.IsClosed());
  EXPECT_EQ(topology.Components, 2);
  EXPECT_EQ(topology.EulerNumber, 4);
  const double volume = 4 * Pi / 3 * (std::pow(10.5, 3) - std::pow(9.5, 3));
  EXPECT_NEAR(followed.Surface.GetVolume(), volume, 0.01 * volume);
}

// Where sheets touch, cross and end within a cell, marching cubes make edges of four triangles.
TEST(SurfaceFollower, IsAManifoldWhateverTheFunction)
{
  for (int seed = 0; seed < 3; ++seed)
  {
    const auto rough = [seed](const Vec3& x)
    {
      return std::sin(2.1 * x[0] + seed) * std::cos(1.7 * x[1]) +
        std::sin(1.9 * x[1] + 2 * seed) * std::cos(2.3 * x[2]) +
        std::sin(2.2 * x[2]) * std::cos(2 * x[0] + seed) + 0.05 * seed;
    };
    std::vector<Vec3> seeds;
    for (int i = 0; i < 200; ++i)
    {
      seeds.push_back({ 5 * std::sin(1.0 * i), 5 * std::sin(2.3 * i), 5 * std::sin(3.7 * i) });
    }
    auto options = Within(5, 0.7);
    const auto closed = Follow(rough, seeds, options);
    const auto topology = lacuna::FindTopology(closed.Surface);
    EXPECT_TRUE(topology.IsManifold()) << seed;
    EXPECT_TRUE(topology.IsClosed()) << seed;
    EXPECT_TRUE(closed.ReachesBounds);
    options.Cap = false;
    const auto open = Follow(rough, seeds, options);
    EXPECT_TRUE(lacuna::FindTopology(open.Surface).IsManifold()) << seed;
    EXPECT_FALSE(lacuna::FindTopology(open.Surface).IsClosed()) << seed;
    EXPECT_TRUE(open.ReachesBounds);
  }
}

TEST(SurfaceFollower, CapsAtBounds)
{
  const auto sphere = [](const Vec3& x) { return Sphere(x, { 0, 0, 0 }, 10); };
  auto options = Within(20, 0.5);
  options.Bounds[1] = 4; // x up to 4: a cap of height 6 is missing
  const auto followed = Follow(sphere, { { -10, 0, 0 } }, options);
  const auto topology = lacuna::FindTopology(followed.Surface);
  EXPECT_TRUE(topology.IsClosed());
  EXPECT_EQ(topology.EulerNumber, 2);
  EXPECT_TRUE(followed.ReachesBounds);
  const double volume = 4 * Pi / 3 * 1000 - Pi * 36 * (30 - 6) / 3;
  EXPECT_NEAR(followed.Surface.GetVolume(), volume, 0.01 * volume);
  for (std::size_t i = 0; i < followed.Surface.Points.size(); ++i)
  {
    ASSERT_LE(followed.Surface.Points[i][0], 4 + 2e-4);
    if (followed.IsCap[i] && followed.Surface.Points[i][0] > 4 + 1e-5)
    {
      ASSERT_EQ(followed.Normals[i][0], 1);
    }
  }
}

TEST(SurfaceFollower, DoesNotDependOnThreads)
{
  const auto one = Follow(Torus, { { 19, 0, 0 } }, Within(30, 1), 1);
  const auto four = Follow(Torus, { { 19, 0, 0 } }, Within(30, 1), 4);
  EXPECT_EQ(one.Surface.Points, four.Surface.Points);
  EXPECT_EQ(one.Surface.Triangles, four.Surface.Triangles);
}

TEST(SurfaceFollower, RefusesWhatHasNoSurface)
{
  const auto sphere = [](const Vec3& x) { return Sphere(x, { 0, 0, 0 }, 10); };
  EXPECT_THROW(Follow(sphere, {}, Within(20, 1)), std::runtime_error);
  EXPECT_THROW(
    Follow([](const Vec3&) { return 1.0; }, { { 0, 0, 0 } }, Within(20, 1)), std::runtime_error);
  EXPECT_THROW(Follow([](const Vec3&) { return std::nan(""); }, { { 0, 0, 0 } }, Within(20, 1)),
    std::runtime_error);
  EXPECT_THROW(Follow(sphere, { { 10, 0, 0 } }, Within(20, 0)), std::invalid_argument);
  EXPECT_THROW(Follow(sphere, { { 10, 0, 0 } }, Within(0, 1)), std::invalid_argument);
  EXPECT_THROW(Follow(sphere, { { 10, 0, 0 } }, Within(20, 1e-9)), std::invalid_argument);
  auto options = Within(20, 1);
  options.Tolerance = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Follow(sphere, { { 10, 0, 0 } }, options), std::invalid_argument);
}

TEST(TriangleSurface, TopologyTellsWhatIsWrong)
{
  lacuna::TriangleSurface tetrahedron;
  tetrahedron.Points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
  tetrahedron.Triangles = { { 0, 2, 1 }, { 0, 1, 3 }, { 0, 3, 2 }, { 1, 2, 3 } };
  EXPECT_NEAR(tetrahedron.GetVolume(), 1.0 / 6, 1e-15);
  EXPECT_NEAR(tetrahedron.GetArea(), 1.5 + std::sqrt(3.0) / 2, 1e-15);
  auto topology = lacuna::FindTopology(tetrahedron);
  EXPECT_TRUE(topology.IsClosed() && topology.IsManifold());
  EXPECT_EQ(topology.EulerNumber, 2);
  // nothing of it can collapse
  EXPECT_EQ(lacuna::CollapseShortEdges(tetrahedron, 10, 100), 0);
  EXPECT_EQ(tetrahedron.Triangles.size(), 4u);

  auto open = tetrahedron;
  open.Triangles.pop_back();
  EXPECT_EQ(lacuna::FindTopology(open).BoundaryEdges, 3);
  EXPECT_TRUE(lacuna::FindTopology(open).IsManifold());

  auto turned = tetrahedron;
  std::swap(turned.Triangles[0][0], turned.Triangles[0][1]);
  EXPECT_EQ(lacuna::FindTopology(turned).BadEdges, 3);

  auto touching = tetrahedron; // another one that shares a point
  touching.Points.insert(touching.Points.end(), { { -1, 0, 0 }, { 0, -1, 0 }, { 0, 0, -1 } });
  touching.Triangles.insert(
    touching.Triangles.end(), { { 0, 4, 5 }, { 0, 6, 4 }, { 0, 5, 6 }, { 4, 6, 5 } });
  topology = lacuna::FindTopology(touching);
  EXPECT_EQ(topology.BadEdges, 0);
  EXPECT_EQ(topology.BadPoints, 1);
  EXPECT_EQ(topology.Components, 2);
}

// Tetrahedra at the origin, each within the one before, and one beside.
TEST(TriangleSurface, PartsKnowWhatEnclosesThem)
{
  lacuna::TriangleSurface surface;
  const auto add = [&](double size, const Vec3& at, bool inwards)
  {
    const auto first = static_cast<std::int32_t>(surface.Points.size());
    for (const Vec3& p :
      { Vec3{ 1, 1, 1 }, Vec3{ 1, -1, -1 }, Vec3{ -1, 1, -1 }, Vec3{ -1, -1, 1 } })
    {
      surface.Points.push_back(at + size * p);
    }
    for (const std::array<int, 3>& t :
      { std::array<int, 3>{ 0, 1, 2 }, { 0, 3, 1 }, { 0, 2, 3 }, { 1, 3, 2 } })
    {
      surface.Triangles.push_back(
        { first + t[0], first + t[inwards ? 2 : 1], first + t[inwards ? 1 : 2] });
    }
  };
  add(1, { 0.1, 0, 0 }, false); // solid in a cavity
  add(9, { 0, 0, 0 }, false);
  add(2, { 40, 0, 0 }, true);     // inside out
  add(3, { 0, 0.2, 0 }, true);    // the cavity
  add(0.2, { 0.1, 0, 0 }, false); // solid within a solid
  const std::vector<lacuna::SurfacePart> parts = lacuna::FindParts(surface);
  const double sizes[] = { 9, 3, 2, 1, 0.2 };
  const int depths[] = { 0, 1, 0, 2, 3 };
  ASSERT_EQ(parts.size(), 5U);
  for (int i = 0; i < 5; ++i)
  {
    EXPECT_NEAR(std::abs(parts[i].Volume), 8.0 / 3 * std::pow(sizes[i], 3), 1e-9);
    EXPECT_EQ(parts[i].Depth, depths[i]) << i;
    EXPECT_EQ(parts[i].IsInsideOut(), i == 2 || i == 4) << i;
  }
}
