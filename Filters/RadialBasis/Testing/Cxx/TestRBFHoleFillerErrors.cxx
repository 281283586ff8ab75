// SPDX-License-Identifier: BSD-3-Clause
// Bad input: an error or warning that says what is wrong, and no half result.
#include "RBFTestMaps.h"
#include "lacunaCheck.h"
#include "vtkCallbackCommand.h"
#include "vtkLacunaFieldData.h"
#include "vtkLacunaRBFHoleFiller.h"
#include "vtkSphere.h"

#include <functional>
#include <iostream>

namespace
{
struct Case
{
  const char* Name;
  std::function<void(TestMap&, vtkLacunaRBFHoleFiller*)> Spoil;
  const char* Expected;
};

void InvalidateAll(TestMap& map, const std::function<bool(vtkIdType)>& keep)
{
  for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
  {
    if (!keep(i))
    {
      map.Invalidate(i);
    }
  }
}

const Case Errors[] = {
  { "not a depth map",
    [](TestMap& map, vtkLacunaRBFHoleFiller*) { map.Image->GetPointData()->RemoveArray("Depth"); },
    "'Depth'" },
  { "direction reset by another filter",
    [](TestMap& map, vtkLacunaRBFHoleFiller*)
    { map.Image->SetDirectionMatrix(1, 0, 0, 0, 1, 0, 0, 0, 1); },
    "disagrees" },
  { "perspective map",
    [](TestMap& map, vtkLacunaRBFHoleFiller*) {
      vtkLacunaFieldData::Set(map.Image, "EyePosition", { 0, 0, -500 }, 3);
    },
    "perspective" },
  { "no depth at all",
    [](TestMap& map, vtkLacunaRBFHoleFiller*)
    { InvalidateAll(map, [](vtkIdType) { return false; }); },
    "no pixel of the depth map has a depth" },
  { "missing array",
    [](TestMap&, vtkLacunaRBFHoleFiller* filler) { filler->SetDefectArray("nowhere"); },
    "'nowhere' with one component; it has 'Depth', 'vtkValidPointMask'" },
  { "array of vectors",
    [](TestMap&, vtkLacunaRBFHoleFiller* filler) { filler->SetSupportArray("Normals"); },
    "SupportArray" },
  { "kernel", [](TestMap&, vtkLacunaRBFHoleFiller* filler) { filler->SetKernel(2); },
    "Kernel is 2" },
  { "margin", [](TestMap&, vtkLacunaRBFHoleFiller* filler) { filler->SetSupportMargin(-12); },
    "SupportMargin is -12" },
  { "spacing", [](TestMap&, vtkLacunaRBFHoleFiller* filler) { filler->SetNodeSpacing(0); },
    "NodeSpacing is 0" },
  { "output margin", [](TestMap&, vtkLacunaRBFHoleFiller* filler) { filler->SetOutputMargin(-1); },
    "OutputMargin is -1" },
  { "smoothing", [](TestMap&, vtkLacunaRBFHoleFiller* filler) { filler->SetSmoothing(-1); },
    "Smoothing" },
  { "no support",
    [](TestMap& map, vtkLacunaRBFHoleFiller*)
    { InvalidateAll(map, [&](vtkIdType i) { return map.IsInDisc(i, 5); }); },
    "raise SupportMargin" },
  { "two nodes",
    [](TestMap& map, vtkLacunaRBFHoleFiller*)
    { InvalidateAll(map, [](vtkIdType i) { return i == 0 || i == 30 * 80 + 20; }); },
    "at least 3" },
  { "collinear nodes",
    [](TestMap& map, vtkLacunaRBFHoleFiller*)
    { InvalidateAll(map, [](vtkIdType i) { return i / 80 == 12; }); },
    "one line" },
};
}

