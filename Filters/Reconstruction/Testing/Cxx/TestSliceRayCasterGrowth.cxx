// SPDX-License-Identifier: BSD-3-Clause
/// vtkLacunaSliceRayCaster on inputs that grow, are replayed, or move with time; stopped on the
/// way.
#include "lacunaTestCasters.h"
#include "lacunaTestReplay.h"
#include "vtkCallbackCommand.h"
#include "vtkDataArray.h"
#include "vtkMath.h"

#include <cmath>

using lacuna::Matrix4;
using namespace lacunaTestStacks;

namespace
{
void TestGrowingInput()
{
  const std::vector<Matrix4> poses = MakePoses(6);
  const auto first = [&](int count)
  { return std::vector<Matrix4>(poses.begin(), poses.begin() + count); };
  vtkNew<Caster> caster;
  FixView(caster);
  const auto update = [&](vtkImageData* stack)
  {
    caster->SetInputData(stack);
    caster->Update();
    LACUNA_CHECK(IsSame(caster->GetOutput(), CastAfresh(stack)));
    return caster->GetNumberOfCastSlices();
  };
  LACUNA_CHECK(update(MakeStack(first(2))) == 2);
  LACUNA_CHECK(update(MakeStack(first(3))) == 1);
  LACUNA_CHECK(update(MakeStack(first(3))) == 0);
  LACUNA_CHECK(update(MakeStack(first(6))) == 3);
  // the same memory with new slices in it, as a live source may have it
  const auto stack = MakeStack(first(6));
  update(stack);
  stack->GetPointData()->GetScalars()->SetTuple1(5 * 13 * 9 + 13 * 4 + 6, 0);
  stack->GetPointData()->GetScalars()->Modified();
  stack->Modified();
  LACUNA_CHECK_THAT(update(stack) == 6, "an old slice has changed");
  LACUNA_CHECK(update(MakeStack(first(4))) == 4);
  std::vector<Matrix4> moved = first(6);
  moved[1](2, 3) += 1e-6;
  LACUNA_CHECK(update(MakeStack(moved)) == 6);
  LACUNA_CHECK_THAT(update(MakeStack(moved, VTK_SHORT)) == 6, "another type");
  // a slice that was left out counts: the rest is not what it was
  LACUNA_CHECK(update(MakeStack(moved, VTK_SHORT, { 0, 8, 0, 0, 0, 0 })) == 5);

  // a new slice in front of what was solid, and with it an old one comes to count again, whose
  // pixels are no longer where they were
  std::vector<Matrix4> tangled;
  for (const double height : { 0.0, 2.0, 4.0, 1.0 })
  {
    tangled.push_back(Matrix4::Translation({ 0, 0, height }) * poses[0]);
  }
  const auto paint = [](vtkImageData* slices, int slice, double grey)
  {
    for (vtkIdType i = 0; i < 13 * 9; ++i)
    {
      slices->GetPointData()->GetScalars()->SetTuple1(slice * 13 * 9 + i, grey);
    }
  };
  const auto old = MakeStack({ tangled.begin(), tangled.end() - 1 });
  paint(old, 0, 10);
  paint(old, 1, 20);
  paint(old, 2, 100);
  LACUNA_CHECK(update(old) == 3);
  const auto grown = MakeStack(tangled);
  paint(grown, 0, 10);
  paint(grown, 1, 20);
  paint(grown, 2, 100);
  paint(grown, 3, 50);
  for (const int slice : { 0, 1, 2 })
  {
    paint(old, slice, 255);
  }
  LACUNA_CHECK(update(grown) == 1);
  LACUNA_CHECK_NEAR(GetValue(caster->GetOutput(), "Depth", 8, 6, 0), 0.5, 1e-12);

  // what does not change the casting
  update(MakeStack(MakePoses(5)));
  caster->SetMaximumGap(0.5);
  caster->Update();
  LACUNA_CHECK(caster->GetNumberOfCastSlices() == 0);
  caster->SetIsoValue(31);
  caster->Update();
  LACUNA_CHECK(caster->GetNumberOfCastSlices() == 5);
  caster->SetSolidSide(Caster::Below);
  caster->Update();
  LACUNA_CHECK(caster->GetNumberOfCastSlices() == 5);
  caster->SetViewUp(0, 1, 0);
  caster->Update();
  LACUNA_CHECK(caster->GetNumberOfCastSlices() == 5);
  caster->SetClipRectangle(1, 0, 0, 0);
  caster->Update();
  LACUNA_CHECK(caster->GetNumberOfCastSlices() == 5);

  // a map that follows the slices is laid out anew
  caster->SetFocalPoint(VTK_DOUBLE_MAX, VTK_DOUBLE_MAX, VTK_DOUBLE_MAX);
  caster->SetInputData(MakeStack(MakePoses(2)));
  caster->Update();
  std::vector<Matrix4> wider = MakePoses(3);
  wider[2](0, 3) += 5;
  caster->SetInputData(MakeStack(wider));
  caster->Update();
  LACUNA_CHECK(caster->GetNumberOfCastSlices() == 3);
}

// What is old is not looked at again: only casting tells whether there is a surface. VTK keeps the
// range of an array that was asked for it.
bool IsRangeKnown(vtkImageData* stack)
{
  vtkDataArray* levels = stack->GetPointData()->GetScalars();
  return levels->HasInformation() &&
    (levels->GetInformation()->Has(vtkDataArray::PER_FINITE_COMPONENT()) ||
      levels->GetInformation()->Has(vtkDataArray::PER_COMPONENT()));
}

void TestNoPassOverAllPixels()
{
  vtkNew<Caster> caster;
  FixView(caster);
  const auto messages = lacunaCheck::Watch(caster);
  const std::vector<Matrix4> poses = MakePoses(6);
  for (const double isoValue : { 30.0, 90.0, 1000.0 })
  {
    caster->SetIsoValue(isoValue);
    messages->Warnings.clear();
    for (int count = 2; count <= 6; ++count)
    {
      const auto stack = MakeStack({ poses.begin(), poses.begin() + count });
      caster->SetInputData(stack);
      caster->Update();
      LACUNA_CHECK_THAT(!IsRangeKnown(stack), "range of all at " + std::to_string(isoValue));
    }
  }
  // what a live source has shown when the warning comes, and that it comes once
  LACUNA_CHECK_CONTAINS(messages->Warnings,
    "IsoValue 1000 lies outside the grey levels of the slices, which range from 0 to 38: ");
  LACUNA_CHECK(messages->Warnings.find("IsoValue") == messages->Warnings.rfind("IsoValue"));
}

// Slices are counted with those of before.
void TestRangeGrows()
{
  vtkNew<Caster> caster;
  FixView(caster);
  caster->SetIsoValue(70);
  const auto messages = lacunaCheck::Watch(caster);
  const std::vector<Matrix4> poses = MakePoses(6);
  const auto update = [&](int count)
  {
    messages->Warnings.clear();
    caster->SetInputData(MakeStack({ poses.begin(), poses.begin() + count }));
    caster->Update();
    return messages->Warnings;
  };
  LACUNA_CHECK_CONTAINS(update(2), "which range from 0 to 38");
  caster->SetIsoValue(71);
  LACUNA_CHECK_CONTAINS(update(3), "which range from 0 to 48");
  LACUNA_CHECK_THAT(update(6).empty(), "now there is a surface");
}

// Slices that are still to come are not taken as black ones, and what has been said is not
// repeated.
void TestReplay()
{
  vtkNew<Replay> replay;
  replay->Show = [](int shown)
  {
    std::vector<unsigned char> status(6, 0);
    std::fill(status.begin() + shown, status.end(), lacuna::TrackedSlices::ImageInvalid);
    return MakeStack(MakePoses(6), VTK_UNSIGNED_CHAR, status);
  };
  vtkNew<Caster> caster;
  LookAlong(caster);
  caster->UseImageInvalidOn();
  caster->SetSolidSide(Caster::Below);
  caster->SetInputConnection(replay->GetOutputPort());
  for (int k = 0; k < 6; ++k)
  {
    caster->UpdateTimeStep(k);
    LACUNA_CHECK_THAT(caster->GetNumberOfCastSlices() == 1, "slices at " + std::to_string(k));
  }
  // none at all: an error of the whole sweep alone
  vtkNew<Caster> blind;
  replay->Show = [](int)
  { return MakeStack(MakePoses(6), VTK_UNSIGNED_CHAR, std::vector<unsigned char>(6, 2)); };
  replay->Modified();
  blind->SetInputConnection(replay->GetOutputPort());
  const auto messages = lacunaCheck::Watch(blind);
  blind->UpdateTimeStep(5);
  LACUNA_CHECK_CONTAINS(messages->Errors, "no slice is left to look at");
}

// Of the first slices of a live sweep nothing can be seen yet, which is no error.
void TestLiveBeginning()
{
  vtkNew<Caster> caster;
  FixView(caster);
  const auto messages = lacunaCheck::Watch(caster);
  const auto flagged = MakeStack(MakePoses(2), VTK_SHORT, { 1, 1 });
  lacuna::TrackedSlices::MarkAsGrowing(flagged);
  caster->SetInputData(flagged);
  caster->Update();
  LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
  LACUNA_CHECK(caster->GetOutput()->GetNumberOfPoints() == 0);
  flagged->GetFieldData()->RemoveArray(lacuna::TrackedSlices::GrowingName);
  caster->Modified();
  caster->Update();
  LACUNA_CHECK_CONTAINS(messages->Errors, "no slice is left to look at");
}

void TestWarnings()
{
  vtkNew<Caster> caster;
  FixView(caster);
  caster->SetIsoValue(1000);
  caster->SetBadPoses(Caster::LeaveOut);
  const auto update = [&](int count, int bad)
  {
    std::vector<Matrix4> poses = MakePoses(count);
    poses[bad](0, 0) = std::nan("");
    poses[1] = poses[1] * Matrix4::Rotation({ 0, 1, 0 }, 0.5 * vtkMath::Pi());
    poses.back() = poses[1];
    const auto messages = lacunaCheck::Watch(caster);
    caster->SetInputData(MakeStack(poses));
    caster->Update();
    caster->RemoveAllObservers();
    caster->GetExecutive()->RemoveAllObservers();
    LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
    return messages->Warnings;
  };
  const std::string first = update(6, 2);
  LACUNA_CHECK_CONTAINS(first, "slice 2");
  LACUNA_CHECK_CONTAINS(first, "edge-on");
  LACUNA_CHECK_CONTAINS(first, "IsoValue 1000");
  LACUNA_CHECK_THAT(update(7, 2).empty(), "nothing new");
  const std::string second = update(8, 4);
  LACUNA_CHECK_THAT(Contains(second, "slice 4") && !Contains(second, "edge-on"), second);
  caster->SetIsoValue(2000);
  LACUNA_CHECK_CONTAINS(update(8, 4), "IsoValue 2000");
}

vtkSmartPointer<vtkImageData> MovingStack(double time)
{
  return MakeStack(MakePoses(5, time), VTK_SHORT);
}

// Slices that stand still, of which the one at the time and all later ones are still to come.
vtkSmartPointer<vtkImageData> ReplayedStack(double time)
{
  std::vector<unsigned char> status(5, 0);
  for (int slice = 0; slice < 5; ++slice)
  {
    status[slice] = slice < time ? 0 : 2;
  }
  const auto stack = MakeStack(MakePoses(5, 0), VTK_SHORT, status);
  for (vtkIdType i = 0; i < stack->GetNumberOfPoints(); ++i)
  {
    if (status[i / (13 * 9)] != 0)
    {
      stack->GetPointData()->GetScalars()->SetTuple1(i, 0);
    }
  }
  return stack;
}

void TestPipeline()
{
  vtkNew<SliceSource> source;
  source->Show = MovingStack;
  vtkNew<Caster> caster;
  LookAlong(caster);
  caster->SetInputConnection(source->GetOutputPort());
  caster->UpdateInformation();
  int whole[6];
  caster->GetOutputInformation(0)->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole);
  LACUNA_CHECK_THAT(
    whole[1] == 12 && whole[3] == 8 && whole[5] == 0, "whole extent before the data");
  caster->Update();
  caster->SetMaximumGap(3);
  caster->Update();
  LACUNA_CHECK(source->Executions == 1);
  source->Modified();
  caster->Update();
  LACUNA_CHECK(source->Executions == 2);

