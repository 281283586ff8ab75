// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Curved plates with holes through them, of known shape. No mirror image of one is the same.
#ifndef TestShells_h
#define TestShells_h

#include "lacunaExecution.h"
#include "lacunaMatrix4.h"
#include "lacunaPlanarCurves.h"
#include "lacunaPlanarLattice.h"
#include "lacunaPlanarTriangulation.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"

#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkUnsignedCharArray.h"

#include <cmath>
#include <functional>
#include <vector>

namespace TestShells
{
using lacuna::Vec2;
using lacuna::Vec3;

constexpr double Pi = 3.14159265358979323846;
constexpr double Axes[3] = { 75, 85, 65 }; // of an ellipsoid, mm
constexpr int Levels = 6;                  // of the walls

// What the outer face is: the ellipsoid over x, y.
inline Vec3 OuterPoint(const Vec2& p)
{
  const double x = p[0] / Axes[0];
  const double y = p[1] / Axes[1];
  return { p[0], p[1], Axes[2] * std::sqrt(1 - x * x - y * y) };
}

inline Vec3 OuterNormal(const Vec2& p)
{
  const Vec3 q = OuterPoint(p);
  return lacuna::Normalized(
    { q[0] / (Axes[0] * Axes[0]), q[1] / (Axes[1] * Axes[1]), q[2] / (Axes[2] * Axes[2]) });
}

struct Shell
{
  double Size = 1;      // of the outline
  double Thickness = 4; // mm
  double Edge = 1;      // mm, of triangles
  bool HasHoles = true;
  lacuna::Matrix4 ToWorld;
  std::function<double(const Vec2&)> Roughness; // mm, added to the inner face
};

inline std::vector<lacuna::Loop> Outlines(const Shell& shell)
{
  std::vector<lacuna::Loop> loops;
  const auto add = [&](
                     double x, double y, bool forward, const std::function<double(double)>& radius)
  {
    lacuna::Loop loop;
    const int count = static_cast<int>(2 * Pi * radius(0.7) / (0.5 * shell.Edge));
    for (int k = 0; k < count; ++k)
    {
      const double angle = 2 * Pi * (forward ? k : -k) / count;
      loop.push_back({ x + radius(angle) * std::cos(angle), y + radius(angle) * std::sin(angle) });
    }
    loops.push_back(loop);
  };
  add(0, 0, true,
    [&](double a) {
      return shell.Size * (28 + 5 * std::cos(a) + 4 * std::sin(2 * a) + 3 * std::cos(3 * a - 0.5));
    });
  if (shell.HasHoles)
  {
    add(9, -5, false, [](double) { return 2.0; });
    add(-10, 8, false, [](double) { return 3.0; });
  }
  return loops;
}

// Faces as of Skull Implant. Walls run along the normals.
inline vtkSmartPointer<vtkPolyData> Make(const Shell& shell, const char* faceName = "ImplantFace")
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkUnsignedCharArray> faces;
  faces->SetName(faceName);
  const auto addPoint = [&](const Vec2& p, double depth)
  {
    const double rough = shell.Roughness && depth == 1 ? shell.Roughness(p) : 0;
    const Vec3 q = OuterPoint(p) - (depth * shell.Thickness + rough) * OuterNormal(p);
    return points->InsertNextPoint(shell.ToWorld.Point(q).data());
  };
  const auto addTriangle = [&](vtkIdType a, vtkIdType b, vtkIdType c, unsigned char face)
  {
    cells->InsertNextCell({ a, b, c });
    faces->InsertNextValue(face);
  };
  const std::vector<lacuna::Loop> loops = Outlines(shell);
  std::vector<std::vector<std::vector<vtkIdType>>> rings; // level, loop
  for (int level = 0; level <= Levels; ++level)
  {
    rings.emplace_back();
    for (const lacuna::Loop& loop : loops)
    {
      rings.back().emplace_back();
      for (const Vec2& p : loop)
      {
        rings.back().back().push_back(addPoint(p, static_cast<double>(level) / Levels));
      }
    }
  }
  lacuna::ThreadExecution execution(1);
  for (const int level : { 0, Levels })
  {
    lacuna::Loop feet;
    std::vector<vtkIdType> ids;
    std::vector<std::vector<std::int32_t>> edges;
    for (std::size_t l = 0; l < loops.size(); ++l)
    {
      edges.emplace_back();
      for (std::size_t k = 0; k < loops[l].size(); ++k)
      {
        edges.back().push_back(static_cast<std::int32_t>(feet.size()));
        feet.push_back(loops[l][k]);
        ids.push_back(rings[level][l][k]);
      }
    }
    for (const Vec2& p : lacuna::FillWithLattice(execution, loops, shell.Edge, 0.6 * shell.Edge))
    {
      feet.push_back(p);
      ids.push_back(addPoint(p, level == 0 ? 0 : 1));
    }
    for (const lacuna::Triangle& t : lacuna::TriangulateRegion(feet, edges))
    {
      addTriangle(
        ids[t[0]], ids[t[level == 0 ? 1 : 2]], ids[t[level == 0 ? 2 : 1]], level == 0 ? 0 : 1);
    }
  }
  for (int level = 0; level < Levels; ++level)
  {
    for (std::size_t l = 0; l < loops.size(); ++l)
    {
      const std::vector<vtkIdType>& upper = rings[level][l];
      const std::vector<vtkIdType>& lower = rings[level + 1][l];
      for (std::size_t k = 0; k < upper.size(); ++k)
      {
        const std::size_t next = (k + 1) % upper.size();
        addTriangle(upper[k], lower[k], lower[next], 2);
        addTriangle(upper[k], lower[next], upper[next], 2);
      }
    }
  }
  auto mesh = vtkSmartPointer<vtkPolyData>::New();
  mesh->SetPoints(points);
  mesh->SetPolys(cells);
  mesh->GetCellData()->SetScalars(faces);
  return mesh;
}
}
#endif
