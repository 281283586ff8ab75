// SPDX-License-Identifier: BSD-3-Clause
/// Several sweeps in one input of vtkLacunaSweptVolume and vtkLacunaSliceRayCaster: nothing is made
/// of the air between them, and the outputs say where they end.
#include "lacunaTestStacks.h"
#include "vtkFieldData.h"
#include "vtkLacunaSliceRayCaster.h"

#include <cstring>

using lacuna::Matrix4;
using namespace lacunaTestStacks;

namespace
{
// Of 6 slices each, 1 mm apart, the second one begins 20 mm behind the end of the first one.
std::vector<Matrix4> MakeStrips()
{
  std::vector<Matrix4> poses = MakePoses(6);
  const std::vector<Matrix4> next = MakePoses(6, 25);
  poses.insert(poses.end(), next.begin(), next.end());
  return poses;
}

void SetUp(vtkLacunaSweptVolume* filter)
{
  filter->SetOutputSpacing(0.5, 0.5, 0.5);
  filter->SetOutputBounds(10, 16, 20, 24, 0, 30);
}

// Whether the voxel in the middle of a layer is filled.
bool IsFilled(vtkImageData* volume, double z)
{
  return GetValue(volume, "vtkValidPointMask", 6, 4, static_cast<int>(2 * z)) == 1;
}

void TestMethods()
{
  vtkNew<vtkLacunaSweptVolume> filter;
  SetUp(filter);
  filter->SetInputData(MakeStack(MakeStrips()));
  LACUNA_CHECK(filter->GetGapMethod() == vtkLacunaSweptVolume::AutomaticGap);
  const auto messages = lacunaCheck::Watch(filter);
  const auto check = [&](bool isJoined, const std::string& what)
  {
    messages->Warnings.clear();
    filter->Update();
    for (int k = 0; k <= 60; ++k)
    {
      const double z = 0.5 * k;
      LACUNA_CHECK_THAT(IsFilled(filter->GetOutput(), z) == (isJoined || z <= 5 || z >= 25),
        what + ", z = " + std::to_string(z));
    }
  };
  check(false, "automatic");
  LACUNA_CHECK(messages->Warnings.empty());
  LACUNA_CHECK(std::string(filter->GetSweepDescription()) ==
    "2 sweeps: slices 0 to 5, at most 1 mm apart; slices 6 to 11, at most 1 mm apart; not joined: "
    "20 mm and 0.1 s from slice 5 to 6 (the limit is 8 mm)");
  vtkFieldData* fields = filter->GetOutput()->GetFieldData();
  const double truth[2][3] = { { 0, 0, 5 }, { 0, 6, 11 } };
  LACUNA_CHECK(fields->GetArray("Sweeps")->GetNumberOfTuples() == 2);
  for (int s = 0; s < 2; ++s)
  {
    LACUNA_CHECK(std::equal(truth[s], truth[s] + 3, fields->GetArray("Sweeps")->GetTuple3(s)));
    LACUNA_CHECK_NEAR(fields->GetArray("SweepGap")->GetTuple1(s), 1, 1e-12);
  }

  filter->SetMaximumSliceGap(0.9);
  filter->Update();
  LACUNA_CHECK_THAT(!IsFilled(filter->GetOutput(), 2.5), "a limit counts besides");
  filter->SetMaximumSliceGap(0);
  filter->SetGapMethodToUnlimited();
  check(true, "unlimited");
  LACUNA_CHECK(messages->Warnings.empty());
  LACUNA_CHECK(fields->GetArray("Sweeps")->GetNumberOfTuples() == 1);
  filter->SetMaximumSliceGap(3);
  check(true, "unlimited, whatever the limit is");
  filter->SetGapMethodToGiven();
  check(false, "given");
  filter->SetMaximumSliceGap(0);
  check(true, "given, 0");
  LACUNA_CHECK_CONTAINS(messages->Warnings,
    "joined through the air: 20 mm and 0.1 s from slice 5 to 6 (the limit is 8 mm). Set GapMethod");
}

// The slices between the strips are gated out: where they show that the probe went on, so does the
// sweep. Flagged as too fast they do not.
void TestGatedOut()
{
  for (const bool isGated : { true, false })
  {
    std::vector<unsigned char> status(31, 0);
    std::fill(status.begin() + 6, status.begin() + 25,
      isGated ? lacuna::TrackedSlices::GatedOut : lacuna::TrackedSlices::TooFast);
    vtkNew<vtkLacunaSweptVolume> filter;
    SetUp(filter);
    filter->SetInputData(MakeStack(MakePoses(31), VTK_SHORT, status));
    filter->Update();
    LACUNA_CHECK_THAT(
      IsFilled(filter->GetOutput(), 15) == isGated, isGated ? "gated out" : "too fast");
  }
}

// One slice after the other: what comes out is that of all at once, bit by bit.
void TestLive()
{
  const std::vector<Matrix4> all = MakeStrips();
  vtkNew<vtkLacunaSweptVolume> live;
  SetUp(live);
  for (std::size_t count = 2; count <= all.size(); ++count)
  {
    const auto stack = MakeStack({ all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count) });
    live->SetInputData(stack);
    live->Update();
    LACUNA_CHECK_THAT(live->GetNumberOfSlicesAdded() == (count <= 3 ? static_cast<int>(count) : 1),
      "only what is new");
    vtkNew<vtkLacunaSweptVolume> file;
    SetUp(file);
    file->SetInputData(stack);
    file->Update();
    for (const char* name : { "Intensity", "Contributions", "vtkValidPointMask" })
    {
      vtkDataArray* a = live->GetOutput()->GetPointData()->GetArray(name);
      vtkDataArray* b = file->GetOutput()->GetPointData()->GetArray(name);
      LACUNA_CHECK_THAT(a->GetDataSize() == b->GetDataSize() &&
          std::memcmp(a->GetVoidPointer(0), b->GetVoidPointer(0),
            static_cast<std::size_t>(a->GetDataSize()) * a->GetDataTypeSize()) == 0,
        name + std::string(" of slices ") + std::to_string(count));
    }
    LACUNA_CHECK(std::string(live->GetSweepDescription()) == file->GetSweepDescription());
  }
  LACUNA_CHECK(!IsFilled(live->GetOutput(), 15) && IsFilled(live->GetOutput(), 29.5));
}

