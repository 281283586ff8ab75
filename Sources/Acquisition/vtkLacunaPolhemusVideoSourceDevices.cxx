// SPDX-License-Identifier: BSD-3-Clause
// How vtkLacunaPolhemusVideoSource opens its devices and makes its acquisition what the properties say.
#include "lacunaLiveSweep.h"
#include "lacunaPrintableText.h"
#include "lacunaProbeFrames.h"
#include "vtkLacunaPolhemusVideoSource.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

namespace
{
constexpr std::int64_t Mebibyte = 1024 * 1024;

std::string Text(const char* s)
{
  return s ? s : "";
}

// Changes when the file does.
std::string DescribeVersion(const std::string& fileName)
{
  std::error_code none;
  const auto time = std::filesystem::last_write_time(fileName, none).time_since_epoch().count();
  const std::uintmax_t size = std::filesystem::file_size(fileName, none);
  return none ? "" : std::to_string(time) + " " + std::to_string(size);
}
}

//------------------------------------------------------------------------------
// Those that the kernel knows, too.
lacuna::AcquisitionRules vtkLacunaPolhemusVideoSource::GetRules() const
{
  lacuna::AcquisitionRules rules;
  rules.Mode = static_cast<lacuna::CaptureMode>(this->CaptureMode);
  rules.MovementThreshold = this->MovementThreshold;
  rules.SpeedLimit = this->SpeedLimit;
  rules.TimeOffset = this->TimeOffset;
  rules.HoldLastPose = this->HoldLastPose;
  return rules;
}

//------------------------------------------------------------------------------
void vtkLacunaPolhemusVideoSource::ListRules(lacuna::Properties& properties) const
{
  using lacuna::ValueRange;
  properties.Add("CalibrationFileName", this->CalibrationFileName)
    .Add(
      "PixelSpacing", this->PixelSpacing, ValueRange::Above(0, "mm").OrZero("of the calibration"));
  this->GetRules().Describe(properties);
  properties
    .Add("MemoryLimit", this->MemoryLimit,
      ValueRange::AtLeast(1, "MiB").OrZero("half of the free memory"))
    .Add("RecordFileName", this->RecordFileName)
    .Add("RecordCompression", this->RecordCompression, lacuna::AcquisitionRules::CompressionRange);
}

//------------------------------------------------------------------------------
std::string vtkLacunaPolhemusVideoSource::DescribeRules() const
{
  lacuna::Properties properties;
  this->ListRules(properties);
  return properties.GetText();
}

//------------------------------------------------------------------------------
void vtkLacunaPolhemusVideoSource::Open()
{
  lacuna::LiveSweep& now = *this->Now;
  this->Close(); // ports are free for the next
  now.Acquisition = std::make_unique<lacuna::SweepAcquisition>(
    this->MakeDevices(now.GetClock()), lacuna::AcquisitionRules(), now.GetClock());
  now.Tracker = this->DescribeTracker();
  now.Video = this->DescribeVideo();
  now.Crop = this->DescribeCrop();
  now.FreeBytes = now.FindFreeBytes();
  now.NewestNumber = -1; // frames are counted anew
}

//------------------------------------------------------------------------------
// The slices stay, and what is told of them.
void vtkLacunaPolhemusVideoSource::Close()
{
  lacuna::LiveSweep& now = *this->Now;
  if (!now.Acquisition)
  {
    return;
  }
  const lacuna::AcquisitionState past = now.Acquisition->Finish();
  this->GetNeedsUpdate(); // the last slices: after Finish there are no more
  if (now.Stack && !now.StackIsOfOthers)
  {
    now.Past = past;
    now.StackIsOfOthers = true;
    if (const std::int64_t unwritten = now.GetUnwritten(); unwritten > 0)
    {
      now.Past.File.Trouble = std::to_string(unwritten) + " of " +
        std::to_string(now.Past.File.Added) +
        " slices could not be recorded and are only in memory: save the sweep (Save Data)";
      vtkWarningMacro(<< now.Past.File.Trouble);
    }
  }
  now.Acquisition.reset();
}

//------------------------------------------------------------------------------
// Whether others were chosen.
bool vtkLacunaPolhemusVideoSource::DevicesDiffer() const
{
  const lacuna::LiveSweep& now = *this->Now;
  return this->DescribeTracker() != now.Tracker || this->DescribeVideo() != now.Video ||
    this->DescribeCrop() != now.Crop;
}

//------------------------------------------------------------------------------
// And a capture does not change them.
bool vtkLacunaPolhemusVideoSource::DevicesWait() const
{
  const lacuna::LiveSweep& now = *this->Now;
  return now.Acquisition && this->DevicesDiffer() && now.Acquisition->GetState().Capturing;
}

//------------------------------------------------------------------------------
// A capture goes on with another device in the place of one that does not work: a plug that came
// back by another name, a wrong baud rate.
void vtkLacunaPolhemusVideoSource::ReplaceBrokenDevices()
{
  lacuna::LiveSweep& now = *this->Now;
  const lacuna::AcquisitionState state = now.GetState();
  if (!state.Capturing)
  {
    return; // they are opened anew
  }
  if (!state.TrackerWorks && this->DescribeTracker() != now.Tracker)
  {
    now.Acquisition->ReplaceTracker(this->MakeDevices(now.GetClock()));
    now.Tracker = this->DescribeTracker();
  }
  if (!state.VideoWorks && this->DescribeVideo() != now.Video)
  {
    now.Acquisition->ReplaceVideo(this->MakeDevices(now.GetClock()));
    now.Video = this->DescribeVideo();
  }
}

