// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSkullImplant.h"

#include "lacunaShellTest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

using namespace lacunaShellTest;

TEST(SkullImplant, FillsTheHoleOfASphere)
{
  const Shell shell;
  SkullImplantOptions options;
  options.TriangleSize = 1.5;
  const SkullImplant implant = Make(shell, options);
  EXPECT_TRUE(IsClosed(implant));
  ASSERT_EQ(implant.Faces.size(), implant.Triangles.size());
  double nearest = -100;
  double farthest = 100;
  for (std::size_t t = 0; t < implant.Triangles.size(); ++t)
  {
    for (const int corner : implant.Triangles[t])
    {
      const Vec3& x = implant.Points[corner];
      if (implant.Faces[t] != SkullImplantFace::Edge)
      {
        const double radius =
          implant.Faces[t] == SkullImplantFace::Outer ? Outer : Outer - Thickness;
        EXPECT_NEAR(Norm(x), radius, 0.05);
      }
      else
      {
        nearest = std::max(nearest, shell.GetWall(x));
        farthest = std::min(farthest, shell.GetWall(x));
      }
    }
  }
  // the clearance at each depth, within what comes of edges of triangles
  EXPECT_NEAR(nearest, -0.5, 0.03);
  EXPECT_NEAR(farthest, -0.5, 0.03);
  EXPECT_NEAR(implant.InsertionClearance, 0.5, 0.03);
  EXPECT_EQ(implant.UndercutVolume, 0);
  EXPECT_NEAR(implant.MinimumThickness, Thickness, 0.05);
  // By rings of the cone, at distance r from the middle and half a mm within its wall.
  double volume = 0;
  double area = 0;
  const int steps = 600;
  for (int k = 0; k <= steps; ++k)
  {
    const double r = Outer - Thickness * k / steps;
    const double sine = (12 * std::sin(HoleAngle) - 0.5) / r; // of the angle between wall and ray
    const double share = 2 * lacunaSkullTest::Pi * (1 - std::cos(HoleAngle + std::asin(sine)));
    area = k == 0 ? share * r * r : area;
    volume += (k % steps == 0 ? 0.5 : 1) * share * r * r * Thickness / steps;
  }
  EXPECT_NEAR(implant.Volume, volume, 0.005 * volume);
  EXPECT_NEAR(implant.OuterArea, area, 0.005 * area);
  EXPECT_GT(implant.HoleArea, implant.OuterArea);
  EXPECT_GT(Dot(implant.InsertionDirection, shell.Axis), -1.001);
  EXPECT_LT(Dot(implant.InsertionDirection, shell.Axis), -0.995);
  EXPECT_NEAR(implant.LeastTaper, HoleAngle * 180 / lacunaSkullTest::Pi, 1);
  EXPECT_EQ(implant.Errors.size(), implant.Points.size());
  EXPECT_GE(implant.LargestError, implant.ErrorRMS);
  EXPECT_TRUE(implant.Warnings.empty());
}

// The way in is along the cylinder, and so are the walls: no bone is in the way, and the gap is the same everywhere.
TEST(SkullImplant, IsPutInAlongACylinder)
{
  const Matrix4 turn = Matrix4::Translation({ 40, -25, 30 }) * Matrix4::Rotation({ 1, 2, -1 }, 1.1);
  const Shell shell(turn, -100, -10, Hole::Cylinder);
  SkullImplantOptions options;
  options.TriangleSize = 1.5;
  const SkullImplant implant = Make(shell, options);
  EXPECT_TRUE(IsClosed(implant));
  const Vec3 axis = turn.Vector(shell.GetCylinderAxis());
  EXPECT_LT(Dot(implant.InsertionDirection, axis), -std::cos(0.02));
  EXPECT_NEAR(implant.LeastTaper, 0, 1.5);
  EXPECT_NEAR(implant.InsertionClearance, 0.5, 0.03);
  EXPECT_LT(implant.UndercutVolume, 1);
  for (std::size_t t = 0; t < implant.Triangles.size(); ++t)
  {
    for (const int corner : implant.Triangles[t])
    {
      if (implant.Faces[t] == SkullImplantFace::Edge)
      {
        EXPECT_NEAR(shell.GetWall(turn.Inverse().Point(implant.Points[corner])), -0.5, 0.05);
      }
    }
  }
}

