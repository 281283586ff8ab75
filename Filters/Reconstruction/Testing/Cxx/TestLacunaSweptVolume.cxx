// SPDX-License-Identifier: BSD-3-Clause
/// Ports, arrays, extents, pieces, time, errors of vtkLacunaSweptVolume.
#include "lacunaCheck.h"
#include "lacunaProvenance.h"
#include "lacunaTestReplay.h"
#include "lacunaTestStacks.h"
#include "lacunaTrackedSlices.h"
#include "vtkCallbackCommand.h"
#include "vtkCharArray.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkLacunaSweptVolume.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnsignedIntArray.h"

#include <cmath>
#include <functional>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

using lacuna::Matrix4;
using namespace lacunaTestStacks;

namespace
{
vtkSmartPointer<vtkImageData> MovingStack(double time)
{
  return MakeStack(MakePoses(5, time));
}

void TestContract()
{
  vtkNew<vtkLacunaSweptVolume> filter;
  filter->SetInputData(MakeStack(MakePoses(5)));
  filter->SetOutputSpacing(0.5, 1, 0.5);
  filter->Update();
  vtkImageData* volume = filter->GetOutput();
  const int* extent = volume->GetExtent();
  LACUNA_CHECK_THAT(extent[0] == 0 && extent[1] == 12 && extent[2] == 0 && extent[3] == 4 &&
      extent[4] == 0 && extent[5] == 8,
    "extent");
  LACUNA_CHECK_THAT(
    volume->GetOrigin()[0] == 10 && volume->GetOrigin()[1] == 20 && volume->GetOrigin()[2] == 0,
    "origin");
  LACUNA_CHECK_THAT(volume->GetSpacing()[1] == 1, "spacing");
  vtkPointData* points = volume->GetPointData();
  LACUNA_CHECK_THAT(points->GetNumberOfArrays() == 3, "three arrays");
  LACUNA_CHECK_THAT(points->GetScalars() &&
      std::string(points->GetScalars()->GetName()) == "Intensity" &&
      points->GetScalars()->GetDataType() == VTK_UNSIGNED_CHAR,
    "Intensity is active and of the input's type");
  LACUNA_CHECK_THAT(vtkUnsignedIntArray::SafeDownCast(points->GetArray("Contributions")) != nullptr,
    "Contributions are unsigned int");
  LACUNA_CHECK_THAT(
    vtkCharArray::SafeDownCast(points->GetArray("vtkValidPointMask")) != nullptr, "mask is char");
  // wider footprints see the same of linear grey levels, and higher ones too
  filter->SetFootprintScale(2.00000001);
  filter->FootprintAcrossSlicesOn();
  filter->Update();
  LACUNA_CHECK_THAT(
    GetValue(volume, "Intensity", 6, 2, 5) == 39, "wide and high footprints of a ramp");
  LACUNA_CHECK_CONTAINS(
    lacuna::Provenance::Get(volume)[0], "FootprintScale=2.00000001 FootprintAcrossSlices=on");
  filter->SetFootprintScale(1);
  filter->FootprintAcrossSlicesOff();
  filter->Update();
  // column 6, row 4, between slices 2 and 3: 6 + 8 + 25
  LACUNA_CHECK_THAT(GetValue(volume, "Intensity", 6, 2, 5) == 39, "interpolated grey level");
  LACUNA_CHECK_THAT(GetValue(volume, "Contributions", 6, 2, 5) == 1, "one sample between slices");
  LACUNA_CHECK_THAT(
    GetValue(volume, "vtkValidPointMask", 12, 4, 8) == 1, "the last voxel is filled");
  LACUNA_CHECK_THAT(volume->GetFieldData()->GetNumberOfArrays() == 3,
    "only Provenance, Sweeps and SweepGap in the field data");
  const std::vector<std::string> steps = lacuna::Provenance::Get(volume);
  LACUNA_CHECK_THAT(steps.size() == 1 && Contains(steps[0], "vtkLacunaSweptVolume") &&
      Contains(steps[0], "OutputSpacing=0.5,1,0.5") &&
      Contains(steps[0], "PixelSampling=Footprint"),
    "provenance");

  std::ostringstream text;
  filter->Print(text);
  LACUNA_CHECK_THAT(Contains(text.str(), "Compounding: Mean (0 (Mean) or 1 (Maximum))") &&
      Contains(text.str(), "MemoryLimit: 4096 (0 (no limit) or 1 MiB or more)"),
    "PrintSelf");
}

void TestTypes()
{
  for (const int type : { VTK_CHAR, VTK_SIGNED_CHAR, VTK_UNSIGNED_CHAR, VTK_SHORT,
         VTK_UNSIGNED_SHORT, VTK_INT, VTK_UNSIGNED_INT, VTK_LONG, VTK_UNSIGNED_LONG, VTK_LONG_LONG,
         VTK_UNSIGNED_LONG_LONG, VTK_FLOAT, VTK_DOUBLE })
  {
    for (const int output : { vtkLacunaSweptVolume::Input, vtkLacunaSweptVolume::Float })
    {
      vtkNew<vtkLacunaSweptVolume> filter;
      filter->SetInputData(MakeStack(MakePoses(5), type));
      filter->SetOutputSpacing(0.5, 0.5, 0.5);
      filter->SetOutputScalarType(output);
      filter->Update();
      const std::string name = "type " + std::to_string(type);
      vtkImageData* volume = filter->GetOutput();
      LACUNA_CHECK_THAT(
        volume->GetScalarType() == (output == vtkLacunaSweptVolume::Float ? VTK_FLOAT : type),
        name + " of the output");
      LACUNA_CHECK_THAT(GetValue(volume, "Intensity", 6, 4, 5) == 39, name);
    }
  }
  // several inputs of different types
  vtkNew<vtkLacunaSweptVolume> filter;
  filter->AddInputData(MakeStack(MakePoses(5), VTK_UNSIGNED_CHAR));
  filter->AddInputData(MakeStack(MakePoses(5), VTK_DOUBLE));
  filter->SetOutputSpacing(0.5, 0.5, 0.5);
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK_CONTAINS(messages->Errors, "different types (unsigned char, double)");
  filter->SetOutputScalarTypeToFloat();
  filter->Update();
  LACUNA_CHECK_THAT(
    GetValue(filter->GetOutput(), "Intensity", 6, 4, 5) == 39, "mixed types as float");
  LACUNA_CHECK_THAT(GetValue(filter->GetOutput(), "Contributions", 6, 4, 5) == 2, "two sweeps");
}

void TestPieces()
{
  vtkNew<vtkLacunaSweptVolume> whole;
  whole->SetInputData(MakeStack(MakePoses(5)));
  whole->SetOutputSpacing(0.3, 0.3, 0.3);
  whole->Update();
  vtkIdType points = 0;
  for (int piece = 0; piece < 3; ++piece)
  {
    vtkNew<vtkLacunaSweptVolume> filter;
    filter->SetInputData(MakeStack(MakePoses(5)));
    filter->SetOutputSpacing(0.3, 0.3, 0.3);
    filter->UpdatePiece(piece, 3, 0);
    vtkImageData* part = filter->GetOutput();
    points += part->GetNumberOfPoints();
    LACUNA_CHECK_THAT(part->GetNumberOfPoints() > 0 &&
        part->GetNumberOfPoints() < whole->GetOutput()->GetNumberOfPoints(),
      "a piece is a part");
    const int* e = part->GetExtent();
    bool same = true;
    for (int k = e[4]; k <= e[5]; ++k)
    {
      for (int j = e[2]; j <= e[3]; ++j)
      {
        for (int i = e[0]; i <= e[1]; ++i)
        {
          for (const char* name : { "Intensity", "Contributions", "vtkValidPointMask" })
          {
            same &= GetValue(part, name, i, j, k) == GetValue(whole->GetOutput(), name, i, j, k);
          }
        }
      }
    }
    LACUNA_CHECK_THAT(same, "piece " + std::to_string(piece) + " equals its part of the whole");
  }
  LACUNA_CHECK_THAT(points >= whole->GetOutput()->GetNumberOfPoints(), "pieces cover the whole");
}

// A part of a stack, with all tuples in the field data, as Extract Subset makes it.
vtkSmartPointer<vtkImageData> Crop(vtkImageData* stack, int extent[6])
{
  auto part = vtkSmartPointer<vtkImageData>::New();
  part->DeepCopy(stack);
  part->Crop(extent);
  return part;
}

void TestParts()
{
  vtkNew<vtkLacunaSweptVolume> clipped;
  clipped->SetInputData(MakeStack(MakePoses(5)));
  clipped->SetOutputSpacing(0.5, 0.5, 0.5);
  clipped->SetClipRectangle(3, 2, 7, 5);
  clipped->Update();
  const double* bounds = clipped->GetOutput()->GetBounds();
  LACUNA_CHECK_THAT(bounds[0] == 11.5 && bounds[1] == 14.5 && bounds[2] == 21 && bounds[3] == 23,
    "bounds of the clip rectangle");
  LACUNA_CHECK_THAT(
    GetValue(clipped->GetOutput(), "Intensity", 3, 2, 5) == 39, "grey level in the rectangle");

  // the same pixels of slices 1..4 as a cropped stack
  int extent[6] = { 3, 9, 2, 6, 1, 4 };
  const auto part = Crop(MakeStack(MakePoses(5)), extent);
  vtkNew<vtkLacunaSweptVolume> cropped;
  cropped->SetInputData(part);
  cropped->SetOutputSpacing(0.5, 0.5, 0.5);
  cropped->Update();
  LACUNA_CHECK_THAT(cropped->GetOutput()->GetBounds()[4] == 1, "the first slice is left out");
  LACUNA_CHECK_THAT(GetValue(cropped->GetOutput(), "Intensity", 3, 2, 3) == 39, "cropped stack");
  // a stack whose extent starts at 0 says by its origin which part it is
  part->SetExtent(0, 6, 0, 4, 0, 3);
  part->SetOrigin(3, 2, 1);
  cropped->SetClipRectangle(4, 0, 0, 5);
  cropped->Update();
  bounds = cropped->GetOutput()->GetBounds();
  LACUNA_CHECK_THAT(bounds[0] == 12 && bounds[1] == 14.5 && bounds[2] == 21 && bounds[3] == 22,
    "the rectangle counts the pixels of the original slices");
  LACUNA_CHECK_THAT(
    GetValue(cropped->GetOutput(), "Intensity", 2, 2, 3) == 39, "stack with an origin");
  // every second column and row
  vtkNew<vtkImageData> strided;
  strided->DeepCopy(MakeStack(MakePoses(5)));
  strided->SetSpacing(2, 2, 1);
  vtkNew<vtkLacunaSweptVolume> wide;
  wide->SetInputData(strided);
  wide->SetOutputSpacing(0.5, 0.5, 0.5);
  wide->Update();
  LACUNA_CHECK_THAT(
    wide->GetOutput()->GetBounds()[1] == 22, "pixels of a strided stack lie further apart");
}

void TestErrors()
{
  const double notANumber = std::numeric_limits<double>::quiet_NaN();
  const auto good = MakeStack(MakePoses(5));
  LACUNA_CHECK_THAT(GetError(good).empty(), "no error");

  auto stack = MakeStack(MakePoses(5));
  stack->GetFieldData()->RemoveArray("ImageToReference");
  LACUNA_CHECK_CONTAINS(GetError(stack), "'ImageToReference' is missing");
  stack = MakeStack(MakePoses(5));
  stack->GetFieldData()->RemoveArray("SliceStatus");
  LACUNA_CHECK_CONTAINS(GetError(stack), "'SliceStatus' is missing");
  stack = MakeStack(MakePoses(5));
  stack->GetPointData()->SetActiveScalars(nullptr);
  stack->GetPointData()->RemoveArray(0);
  LACUNA_CHECK_CONTAINS(GetError(stack), "no active point scalars");
  stack = MakeStack(MakePoses(5));
  stack->SetOrigin(0, 0, 3);
  LACUNA_CHECK_CONTAINS(GetError(stack), "z = 5");
  stack = MakeStack(MakePoses(5));
  stack->SetDirectionMatrix(0, 1, 0, 1, 0, 0, 0, 0, 1);
  LACUNA_CHECK_CONTAINS(GetError(stack), "direction matrix");

  const auto with = [&](const Configure& configure) { return GetError(good, configure); };
  LACUNA_CHECK_CONTAINS(with([](auto* f) { f->SetOutputSpacing(0.5, -1, 0.5); }),
    "OutputSpacing is -1 mm; it must be 0 (automatic) or above 0 mm");
  LACUNA_CHECK_CONTAINS(
    with([=](auto* f) { f->SetOutputSpacing(notANumber, 1, 1); }), "OutputSpacing is nan mm");
  LACUNA_CHECK_CONTAINS(
    with([](auto* f) { f->SetOutputBounds(12, 11, 1, -1, 1, -1); }), "minimum first");
  LACUNA_CHECK_CONTAINS(
    with([](auto* f) { f->SetClipRectangle(40, 0, 0, 0); }), "0 columns of 0 to 12");
  LACUNA_CHECK_CONTAINS(with([](auto* f) { f->SetClipRectangle(0, 8, 0, 0); }), "1 rows of 0 to 8");
  LACUNA_CHECK_CONTAINS(
    with([](auto* f) { f->SetClipRectangle(13, 0, 2147483647, 0); }), "0 columns of 0 to 12");
  LACUNA_CHECK_CONTAINS(with([](auto* f) { f->SetClipRectangle(-1, 0, 5, 0); }),
    "ClipRectangle is -1 pixels; it must be 0 (all) or 1 pixels or more");
  LACUNA_CHECK_CONTAINS(with([](auto* f) { f->SetClipRectangle(0, 0, 0, -2147483647); }),
    "ClipRectangle is -2147483647 pixels");
  // what lies beyond the right and lower edges does not matter
  LACUNA_CHECK(with([](auto* f) { f->SetClipRectangle(3, 2, 2147483647, 99); }).empty());
  LACUNA_CHECK_CONTAINS(with([](auto* f) { f->SetMaximumSliceGap(-1); }), "MaximumSliceGap");
  LACUNA_CHECK_CONTAINS(with([](auto* f) { f->SetFanMask(3); }),
    "FanMask is 3; it must be 0 (Given), 1 (Automatic) or 2 (None)");
  LACUNA_CHECK_CONTAINS(with([](auto* f) { f->SetGapMethod(-1); }), "GapMethod is -1");
  LACUNA_CHECK_CONTAINS(with([](auto* f) { f->SetFootprintScale(0); }), "FootprintScale");
  LACUNA_CHECK_CONTAINS(with([=](auto* f) { f->SetFootprintScale(notANumber); }), "FootprintScale");
  for (const double tiny : { 1e-3, 1e-7, 1e-100, 1e-300 })
  {
    LACUNA_CHECK_CONTAINS(
      with([=](auto* f) { f->SetOutputSpacing(tiny, tiny, tiny); }), "MemoryLimit allows");
  }
  LACUNA_CHECK_CONTAINS(with(
                          [](auto* f)
                          {
                            f->SetMemoryLimit(1);
                            f->SetOutputSpacing(0.05, 0.05, 0.05);
                          }),
    "1048576 bytes");

  LACUNA_CHECK_CONTAINS(with(
                          [](auto* f)
                          {
                            f->SetMemoryLimit(0);
                            f->SetOutputSpacing(0.0002, 0.0002, 0.0002);
                          }),
    "this part of the volume would need");

  LACUNA_CHECK_CONTAINS(with([](auto* f) { f->SetMemoryLimit(-1); }),
    "MemoryLimit is -1 MiB; it must be 0 (no limit) or 1 MiB or more");

  // what fits in one voxel is not called flat
  for (const double huge : { 1e7, 1e300 })
  {
    vtkNew<vtkLacunaSweptVolume> one;
    one->SetInputData(MakeStack(MakePoses(5)));
    one->SetOutputSpacing(huge, huge, huge);
    const auto messages = lacunaCheck::Watch(one);
    one->Update();
    LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
    LACUNA_CHECK_CONTAINS(messages->Warnings, "the volume has only one voxel");
    LACUNA_CHECK(one->GetOutput()->GetNumberOfPoints() == 1);
    LACUNA_CHECK(GetValue(one->GetOutput(), "Contributions", 0, 0, 0) > 0);
  }

  // one slice
  const std::string single = GetError(MakeStack(MakePoses(1)));
  LACUNA_CHECK_CONTAINS(
    single, "the slices are too few: 1 of 1 can be used, at least 2 are needed");
  LACUNA_CHECK_CONTAINS(single, "set Interpolation to NearestVoxel");
  LACUNA_CHECK(GetError(MakeStack(MakePoses(1)),
    [](auto* f) {
      f->SetInterpolationToNearestVoxel();
    }).empty());
  const std::string flagged = GetError(MakeStack(MakePoses(3), VTK_SHORT, { 0, 4, 8 }));
  LACUNA_CHECK_CONTAINS(flagged, "set UseTooFast, UseGatedOut to take the flagged ones");
  LACUNA_CHECK_CONTAINS(GetError(MakeStack(MakePoses(3), VTK_SHORT, { 1, 1, 1 })),
    "mend the SliceStatus of those whose pose is right");

  // a pair turned too far is a warning, the rest is filled
  std::vector<Matrix4> poses = MakePoses(3);
  poses.push_back(poses[2] * Matrix4::Rotation({ 0, 1, 0 }, 2));
  vtkNew<vtkLacunaSweptVolume> turned;
  turned->SetInputData(MakeStack(poses));
  turned->SetOutputSpacing(0.5, 0.5, 0.5);
  const auto messages = lacunaCheck::Watch(turned);
  turned->Update();
  LACUNA_CHECK_CONTAINS(messages->Warnings, "1 of 3 pairs");
  LACUNA_CHECK_THAT(turned->GetOutput()->GetNumberOfPoints() > 0, "a warning keeps the output");

  // the second of two inputs is named
  vtkNew<vtkLacunaSweptVolume> two;
  two->AddInputData(good);
  poses = MakePoses(2);
  poses[0](2, 2) = notANumber;
  two->AddInputData(MakeStack(poses));
  const auto second = lacunaCheck::Watch(two);
  two->Update();
  LACUNA_CHECK_CONTAINS(second->Errors, "slice 0 of input 1");

  // once mended, it works again
  vtkNew<vtkLacunaSweptVolume> mended;
  mended->SetInputData(good);
  mended->SetOutputSpacing(-1, 1, 1);
  const auto once = lacunaCheck::Watch(mended);
  mended->Update();
  LACUNA_CHECK_THAT(!once->Errors.empty(), "an error first");
  mended->SetOutputSpacing(1, 1, 1);
  mended->Update();
  LACUNA_CHECK_THAT(mended->GetOutput()->GetNumberOfPoints() == 7 * 5 * 5, "then the volume");

  // nothing in, nothing out
  vtkNew<vtkImageData> empty;
  LACUNA_CHECK_THAT(GetError(empty).empty(), "an empty input is no error");
}

void TestPipeline()
{
  vtkNew<SliceSource> source;
  source->Show = MovingStack;
  vtkNew<vtkLacunaSweptVolume> filter;
  filter->SetInputConnection(source->GetOutputPort());
  filter->SetOutputSpacing(0.5, 0.5, 0.5);
  filter->UpdateInformation();
  int whole[6];
  filter->GetOutputInformation(0)->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole);
  LACUNA_CHECK_THAT(
    whole[1] == 12 && whole[3] == 8 && whole[5] == 8, "whole extent before the data");
  filter->Update();
  filter->SetCompoundingToMaximum();
  filter->Update();
  LACUNA_CHECK_THAT(source->Executions == 1, "the source runs once");
  source->Modified();
  filter->Update();
  LACUNA_CHECK_THAT(source->Executions == 2, "and once more when modified");

