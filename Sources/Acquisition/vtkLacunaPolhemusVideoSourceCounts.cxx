// SPDX-License-Identifier: BSD-3-Clause
// What vtkLacunaPolhemusVideoSource tells of an acquisition's state.
#include "vtkLacunaLiveSweep.h"
#include "vtkLacunaPolhemusVideoSource.h"

#include <limits>

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
  return this->Now->GetState().Counts.Frames;
}

//------------------------------------------------------------------------------
vtkIdType vtkLacunaPolhemusVideoSource::GetStillFrames() const
{
  return this->Now->GetState().Counts.Still;
}

//------------------------------------------------------------------------------
vtkIdType vtkLacunaPolhemusVideoSource::GetFramesWithoutPose() const
{
  return this->Now->GetState().Counts.WithoutPose;
}

//------------------------------------------------------------------------------
vtkIdType vtkLacunaPolhemusVideoSource::GetFramesOfWrongSize() const
{
  return this->Now->GetState().Counts.WrongSize;
}

//------------------------------------------------------------------------------
vtkIdType vtkLacunaPolhemusVideoSource::GetFramesPastLimit() const
{
  return this->Now->GetState().Counts.PastLimit;
}

//------------------------------------------------------------------------------
vtkIdType vtkLacunaPolhemusVideoSource::GetMissingFrames() const
{
  return this->Now->GetState().Missing;
}

//------------------------------------------------------------------------------
vtkIdType vtkLacunaPolhemusVideoSource::GetTooFastSlices() const
{
  return this->Now->GetState().Counts.TooFast;
}

//------------------------------------------------------------------------------
double vtkLacunaPolhemusVideoSource::GetSpeed() const
{
  return this->Now->GetState().Speed.value_or(std::numeric_limits<double>::quiet_NaN());
}

//------------------------------------------------------------------------------
double vtkLacunaPolhemusVideoSource::GetLargestResidual() const
{
  return this->Now->GetState().LargestResidual;
}

//------------------------------------------------------------------------------
vtkIdType vtkLacunaPolhemusVideoSource::GetRecordedSlices() const
{
  return this->Now->GetState().File.Synced;
}

//------------------------------------------------------------------------------
const char* vtkLacunaPolhemusVideoSource::GetRecordedFileName()
{
  this->Now->FileName = this->Now->GetState().File.FileName;
  return this->Now->FileName.c_str();
}
