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
constexpr double Outer = 60;     // mm, of a spherical shell
constexpr double Thickness = 6;  // mm
constexpr double HoleAngle = 0.4; // radians from its axis: 47 mm across
constexpr std::size_t FewNodes = 200;

// A spherical shell open below (z of directions under -0.5), with a hole whose wall is cut along rays
// from a point below the centre. Values fall by 200 a mm across the surfaces.
struct Shell
{
  explicit Shell(const Matrix4& ownToWorld = {}, double strut = 0)
    : Axis(lacuna::Normalized({ 0.5, -0.3, 0.8 }))
  {
    this->Volume.Size = { 90, 92, 88 };
    this->Volume.Type = lacuna::ScalarType::Int16;
    const double spacing = 1.5;
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
          inside = std::min(inside, x[2] + 0.5 * Outer);
          const double away = this->GetWall(x);
          const Vec3 beside = lacuna::Normalized(Cross(this->Axis, { 1, 0, 0 }));
          const double bridge = strut - std::abs(Dot(x, beside));
          inside = std::min(inside, std::max(away, bridge));
          this->Voxels.push_back(
            static_cast<std::int16_t>(std::clamp(300 + 200 * inside, 0.0, 1000.0)));
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
  const std::vector<std::vector<int>> defects = FindDefects(rays);
  EXPECT_FALSE(defects.empty());
  std::vector<Vec3> missing;
  for (const int ray : defects.at(0))
  {
    missing.push_back(rays.Directions[ray]);
  }
  const SkullShape shape(GetSoundBone(rays), missing, shell.Plane, execution, FewNodes);
  return MakeSkullImplant(shell.Volume, rays, defects.at(0), shape, options, execution);
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
    [&](const auto& e)
    { return e.second == 1 && edges.count({ e.first.second, e.first.first }) == 1; });
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
  double leastWall = -100;
  double mostWall = -100;
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
        // no point of the edge comes nearer to bone than the clearance, and the nearest of each ray is there
        mostWall = std::max(mostWall, shell.GetWall(x));
        leastWall = std::max(leastWall, shell.GetWall(Outer / Norm(x) * x));
      }
    }
  }
  EXPECT_LT(mostWall, -0.45);
  EXPECT_GT(mostWall, -0.65);
  // the wall of bone is steeper than the rays: the gap is wider at the outer surface, by 6 mm * tan(5 degrees)
  EXPECT_LT(leastWall, -0.45);
  // a spherical cap of the outline's angle, between two radii
  const double chord = std::asin(12.0 / Outer * std::sin(HoleAngle)); // from the apex' to the centre's angle
  const double inner = Outer - Thickness;
  const double angle = HoleAngle - std::asin(12.0 / inner * std::sin(HoleAngle)) - 0.5 / inner;
  EXPECT_LT(angle, HoleAngle - chord);
  const double share = 2 * lacunaSkullTest::Pi * (1 - std::cos(angle));
  EXPECT_NEAR(implant.Volume, share * (std::pow(Outer, 3) - std::pow(inner, 3)) / 3,
    0.02 * implant.Volume);
  EXPECT_NEAR(implant.OuterArea, share * Outer * Outer, 0.02 * implant.OuterArea);
  EXPECT_GT(implant.HoleArea, implant.OuterArea);
  EXPECT_GT(Dot(implant.InsertionDirection, shell.Axis), -1.001);
  EXPECT_LT(Dot(implant.InsertionDirection, shell.Axis), -0.995);
  EXPECT_NEAR(implant.LeastTaper, angle * 180 / lacunaSkullTest::Pi, 2);
  EXPECT_EQ(implant.Errors.size(), implant.Points.size());
  EXPECT_GE(implant.LargestError, implant.ErrorRMS);
  EXPECT_TRUE(implant.Warnings.empty());
}