int TestRBFHoleFillerErrors(int, char*[])
{
  for (const Case& c : Errors)
  {
    std::cout << c.Name << std::endl;
    TestMap map;
    vtkNew<vtkSphere> sphere;
    sphere->SetCenter(map.GetSurfacePoint(45, 42).data());
    sphere->SetRadius(6);
    vtkNew<vtkLacunaRBFHoleFiller> filler;
    filler->SetInputData(map.Image);
    filler->SetDefectRegion(sphere);
    filler->SetSupportMargin(30);
    c.Spoil(map, filler);
    const auto messages = lacunaCheck::Watch(filler);
    filler->Update();
    LACUNA_CHECK(messages->HasError(c.Expected));
    LACUNA_CHECK(filler->GetOutput()->GetNumberOfPoints() == 0);
  }

  {
    // so many nodes that their matrix would exceed the limit: said before anything is allocated
    vtkNew<vtkImageData> large;
    large->SetDimensions(220, 180, 1);
    vtkLacunaDepthMap::SetGeometry(
      large, { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 1, 1 } });
    vtkNew<vtkDoubleArray> depth;
    depth->SetName("Depth");
    depth->SetNumberOfTuples(large->GetNumberOfPoints());
    depth->Fill(10);
    depth->SetValue(90 * 220 + 110, std::nan(""));
    large->GetPointData()->AddArray(depth); // no mask: NaN alone marks what has no depth
    vtkNew<vtkLacunaRBFHoleFiller> filler;
    filler->SetInputData(large);
    filler->SetSupportMargin(1000);
    const auto messages = lacunaCheck::Watch(filler);
    filler->Update();
    LACUNA_CHECK(messages->HasError("39587 nodes need a matrix of 12538944800 bytes") &&
      messages->HasError("raise NodeSpacing"));
    filler->SetNodeSpacing(10);
    filler->Update();
    LACUNA_CHECK(
      filler->GetOutput()->GetPointData()->GetArray("Depth")->GetTuple1(90 * 220 + 110) > 9.999);
  }
  {
    // flagged valid without a depth
    TestMap map;
    map.Image->GetPointData()->GetArray("Depth")->SetTuple1(30 * 80 + 30, HUGE_VAL);
    map.Image->GetPointData()->GetArray("Depth")->SetTuple1(31 * 80 + 30, std::nan(""));
    vtkNew<vtkLacunaRBFHoleFiller> filler;
    filler->SetInputData(map.Image);
    const auto messages = lacunaCheck::Watch(filler);
    filler->Update();
    LACUNA_CHECK(messages->HasWarning("2 pixels of the depth map are flagged valid"));
    LACUNA_CHECK(
      filler->GetOutput()->GetPointData()->GetArray("FilledMask")->GetTuple1(30 * 80 + 30) == 1);
  }
  {
    // nothing to fill
    TestMap map;
    vtkNew<vtkLacunaRBFHoleFiller> filler;
    filler->SetInputData(map.Image);
    const auto messages = lacunaCheck::Watch(filler);
    filler->Update();
    LACUNA_CHECK(messages->HasWarning("the defect is empty"));
    vtkPointData* points = filler->GetOutput()->GetPointData();
    for (vtkIdType i = 0; i < map.Image->GetNumberOfPoints(); ++i)
    {
      LACUNA_CHECK(points->GetArray("Depth")->GetTuple1(i) ==
        map.Image->GetPointData()->GetArray("Depth")->GetTuple1(i));
      LACUNA_CHECK(points->GetArray("FilledMask")->GetTuple1(i) == 0);
      LACUNA_CHECK(std::isnan(points->GetArray("Fitted")->GetTuple1(i)));
      LACUNA_CHECK(std::isnan(points->GetArray("Deviation")->GetTuple1(i)));
    }
  }
  {
    // an empty image is no error
    vtkNew<vtkImageData> empty;
    vtkNew<vtkLacunaRBFHoleFiller> filler;
    filler->SetInputData(empty);
    const auto messages = lacunaCheck::Watch(filler);
    filler->Update();
    LACUNA_CHECK(messages->Errors.empty() && messages->Warnings.empty());
  }
  {
    // stopped by the user: no half result
    TestMap map;
    vtkNew<vtkSphere> sphere;
    sphere->SetCenter(map.GetSurfacePoint(45, 42).data());
    sphere->SetRadius(6);
    vtkNew<vtkLacunaRBFHoleFiller> filler;
    filler->SetInputData(map.Image);
    filler->SetDefectRegion(sphere);
    vtkNew<vtkCallbackCommand> stop;
    stop->SetCallback([](vtkObject* caller, unsigned long, void*, void*)
      { static_cast<vtkAlgorithm*>(caller)->SetAbortExecute(1); });
    filler->AddObserver(vtkCommand::ProgressEvent, stop);
    filler->Update();
    LACUNA_CHECK(filler->GetOutput()->GetNumberOfPoints() == 0);
  }
  return lacunaCheck::Result();
}
