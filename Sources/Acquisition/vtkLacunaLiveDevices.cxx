// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaLiveDevices.h"

#include "lacunaDeviceChoice.h"
#include "lacunaParameterText.h"
#include "lacunaSweepAcquisition.h"

#include <algorithm>

namespace
{
std::string Text(const char* s)
{
  return s ? s : "";
}
}

//------------------------------------------------------------------------------
vtkLacunaLiveDevices::~vtkLacunaLiveDevices()
{
  this->SetTrackerConnection(nullptr);
  this->SetVideoURL(nullptr);
  this->SetVideoOptions(nullptr);
}

//------------------------------------------------------------------------------
std::string vtkLacunaLiveDevices::DescribeTracker() const
{
  return lacuna::ParameterText()
    .Add("TrackerConnection", this->TrackerConnection)
    .Add("BaudRate", this->BaudRate)
    .Add("Station", this->Station)
    .Add("Hemisphere", this->Hemisphere)
    .Add("FiltersOff", this->FiltersOff)
    .Add("RecordFormat", this->RecordFormat)
    .Add("RecordUnit", this->RecordUnit)
    .Add("TrackerReset", this->TrackerReset)
    .Add("ButtonStarts", this->ButtonStarts) // the records have it then
    .Get();
}

//------------------------------------------------------------------------------
std::string vtkLacunaLiveDevices::DescribeVideo() const
{
  return lacuna::ParameterText()
    .Add("VideoURL", this->VideoURL)
    .Add("VideoOptions", this->VideoOptions)
    .Add("Field", this->Field)
    .Add("VideoLatency", this->VideoLatency)
    .Get();
}

//------------------------------------------------------------------------------
std::string vtkLacunaLiveDevices::DescribeCrop() const
{
  return lacuna::ParameterText().Add("CropRectangle", this->CropRectangle).Get();
}

//------------------------------------------------------------------------------
std::string vtkLacunaLiveDevices::DescribeDevices() const
{
  return this->DescribeTracker() + " " + this->DescribeVideo() + " " + this->DescribeCrop();
}

//------------------------------------------------------------------------------
lacuna::AcquisitionDevices vtkLacunaLiveDevices::MakeDevices(const lacuna::Clock& clock) const
{
  lacuna::TrackerChoice tracker;
  tracker.Connection = Text(this->TrackerConnection);
  tracker.BaudRate = this->BaudRate;
  tracker.Station = this->Station;
  tracker.Hemisphere = { this->Hemisphere[0], this->Hemisphere[1], this->Hemisphere[2] };
  tracker.FiltersOff = this->FiltersOff;
  tracker.Format.Binary = this->RecordFormat == Binary;
  tracker.Format.Unit =
    this->RecordUnit == Inch ? lacuna::LengthUnit::Inch : lacuna::LengthUnit::Centimetre;
  tracker.Reset = static_cast<lacuna::FastrakReset>(this->TrackerReset);
  tracker.WithButton = this->ButtonStarts;
  lacuna::VideoSettings video;
  video.URL = Text(this->VideoURL);
  video.Options = Text(this->VideoOptions);
  video.Field = static_cast<lacuna::VideoField>(this->Field);
  lacuna::AcquisitionDevices devices;
  devices.Poses = lacuna::ChoosePoseDevice(tracker, clock);
  devices.Frames = lacuna::ChooseFrameDevice(video, clock);
  devices.Station = this->Station;
  if (this->VideoLatency >= 0)
  {
    devices.VideoLatency = this->VideoLatency;
  }
  std::copy_n(this->CropRectangle, 4, devices.Crop.begin());
  devices.ReopenEndedVideo = video.URL.find("://") != std::string::npos;
  return devices;
}
