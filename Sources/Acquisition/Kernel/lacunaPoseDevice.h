// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What an acquisition asks for poses: a tracker on a serial port, a stream of the network.
#ifndef lacunaPoseDevice_h
#define lacunaPoseDevice_h

#include "lacunaTrackedPose.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace lacuna
{
struct PoseCounts
{
  std::uint64_t Poses = 0;   ///< right measurements that came
  std::uint64_t Missing = 0; ///< that were asked for, or announced, and did not come, or too late
  std::uint64_t Damaged = 0; ///< that came incomplete or spoilt
  std::uint64_t Implausible = 0; ///< that no motion explains (see MotionCheck)
  std::uint64_t Flipped = 0;     ///< whose hemisphere was set right
};

/// Open when it is made (by a factory that throws as the functions do) and closed when it is
/// destroyed. One thread makes, uses and destroys it.
///
/// Where it does not work, the functions throw std::runtime_error, ChannelError or TrackerError
/// among them, whose text names the device and says what to do; then it is destroyed, and after a
/// while another one is made. They throw std::invalid_argument for settings that cannot be, and
/// Aborted when told to stop, which they ask at least every 100 ms.
class PoseDevice
{
public:
  virtual ~PoseDevice() = default;

  /// Makes it measure; called once, before Poll. May take some seconds.
  virtual void SetUp() = 0;
  /// Waits for the next measurements and adds those that are taken now, in order of Time for each
  /// Station but for those that are not Usable, with the times of the acquisition's clock. False
  /// when none came: after at most a second and a half it returns, however silent the device is.
  virtual bool Poll(std::vector<TrackedPose>& poses) = 0;
  virtual PoseCounts GetCounts() const = 0;
  /// What is wrong with the measurements now though they come, and what to do; empty: nothing.
  virtual std::string GetWarning() const = 0;
  /// So many s without a measurement are no reason to warn: the last one holds as long.
  virtual void AllowSilence(double /*seconds*/) {}
};

/// Opens a device; asked for another one after a failure. stopped says when to give up.
using PoseDeviceFactory =
  std::function<std::unique_ptr<PoseDevice>(const std::function<bool()>& stopped)>;
}
#endif
