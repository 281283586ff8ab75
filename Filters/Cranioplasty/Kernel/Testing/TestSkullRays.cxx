// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSkullRays.h"

#include "lacunaSkullTest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

using lacuna::Matrix4;
using lacuna::SkullRayKind;
using lacuna::Vec3;

namespace
{
struct Hole
{
  Vec3 Middle;
  double Radius; // radians
};

// The analytic skull without its base, in voxels that are longer along z, with holes.
struct Scan
{
  // diploe: half of how thick a layer without bone is in the middle of the bone, mm
  explicit Scan(const std::vector<Hole>& holes, const Matrix4& turn = {}, double highest = 100,
    double diploe = -10)
  {
    const double spacing[] = { 2, 2, 2.5 };
    const Vec3 first{ -104, -110, -60 };
    this->Size = { 105, 111, static_cast<int>((highest + 60) / 2.5) };
    this->IndexToOwn =
      Matrix4::Translation(first) * Matrix4::Scaling({ spacing[0], spacing[1], spacing[2] });
    this->OwnToWorld = turn;
    const lacunaSkullTest::Skull skull;
    for (int k = 0; k < this->Size[2]; ++k)
    {
      for (int j = 0; j < this->Size[1]; ++j)
      {
        for (int i = 0; i < this->Size[0]; ++i)
        {
          const Vec3 x = this->IndexToOwn.Point(
            { static_cast<double>(i), static_cast<double>(j), static_cast<double>(k) });
          const double r = Norm(x);
          const Vec3 d = lacuna::Normalized(x);
          double depth = -10; // mm within bone
          if (r > 50 && r < 110)
          {
            const double outer = skull.GetOuter(d);
            const double thickness = skull.GetThickness(d);
            depth = std::min(outer - r, r - outer + thickness);
            depth = std::min(depth, std::abs(r - outer + 0.5 * thickness) - diploe);
          }
          for (const Hole& hole : holes)
          {
            depth = std::min(depth,
              r *
                (std::acos(std::clamp(Dot(d, lacuna::Normalized(hole.Middle)), -1.0, 1.0)) -
                  hole.Radius));
          }
          depth = std::min(depth, x[2] + 40);
          this->Voxels.push_back(static_cast<float>(300 + 200 * std::clamp(depth, -3.0, 3.0)));
        }
      }
    }
  }
  lacuna::VoxelVolume Get() const
  {
    lacuna::VoxelVolume volume;
    volume.Voxels = this->Voxels.data();
    volume.Type = lacuna::ScalarType::Float32;
    volume.Size = this->Size;
    volume.IndexToWorld = this->OwnToWorld * this->IndexToOwn;
    return volume;
  }

  std::array<int, 3> Size{};
  Matrix4 IndexToOwn;
  Matrix4 OwnToWorld;
  std::vector<float> Voxels;
};
}

TEST(SkullRays, FindsBothTablesAndTheDefects)
{
  const Scan scan({ { { 0.8, -0.2, 0.55 }, 0.5 }, { { -0.6, 0.5, 0.6 }, 0.25 } });
  const lacunaSkullTest::Skull skull;
  lacuna::ThreadExecution execution(2);
  const lacuna::SkullRays rays = lacuna::TraceSkull(scan.Get(), 300, { 0, 0, 0 }, 3, execution);
  int sound = 0;
  double squares[] = { 0, 0 };
  for (std::size_t i = 0; i < rays.Directions.size(); ++i)
  {
    const Vec3& d = rays.Directions[i];
    if (rays.Kinds[i] == SkullRayKind::Sound)
    {
      ++sound;
      const double outer = rays.Outer[i] - skull.GetOuter(d);
      const double thickness = rays.Outer[i] - rays.Inner[i] - skull.GetThickness(d);
      EXPECT_LT(std::abs(outer), 0.5); // of voxels of 2 x 2 x 2.5 mm
      EXPECT_LT(std::abs(thickness), 0.5);
      squares[0] += outer * outer;
      squares[1] += thickness * thickness;
    }
    EXPECT_EQ(std::isnan(rays.Outer[i]),
      rays.Kinds[i] == SkullRayKind::Open || rays.Kinds[i] == SkullRayKind::Unknown);
  }
  EXPECT_LT(std::sqrt(squares[0] / sound), 0.05);
  EXPECT_LT(std::sqrt(squares[1] / sound), 0.08);
  // 0.71 of the sphere is above -40 mm; the holes, and 4 mm beside every edge, are no sound bone
  EXPECT_GT(sound, 0.5 * rays.Directions.size());
  EXPECT_EQ(lacuna::GetSoundBone(rays).Outer.size(), static_cast<std::size_t>(sound));

  const std::vector<std::vector<int>> defects = lacuna::FindDefects(rays);
  ASSERT_EQ(defects.size(), 2u); // not the missing base
  const double part[] = { (1 - std::cos(0.5)) / 2, (1 - std::cos(0.25)) / 2 };
  for (int i = 0; i < 2; ++i)
  {
    EXPECT_NEAR(
      static_cast<double>(defects[i].size()) / rays.Directions.size(), part[i], 0.1 * part[i]);
  }
  for (const int i : defects[0])
  {
    EXPECT_GT(Dot(rays.Directions[i], lacuna::Normalized({ 0.8, -0.2, 0.55 })), std::cos(0.55));
  }
}

