// SPDX-License-Identifier: BSD-3-Clause
// ReplayInTime, and reading no more than is asked for.
#include "Compress.h"
#include "TrackedSliceReaderTesting.h"
#include "lacunaTrackedSlices.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkImageThreshold.h"
#include "vtkInformation.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <cstdlib>

namespace
{
using Pipeline = vtkStreamingDemandDrivenPipeline;

/// The stack has count slices, of which the first ones are shown.
void CheckStack(
  vtkLacunaTrackedSliceReader* reader, int shown, int count = 6, int first = 0, int stride = 1)
{
  vtkImageData* output = reader->GetOutput();
  LACUNA_CHECK(output->GetDimensions()[2] == count);
  LACUNA_CHECK(output->GetOrigin()[2] == first && output->GetSpacing()[2] == stride);
  for (int k = 0; k < count; ++k)
  {
    for (int pixel = 0; pixel < 20; ++pixel)
    {
      const int grey = GetGrey(pixel % 5, pixel / 5, first + k * stride);
      LACUNA_CHECK(
        output->GetScalarComponentAsDouble(pixel % 5, pixel / 5, k, 0) == (k < shown ? grey : 0));
    }
  }
  vtkDataArray* status = output->GetFieldData()->GetArray("SliceStatus");
  for (int i = 0; i < status->GetNumberOfTuples(); ++i)
  {
    const bool taken = shown == count || i <= first + (shown - 1) * stride;
    LACUNA_CHECK(status->GetTuple1(i) == (taken ? 0 : 2));
  }
}

void TestOffByDefault()
{
  ReaderOf test(MakeSequence(6).GetContent());
  LACUNA_CHECK(!test.Reader->GetReplayInTime());
  test.Reader->UpdateTimeStep(11.5);
  LACUNA_CHECK(!test.Reader->GetOutputInformation(0)->Has(Pipeline::TIME_STEPS()));
  CheckStack(test.Reader, 6);
}

void TestGrowing(const std::string& content)
{
  ReaderOf test(content); // slices at 10.25, 11.25 ...
  vtkLacunaTrackedSliceReader* reader = test.Reader;
  reader->ReplayInTimeOn();
  reader->UpdateInformation();
  vtkInformation* info = reader->GetOutputInformation(0);
  LACUNA_CHECK(info->Length(Pipeline::TIME_STEPS()) == 6);
  LACUNA_CHECK(info->Get(Pipeline::TIME_STEPS())[5] == 15.25);
  LACUNA_CHECK(info->Get(Pipeline::TIME_RANGE())[0] == 10.25);
  const std::pair<double, int> steps[] = { { 10.25, 1 }, { 12.25, 3 }, { 12.3, 3 }, { 15.25, 6 },
    { 11.25, 2 }, { 14, 4 }, { 0, 1 }, { 99, 6 }, { 99.5, 6 } };
  for (const auto& [time, slices] : steps)
  {
    reader->UpdateTimeStep(time);
    CheckStack(reader, slices);
    vtkImageData* output = reader->GetOutput();
    LACUNA_CHECK(output->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()) == 9.25 + slices);
    const lacuna::TrackedSlices tracked(output);
    LACUNA_CHECK(tracked.GetNumberOfSlices() == 6); // the whole sweep
    LACUNA_CHECK(tracked.GetImageToReference(5).IsFinite());
  }

  const int part[6] = { 1, 2, 0, 3, 1, 4 };
  reader->UpdateTimeStep(13.25, -1, 1, 0, part); // slices 1 to 3 of 1 to 4
  vtkImageData* output = reader->GetOutput();
  LACUNA_CHECK(output->GetNumberOfPoints() == 32);
  LACUNA_CHECK(output->GetScalarComponentAsDouble(2, 3, 3, 0) == GetGrey(2, 3, 3));
  LACUNA_CHECK(output->GetScalarComponentAsDouble(2, 3, 4, 0) == 0);
  reader->UpdateTimeStep(10.25); // none of them
  LACUNA_CHECK(output->GetScalarComponentAsDouble(2, 3, 1, 0) == 0);
  const int whole[6] = { 0, 4, 0, 3, 0, 5 };
  reader->UpdateTimeStep(13.25, -1, 1, 0, whole);
  CheckStack(reader, 4);

  reader->SetFrameRange(1, 5);
  reader->SetFrameStride(2); // 11.25, 13.25, 15.25
  reader->UpdateInformation();
  LACUNA_CHECK(info->Length(Pipeline::TIME_STEPS()) == 3);
  const int strided[6] = { 0, 4, 0, 3, 0, 2 };
  reader->UpdateTimeStep(13.25, -1, 1, 0, strided);
  CheckStack(reader, 2, 3, 1, 2);
  LACUNA_CHECK(
    reader->GetOutput()->GetFieldData()->GetArray("Timestamp")->GetNumberOfTuples() == 6);
  reader->ReplayInTimeOff();
  reader->UpdateTimeStep(11.25);
  CheckStack(reader, 3, 3, 1, 2);
  LACUNA_CHECK(!info->Has(Pipeline::TIME_STEPS()));
  reader->ReplayInTimeOn();
  reader->SetFrameRange(0, -1);
  reader->SetFrameStride(1);
  vtkNew<vtkImageThreshold> filter; // a filter in between knows nothing of all this
  filter->SetInputConnection(reader->GetOutputPort());
  for (const int slices : { 2, 5, 1 })
  {
    filter->UpdateTimeStep(9.25 + slices);
    LACUNA_CHECK(filter->GetOutput()->GetDimensions()[2] == 6);
    CheckStack(reader, slices);
    LACUNA_CHECK(
      filter->GetOutput()->GetFieldData()->GetArray("SliceStatus")->GetTuple1(slices) == 2);
  }
  LACUNA_CHECK(test.Errors.empty() && test.Warnings.empty());
}

