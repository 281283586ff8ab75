// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVideoDevice.h"

#include <utility>

namespace lacuna
{
VideoDevice::VideoDevice(
  const VideoSettings& settings, const Clock& clock, std::function<bool()> stopped)
  : IsGrabber(settings.URL.rfind("/dev/", 0) == 0)
  , Source(settings, clock, std::move(stopped))
{
}

double VideoDevice::GetLatency() const
{
  const double rate = this->Source.GetFrameRate();
  return this->IsGrabber && rate > 0 ? 1 / rate : 0;
}

FrameDeviceFactory MakeVideoFactory(const VideoSettings& settings, const Clock& clock)
{
  return [settings, &clock](const std::function<bool()>& stopped)
  { return std::make_unique<VideoDevice>(settings, clock, stopped); };
}
}
