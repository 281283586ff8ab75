// SPDX-License-Identifier: BSD-3-Clause
// A spherical shell with a hole whose walls are known exactly, and implants for it.
#ifndef lacunaShellTest_h
#define lacunaShellTest_h

#include "lacunaSkullImplant.h"
#include "lacunaSkullTest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace lacunaShellTest
{
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

constexpr double Outer = 60;      // mm, of a spherical shell
constexpr double Thickness = 6;   // mm
constexpr double HoleAngle = 0.4; // radians from its axis: 47 mm across
constexpr std::size_t FewNodes = 200;

enum class Hole
{
  Cone,     ///< cut along rays from a point below the centre: it opens outwards
  Undercut, ///< the same from a point above
  Cylinder, ///< whose axis is not that of the skull there
  None
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
    if (this->Kind == Hole::None)
    {
      return 2 * Outer;
    }
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

// change: of the rays, when the surfaces are predicted already.
inline SkullImplant Make(const Shell& shell, const SkullImplantOptions& options, int threads = 2,
  const Vec3& off = {}, const std::function<void(SkullRays&)>& change = {})
{
  lacuna::ThreadExecution execution(threads);
  SkullRays rays = TraceSkull(
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
  if (change)
  {
    change(rays);
  }
  return MakeSkullImplant(shell.Volume, rays, defect, shape, ShellBone(shell), options, execution);
}

// Each edge is in two triangles, in opposite directions.
inline bool IsClosed(const SkullImplant& implant)
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

// Of the edge's triangles that hang together: lists of points. The rim is one of them.
inline std::vector<std::vector<int>> FindWalls(const SkullImplant& implant)
{
  std::vector<int> parent(implant.Points.size());
  for (std::size_t k = 0; k < parent.size(); ++k)
  {
    parent[k] = static_cast<int>(k);
  }
  const auto find = [&](int k)
  {
    while (parent[k] != k)
    {
      k = parent[k] = parent[parent[k]];
    }
    return k;
  };
  std::set<int> used;
  for (std::size_t t = 0; t < implant.Triangles.size(); ++t)
  {
    if (implant.Faces[t] == SkullImplantFace::Edge)
    {
      for (const int corner : implant.Triangles[t])
      {
        used.insert(corner);
        parent[find(corner)] = find(implant.Triangles[t][0]);
      }
    }
  }
  std::map<int, std::vector<int>> walls;
  for (const int k : used)
  {
    walls[find(k)].push_back(k);
  }
  std::vector<std::vector<int>> found;
  for (const auto& [root, points] : walls)
  {
    found.push_back(points);
  }
  std::sort(
    found.begin(), found.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return found;
}
}
#endif
