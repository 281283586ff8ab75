// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCheck.h"
#include "vtkDataArray.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkLacunaOccludedAngle.h"
#include "vtkNew.h"
#include "vtkPiecewiseFunction.h"
#include "vtkPointData.h"
#include "vtkSphere.h"

#include <climits>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

namespace
{
// What the filter says about an image of 0 with one voxel of 1, after change.
void Expect(const std::string& message,
  const std::function<void(vtkLacunaOccludedAngle*, vtkImageData*)>& change)
{
  vtkNew<vtkImageData> image;
  image->SetExtent(5, 14, 0, 11, 0, 7);
  image->SetSpacing(1, 0.5, 2);
  image->AllocateScalars(VTK_FLOAT, 1);
  image->GetPointData()->GetScalars()->Fill(0);
  image->SetScalarComponentFromDouble(9, 4, 3, 0, 1);
  vtkNew<vtkLacunaOccludedAngle> filter;
  filter->SetNumberOfDirections(10);
  filter->SetInputData(image);
  change(filter, image);
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK_CONTAINS(messages->Errors, message);
  LACUNA_CHECK(filter->GetOutput()->GetNumberOfPoints() == 0);
}
}

int TestOccludedAngleErrors(int, char*[])
{
  using Filter = vtkLacunaOccludedAngle;
  Expect("all grey levels are 0",
    [](Filter*, vtkImageData* image) { image->GetPointData()->GetScalars()->Fill(0); });
  Expect("no active point scalars",
    [](Filter*, vtkImageData* image) { image->GetPointData()->Initialize(); });
  Expect("no point array 'Echo' of numbers",
    [](Filter* filter, vtkImageData*) { filter->SetScalarArray("Echo"); });
  Expect("mend the spacing of the input",
    [](Filter*, vtkImageData* image) { image->SetSpacing(1, 1e300, 1e300); });
  Expect("at least two voxels wide",
    [](Filter*, vtkImageData* image) { image->SetDimensions(0, 0, 0); });
  Expect("its point array Short has 3 values for 960 points",
    [](Filter* filter, vtkImageData* image)
    {
      vtkNew<vtkFloatArray> array;
      array->SetName("Short");
      array->SetNumberOfTuples(3);
      array->Fill(1);
      image->GetPointData()->AddArray(array);
      filter->SetScalarArray("Short");
    });
  Expect("more than one component",
    [](Filter*, vtkImageData* image) { image->AllocateScalars(VTK_FLOAT, 3); });
  Expect("at least two voxels wide",
    [](Filter* filter, vtkImageData*)
    {
      vtkNew<vtkImageData> line;
      line->SetDimensions(9, 1, 1);
      line->AllocateScalars(VTK_FLOAT, 1);
      line->GetPointData()->GetScalars()->Fill(1);
      filter->SetInputData(line);
    });
  Expect("at least two voxels wide",
    [](Filter* filter, vtkImageData*)
    {
      vtkNew<vtkImageData> nothing; // though it is wide along two axes
      nothing->SetDimensions(9, 0, 7);
      nothing->AllocateScalars(VTK_DOUBLE, 1);
      vtkNew<vtkPiecewiseFunction> function;
      function->AddPoint(0, 1);
      filter->SetOpacityFunction(function);
      filter->SetAttenuation(Filter::ByOpacityFunction);
      filter->SetInputData(nothing);
    });
  Expect("not a finite number at voxel (9, 4, 3)",
    [](Filter*, vtkImageData* image)
    {
      image->SetScalarComponentFromDouble(5, 0, 0, 0, 1);
      image->SetScalarComponentFromDouble(9, 4, 3, 0, std::numeric_limits<double>::quiet_NaN());
    });
  Expect("negative or not a number at voxel (6, 2, 1)",
    [](Filter* filter, vtkImageData* image)
    {
      filter->SetAttenuation(Filter::ByArray);
      image->SetScalarComponentFromDouble(6, 2, 1, 0, -0.25);
    });
  Expect("negative or not a number at voxel (6, 2, 1)",
    [](Filter* filter, vtkImageData* image)
    {
      filter->SetAttenuation(Filter::ByArray);
      image->SetScalarComponentFromDouble(6, 2, 1, 0, std::nan(""));
    });
  Expect("no OpacityFunction",
    [](Filter* filter, vtkImageData*) { filter->SetAttenuation(Filter::ByOpacityFunction); });
  Expect("there is no threshold",
    [](Filter* filter, vtkImageData*) { filter->SetNumberOfThresholdsOverPi(0); });
  Expect("LocalRadii has 2 values and ThresholdsOverPi 3",
    [](Filter* filter, vtkImageData*)
    {
      filter->SetThresholdsOverPi(2, 2);
      filter->SetLocalRadii(1, 5);
    });
  Expect("ThresholdsOverPi is 4.5; it must be from 0 to 4",
    [](Filter* filter, vtkImageData*) { filter->SetThresholdsOverPi(1, 4.5); });
  Expect("ThresholdsOverPi is 2.5; in a 2-D image it must be at most 2",
    [](Filter* filter, vtkImageData* image)
    {
      image->SetDimensions(10, 12, 1);
      image->AllocateScalars(VTK_FLOAT, 1);
      image->GetPointData()->GetScalars()->Fill(0);
      image->SetScalarComponentFromDouble(5, 4, 0, 0, 1);
      filter->SetThresholdsOverPi(0, 2.5);
    });
  Expect("LocalRadii is -3 mm; it must be 0 (whole space) or above 0 mm",
    [](Filter* filter, vtkImageData*) { filter->SetLocalRadii(0, -3); });
  Expect("Mode is 2; it must be 0 (Continuous) or 1 (Binary)",
    [](Filter* filter, vtkImageData*) { filter->SetMode(2); });
  Expect("Attenuation is -1; it must be 0 (Linear in Range), 1 (Opacity Function) or 2 (Array)",
    [](Filter* filter, vtkImageData*) { filter->SetAttenuation(-1); });
  Expect("smaller than a voxel; give at least 0.5",
    [](Filter* filter, vtkImageData*) { filter->SetLocalRadii(0, 0.4); });
  Expect("ObjectOpacity is 1.5; it must be above 0 and at most 1",
    [](Filter* filter, vtkImageData*) { filter->SetObjectOpacity(1.5); });
  for (const int directions : { INT_MIN, -1, 0, 1, 10000001 })
  {
    Expect("NumberOfDirections is " + std::to_string(directions) + "; it must be from 2 to 1e+07",
      [directions](Filter* filter, vtkImageData*) { filter->SetNumberOfDirections(directions); });
  }
  Expect("MedianKernel is 4", [](Filter* filter, vtkImageData*) { filter->SetMedianKernel(4); });
  Expect("Dilation is 1 voxels; it must be from 0 to 0.9 voxels",
    [](Filter* filter, vtkImageData*) { filter->SetDilation(1); });
  Expect("contains none of the data",
    [](Filter* filter, vtkImageData*)
    {
      vtkNew<vtkSphere> elsewhere;
      elsewhere->SetCenter(100, 100, 100);
      filter->SetReconstructionSpace(elsewhere);
    });
  Expect("ReconstructionSpace: of the sphere Radius is -3",
    [](Filter* filter, vtkImageData*)
    {
      vtkNew<vtkSphere> ball;
      ball->SetCenter(5, 5, 5);
      ball->SetRadius(-3);
      filter->SetReconstructionSpace(ball);
    });
  Expect("the reconstruction space (second input)",
    [](Filter* filter, vtkImageData* image)
    {
      vtkNew<vtkImageData> mask;
      mask->DeepCopy(image);
      mask->SetSpacing(1, 0.5, 2.1);
      filter->SetInputData(1, mask);
    });

  // Everything object is no error: every voxel is hidden from everywhere.
  vtkNew<vtkImageData> full;
  full->SetDimensions(6, 6, 6);
  full->AllocateScalars(VTK_FLOAT, 1);
  full->GetPointData()->GetScalars()->Fill(50);
  vtkNew<vtkLacunaOccludedAngle> filter;
  filter->SetInputData(full);
  filter->SetMode(Filter::Binary);
  filter->SetAttenuation(Filter::ByArray);
  filter->SetNumberOfDirections(10);
  filter->Update();
  double range[2];
  filter->GetOutput()->GetPointData()->GetArray("Object")->GetRange(range);
  LACUNA_CHECK(range[0] == 1);
  return lacunaCheck::Result();
}
