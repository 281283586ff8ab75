// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A head that is symmetric but for what is done to it, in any pose.
#ifndef lacunaMirrorTest_h
#define lacunaMirrorTest_h

#include "lacunaExecution.h"
#include "lacunaVolumeSymmetry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace lacunaMirrorTest
{
using lacuna::Matrix4;
using lacuna::Vec3;

inline Matrix4 Small(std::mt19937& random, double angle)
{
  std::uniform_real_distribution<double> u(-1, 1);
  return Matrix4::Rotation({ u(random), u(random), u(random) + 2 }, angle * u(random)) *
    Matrix4::Rotation({ u(random) + 2, u(random), u(random) }, angle * u(random));
}

/// Of the head in the middle of the volume. Its own x axis is perpendicular to its plane.
struct Pose
{
  explicit Pose(std::mt19937& random)
    : Axes(Small(random, 3))
  {
    std::uniform_real_distribution<double> u(-4, 4);
    this->Shift = { u(random), u(random), u(random) };
    this->Origin = { 50 * u(random), 50 * u(random), 50 * u(random) };
    this->Direction = Small(random, 2);
  }
  Matrix4 Axes;          ///< of the head in the grid
  Vec3 Shift{ 0, 0, 0 }; ///< of the head from the middle of the grid
  Vec3 Origin{ 0, 0, 0 };
  Matrix4 Direction; ///< of the grid in the world
  /// Set by Scene: the head's plane and middle, world.
  lacuna::MirrorPlane Plane;
  Vec3 Middle{ 0, 0, 0 };
};

/// 1 above 0, smoothly from 0 below.
inline double Step(double x)
{
  return 1 / (1 + std::exp(-4 * x));
}

struct Grid
{
  std::array<int, 3> Size;
  Vec3 Spacing;

  lacuna::VoxelVolume Of(const void* voxels, lacuna::ScalarType type) const
  {
    lacuna::VoxelVolume volume;
    volume.Voxels = voxels;
    volume.Type = type;
    volume.Size = this->Size;
    volume.IndexToWorld = Matrix4::Scaling(this->Spacing);
    return volume;
  }
};

enum class Defect
{
  None,
  Hole,  ///< of 30 mm radius in the skull of one side, 20 mm deep
  CutOff ///< the head is moved out of the volume by a quarter of its width
};

/// Hounsfield units of a head: skin, skull, brain, ventricles, eyes, nose and ears; symmetric in x,
/// and in nothing else.
inline double HeadAt(const Vec3& p, bool hole)
{
  const double x = std::abs(p[0]);
  const double y = p[1];
  const double z = p[2];
  const auto ball = [&](double cx, double cy, double cz, double rx, double ry, double rz)
  {
    const double r = std::hypot((x - cx) / rx, (y - cy) / ry, (z - cz) / rz);
    return Step((1 - r) * std::min({ rx, ry, rz }));
  };
  double value = -1000;
  const auto put = [&](double part, double grey) { value += part * (grey - value); };
  put(ball(0, 0, 0, 62, 75, 60), 40);
  put(ball(64, 5, -8, 5, 9, 13), 40);
  put(ball(0, -77, -20, 8, 12, 10), 40);
  put(ball(0, 0, 0, 56, 69, 54), 1000);
  put(ball(0, 2, 0, 50, 62, 48), 35);
  put(ball(10, 5, 5, 5, 20, 8), 0);
  put(ball(24, -60, -18, 13, 12, 12), 20);
  if (hole && p[0] > 0)
  {
    const double r = std::hypot(y - 5, z - 15);
    const double outside = Step(std::hypot(p[0] / 50, (y - 2) / 62, z / 48) * 48 - 48);
    const double inside = Step((1.0 - std::hypot(p[0] / 56, y / 69, z / 54)) * 54);
    value += Step(30 - r) * outside * inside * (40 - value);
  }
  return value;
}

class Scene
{
public:
  Scene(const Grid& grid, Pose& pose, Defect defect, double noise, int seed)
    : Voxels(static_cast<std::size_t>(grid.Size[0]) * grid.Size[1] * grid.Size[2])
  {
    Vec3 middle{ 0, 0, 0 };
    for (int a = 0; a < 3; ++a)
    {
      middle[a] = (grid.Size[a] - 1) / 2.0 * grid.Spacing[a] + pose.Shift[a];
    }
    if (defect == Defect::CutOff)
    {
      middle[0] -= 30;
    }
    const Matrix4 toHead = (Matrix4::Translation(middle) * pose.Axes).Inverse();
    lacuna::ThreadExecution execution;
    execution.For(grid.Size[2], 1,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (auto k = static_cast<int>(begin); k < end; ++k)
        {
          std::mt19937 random(1000 * seed + k);
          std::normal_distribution<double> normal(0, 1);
          for (int j = 0; j < grid.Size[1]; ++j)
          {
            for (int i = 0; i < grid.Size[0]; ++i)
            {
              const Vec3 p =
                toHead.Point({ i * grid.Spacing[0], j * grid.Spacing[1], k * grid.Spacing[2] });
              const double v = HeadAt(p, defect == Defect::Hole) + noise * normal(random);
              this->Voxels[i + static_cast<std::size_t>(grid.Size[0]) * (j + grid.Size[1] * k)] =
                static_cast<std::int16_t>(std::lround(v));
            }
          }
        }
      });
    this->Volume = grid.Of(this->Voxels.data(), lacuna::ScalarType::Int16);
    const Matrix4 toWorld = Matrix4::Translation(pose.Origin) * pose.Direction;
    this->Volume.IndexToWorld = toWorld * Matrix4::Scaling(grid.Spacing);
    pose.Middle = toWorld.Point(middle);
    pose.Plane.Normal = Normalized(toWorld.Vector(pose.Axes.Column(0)));
    pose.Plane.Offset = Dot(pose.Plane.Normal, pose.Middle);
  }
  lacuna::MaskedVolume Masked() const { return { this->Volume, {} }; }

  std::vector<std::int16_t> Voxels;
  lacuna::VoxelVolume Volume;
};

struct PlaneError
{
  double Degrees;
  double Distance; ///< mm, in the middle of the head
};

inline PlaneError Compare(const lacuna::MirrorPlane& found, const Pose& pose)
{
  const Vec3& n = pose.Plane.Normal;
  const Vec3 cross = Cross(found.Normal, n);
  return { std::asin(std::min(1.0, Norm(cross))) * 180 / 3.14159265358979323846,
    std::abs(found.Distance(pose.Middle)) };
}
}
#endif
