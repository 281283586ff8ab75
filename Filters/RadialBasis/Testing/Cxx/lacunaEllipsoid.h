// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// An ellipsoid beside the origin, as points and as outlines, for tests of surfaces.
#ifndef lacunaEllipsoid_h
#define lacunaEllipsoid_h

#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <cmath>
#include <vector>

namespace lacunaEllipsoid
{
constexpr double Pi = 3.14159265358979323846;
// an ellipsoid without symmetry about the origin
constexpr double Axes[3] = { 30, 22, 16 };
constexpr double Center[3] = { 10, -4, 7 };
constexpr double Volume = 4 * Pi / 3 * Axes[0] * Axes[1] * Axes[2] / 1000; // ml

inline void AddPoint(double x, double y, double z, vtkPoints* points, vtkDoubleArray* normals)
{
  const double u[3] = { x, y, z }; // on the unit sphere
  double p[3];
  double n[3];
  double length = 0;
  for (int c = 0; c < 3; ++c)
  {
    p[c] = Center[c] + Axes[c] * u[c];
    n[c] = u[c] / Axes[c];
    length += n[c] * n[c];
  }
  points->InsertNextPoint(p);
  for (double& c : n)
  {
    c /= std::sqrt(length);
  }
  normals->InsertNextTuple(n);
}

inline vtkSmartPointer<vtkPolyData> MakePoints(int count, bool withNormals)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkDoubleArray> normals;
  normals->SetName("Normals");
  normals->SetNumberOfComponents(3);
  for (int i = 0; i < count; ++i)
  {
    const double z = 1 - (2 * i + 1.0) / count;
    const double angle = 2.399963229728653 * i;
    const double r = std::sqrt(1 - z * z);
    AddPoint(r * std::cos(angle), r * std::sin(angle), z, points, normals);
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  if (withNormals)
  {
    data->GetPointData()->AddArray(normals);
  }
  return data;
}

// Slices across z; outlines may run either way round.
inline vtkSmartPointer<vtkPolyData> MakeOutlines(bool closed)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkDoubleArray> normals;
  normals->SetNumberOfComponents(3);
  vtkNew<vtkCellArray> lines;
  int slice = 0;
  for (const double z : { -0.9, -0.6, -0.2, 0.2, 0.6, 0.9 })
  {
    std::vector<vtkIdType> ids;
    for (int k = 0; k < 30; ++k)
    {
      const double angle = (slice % 2 ? -1 : 1) * 2 * Pi * k / 30;
      ids.push_back(points->GetNumberOfPoints());
      AddPoint(std::sqrt(1 - z * z) * std::cos(angle), std::sqrt(1 - z * z) * std::sin(angle), z,
        points, normals);
    }
    if (closed)
    {
      ids.push_back(ids.front());
    }
    lines->InsertNextCell(static_cast<vtkIdType>(ids.size()), ids.data());
    ++slice;
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetLines(lines);
  return data;
}
}
#endif