// Straight in, the cylinder is in the way on one side and open on the other.
TEST(SkullImplant, KeepsClearOfBoneAlongAGivenDirection)
{
  const Shell shell({}, -100, -10, Hole::Cylinder);
  SkullImplantOptions options;
  options.TriangleSize = 1.5;
  options.InsertionDirection = -3 * shell.Axis;
  const SkullImplant implant = Make(shell, options);
  EXPECT_TRUE(IsClosed(implant));
  EXPECT_LT(Norm(implant.InsertionDirection + shell.Axis), 1e-12);
  const ShellBone bone(shell);
  double least = 100;
  for (const Vec3& x : implant.Points)
  {
    for (double way = 0; way < 20; way += 0.1)
    {
      least = std::min(least, bone.Find(x + way * shell.Axis, 5).Distance);
    }
  }
  EXPECT_GT(least, 0.45);
  EXPECT_NEAR(implant.InsertionClearance, least, 0.05);
  // At the foot of the wall, which leans over it; the sphere's slope beside the axis makes it somewhat more.
  const double width = Thickness * std::sin(Shell::CylinderTilt);
  EXPECT_GT(implant.UndercutWidth, 0.9 * width);
  EXPECT_LT(implant.UndercutWidth, 1.4 * width);
  // on the side to which the cylinder leans the wall is undercut
  const Vec3 lean = shell.GetCylinderAxis() - Dot(shell.GetCylinderAxis(), shell.Axis) * shell.Axis;
  EXPECT_LT(Dot(implant.UndercutPoint, lean), 0);
  // half of the wall, a triangle of the width and the thickness
  const double volume = 2 * Shell::CylinderRadius * 0.5 * Thickness * width;
  EXPECT_NEAR(implant.UndercutVolume, volume, 0.35 * volume);
}

// The hole is narrowest outside: the edge goes straight down from there.
TEST(SkullImplant, TellsOfUndercutsAllAround)
{
  const Shell shell({}, -100, -10, Hole::Undercut);
  SkullImplantOptions options;
  options.TriangleSize = 1.5;
  const SkullImplant implant = Make(shell, options);
  EXPECT_TRUE(IsClosed(implant));
  EXPECT_GT(implant.InsertionClearance, 0.45);
  EXPECT_LT(Dot(implant.InsertionDirection, shell.Axis), -0.999);
  EXPECT_GT(implant.LeastTaper, -1);
  // At the foot, where the edge goes straight down from its upper end. Bone is thin at its own rim, and so is the
  // implant that follows it.
  const double depth = implant.Thickness[0] * std::cos(0.49);
  EXPECT_NEAR(implant.UndercutWidth, depth * std::sin(HoleAngle), 0.3);
}

TEST(SkullImplant, HasTheWantedThickness)
{
  const Shell shell;
  SkullImplantOptions options;
  options.TriangleSize = 2;
  options.Thickness = 3;
  const SkullImplant uniform = Make(shell, options);
  EXPECT_TRUE(IsClosed(uniform));
  EXPECT_NEAR(uniform.MinimumThickness, 3, 0.03);
  options.Thickness = 0;
  options.MinimumThickness = 8;
  const SkullImplant thicker = Make(shell, options);
  EXPECT_GE(thicker.MinimumThickness, 8);
  EXPECT_LT(thicker.MinimumThickness, 8.2);
  options.Thickness = 0.6; // thinner than the least thickness: what is asked for counts
  options.MinimumThickness = 1.5;
  EXPECT_NEAR(Make(shell, options).MinimumThickness, 0.6, 0.02);
  for (const auto* implant : { &uniform, &thicker })
  {
    const double inner = Outer - (implant == &uniform ? 3 : 8 * 1.01);
    for (std::size_t t = 0; t < implant->Triangles.size(); ++t)
    {
      const Vec3& x = implant->Points[implant->Triangles[t][0]];
      if (implant->Faces[t] == SkullImplantFace::Outer)
      {
        EXPECT_NEAR(Norm(x), Outer, 0.05);
      }
      else if (implant->Faces[t] == SkullImplantFace::Inner)
      {
        EXPECT_NEAR(Norm(x), inner, 0.05);
      }
    }
  }
}

TEST(SkullImplant, KeepsWideClearances)
{
  const Shell shell;
  SkullImplantOptions options;
  options.TriangleSize = 1.5;
  for (const double clearance : { 1.5, 4.0 })
  {
    options.EdgeClearance = clearance;
    const SkullImplant implant = Make(shell, options);
    EXPECT_TRUE(IsClosed(implant));
    EXPECT_NEAR(implant.InsertionClearance, clearance, 0.05);
    for (std::size_t t = 0; t < implant.Triangles.size(); ++t)
    {
      if (implant.Faces[t] == SkullImplantFace::Edge)
      {
        EXPECT_NEAR(shell.GetWall(implant.Points[implant.Triangles[t][0]]), -clearance, 0.06);
      }
    }
  }
}

// Far thicker than bone: the wall bends around the inner end of the bone's, and its triangles do not cut that corner.
TEST(SkullImplant, DoesNotCutCornersOfBone)
{
  const Shell shell;
  SkullImplantOptions options;
  options.TriangleSize = 1.5;
  options.Thickness = 20;
  const SkullImplant implant = Make(shell, options);
  EXPECT_TRUE(IsClosed(implant));
  const ShellBone bone(shell);
  double least = 100;
  for (std::size_t t = 0; t < implant.Triangles.size(); ++t)
  {
    const auto& c = implant.Triangles[t];
    for (int k = 0; implant.Faces[t] == SkullImplantFace::Edge && k <= 8; ++k)
    {
      const Vec3 a = implant.Points[c[0]];
      least = std::min(least, bone.Find(a + (k / 8.0) * (implant.Points[c[1]] - a), 5).Distance);
    }
  }
  EXPECT_GT(least, 0.4);
  EXPECT_NEAR(implant.InsertionClearance, least, 0.05);
}

