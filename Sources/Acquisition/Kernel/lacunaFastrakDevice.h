// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A FASTRAK as an acquisition's source of poses.
#ifndef lacunaFastrakDevice_h
#define lacunaFastrakDevice_h

#include "lacunaClock.h"
#include "lacunaFastrakTracker.h"
#include "lacunaPoseDevice.h"

namespace lacuna
{
class FastrakDevice : public PoseDevice
{
public:
  /// The clock must live longer, and have the channel's time.
  FastrakDevice(std::unique_ptr<ByteChannel> channel, const Clock& clock,
    const FastrakSettings& settings, std::function<bool()> stopped);

  void SetUp() override { this->Tracker.SetUp(); }
  bool Poll(std::vector<TrackedPose>& poses) override { return this->Tracker.Poll(poses); }
  PoseCounts GetCounts() const override;
  std::string GetWarning() const override { return this->Tracker.GetWarning(); }

private:
  std::unique_ptr<ByteChannel> Channel;
  FastrakTracker Tracker;
};

/// The record to ask one receiver for: the pose, listed twice where the line carries that 40 times a
/// second and more, so that damage is seen, in ASCII with more digits where it carries these; and the
/// stylus's button if wanted.
FastrakLayout ChooseFastrakLayout(int baud, bool withButton, bool binary = true);

/// Opens a FASTRAK on a serial port. The clock must live longer; it is the computer's.
PoseDeviceFactory MakeFastrakFactory(
  const std::string& port, int baud, const Clock& clock, const FastrakSettings& settings);
}
#endif
