// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSurfacePrior.h"

#include "lacunaExecution.h"
#include "lacunaVolumeDirection.h"
#include "vtkDataArray.h"
#include "vtkFeatureEdges.h"
#include "vtkImageData.h"
#include "vtkImplicitFunction.h"
#include "vtkImplicitPolyDataDistance.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkTriangleFilter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace
{
constexpr double LargestDistance = 1000; // of an implicit function, in steps: the size of the data

bool IsClosed(vtkPolyData* mesh)
{
  vtkNew<vtkFeatureEdges> edges;
  edges->SetInputData(mesh);
  edges->FeatureEdgesOff();
  edges->ManifoldEdgesOff();
  edges->Update();
  return edges->GetOutput()->GetNumberOfCells() == 0;
}
}

lacuna::SurfacePrior::SurfacePrior(vtkDataSet* data)
{
  constexpr double step = 1e-3; // of the size
  this->Step = step * data->GetLength();
  if (auto* image = vtkImageData::SafeDownCast(data))
  {
    lacuna::VolumeDirection::Check(image);
    const int* dimensions = image->GetDimensions();
    vtkDataArray* scalars = image->GetPointData()->GetScalars();
    if (!scalars || scalars->GetNumberOfComponents() != 1 ||
      std::min({ dimensions[0], dimensions[1], dimensions[2] }) < 2)
    {
      throw std::runtime_error(
        "PriorSurface is an image without scalars of one component, or flat; "
        "it must hold the signed distance in mm, negative inside");
    }
    this->Image = image;
    return;
  }
  auto* poly = vtkPolyData::SafeDownCast(data);
  if (!poly || poly->GetNumberOfPolys() + poly->GetNumberOfStrips() == 0)
  {
    throw std::runtime_error(
      "PriorSurface has no triangles; give a closed mesh, or an image of the "
      "signed distance in mm");
  }
  vtkNew<vtkTriangleFilter> triangles;
  triangles->SetInputData(poly);
  triangles->PassLinesOff();
  triangles->PassVertsOff();
  triangles->Update();
  if (!IsClosed(triangles->GetOutput()))
  {
    throw std::runtime_error("PriorSurface is a mesh that is not closed, so that it has no inside; "
                             "fill its holes (Fill Holes, Clean)");
  }
  vtkNew<vtkImplicitPolyDataDistance> distance;
  distance->SetInput(triangles->GetOutput());
  this->Function = distance;
}

lacuna::SurfacePrior::SurfacePrior(vtkImplicitFunction* function, double size)
  : Function(function)
  , IsDistance(false)
  , Step(1e-3 * size)
{
}

lacuna::SurfacePrior::~SurfacePrior() = default;

//------------------------------------------------------------------------------
double lacuna::SurfacePrior::GetValue(const lacuna::Vec3& x) const
{
  if (this->Function)
  {
    lacuna::Vec3 place = x;
    const double value = this->Function->FunctionValue(place.data());
    if (this->IsDistance)
    {
      return value;
    }
    // By differences: gradients of VTK's functions may be missing or too short. Where it is flat, as in the
    // middle of a sphere, nothing is divided by nearly 0.
    lacuna::Vec3 gradient;
    for (int c = 0; c < 3; ++c)
    {
      lacuna::Vec3 before = x;
      lacuna::Vec3 after = x;
      before[c] -= this->Step;
      after[c] += this->Step;
      gradient[c] = (this->Function->FunctionValue(after.data()) -
                      this->Function->FunctionValue(before.data())) /
        (2 * this->Step);
    }
    const double slope = lacuna::Norm(gradient);
    const double least = std::abs(value) / (LargestDistance * this->Step);
    return value / std::max({ slope, least, std::numeric_limits<double>::min() });
  }
  double index[3];
  this->Image->TransformPhysicalPointToContinuousIndex(x.data(), index);
  const int* extent = this->Image->GetExtent();
  int low[3];
  double part[3];
  lacuna::Vec3 beyond{};
  for (int c = 0; c < 3; ++c)
  {
    const double inside = std::clamp(
      index[c], static_cast<double>(extent[2 * c]), static_cast<double>(extent[2 * c + 1]));
    beyond[c] = (index[c] - inside) * this->Image->GetSpacing()[c];
    low[c] = std::min(static_cast<int>(std::floor(inside)), extent[2 * c + 1] - 1);
    part[c] = inside - low[c];
  }
  vtkDataArray* scalars = this->Image->GetPointData()->GetScalars();
  double value = 0;
  for (int corner = 0; corner < 8; ++corner)
  {
    int at[3];
    double weight = 1;
    for (int c = 0; c < 3; ++c)
    {
      const int high = corner >> c & 1;
      at[c] = low[c] + high;
      weight *= high ? part[c] : 1 - part[c];
    }
    value += weight * scalars->GetComponent(this->Image->ComputePointId(at), 0);
  }
  return value + lacuna::Norm(beyond);
}

//------------------------------------------------------------------------------
void lacuna::SurfacePrior::Evaluate(lacuna::Execution& execution,
  const std::vector<lacuna::Vec3>& points, std::vector<double>& values,
  std::vector<lacuna::Vec3>* gradients) const
{
  // on one thread: VTK's locators differ by version in whether more are safe
  constexpr std::size_t batch = 4096;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (i % batch == 0)
    {
      execution.Report(static_cast<double>(i) / static_cast<double>(points.size()));
    }
    values[i] = this->GetValue(points[i]);
    for (int c = 0; gradients && c < 3; ++c)
    {
      lacuna::Vec3 before = points[i];
      lacuna::Vec3 after = points[i];
      before[c] -= this->Step;
      after[c] += this->Step;
      (*gradients)[i][c] = (this->GetValue(after) - this->GetValue(before)) / (2 * this->Step);
    }
  }
}
