// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaLandmarks.h"

#include "lacunaMatrix4.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

using namespace lacuna;

namespace
{
std::vector<Vec3> Cloud()
{
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> range(-50, 50);
  std::vector<Vec3> points;
  for (int k = 0; k < 500; ++k)
  {
    points.push_back({ range(random), range(random), 0.2 * range(random) });
  }
  return points;
}

std::array<Vec3, 4> Take(
  const std::vector<Vec3>& points, const std::array<std::size_t, 4>& indices, const Matrix4& move)
{
  std::array<Vec3, 4> taken;
  for (std::size_t k = 0; k < 4; ++k)
  {
    taken[k] = move.Point(points[indices[k]]);
  }
  return taken;
}

LandmarkMove MoveOf(const Matrix4& move)
{
  const std::vector<Vec3> points = Cloud();
  std::array<std::size_t, 4> indices{};
  EXPECT_TRUE(FindLandmarks(points, indices));
  return CompareLandmarks(Take(points, indices, {}), Take(points, indices, move));
}
}

TEST(Landmarks, SpanTheSpaceOfThePoints)
{
  const std::vector<Vec3> points = Cloud();
  std::array<std::size_t, 4> indices{};
  ASSERT_TRUE(FindLandmarks(points, indices));
  EXPECT_EQ(indices[0], 0u);
  for (const Vec3& p : points)
  {
    EXPECT_LE(Norm(p - points[0]), Norm(points[indices[1]] - points[0]));
  }
  const auto p = Take(points, indices, {});
  EXPECT_GT(std::abs(Dot(Cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0])), 20000);
}

TEST(Landmarks, NeedFourPointsThatAreNotInAPlane)
{
  std::array<std::size_t, 4> indices{};
  EXPECT_FALSE(FindLandmarks({}, indices));
  EXPECT_FALSE(FindLandmarks({ { 1, 2, 3 } }, indices));
  EXPECT_FALSE(FindLandmarks({ { 1, 2, 3 }, { 2, 3, 4 }, { 3, 4, 5 }, { 5, 6, 7 } }, indices));
  std::vector<Vec3> flat = Cloud();
  for (Vec3& p : flat)
  {
    p[2] = 0.3 * p[0] - 0.7 * p[1];
  }
  EXPECT_FALSE(FindLandmarks(flat, indices));
  flat[77][2] += 0.01;
  EXPECT_TRUE(FindLandmarks(flat, indices));
}

TEST(Landmarks, LeadTheOtherPoints)
{
  const Matrix4 move = Matrix4::Translation({ 500, -2, 7 }) * Matrix4::Rotation({ 3, -1, 2 }, 1.3) *
    Matrix4::Scaling({ 1, -2, 0.5 });
  const std::vector<Vec3> points = Cloud();
  std::array<std::size_t, 4> indices{};
  ASSERT_TRUE(FindLandmarks(points, indices));
  const Matrix4 map = MapLandmarks(Take(points, indices, {}), Take(points, indices, move));
  for (const Vec3& p : points)
  {
    EXPECT_LE(Norm(map.Point(p) - move.Point(p)), 1e-10);
  }
}

TEST(Landmarks, TellMotionsApart)
{
  const LandmarkMove none = MoveOf({});
  EXPECT_EQ(none.Stretch, 0);
  EXPECT_EQ(none.Way, 0);
  EXPECT_FALSE(none.Mirrored);
  EXPECT_NEAR(none.Tilt, 0, 1e-9);

  const LandmarkMove shift = MoveOf(Matrix4::Translation({ 3, -4, 12 }));
  EXPECT_NEAR(shift.Way, 13, 1e-12);
  EXPECT_NEAR(shift.Rise, 12, 1e-12);
  EXPECT_NEAR(shift.Stretch, 0, 1e-12);
  EXPECT_NEAR(shift.Tilt, 0, 1e-9);

  const LandmarkMove turn = MoveOf(Matrix4::Rotation({ 0, 0, 1 }, 0.4));
  EXPECT_GT(turn.Way, 1);
  EXPECT_NEAR(turn.Rise, 0, 1e-12);
  EXPECT_NEAR(turn.Stretch, 0, 1e-12);
  EXPECT_NEAR(turn.Tilt, 0, 1e-9);
  EXPECT_FALSE(turn.Mirrored);

  const LandmarkMove tilt = MoveOf(Matrix4::Rotation({ 1, 0, 0 }, 0.01));
  EXPECT_NEAR(tilt.Tilt, 0.01 * 180 / 3.14159265358979323846, 1e-9);
  EXPECT_FALSE(tilt.Mirrored);

  for (const Vec3& s : { Vec3{ -1, 1, 1 }, Vec3{ 1, -1, 1 }, Vec3{ 1, 1, -1 }, Vec3{ -1, -1, -1 } })
  {
    const LandmarkMove mirror = MoveOf(Matrix4::Translation({ 1, 2, 3 }) * Matrix4::Scaling(s));
    EXPECT_TRUE(mirror.Mirrored);
    EXPECT_NEAR(mirror.Stretch, 0, 1e-12);
  }
  EXPECT_FALSE(MoveOf(Matrix4::Scaling({ -1, -1, 1 })).Mirrored); // half a turn
  EXPECT_GT(MoveOf(Matrix4::Scaling({ 1 / 25.4, 1 / 25.4, 1 / 25.4 })).Stretch, 50);
  EXPECT_GT(MoveOf(Matrix4::Scaling({ 1, 1, 1.001 })).Stretch, 0.003);
  EXPECT_GT(MoveOf(Matrix4::Scaling({ 1, 1, 0 })).Stretch, 0.5);
}
