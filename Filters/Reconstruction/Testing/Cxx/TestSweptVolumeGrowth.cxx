// SPDX-License-Identifier: BSD-3-Clause
/// vtkLacunaSweptVolume while its sweep grows: replayed in time, or live.
#include "lacunaTestReplay.h"

#include <cmath>
#include <cstring>
#include <random>

using lacuna::Matrix4;
using namespace lacunaTestStacks;

namespace
{
constexpr int Slices = 10;

Matrix4 GetPose(int n)
{
  return Matrix4::Translation({ 0.3 * n, std::sin(n), 0.8 * n }) *
    Matrix4::Rotation({ 0, 1, 0 }, 0.1 * std::sin(2 * n)) * Matrix4::Scaling({ 0.4, 0.5, 1 });
}

// The first count slices of a sweep; slices from blank on are black and flagged.
vtkSmartPointer<vtkImageData> MakeSweep(int count, int blank = Slices, int firstGrey = -1)
{
  auto stack = vtkSmartPointer<vtkImageData>::New();
  stack->SetDimensions(40, 30, count);
  stack->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  auto* pixel = static_cast<unsigned char*>(stack->GetScalarPointer());
  std::mt19937 random(9);
  std::vector<Matrix4> poses;
  std::vector<double> times;
  std::vector<unsigned char> status;
  std::vector<int> frames;
  for (int k = 0; k < count; ++k)
  {
    poses.push_back(GetPose(k));
    times.push_back(0.5 * k);
    frames.push_back(k);
    status.push_back(k < blank ? 0 : lacuna::TrackedSlices::ImageInvalid);
    for (int i = 0; i < 40 * 30; ++i)
    {
      const auto grey = static_cast<unsigned char>(random() % 256);
      *pixel++ = k < blank ? grey : 0;
    }
  }
  if (firstGrey >= 0)
  {
    *static_cast<unsigned char*>(stack->GetScalarPointer()) = static_cast<unsigned char>(firstGrey);
  }
  lacuna::TrackedSlices::Write(stack, poses, times, status, frames);
  return stack;
}

bool AreEqual(vtkImageData* a, vtkImageData* b)
{
  bool equal = a->GetNumberOfPoints() == b->GetNumberOfPoints() && a->GetNumberOfPoints() > 0;
  for (const char* name : { "Intensity", "Contributions", "vtkValidPointMask" })
  {
    vtkDataArray* x = a->GetPointData()->GetArray(name);
    vtkDataArray* y = b->GetPointData()->GetArray(name);
    equal = equal && x->GetDataSize() == y->GetDataSize() &&
      std::memcmp(x->GetVoidPointer(0), y->GetVoidPointer(0),
        static_cast<std::size_t>(x->GetDataSize()) * x->GetDataTypeSize()) == 0;
  }
  return equal;
}

void SetUp(vtkLacunaSweptVolume* filter)
{
  filter->SetOutputSpacing(0.4, 0.4, 0.4);
  filter->SetOutputScalarTypeToFloat();
}

// All at once, in the grid of another volume.
vtkSmartPointer<vtkImageData> AtOnce(vtkImageData* stack, vtkImageData* grid)
{
  vtkNew<vtkLacunaSweptVolume> filter;
  SetUp(filter);
  filter->SetInputData(stack);
  double bounds[6];
  grid->GetBounds(bounds);
  filter->SetOutputBounds(bounds);
  filter->Update();
  return filter->GetOutput();
}

void TestReplay()
{
  vtkNew<Replay> replay;
  replay->Show = [](int shown) { return MakeSweep(Slices, shown); };
  vtkNew<vtkLacunaSweptVolume> filter;
  SetUp(filter);
  filter->SetInputConnection(replay->GetOutputPort());
  const auto messages = lacunaCheck::Watch(filter);
  double bounds[6] = { 0, 0, 0, 0, 0, 0 };
  for (int k = 0; k < Slices; ++k)
  {
    filter->UpdateTimeStep(k);
    vtkImageData* volume = filter->GetOutput();
    LACUNA_CHECK_THAT(filter->GetNumberOfSlicesAdded() == 1, "one slice at a time");
    LACUNA_CHECK_THAT(k == 0 || std::equal(bounds, bounds + 6, volume->GetBounds()),
      "the grid is that of the whole sweep from the beginning");
    volume->GetBounds(bounds);
    if (k > 0)
    {
      LACUNA_CHECK_THAT(
        AreEqual(volume, AtOnce(MakeSweep(k + 1), volume)), std::to_string(k + 1) + " slices");
    }
  }
  vtkNew<vtkLacunaSweptVolume> whole;
  SetUp(whole);
  whole->SetInputData(MakeSweep(Slices));
  whole->Update();
  LACUNA_CHECK_THAT(
    std::equal(bounds, bounds + 6, whole->GetOutput()->GetBounds()), "the grid of all slices");
  LACUNA_CHECK_THAT(AreEqual(filter->GetOutput(), whole->GetOutput()), "the end of the replay");

  // back, and in leaps
  filter->UpdateTimeStep(4);
  LACUNA_CHECK_THAT(filter->GetNumberOfSlicesAdded() == 5, "made anew");
  LACUNA_CHECK_THAT(
    AreEqual(filter->GetOutput(), AtOnce(MakeSweep(5), filter->GetOutput())), "back");
  filter->UpdateTimeStep(7);
  LACUNA_CHECK_THAT(filter->GetNumberOfSlicesAdded() == 3, "a leap");
  LACUNA_CHECK_THAT(
    AreEqual(filter->GetOutput(), AtOnce(MakeSweep(8), filter->GetOutput())), "after a leap");
  // other parameters
  filter->SetCompoundingToMaximum();
  filter->Update();
  LACUNA_CHECK_THAT(filter->GetNumberOfSlicesAdded() == 8, "made anew for other parameters");
  filter->SetOutputScalarTypeToInput();
  filter->Update();
  LACUNA_CHECK_THAT(filter->GetNumberOfSlicesAdded() == 0, "only written anew");
  LACUNA_CHECK_THAT(messages->Errors.empty() && messages->Warnings.empty(), messages->Errors);
}

// Slices that are still to come are not taken as black ones.
void TestReplayOfInvalidImages()
{
  vtkNew<Replay> replay;
  // slices 3 and 9 have no image, though they have been taken
  replay->Show = [](int shown)
  {
    const auto stack = MakeSweep(Slices, shown);
    vtkDataArray* status = stack->GetFieldData()->GetArray("SliceStatus");
    status->SetTuple1(3, lacuna::TrackedSlices::ImageInvalid);
    status->SetTuple1(9, lacuna::TrackedSlices::ImageInvalid);
    return stack;
  };
  vtkNew<vtkLacunaSweptVolume> filter;
  SetUp(filter);
  filter->UseImageInvalidOn();
  filter->SetInputConnection(replay->GetOutputPort());
  for (int k = 0; k < Slices; ++k)
  {
    filter->UpdateTimeStep(k);
    // the slice without an image counts as soon as one with an image comes after it
    LACUNA_CHECK_THAT(filter->GetNumberOfSlicesAdded() ==
        (k == 3      ? 0
            : k == 4 ? 2
                     : 1),
      "slices at time " + std::to_string(k));
    if (k != 3 && k > 0)
    {
      LACUNA_CHECK_THAT(
        AreEqual(filter->GetOutput(), AtOnce(MakeSweep(k + 1), filter->GetOutput())),
        "no black slices at time " + std::to_string(k));
    }
  }
  // all of a sweep without images
  replay->Show = [](int) { return MakeSweep(Slices, 0); };
  replay->Modified();
  vtkNew<vtkLacunaSweptVolume> blind;
  blind->SetInputConnection(replay->GetOutputPort());
  const auto messages = lacunaCheck::Watch(blind);
  blind->UpdateTimeStep(Slices - 1);
  LACUNA_CHECK_CONTAINS(messages->Errors, "the slices are too few: 0 of 10");
}

// A probe that begins to move later.
void TestReplayOfRest()
{
  std::vector<Matrix4> poses = MakePoses(Slices);
  std::fill(poses.begin(), poses.begin() + 4, poses[0]);
  vtkNew<Replay> replay;
  replay->Show = [&](int shown)
  {
    std::vector<unsigned char> status(Slices, 0);
    std::fill(status.begin() + shown, status.end(), lacuna::TrackedSlices::ImageInvalid);
    return MakeStack(poses, VTK_UNSIGNED_CHAR, status);
  };
  vtkNew<vtkLacunaSweptVolume> filter;
  SetUp(filter);
  filter->SetInputConnection(replay->GetOutputPort());
  const auto messages = lacunaCheck::Watch(filter);
  for (int k = 0; k < Slices; ++k)
  {
    filter->UpdateTimeStep(k);
    LACUNA_CHECK_THAT(filter->GetOutput()->GetNumberOfPoints() > 0, "a volume at any time");
    double range[2];
    filter->GetOutput()->GetPointData()->GetArray("Contributions")->GetRange(range);
    LACUNA_CHECK_THAT((range[1] > 0) == (k >= 4), "empty while the probe is at rest");
  }
  LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
  // it never moves
  std::fill(poses.begin(), poses.end(), poses[0]);
  replay->Modified();
  filter->UpdateTimeStep(Slices - 2);
  LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
  filter->UpdateTimeStep(Slices - 1);
  LACUNA_CHECK_CONTAINS(messages->Errors, "all slices lie in the same plane");
}

// What has been said is not said again at each slice.
void TestWarnings()
{
  const auto stack = [](int count, const std::vector<int>& bad)
  {
    std::vector<Matrix4> poses = MakePoses(count);
    for (const int n : bad)
    {
      poses[n](0, 0) = std::nan("");
    }
    poses[1] = poses[1] * Matrix4::Rotation({ 0, 1, 0 }, 3.1);
    return MakeStack(poses);
  };
  vtkNew<vtkLacunaSweptVolume> filter;
  SetUp(filter);
  filter->SetBadPosesToLeaveOut();
  const auto update = [&](int count, const std::vector<int>& bad)
  {
    const auto messages = lacunaCheck::Watch(filter);
    filter->SetInputData(stack(count, bad));
    filter->Update();
    filter->RemoveAllObservers();
    filter->GetExecutive()->RemoveAllObservers();
    LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
    return messages->Warnings;
  };
  const std::string first = update(6, { 3 });
  LACUNA_CHECK_CONTAINS(first, "1 slice was left out because of bad poses");
  LACUNA_CHECK_CONTAINS(first, "turned by 90 degrees or more");
  LACUNA_CHECK_THAT(update(7, { 3 }).empty(), "nothing new");
  const std::string second = update(8, { 3, 7 });
  LACUNA_CHECK_CONTAINS(second, "1 slice was left out because of bad poses");
  LACUNA_CHECK_CONTAINS(second, "slice 7");
  LACUNA_CHECK_THAT(!Contains(second, "slice 3") && !Contains(second, "turned"), second);
  update(8, {});
  LACUNA_CHECK_CONTAINS(update(8, { 3 }), "slice 3");
}

// A source that appends slices knows nothing of the future.
void TestLive()
{
  vtkNew<vtkLacunaSweptVolume> filter;
  SetUp(filter);
  filter->SetOutputBounds(0, 15, 0, 14, 0, 7);
  for (int count = 2; count <= Slices; ++count)
  {
    filter->SetInputData(MakeSweep(count)); // a copy of the old slices, and one more
    filter->Update();
    LACUNA_CHECK_THAT(filter->GetNumberOfSlicesAdded() ==
        (count == 2      ? 2
            : count == 3 ? 3
                         : 1),
      "only the new slice, once it has grown");
    LACUNA_CHECK_THAT(AreEqual(filter->GetOutput(), AtOnce(MakeSweep(count), filter->GetOutput())),
      std::to_string(count) + " slices live");
  }
  // a pixel of the first slice is another one
  filter->SetInputData(MakeSweep(Slices, Slices, 77));
  filter->Update();
  LACUNA_CHECK_THAT(filter->GetNumberOfSlicesAdded() == Slices, "old slices that have changed");
  LACUNA_CHECK_THAT(
    AreEqual(filter->GetOutput(), AtOnce(MakeSweep(Slices, Slices, 77), filter->GetOutput())),
    "with the changed pixel");

  // bounds that the sweep reaches late
  vtkNew<vtkLacunaSweptVolume> late;
  SetUp(late);
  late->SetOutputBounds(0, 15, 0, 14, 6.6, 7.4);
  const auto messages = lacunaCheck::Watch(late);
  int told = 0;
  for (int count = 2; count <= Slices; ++count)
  {
    messages->Warnings.clear();
    late->SetInputData(MakeSweep(count));
    late->Update();
    LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
    told += messages->HasWarning("the volume is empty: OutputBounds along z") ? 1 : 0;
    LACUNA_CHECK_THAT(AreEqual(late->GetOutput(), AtOnce(MakeSweep(count), late->GetOutput())),
      std::to_string(count) + " slices, bounds that are reached late");
  }
  LACUNA_CHECK(told == 1);
  LACUNA_CHECK(
    late->GetOutput()->GetPointData()->GetArray("vtkValidPointMask")->GetRange()[1] == 1);

  // without bounds the grid grows: all is made anew, and right
  vtkNew<vtkLacunaSweptVolume> free;
  SetUp(free);
  for (int count = 2; count <= Slices; ++count)
  {
    free->SetInputData(MakeSweep(count));
    free->Update();
    vtkNew<vtkLacunaSweptVolume> fresh;
    SetUp(fresh);
    fresh->SetInputData(MakeSweep(count));
    fresh->Update();
    LACUNA_CHECK_THAT(AreEqual(free->GetOutput(), fresh->GetOutput()), "growing grid");
  }
}

// Of the first slices of a live sweep nothing can be made yet, which is no error.
void TestLiveBeginning()
{
  vtkNew<vtkLacunaSweptVolume> filter;
  SetUp(filter);
  const auto messages = lacunaCheck::Watch(filter);
  const auto update = [&](vtkImageData* sweep, bool grows)
  {
    if (grows)
    {
      lacuna::TrackedSlices::MarkAsGrowing(sweep);
    }
    filter->SetInputData(sweep);
    filter->Update();
    return filter->GetOutput()->GetNumberOfPoints();
  };
  LACUNA_CHECK(update(MakeSweep(1), true) == 0);
  LACUNA_CHECK(update(MakeSweep(3, 0), true) == 0); // all are flagged
  LACUNA_CHECK(update(MakeSweep(3, 1), true) == 0);
  LACUNA_CHECK(update(MakeSweep(3), true) > 0);
  LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
  LACUNA_CHECK(update(MakeSweep(1), false) == 0);
  LACUNA_CHECK_CONTAINS(messages->Errors, "the slices are too few: 1 of 1");
}

// Not every stack with invalid images is a replay.
void TestNoReplay()
{
  vtkNew<vtkLacunaSweptVolume> filter;
  SetUp(filter);
  filter->SetInputData(MakeSweep(Slices, 5));
  filter->Update();
  vtkNew<vtkLacunaSweptVolume> five;
  SetUp(five);
  five->SetInputData(MakeSweep(5));
  five->Update();
  LACUNA_CHECK_THAT(AreEqual(filter->GetOutput(), five->GetOutput()), "the grid of what there is");
  LACUNA_CHECK_THAT(filter->GetNumberOfSlicesAdded() == 5, "slices with an image");
}
}

int TestSweptVolumeGrowth(int, char*[])
{
  TestReplay();
  TestReplayOfInvalidImages();
  TestReplayOfRest();
  TestWarnings();
  TestLive();
  TestLiveBeginning();
  TestNoReplay();
  return lacunaCheck::Result();
}