TEST(SkullImplant, TurnsWithTheVolume)
{
  const Matrix4 turn =
    Matrix4::Translation({ 40, -25, 300 }) * Matrix4::Rotation({ 1, 2, -1 }, 1.1);
  SkullImplantOptions options;
  options.TriangleSize = 2;
  const SkullImplant here = Make(Shell(), options, 1);
  const SkullImplant there = Make(Shell(turn), options, 2);
  ASSERT_EQ(here.Points.size(), there.Points.size());
  for (std::size_t i = 0; i < here.Points.size(); ++i)
  {
    EXPECT_LT(Norm(turn.Point(here.Points[i]) - there.Points[i]), 1e-3);
    EXPECT_NEAR(here.Errors[i], there.Errors[i], 1e-3);
  }
  EXPECT_EQ(here.Triangles, there.Triangles);
}

TEST(SkullImplant, IsTheSameFromAnotherMiddle)
{
  const Shell shell;
  SkullImplantOptions options;
  options.TriangleSize = 2;
  const SkullImplant implant = Make(shell, options, 2, { 4, -3, 5 });
  for (std::size_t t = 0; t < implant.Triangles.size(); ++t)
  {
    if (implant.Faces[t] == SkullImplantFace::Outer)
    {
      EXPECT_NEAR(Norm(implant.Points[implant.Triangles[t][0]]), Outer, 0.05);
    }
  }
}

TEST(SkullImplant, LeavesBoneInTheHoleFree)
{
  // a bridge of 8 mm across the hole: one half is filled, and the other is told of
  const Shell shell({}, 4);
  SkullImplantOptions options;
  options.TriangleSize = 2;
  const SkullImplant implant = Make(shell, options);
  EXPECT_TRUE(IsClosed(implant));
  const Vec3 beside = lacuna::Normalized(Cross(shell.Axis, { 1, 0, 0 }));
  const double side = Dot(implant.Points[0], beside) > 0 ? 1 : -1;
  for (const Vec3& x : implant.Points)
  {
    EXPECT_GT(side * Dot(x, beside), 4 + 0.3);
  }
}

TEST(SkullImplant, LeavesNarrowGapsOut)
{
  SkullImplantOptions options;
  options.TriangleSize = 2;
  const SkullImplant whole = Make(Shell(), options);
  // 3 mm wide, and 35 mm long
  const SkullImplant implant = Make(Shell({}, -100, 1.5), options);
  EXPECT_TRUE(IsClosed(implant));
  EXPECT_NEAR(implant.Volume, whole.Volume, 0.01 * whole.Volume);
  const Vec3 axis = Shell().Axis;
  const auto farthest = [&](const SkullImplant& each)
  {
    double angle = 0;
    for (const Vec3& x : each.Points)
    {
      angle = std::max(angle, std::acos(Dot(lacuna::Normalized(x), axis)));
    }
    return angle;
  };
  EXPECT_LT(farthest(implant), farthest(whole) + 2.5 / Outer);
  EXPECT_GT(implant.LeastTaper, 0.5 * whole.LeastTaper);
}

TEST(SkullImplant, EndsWhereTheScanDoesAndSaysSo)
{
  SkullImplantOptions options;
  options.TriangleSize = 2;
  Shell shell;
  for (const int slices : { 112, 122 }) // the hole reaches up to 59 mm
  {
    shell.Volume.Size[2] = slices;
    const double highest = slices - 65;
    const SkullImplant implant = Make(shell, options);
    EXPECT_TRUE(IsClosed(implant));
    ASSERT_EQ(implant.Warnings.size(), 1u);
    EXPECT_NE(implant.Warnings[0].find("the scan ends within the hole"), std::string::npos);
    double top = 0;
    for (const Vec3& x : implant.Points)
    {
      top = std::max(top, x[2]);
    }
    EXPECT_LT(top, highest + 1);
    EXPECT_GT(top, highest - 3);
  }
}

TEST(SkullImplant, RefusesWhatCannotBe)
{
  SkullImplantOptions options;
  options.EdgeClearance = -1;
  EXPECT_THROW(Make(Shell(), options), std::invalid_argument);
  options.EdgeClearance = 0.5;
  options.TriangleSize = 0.1;
  EXPECT_THROW(Make(Shell(), options), std::invalid_argument);
  options.TriangleSize = 2;
  options.Thickness = 0.2;
  EXPECT_THROW(Make(Shell(), options), std::invalid_argument);
  options.Thickness = 0;
  options.MinimumThickness = -1;
  EXPECT_THROW(Make(Shell(), options), std::invalid_argument);
}
