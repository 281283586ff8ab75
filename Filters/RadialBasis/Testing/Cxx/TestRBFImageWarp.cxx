// SPDX-License-Identifier: BSD-3-Clause
// Image warps: masks and errors.
#include "RBFTestWarps.h"
#include "lacunaCheck.h"
#include "vtkCellData.h"
#include "vtkCharArray.h"
#include "vtkLacunaRBFImageWarp.h"
#include "vtkTypeInt32Array.h"
#include "vtkTypeInt64Array.h"

#include <cmath>
#include <functional>
#include <limits>
#include <string>

namespace
{
using namespace RBFTestWarps;

// A mask with an invalid block and single voxels, seen from every kind of place between voxels.
vtkSmartPointer<vtkCharArray> MakeMask(vtkImageData* image)
{
  auto mask = vtkSmartPointer<vtkCharArray>::New();
  mask->SetName("vtkValidPointMask");
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    const vtkIdType column = i % 40;
    const vtkIdType row = i / 40 % 30;
    mask->InsertNextValue((column > 24 && row < 9) || i % 131 == 0 ? 0 : 1);
  }
  return mask;
}

// What is interpolated from an invalid voxel is invalid: just there where NaN in place of the
// invalid grey levels would have spread to.
void CheckMask(int layers, int interpolation, bool still)
{
  const vtkSmartPointer<vtkImageData> image = MakeImage(layers);
  vtkNew<vtkPolyData> landmarks;
  vtkNew<vtkPolyData> targets;
  MakeLandmarks(image, 25, landmarks, targets);
  const auto warp = [&](vtkImageData* input)
  {
    vtkNew<vtkLacunaRBFImageWarp> filter;
    filter->SetInputData(0, input);
    filter->SetInputData(1, landmarks);
    filter->SetInputData(2, still ? landmarks : targets);
    filter->SetInterpolation(interpolation);
    filter->SetOutsideValue(-1000);
    filter->Update();
    auto output = vtkSmartPointer<vtkImageData>::New();
    output->ShallowCopy(filter->GetOutput());
    return output;
  };
  const vtkSmartPointer<vtkCharArray> mask = MakeMask(image);
  const vtkSmartPointer<vtkImageData> unmasked = warp(image);
  vtkNew<vtkImageData> withNaN;
  withNaN->DeepCopy(image);
  vtkDataArray* spoilt = withNaN->GetPointData()->GetScalars();
  for (vtkIdType i = 0; i < mask->GetNumberOfTuples(); ++i)
  {
    if (mask->GetValue(i) == 0)
    {
      spoilt->SetComponent(i, 1, std::nan(""));
    }
  }
  const vtkSmartPointer<vtkImageData> spread = warp(withNaN);
  image->GetPointData()->AddArray(mask);
  vtkNew<vtkDoubleArray> other;
  other->SetName("Other");
  other->SetNumberOfTuples(image->GetNumberOfPoints());
  image->GetPointData()->AddArray(other);
  vtkNew<vtkDoubleArray> cells;
  cells->SetName("Cells");
  cells->SetNumberOfTuples(image->GetNumberOfCells());
  image->GetCellData()->AddArray(cells);
  const vtkSmartPointer<vtkImageData> masked = warp(image);

  LACUNA_CHECK(masked->GetPointData()->GetNumberOfArrays() == 2);
  LACUNA_CHECK(masked->GetCellData()->GetNumberOfArrays() == 0);
  vtkDataArray* valid = masked->GetPointData()->GetArray("vtkValidPointMask");
  vtkDataArray* place = masked->GetPointData()->GetArray("Place");
  vtkIdType lost = 0;
  for (vtkIdType i = 0; i < masked->GetNumberOfPoints(); ++i)
  {
    // VTK's cubic interpolation multiplies NaN by 0 on a voxel: there the mask itself is expected.
    const bool within =
      unmasked->GetPointData()->GetArray("vtkValidPointMask")->GetComponent(i, 0) != 0;
    const bool known = still
      ? mask->GetValue(i) != 0
      : within && !std::isnan(spread->GetPointData()->GetArray("Place")->GetComponent(i, 1));
    lost += within && !known ? 1 : 0;
    LACUNA_CHECK((valid->GetComponent(i, 0) != 0) == known);
    LACUNA_CHECK(place->GetComponent(i, 0) ==
      (known ? unmasked->GetPointData()->GetArray("Place")->GetComponent(i, 0) : -1000));
    LACUNA_CHECK(still ||
      known == (spread->GetPointData()->GetArray("vtkValidPointMask")->GetComponent(i, 0) != 0));
  }
  LACUNA_CHECK(lost > masked->GetNumberOfPoints() / 20);
  LACUNA_CHECK(lost < masked->GetNumberOfPoints() * 3 / 4);
}

struct Case
{
  const char* Name;
  std::function<void(vtkPolyData*, vtkPolyData*, vtkLacunaRBFImageWarp*)> Spoil;
  const char* Expected;
};

