// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaLiveDevices.h"

#include "lacunaDeviceChoice.h"
#include "lacunaSweepAcquisition.h"

#include <algorithm>
#include <array>

namespace
{
constexpr std::array<const char*, 2> RecordFormatNames{ "Binary", "ASCII" };
constexpr std::array<const char*, 2> RecordUnitNames{ "Centimetre", "Inch" };

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
void vtkLacunaLiveDevices::ListTracker(lacuna::Properties& properties) const
{
  using lacuna::ValueRange;
  properties.Add("TrackerConnection", this->TrackerConnection)
    .Add("BaudRate", this->BaudRate, ValueRange::Between(2400, 115200))
    .Add("Station", this->Station, ValueRange::Between(1, 4))
    .Add("Hemisphere", this->Hemisphere, ValueRange::Any())
    .Add("FiltersOff", this->FiltersOff)
    .Add("RecordFormat", this->RecordFormat, RecordFormatNames)
    .Add("RecordUnit", this->RecordUnit, RecordUnitNames)
    .Add("TrackerReset", this->TrackerReset, lacuna::FastrakResetNames)
    .Add("ButtonStarts", this->ButtonStarts); // the records have it then
}

//------------------------------------------------------------------------------
void vtkLacunaLiveDevices::ListVideo(lacuna::Properties& properties) const
{
  properties.Add("VideoURL", this->VideoURL)
    .Add("VideoOptions", this->VideoOptions)
    .Add("Field", this->Field, lacuna::VideoFieldNames)
    .Add("VideoLatency", this->VideoLatency, lacuna::ValueRange::Between(-1, 1, "s"));
}

//------------------------------------------------------------------------------
void vtkLacunaLiveDevices::ListCrop(lacuna::Properties& properties) const
{
  properties.Add(
    "CropRectangle", this->CropRectangle, lacuna::ValueRange::AtLeast(1, "pixels").OrZero("all"));
}

//------------------------------------------------------------------------------
void vtkLacunaLiveDevices::Describe(lacuna::Properties& properties) const
{
  this->ListTracker(properties);
  this->ListVideo(properties);
  this->ListCrop(properties);
}

//------------------------------------------------------------------------------
std::string vtkLacunaLiveDevices::DescribeTracker() const
{
  lacuna::Properties properties;
  this->ListTracker(properties);
  return properties.GetText();
}

//------------------------------------------------------------------------------
std::string vtkLacunaLiveDevices::DescribeVideo() const
{
  lacuna::Properties properties;
  this->ListVideo(properties);
  return properties.GetText();
}

//------------------------------------------------------------------------------
std::string vtkLacunaLiveDevices::DescribeCrop() const
{
  lacuna::Properties properties;
  this->ListCrop(properties);
  return properties.GetText();
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
