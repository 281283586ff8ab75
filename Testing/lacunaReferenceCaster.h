// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The ray caster of Carr 1996, 3.2, to measure against: rays go from cell to cell, cells without a
/// control point at the threshold are skipped, in the others eight samples of 64 taps are taken and
/// a transition is interpolated linearly.
#ifndef lacunaReferenceCaster_h
#define lacunaReferenceCaster_h

#include "lacunaVoxelVolume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace lacuna
{
/// Of a volume of Int16; parallel rays.
class ReferenceCaster
{
public:
  explicit ReferenceCaster(const VoxelVolume& volume)
    : Voxels(static_cast<const std::int16_t*>(volume.Voxels))
    , Size(volume.Size)
    , WorldToIndex(volume.IndexToWorld.Inverse())
  {
  }

  double Distance(const Vec3& origin, const Vec3& direction, double isoValue, Vec3& normal) const
  {
    const Vec3 a = this->WorldToIndex.Point(origin);
    const Vec3 b = this->WorldToIndex.Vector(direction);
    double t = -1e30;
    double last = 1e30;
    for (int i = 0; i < 3; ++i)
    {
      // the thesis keeps off the border, where support is missing
      const double u = (1 - a[i]) / b[i];
      const double v = (this->Size[i] - 2 - a[i]) / b[i];
      if (b[i] == 0 && (a[i] < 1 || a[i] > this->Size[i] - 2))
      {
        return std::numeric_limits<double>::quiet_NaN();
      }
      if (b[i] != 0)
      {
        t = std::max(t, std::min(u, v));
        last = std::min(last, std::max(u, v));
      }
    }
    double before = -1e30; // outside
    double beforeT = t;
    while (t < last)
    {
      const Vec3 at = a + (t + 1e-9) * b;
      int cell[3];
      double end = last;
      for (int i = 0; i < 3; ++i)
      {
        cell[i] = std::min(std::max(static_cast<int>(std::floor(at[i])), 1), this->Size[i] - 3);
        if (b[i] != 0)
        {
          const double leave = (cell[i] + (b[i] > 0) - a[i]) / b[i];
          end = leave > t + 1e-9 ? std::min(end, leave) : end;
        }
      }
      if (this->Reaches(cell, isoValue))
      {
        for (int sample = 0; sample < 8; ++sample)
        {
          const double s = t + (end - t) * (sample + 1) / 8;
          const double value = this->Value(cell, a + s * b, nullptr);
          if (value >= isoValue && before < isoValue)
          {
            const double hit =
              before < -1e29 ? s : beforeT + (s - beforeT) * (isoValue - before) / (value - before);
            this->Value(cell, a + hit * b, &normal);
            return hit;
          }
          before = value;
          beforeT = s;
        }
      }
      t = end;
    }
    return std::numeric_limits<double>::quiet_NaN();
  }

private:
  const std::int16_t* Corner(const int cell[3]) const
  {
    return this->Voxels + (cell[0] - 1) +
      static_cast<std::int64_t>(this->Size[0]) *
      ((cell[1] - 1) + static_cast<std::int64_t>(this->Size[1]) * (cell[2] - 1));
  }

  bool Reaches(const int cell[3], double isoValue) const
  {
    const std::int16_t* corner = this->Corner(cell);
    for (int k = 0; k < 4; ++k)
    {
      for (int j = 0; j < 4; ++j)
      {
        const std::int16_t* p =
          corner + static_cast<std::int64_t>(this->Size[0]) * (j + this->Size[1] * k);
        if (p[0] >= isoValue || p[1] >= isoValue || p[2] >= isoValue || p[3] >= isoValue)
        {
          return true;
        }
      }
    }
    return false;
  }

  static void Weights(double x, double w[4], double d[4])
  {
    const double y = 1 - x;
    w[0] = y * y * y / 6;
    w[1] = (3 * x * x * x - 6 * x * x + 4) / 6;
    w[3] = x * x * x / 6;
    w[2] = 1 - w[0] - w[1] - w[3];
    d[0] = -0.5 * y * y;
    d[1] = x * (1.5 * x - 2);
    d[2] = 0.5 + x * (1 - 1.5 * x);
    d[3] = 0.5 * x * x;
  }

  double Value(const int cell[3], const Vec3& at, Vec3* normal) const
  {
    double w[3][4];
    double d[3][4];
    for (int i = 0; i < 3; ++i)
    {
      Weights(at[i] - cell[i], w[i], d[i]);
    }
    const std::int16_t* corner = this->Corner(cell);
    double value = 0;
    Vec3 gradient{ 0, 0, 0 };
    for (int k = 0; k < 4; ++k)
    {
      for (int j = 0; j < 4; ++j)
      {
        const std::int16_t* p =
          corner + static_cast<std::int64_t>(this->Size[0]) * (j + this->Size[1] * k);
        const double row = p[0] * w[0][0] + p[1] * w[0][1] + p[2] * w[0][2] + p[3] * w[0][3];
        value += row * w[1][j] * w[2][k];
        if (normal)
        {
          const double slope = p[0] * d[0][0] + p[1] * d[0][1] + p[2] * d[0][2] + p[3] * d[0][3];
          gradient = gradient +
            Vec3{ slope * w[1][j] * w[2][k], row * d[1][j] * w[2][k], row * w[1][j] * d[2][k] };
        }
      }
    }
    if (normal)
    {
      *normal = Normalized(gradient);
    }
    return value;
  }

  const std::int16_t* Voxels;
  std::array<int, 3> Size;
  Matrix4 WorldToIndex;
};
}
#endif
