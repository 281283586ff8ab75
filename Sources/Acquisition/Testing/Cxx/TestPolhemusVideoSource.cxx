// SPDX-License-Identifier: BSD-3-Clause
// An emulated FASTRAK behind the real libserialport, and a test signal of FFmpeg.
#include "lacunaClock.h"
#include "lacunaFieldData.h"
#include "lacunaProvenance.h"
#include "lacunaTestBench.h"
#include "lacunaTrackedSlices.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkLacunaTrackedSliceReader.h"
#include "vtkPointData.h"
#include "vtkUnsignedCharArray.h"

#include <cstring>
#include <string>

using namespace lacunaTest;

namespace
{
void TestSlices()
{
  Bench bench([](double, int) { return Still; });
  vtkLacunaPolhemusVideoSource* source = bench.Source;
  source->SetMemoryLimit(64);
  source->SetCropRectangle(10, 20, 0, 16);
  source->SetRecordFileName((bench.Folder + "/sweep.mhd").c_str());
  source->Connect();
  LACUNA_CHECK(bench.IsConnected());
  LACUNA_CHECK(bench.PollUntil(
    [&]
    {
      source->Update(); // dormant display
      return source->GetOutput(1)->GetDimensions()[0] == 54;
    }));
  LACUNA_CHECK(source->GetOutput(0)->GetNumberOfPoints() == 0);
  LACUNA_CHECK(source->GetOutput(1)->GetOrigin()[0] == 10);

  source->Start();
  LACUNA_CHECK(source->GetCapturing());
  LACUNA_CHECK(bench.PollFor(5));
  source->Update();
  vtkImageData* output = source->GetOutput(0);
  vtkNew<vtkImageData> early;
  early->ShallowCopy(output);
  const void* memory = output->GetScalarPointer();
  const int before = output->GetDimensions()[2];
  LACUNA_CHECK(output->GetFieldData()->GetArray("ImageToReference") == nullptr);
  LACUNA_CHECK(bench.Messages->HasWarning("not calibrated"));

  // while it goes on the probe is calibrated, and what was taken is too
  const lacuna::Matrix4 imageToProbe =
    lacuna::Matrix4::Translation({ 3, 5, 7 }) * lacuna::Matrix4::Scaling({ 0.25, 0.5, 0.35 });
  source->SetCalibrationFileName(bench.WriteCalibration(imageToProbe).c_str());
  LACUNA_CHECK(bench.PollFor(before + 10));
  source->Update();
  LACUNA_CHECK(bench.PollFor(before + 20));
  const lacuna::SteadyClock clock;
  const double begin = clock.Now();
  source->Stop();
  std::cout << "stopped after " << clock.Now() - begin << " s\n";
  LACUNA_CHECK(!source->GetCapturing());
  source->Update();
  vtkNew<vtkImageData> kept; // polling makes outputs anew
  kept->ShallowCopy(output);
  output = kept;
  const int count = output->GetDimensions()[2];
  LACUNA_CHECK(count == source->GetSliceCount() && count >= before + 20);
  LACUNA_CHECK(output->GetScalarPointer() == memory); // nothing was copied
  LACUNA_CHECK(early->GetDimensions()[2] == before);
  LACUNA_CHECK(output->GetDimensions()[0] == 54 && output->GetDimensions()[1] == 16);
  LACUNA_CHECK(output->GetOrigin()[0] == 10 && output->GetOrigin()[1] == 20);
  LACUNA_CHECK(source->GetFrameCount() == count);

  const lacuna::TrackedSlices slices(output);
  vtkDataArray* probe = lacuna::FieldData::Get(output, "ProbeToTracker", 16, count);
  vtkDataArray* frames = lacuna::FieldData::Get(output, "FrameNumber", 1, count);
  vtkDataArray* residuals = lacuna::FieldData::Get(output, "Residual", 1, count);
  lacuna::FieldData::Get(output, "Speed", 1, count);
  for (vtkIdType i = 0; i < count; ++i)
  {
    // a busy computer may make slices without a pose, but never wrong ones
    const bool valid = slices.IsUsable(i);
    const lacuna::Matrix4 pose = lacuna::FieldData::GetMatrix(probe, i);
    LACUNA_CHECK(valid == pose.IsFinite());
    LACUNA_CHECK(!valid || Distance(pose, Still) < 1e-3);
    LACUNA_CHECK(!valid || Distance(slices.GetImageToReference(i), pose * imageToProbe) < 1e-9);
    LACUNA_CHECK(
      !valid || (residuals->GetComponent(i, 0) >= 0 && residuals->GetComponent(i, 0) < 0.126));
    LACUNA_CHECK(i == 0 || frames->GetComponent(i, 0) == frames->GetComponent(i - 1, 0) + 1);
    LACUNA_CHECK(i == 0 || slices.GetTimestamp(i) > slices.GetTimestamp(i - 1));
  }
  LACUNA_CHECK(
    Distance(lacuna::FieldData::GetMatrix(lacuna::FieldData::Get(output, "ImageToProbe", 16, 1), 0),
      imageToProbe) < 1e-12);
  const std::vector<std::string> provenance = lacuna::Provenance::Get(output);
  LACUNA_CHECK(provenance.size() == 1);
  LACUNA_CHECK_CONTAINS(provenance[0], "VideoURL=\"lavfi:testsrc2=size=64x48:rate=25\"");

  // the range is told, not looked for; by and by, as the slices came
  vtkDataArray* intensity = output->GetPointData()->GetScalars();
  LACUNA_CHECK(intensity->HasInformation() &&
    intensity->GetInformation()->Has(vtkAbstractArray::PER_COMPONENT()));
  vtkNew<vtkUnsignedCharArray> copy;
  copy->SetArray(
    static_cast<unsigned char*>(intensity->GetVoidPointer(0)), intensity->GetNumberOfTuples(), 1);
  for (int i = 0; i < 2; ++i)
  {
    LACUNA_CHECK(intensity->GetRange()[i] == copy->GetRange()[i]);
    LACUNA_CHECK(intensity->GetFiniteRange()[i] == copy->GetFiniteRange()[i]);
  }

  // what is on the disk is the same
  LACUNA_CHECK(bench.PollUntil([&] { return source->GetRecordedSlices() == count; }));
  LACUNA_CHECK(source->GetTakenSlices() == count && source->GetWaitingSlices() == 0);
  LACUNA_CHECK(source->GetDiskSpace() > 0 && std::string(source->GetDiskMessage()).empty());
  LACUNA_CHECK(source->GetMemoryUsed() * 1024 * 1024 == count * 54.0 * 16);
  LACUNA_CHECK(source->GetMemoryLimitNow() == 64);
  vtkNew<vtkLacunaTrackedSliceReader> reader;
  LACUNA_CHECK(std::string(source->GetRecordedFileName()) == bench.Folder + "/sweep.mhd");
  reader->SetFileName(source->GetRecordedFileName());
  reader->SetCalibrationFileName(source->GetCalibrationFileName());
  reader->Update();
  vtkImageData* read = reader->GetOutput();
  LACUNA_CHECK(read->GetNumberOfPoints() == output->GetNumberOfPoints());
  LACUNA_CHECK(std::memcmp(read->GetScalarPointer(), output->GetScalarPointer(),
                 static_cast<std::size_t>(output->GetNumberOfPoints())) == 0);
  LACUNA_CHECK(read->GetOrigin()[0] == 10 && read->GetOrigin()[1] == 20);
  LACUNA_CHECK(!read->GetFieldData()->HasArray("FirstColumn")); // would be wrong of a part of it
  const lacuna::TrackedSlices again(read);
  for (vtkIdType i = 0; i < count; ++i)
  {
    LACUNA_CHECK(again.GetStatus(i) == slices.GetStatus(i));
    LACUNA_CHECK(again.GetTimestamp(i) == slices.GetTimestamp(i));
    LACUNA_CHECK(!slices.IsUsable(i) ||
      Distance(again.GetImageToReference(i), slices.GetImageToReference(i)) < 1e-9);
    LACUNA_CHECK(!slices.IsUsable(i) ||
      Distance(lacuna::FieldData::GetMatrix(read->GetFieldData()->GetArray("ProbeToTracker"), i),
        lacuna::FieldData::GetMatrix(probe, i)) < 1e-12);
  }

  source->Clear();
  source->Update();
  LACUNA_CHECK(source->GetSliceCount() == 0 && source->GetOutput(0)->GetNumberOfPoints() == 0);
  LACUNA_CHECK(early->GetPointData()->GetScalars()->GetNumberOfTuples() == before * 54 * 16);
  LACUNA_CHECK(bench.Messages->Errors.empty());
}

void TestMovement()
{
  // rests for a while, then goes 10 mm
  const lacuna::SteadyClock clock;
  const double begin = clock.Now();
  Bench bench(
    [begin](double time, int)
    {
      const double way = std::min(std::max(time - begin - 6, 0.0), 1.0) * 10;
      return lacuna::Matrix4::Translation({ 200 + way, 0, 0 });
    });
  vtkLacunaPolhemusVideoSource* source = bench.Source;
  source->SetCaptureMode(vtkLacunaPolhemusVideoSource::Movement);
  source->SetMovementThreshold(1);
  source->SetSpeedLimit(5);
  source->Start();
  LACUNA_CHECK(bench.PollFor(2));
  LACUNA_CHECK(clock.Now() > begin + 6);
  bool warned = false;
  LACUNA_CHECK(bench.PollUntil(
    [&]
    {
      warned = warned || std::string(source->GetMessage()).find("Too fast") != std::string::npos;
      return clock.Now() > begin + 8;
    }));
  source->Stop();
  LACUNA_CHECK(source->GetSliceCount() >= 3 && source->GetSliceCount() <= 11);
  LACUNA_CHECK(source->GetStillFrames() > 10);
  LACUNA_CHECK(source->GetTooFastSlices() >= 1 && warned);
  LACUNA_CHECK(bench.Messages->HasWarning("SpeedLimit"));
}
}

int TestPolhemusVideoSource(int, char*[])
{
  TestSlices();
  TestMovement();
  return lacunaCheck::Result();
}
