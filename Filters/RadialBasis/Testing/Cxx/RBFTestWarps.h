// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Images and landmarks for the tests of RBF Image Warp.
#ifndef RBFTestWarps_h
#define RBFTestWarps_h

#include "lacunaCheck.h"
#include "vtkDoubleArray.h"
#include "vtkExecutive.h"
#include "vtkImageData.h"
#include "vtkLacunaRBFImageWarp.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <cmath>

namespace RBFTestWarps
{
inline constexpr double Origin[3] = { 10, -5, 30 };
inline constexpr double Spacing[3] = { 1.5, 2, 2.5 };
/// turned about z and x: an image of a tilted scanner
inline constexpr double Direction[9] = { 0.8, -0.6, 0, 0.36, 0.48, -0.8, 0.48, 0.64, 0.6 };

/// Grey levels that say which place they belong to: the world coordinates, three components.
inline vtkSmartPointer<vtkImageData> MakeImage(int layers)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetExtent(2, 41, 0, 29, 5, 4 + layers);
  image->SetOrigin(Origin);
  image->SetSpacing(Spacing);
  if (layers > 1)
  {
    image->SetDirectionMatrix(Direction);
  }
  vtkNew<vtkDoubleArray> place;
  place->SetName("Place");
  place->SetNumberOfComponents(3);
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    place->InsertNextTuple(image->GetPoint(i));
  }
  image->GetPointData()->SetScalars(place);
  return image;
}

inline double Fraction(double x)
{
  return x - std::floor(x);
}

/// Landmarks scattered in the image, and targets up to 2 to 3 times so many mm away.
inline void MakeLandmarks(
  vtkImageData* image, int count, vtkPolyData* landmarks, vtkPolyData* targets, double way = 1)
{
  vtkNew<vtkPoints> from;
  vtkNew<vtkPoints> to;
  from->SetDataTypeToDouble();
  to->SetDataTypeToDouble();
  const int* extent = image->GetExtent();
  for (int i = 1; i <= count; ++i)
  {
    const double index[3] = { extent[0] + (extent[1] - extent[0]) * Fraction(i * 0.7548776662),
      extent[2] + (extent[3] - extent[2]) * Fraction(i * 0.5698402910),
      extent[4] + (extent[5] - extent[4]) * Fraction(i * 0.8191725134) };
    double x[3];
    image->TransformContinuousIndexToPhysicalPoint(index, x);
    from->InsertNextPoint(x);
    x[0] += way * 2 * std::sin(i);
    x[1] += way * 3 * std::cos(2.0 * i);
    x[2] += image->GetDimensions()[2] > 1 ? way * 2 * std::sin(3.0 * i) : 0;
    to->InsertNextPoint(x);
  }
  landmarks->SetPoints(from);
  targets->SetPoints(to);
}

/// A warp of all three inputs, and what it says.
struct WatchedWarp
{
  vtkNew<vtkLacunaRBFImageWarp> Filter;
  vtkNew<lacunaCheck::Messages> Messages;

  WatchedWarp(vtkImageData* image, vtkPolyData* landmarks, vtkPolyData* targets)
  {
    this->Messages->Watch(this->Filter);
    this->Messages->Watch(this->Filter->GetExecutive());
    this->Filter->SetInputData(0, image);
    this->Filter->SetInputData(1, landmarks);
    this->Filter->SetInputData(2, targets);
  }
};
}
#endif
