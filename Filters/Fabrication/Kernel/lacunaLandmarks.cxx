// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaLandmarks.h"

#include <algorithm>
#include <cmath>

namespace lacuna
{
namespace
{
constexpr double Degrees = 180 / 3.14159265358979323846;
constexpr double LeastHeight = 0.001; // mm

// The point with the largest measure.
template <class Measure>
std::size_t FindLargest(const std::vector<Vec3>& points, const Measure& measure)
{
  std::size_t largest = 0;
  double value = -1;
  for (std::size_t k = 0; k < points.size(); ++k)
  {
    if (const double here = measure(points[k]); here > value)
    {
      value = here;
      largest = k;
    }
  }
  return largest;
}

Matrix4 Edges(const std::array<Vec3, 4>& p)
{
  return Matrix4::FromColumns(p[1] - p[0], p[2] - p[0], p[3] - p[0], { 0, 0, 0 });
}
}

//------------------------------------------------------------------------------
bool FindLandmarks(const std::vector<Vec3>& points, std::array<std::size_t, 4>& indices)
{
  if (points.empty())
  {
    return false;
  }
  const Vec3& first = points[0];
  indices[0] = 0;
  indices[1] = FindLargest(points, [&](const Vec3& p) { return Norm(p - first); });
  const Vec3 edge = points[indices[1]] - first;
  indices[2] = FindLargest(points, [&](const Vec3& p) { return Norm(Cross(edge, p - first)); });
  const Vec3 across = Cross(edge, points[indices[2]] - first);
  const auto height = [&](const Vec3& p) { return std::abs(Dot(across, p - first)); };
  indices[3] = FindLargest(points, height);
  return height(points[indices[3]]) > LeastHeight * Norm(across);
}

//------------------------------------------------------------------------------
LandmarkMove CompareLandmarks(const std::array<Vec3, 4>& before, const std::array<Vec3, 4>& after)
{
  LandmarkMove move;
  for (std::size_t a = 0; a < 4; ++a)
  {
    move.Way = std::max(move.Way, Norm(after[a] - before[a]));
    move.Rise += (after[a][2] - before[a][2]) / 4;
    for (std::size_t b = 0; b < a; ++b)
    {
      move.Stretch =
        std::max(move.Stretch, std::abs(Norm(after[a] - after[b]) - Norm(before[a] - before[b])));
    }
  }
  const Matrix4 map = MapLandmarks(before, after);
  move.Mirrored = map.Determinant3() < 0;
  const Vec3 up = map.Column(2);
  move.Tilt = Degrees * std::atan2(std::hypot(up[0], up[1]), up[2]);
  return move;
}

//------------------------------------------------------------------------------
Matrix4 MapLandmarks(const std::array<Vec3, 4>& before, const std::array<Vec3, 4>& after)
{
  return Matrix4::Translation(after[0]) * Edges(after) * Edges(before).Inverse() *
    Matrix4::Translation(-1.0 * before[0]);
}
}
