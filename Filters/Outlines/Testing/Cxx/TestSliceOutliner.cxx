// SPDX-License-Identifier: BSD-3-Clause
// Outlines and pictures of slices in space: tracked slices that are tilted, a turned volume, and bad input.
#include "lacunaCheck.h"
#include "lacunaMatrix4.h"
#include "lacunaTrackedSlices.h"
#include "lacunaVector.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkLacunaSliceOutliner.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStringArray.h"
#include "vtkStructuredGrid.h"

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace
{
using lacuna::Matrix4;
using lacuna::Vec3;

// Slices of 0.5 x 0.4 mm pixels that turn about an edge, askew.
std::vector<Matrix4> MakePoses(int count)
{
  std::vector<Matrix4> poses;
  for (int n = 0; n < count; ++n)
  {
    const double angle = 0.1 * n;
    poses.push_back(
      Matrix4::FromColumns({ 0.5, 0, 0 }, { 0, 0.4 * std::cos(angle), 0.4 * std::sin(angle) },
        { 0, -std::sin(angle), std::cos(angle) }, { 10, 20.0 + n, -5 }));
  }
  return poses;
}

// 13 x 9 pixels; grey level = column + 2 row + 10 slice.
vtkSmartPointer<vtkImageData> MakeStack(int count, const std::vector<unsigned char>& status = {})
{
  auto stack = vtkSmartPointer<vtkImageData>::New();
  stack->SetDimensions(13, 9, count);
  stack->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  for (int k = 0; k < count; ++k)
  {
    for (int j = 0; j < 9; ++j)
    {
      for (int i = 0; i < 13; ++i)
      {
        stack->SetScalarComponentFromDouble(i, j, k, 0, i + 2 * j + 10 * k);
      }
    }
  }
  std::vector<double> times(count, 0);
  std::vector<int> frames(count, 0);
  lacuna::TrackedSlices::Write(stack, MakePoses(count), times,
    status.empty() ? std::vector<unsigned char>(count, 0) : status, frames);
  return stack;
}

// An L without symmetry.
void AddL(vtkLacunaSliceOutliner* filter, int structure, int outline, int slice)
{
  const double places[6][2] = { { 2, 1 }, { 9, 1 }, { 9, 3 }, { 4, 3 }, { 4, 7 }, { 2, 7 } };
  for (const auto& p : places)
  {
    filter->AddOutlinePoint(structure, outline, slice, p[0], p[1]);
  }
}

Vec3 GetPoint(vtkDataSet* data, vtkIdType i)
{
  Vec3 x;
  data->GetPoint(i, x.data());
  return x;
}

void TestTrackedSlices()
{
  const auto stack = MakeStack(5);
  vtkNew<vtkLacunaSliceOutliner> filter;
  filter->SetInputData(stack);
  filter->SmoothOff();
  AddL(filter, 2, 7, 3);
  AddL(filter, 1, 0, 1);
  filter->AddStructureName("Liver");
  filter->AddStructureColor(1, 0.5, 0);
  filter->SetSlice(3);
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK_THAT(
    messages->Errors.empty() && messages->Warnings.empty(), messages->Errors + messages->Warnings);
  vtkPolyData* lines = filter->GetOutput();
  LACUNA_CHECK(lines->GetNumberOfLines() == 2 && lines->GetNumberOfPoints() == 12);
  const Matrix4 pose = MakePoses(5)[3];
  const double places[6][2] = { { 2, 1 }, { 9, 1 }, { 9, 3 }, { 4, 3 }, { 4, 7 }, { 2, 7 } };
  vtkIdList* ids = lines->GetCell(0)->GetPointIds();
  LACUNA_CHECK(ids->GetNumberOfIds() == 7 && ids->GetId(6) == ids->GetId(0));
  for (int i = 0; i < 6; ++i)
  {
    const Vec3 expected = pose.Point({ places[i][0], places[i][1], 0 });
    LACUNA_CHECK_NEAR(Norm(GetPoint(lines, ids->GetId(i)) - expected), 0, 1e-12);
    LACUNA_CHECK(
      lines->GetPointData()->GetArray("Pixel")->GetComponent(ids->GetId(i), 1) == places[i][1]);
    LACUNA_CHECK(lines->GetPointData()->GetArray("Pixel")->GetComponent(ids->GetId(i), 2) == 3);
    LACUNA_CHECK(lines->GetPointData()->GetArray("Handle")->GetComponent(ids->GetId(i), 0) == 1);
  }
  vtkCellData* cells = lines->GetCellData();
  auto* names = vtkStringArray::SafeDownCast(cells->GetAbstractArray("StructureName"));
  LACUNA_CHECK(names->GetValue(0) == "Structure 2" && names->GetValue(1) == "Liver");
  LACUNA_CHECK(cells->GetArray("Structure")->GetComponent(0, 0) == 2);
  LACUNA_CHECK(cells->GetArray("Outline")->GetComponent(0, 0) == 7);
  LACUNA_CHECK(cells->GetArray("SliceNumber")->GetComponent(1, 0) == 1);
  LACUNA_CHECK(cells->GetArray("StructureColor")->GetComponent(1, 1) == 128);
  LACUNA_CHECK(
    cells->GetArray("StructureColor")->GetComponent(0, 2) == 233); // the second of its own

  auto* picture = vtkStructuredGrid::SafeDownCast(filter->GetOutputDataObject(1));
  LACUNA_CHECK(picture->GetNumberOfPoints() == 13 * 9);
  for (int j = 0; j < 9; ++j)
  {
    for (int i = 0; i < 13; ++i)
    {
      const vtkIdType n = 13 * static_cast<vtkIdType>(j) + i;
      LACUNA_CHECK_NEAR(Norm(GetPoint(picture, n) - pose.Point({ 1.0 * i, 1.0 * j, 0 })), 0, 1e-12);
      LACUNA_CHECK(picture->GetPointData()->GetScalars()->GetComponent(n, 0) == i + 2 * j + 30);
    }
  }
  LACUNA_CHECK_NEAR(picture->GetFieldData()->GetArray("PixelSize")->GetComponent(0, 1), 0.4, 1e-12);
  LACUNA_CHECK(filter->GetSliceRange()[0] == 0 && filter->GetSliceRange()[1] == 4);

  // a part of the stack: slices keep their numbers
  auto part = vtkSmartPointer<vtkImageData>::New();
  part->ShallowCopy(stack);
  const int extent[6] = { 0, 12, 0, 8, 3, 4 };
  part->Crop(extent);
  filter->SetInputData(part);
  filter->RemoveAllOutlinePoints();
  AddL(filter, 1, 0, 3);
  filter->Update();
  LACUNA_CHECK_NEAR(Norm(GetPoint(filter->GetOutput(), 0) - pose.Point({ 2, 1, 0 })), 0, 1e-12);
  LACUNA_CHECK(filter->GetSliceRange()[0] == 3);

  // every second pixel and slice: places stay those of the contract
  auto strided = vtkSmartPointer<vtkImageData>::New();
  strided->SetDimensions(7, 5, 3);
  strided->SetSpacing(2, 2, 2);
  strided->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  strided->GetFieldData()->ShallowCopy(stack->GetFieldData());
  filter->SetInputData(strided);
  filter->RemoveAllOutlinePoints();
  AddL(filter, 1, 0, 4);
  filter->SetSlice(3); // there are 0, 2 and 4
  filter->Update();
  LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
  LACUNA_CHECK_NEAR(
    Norm(GetPoint(filter->GetOutput(), 0) - MakePoses(5)[4].Point({ 2, 1, 0 })), 0, 1e-12);
  picture = vtkStructuredGrid::SafeDownCast(filter->GetOutputDataObject(1));
  LACUNA_CHECK(picture->GetNumberOfPoints() == 35);
  LACUNA_CHECK(picture->GetFieldData()->GetArray("SliceNumber")->GetComponent(0, 0) == 2);
  LACUNA_CHECK(picture->GetFieldData()->GetArray("PixelStep")->GetComponent(0, 1) == 2);
  LACUNA_CHECK_NEAR(picture->GetFieldData()->GetArray("PixelSize")->GetComponent(0, 0), 1, 1e-12);
  LACUNA_CHECK_NEAR(Norm(GetPoint(picture, 7 + 1) - MakePoses(5)[2].Point({ 2, 2, 0 })), 0, 1e-12);
  filter->SetInputData(part);
  filter->RemoveAllOutlinePoints();
  AddL(filter, 1, 0, 3);

  // smooth: through the same points
  filter->SmoothOn();
  filter->Update();
  vtkDataArray* handle = filter->GetOutput()->GetPointData()->GetArray("Handle");
  int handles = 0;
  for (vtkIdType i = 0; i < handle->GetNumberOfTuples(); ++i)
  {
    if (handle->GetComponent(i, 0) == 1)
    {
      const Vec3 expected = pose.Point({ places[handles][0], places[handles][1], 0 });
      LACUNA_CHECK_NEAR(Norm(GetPoint(filter->GetOutput(), i) - expected), 0, 1e-12);
      ++handles;
    }
  }
  LACUNA_CHECK(handles == 6 && handle->GetNumberOfTuples() == 48);
}

void TestVolume()
{
  vtkNew<vtkImageData> volume;
  volume->SetDimensions(13, 9, 4);
  volume->SetOrigin(-3, 5, 7);
  volume->SetSpacing(0.5, 0.7, 2);
  const double direction[9] = { 0, 0, 1, 1, 0, 0, 0, 1, 0 };
  volume->SetDirectionMatrix(direction);
  volume->AllocateScalars(VTK_SHORT, 1);
  vtkNew<vtkLacunaSliceOutliner> filter;
  filter->SetInputData(volume);
  filter->SmoothOff();
  AddL(filter, 1, 0, 2);
  filter->SetSlice(2);
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
  double expected[3];
  volume->TransformContinuousIndexToPhysicalPoint(9, 3, 2, expected);
  const Vec3 place{ expected[0], expected[1], expected[2] };
  filter->SetVolumeGrid(filter->GetInputGrid());
  filter->Update();
  LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
  LACUNA_CHECK_NEAR(Norm(GetPoint(filter->GetOutput(), 2) - place), 0, 1e-12);

  // finer voxels: the same indices lie elsewhere
  vtkNew<vtkImageData> finer;
  finer->ShallowCopy(volume);
  finer->SetSpacing(0.5, 0.7, 1.5);
  filter->SetInputData(finer);
  filter->Update();
  LACUNA_CHECK_CONTAINS(messages->Errors, "voxels of 0.5 x 0.7 x 2 mm");
}

std::string GetError(
  vtkImageData* stack, const std::function<void(vtkLacunaSliceOutliner*)>& configure)
{
  vtkNew<vtkLacunaSliceOutliner> filter;
  filter->SetInputData(stack);
  configure(filter);
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK_THAT(
    messages->Errors.empty() || filter->GetOutput()->GetNumberOfPoints() == 0, "no half result");
  return messages->Errors;
}

void TestErrors()
{
  const auto stack = MakeStack(5);
  const auto add = [](std::vector<std::vector<double>> points)
  {
    return [points](vtkLacunaSliceOutliner* filter)
    {
      for (const auto& p : points)
      {
        filter->AddOutlinePoint(p[0], p[1], p[2], p[3], p[4]);
      }
    };
  };
  LACUNA_CHECK_CONTAINS(GetError(stack, add({ { 1, 0, 2, 1, 1 }, { 1, 0, 2, 5, 1 } })),
    "outline 0 of Structure 1 in slice 2 has 2 points; it needs at least 3");
  LACUNA_CHECK_CONTAINS(
    GetError(stack, add({ { 1, 0, 2, 1, 1 }, { 1, 0, 3, 5, 1 }, { 1, 0, 2, 5, 5 } })),
    "in one slice");
  LACUNA_CHECK_CONTAINS(
    GetError(stack, add({ { 1, 0, 9, 1, 1 }, { 1, 0, 9, 5, 1 }, { 1, 0, 9, 5, 5 } })),
    "the slices are 0 to 4");
  LACUNA_CHECK_CONTAINS(GetError(stack, add({ { 1.5, 0, 2, 1, 1 } })), "whole numbers");
  LACUNA_CHECK_CONTAINS(GetError(stack, add({ { 1, 0, 2.5, 1, 1 } })), "the slice 2.5");
  LACUNA_CHECK_CONTAINS(GetError(stack,
                          add({ { 1, 0, 2, std::numeric_limits<double>::quiet_NaN(), 1 },
                            { 1, 0, 2, 5, 1 }, { 1, 0, 2, 5, 5 } })),
    "not finite");
  LACUNA_CHECK_CONTAINS(
    GetError(stack,
      add({ { 1, 0, 2, 1, 1 }, { 1, 0, 2, 5, 1 }, { 1, 0, 2, 5, 5 }, { 1, 1, 2, 1, 1 },
        { 1, 1, 2, 5, 1 }, { 1, 1, 2, 5, 5 }, { 1, 0, 2, 7, 7 } })),
    "in two places");
  LACUNA_CHECK_CONTAINS(
    GetError(stack, [](vtkLacunaSliceOutliner* filter) { filter->SetSlice(8); }),
    "Slice 8 is not there");

  vtkNew<vtkImageData> uncalibrated;
  uncalibrated->ShallowCopy(stack);
  uncalibrated->GetFieldData()->RemoveArray("ImageToReference");
  LACUNA_CHECK_CONTAINS(GetError(uncalibrated, [](vtkLacunaSliceOutliner*) {}), "not calibrated");

  // a slice without a pose
  const auto gap = MakeStack(5, { 0, 0, lacuna::TrackedSlices::PoseInvalid, 0, 0 });
  vtkNew<vtkLacunaSliceOutliner> filter;
  filter->SetInputData(gap);
  AddL(filter, 1, 0, 2);
  AddL(filter, 1, 1, 3);
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK(
    messages->Errors.empty() && messages->HasWarning("outline 0 of Structure 1 in slice 2"));
  LACUNA_CHECK(filter->GetOutput()->GetNumberOfLines() == 1);
  filter->SetSlice(2); // no picture, and the outlines all the same
  filter->Update();
  LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
  LACUNA_CHECK(filter->GetOutput()->GetNumberOfLines() == 1);
  auto* none = vtkStructuredGrid::SafeDownCast(filter->GetOutputDataObject(1));
  LACUNA_CHECK(none->GetNumberOfPoints() == 0);
  LACUNA_CHECK(none->GetFieldData()->GetArray("SliceNumber")->GetComponent(0, 0) == 2);

  vtkNew<vtkLacunaSliceOutliner> eight;
  eight->SetInputData(stack);
  eight->SmoothOff();
  add({ { 1, 0, 2, 1, 1 }, { 1, 0, 2, 5, 5 }, { 1, 0, 2, 5, 1 }, { 1, 0, 2, 1, 5 } })(eight);
  const auto warnings = lacunaCheck::Watch(eight);
  eight->Update();
  LACUNA_CHECK(warnings->HasWarning("crosses itself at column 3, row 3"));
}
}

int TestSliceOutliner(int, char*[])
{
  TestTrackedSlices();
  TestVolume();
  TestErrors();
  return lacunaCheck::Result();
}