// Seen along the sweep: a surface is not put into the air between a dark and a bright strip.
void TestRayCaster()
{
  vtkNew<vtkLacunaSliceRayCaster> caster;
  caster->SetInputData(MakeStack(MakeStrips())); // at column 6, row 4: 14 + 10 slice
  caster->SetViewDirection(0, 0, 1);
  caster->SetViewUp(0, -1, 0);
  caster->SetPixelSpacing(0.5);
  const auto depth = [&]
  {
    caster->Update();
    return GetValue(caster->GetOutput(), "Depth", 6, 4, 0);
  };
  caster->SetIsoValue(69); // slice 5 has 64, slice 6 has 74
  LACUNA_CHECK_NEAR(depth(), 25, 1e-9);
  vtkFieldData* fields = caster->GetOutput()->GetFieldData();
  LACUNA_CHECK_NEAR(fields->GetArray("RayGap")->GetTuple1(0), 1, 1e-4);
  LACUNA_CHECK(fields->GetArray("Sweeps")->GetNumberOfTuples() == 2);
  LACUNA_CHECK_CONTAINS(std::string(caster->GetSweepDescription()), "from slice 5 to 6");
  caster->SetGapMethodToUnlimited();
  LACUNA_CHECK_NEAR(depth(), 15, 1e-9);
  caster->SetGapMethodToGiven();
  LACUNA_CHECK_NEAR(depth(), 15, 1e-9);
  caster->SetMaximumGap(19);
  LACUNA_CHECK_NEAR(depth(), 25, 1e-9);
  caster->SetGapMethodToAutomatic();
  caster->SetMaximumGap(0);
  caster->SetIsoValue(49); // within a sweep
  LACUNA_CHECK_NEAR(depth(), 3.5, 1e-9);
}
}

int TestSweptVolumeSweeps(int, char*[])
{
  TestMethods();
  TestGatedOut();
  TestLive();
  TestRayCaster();
  return lacunaCheck::Result();
}