  // a source that moves with time; the map goes with it
  vtkNew<SliceSource> moving;
  moving->Show = MovingStack;
  moving->HasTime = true;
  caster->SetInputConnection(moving->GetOutputPort());
  for (const double time : { 0.0, 100.0, 0.0 })
  {
    caster->UpdateTimeStep(time);
    LACUNA_CHECK_NEAR(caster->GetOutput()->GetOrigin()[2], time, 1e-9);
    LACUNA_CHECK_NEAR(GetValue(caster->GetOutput(), "Depth", 6, 4, 0), 1.6, 1e-9);
  }

  // slices that come with time: the map is that of the whole sweep from the beginning
  vtkNew<SliceSource> replay;
  replay->Show = ReplayedStack;
  replay->HasTime = true;
  vtkNew<Caster> watching;
  LookAlong(watching);
  watching->SetInputConnection(replay->GetOutputPort());
  const auto messages = lacunaCheck::Watch(watching);
  for (const int time : { 0, 1, 2, 3, 5 })
  {
    watching->UpdateTimeStep(time);
    vtkImageData* map = watching->GetOutput();
    LACUNA_CHECK(map->GetNumberOfPoints() == 13 * 9);
    LACUNA_CHECK(watching->GetNumberOfCastSlices() == (time == 5 ? 2 : time == 0 ? 0 : 1));
    // grey = 14 + 10 z at column 6 of row 4
    LACUNA_CHECK(std::isnan(GetValue(map, "Depth", 6, 4, 0)) == (time < 3));
  }
  LACUNA_CHECK_NEAR(GetValue(watching->GetOutput(), "Depth", 6, 4, 0), 1.6, 1e-12);
  watching->UpdateTimeStep(2);
  LACUNA_CHECK_THAT(watching->GetNumberOfCastSlices() == 2, "back in time all is cast anew");
  LACUNA_CHECK_THAT(messages->Errors.empty() && messages->Warnings.empty(),
    "nothing to say of slices that are still to come: " + messages->Errors + messages->Warnings);

  // stopped by the user, and then not
  vtkNew<Caster> stopped;
  LookAlong(stopped);
  stopped->SetInputData(MakeStack(MakePoses(5)));
  stopped->SetPixelSpacing(0.01);
  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback([](vtkObject* object, unsigned long, void*, void*)
    { vtkAlgorithm::SafeDownCast(object)->SetAbortExecute(1); });
  const unsigned long tag = stopped->AddObserver(vtkCommand::ProgressEvent, stop);
  stopped->Update();
  LACUNA_CHECK_THAT(stopped->GetOutput()->GetNumberOfPoints() == 0, "nothing is left when stopped");
  stopped->RemoveObserver(tag);
  stopped->SetAbortExecute(0);
  stopped->Modified();
  stopped->Update();
  LACUNA_CHECK_NEAR(GetValue(stopped->GetOutput(), "Depth", 300, 200, 0), 1.6, 1e-9);
}
}

int TestSliceRayCasterGrowth(int, char*[])
{
  TestGrowingInput();
  TestNoPassOverAllPixels();
  TestRangeGrows();
  TestReplay();
  TestLiveBeginning();
  TestWarnings();
  TestPipeline();
  return lacunaCheck::Result();
}
