// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaExecution.h"
#include "lacunaFaceRelief.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{
using namespace lacuna;

constexpr double Pi = 3.14159265358979323846;
constexpr double Radius = 60; // mm

// A part of a ball around an axis, from an angle of the axis to another one (radians).
struct Cap
{
  std::vector<Vec3> Points;
  std::vector<Triangle> Triangles;
  Vec3 Axis = Normalized({ 0.3, -0.5, 0.7 });
  Vec3 Centre{ 40, -110, 250 };

  Cap(double first, double last, int rings = 30, int around = 90)
  {
    const Vec3 x = Normalized(Cross(this->Axis, { 1, 0, 0 }));
    const Vec3 y = Cross(this->Axis, x);
    for (int j = 0; j <= rings; ++j)
    {
      const double a = first + (last - first) * j / rings;
      for (int i = 0; i < around; ++i)
      {
        const double b = 2 * Pi * i / around;
        this->Points.push_back(this->Centre + Radius * std::cos(a) * this->Axis +
          Radius * std::sin(a) * (std::cos(b) * x + std::sin(b) * y));
      }
    }
    for (int j = 0; j < rings; ++j)
    {
      for (int i = 0; i < around; ++i)
      {
        const int next = (i + 1) % around;
        const int upper = j * around;
        const int lower = upper + around;
        this->Triangles.push_back({ upper + i, lower + i, lower + next });
        this->Triangles.push_back({ upper + i, lower + next, upper + next });
      }
    }
  }
};

FaceRelief Make(const Cap& cap, double margin = 5)
{
  ThreadExecution execution(1);
  return MakeFaceRelief(execution, cap.Points, cap.Triangles, 0.75, margin);
}

std::string Refusal(const Cap& cap, double margin = 5)
{
  try
  {
    Make(cap, margin);
  }
  catch (const std::runtime_error& error)
  {
    return error.what();
  }
  return "";
}
}

// The best view is the middle of what is seen, however many points are on one side.
TEST(FaceRelief, SquareViewIsOfTheSteepest)
{
  const Vec3 axis = Normalized({ 0.3, -0.5, 0.7 });
  const Vec3 x = Normalized(Cross(axis, { 1, 0, 0 }));
  const Vec3 y = Cross(axis, x);
  std::vector<Vec3> normals;
  for (int j = 0; j <= 20; ++j)
  {
    for (int i = 0; i < 120; ++i)
    {
      const double a = 0.9 * j / 20;
      const double b = i < 60 ? 0.01 * i : 2 * Pi * (i - 60) / 60;
      normals.push_back(std::cos(a) * axis + std::sin(a) * (std::cos(b) * x + std::sin(b) * y));
    }
  }
  const Vec3 view = FindSquareView(normals);
  EXPECT_GT(-Dot(view, axis), std::cos(0.005));
}

// Samples are on the ball, in its place, and the hole in its middle is closed.
TEST(FaceRelief, IsTheFace)
{
  const Cap cap(0.15, 0.8);
  const FaceRelief relief = Make(cap);
  EXPECT_NEAR(relief.ToWorld.Determinant3(), 1, 1e-12);
  EXPECT_NEAR(relief.SteepestAngle, 0.8 * 180 / Pi, 1);
  EXPECT_NEAR(Norm(relief.SteepestPoint - cap.Centre), Radius, 1e-9);
  EXPECT_LT(relief.Deviation, 0.005);
  const Vec3 view = Normalized(relief.ToWorld.Vector({ 0, 0, 1 }));
  EXPECT_LT(Dot(view, cap.Axis), -std::cos(0.01));
  double onFace = 0;
  double beyond = 0;
  int count = 0;
  for (std::int64_t k = 0; k < static_cast<std::int64_t>(relief.Depths.size()); ++k)
  {
    const Vec3 p = relief.ToWorld.Point({ 0.75 * static_cast<double>(k % relief.Size.Columns),
                     0.75 * static_cast<double>(k / relief.Size.Columns), relief.Depths[k] }) -
      cap.Centre;
    const double angle = std::acos(Dot(Normalized(p), cap.Axis));
    EXPECT_TRUE(angle > 0.78 || relief.Mask[k] == 1) << angle;
    EXPECT_TRUE(angle < 0.81 || relief.Mask[k] == 0) << angle;
    double& off = angle < 0.8 && angle > 0.15 ? onFace : beyond;
    if (angle < 0.86) // 3 mm beyond the rim
    {
      off = std::max(off, std::abs(Norm(p) - Radius));
      ++count;
    }
  }
  EXPECT_GT(count, 10000);
  EXPECT_LT(onFace, 0.01);
  EXPECT_LT(beyond, 0.1);
}

