// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSkullImplant.h"

#include "lacunaSkullTest.h"

#include <gtest/gtest.h>

#include <algorithm>
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

// A spherical shell open below (z of directions under -0.5), with a hole whose wall is cut along rays
// from a point below the centre. Values fall by 200 a mm across the surfaces.
struct Shell
{
  // strut: half the width of a bridge; slot: half the width of a gap from the hole to 1 radian from its axis
  explicit Shell(const Matrix4& ownToWorld = {}, double strut = 0, double slot = -10)
    : Axis(lacuna::Normalized({ 0.5, -0.3, 0.8 }))
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
          const double r = Norm(x);
          double inside = std::min(Outer - r, r - (Outer - Thickness));
          if (inside < -3)
          {
            this->Voxels.push_back(0);
            continue;
          }
          inside = std::min(inside, x[2] + 0.5 * Outer);
          const double away = this->GetWall(x);
          const Vec3 beside = lacuna::Normalized(Cross(this->Axis, { 1, 0, 0 }));
          const double bridge = strut - std::abs(Dot(x, beside));
          inside = std::min(inside, std::max(away, bridge));
          const double along = std::acos(Dot(lacuna::Normalized(x), this->Axis));
          const Vec3 ahead = Cross(beside, this->Axis);
          const double gap =
            std::max({ std::abs(Dot(x, beside)) - slot, r * (along - 1), -Dot(x, ahead) });
          inside = std::min(inside, gap);
          this->Voxels.push_back(
            static_cast<std::int16_t>(std::clamp(300 + 200 * inside, 0.0, 900.0)));
        }
      }
    }
    this->Volume.Voxels = this->Voxels.data();
    this->Plane.Normal = ownToWorld.Vector(lacuna::Normalized({ 0.3, 0.5, 0 }));
    this->Plane.Offset = Dot(this->Plane.Normal, ownToWorld.Column(3));
  }

  // mm from the wall of the hole, positive in bone
  double GetWall(const Vec3& x) const
  {
    const Vec3 apex = -12.0 * this->Axis;
    const Vec3 d = x - apex;
    return Norm(d) * (std::acos(Dot(lacuna::Normalized(d), this->Axis)) - HoleAngle);
  }

  Vec3 Axis;
  std::vector<std::int16_t> Voxels;
  VoxelVolume Volume;
  MirrorPlane Plane;
  Matrix4 World;
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
  return MakeSkullImplant(shell.Volume, rays, defect, shape, options, execution);
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
      }
    }
  }
  // The wall of bone is steeper than the rays, so that it is nearest at the outer surface: there the
  // clearance, which is that of the inner surface, is a ninth more.
  EXPECT_NEAR(nearest, -0.5 * Outer / (Outer - Thickness), 0.12);
  const double inner = Outer - Thickness;
  const double angle = HoleAngle + std::asin(12 / Outer * std::sin(HoleAngle)) - 0.5 / inner;
  const double share = 2 * lacunaSkullTest::Pi * (1 - std::cos(angle));
  EXPECT_NEAR(
    implant.Volume, share * (std::pow(Outer, 3) - std::pow(inner, 3)) / 3, 0.015 * implant.Volume);
  EXPECT_NEAR(implant.OuterArea, share * Outer * Outer, 0.015 * implant.OuterArea);
  EXPECT_GT(implant.HoleArea, implant.OuterArea);
  EXPECT_GT(Dot(implant.InsertionDirection, shell.Axis), -1.001);
  EXPECT_LT(Dot(implant.InsertionDirection, shell.Axis), -0.995);
  EXPECT_NEAR(implant.LeastTaper, angle * 180 / lacunaSkullTest::Pi, 2);
  EXPECT_EQ(implant.Errors.size(), implant.Points.size());
  EXPECT_GE(implant.LargestError, implant.ErrorRMS);
  EXPECT_TRUE(implant.Warnings.empty());
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
  const SkullImplant implant = Make(Shell({}, 0, 1.5), options);
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
}
