// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Closed meshes of known volume.
#ifndef lacunaMeshShapes_h
#define lacunaMeshShapes_h

#include "lacunaClosedMesh.h"

#include <cmath>
#include <map>
#include <utility>

namespace lacunaMeshShapes
{
using lacuna::ClosedMesh;
using lacuna::Vec3;

/// turned: inside out, as a cavity.
inline void Append(ClosedMesh& mesh, const ClosedMesh& other, bool turned = false)
{
  const auto first = static_cast<std::int32_t>(mesh.Points.size());
  mesh.Points.insert(mesh.Points.end(), other.Points.begin(), other.Points.end());
  for (ClosedMesh::Triangle ids : other.Triangles)
  {
    if (turned)
    {
      std::swap(ids[1], ids[2]);
    }
    mesh.Triangles.push_back({ ids[0] + first, ids[1] + first, ids[2] + first });
  }
}

/// n rows of triangles from pole to pole, 2 n columns.
inline ClosedMesh Sphere(const Vec3& center, double radius, int n)
{
  constexpr double Pi = 3.14159265358979323846;
  ClosedMesh mesh;
  mesh.Points.push_back(center + Vec3{ 0, 0, radius });
  for (int i = 1; i < n; ++i)
  {
    for (int j = 0; j < 2 * n; ++j)
    {
      const double t = Pi * i / n;
      const double p = Pi * j / n;
      mesh.Points.push_back(center +
        radius * Vec3{ std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t) });
    }
  }
  mesh.Points.push_back(center - Vec3{ 0, 0, radius });
  const auto last = static_cast<std::int32_t>(mesh.Points.size()) - 1;
  const auto id = [&](int i, int j) { return 1 + (i - 1) * 2 * n + j % (2 * n); };
  for (int j = 0; j < 2 * n; ++j)
  {
    mesh.Triangles.push_back({ 0, id(1, j), id(1, j + 1) });
    mesh.Triangles.push_back({ last, id(n - 1, j + 1), id(n - 1, j) });
    for (int i = 1; i < n - 1; ++i)
    {
      mesh.Triangles.push_back({ id(i, j), id(i + 1, j), id(i + 1, j + 1) });
      mesh.Triangles.push_back({ id(i, j), id(i + 1, j + 1), id(i, j + 1) });
    }
  }
  return mesh;
}

/// What is filled of cells of a lattice, each face two triangles. filled(i, j, k) is false outside of size.
template <class Filled>
ClosedMesh Cells(
  const std::array<int, 3>& size, const Vec3& low, const Vec3& spacing, Filled filled)
{
  ClosedMesh mesh;
  std::map<std::array<int, 3>, std::int32_t> numbers;
  const auto point = [&](std::array<int, 3> at)
  {
    const auto [found, added] = numbers.emplace(at, static_cast<std::int32_t>(mesh.Points.size()));
    if (added)
    {
      mesh.Points.push_back(
        { low[0] + spacing[0] * at[0], low[1] + spacing[1] * at[1], low[2] + spacing[2] * at[2] });
    }
    return found->second;
  };
  std::array<int, 3> at{};
  for (at[2] = 0; at[2] < size[2]; ++at[2])
  {
    for (at[1] = 0; at[1] < size[1]; ++at[1])
    {
      for (at[0] = 0; at[0] < size[0]; ++at[0])
      {
        for (int axis = 0; axis < 3 && filled(at); ++axis)
        {
          for (const int side : { -1, 1 })
          {
            std::array<int, 3> next = at;
            next[axis] += side;
            if (filled(next))
            {
              continue;
            }
            const int u = (axis + 1) % 3;
            const int v = (axis + 2) % 3;
            std::array<int, 3> corners[4] = { at, at, at, at };
            for (auto& corner : corners)
            {
              corner[axis] += side > 0 ? 1 : 0;
            }
            ++corners[1][u];
            ++corners[2][u];
            ++corners[2][v];
            ++corners[3][v];
            std::int32_t ids[4];
            for (int k = 0; k < 4; ++k)
            {
              ids[k] = point(corners[side > 0 ? k : 3 - k]);
            }
            mesh.Triangles.push_back({ ids[0], ids[1], ids[2] });
            mesh.Triangles.push_back({ ids[0], ids[2], ids[3] });
          }
        }
      }
    }
  }
  return mesh;
}

inline ClosedMesh Box(const Vec3& low, const Vec3& high)
{
  return Cells({ 1, 1, 1 }, low, high - low,
    [](const std::array<int, 3>& at) {
      return at == std::array<int, 3>{ 0, 0, 0 };
    });
}

/// 20 x 30 x 40 mm from -5 7 11 on, with a square hole of 4 x 6 mm along z that is off its middle: no mirror
/// image is the same. n: cells in 4 x 6 x 40 mm along each axis.
constexpr double BoxWithHoleVolume = 20 * 30 * 40 - 4 * 6 * 40;
inline ClosedMesh BoxWithHole(int n)
{
  return Cells({ 5 * n, 5 * n, n }, { -5, 7, 11 }, { 4.0 / n, 6.0 / n, 40.0 / n },
    [n](const std::array<int, 3>& at)
    {
      const bool inside =
        at[0] >= 0 && at[1] >= 0 && at[2] >= 0 && at[0] < 5 * n && at[1] < 5 * n && at[2] < n;
      return inside && !(at[0] / n == 1 && at[1] / n == 3);
    });
}
}
#endif
