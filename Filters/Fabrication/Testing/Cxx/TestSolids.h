// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Filled maps, and what closed surfaces enclose.
#ifndef TestSolids_h
#define TestSolids_h

#include "TestSurfaces.h"
#include "vtkCellArray.h"
#include "vtkCellArrayIterator.h"
#include "vtkPolyData.h"

#include <functional>
#include <map>

namespace TestSolids
{
// A thick letter F, upright as the viewer sees it; x, y in mm from the middle of the map.
inline bool IsLetter(double x, double y)
{
  return (x > -8 && x < -3 && y > -10 && y < 10) || (x >= -3 && x < 8 && y > -10 && y < -5.5) ||
    (x >= -3 && x < 4 && y > -2 && y < 2.5);
}

// How many corners of a rectangle of 2 dx by 2 dy about x, y are in the letter: 0 and 4 are clear.
inline int CornersInLetter(double x, double y, double dx, double dy)
{
  return IsLetter(x - dx, y - dy) + IsLetter(x + dx, y - dy) + IsLetter(x - dx, y + dy) +
    IsLetter(x + dx, y + dy);
}

// From where viewers look at the map.
constexpr lacuna::Vec3 Views[] = { { 0, 0, 1 }, { 0, 0, -1 }, { 1, 0, 0 }, { 0, 1, 0 },
  { 1, -2, 0.5 } };

inline double X(int i)
{
  return 0.5 * (i - 49);
}

inline double Y(int j)
{
  return 0.75 * (j - 30);
}

// At pixel i, j, so deep.
inline lacuna::Vec3 Place(const lacuna::DepthMap::Geometry& geometry, int i, int j, double depth)
{
  return geometry.Origin + 0.5 * i * geometry.Right + 0.75 * j * geometry.Down +
    depth * geometry.View;
}

// The map of TestSurfaces with the letter as filled defect and bone that grows thinner to the right.
inline vtkSmartPointer<vtkImageData> FilledMap(const lacuna::DepthMap::Geometry& geometry,
  const std::function<bool(double, double)>& inside = IsLetter)
{
  auto map = TestSurfaces::Map(geometry, true);
  vtkNew<vtkCharArray> filled;
  filled->SetName(lacuna::DepthMap::FilledMaskName);
  vtkNew<vtkDoubleArray> thickness;
  thickness->SetName("Thickness");
  for (int j = -3; j <= 66; ++j)
  {
    for (int i = 5; i <= 94; ++i)
    {
      filled->InsertNextValue(inside(X(i), Y(j)));
      thickness->InsertNextValue(inside(X(i), Y(j)) ? TestSurfaces::NaN : 5 - 0.2 * X(i));
    }
  }
  map->GetPointData()->AddArray(filled);
  map->GetPointData()->AddArray(thickness);
  return map;
}

// How often the closed surface winds around p: 1 inside, 0 outside, -1 when it is inside out.
inline double GetWinding(vtkPolyData* solid, const lacuna::Vec3& p)
{
  double sum = 0;
  auto cells = vtk::TakeSmartPointer(solid->GetPolys()->NewIterator());
  for (cells->GoToFirstCell(); !cells->IsDoneWithTraversal(); cells->GoToNextCell())
  {
    vtkIdType n;
    const vtkIdType* ids;
    cells->GetCurrentCell(n, ids);
    lacuna::Vec3 v[3];
    double length[3];
    for (int k = 0; k < 3; ++k)
    {
      solid->GetPoint(ids[k], v[k].data());
      v[k] = v[k] - p;
      length[k] = lacuna::Norm(v[k]);
    }
    sum += 2 *
      std::atan2(lacuna::Dot(v[0], lacuna::Cross(v[1], v[2])),
        length[0] * length[1] * length[2] + lacuna::Dot(v[0], v[1]) * length[2] +
          lacuna::Dot(v[1], v[2]) * length[0] + lacuna::Dot(v[2], v[0]) * length[1]);
  }
  return sum / (4 * 3.14159265358979323846);
}

// Every edge has two triangles, one each way.
inline bool IsClosed(vtkPolyData* solid)
{
  std::map<std::pair<vtkIdType, vtkIdType>, int> edges;
  auto cells = vtk::TakeSmartPointer(solid->GetPolys()->NewIterator());
  for (cells->GoToFirstCell(); !cells->IsDoneWithTraversal(); cells->GoToNextCell())
  {
    vtkIdType n;
    const vtkIdType* ids;
    cells->GetCurrentCell(n, ids);
    for (int k = 0; k < 3; ++k)
    {
      ++edges[{ ids[k], ids[(k + 1) % 3] }];
    }
  }
  for (const auto& edge : edges)
  {
    if (edge.second != 1 || !edges.count({ edge.first.second, edge.first.first }))
    {
      return false;
    }
  }
  return !edges.empty();
}
}
#endif
