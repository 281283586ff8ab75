// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A volume as a scene.
#ifndef lacunaVolumeScene_h
#define lacunaVolumeScene_h

#include "lacunaMatrix4.h"
#include "lacunaPhantomScene.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace lacuna
{
/// Trilinear interpolation of a regular grid; 0 outside of the box of its voxel centres.
template <class T>
class VolumeScene : public PhantomScene
{
public:
  /// voxels: dimensions[0] x dimensions[1] x dimensions[2] values, x fastest, components apart from
  /// each other; not owned. referenceToVoxel: mm to fractional voxel numbers from 0.
  VolumeScene(const T* voxels, const std::array<int, 3>& dimensions, int components,
    const Matrix4& referenceToVoxel)
    : Voxels(voxels)
    , Dimensions(dimensions)
    , Stride{ components, static_cast<std::int64_t>(components) * dimensions[0],
      static_cast<std::int64_t>(components) * dimensions[0] * dimensions[1] }
    , ReferenceToVoxel(referenceToVoxel)
  {
  }

  void SampleRow(
    const Vec3& start, const Vec3& step, int first, int count, double* values) const override
  {
    const Vec3 voxelStart = this->ReferenceToVoxel.Point(start);
    const Vec3 voxelStep = this->ReferenceToVoxel.Vector(step);
    for (int j = 0; j < count; ++j)
    {
      values[j] = this->Interpolate(voxelStart + static_cast<double>(first + j) * voxelStep);
    }
  }

private:
  double Interpolate(const Vec3& p) const
  {
    const T* corner = this->Voxels;
    double weight[3];
    std::int64_t next[3];
    for (int i = 0; i < 3; ++i)
    {
      // A point on the last voxel centre may fall beyond it by rounding.
      constexpr double Tolerance = 1e-9;
      const double last = this->Dimensions[i] - 1;
      if (!(p[i] >= -Tolerance && p[i] <= last + Tolerance))
      {
        return 0;
      }
      const double x = p[i] < 0 ? 0 : (p[i] > last ? last : p[i]);
      const double base = std::floor(x) < last ? std::floor(x) : (last > 0 ? last - 1 : 0);
      corner += static_cast<std::int64_t>(base) * this->Stride[i];
      weight[i] = x - base;
      next[i] = last > 0 ? this->Stride[i] : 0;
    }
    double slab[2];
    for (int k = 0; k < 2; ++k)
    {
      const T* plane = corner + k * next[2];
      const double row0 = Lerp(plane[0], plane[next[0]], weight[0]);
      const double row1 = Lerp(plane[next[1]], plane[next[1] + next[0]], weight[0]);
      slab[k] = Lerp(row0, row1, weight[1]);
    }
    return Lerp(slab[0], slab[1], weight[2]);
  }

  static double Lerp(double a, double b, double w) { return a + w * (b - a); }

  const T* Voxels;
  std::array<int, 3> Dimensions;
  std::int64_t Stride[3];
  Matrix4 ReferenceToVoxel;
};
}
#endif
