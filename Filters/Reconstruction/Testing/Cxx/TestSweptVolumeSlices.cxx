// SPDX-License-Identifier: BSD-3-Clause
/// Which slices vtkLacunaSweptVolume takes: status, flags taken by choice, bad poses.
#include "lacunaProvenance.h"
#include "lacunaTestStacks.h"
#include "vtkFieldData.h"
#include "vtkIntArray.h"

#include <limits>

using lacuna::Matrix4;
using namespace lacunaTestStacks;

namespace
{
constexpr double NotANumber = std::numeric_limits<double>::quiet_NaN();

// Grey level at column 6, row 4 and the given height above slice 0; -1 where there is none.
double GetGrey(vtkLacunaSweptVolume* filter, double height)
{
  filter->SetOutputSpacing(0.5, 0.5, 0.5);
  filter->SetOutputBounds(10, 16, 20, 24, 0, 4);
  filter->Update();
  vtkImageData* volume = filter->GetOutput();
  const int k = static_cast<int>(2 * height);
  return GetValue(volume, "vtkValidPointMask", 6, 4, k) == 1
    ? GetValue(volume, "Intensity", 6, 4, k)
    : -1;
}

// Slice 2 alone is 100 grey levels too bright.
vtkSmartPointer<vtkImageData> MakeMarkedStack(
  const std::vector<Matrix4>& poses, const std::vector<unsigned char>& status = {})
{
  vtkSmartPointer<vtkImageData> stack = MakeStack(poses, VTK_SHORT, status);
  for (int j = 0; j < 9; ++j)
  {
    for (int i = 0; i < 13; ++i)
    {
      stack->SetScalarComponentFromDouble(
        i, j, 2, 0, 100 + stack->GetScalarComponentAsDouble(i, j, 2, 0));
    }
  }
  return stack;
}

void TestStatus()
{
  // The middle slice is garbage and marked; its pose is not even a number.
  std::vector<Matrix4> poses = MakePoses(5);
  poses[2](0, 3) = NotANumber;
  vtkNew<vtkLacunaSweptVolume> filter;
  filter->SetInputData(MakeMarkedStack(poses, { 0, 0, 1, 0, 0 }));
  LACUNA_CHECK_THAT(GetGrey(filter, 2) == 34, "its neighbours form the pair");
  filter->SetMaximumSliceGap(1.5);
  LACUNA_CHECK_THAT(GetGrey(filter, 2) == -1, "unless too far apart");
  LACUNA_CHECK_THAT(GetGrey(filter, 0.5) == 19, "others stay");
}

void TestFlagsTakenByChoice()
{
  using Setter = void (vtkLacunaSweptVolume::*)();
  const Setter setters[] = { &vtkLacunaSweptVolume::UseImageInvalidOn,
    &vtkLacunaSweptVolume::UseTooFastOn, &vtkLacunaSweptVolume::UseGatedOutOn };
  for (int choices = 0; choices < 8; ++choices)
  {
    for (int flags = 0; flags < 16; ++flags)
    {
      vtkNew<vtkLacunaSweptVolume> filter;
      const auto status = static_cast<unsigned char>(flags);
      filter->SetInputData(MakeMarkedStack(MakePoses(5), { 0, 0, status, 0, 0 }));
      int accepted = 0;
      for (int c = 0; c < 3; ++c)
      {
        if ((choices >> c) & 1)
        {
          const Setter set = setters[c]; // at once GCC 12's sanitizer takes another c
          (filter->*set)();
          accepted |= 2 << c;
        }
      }
      const bool isTaken = (flags & ~accepted) == 0; // a pose that is invalid never is
      LACUNA_CHECK_THAT(GetGrey(filter, 2) == (isTaken ? 134 : 34),
        "status " + std::to_string(flags) + ", accepted " + std::to_string(accepted));
    }
  }
  // unknown flags do not become known ones
  vtkNew<vtkLacunaSweptVolume> filter;
  filter->SetInputData(MakeMarkedStack(MakePoses(5), { 0, 0, 64, 0, 0 }));
  filter->UseImageInvalidOn();
  filter->UseTooFastOn();
  filter->UseGatedOutOn();
  LACUNA_CHECK_THAT(GetGrey(filter, 2) == 34, "a flag of the future");
  LACUNA_CHECK_CONTAINS(lacuna::Provenance::Get(filter->GetOutput()).back(),
    "UseImageInvalid=on UseTooFast=on UseGatedOut=on BadPoses=Refuse");
}

void TestTooFew()
{
  LACUNA_CHECK_CONTAINS(GetError(MakeStack(MakePoses(1))), "too few: 1 of 1 can be used");
  const std::string few = GetError(MakeStack(MakePoses(4), VTK_SHORT, { 1, 0, 2, 12 }));
  LACUNA_CHECK_CONTAINS(few, "1 of 4 can be used, at least 2 are needed");
  LACUNA_CHECK_CONTAINS(few,
    "3 of 4 are flagged in SliceStatus: 1 pose invalid (1), 1 image invalid (2), 1 too fast (4), 1 "
    "gated out (8)");
  LACUNA_CHECK_CONTAINS(
    GetError(MakeStack(MakePoses(4), VTK_SHORT, { 1, 1, 1, 1 })), "4 pose invalid (1)");
  LACUNA_CHECK_THAT(GetError(MakeStack(MakePoses(1)),
                      [](vtkLacunaSweptVolume* f) { f->SetInterpolationToNearestVoxel(); })
                      .empty(),
    "one slice is enough for NearestVoxel");
  LACUNA_CHECK_CONTAINS(
    GetError(MakeStack(std::vector<Matrix4>(5, MakePoses(1)[0]))), "in the same plane");
  std::vector<Matrix4> poses(4, MakePoses(1)[0]);
  poses[0](0, 0) = NotANumber;
  poses[1](0, 0) = NotANumber;
  poses[2](0, 0) = NotANumber;
  LACUNA_CHECK_CONTAINS(
    GetError(MakeStack(poses), [](vtkLacunaSweptVolume* f) { f->SetBadPosesToLeaveOut(); }),
    "0 of 4 are flagged in SliceStatus; 3 have bad poses");
}

// A probe that stands still for a moment changes nothing.
void TestIdenticalPoses()
{
  std::vector<Matrix4> poses = MakePoses(5);
  vtkNew<vtkLacunaSweptVolume> moving;
  moving->SetInputData(MakeStack(poses));
  poses[2] = poses[1];
  poses[3] = poses[1];
  vtkNew<vtkLacunaSweptVolume> still;
  still->SetInputData(MakeStack(poses, VTK_UNSIGNED_CHAR));
  LACUNA_CHECK_THAT(GetGrey(still, 0.5) == GetGrey(moving, 0.5), "before");
  LACUNA_CHECK_THAT(GetGrey(still, 2.5) > 0, "after");
}

void TestUnusablePoses()
{
  std::vector<Matrix4> poses = MakePoses(5);
  poses[3](1, 1) = NotANumber;
  LACUNA_CHECK_CONTAINS(
    GetError(MakeStack(poses)), "slice 3: its pose has elements that are not finite");
  LACUNA_CHECK_CONTAINS(GetError(MakeStack(poses)), "mark the slice invalid (SliceStatus 1)");
  LACUNA_CHECK_CONTAINS(GetError(MakeStack(poses)), "field data array 'ImageToReference'");
  LACUNA_CHECK_CONTAINS(
    GetError(MakeStack(poses), [](vtkLacunaSweptVolume* f) { f->SetBadPosesToKeepOutliers(); }),
    "slice 3: its pose has elements that are not finite");
  poses[3](1, 1) = std::numeric_limits<double>::infinity();
  LACUNA_CHECK_CONTAINS(GetError(MakeStack(poses)), "slice 3: its pose has elements");
  poses = MakePoses(5);
  poses[1] = poses[1] * Matrix4::Scaling({ 0, 1, 1 });
  LACUNA_CHECK_CONTAINS(GetError(MakeStack(poses)), "slice 1: its pose is singular");
  poses = MakePoses(5);
  poses[0](3, 0) = 1;
  LACUNA_CHECK_CONTAINS(GetError(MakeStack(poses)), "slice 0: its pose is not affine");
  // a frame that has another number than its slice is named by both
  vtkSmartPointer<vtkImageData> stack = MakeStack(poses);
  stack->GetFieldData()->GetArray("FrameNumber")->SetTuple1(0, 250);
  LACUNA_CHECK_CONTAINS(GetError(stack), "slice 0 (frame 250): its pose is not affine");
  stack->GetFieldData()->GetArray("FrameNumber")->SetNumberOfTuples(4);
  LACUNA_CHECK_CONTAINS(GetError(stack), "FrameNumber");
  stack->GetFieldData()->RemoveArray("FrameNumber");
  LACUNA_CHECK_CONTAINS(GetError(stack), "slice 0: its pose is not affine");

  // the valid rest is used when the user allows it
  poses = MakePoses(5);
  poses[2](2, 3) = NotANumber;
  vtkNew<vtkLacunaSweptVolume> filter;
  filter->SetInputData(MakeMarkedStack(poses));
  filter->SetBadPosesToLeaveOut();
  const auto messages = lacunaCheck::Watch(filter);
  LACUNA_CHECK_THAT(GetGrey(filter, 2) == 34, "neighbours of the slice that is left out");
  LACUNA_CHECK_CONTAINS(messages->Warnings, "1 slice was left out");
  LACUNA_CHECK_CONTAINS(messages->Warnings, "slice 2: its pose has elements that are not finite");
}

void TestOutliers()
{
  std::vector<Matrix4> poses = MakePoses(9);
  poses[2] = Matrix4::Translation({ 0, 1e9, 0 }) * poses[2];
  const auto stack = MakeMarkedStack(poses);
  const std::string wild = GetError(stack);
  LACUNA_CHECK_CONTAINS(wild, "slice 2: its pose is an outlier, it lies 1e+09 mm");
  LACUNA_CHECK_CONTAINS(wild, "'ImageToReference'");
  LACUNA_CHECK_CONTAINS(wild, "Set BadPoses to LeaveOut");
  const std::string kept =
    GetError(stack, [](vtkLacunaSweptVolume* f) { f->SetBadPosesToKeepOutliers(); });
  LACUNA_CHECK_CONTAINS(kept, "slice 2 lies 1e+09 mm from the middle");
  LACUNA_CHECK_CONTAINS(kept, "MemoryLimit allows 4294967296 bytes");
  LACUNA_CHECK_CONTAINS(kept, "An OutputSpacing of");

  vtkNew<vtkLacunaSweptVolume> filter;
  filter->SetInputData(stack);
  filter->SetBadPosesToLeaveOut();
  const auto messages = lacunaCheck::Watch(filter);
  LACUNA_CHECK_THAT(GetGrey(filter, 2) == 34, "neighbours of the outlier");
  LACUNA_CHECK_CONTAINS(messages->Warnings, "1 slice was left out");
  LACUNA_CHECK_CONTAINS(messages->Warnings, "slice 2: its pose is an outlier");
  LACUNA_CHECK_THAT(messages->Errors.empty(), "no error");

  // not so far that it would not fit: refused, kept by choice
  poses[2] = Matrix4::Translation({ 0, 60, 0 }) * MakePoses(9)[2];
  LACUNA_CHECK_CONTAINS(GetError(MakeStack(poses)), "it lies 60.");
  LACUNA_CHECK_THAT(
    GetError(MakeStack(poses), [](vtkLacunaSweptVolume* f) { f->SetBadPosesToKeepOutliers(); })
      .empty(),
    "kept by choice");
  // an outlier that is marked is none
  LACUNA_CHECK_THAT(
    GetError(MakeStack(poses, VTK_SHORT, { 0, 0, 1, 0, 0, 0, 0, 0, 0 })).empty(), "marked");
  // two of two inputs are judged each for itself
  vtkNew<vtkLacunaSweptVolume> two;
  two->AddInputData(MakeStack(MakePoses(9)));
  two->AddInputData(MakeStack(MakePoses(9, 500)));
  two->SetOutputSpacing(1, 1, 1);
  two->Update();
  LACUNA_CHECK_THAT(two->GetOutput()->GetDimensions()[2] == 509, "sweeps far apart");
}

void TestLayersOfOneSlice()
{
  vtkSmartPointer<vtkImageData> stack = MakeStack(MakePoses(5));
  stack->SetSpacing(1, 1, 1e-4);
  LACUNA_CHECK_CONTAINS(GetError(stack), "slice 0 twice");
}
}

int TestSweptVolumeSlices(int, char*[])
{
  TestStatus();
  TestFlagsTakenByChoice();
  TestTooFew();
  TestIdenticalPoses();
  TestUnusablePoses();
  TestOutliers();
  TestLayersOfOneSlice();
  return lacunaCheck::Result();
}