  // a source that moves with time
  vtkNew<SliceSource> moving;
  moving->Show = MovingStack;
  moving->HasTime = true;
  filter->SetInputConnection(moving->GetOutputPort());
  filter->UpdateTimeStep(0);
  LACUNA_CHECK_THAT(filter->GetOutput()->GetOrigin()[2] == 0, "at time 0");
  filter->UpdateTimeStep(100);
  LACUNA_CHECK_THAT(filter->GetOutput()->GetOrigin()[2] == 100, "the grid follows in time");
  LACUNA_CHECK_THAT(
    GetValue(filter->GetOutput(), "Intensity", 6, 4, 5) == 39, "and so do the grey levels");
  filter->UpdateTimeStep(0);
  LACUNA_CHECK_THAT(filter->GetOutput()->GetOrigin()[2] == 0, "and back");

  // stopped by the user
  vtkNew<vtkLacunaSweptVolume> stopped;
  stopped->SetInputData(MakeStack(MakePoses(5)));
  stopped->SetOutputSpacing(0.02, 0.02, 0.02);
  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback([](vtkObject* caller, unsigned long, void*, void*)
    { vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1); });
  stopped->AddObserver(vtkCommand::ProgressEvent, stop);
  stopped->Update();
  LACUNA_CHECK_THAT(stopped->GetOutput()->GetNumberOfPoints() == 0, "nothing is left when stopped");
}

