// SPDX-License-Identifier: BSD-3-Clause
// What vtkLacunaPolhemusVideoSource tells of an acquisition's state.
#include "vtkLacunaLiveSweep.h"
#include "vtkLacunaPolhemusVideoSource.h"

#include <algorithm>
#include <limits>

namespace
{
constexpr double Mebibyte = 1024 * 1024;
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
  this->Now->DiskMessage = this->Now->GetSweepState().File.Trouble;
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