void TestClocks()
{
  SequenceFile file = MakeSequence(5);
  file.SetFrame(1, "Timestamp", "8");
  file.RemoveFrame(3, "Timestamp");
  ReaderOf test(file.GetContent());
  test.Reader->ReplayInTimeOn();
  test.Reader->UpdateTimeStep(10.25);
  CheckStack(test.Reader, 2, 5); // the clock jumped back
  test.Reader->UpdateTimeStep(12.25);
  CheckStack(test.Reader, 4, 5);
  const std::size_t warned = test.Warnings.size();
  LACUNA_CHECK_CONTAINS(test.Warnings, "Timestamp is missing or not a finite number in frame 3");
  test.Reader->UpdateTimeStep(14.25);
  LACUNA_CHECK(test.Warnings.size() == warned); // said once

  for (int i = 0; i < 5; ++i)
  {
    file.RemoveFrame(i, "Timestamp");
  }
  ReaderOf none(file.GetContent());
  none.Reader->ReplayInTimeOn();
  none.Reader->UpdateTimeStep(2);
  CheckStack(none.Reader, 3, 5);
  LACUNA_CHECK_CONTAINS(none.Warnings, "no slice has a Timestamp");
}

// Over 4 GiB long, a few kilobytes on disk: only what is asked for is read.
void TestSparseFile()
{
  const int frames = 6000;
  SequenceFile file = MakeSequence(frames, 1, 1);
  file.Set("DimSize", "1024 1024 " + std::to_string(frames));
  file.Pixels.clear();
  ReaderOf test(file.GetContent());
  const auto header = static_cast<std::uintmax_t>(file.GetHeader().size());
  const std::uintmax_t frameSize = 1024 * 1024;
  std::error_code error;
  std::filesystem::resize_file(test.File.GetPath(), header + frames * frameSize, error);
  if (error)
  {
    std::cout << "no sparse files here: " << error.message() << "\n";
    return;
  }
  {
    std::fstream stream(test.File.GetPath(), std::ios::binary | std::ios::in | std::ios::out);
    for (const int frame : { 4500, 5997, 5999 })
    {
      stream.seekp(static_cast<std::streamoff>(header + frame * frameSize + 5 * 1024 + 7));
      stream << static_cast<char>(frame % 251);
    }
  }
  vtkLacunaTrackedSliceReader* reader = test.Reader;
  reader->SetMemoryLimit(8); // MiB: not the whole file
  reader->SetFrameRange(frames - 3, -1);
  reader->Update();
  vtkImageData* output = reader->GetOutput();
  LACUNA_CHECK(output->GetDimensions()[2] == 3 && output->GetOrigin()[2] == frames - 3);
  LACUNA_CHECK(output->GetScalarComponentAsDouble(7, 5, 0, 0) == 5997 % 251);
  LACUNA_CHECK(output->GetScalarComponentAsDouble(7, 5, 1, 0) == 0);
  LACUNA_CHECK(output->GetScalarComponentAsDouble(7, 5, 2, 0) == 5999 % 251);
  LACUNA_CHECK(output->GetScalarComponentAsDouble(8, 5, 2, 0) == 0);
  reader->SetFrameRange(0, -1);
  reader->SetFrameStride(1500); // 0, 1500, 3000, 4500
  reader->Update();
  LACUNA_CHECK(output->GetDimensions()[2] == 4);
  LACUNA_CHECK(output->GetScalarComponentAsDouble(7, 5, 3, 0) == 4500 % 251);
  LACUNA_CHECK(test.Errors.empty());
  reader->SetFrameStride(1);
  reader->ReplayInTimeOn(); // of a preview: 0, 750, 1500, ...
  reader->Update();
  LACUNA_CHECK(output->GetDimensions()[2] == 8 && output->GetSpacing()[2] == 750);
  LACUNA_CHECK(output->GetScalarComponentAsDouble(7, 5, 6, 0) == 4500 % 251);
  LACUNA_CHECK_CONTAINS(test.Warnings, "this is a preview of every 750th of 6000 slices");
}
}

int TestTrackedSliceReplay(int, char*[])
{
  TestOffByDefault();
  TestGrowing(MakeSequence(6).GetContent());
  TestGrowing(Compressed(MakeSequence(6)).GetContent());
  TestClocks();
  TestSparseFile();
  return lacunaCheck::Result();
}