//------------------------------------------------------------------------------
// Makes the acquisition what the properties say; an error says why it cannot be, once.
void vtkLacunaPolhemusVideoSource::Configure()
{
  lacuna::LiveSweep& now = *this->Now;
  this->ReplaceBrokenDevices();
  const bool wait = this->DevicesWait();
  if (wait && now.Subjects.try_emplace("devices", 0).second)
  {
    vtkWarningMacro(<< lacuna::LiveSweep::WaitingText);
  }
  const bool reopen = !now.Acquisition || (this->DevicesDiffer() && !wait);
  const std::string calibration = Text(this->CalibrationFileName);
  const std::string tried = (wait ? now.DescribeDevices() : this->DescribeDevices()) +
    this->DescribeRules() + DescribeVersion(calibration) + (wait ? " wait" : "");
  if (tried == now.Tried && (now.Acquisition || !now.Trouble.empty()))
  {
    return;
  }
  now.Tried = tried;
  try
  {
    this->Described::CheckProperties();
    // One that is chosen together with other devices is theirs.
    const bool keepsCalibration = wait && now.Calibration.Calibrated;
    const lacuna::AcquisitionRules rules = this->MakeRules(keepsCalibration);
    if (reopen)
    {
      this->Open();
    }
    this->Apply(rules, keepsCalibration);
    if (calibration.empty() && !now.ToldUncalibrated)
    {
      vtkWarningMacro("The probe is not calibrated: slices have no ImageToReference. Set "
                      "CalibrationFileName, also later");
    }
    now.ToldUncalibrated = calibration.empty();
    now.Trouble.clear();
  }
  catch (const std::exception& e)
  {
    now.Trouble = e.what();
    vtkErrorMacro(<< lacuna::ToPrintable(now.Trouble));
    if (this->ButtonStarts && now.Acquisition && !now.GetState().Capturing)
    {
      now.Rules.ButtonStarts = false; // as Start, which does nothing with rules that are not wanted
      now.Acquisition->SetRules(now.Rules);
    }
  }
}

//------------------------------------------------------------------------------
// What the properties say; keepsCalibration: with the calibration that holds now. Throws.
lacuna::AcquisitionRules vtkLacunaPolhemusVideoSource::MakeRules(bool keepsCalibration)
{
  const lacuna::LiveSweep& now = *this->Now;
  const std::string calibration = Text(this->CalibrationFileName);
  lacuna::AcquisitionRules rules = this->GetRules();
  if (!calibration.empty())
  {
    const lacuna::ProbeFrames frames = lacuna::ReadProbeFrames(calibration, this->PixelSpacing);
    rules.ImageToProbe = frames.ImageToProbe;
    rules.TrackerToReference = frames.TrackerToReference;
    if (!frames.Warning.empty())
    {
      vtkWarningMacro(<< lacuna::ToPrintable(calibration + ": " + frames.Warning));
    }
  }
  if (keepsCalibration)
  {
    rules.ImageToProbe = now.Calibration.ImageToProbe;
    rules.TrackerToReference = now.Calibration.TrackerToReference;
  }
  rules.RecordFileName = Text(this->RecordFileName);
  rules.RecordCompressionLevel = this->RecordCompression;
  rules.MemoryLimit = this->MemoryLimit * Mebibyte;
  lacuna::CheckRules(rules);
  return rules;
}

//------------------------------------------------------------------------------
// Gives the rules to the devices that are open now, and the calibration to the slices they took.
void vtkLacunaPolhemusVideoSource::Apply(lacuna::AcquisitionRules rules, bool keepsCalibration)
{
  lacuna::LiveSweep& now = *this->Now;
  rules.ButtonStarts = this->ButtonStarts && !now.StackIsOfOthers;
  if (this->MemoryLimit == 0)
  {
    rules.MemoryLimit = now.FreeBytes / 2;
  }
  now.Acquisition->SetRules(rules);
  now.Rules = rules;
  now.LimitBytes = rules.MemoryLimit;
  now.Calibration.Calibrated = rules.ImageToProbe.has_value();
  now.Calibration.ImageToProbe = rules.ImageToProbe.value_or(lacuna::Matrix4());
  now.Calibration.TrackerToReference = rules.TrackerToReference;
  if (!now.StackIsOfOthers && !keepsCalibration) // else another probe may have taken them
  {
    now.TakenBy = now.DescribeDevices() + " " + this->DescribeRules();
    if (now.Stack)
    {
      now.Stack->Calibrate(now.Calibration);
    }
  }
}

//------------------------------------------------------------------------------
void vtkLacunaPolhemusVideoSource::Connect()
{
  this->Now->Tried.clear(); // asked for: tries again what failed
  this->Configure();
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkLacunaPolhemusVideoSource::Disconnect()
{
  if (this->Now->Acquisition)
  {
    this->Close();
    this->Now->Subjects.clear();
    this->Modified();
  }
}
