// SPDX-License-Identifier: BSD-3-Clause
// What is said of settings that cannot be, without any device.
#include "lacunaCheck.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkLacunaPolhemusVideoSource.h"

#include <chrono>
#include <sstream>
#include <string>
#include <thread>

namespace
{
// Polls until a message has these words, for at most a minute.
void CheckMessage(vtkLacunaPolhemusVideoSource* source, const std::string& words)
{
  for (int i = 0; i < 6000; ++i)
  {
    source->Poll();
    source->Update();
    if (std::string(source->GetMessage()).find(words) != std::string::npos)
    {
      return;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  LACUNA_CHECK_CONTAINS(std::string(source->GetMessage()), words);
}

void TestDormant()
{
  vtkNew<vtkLacunaPolhemusVideoSource> source;
  const auto messages = lacunaCheck::Watch(source);
  source->Update(); // opens nothing
  LACUNA_CHECK(source->GetOutput(0)->GetNumberOfPoints() == 0);
  vtkImageData* newest = source->GetOutput(1); // ready to be shown
  LACUNA_CHECK(newest->GetDimensions()[0] == 768 && newest->GetDimensions()[2] == 1);
  LACUNA_CHECK(newest->GetScalarRange()[0] == 0 && newest->GetScalarRange()[1] == 255);
  LACUNA_CHECK(newest->GetFieldData()->GetArray("SliceStatus")->GetComponent(0, 0) == 3);
  LACUNA_CHECK(messages->Errors.empty() && messages->Warnings.empty());
  LACUNA_CHECK(!source->GetNeedsUpdate()); // nothing new
  LACUNA_CHECK(!source->GetTrackerWorks());
  LACUNA_CHECK_CONTAINS(std::string(source->GetMessage()), "Connect");
  source->Stop();
  source->Clear();
  source->Disconnect();
  LACUNA_CHECK(source->GetSliceCount() == 0 && source->GetSpeed() != source->GetSpeed());
  LACUNA_CHECK(source->GetTakenSlices() == 0 && source->GetWaitingSlices() == 0);
  LACUNA_CHECK(source->GetMemoryUsed() == 0 && source->GetMemoryLimitNow() == 0);
  LACUNA_CHECK(source->GetDiskSpace() != source->GetDiskSpace());
  std::ostringstream text;
  source->Print(text);
  LACUNA_CHECK_CONTAINS(text.str(), "BaudRate: 115200 (from 2400 to 115200)");
  LACUNA_CHECK_CONTAINS(text.str(), "SpeedLimit: 23 (0 (no limit) or above 0 mm/s)");
}

void TestNothingSet()
{
  vtkNew<vtkLacunaPolhemusVideoSource> source;
  const auto messages = lacunaCheck::Watch(source);
  source->Connect();
  CheckMessage(source, "TrackerConnection is not set");
  CheckMessage(source, "VideoURL is not set");
  CheckMessage(source, "/dev/video0");
  LACUNA_CHECK(messages->HasWarning("not calibrated"));
  LACUNA_CHECK(messages->HasWarning("TrackerConnection is not set"));
  LACUNA_CHECK(messages->Errors.empty());
  const std::size_t length = messages->Warnings.size();
  for (int i = 0; i < 100; ++i)
  {
    source->Poll();
    source->Update();
  }
  LACUNA_CHECK(messages->Warnings.size() == length); // each is said once
}

void TestSettings()
{
  const auto refuses = [](const auto& change, const char* words)
  {
    vtkNew<vtkLacunaPolhemusVideoSource> source;
    const auto messages = lacunaCheck::Watch(source);
    change(source.Get());
    source->Start();
    LACUNA_CHECK_CONTAINS(messages->Errors, words);
    LACUNA_CHECK(!source->GetCapturing());
    LACUNA_CHECK_CONTAINS(std::string(source->GetMessage()), words);
    source->Update(); // and the pipeline goes on
  };
  refuses([](auto* source) { source->SetMovementThreshold(-1); }, "MovementThreshold");
  refuses([](auto* source) { source->SetSpeedLimit(-1); }, "SpeedLimit");
  refuses([](auto* source) { source->SetTimeOffset(3); }, "TimeOffset");
  refuses([](auto* source) { source->SetHoldLastPose(-1); }, "HoldLastPose");
  refuses(
    [](auto* source) { source->SetCropRectangle(-1, 0, 0, 0); }, "CropRectangle is -1 pixels");
  refuses([](auto* source) { source->SetRecordFileName("sweep.mha"); }, ".mhd or .nhdr");
  refuses([](auto* source) { source->SetCalibrationFileName("/none.xml"); }, "/none.xml");

  // a setting that is mended is taken
  vtkNew<vtkLacunaPolhemusVideoSource> source;
  const auto messages = lacunaCheck::Watch(source);
  source->Connect();
  source->SetTimeOffset(3);
  source->Update();
  LACUNA_CHECK(messages->HasError("TimeOffset"));
  messages->Errors.clear();
  source->Update();
  LACUNA_CHECK(messages->Errors.empty());
  source->SetTimeOffset(0.1);
  source->Update();
  LACUNA_CHECK(messages->Errors.empty());
  LACUNA_CHECK(std::string(source->GetMessage()).find("TimeOffset") == std::string::npos);
  source->SetStation(7);
  source->Update();
  LACUNA_CHECK(messages->HasError("Station is 7; it must be from 1 to 4"));
  CheckMessage(source, "Station is 7");
  source->SetStation(1);
  source->SetTrackerConnection("/dev/ttyLacunaNone");
  source->Update();
  CheckMessage(source, "There is no port /dev/ttyLacunaNone");
}
}

int TestPolhemusVideoSourceSettings(int, char*[])
{
  TestDormant();
  TestNothingSet();
  TestSettings();
  return lacunaCheck::Result();
}
