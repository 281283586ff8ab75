// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSkullImplant.h"

#include "lacunaSkullTest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

using lacuna::MakeSkullImplant;
using lacuna::Matrix4;
using lacuna::MirrorPlane;
using lacuna::SkullImplant;
using lacuna::SkullImplantFace;
using lacuna::SkullImplantOptions;
using lacuna::SkullRays;
using lacuna::SkullShape;
using lacuna::Vec3;
using lacuna::VoxelVolume;

namespace
{
constexpr double Outer = 60;      // mm, of a spherical shell
constexpr double Thickness = 6;   // mm
constexpr double HoleAngle = 0.4; // radians from its axis: 47 mm across
constexpr std::size_t FewNodes = 200;

enum class Hole
{
  Cone,     ///< cut along rays from a point below the centre: it opens outwards
  Undercut, ///< the same from a point above
  Cylinder  ///< whose axis is not that of the skull there
};

// A spherical shell open below (z of directions under -0.5), with a hole. Values fall by 200 a mm across the surfaces.
struct Shell
{
  // strut: half the width of a bridge; slot: half the width of a gap from the hole to 1 radian from its axis
  explicit Shell(
    const Matrix4& ownToWorld = {}, double strut = -100, double slot = -10, Hole hole = Hole::Cone)
    : Axis(lacuna::Normalized({ 0.5, -0.3, 0.8 }))
    , Kind(hole)
    , Strut(strut)
    , Slot(slot)
  {
    this->Volume.Size = { 133, 137, 129 };
    this->Volume.Type = lacuna::ScalarType::Int16;
    const double spacing = 1;
    const Vec3 first{ -66, -68, -64 };
    this->Volume.IndexToWorld = ownToWorld *
      Matrix4::FromColumns({ spacing, 0, 0 }, { 0, spacing, 0 }, { 0, 0, spacing }, first);
    this->World = ownToWorld;
    for (int k = 0; k < this->Volume.Size[2]; ++k)
    {
      for (int j = 0; j < this->Volume.Size[1]; ++j)
      {
        for (int i = 0; i < this->Volume.Size[0]; ++i)
        {
          const Vec3 x = first + Vec3{ spacing * i, spacing * j, spacing * k };
          const double value = 300 + 200 * this->GetDepth(x);
          this->Voxels.push_back(static_cast<std::int16_t>(std::clamp(value, 0.0, 900.0)));
        }
      }
    }
    this->Volume.Voxels = this->Voxels.data();
    this->Plane.Normal = ownToWorld.Vector(lacuna::Normalized({ 0.3, 0.5, 0 }));
    this->Plane.Offset = Dot(this->Plane.Normal, ownToWorld.Column(3));
  }

  // mm below the nearest surface, positive in bone
  double GetDepth(const Vec3& x) const
  {
    const double r = Norm(x);
    double inside = std::min({ Outer - r, r - (Outer - Thickness), x[2] + 0.5 * Outer });
    const Vec3 beside = lacuna::Normalized(Cross(this->Axis, { 1, 0, 0 }));
    inside = std::min(inside, std::max(this->GetWall(x), this->Strut - std::abs(Dot(x, beside))));
    const double along = std::acos(Dot(lacuna::Normalized(x), this->Axis));
    const Vec3 ahead = Cross(beside, this->Axis);
    const double gap =
      std::max({ std::abs(Dot(x, beside)) - this->Slot, r * (along - 1), -Dot(x, ahead) });
    return std::min(inside, gap);
  }

  // mm from the wall of the hole, positive in bone
  double GetWall(const Vec3& x) const
  {
    if (this->Kind == Hole::Cylinder)
    {
      const Vec3 d = x - Outer * this->Axis;
      const Vec3 axis = this->GetCylinderAxis();
      return Norm(d - Dot(d, axis) * axis) - CylinderRadius;
    }
    const double up = this->Kind == Hole::Cone ? 1 : -1;
    const Vec3 d = x - (this->Kind == Hole::Cone ? -12.0 : 120.0) * this->Axis;
    const double angle = std::acos(up * Dot(lacuna::Normalized(d), this->Axis)) - HoleAngle;
    return Norm(d) * (std::abs(angle) < 0.5 * lacunaSkullTest::Pi ? std::sin(angle) : angle);
  }

  // Of a cylinder, outwards: it leans by CylinderTilt.
  Vec3 GetCylinderAxis() const
  {
    const Vec3 beside = lacuna::Normalized(Cross(this->Axis, { 0, 1, 0.3 }));
    return std::cos(CylinderTilt) * this->Axis + std::sin(CylinderTilt) * beside;
  }

  static constexpr double CylinderRadius = 20; // mm
  static constexpr double CylinderTilt = 0.35; // radians

