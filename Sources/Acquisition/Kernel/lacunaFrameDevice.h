// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What an acquisition reads images from: a frame grabber, a file, a stream of the network.
#ifndef lacunaFrameDevice_h
#define lacunaFrameDevice_h

#include "lacunaVideoSource.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lacuna
{
/// Open when it is made (by a factory that throws as the functions do) and closed when it is
/// destroyed. One thread makes, uses and destroys it.
///
/// Where it does not work, the functions throw std::runtime_error, VideoError among them, whose text
/// names the device and says what to do; then it is destroyed, and after a while another one is
/// made. They throw std::invalid_argument for settings that cannot be, and Aborted when told to
/// stop, which they ask at least every 100 ms.
class FrameDevice
{
public:
  virtual ~FrameDevice() = default;

  /// Waits for the next frame. Arrival is of the acquisition's clock. After End there is none more.
  virtual VideoEvent Read(VideoFrame& frame) = 0;
  /// s from the instant at which the probe saw a frame's content to the frame's Arrival, as far as the
  /// kind of device determines it; 0: not known. A frame grabber has a frame when its last line was
  /// sent, one frame's time after its first.
  virtual double GetLatency() const = 0;
  /// See VideoSource.
  virtual std::vector<std::optional<double>> TakeArrivals() { return {}; }
  virtual VideoSource::Counts GetCounts() const = 0;
  /// What is wrong with the frames now though they come, and what to do; empty: nothing.
  virtual std::string GetWarning() const { return {}; }
};

/// Opens a device; asked for another one after a failure. stopped says when to give up.
using FrameDeviceFactory =
  std::function<std::unique_ptr<FrameDevice>(const std::function<bool()>& stopped)>;
}
#endif
