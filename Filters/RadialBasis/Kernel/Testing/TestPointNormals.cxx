// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPointNormals.h"

#include "lacunaExecution.h"
#include "lacunaTestShapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

namespace
{
using lacuna::TestShape;
using lacuna::Vec3;

lacuna::PointNormals Estimate(const std::vector<Vec3>& points, int threads = 2)
{
  lacuna::ThreadExecution execution(threads);
  return lacuna::EstimateNormals(execution, points);
}

// How many normals point to the side of the true ones.
std::size_t CountRight(const std::vector<Vec3>& normals, const std::vector<Vec3>& truth)
{
  std::size_t right = 0;
  for (std::size_t i = 0; i < truth.size(); ++i)
  {
    right += lacuna::Dot(normals[i], truth[i]) > 0;
  }
  return right;
}
}

TEST(PointNormals, NeighborsAgreeWithBruteForce)
{
  const auto points = TestShape(TestShape::Kumara).Sample(500, 1).Points;
  const lacuna::PointNeighbors tree(points);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> coordinate(-50, 50);
  for (int trial = 0; trial < 20; ++trial)
  {
    const Vec3 x{ coordinate(random), coordinate(random), coordinate(random) };
    std::vector<double> expected;
    for (const Vec3& p : points)
    {
      expected.push_back(lacuna::Norm(p - x));
    }
    std::sort(expected.begin(), expected.end());
    std::vector<std::size_t> indices;
    std::vector<double> distances;
    tree.Find(x, 7, indices, &distances);
    ASSERT_EQ(indices.size(), 7u);
    for (int k = 0; k < 7; ++k)
    {
      EXPECT_NEAR(distances[k], expected[k], 1e-12);
      EXPECT_NEAR(lacuna::Norm(points[indices[k]] - x), expected[k], 1e-12);
    }
    EXPECT_NEAR(tree.GetDistance(x), expected[0], 1e-12);
  }
  EXPECT_THROW(lacuna::PointNeighbors({}), std::invalid_argument);
}

TEST(PointNormals, SpacingIsThatOfAGrid)
{
  std::vector<Vec3> points;
  for (int i = 0; i < 60; ++i)
  {
    for (int j = 0; j < 60; ++j)
    {
      points.push_back({ 0.7 * i, 0.7 * j, 0 });
    }
  }
  lacuna::ThreadExecution execution(2);
  EXPECT_NEAR(lacuna::FindPointSpacing(execution, points), 0.7, 0.2);
}

TEST(PointNormals, ClosedShapesHaveThemOutwards)
{
  for (const auto kind : { TestShape::Sphere, TestShape::Torus, TestShape::Kumara, TestShape::Cup })
  {
    const auto data = TestShape(kind).SampleNoisy(4000, 0.1, false, 3, 0);
    const auto normals = Estimate(data.Points);
    EXPECT_EQ(normals.Parts, 1) << TestShape::GetName(kind);
    EXPECT_EQ(normals.Linear, 0);
    // at sharp edges a normal is that of the one face or the other
    EXPECT_GE(CountRight(normals.Normals, data.Normals), 0.995 * 4000) << TestShape::GetName(kind);
  }
}

TEST(PointNormals, CavitiesHaveThemInwards)
{
  const TestShape sphere(TestShape::Sphere);
  auto data = sphere.Sample(3000, 4);
  const auto inner = sphere.Sample(1000, 5);
  for (std::size_t i = 0; i < inner.Points.size(); ++i)
  {
    data.Points.push_back(0.5 * inner.Points[i] + Vec3{ 5, 0, 0 });
    data.Normals.push_back(-1.0 * inner.Normals[i]); // out of the solid is into the cavity
  }
  const auto normals = Estimate(data.Points);
  EXPECT_EQ(normals.Parts, 2);
  EXPECT_EQ(CountRight(normals.Normals, data.Normals), data.Points.size());
  EXPECT_EQ(normals.Conflicts, 0);
}

TEST(PointNormals, TellsOfSurfacesWithOneSide)
{
  std::vector<Vec3> moebius;
  const double pi = std::acos(-1.0);
  for (int i = 0; i < 400; ++i)
  {
    for (int j = -6; j <= 6; ++j)
    {
      const double t = 2 * pi * i / 400;
      const double r = 30 + 0.5 * j * std::cos(t / 2);
      moebius.push_back({ r * std::cos(t), r * std::sin(t), 0.5 * j * std::sin(t / 2) });
    }
  }
  const auto normals = Estimate(moebius);
  EXPECT_GT(normals.Conflicts, 10);
  EXPECT_NEAR(std::hypot(normals.ConflictAt[0], normals.ConflictAt[1]), 30, 4);
  EXPECT_EQ(Estimate(TestShape(TestShape::Torus).Sample(3000, 6).Points).Conflicts, 0);
}

TEST(PointNormals, TellsOfLines)
{
  std::vector<Vec3> line;
  for (int i = 0; i < 50; ++i)
  {
    line.push_back({ 1.0 * i, 2.0 * i, 0.5 * i });
  }
  EXPECT_EQ(Estimate(line).Linear, 50);
  line.resize(5);
  EXPECT_THROW(Estimate(line), std::invalid_argument);
}

TEST(PointNormals, FindsThoseThatContradict)
{
  auto data = TestShape(TestShape::Sphere).Sample(2000, 7);
  lacuna::ThreadExecution execution(2);
  Vec3 at{};
  EXPECT_EQ(lacuna::FindOpposedNormals(execution, data.Points, data.Normals, 2, at), 0);
  data.Normals[17] = -1.0 * data.Normals[17];
  EXPECT_GT(lacuna::FindOpposedNormals(execution, data.Points, data.Normals, 4, at), 1);
  EXPECT_LT(lacuna::Norm(at - data.Points[17]), 4);
}

TEST(PointNormals, DoNotDependOnThreads)
{
  const auto points = TestShape(TestShape::Cup).SampleNoisy(2000, 0.2, true, 8).Points;
  EXPECT_EQ(Estimate(points, 1).Normals, Estimate(points, 4).Normals);
}