TEST(SkullRays, AreTheSameInATurnedVolume)
{
  const std::vector<Hole> holes{ { { 0.8, -0.2, 0.55 }, 0.5 } };
  const Matrix4 turn =
    Matrix4::Translation({ 30, 500, -70 }) * Matrix4::Rotation({ 1, -1, 0.4 }, 1.3);
  const Scan straight(holes);
  const Scan turned(holes, turn);
  lacuna::ThreadExecution one(1);
  lacuna::ThreadExecution two(2);
  const Vec3 center{ 0, 3, 2 };
  const lacuna::SkullRays a = lacuna::TraceSkull(straight.Get(), 300, center, 4, one);
  const lacuna::SkullRays b = lacuna::TraceSkull(turned.Get(), 300, turn.Point(center), 4, two);
  ASSERT_EQ(a.Kinds, b.Kinds);
  for (std::size_t i = 0; i < a.Outer.size(); ++i)
  {
    EXPECT_LT(Norm(turn.Vector(a.Directions[i]) - b.Directions[i]), 1e-9);
    if (!std::isnan(a.Outer[i]))
    {
      EXPECT_NEAR(a.Outer[i], b.Outer[i], 1e-6);
      EXPECT_NEAR(a.Inner[i], b.Inner[i], 1e-6);
    }
  }
}

TEST(SkullRays, CountDiploeAsBone)
{
  const Scan scan({}, {}, 100, 0.6);
  const lacuna::VoxelVolume volume = scan.Get();
  const lacunaSkullTest::Skull skull;
  lacuna::ThreadExecution execution(2);
  const lacuna::SkullRays rays = lacuna::TraceSkull(volume, 300, { 0, 0, 0 }, 3, execution);
  int sound = 0;
  int split = 0;
  double square = 0;
  for (std::size_t i = 0; i < rays.Directions.size(); ++i)
  {
    if (rays.Kinds[i] == SkullRayKind::Sound)
    {
      const Vec3& d = rays.Directions[i];
      const double thickness = skull.GetThickness(d);
      square += std::pow(rays.Outer[i] - rays.Inner[i] - thickness, 2);
      const double middle = skull.GetOuter(d) - 0.5 * thickness;
      const std::vector<double> value =
        lacuna::FindLargestAlong(volume, { 0, 0, 0 }, { { d, middle, middle } }, execution);
      split += value[0] < 300;
      ++sound;
    }
  }
  EXPECT_GT(sound, 1000);
  EXPECT_GT(split, 0.2 * sound);
  // voxels of 2 x 2 x 2.5 mm lose a table of 2 mm here and there
  EXPECT_LT(std::sqrt(square / sound), 1);
}

TEST(SkullRays, AreNoSoundBoneWhereVoxelsRoundItOff)
{
  const Scan scan({ { { 0.8, -0.2, 0.55 }, 0.5 } });
  lacuna::ThreadExecution execution(2);
  lacuna::SkullRays rays = lacuna::TraceSkull(scan.Get(), 300, { 0, 0, 0 }, 3, execution);
  EXPECT_NEAR(rays.RoundedEdge, 1.5 * 2.5, 1e-9);
  rays.RoundedEdge = 9;
  const lacuna::SoundBone bone = lacuna::GetSoundBone(rays);
  std::size_t next = 0;
  std::size_t left = 0;
  for (std::size_t i = 0; i < rays.Directions.size(); ++i)
  {
    if (rays.Kinds[i] != SkullRayKind::Sound)
    {
      continue;
    }
    double nearest = 10; // radians
    for (std::size_t j = 0; j < rays.Directions.size(); ++j)
    {
      if (rays.Kinds[j] == SkullRayKind::Open)
      {
        nearest = std::min(
          nearest, std::acos(std::clamp(Dot(rays.Directions[i], rays.Directions[j]), -1.0, 1.0)));
      }
    }
    if (nearest * rays.Outer[i] > 9)
    {
      ASSERT_LT(next, bone.Outer.size());
      EXPECT_EQ(bone.Outer[next++], rays.Outer[i]);
    }
    else
    {
      ++left;
    }
  }
  EXPECT_EQ(next, bone.Outer.size());
  EXPECT_GT(left, 30u);
}

TEST(SkullRays, DoNotGuessBeyondTheScan)
{
  // a scan that ends below the crown
  const Scan scan({ { { 0.9, 0, 0.2 }, 0.3 } }, {}, 60);
  lacuna::ThreadExecution execution(2);
  const lacuna::SkullRays rays = lacuna::TraceSkull(scan.Get(), 300, { 0, 0, 0 }, 3, execution);
  for (std::size_t i = 0; i < rays.Kinds.size(); ++i)
  {
    if (rays.Directions[i][2] > 0.85)
    {
      EXPECT_EQ(rays.Kinds[i], SkullRayKind::Unknown);
    }
  }
  const std::vector<std::vector<int>> defects = lacuna::FindDefects(rays);
  ASSERT_EQ(defects.size(), 1u);
  EXPECT_GT(Dot(rays.Directions[defects[0][0]], { 1, 0, 0 }), 0.8);
}

