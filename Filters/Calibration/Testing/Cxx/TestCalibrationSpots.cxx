// SPDX-License-Identifier: BSD-3-Clause
/// Spots found by vtkLacunaProbeCalibration: crops, flags, threads, given picks, what cannot be.
#include "lacunaCheck.h"
#include "lacunaFieldData.h"
#include "lacunaTrackedSlices.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkLacunaProbeCalibration.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSMPTools.h"
#include "vtkSmartPointer.h"
#include "vtkTable.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

using lacuna::Matrix4;
using lacuna::Vec2;

namespace
{
constexpr int Width = 120;
constexpr int Height = 100;
constexpr int Slices = 30;
constexpr double Spacing = 0.5;

Vec2 GetPixel(int n)
{
  return { 60 + 40 * std::sin(0.9 * n), 55 + 30 * std::cos(0.5 * n) };
}

// A small ball that does not move, seen from all sides.
vtkSmartPointer<vtkImageData> MakeStack(const std::vector<int>& withoutImage = {})
{
  auto stack = vtkSmartPointer<vtkImageData>::New();
  stack->SetDimensions(Width, Height, Slices);
  stack->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  auto* pixel = static_cast<unsigned char*>(stack->GetScalarPointer());
  std::mt19937 random(1);
  std::vector<Matrix4> poses;
  vtkNew<vtkUnsignedCharArray> status;
  status->SetName(lacuna::TrackedSlices::SliceStatusName);
  const Matrix4 probeToScan =
    Matrix4::Rotation({ 1, 2, 0 }, -1) * Matrix4::Translation({ -20, 50, -90 });
  for (int n = 0; n < Slices; ++n)
  {
    const Vec2 spot = GetPixel(n);
    for (int row = 0; row < Height; ++row)
    {
      for (int column = 0; column < Width; ++column)
      {
        const double x = (column - spot[0]) / 2, y = (row - spot[1]) / 1.3;
        *pixel++ =
          static_cast<unsigned char>(random() % 20 + 220 * std::exp(-0.5 * (x * x + y * y)));
      }
    }
    const Matrix4 turn = Matrix4::Rotation({ 1, 0, 0 }, std::sin(1.3 * n)) *
      Matrix4::Rotation({ 0, 1, 0 }, std::cos(0.7 * n)) * Matrix4::Rotation({ 0, 0, 1 }, 0.8 * n);
    poses.push_back(Matrix4::Translation({ 5, 6, 7 }) * turn *
      Matrix4::Translation({ -Spacing * spot[0], -Spacing * spot[1], 0 }) * probeToScan);
    status->InsertNextValue(std::count(withoutImage.begin(), withoutImage.end(), n) > 0
        ? lacuna::TrackedSlices::ImageInvalid
        : 0);
  }
  lacuna::FieldData::SetMatrices(stack, "ProbeToTracker", poses);
  stack->GetFieldData()->AddArray(status);
  return stack;
}

vtkSmartPointer<vtkLacunaProbeCalibration> Make(
  vtkDataObject* stack, vtkDataObject* picks = nullptr)
{
  auto filter = vtkSmartPointer<vtkLacunaProbeCalibration>::New();
  filter->SetInputDataObject(0, stack);
  if (picks)
  {
    filter->SetInputDataObject(1, picks);
  }
  filter->SetMethodToPointTarget();
  filter->SetPixelSpacing(Spacing);
  return filter;
}

vtkTable* GetTable(vtkLacunaProbeCalibration* filter)
{
  filter->Update();
  return vtkTable::SafeDownCast(filter->GetOutputDataObject(1));
}

double Get(vtkTable* table, const char* name, vtkIdType row)
{
  return vtkDataArray::SafeDownCast(table->GetColumnByName(name))->GetTuple1(row);
}

std::string GetError(vtkLacunaProbeCalibration* filter)
{
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  return messages->Errors;
}

void TestSpots()
{
  const auto stack = MakeStack();
  const auto filter = Make(stack);
  vtkTable* table = GetTable(filter);
  LACUNA_CHECK(table->GetNumberOfRows() == Slices);
  for (vtkIdType row = 0; row < table->GetNumberOfRows(); ++row)
  {
    const Vec2 truth = GetPixel(static_cast<int>(Get(table, "Slice", row)));
    LACUNA_CHECK_NEAR(Get(table, "Column", row), truth[0], 0.25);
    LACUNA_CHECK_NEAR(Get(table, "Row", row), truth[1], 0.25);
    LACUNA_CHECK_NEAR(Get(table, "Error", row), 0, 0.3);
    LACUNA_CHECK(Get(table, "Score", row) > 0.5 && Get(table, "Score", row) <= 1);
  }
  auto* marks = vtkPolyData::SafeDownCast(filter->GetOutputDataObject(4));
  LACUNA_CHECK(marks->GetNumberOfVerts() == Slices);
  LACUNA_CHECK_NEAR(marks->GetPoint(7)[2], 7, 0);
  LACUNA_CHECK_NEAR(marks->GetPoint(7)[0], GetPixel(7)[0], 0.25);

  // pixels and slices keep their numbers in a part of the stack
  vtkNew<vtkImageData> cropped;
  cropped->DeepCopy(stack);
  const int extent[6] = { 10, Width - 1, 15, Height - 2, 4, Slices - 1 };
  cropped->Crop(extent);
  const auto ofPart = Make(cropped);
  vtkTable* partTable = GetTable(ofPart);
  LACUNA_CHECK(partTable->GetNumberOfRows() == Slices - 4);
  for (vtkIdType row = 0; row < partTable->GetNumberOfRows(); ++row)
  {
    LACUNA_CHECK_NEAR(Get(partTable, "Slice", row), row + 4, 0);
    LACUNA_CHECK_NEAR(Get(partTable, "Column", row), Get(table, "Column", row + 4), 0.02);
    LACUNA_CHECK_NEAR(Get(partTable, "Row", row), Get(table, "Row", row + 4), 0.02);
  }
  // slices without an image have no spot
  const auto flagged = Make(MakeStack({ 3, 8 }));
  LACUNA_CHECK(GetTable(flagged)->GetNumberOfRows() == Slices - 2);
}

void TestThreads()
{
  const auto stack = MakeStack();
  const auto whole = Make(stack);
  vtkTable* expected = GetTable(whole);
  for (const int threads : { 1, 2, 5 })
  {
    const auto filter = Make(stack);
    vtkSMPTools::LocalScope(
      vtkSMPTools::Config{ threads, std::string("STDThread"), false }, [&] { filter->Update(); });
    vtkTable* table = vtkTable::SafeDownCast(filter->GetOutputDataObject(1));
    LACUNA_CHECK(table->GetNumberOfRows() == expected->GetNumberOfRows());
    for (vtkIdType row = 0; row < table->GetNumberOfRows(); ++row)
    {
      for (const char* name : { "Column", "Row", "Score", "PhantomX" })
      {
        LACUNA_CHECK(Get(table, name, row) == Get(expected, name, row));
      }
    }
  }
}

void TestGivenPoints()
{
  vtkNew<vtkPolyData> picks;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (int n = 0; n < Slices; n += 2)
  {
    points->InsertNextPoint(GetPixel(n)[0], GetPixel(n)[1], n + 0.2);
  }
  picks->SetPoints(points);
  const auto filter = Make(MakeStack(), picks);
  vtkTable* table = GetTable(filter);
  LACUNA_CHECK(table->GetNumberOfRows() == Slices / 2); // no others are looked for
  LACUNA_CHECK_NEAR(Get(table, "Error", 3), 0, 1e-6);
  LACUNA_CHECK_NEAR(Get(table, "Slice", 3), 6, 0);
  LACUNA_CHECK_NEAR(Get(table, "Score", 3), 1, 0);

  points->InsertNextPoint(1, 1, Slices);
  picks->Modified();
  LACUNA_CHECK_CONTAINS(GetError(Make(MakeStack(), picks)), "point 15 of the picks is of slice 30");
}

void TestErrors()
{
  auto filter = Make(MakeStack());
  filter->FindSpotsOff();
  LACUNA_CHECK_CONTAINS(GetError(filter), "FindSpots is off");
  auto black = MakeStack();
  black->GetPointData()->GetScalars()->Fill(0);
  LACUNA_CHECK_CONTAINS(GetError(Make(black)), "no slice shows a bright spot");
  auto colours = MakeStack();
  vtkNew<vtkUnsignedCharArray> rgb;
  rgb->SetNumberOfComponents(3);
  rgb->SetNumberOfTuples(colours->GetNumberOfPoints());
  rgb->Fill(7);
  colours->GetPointData()->SetScalars(rgb);
  LACUNA_CHECK_CONTAINS(GetError(Make(colours)), "grey levels are needed to look for");
  filter = Make(MakeStack());
  filter->SetMethodToThreeWires();
  LACUNA_CHECK_CONTAINS(GetError(filter), "neither picks (second input) nor WireRanges");
  filter->SetWireRanges("X 0-5, Y 4");
  LACUNA_CHECK_CONTAINS(GetError(filter), "only one wire can be followed");
}
}

int TestCalibrationSpots(int, char*[])
{
  TestSpots();
  TestThreads();
  TestGivenPoints();
  TestErrors();
  return lacunaCheck::Result();
}
