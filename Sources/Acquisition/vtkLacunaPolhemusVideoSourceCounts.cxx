// SPDX-License-Identifier: BSD-3-Clause
// What vtkLacunaPolhemusVideoSource tells of its state, in figures and in words.
#include "lacunaLiveSweep.h"
#include "lacunaPrintableText.h"
#include "vtkLacunaPolhemusVideoSource.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

namespace
{
constexpr double Mebibyte = 1024 * 1024;
}

//------------------------------------------------------------------------------
vtkIdType vtkLacunaPolhemusVideoSource::GetSliceCount() const
{
  return this->Now->Stack ? this->Now->Stack->GetNumberOfSlices() : 0;
}

//------------------------------------------------------------------------------
bool vtkLacunaPolhemusVideoSource::GetCapturing() const
{
  return this->Now->GetState().Capturing;
}

//------------------------------------------------------------------------------
bool vtkLacunaPolhemusVideoSource::GetTrackerWorks() const
{
  return this->Now->GetState().TrackerWorks;
}

//------------------------------------------------------------------------------
bool vtkLacunaPolhemusVideoSource::GetVideoWorks() const
{
  return this->Now->GetState().VideoWorks;
}

//------------------------------------------------------------------------------
vtkIdType vtkLacunaPolhemusVideoSource::GetFrameCount() const
{
  return this->Now->GetSweepState().Counts.Frames;
}

//------------------------------------------------------------------------------
vtkIdType vtkLacunaPolhemusVideoSource::GetStillFrames() const
{
  return this->Now->GetSweepState().Counts.Still;
}

//------------------------------------------------------------------------------
vtkIdType vtkLacunaPolhemusVideoSource::GetFramesWithoutPose() const
{
  return this->Now->GetSweepState().Counts.WithoutPose;
}

//------------------------------------------------------------------------------
vtkIdType vtkLacunaPolhemusVideoSource::GetFramesOfWrongSize() const
{
  return this->Now->GetSweepState().Counts.WrongSize;
}

//------------------------------------------------------------------------------
vtkIdType vtkLacunaPolhemusVideoSource::GetFramesPastLimit() const
{
  return this->Now->GetSweepState().Counts.PastLimit;
}

//------------------------------------------------------------------------------
vtkIdType vtkLacunaPolhemusVideoSource::GetMissingFrames() const
{
  return this->Now->GetSweepState().Missing;
}

//------------------------------------------------------------------------------
vtkIdType vtkLacunaPolhemusVideoSource::GetTooFastSlices() const
{
  return this->Now->GetSweepState().Counts.TooFast;
}

//------------------------------------------------------------------------------
double vtkLacunaPolhemusVideoSource::GetSpeed() const
{
  return this->Now->GetState().Speed.value_or(std::numeric_limits<double>::quiet_NaN());
}

//------------------------------------------------------------------------------
double vtkLacunaPolhemusVideoSource::GetLargestResidual() const
{
  return this->Now->GetSweepState().LargestResidual;
}

//------------------------------------------------------------------------------
vtkIdType vtkLacunaPolhemusVideoSource::GetTakenSlices() const
{
  return std::max<vtkIdType>(this->Now->GetSweepState().Counts.Slices, this->GetSliceCount());
}

//------------------------------------------------------------------------------
vtkIdType vtkLacunaPolhemusVideoSource::GetRecordedSlices() const
{
  return this->Now->GetSweepState().File.Synced;
}

//------------------------------------------------------------------------------
vtkIdType vtkLacunaPolhemusVideoSource::GetVerifiedSlices() const
{
  return this->Now->GetSweepState().File.Verified;
}

//------------------------------------------------------------------------------
const char* vtkLacunaPolhemusVideoSource::GetRecordedFileName()
{
  this->Now->FileName = this->Now->GetSweepState().File.FileName;
  return this->Now->FileName.c_str();
}

//------------------------------------------------------------------------------
vtkIdType vtkLacunaPolhemusVideoSource::GetWaitingSlices() const
{
  const lacuna::SweepFile::State file = this->Now->GetSweepState().File;
  return file.Added - file.Synced;
}

//------------------------------------------------------------------------------
double vtkLacunaPolhemusVideoSource::GetDiskSpace() const
{
  const std::int64_t bytes = this->Now->GetSweepState().File.FreeBytes;
  return bytes < 0 ? std::numeric_limits<double>::quiet_NaN()
                   : static_cast<double>(bytes) / Mebibyte;
}

//------------------------------------------------------------------------------
const char* vtkLacunaPolhemusVideoSource::GetDiskMessage()
{
  const lacuna::SweepFile::State file = this->Now->GetSweepState().File;
  this->Now->DiskMessage = lacuna::ToPrintable(file.Trouble.empty() ? file.Notice : file.Trouble);
  return this->Now->DiskMessage.c_str();
}

//------------------------------------------------------------------------------
double vtkLacunaPolhemusVideoSource::GetMemoryUsed() const
{
  std::int64_t bytes = 0;
  if (this->Now->Stack)
  {
    const std::array<int, 4> window = this->Now->Stack->GetWindow();
    bytes = this->Now->Stack->GetNumberOfSlices() * window[2] * window[3];
  }
  return static_cast<double>(std::max(bytes, this->Now->GetState().Memory)) / Mebibyte;
}

//------------------------------------------------------------------------------
double vtkLacunaPolhemusVideoSource::GetMemoryLimitNow() const
{
  return static_cast<double>(this->Now->LimitBytes) / Mebibyte;
}

//------------------------------------------------------------------------------
// What is to be done with slices before others can be taken; empty: nothing.
std::string vtkLacunaPolhemusVideoSource::DescribeKept() const
{
  const lacuna::LiveSweep& now = *this->Now;
  if (!now.StackIsOfOthers)
  {
    return {};
  }
  return (now.Past.File.Trouble.empty() ? "" : now.Past.File.Trouble + "\n") + "There are " +
    std::to_string(this->GetSliceCount()) +
    " slices of devices that have been closed: save them, Clear, then Start" +
    (this->ButtonStarts ? "; before that the button does nothing" : "");
}

//------------------------------------------------------------------------------
const char* vtkLacunaPolhemusVideoSource::GetMessage()
{
  lacuna::LiveSweep& now = *this->Now;
  std::string text = now.Trouble;
  const auto add = [&text](const std::string& line)
  { text += (text.empty() || line.empty() ? "" : "\n") + line; };
  add(now.Acquisition ? "" : "The devices are not open: Connect, or Start");
  add(this->DevicesWait() ? lacuna::LiveSweep::WaitingText : "");
  add(this->ButtonStarts && now.Acquisition && !now.Trouble.empty()
      ? "Mend that before you start; the button does nothing now"
      : "");
  add(now.MemoryTrouble);
  add(this->DescribeKept());
  const lacuna::AcquisitionState state = now.GetState();
  std::for_each(state.Messages.begin(), state.Messages.end(), add);
  std::for_each(state.Notes.begin(), state.Notes.end(), add);
  now.Messages = lacuna::ToPrintable(text);
  return now.Messages.c_str();
}