const Case Errors[] = {
  { "number",
    [](vtkPolyData*, vtkPolyData* to, vtkLacunaRBFImageWarp*)
    { to->GetPoints()->InsertNextPoint(1, 2, 3); },
    "25 landmarks but 26 targets" },
  { "few",
    [](vtkPolyData* from, vtkPolyData* to, vtkLacunaRBFImageWarp*)
    {
      from->GetPoints()->SetNumberOfPoints(3);
      to->GetPoints()->SetNumberOfPoints(3);
    },
    "at least 4 are needed" },
  { "none",
    [](vtkPolyData* from, vtkPolyData* to, vtkLacunaRBFImageWarp*)
    {
      from->GetPoints()->SetNumberOfPoints(0);
      to->GetPoints()->SetNumberOfPoints(0);
    },
    "at least 4 are needed" },
  { "contradiction",
    [](vtkPolyData*, vtkPolyData* to, vtkLacunaRBFImageWarp*)
    { to->GetPoints()->SetPoint(4, to->GetPoint(7)); },
    "nodes 4 and 7 lie at the same place" },
  { "NaN",
    [](vtkPolyData* from, vtkPolyData*, vtkLacunaRBFImageWarp*)
    { from->GetPoints()->SetPoint(6, std::nan(""), 0, 0); },
    "node 6" },
  { "kernel", [](vtkPolyData*, vtkPolyData*, vtkLacunaRBFImageWarp* w) { w->SetKernel(4); },
    "Kernel is 4; it must be 0 (ThinPlate), 1 (Linear), 2 (Triharmonic) or 3 (Cubic)" },
  { "interpolation",
    [](vtkPolyData*, vtkPolyData*, vtkLacunaRBFImageWarp* w) { w->SetInterpolation(3); },
    "Interpolation is 3; it must be 0 (Nearest), 1 (Linear) or 2 (Cubic)" },
  { "accuracy", [](vtkPolyData*, vtkPolyData*, vtkLacunaRBFImageWarp* w) { w->SetAccuracy(0); },
    "Accuracy is 0 voxels; it must be above 0 and at most 1 voxels" },
  { "coarse accuracy",
    [](vtkPolyData*, vtkPolyData*, vtkLacunaRBFImageWarp* w) { w->SetAccuracy(1); },
    "Accuracy is 1 voxel; it must be less" },
  { "smoothing", [](vtkPolyData*, vtkPolyData*, vtkLacunaRBFImageWarp* w) { w->SetSmoothing(-1); },
    "Smoothing is -1; it must be 0 or more" },
};

void CheckErrors()
{
  for (const Case& c : Errors)
  {
    const vtkSmartPointer<vtkImageData> image = MakeImage(12);
    vtkNew<vtkPolyData> landmarks;
    vtkNew<vtkPolyData> targets;
    MakeLandmarks(image, 25, landmarks, targets);
    WatchedWarp run(image, landmarks, targets);
    c.Spoil(landmarks, targets, run.Filter);
    run.Filter->Update();
    if (!run.Messages->HasError(c.Expected))
    {
      lacunaCheck::Fail(__FILE__, __LINE__, std::string(c.Name) + ": " + run.Messages->Errors);
    }
    LACUNA_CHECK(run.Filter->GetOutput()->GetNumberOfPoints() == 0);
  }
}

// Labels that a double does not hold come out as they are; 32 bits say which they are. The largest number
// stays the largest.
void CheckLabels()
{
  constexpr vtkTypeInt64 first = vtkTypeInt64{ 1 } << 53;
  const vtkSmartPointer<vtkImageData> image = MakeImage(12);
  vtkNew<vtkPolyData> landmarks;
  vtkNew<vtkPolyData> targets;
  MakeLandmarks(image, 25, landmarks, targets);
  const auto warp = [&](vtkDataArray* scalars, int interpolation)
  {
    image->GetPointData()->SetScalars(scalars);
    WatchedWarp run(image, landmarks, targets);
    run.Filter->SetInterpolation(interpolation);
    run.Filter->SetOutsideValue(-7);
    run.Filter->Update();
    LACUNA_CHECK(run.Messages->Errors.empty());
    return vtkSmartPointer<vtkDataArray>(run.Filter->GetOutput()->GetPointData()->GetScalars());
  };
  vtkNew<vtkTypeInt32Array> numbers;
  vtkNew<vtkTypeInt64Array> labels;
  vtkNew<vtkTypeInt64Array> largest;
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    numbers->InsertNextValue(static_cast<vtkTypeInt32>(i));
    labels->InsertNextValue(first + 2 * i + 1);
    largest->InsertNextValue(std::numeric_limits<vtkTypeInt64>::max());
  }
  numbers->SetName("Labels");
  labels->SetName("Labels");
  largest->SetName("Labels");
  const auto expected = warp(numbers, vtkLacunaRBFImageWarp::Nearest);
  const auto found = warp(labels, vtkLacunaRBFImageWarp::Nearest);
  const auto high = warp(largest, vtkLacunaRBFImageWarp::Linear);
  vtkIdType inside = 0;
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    const auto number = static_cast<vtkTypeInt64>(expected->GetTuple1(i));
    LACUNA_CHECK(vtkTypeInt64Array::SafeDownCast(found)->GetValue(i) ==
      (number < 0 ? -7 : first + 2 * number + 1));
    const double value = high->GetTuple1(i);
    LACUNA_CHECK(value == -7 || value > 9e18);
    inside += number < 0 ? 0 : 1;
  }
  LACUNA_CHECK(inside > 1000);
}

// The mask is no picture.
void CheckMaskAlone()
{
  const vtkSmartPointer<vtkImageData> image = MakeImage(12);
  vtkNew<vtkPolyData> landmarks;
  vtkNew<vtkPolyData> targets;
  MakeLandmarks(image, 25, landmarks, targets);
  image->GetPointData()->SetScalars(MakeMask(image));
  WatchedWarp run(image, landmarks, targets);
  run.Filter->Update();
  LACUNA_CHECK(run.Messages->HasError("active scalars are its vtkValidPointMask"));
}
}

int TestRBFImageWarp(int, char*[])
{
  for (int interpolation = 0; interpolation < 3; ++interpolation)
  {
    CheckMask(12, interpolation, false);
    CheckMask(1, interpolation, false);
    CheckMask(12, interpolation, true);
  }
  CheckLabels();
  CheckMaskAlone();
  CheckErrors();
  return lacunaCheck::Result();
}