// Few, large triangles give a surface, too, and say how far it is from their corners.
TEST(FaceRelief, TakesCoarseMeshes)
{
  const FaceRelief relief = Make(Cap(0.1, 0.8, 2, 5));
  EXPECT_GT(relief.Deviation, 0);
  EXPECT_LT(relief.Deviation, 1);
}

TEST(FaceRelief, RefusesWhatNoMouldMakes)
{
  EXPECT_EQ(Refusal(Cap(0.1, 1.4)), "");
  const std::string steep = Refusal(Cap(0.1, 1.7));
  EXPECT_NE(steep.find("no direction of pressing sees all of the face"), std::string::npos)
    << steep;
  EXPECT_NE(steep.find("96 degrees steep"), std::string::npos) << steep;
  for (const double margin : { 1e6, HUGE_VAL })
  {
    const std::string large = Refusal(Cap(0.1, 0.8), margin);
    EXPECT_NE(large.find("the largest mould is made of 1000 mm"), std::string::npos) << large;
  }
  Cap flat(0.1, 0.8);
  std::fill(flat.Points.begin(), flat.Points.end(), flat.Centre);
  EXPECT_EQ(Refusal(flat), "the face has no area");
}

// A surface of second degree is found exactly, beyond its points, too.
TEST(SplineEquations, GoesOnWithCurvature)
{
  const auto surface = [](double u, double v) -> Vec3 {
    return { u, v, 3 + 0.2 * u - 0.1 * v + 0.01 * u * u - 0.02 * u * v + 0.03 * v * v };
  };
  std::vector<SplinePoint> points;
  for (int k = 0; k < 900; ++k)
  {
    const double u = 5 + 0.3 * (k % 30) + 0.1 * std::sin(k);
    const double v = 4 + 0.4 * std::floor(k / 30.0) + 0.1 * std::cos(k);
    points.push_back({ { u, v }, surface(u, v) });
  }
  const BSplineSurface found = FitScattered(points, { 0, 0 }, { 20, 20 }, 2);
  for (const Vec2& at : { Vec2{ 0, 0 }, Vec2{ 10, 10 }, Vec2{ 20, 3 }, Vec2{ 20, 20 } })
  {
    EXPECT_LT(Norm(found.Evaluate(at[0], at[1]) - surface(at[0], at[1])), 1e-5);
  }
}

// Closed splines go round; a part of them is the same function.
TEST(SplineEquations, ClosedSplinesHaveNoSeam)
{
  const UniformSplines u(0, 2 * Pi, 24, true);
  const UniformSplines v(0, 3, 2, false);
  SplineEquations equations(u, v);
  for (int k = 0; k < 1000; ++k)
  {
    const double angle = 2 * Pi * k / 100;
    const double height = 0.3 * std::floor(k / 100.0) + 0.15;
    equations.Add({ { angle, height }, { std::cos(angle), std::sin(angle), height } }, 1);
  }
  equations.AddStiffness(1e-9, true, 2);
  const std::vector<Vec3> control = equations.Solve();
  ASSERT_EQ(control.size(), 24U * 5U);
  const auto at = [&](double angle, double height)
  {
    const CubicSplineSpace::Values bu = u.Evaluate(angle);
    const CubicSplineSpace::Values bv = v.Evaluate(height);
    Vec3 p{ 0, 0, 0 };
    for (int k = 0; k < 16; ++k)
    {
      p = p +
        bu.Weights[k % 4] * bv.Weights[k / 4] *
          control[u.Wrap(static_cast<int>(bu.First) + k % 4) + 24 * (bv.First + k / 4)];
    }
    return p;
  };
  for (const double angle : { 0.0, 1.0, 6.0, 2 * Pi, 7.0 })
  {
    EXPECT_LT(Norm(at(angle, 1) - Vec3{ std::cos(angle), std::sin(angle), 1 }), 1e-4) << angle;
  }
  EXPECT_LT(Norm(at(0, 1) - at(2 * Pi, 1)), 1e-12);
  for (const int first : { 0, 12 })
  {
    const BSplineSurface half = MakeClamped(u, v, control, first, first + 12);
    ASSERT_EQ(half.U.GetSize(), 15);
    for (const double part : { 0.0, 0.1, 0.5, 0.93, 1.0 })
    {
      const double angle = half.U.GetFirst() + part * (half.U.GetLast() - half.U.GetFirst());
      EXPECT_LT(Norm(half.Evaluate(angle, 3 * part) - at(angle, 3 * part)), 1e-12) << angle;
    }
  }
}
