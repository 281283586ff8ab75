// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Inputs of the IGES Writer's tests. All are asymmetric: no mirror image is the same.
#ifndef TestSurfaces_h
#define TestSurfaces_h

#include "lacunaDepthMap.h"
#include "lacunaFieldData.h"
#include "vtkCharArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"
#include "vtkStructuredGrid.h"

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

namespace TestSurfaces
{
constexpr double NaN = std::numeric_limits<double>::quiet_NaN();

/// A dome with a bump off its centre; x, y in mm from the centre.
inline double Depth(double x, double y)
{
  return 65 - std::sqrt(60 * 60 - x * x - 1.2 * y * y) -
    3 * std::exp(-((x - 8) * (x - 8) + (y + 5) * (y + 5)) / 60);
}

/// The geometry of a map seen along the view, turned by an angle about it.
inline lacuna::DepthMap::Geometry Geometry(const lacuna::Vec3& view, double turn)
{
  const lacuna::Matrix4 rotation = lacuna::Matrix4::Rotation(view, turn);
  const lacuna::Vec3 z = lacuna::Normalized(view);
  const lacuna::Vec3 other =
    std::abs(z[0]) < 0.5 ? lacuna::Vec3{ 1, 0, 0 } : lacuna::Vec3{ 0, 1, 0 };
  const lacuna::Vec3 x = rotation.Vector(lacuna::Normalized(other - lacuna::Dot(other, z) * z));
  return { { 33, -71, 140 }, x, lacuna::Cross(z, x), z, { 0.5, 0.75 } };
}

/// A map of 90 x 70 pixels whose extent starts at (5, -3). With fitted, Fitted is a number on
/// columns 20..79 and rows 10..49 only, and Depth has a hole.
inline vtkSmartPointer<vtkImageData> Map(
  const lacuna::DepthMap::Geometry& geometry, bool fitted, bool perspective = false)
{
  auto map = vtkSmartPointer<vtkImageData>::New();
  map->SetExtent(5, 94, -3, 66, 0, 0);
  lacuna::DepthMap::SetGeometry(map, geometry);
  vtkNew<vtkDoubleArray> depth;
  depth->SetName(lacuna::DepthMap::DepthName);
  vtkNew<vtkDoubleArray> fit;
  fit->SetName(lacuna::DepthMap::FittedName);
  for (int j = -3; j <= 66; ++j)
  {
    for (int i = 5; i <= 94; ++i)
    {
      const double d = Depth(0.5 * (i - 49), 0.75 * (j - 30));
      depth->InsertNextValue(fitted && std::hypot(i - 50, j - 30) < 10 ? NaN : d);
      fit->InsertNextValue(i >= 20 && i <= 79 && j >= 10 && j <= 49 ? d : NaN);
    }
  }
  map->GetPointData()->AddArray(depth);
  if (fitted)
  {
    map->GetPointData()->AddArray(fit);
  }
  if (perspective)
  {
    const lacuna::Vec3 eye =
      geometry.Origin + 20.0 * geometry.Right + 25.0 * geometry.Down + -150.0 * geometry.View;
    lacuna::FieldData::Set(map, lacuna::DepthMap::EyePositionName, { eye[0], eye[1], eye[2] }, 3);
    lacuna::FieldData::Set(map, lacuna::DepthMap::ViewAngleName, { 30 }, 1);
  }
  return map;
}

/// Marks the pixels (i, j) of a Map in FilledMask.
inline void Fill(vtkImageData* map, const std::function<bool(int i, int j)>& filled)
{
  vtkNew<vtkCharArray> mask;
  mask->SetName(lacuna::DepthMap::FilledMaskName);
  for (int j = -3; j <= 66; ++j)
  {
    for (int i = 5; i <= 94; ++i)
    {
      mask->InsertNextValue(filled(i, j) ? 1 : 0);
    }
  }
  map->GetPointData()->AddArray(mask);
}

/// An asymmetric defect about pixel (50, 30): an ellipse of 12 x 9 mm half axes, in it an island of
/// 4 mm radius off its centre. Fitted covers 30 x 30 mm about (49.5, 29.5).
inline bool Defect(int i, int j)
{
  const double x = 0.5 * (i - 50);
  const double y = 0.75 * (j - 30);
  return x * x / 144 + y * y / 81 < 1 && std::hypot(x - 4, y + 2) >= 4;
}

/// The surface points that are to be written of a Map, column fastest.
inline std::vector<lacuna::Vec3> Points(vtkImageData* image, bool fitted)
{
  const lacuna::DepthMap map(image);
  std::vector<lacuna::Vec3> points;
  for (int j = fitted ? 10 : -3; j <= (fitted ? 49 : 66); ++j)
  {
    for (int i = fitted ? 20 : 5; i <= (fitted ? 79 : 94); ++i)
    {
      points.push_back(map.GetPoint(i, j, Depth(0.5 * (i - 49), 0.75 * (j - 30))));
    }
  }
  return points;
}

/// A structured surface of 40 x 25 points; flat is the dimension (0, 1, 2) that is 1.
inline vtkSmartPointer<vtkStructuredGrid> Grid(int flat, std::vector<lacuna::Vec3>& points)
{
  auto grid = vtkSmartPointer<vtkStructuredGrid>::New();
  int dimensions[3] = { 40, 40, 25 };
  dimensions[flat] = 1;
  dimensions[flat == 0 ? 1 : 0] = 40;
  dimensions[flat == 2 ? 1 : 2] = 25;
  grid->SetDimensions(dimensions);
  vtkNew<vtkPoints> array;
  array->SetDataTypeToDouble();
  points.clear();
  for (int j = 0; j < 25; ++j)
  {
    for (int i = 0; i < 40; ++i)
    {
      // bent round, so that no direction sees it as a height field
      const double angle = 0.1 * i;
      const double radius = 20 + 0.2 * j + std::sin(0.3 * j + angle);
      points.push_back({ radius * std::cos(angle), radius * std::sin(angle), 1.5 * j });
      array->InsertNextPoint(points.back().data());
    }
  }
  grid->SetPoints(array);
  return grid;
}

/// The pixels of a Map, without their depths or with them and height (mm along the view), as a grid
/// with the map's data, moved as ParaView's Transform does it.
inline vtkSmartPointer<vtkStructuredGrid> PixelGrid(
  vtkImageData* image, const lacuna::Matrix4& move, bool depths, double height)
{
  const lacuna::Matrix4 matrix = lacuna::DepthMap(image).GetImageToWorld();
  auto grid = vtkSmartPointer<vtkStructuredGrid>::New();
  grid->SetDimensions(90, 70, 1);
  vtkNew<vtkPoints> points; // single precision
  for (int j = -3; j <= 66; ++j)
  {
    for (int i = 5; i <= 94; ++i)
    {
      const double depth = depths ? Depth(0.5 * (i - 49), 0.75 * (j - 30)) : 0.0;
      points->InsertNextPoint(
        move.Point(matrix.Point({ double(i), double(j), depth + height })).data());
    }
  }
  grid->SetPoints(points);
  grid->GetPointData()->ShallowCopy(image->GetPointData());
  grid->GetFieldData()->ShallowCopy(image->GetFieldData());
  return grid;
}

/// Gives data PressPosition, and then does what ParaView's Transform does.
inline void RecordAndMove(vtkPointSet* data, const lacuna::Matrix4& move)
{
  vtkNew<vtkDoubleArray> made;
  made->SetName("PressPosition");
  made->SetNumberOfComponents(4);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (vtkIdType k = 0; k < data->GetNumberOfPoints(); ++k)
  {
    lacuna::Vec3 p;
    data->GetPoint(k, p.data());
    made->InsertNextTuple4(p[0], p[1], p[2], 1);
    points->InsertNextPoint(move.Point(p).data());
  }
  data->GetPointData()->AddArray(made);
  data->SetPoints(points);
}
}
#endif
