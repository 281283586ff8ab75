// SPDX-License-Identifier: BSD-3-Clause
/// vtkLacunaSweptVolume while its sweep grows: replayed in time, or live.
#include "lacunaTestStacks.h"
#include "vtkFieldData.h"
#include "vtkImageAlgorithm.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <cmath>
#include <cstring>
#include <limits>
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
    status.push_back(k < blank ? 0 : vtkLacunaTrackedSlices::ImageInvalid);
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
  vtkLacunaTrackedSlices::Write(stack, poses, times, status, frames);
  return stack;
}

// A sweep replayed in time, as by the reader: later slices are blank and flagged.
class Replay : public vtkImageAlgorithm
{
public:
  static Replay* New();
  vtkTypeMacro(Replay, vtkImageAlgorithm);

protected:
  Replay() { this->SetNumberOfInputPorts(0); }
  int RequestInformation(
    vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    vtkInformation* info = outputs->GetInformationObject(0);
    const int extent[6] = { 0, 39, 0, 29, 0, Slices - 1 };
    info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
    double steps[Slices];
    for (int k = 0; k < Slices; ++k)
    {
      steps[k] = 0.5 * k;
    }
    const double range[2] = { steps[0], steps[Slices - 1] };
    info->Set(vtkStreamingDemandDrivenPipeline::TIME_STEPS(), steps, Slices);
    info->Set(vtkStreamingDemandDrivenPipeline::TIME_RANGE(), range, 2);
    return 1;
  }
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    vtkInformation* info = outputs->GetInformationObject(0);
    const double time = info->Has(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP())
      ? info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP())
      : 1e9;
    vtkImageData::GetData(outputs)->ShallowCopy(
      MakeSweep(Slices, static_cast<int>(std::min<double>(Slices, time / 0.5 + 1))));
    return 1;
  }
};
vtkStandardNewMacro(Replay);

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
  vtkNew<vtkLacunaSweptVolume> filter;
  SetUp(filter);
  filter->SetInputConnection(replay->GetOutputPort());
  const auto messages = lacunaCheck::Watch(filter);
  double bounds[6] = { 0, 0, 0, 0, 0, 0 };
  for (int k = 0; k < Slices; ++k)
  {
    filter->UpdateTimeStep(0.5 * k);
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
  filter->UpdateTimeStep(0.5 * 4);
  LACUNA_CHECK_THAT(filter->GetNumberOfSlicesAdded() == 5, "made anew");
  LACUNA_CHECK_THAT(
    AreEqual(filter->GetOutput(), AtOnce(MakeSweep(5), filter->GetOutput())), "back");
  filter->UpdateTimeStep(0.5 * 7);
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
  TestLive();
  TestNoReplay();
  return lacunaCheck::Result();
}