TEST(SkullRays, SeeAHoleAtTheCrownThoughTheScanEndsThere)
{
  // the scan ends at 82 mm, the crown is at about 80
  const Scan scan({ { { 0, 0, 1 }, 0.5 } }, {}, 82);
  lacuna::ThreadExecution execution(2);
  const lacuna::SkullRays rays = lacuna::TraceSkull(scan.Get(), 300, { 0, 0, 0 }, 3, execution);
  const std::vector<std::vector<int>> defects = lacuna::FindDefects(rays);
  ASSERT_EQ(defects.size(), 1u);
  const double part = (1 - std::cos(0.5)) / 2;
  EXPECT_NEAR(static_cast<double>(defects[0].size()) / rays.Directions.size(), part, 0.1 * part);
}

TEST(SkullRays, KnowWhatACurveEncloses)
{
  const Scan scan({});
  lacuna::ThreadExecution execution(2);
  const lacuna::SkullRays rays = lacuna::TraceSkull(scan.Get(), 300, { 0, 0, 0 }, 3, execution);
  // a circle of 1.2 radians about a direction, drawn with dense points on one half, at several heights
  const Vec3 axis = lacuna::Normalized({ 0.7, -0.4, 0.6 });
  const Vec3 u = lacuna::Normalized(Cross(axis, { 0, 0, 1 }));
  const Vec3 v = Cross(axis, u);
  std::vector<Vec3> curve;
  for (int k = 0; k < 300; ++k)
  {
    const double turn = lacunaSkullTest::Pi * (k < 200 ? k / 200.0 : 1 + (k - 200) / 100.0);
    curve.push_back((60.0 + k % 40) *
      (std::cos(1.2) * axis + (std::sin(1.2) * std::cos(turn)) * u +
        (std::sin(1.2) * std::sin(turn)) * v));
  }
  const std::vector<int> within = lacuna::FindRaysWithin(rays, curve);
  std::vector<bool> isWithin(rays.Directions.size(), false);
  for (const int i : within)
  {
    isWithin[i] = true;
  }
  for (std::size_t i = 0; i < isWithin.size(); ++i)
  {
    const double angle = std::acos(std::clamp(Dot(rays.Directions[i], axis), -1.0, 1.0));
    if (std::abs(angle - 1.2) > 0.01)
    {
      EXPECT_EQ(isWithin[i], angle < 1.2);
    }
  }
  EXPECT_THROW(lacuna::FindRaysWithin(rays, { axis, u }), std::invalid_argument);
  std::vector<Vec3> eight = curve;
  std::swap(eight[3], eight[eight.size() / 2]);
  EXPECT_THROW(lacuna::FindRaysWithin(rays, eight), std::invalid_argument);
}

TEST(SkullRays, CenterIsAmidTheVault)
{
  const Matrix4 turn =
    Matrix4::Translation({ 30, 500, -70 }) * Matrix4::Rotation({ 1, -1, 0.4 }, 1.3);
  const Scan scan({ { { 0.8, -0.2, 0.55 }, 0.5 } }, turn);
  lacuna::ThreadExecution execution(2);
  lacuna::MirrorPlane plane;
  plane.Normal = turn.Vector({ 1, 0, 0 });
  plane.Offset = Dot(plane.Normal, turn.Column(3));
  const Vec3 center = lacuna::FindSkullCenter(scan.Get(), 300, plane, execution);
  EXPECT_LT(std::abs(plane.Distance(center)), 1e-9);
  EXPECT_LT(Norm(center - turn.Point({ 0, 0, 0 })), 12);
}

TEST(SkullRays, RefusesWhatIsNoSkull)
{
  lacuna::ThreadExecution execution(1);
  const Scan scan({});
  const lacuna::VoxelVolume volume = scan.Get();
  const auto trace = [&](double level, const Vec3& center, double spacing)
  { lacuna::TraceSkull(volume, level, center, spacing, execution); };
  EXPECT_THROW(trace(300, { 500, 0, 0 }, 4), std::invalid_argument);
  EXPECT_THROW(trace(300, { std::nan(""), 0, 0 }, 4), std::invalid_argument);
  EXPECT_THROW(trace(std::nan(""), { 0, 0, 0 }, 4), std::invalid_argument);
  EXPECT_THROW(trace(300, { 0, 0, 0 }, 0), std::invalid_argument);
  EXPECT_THROW(trace(5000, { 0, 0, 0 }, 4), std::invalid_argument);
  EXPECT_THROW(trace(-5000, { 0, 0, 0 }, 4), std::invalid_argument);
  EXPECT_THROW(lacuna::FindSkullCenter(volume, 5000, {}, execution), std::invalid_argument);
  lacuna::VoxelVolume flat = volume;
  flat.Size[2] = 1;
  EXPECT_THROW(lacuna::TraceSkull(flat, 300, { 0, 0, 0 }, 4, execution), std::invalid_argument);
}
