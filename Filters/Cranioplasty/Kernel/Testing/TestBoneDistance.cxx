// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaBoneDistance.h"

#include "lacunaImplantEdge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

using lacuna::TriangleBone;
using lacuna::TriangleSurface;
using lacuna::Vec3;

namespace
{
class Random
{
public:
  double operator()(double low, double high)
  {
    return low + (high - low) * static_cast<double>(this->Engine()) / 4294967296.0;
  }
  Vec3 Point(double half)
  {
    return { (*this)(-half, half), (*this)(-half, half), (*this)(-half, half) };
  }

private:
  std::mt19937 Engine{ 7 };
};

// Twelve triangles, outwards.
TriangleSurface MakeBox(const Vec3& low, const Vec3& high)
{
  TriangleSurface box;
  for (int k = 0; k < 8; ++k)
  {
    box.Points.push_back(
      { (k & 1 ? high : low)[0], (k & 2 ? high : low)[1], (k & 4 ? high : low)[2] });
  }
  box.Triangles = { { 0, 2, 1 }, { 1, 2, 3 }, { 4, 5, 6 }, { 5, 7, 6 }, { 0, 1, 4 }, { 1, 5, 4 },
    { 2, 6, 3 }, { 3, 6, 7 }, { 0, 4, 2 }, { 2, 4, 6 }, { 1, 3, 5 }, { 3, 7, 5 } };
  return box;
}

TriangleBone MakeBone(const TriangleSurface& surface, const Vec3& low, const Vec3& high)
{
  return { surface,
    [low, high](const Vec3& x)
    {
      return x[0] > low[0] && x[0] < high[0] && x[1] > low[1] && x[1] < high[1] && x[2] > low[2] &&
        x[2] < high[2];
    } };
}
}

TEST(BoneDistance, IsThatOfTheNearestTriangle)
{
  Random random;
  TriangleSurface surface;
  for (int k = 0; k < 200; ++k)
  {
    const Vec3 middle = random.Point(10);
    for (int corner = 0; corner < 3; ++corner)
    {
      surface.Points.push_back(middle + random.Point(2));
    }
    surface.Triangles.push_back({ 3 * k, 3 * k + 1, 3 * k + 2 });
  }
  const TriangleBone bone(surface, [](const Vec3& x) { return x[0] > 3; });
  int beyond = 0;
  for (int k = 0; k < 1000; ++k)
  {
    const Vec3 x = random.Point(16);
    // by dense points of each triangle
    double least = 100;
    for (const auto& t : surface.Triangles)
    {
      for (int i = 0; i <= 40; ++i)
      {
        for (int j = 0; i + j <= 40; ++j)
        {
          const Vec3 p = (i / 40.0) * surface.Points[t[0]] + (j / 40.0) * surface.Points[t[1]] +
            ((40 - i - j) / 40.0) * surface.Points[t[2]];
          least = std::min(least, Norm(x - p));
        }
      }
      if (k % 10 != 0 && least < 3)
      {
        break; // an upper bound is enough for most
      }
    }
    const lacuna::NearestBone found = bone.Find(x, 3);
    EXPECT_EQ(found.Distance<0, x[0]> 3);
    EXPECT_LE(std::abs(found.Distance), std::min(least, 3.0) + 1e-12);
    if (std::abs(found.Distance) < 3)
    {
      EXPECT_NEAR(Norm(found.Point - x), std::abs(found.Distance), 1e-12);
    }
    if (k % 10 == 0)
    {
      EXPECT_GE(std::abs(found.Distance), std::min(least, 3.0) - 0.06);
    }
    beyond += found.Distance == 3 ? 1 : 0;
  }
  EXPECT_GT(beyond, 50);
}

TEST(BoneDistance, IsNowhereWithoutTriangles)
{
  const TriangleBone bone({}, [](const Vec3&) { return false; });
  EXPECT_EQ(bone.Find({ 1, 2, 3 }, 4).Distance, 4);
}

// Beside a box, out along -z... and past another box that is above it.
TEST(InsertionPath, IsAsClearAsItsNarrowestPlace)
{
  const Vec3 low{ 0, -20, 0 };
  const Vec3 high{ 10, 20, 6 };
  const TriangleBone bone = MakeBone(MakeBox(low, high), low, high);
  const lacuna::InsertionPath straight(bone, { 0, 0, -1 }, 0.5);
  EXPECT_NEAR(straight.GetClearance({ -0.7, 1, 2 }), 0.7, 1e-3);
  EXPECT_NEAR(straight.GetClearance({ -0.7, 1, -40 }), 0.7, 1e-3);
  EXPECT_EQ(straight.GetClearance({ -4, 1, 2 }), 3);
  EXPECT_LT(straight.GetClearance({ 5, 1, -30 }), -0.9);
  EXPECT_LT(straight.GetClearance({ 5, 1, 3 }), -0.9);
  // leaning over the box by half a mm a mm: nearest at the upper edge
  const lacuna::InsertionPath leaning(bone, { -0.5, 0, -1 }, 0.5);
  const double rise = 4;
  const double beside = 5 - 0.5 * rise; // of the edge, at its height
  EXPECT_NEAR(leaning.GetClearance({ -5, 0, 2 }), std::min(3.0, beside / std::sqrt(1.25)), 0.02);
}

TEST(InsertionPath, HasTheDirectionOfTheMostTaper)
{
  // a trough: its walls lean to the same side
  std::vector<Vec3> walls;
  const Vec3 axis = lacuna::Normalized({ 0.3, -0.2, 0.9 });
  const Vec3 u = lacuna::Normalized(Cross(axis, { 1, 0, 0 }));
  const Vec3 v = Cross(axis, u);
  for (int k = 0; k < 100; ++k)
  {
    const double angle = 2 * 3.14159265358979323846 * k / 100;
    walls.push_back(std::cos(angle) * u + std::sin(angle) * v);
  }
  EXPECT_LT(Norm(lacuna::FindInsertionDirection(walls, { 0, 0, -1 }) + axis), 1e-3);
  EXPECT_LT(Norm(lacuna::FindInsertionDirection({}, { 0, 0, -2 }) - Vec3{ 0, 0, -1 }), 1e-12);
}