  Vec3 Axis;
  Hole Kind;
  double Strut;
  double Slot;
  std::vector<std::int16_t> Voxels;
  VoxelVolume Volume;
  MirrorPlane Plane;
  Matrix4 World;
};

// What is exactly known of the shell: its planes, cones and spheres.
class ShellBone : public lacuna::BoneDistance
{
public:
  explicit ShellBone(const Shell& shell)
    : Bone(shell)
    , WorldToOwn(shell.World.Inverse())
  {
  }
  lacuna::NearestBone Find(const Vec3& world, double limit) const override
  {
    const Vec3 x = this->WorldToOwn.Point(world);
    const double depth = this->Bone.GetDepth(x);
    if (std::abs(depth) >= limit)
    {
      return { depth > 0 ? -limit : limit, world };
    }
    constexpr double h = 1e-4;
    Vec3 slope{ 0, 0, 0 };
    for (int a = 0; a < 3; ++a)
    {
      Vec3 after = x;
      Vec3 before = x;
      after[a] += h;
      before[a] -= h;
      slope[a] = (this->Bone.GetDepth(after) - this->Bone.GetDepth(before)) / (2 * h);
    }
    Vec3 foot = x - depth * lacuna::Normalized(slope);
    constexpr double tiny = 1e-6;
    const double r = Norm(foot);
    const bool isOff =
      r > Outer + tiny || r < Outer - Thickness - tiny || this->Bone.GetWall(foot) < -tiny;
    if (depth < 0 && isOff && this->Bone.Kind != Hole::Cylinder && this->Bone.Strut < 0 &&
      this->Bone.Slot < 0)
    {
      const Vec3 rims[] = { this->FindRim(x, Outer), this->FindRim(x, Outer - Thickness) };
      foot =
        Norm(x - rims[0]) < Norm(x - rims[1]) ? rims[0] : rims[1]; // of a wall that ends before
    }
    return { depth > 0 ? -depth : Norm(x - foot), this->Bone.World.Point(foot) };
  }
  std::array<Vec3, 2> GetBounds() const override
  {
    const Vec3 middle = this->Bone.World.Column(3);
    const Vec3 half{ Outer, Outer, Outer };
    return { middle - half, middle + half };
  }

private:
  // On the circle where the wall meets a sphere.
  Vec3 FindRim(const Vec3& x, double radius) const
  {
    const Vec3& axis = this->Bone.Axis;
    const Vec3 beside = lacuna::Normalized(x - Dot(x, axis) * axis);
    const auto at = [&](double angle)
    { return (radius * std::cos(angle)) * axis + (radius * std::sin(angle)) * beside; };
    double inside = 0;
    double outside = 1;
    for (int step = 0; step < 50; ++step)
    {
      const double middle = 0.5 * (inside + outside);
      (this->Bone.GetWall(at(middle)) < 0 ? inside : outside) = middle;
    }
    return at(inside);
  }

  const Shell& Bone;
  Matrix4 WorldToOwn;
};

SkullImplant Make(
  const Shell& shell, const SkullImplantOptions& options, int threads = 2, const Vec3& off = {})
{
  lacuna::ThreadExecution execution(threads);
  const SkullRays rays = TraceSkull(
    shell.Volume, options.Level, shell.World.Column(3) + shell.World.Vector(off), 4, execution);
  // the base is as clean an opening as the hole
  const Vec3 axis = shell.World.Vector(shell.Axis);
  std::vector<int> defect;
  for (const std::vector<int>& each : FindDefects(rays))
  {
    if (Dot(rays.Directions[each[each.size() / 2]], axis) > 0.5)
    {
      defect = each;
    }
  }
  std::vector<Vec3> missing;
  for (const int ray : defect)
  {
    missing.push_back(rays.Directions[ray]);
  }
  const SkullShape shape(GetSoundBone(rays), missing, shell.Plane, execution, nullptr, FewNodes);
  return MakeSkullImplant(shell.Volume, rays, defect, shape, ShellBone(shell), options, execution);
}

// Each edge is in two triangles, in opposite directions.
bool IsClosed(const SkullImplant& implant)
{
  std::map<std::pair<int, int>, int> edges;
  for (const auto& t : implant.Triangles)
  {
    for (int c = 0; c < 3; ++c)
    {
      ++edges[{ t[c], t[(c + 1) % 3] }];
    }
  }
  return std::all_of(edges.begin(), edges.end(),
    [&](const auto& e) {
      return e.second == 1 && edges.count({ e.first.second, e.first.first }) == 1;
    });
}
}

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
  options.TriangleSize = 0;
  EXPECT_THROW(Make(Shell(), options), std::invalid_argument);
  options.TriangleSize = 2;
  options.Thickness = 0.2;
  EXPECT_THROW(Make(Shell(), options), std::invalid_argument);
  options.Thickness = 0;
  options.MinimumThickness = -1;
  EXPECT_THROW(Make(Shell(), options), std::invalid_argument);
}
