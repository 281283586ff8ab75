// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A volume whose field is evaluated straight from the definition: the oracle of the kernel tests.
#ifndef lacunaTestField_h
#define lacunaTestField_h

#include "lacunaIsoRayCaster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace lacuna
{
struct TestField
{
  std::array<int, 3> Size;
  Matrix4 IndexToWorld;
  std::vector<double> Voxels;

  TestField(const std::array<int, 3>& size, const Matrix4& indexToWorld,
    const std::function<double(const Vec3&)>& valueAtWorld)
    : Size(size)
    , IndexToWorld(indexToWorld)
  {
    for (int k = 0; k < size[2]; ++k)
    {
      for (int j = 0; j < size[1]; ++j)
      {
        for (int i = 0; i < size[0]; ++i)
        {
          this->Voxels.push_back(valueAtWorld(indexToWorld.Point({ 1.0 * i, 1.0 * j, 1.0 * k })));
        }
      }
    }
  }

  VoxelVolume View() const
  {
    VoxelVolume volume;
    volume.Voxels = this->Voxels.data();
    volume.Type = ScalarType::Float64;
    volume.Size = this->Size;
    volume.IndexToWorld = this->IndexToWorld;
    return volume;
  }

  /// Control point, continued linearly beyond the border along one axis after the other.
  double Control(int i, int j, int k) const
  {
    const int index[3] = { i, j, k };
    for (int a = 0; a < 3; ++a)
    {
      const int n = this->Size[a];
      if (index[a] < 0 || index[a] >= n)
      {
        int near[3] = { i, j, k };
        int far[3] = { i, j, k };
        near[a] = index[a] < 0 ? 0 : n - 1;
        far[a] = index[a] < 0 ? 1 : n - 2;
        return 2 * this->Control(near[0], near[1], near[2]) - this->Control(far[0], far[1], far[2]);
      }
    }
    return this->Voxels[i + static_cast<std::size_t>(this->Size[0]) * (j + this->Size[1] * k)];
  }

  /// Carr 1996, eq. 3.13 to 3.15 along each axis.
  static std::array<double, 4> CubicWeights(double x)
  {
    return { (-x * x * x + 3 * x * x - 3 * x + 1) / 6, (3 * x * x * x - 6 * x * x + 4) / 6,
      (-3 * x * x * x + 3 * x * x + 3 * x + 1) / 6, x * x * x / 6 };
  }

  double BSpline(const Vec3& index) const
  {
    return this->Sum(index, -1, [](double x) { return CubicWeights(x); });
  }

  double Trilinear(const Vec3& index) const
  {
    return this->Sum(index, 0, [](double x) { return std::array<double, 4>{ 1 - x, x, 0, 0 }; });
  }

private:
  template <class F>
  double Sum(const Vec3& index, int first, const F& weights) const
  {
    int cell[3];
    std::array<double, 4> w[3];
    for (int a = 0; a < 3; ++a)
    {
      cell[a] = std::min(std::max(static_cast<int>(std::floor(index[a])), 0), this->Size[a] - 2);
      w[a] = weights(index[a] - cell[a]);
    }
    double sum = 0;
    for (int k = 0; k < 4; ++k)
    {
      for (int j = 0; j < 4; ++j)
      {
        for (int i = 0; i < 4; ++i)
        {
          const double weight = w[0][i] * w[1][j] * w[2][k];
          if (weight != 0)
          {
            sum +=
              weight * this->Control(cell[0] + first + i, cell[1] + first + j, cell[2] + first + k);
          }
        }
      }
    }
    return sum;
  }
};

inline Vec3 RandomUnit(std::mt19937& random)
{
  std::normal_distribution<double> normal;
  return Normalized({ normal(random), normal(random), normal(random) });
}

inline Matrix4 RandomFrame(std::mt19937& random, const Vec3& spacing, bool mirrored)
{
  std::uniform_real_distribution<double> uniform(-50, 50);
  const Vec3 offset{ uniform(random), uniform(random), uniform(random) };
  return Matrix4::Translation(offset) * Matrix4::Rotation(RandomUnit(random), uniform(random)) *
    Matrix4::Scaling({ mirrored ? -spacing[0] : spacing[0], spacing[1], spacing[2] });
}
}
#endif
