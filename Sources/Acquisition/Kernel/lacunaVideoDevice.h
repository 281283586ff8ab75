// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A video as an acquisition's source of frames.
#ifndef lacunaVideoDevice_h
#define lacunaVideoDevice_h

#include "lacunaFrameDevice.h"

#include <string>

namespace lacuna
{
class VideoDevice : public FrameDevice
{
public:
  /// The clock goes on by itself and must live longer.
  VideoDevice(const VideoSettings& settings, const Clock& clock, std::function<bool()> stopped);

  VideoEvent Read(VideoFrame& frame) override { return this->Source.Read(frame); }
  /// One frame's time for a frame grabber (/dev/...) whose rate is known; else 0.
  double GetLatency() const override;
  std::vector<std::optional<double>> TakeArrivals() override { return this->Source.TakeArrivals(); }
  VideoSource::Counts GetCounts() const override { return this->Source.GetCounts(); }

private:
  bool IsGrabber;
  VideoSource Source;
};

/// Opens a video. The clock goes on by itself and must live longer.
FrameDeviceFactory MakeVideoFactory(const VideoSettings& settings, const Clock& clock);
}
#endif
