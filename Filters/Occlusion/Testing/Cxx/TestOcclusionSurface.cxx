// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCheck.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkLacunaOcclusionSurface.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

namespace
{
const double Pi = 3.14159265358979323846;
// An ellipsoid off the middle of a turned image whose extent does not start at 0.
const double HalfAxes[3] = { 14, 11, 8 };
const double Middle[3] = { 21, 17, 14 }; // in voxels from the first

void MakeImages(vtkImageData* angle, vtkImageData* data)
{
  for (vtkImageData* image : { angle, data })
  {
    image->SetExtent(5, 46, -3, 33, 7, 36);
    image->SetSpacing(0.5, 0.5, 0.5);
    image->SetOrigin(10, -20, 30);
    // columns: x to y, y to z, z to x
    image->SetDirectionMatrix(0, 0, 1, 1, 0, 0, 0, 1, 0);
  }
  vtkNew<vtkFloatArray> theta;
  theta->SetName("OccludedAngle");
  vtkNew<vtkUnsignedCharArray> object;
  object->SetName("Object");
  vtkNew<vtkUnsignedCharArray> seen;
  seen->SetName("Data");
  for (int k = 0; k < 30; ++k)
  {
    for (int j = 0; j < 37; ++j)
    {
      for (int i = 0; i < 42; ++i)
      {
        const double p[3] = { i - Middle[0], j - Middle[1], k - Middle[2] };
        double f = 0;
        double g = 0;
        for (int c = 0; c < 3; ++c)
        {
          f += std::pow(p[c] / HalfAxes[c], 2);
          g += std::pow(p[c] / HalfAxes[c] / HalfAxes[c], 2);
        }
        const double distance = (f - 1) / (2 * std::sqrt(std::max(g, 1e-6)));
        theta->InsertNextValue(static_cast<float>(2 * Pi * (1 - std::tanh(distance / 3))));
        object->InsertNextValue(distance <= 0.5);
        seen->InsertNextValue(std::abs(distance) <= 0.5 && (i * 7 + j * 5 + k * 3) % 4 == 0);
      }
    }
  }
  angle->GetPointData()->SetScalars(theta);
  angle->GetPointData()->AddArray(object);
  data->GetPointData()->SetScalars(seen);
}

// The filter with the ellipsoid's images, and what it says.
struct Run
{
  vtkNew<vtkImageData> Angle;
  vtkNew<vtkImageData> Data;
  vtkNew<vtkLacunaOcclusionSurface> Filter;
  vtkSmartPointer<lacunaCheck::Messages> Messages = lacunaCheck::Watch(Filter);

  Run()
  {
    MakeImages(this->Angle, this->Data);
    this->Filter->SetInputData(0, this->Angle);
    this->Filter->SetInputData(1, this->Data);
  }
};

void CheckEllipsoid()
{
  const Run run;
  run.Filter->Update();
  LACUNA_CHECK(run.Messages->Errors.empty() && run.Messages->Warnings.empty());
  vtkPolyData* surface = run.Filter->GetOutput();
  LACUNA_CHECK(surface->GetNumberOfPoints() > 1000);
  const double volume = 4 * Pi / 3 * 14 * 11 * 8 / 8 / 1000; // ml
  vtkDataArray* measured = surface->GetFieldData()->GetArray("SurfaceVolume");
  LACUNA_CHECK(measured && std::abs(measured->GetComponent(0, 0) / volume - 1) < 0.02);
  // Every point in world coordinates lies near the ellipsoid, its normal points outwards.
  double largest = 0;
  bool outwards = true;
  for (vtkIdType n = 0; n < surface->GetNumberOfPoints(); ++n)
  {
    double index[3];
    run.Angle->TransformPhysicalPointToContinuousIndex(surface->GetPoint(n), index);
    double f = 0;
    double g = 0;
    double slope[3];
    for (int c = 0; c < 3; ++c)
    {
      const double x = index[c] - run.Angle->GetExtent()[2 * c] - Middle[c];
      f += x * x / (HalfAxes[c] * HalfAxes[c]);
      slope[c] = x / (HalfAxes[c] * HalfAxes[c]);
      g += slope[c] * slope[c];
    }
    largest = std::max(largest, std::abs(f - 1) / (2 * std::sqrt(g)));
    double world[3];
    run.Angle->GetDirectionMatrix()->MultiplyPoint(slope, world);
    const double* normal = surface->GetPointData()->GetNormals()->GetTuple3(n);
    outwards = outwards &&
      world[0] * normal[0] + world[1] * normal[1] + world[2] * normal[2] > 0.8 * std::sqrt(g);
  }
  LACUNA_CHECK(largest < 1);
  LACUNA_CHECK(outwards);
  run.Filter->UpdatePiece(1, 2, 0);
  LACUNA_CHECK(run.Filter->GetOutput()->GetNumberOfPoints() == 0);
}

// A body filled with echoes, every so many of its voxels: even where most data are on its surface, the
// others pull it inwards, which is said.
void CheckFilled(int every)
{
  const Run run;
  vtkDataArray* object = run.Angle->GetPointData()->GetArray("Object");
  for (vtkIdType i = 0; i < object->GetNumberOfTuples(); ++i)
  {
    if (i % every == 0 && object->GetComponent(i, 0) > 0)
    {
      run.Data->GetPointData()->GetScalars()->SetComponent(i, 0, 1);
    }
  }
  run.Filter->Update();
  LACUNA_CHECK(
    run.Messages->Errors.empty() && run.Messages->HasWarning("the surface may be wrong"));
}

void Expect(const std::string& message,
  const std::function<void(vtkLacunaOcclusionSurface*, vtkImageData*, vtkImageData*)>& change)
{
  const Run run;
  change(run.Filter, run.Angle, run.Data);
  run.Filter->Update();
  LACUNA_CHECK_CONTAINS(run.Messages->Errors, message);
  LACUNA_CHECK(run.Filter->GetOutput()->GetNumberOfPoints() == 0);
}
}

int TestOcclusionSurface(int, char*[])
{
  using Filter = vtkLacunaOcclusionSurface;
  CheckEllipsoid();
  CheckFilled(4);
  CheckFilled(8);
  Expect("no point array 'Object'",
    [](Filter*, vtkImageData* angle, vtkImageData*)
    { angle->GetPointData()->RemoveArray("Object"); });
  Expect("other voxels than the angle image",
    [](Filter*, vtkImageData*, vtkImageData* data) { data->SetOrigin(10, -20, 31); });
  Expect("no point array 'Echo' of numbers",
    [](Filter* filter, vtkImageData*, vtkImageData*) { filter->SetScalarArray("Echo"); });
  Expect("all grey levels are",
    [](Filter*, vtkImageData*, vtkImageData* data)
    { data->GetPointData()->GetScalars()->Fill(0); });
  Expect("no voxel of the angle image is object",
    [](Filter*, vtkImageData* angle, vtkImageData*)
    { angle->GetPointData()->GetArray("Object")->Fill(0); });
  Expect("Smoothing is -1; it must be above 0",
    [](Filter* filter, vtkImageData*, vtkImageData*) { filter->SetSmoothing(-1); });
  Expect("Tolerance is 0 voxel edges; it must be from 0.001 to 0.5 voxel edges",
    [](Filter* filter, vtkImageData*, vtkImageData*) { filter->SetTolerance(0); });
  Expect("flat",
    [](Filter*, vtkImageData* angle, vtkImageData* data)
    {
      for (vtkImageData* image : { angle, data })
      {
        const int extent[6] = { 5, 46, -3, 33, 20, 20 };
        image->Crop(extent);
      }
    });
  return lacunaCheck::Result();
}
