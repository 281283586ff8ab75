// SPDX-License-Identifier: BSD-3-Clause
// Devices that change, come late, or are set in another way, behind the real libserialport.
#include "lacunaFieldData.h"
#include "lacunaProvenance.h"
#include "lacunaTestBench.h"
#include "lacunaTrackedSlices.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkLacunaTrackedSliceReader.h"

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

using namespace lacunaTest;

namespace
{
void TestDevicesThatChange()
{
  Bench bench([](double, int) { return Still; });
  vtkLacunaPolhemusVideoSource* source = bench.Source;
  source->Start(); // opens them too
  LACUNA_CHECK(bench.PollFor(3));
  source->SetVideoURL("lavfi:testsrc2=size=32x24:rate=25");
  source->SetTimeOffset(3); // rules do not wait with them
  source->Update();
  LACUNA_CHECK(bench.Messages->HasWarning("after Stop"));
  LACUNA_CHECK_CONTAINS(std::string(source->GetMessage()), "after Stop");
  LACUNA_CHECK(bench.Messages->HasError("TimeOffset"));
  bench.Messages->Errors.clear();
  source->SetTimeOffset(0);
  source->SetCalibrationFileName(
    bench.WriteCalibration(lacuna::Matrix4::Scaling({ 0.5, 0.5, 0.5 })).c_str());
  source->Update();
  LACUNA_CHECK(source->GetOutput(0)->GetFieldData()->HasArray("ImageToReference"));
  LACUNA_CHECK(source->GetCapturing());
  source->Stop();
  LACUNA_CHECK(std::string(source->GetMessage()).find("after Stop") == std::string::npos);
  source->Update();
  LACUNA_CHECK(bench.IsConnected());
  const vtkIdType count = source->GetSliceCount();
  LACUNA_CHECK(count >= 3);
  source->Start();
  LACUNA_CHECK(bench.Messages->HasError("save them"));
  LACUNA_CHECK(!source->GetCapturing());
  LACUNA_CHECK(source->GetSliceCount() == count);
  source->Clear();
  source->Start();
  LACUNA_CHECK(bench.PollFor(3));
  source->Update();
  LACUNA_CHECK(source->GetOutput(0)->GetDimensions()[0] == 32);
  source->Disconnect();
  source->Update();
  LACUNA_CHECK(source->GetOutput(0)->GetDimensions()[2] >= 3);
}

// What is told of the slices holds as long as they are there, whatever becomes of the devices.
void TestFiguresStayWithTheSlices()
{
  Bench bench([](double, int) { return Still; });
  vtkLacunaPolhemusVideoSource* source = bench.Source;
  const std::string file = bench.Folder + "/sweep.mhd";
  source->SetRecordFileName(file.c_str());
  const auto check = [source, &file](vtkIdType count)
  {
    LACUNA_CHECK(source->GetSliceCount() == count);
    LACUNA_CHECK(source->GetFrameCount() == count);
    LACUNA_CHECK(source->GetTakenSlices() == count);
    LACUNA_CHECK(source->GetRecordedSlices() == count);
    LACUNA_CHECK(source->GetWaitingSlices() == 0);
    LACUNA_CHECK(file == source->GetRecordedFileName());
  };
  source->Start();
  LACUNA_CHECK(bench.PollFor(3));
  const auto grows = [source]
  {
    source->Update();
    return lacuna::TrackedSlices::IsGrowing(source->GetOutput(0));
  };
  LACUNA_CHECK(grows());
  source->Stop();
  LACUNA_CHECK(!grows());
  source->Start();
  LACUNA_CHECK(bench.PollUntil(grows));
  source->Disconnect(); // at once: the last slices are not on the disk yet
  LACUNA_CHECK(!grows());
  const vtkIdType count = source->GetSliceCount();
  check(count);
  source->Connect();
  LACUNA_CHECK(bench.IsConnected());
  check(count);
  source->SetVideoURL("lavfi:testsrc2=size=32x24:rate=25");
  source->Update();
  LACUNA_CHECK(bench.IsConnected());
  check(count);
  source->Clear();
  LACUNA_CHECK(source->GetFrameCount() == 0);
  LACUNA_CHECK(source->GetRecordedSlices() == 0);
  LACUNA_CHECK(std::string(source->GetRecordedFileName()).empty());
}

// Slices that are not on the disk are dropped by a second Clear only, also when what took them is
// gone, and each sweep is asked of anew.
void TestUnwrittenSlicesAreKept()
{
  for (const bool connectedAgain : { false, true })
  {
    Bench bench([](double, int) { return Still; });
    vtkLacunaPolhemusVideoSource* source = bench.Source;
    const auto refused = [&](const std::string& words)
    {
      source->Clear();
      LACUNA_CHECK_CONTAINS(bench.Messages->Errors, words);
      bench.Messages->Errors.clear();
    };
    const auto cleared = [&]
    {
      source->Clear();
      LACUNA_CHECK_THAT(bench.Messages->Errors.empty(), bench.Messages->Errors);
      return source->GetSliceCount() == 0;
    };
    source->SetRecordFileName((bench.Folder + "/missing/sweep.mhd").c_str());
    source->Start();
    LACUNA_CHECK(bench.PollFor(3));
    refused("missing");
    source->Start(); // more slices: of those it was not said
    LACUNA_CHECK(bench.PollFor(source->GetSliceCount() + 3));
    refused("missing");
    LACUNA_CHECK(cleared());
    source->Start();
    LACUNA_CHECK(bench.PollFor(3));
    source->Disconnect();
    const vtkIdType count = source->GetSliceCount();
    const std::string words = std::to_string(count) + " of " + std::to_string(count) + " slices";
    LACUNA_CHECK(bench.Messages->HasWarning(words));
    LACUNA_CHECK(source->GetWaitingSlices() == count);
    if (connectedAgain)
    {
      source->Connect();
      LACUNA_CHECK(bench.IsConnected());
    }
    LACUNA_CHECK_CONTAINS(std::string(source->GetMessage()), words);
    LACUNA_CHECK_CONTAINS(std::string(source->GetDiskMessage()), "only in memory");
    LACUNA_CHECK_CONTAINS(std::string(source->GetMessage()), "save them, Clear");
    LACUNA_CHECK(std::string(source->GetMessage()).find("button") == std::string::npos);
    source->SetButtonStarts(true);
    LACUNA_CHECK_CONTAINS(std::string(source->GetMessage()), "the button does nothing");
    refused(words);
    LACUNA_CHECK(source->GetSliceCount() == count);
    LACUNA_CHECK(cleared());
    LACUNA_CHECK(std::string(source->GetMessage()).find("save them") == std::string::npos);
    LACUNA_CHECK(std::string(source->GetDiskMessage()).empty());
  }
}

// A file's name that comes too late is not passed over in silence, one that is mended is taken.
void TestRecordFileNameDuringASweep()
{
  Bench bench([](double, int) { return Still; });
  vtkLacunaPolhemusVideoSource* source = bench.Source;
  source->Start();
  LACUNA_CHECK(bench.PollFor(3));
  source->SetRecordFileName((bench.Folder + "/late.mhd").c_str());
  source->Update();
  LACUNA_CHECK(bench.PollFor(source->GetSliceCount() + 3));
  LACUNA_CHECK(bench.PollUntil([&]
    { return std::string(source->GetMessage()).find("is not recorded") != std::string::npos; }));
  source->Stop();
  source->Update();
  LACUNA_CHECK(source->GetWaitingSlices() == source->GetSliceCount());
  LACUNA_CHECK_CONTAINS(std::string(source->GetDiskMessage()), "is for the next one");
  source->Clear();
  LACUNA_CHECK(bench.Messages->HasError("is not recorded") && source->GetSliceCount() > 0);
  bench.Messages->Errors.clear();
  source->Clear();
  source->SetRecordFileName((bench.Folder + "/mistyped/sweep.mhd").c_str());
  source->Start();
  LACUNA_CHECK(bench.PollFor(3));
  LACUNA_CHECK_CONTAINS(std::string(source->GetDiskMessage()), "mistyped");
  const std::string file = bench.Folder + "/sweep.mhd";
  source->SetRecordFileName(file.c_str());
  source->Update();
  LACUNA_CHECK(bench.PollFor(source->GetSliceCount() + 3));
  source->Stop();
  LACUNA_CHECK(
    bench.PollUntil([&] { return source->GetRecordedSlices() == source->GetSliceCount(); }));
  LACUNA_CHECK(file == source->GetRecordedFileName());
  source->Clear();
  LACUNA_CHECK_THAT(bench.Messages->Errors.empty(), bench.Messages->Errors);
}

// The probe is where x says; mm.
void Calibrate(const Bench& bench, double x)
{
  const std::string file = bench.WriteCalibration(
    lacuna::Matrix4::Translation({ x, 0, 0 }) * lacuna::Matrix4::Scaling({ 0.5, 0.5, 0.5 }));
  bench.Source->SetCalibrationFileName(file.c_str());
  bench.Source->Modified(); // as a poll does: of the same name
}

// Slices belong to the probe and the devices that took them.
void TestKeptSlicesStayAsTheyWere()
{
  Bench bench([](double, int) { return Still; });
  vtkLacunaPolhemusVideoSource* source = bench.Source;
  const auto has = [&](int port, double x)
  {
    source->Update();
    vtkDataArray* matrices = source->GetOutput(port)->GetFieldData()->GetArray("ImageToProbe");
    return matrices && matrices->GetComponent(0, 3) == x;
  };
  Calibrate(bench, 5);
  source->Start();
  LACUNA_CHECK(bench.PollFor(3));
  Calibrate(bench, 6); // rewritten at once: of the same length, in the same second
  LACUNA_CHECK(has(0, 6));
  source->Disconnect();
  source->SetVideoURL("lavfi:testsrc2=size=32x24:rate=25");
  Calibrate(bench, 50);
  source->Connect();
  LACUNA_CHECK(bench.PollUntil([&] { return has(1, 50); }));
  LACUNA_CHECK(has(0, 6));
  const auto names = [&](int port, const char* size) {
    return lacuna::Provenance::Get(source->GetOutput(port)).at(0).find(size) != std::string::npos;
  };
  LACUNA_CHECK(names(0, "64x48") && !names(0, "32x24"));
  LACUNA_CHECK(names(1, "32x24"));
  source->Clear();
  source->Start();
  LACUNA_CHECK(bench.PollFor(3));
  LACUNA_CHECK(has(0, 50) && names(0, "32x24"));
}

// Neither the moment of a poll nor what is chosen for the next devices changes where slices are.
void TestCalibrationsAndMoments()
{
  Bench bench([](double, int) { return Still; });
  vtkLacunaPolhemusVideoSource* source = bench.Source;
  const auto check = [&](int port, double x)
  {
    source->Update();
    vtkImageData* output = source->GetOutput(port);
    const vtkIdType count = output->GetDimensions()[2];
    LACUNA_CHECK(output->GetFieldData()->GetArray("ImageToProbe")->GetComponent(0, 3) == x);
    vtkDataArray* poses = lacuna::FieldData::Get(output, "ImageToReference", 16, count);
    vtkDataArray* probes = lacuna::FieldData::Get(output, "ProbeToTracker", 16, count);
    for (vtkIdType i = 0; i < count; ++i)
    {
      const lacuna::Matrix4 pose = lacuna::FieldData::GetMatrix(poses, i);
      LACUNA_CHECK(!pose.IsFinite() ||
        lacuna::Norm(pose.Point({ 0, 0, 0 }) -
          lacuna::FieldData::GetMatrix(probes, i).Point({ x, 0, 0 })) < 1e-9);
    }
  };
  source->Connect();
  LACUNA_CHECK(bench.IsConnected());
  source->Start();
  std::this_thread::sleep_for(std::chrono::milliseconds(500)); // slices that nobody polls
  Calibrate(bench, 5);
  source->Update();
  LACUNA_CHECK(bench.PollFor(5));
  check(0, 5);
  // for the next devices, which wait
  source->SetVideoURL("lavfi:testsrc2=size=32x24:rate=25");
  Calibrate(bench, 50);
  source->Update();
  LACUNA_CHECK_CONTAINS(std::string(source->GetMessage()), "a calibration chosen with them");
  LACUNA_CHECK(bench.PollFor(source->GetSliceCount() + 3));
  check(0, 5);
  // for these, after all
  source->SetVideoURL("lavfi:testsrc2=size=64x48:rate=25");
  source->Update();
  check(0, 50);
  Calibrate(bench, 5);
  check(0, 5);
  source->SetVideoURL("lavfi:testsrc2=size=32x24:rate=25");
  Calibrate(bench, 50);
  check(0, 5);
  source->Stop();
  source->Update();
  LACUNA_CHECK(bench.IsConnected());
  LACUNA_CHECK(bench.PollUntil(
    [&]
    {
      source->Update();
      return source->GetOutput(1)->GetDimensions()[0] == 32;
    }));
  check(0, 5);
  LACUNA_CHECK(
    source->GetOutput(1)->GetFieldData()->GetArray("ImageToProbe")->GetComponent(0, 3) == 50);
}

// What is taken is there after Disconnect, however late it came.
void TestLastSlices()
{
  Bench bench([](double, int) { return Still; });
  vtkLacunaPolhemusVideoSource* source = bench.Source;
  source->SetTimeOffset(0.95); // slices wait for poses
  source->Start();
  LACUNA_CHECK(bench.PollFor(3));
  source->Disconnect();
  LACUNA_CHECK(source->GetTakenSlices() == source->GetSliceCount());
  LACUNA_CHECK(source->GetFrameCount() == source->GetSliceCount());
  source->Clear();
  source->SetTimeOffset(0);
  // a Clear that may drop them records what it can by then
  const std::string file = bench.Folder + "/late/sweep.mhd";
  source->SetRecordFileName(file.c_str());
  source->Start();
  LACUNA_CHECK(bench.PollFor(5));
  source->Clear();
  LACUNA_CHECK(bench.Messages->HasError("Clear again"));
  bench.Messages->Errors.clear();
  const vtkIdType count = source->GetSliceCount();
  std::filesystem::create_directory(bench.Folder + "/late");
  source->Clear();
  vtkNew<vtkLacunaTrackedSliceReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  LACUNA_CHECK(reader->GetOutput()->GetDimensions()[2] == count);
}

// Half of the memory that was free when the devices were opened, whatever is changed later.
void TestMemoryLimitOfItsOwn()
{
  Bench bench([](double, int) { return Still; });
  vtkLacunaPolhemusVideoSource* source = bench.Source;
  source->Start();
  LACUNA_CHECK(bench.PollFor(3));
  const double limit = source->GetMemoryLimitNow();
  const std::vector<char> used(64 << 20, 1);
  source->SetSpeedLimit(24);
  source->Update();
  LACUNA_CHECK(source->GetMemoryLimitNow() == limit && used.back() == 1);
  source->SetMemoryLimit(100);
  source->Update();
  LACUNA_CHECK(source->GetMemoryLimitNow() == 100);
  source->SetMemoryLimit(-1); // would be no limit of one's own if it were taken for 0
  source->Update();
  LACUNA_CHECK(bench.Messages->HasError("MemoryLimit"));
  LACUNA_CHECK(source->GetMemoryLimitNow() == 100);
  source->SetMemoryLimit(100);
  source->SetRecordCompression(10);
  source->Update();
  LACUNA_CHECK(bench.Messages->HasError("RecordCompression"));
}

// The button does not put slices of other devices to those that are there, also when nobody polled
// while they were taken.
void TestButtonWithoutPolls()
{
  Bench bench([](double, int) { return Still; });
  vtkLacunaPolhemusVideoSource* source = bench.Source;
  source->SetButtonStarts(true);
  source->Connect();
  LACUNA_CHECK(bench.IsConnected());
  const auto press = [&]
  {
    for (const bool pressed : { true, false })
    {
      bench.Unit.Pressed = pressed;
      std::this_thread::sleep_for(std::chrono::milliseconds(300));
    }
  };
  press();
  press();
  source->SetVideoURL("lavfi:testsrc2=size=32x24:rate=25");
  source->Update();
  const vtkIdType count = source->GetSliceCount();
  LACUNA_CHECK(count > 0);
  LACUNA_CHECK(bench.IsConnected());
  const auto ignored = [&](const std::string& words)
  {
    LACUNA_CHECK_CONTAINS(std::string(source->GetMessage()), words);
    press();
    LACUNA_CHECK(!source->GetCapturing());
  };
  ignored("the button does nothing");
  source->Poll();
  source->Update();
  LACUNA_CHECK(source->GetSliceCount() == count);
  LACUNA_CHECK(source->GetOutput(0)->GetNumberOfPoints() == count * 64 * 48);
  // nor slices of rules that are not wanted any more
  source->Clear();
  source->Update();
  source->SetCalibrationFileName("/nowhere.xml");
  source->Update();
  ignored("the button does nothing now");
  LACUNA_CHECK(source->GetSliceCount() == 0);
  source->SetCalibrationFileName(nullptr);
  source->Update();
  press();
  LACUNA_CHECK(source->GetCapturing());
}

// What the newest slice says of the probe; not a number while it has no pose.
lacuna::Matrix4 GetNewestPose(vtkLacunaPolhemusVideoSource* source)
{
  source->Update();
  vtkImageData* output = source->GetOutput(0);
  const vtkIdType count = output->GetDimensions()[2];
  return lacuna::FieldData::GetMatrix(
    lacuna::FieldData::Get(output, "ProbeToTracker", 16, count), count - 1);
}

bool HasPose(vtkLacunaPolhemusVideoSource* source)
{
  return source->GetSliceCount() > 0 && GetNewestPose(source).IsFinite();
}

// Every way in which the unit can write its records gives the same poses.
void TestFormats()
{
  Bench bench([](double, int) { return Still; });
  vtkLacunaPolhemusVideoSource* source = bench.Source;
  for (const int format :
    { vtkLacunaPolhemusVideoSource::Ascii, vtkLacunaPolhemusVideoSource::Binary })
  {
    for (const int unit :
      { vtkLacunaPolhemusVideoSource::Inch, vtkLacunaPolhemusVideoSource::Centimetre })
    {
      source->SetRecordFormat(format);
      source->SetRecordUnit(unit);
      source->SetFiltersOff(unit == vtkLacunaPolhemusVideoSource::Inch);
      source->SetTrackerReset(format == vtkLacunaPolhemusVideoSource::Ascii
          ? vtkLacunaPolhemusVideoSource::Factory
          : vtkLacunaPolhemusVideoSource::Frames);
      source->Clear();
      source->Update();
      source->Start();
      LACUNA_CHECK(bench.PollUntil([&] { return HasPose(source); }));
      source->Stop();
      LACUNA_CHECK(Distance(GetNewestPose(source), Still) < 5e-3);
    }
  }
  LACUNA_CHECK(bench.Messages->Errors.empty());
}

// The only frame of a picture has the number of the one before's.
void TestOnePictureAfterAnother()
{
  Bench bench([](double, int) { return Still; });
  vtkLacunaPolhemusVideoSource* source = bench.Source;
  source->SetTrackerConnection("");
  for (const int columns : { 40, 56 })
  {
    const std::string url =
      "lavfi:testsrc2=rate=25:duration=0.04:size=" + std::to_string(columns) + "x24";
    source->SetVideoURL(url.c_str());
    source->Connect();
    LACUNA_CHECK(bench.PollUntil(
      [&]
      {
        source->Update();
        return source->GetOutput(1)->GetDimensions()[0] == columns ||
          std::string(source->GetMessage()).find("has ended") != std::string::npos;
      }));
    source->Poll();
    source->Update();
    LACUNA_CHECK(source->GetOutput(1)->GetDimensions()[0] == columns);
  }
}

// Each is a command that the unit gets when it is set, and only then.
void TestSettingsReachTheTracker()
{
  using Source = vtkLacunaPolhemusVideoSource;
  struct Case
  {
    const char* Command;
    std::function<void(Source*)> Set;
  };
  const std::vector<Case> cases{ { "", [](Source*) {} },
    { "F", [](Source* source) { source->SetRecordFormat(Source::Ascii); } },
    { "U", [](Source* source) { source->SetRecordUnit(Source::Inch); } },
    { "W", [](Source* source) { source->SetTrackerReset(Source::Factory); } },
    { "x", [](Source* source) { source->SetFiltersOff(true); } },
    { "H1,0.0000,0.0000,-1.0000", [](Source* source) { source->SetHemisphere(0, 0, -1); } },
    { "O1,2,4,2,4,16", [](Source* source) { source->SetButtonStarts(true); } } };
  for (const Case& test : cases)
  {
    Bench bench([](double, int) { return Still; });
    Source* source = bench.Source;
    lacuna::FastrakEmulatorOptions options = Bench::MakeOptions();
    options.Faults.Refused = *test.Command ? std::string(1, *test.Command) : "FUWx";
    const std::string link = bench.Folder + "/other";
    const EmulatedUnit unit(link, options, [](double, int) { return Still; });
    source->SetTrackerConnection(GetPort(link).c_str());
    test.Set(source);
    source->Connect();
    const std::string words = "did not understand the command '" + std::string(test.Command);
    const auto said = [&](const std::string& text)
    { return std::string(source->GetMessage()).find(text) != std::string::npos; };
    if (*test.Command)
    {
      LACUNA_CHECK(bench.PollUntil([&] { return said(words); }));
    }
    else
    {
      LACUNA_CHECK(bench.PollUntil([&] { return source->GetTrackerWorks(); }));
      LACUNA_CHECK(!said(words));
    }
  }
}

// Started without any tracker: it is taken when it is plugged in, while the capture goes on.
void TestTrackerThatComesLate()
{
  Bench bench([](double, int) { return Still; });
  vtkLacunaPolhemusVideoSource* source = bench.Source;
  const std::string link = bench.Folder + "/late";
  source->SetTrackerConnection(GetPort(link).c_str());
  source->Start();
  LACUNA_CHECK(bench.PollFor(3));
  LACUNA_CHECK(source->GetCapturing() && !source->GetTrackerWorks());
  LACUNA_CHECK_CONTAINS(std::string(source->GetMessage()), "There is no port");
  lacuna::FastrakEmulatorOptions options = Bench::MakeOptions();
  options.Faults.Silent = true; // not switched on
  {
    const EmulatedUnit unit(link, options, [](double, int) { return Still; });
    LACUNA_CHECK(bench.PollUntil([&]
      { return std::string(source->GetMessage()).find("does not answer") != std::string::npos; }));
  }
  options.Faults.Silent = false;
  const EmulatedUnit unit(link, options, [](double, int) { return Still; });
  LACUNA_CHECK(bench.PollUntil([&] { return source->GetTrackerWorks() && HasPose(source); }));
  LACUNA_CHECK(source->GetCapturing());
  LACUNA_CHECK(std::string(source->GetMessage()).find("port") == std::string::npos);
  source->Disconnect();
}

// A capture goes on with other settings of a device that does not work, and with these alone.
void TestBrokenDevicesAreReplaced()
{
  Bench bench([](double, int) { return Still; });
  vtkLacunaPolhemusVideoSource* source = bench.Source;
  source->SetBaudRate(9600);
  source->Start();
  LACUNA_CHECK(bench.PollFor(3));
  LACUNA_CHECK(bench.PollUntil(
    [&] { return std::string(source->GetMessage()).find("baud rate") != std::string::npos; }));
  const vtkIdType before = source->GetSliceCount();
  source->SetVideoURL("lavfi:testsrc2=size=32x24:rate=25"); // works: waits
  source->SetBaudRate(115200);
  source->Update();
  LACUNA_CHECK(source->GetCapturing());
  LACUNA_CHECK(bench.PollUntil([&] { return source->GetTrackerWorks() && HasPose(source); }));
  LACUNA_CHECK(source->GetSliceCount() > before);
  LACUNA_CHECK(source->GetOutput(0)->GetDimensions()[0] == 64);
  LACUNA_CHECK(Distance(GetNewestPose(source), Still) < 1e-3);
  source->SetStation(2); // of a tracker that works: waits
  source->Update();
  LACUNA_CHECK_CONTAINS(std::string(source->GetMessage()), "after Stop");
  LACUNA_CHECK(source->GetTrackerWorks());
  source->SetStation(1);
  source->Stop();

  // a video that is not there
  source->SetVideoURL("/none.avi");
  source->Clear();
  source->Update();
  source->Start();
  LACUNA_CHECK(bench.PollUntil(
    [&] { return std::string(source->GetMessage()).find("/none.avi") != std::string::npos; }));
  source->SetVideoURL("lavfi:testsrc2=size=32x24:rate=25");
  LACUNA_CHECK(bench.PollFor(3));
  LACUNA_CHECK(source->GetCapturing());
  source->Update();
  LACUNA_CHECK(source->GetOutput(0)->GetDimensions()[0] == 32);
}
}

int TestPolhemusVideoSourceDevices(int, char*[])
{
  TestDevicesThatChange();
  TestFiguresStayWithTheSlices();
  TestUnwrittenSlicesAreKept();
  TestRecordFileNameDuringASweep();
  TestKeptSlicesStayAsTheyWere();
  TestCalibrationsAndMoments();
  TestLastSlices();
  TestMemoryLimitOfItsOwn();
  TestButtonWithoutPolls();
  TestFormats();
  TestOnePictureAfterAnother();
  TestSettingsReachTheTracker();
  TestTrackerThatComesLate();
  TestBrokenDevicesAreReplaced();
  return lacunaCheck::Result();
}