// Pixels that are not finite make holes, and gaps that are too wide an empty volume: both are said.
void TestWarningsOfHoles()
{
  const auto stack = MakeStack(MakePoses(5), VTK_FLOAT);
  stack->SetScalarComponentFromDouble(6, 4, 2, 0, std::numeric_limits<double>::quiet_NaN());
  vtkNew<vtkLacunaSweptVolume> filter;
  filter->SetInputData(stack);
  filter->SetOutputSpacing(0.5, 0.5, 0.5);
  filter->SetPixelSamplingToNearest();
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK_CONTAINS(messages->Warnings, "5 voxels stay empty");
  vtkImageData* volume = filter->GetOutput();
  LACUNA_CHECK(GetValue(volume, "vtkValidPointMask", 6, 4, 4) == 0);
  LACUNA_CHECK(GetValue(volume, "Contributions", 6, 4, 4) == 0);
  LACUNA_CHECK(GetValue(volume, "Intensity", 6, 4, 4) == 0);
  LACUNA_CHECK(GetValue(volume, "vtkValidPointMask", 5, 4, 4) == 1);
  messages->Warnings.clear();
  filter->Modified();
  filter->Update();
  LACUNA_CHECK_THAT(messages->Warnings.empty(), "said once");

  vtkNew<vtkLacunaSweptVolume> narrow;
  narrow->SetInputData(MakeStack(MakePoses(5)));
  narrow->SetOutputSpacing(0.5, 0.5, 0.5);
  narrow->SetMaximumSliceGap(1.5);
  const auto said = lacunaCheck::Watch(narrow);
  narrow->Update();
  LACUNA_CHECK_THAT(said->Warnings.empty(), said->Warnings);
  narrow->SetMaximumSliceGap(0.5);
  narrow->Update();
  LACUNA_CHECK_CONTAINS(said->Warnings, "the volume is empty: all slices are further apart");
  LACUNA_CHECK_THAT(said->Errors.empty(), said->Errors);
}
}

int TestLacunaSweptVolume(int, char*[])
{
  TestContract();
  TestTypes();
  TestPieces();
  TestParts();
  TestErrors();
  TestPipeline();
  TestWarningsOfHoles();
  return lacunaCheck::Result();
}
