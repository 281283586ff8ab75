// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Depth maps for the tests of this module.
#ifndef RBFTestMaps_h
#define RBFTestMaps_h

#include "lacunaDepthMap.h"
#include "vtkCharArray.h"
#include "vtkCylinder.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

#include <cmath>
#include <limits>

/// A map of 80 x 60 pixels of 1 x 0.8 mm whose extent starts at (10, 20), seen obliquely. Its
/// surface is an inclined plane (no symmetry: an error of axis or sign cannot hide).
struct TestMap
{
  static constexpr int FirstColumn = 10;
  static constexpr int FirstRow = 20;
  static constexpr int Width = 80;
  static constexpr int Height = 60;
  lacuna::Vec3 Origin{ 5, -7, 90 };
  lacuna::Vec3 Right = lacuna::Normalized({ 0.8, 0.5, -0.1 });
  lacuna::Vec3 Down;
  lacuna::Vec3 View;
  vtkSmartPointer<vtkImageData> Image = vtkSmartPointer<vtkImageData>::New();

  /// mm, map axes from index (0, 0)
  static double Depth(double x, double y) { return 25 + 0.3 * x - 0.15 * y; }

  TestMap()
  {
    this->View = lacuna::Normalized(lacuna::Cross(this->Right, { 0.2, -0.9, 0.1 }));
    this->Down = lacuna::Cross(this->View, this->Right);
    this->Image->SetExtent(
      FirstColumn, FirstColumn + Width - 1, FirstRow, FirstRow + Height - 1, 0, 0);
    lacuna::DepthMap::SetGeometry(
      this->Image, { this->Origin, this->Right, this->Down, this->View, { 1, 0.8 } });
    vtkNew<vtkDoubleArray> depth;
    depth->SetName(lacuna::DepthMap::DepthName);
    vtkNew<vtkCharArray> valid;
    valid->SetName(lacuna::DepthMap::MaskName);
    vtkNew<vtkFloatArray> normals;
    normals->SetName(lacuna::DepthMap::NormalsName);
    normals->SetNumberOfComponents(3);
    for (int i = 0; i < Width * Height; ++i)
    {
      const lacuna::Vec2 p = this->GetPosition(i);
      depth->InsertNextValue(Depth(p[0], p[1]));
      valid->InsertNextValue(1);
      normals->InsertNextTuple3(0, 0, 0); // so that computed ones stand out
    }
    this->Image->GetPointData()->AddArray(depth);
    this->Image->GetPointData()->AddArray(valid);
    this->Image->GetPointData()->AddArray(normals);
    this->Image->GetPointData()->SetActiveScalars(lacuna::DepthMap::DepthName);
  }

  /// Map axes, mm.
  lacuna::Vec2 GetPosition(vtkIdType i) const
  {
    return { FirstColumn + static_cast<double>(i % Width),
      0.8 * (FirstRow + static_cast<double>(i / Width)) };
  }
  lacuna::Vec3 GetSurfacePoint(double x, double y) const
  {
    return this->Origin + x * this->Right + y * this->Down + Depth(x, y) * this->View;
  }
  /// Is pixel i in a disc about (45, 42) mm?
  bool IsInDisc(vtkIdType i, double radius) const
  {
    const lacuna::Vec2 p = this->GetPosition(i);
    return std::hypot(p[0] - 45, p[1] - 42) <= radius;
  }
  /// Cuts that disc.
  vtkSmartPointer<vtkCylinder> MakeDisc(double radius) const
  {
    auto cylinder = vtkSmartPointer<vtkCylinder>::New();
    cylinder->SetCenter(this->GetSurfacePoint(45, 42).data());
    cylinder->SetAxis(this->View[0], this->View[1], this->View[2]);
    cylinder->SetRadius(radius);
    return cylinder;
  }
  /// Takes the depth of pixel i away.
  void Invalidate(vtkIdType i)
  {
    this->Image->GetPointData()
      ->GetArray(lacuna::DepthMap::DepthName)
      ->SetTuple1(i, std::numeric_limits<double>::quiet_NaN());
    this->Image->GetPointData()->GetArray(lacuna::DepthMap::MaskName)->SetTuple1(i, 0);
  }
};

/// Component of pixel i of an array.
inline double Get(vtkImageData* image, const char* name, vtkIdType i, int component = 0)
{
  return image->GetPointData()->GetArray(name)->GetComponent(i, component);
}
#endif
