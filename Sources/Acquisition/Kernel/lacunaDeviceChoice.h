// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The devices of an acquisition by what users call them.
#ifndef lacunaDeviceChoice_h
#define lacunaDeviceChoice_h

#include "lacunaClock.h"
#include "lacunaFastrakTracker.h"
#include "lacunaFrameDevice.h"
#include "lacunaPoseDevice.h"
#include "lacunaVector.h"

#include <string>

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

struct TrackerChoice
{
  /// A serial port, "/dev/ttyUSB0", or an OpenIGTLink server (see lacunaOpenIGTLinkAddress.h), for
  /// which the following settings mean nothing.
  std::string Connection;
  int BaudRate = 115200;
  int Station = 1;
  Vec3 Hemisphere{ 1, 0, 0 }; ///< zenith, in the transmitter's coordinates
  bool FiltersOff = false;
  FastrakFormat Format{ true, LengthUnit::Centimetre };
  FastrakReset Reset = FastrakReset::Frames;
  bool WithButton = false; ///< the records tell the stylus's button
};

/// Opens the tracker of that connection. What is none is said by the factory, as std::invalid_argument
/// that lists the ports there are. Poses are of the station that was chosen. The clock must live longer; it is the computer's.
PoseDeviceFactory ChoosePoseDevice(const TrackerChoice& choice, const Clock& clock);

/// Opens the video of that address, of which igtl://... is an OpenIGTLink server; as above.
FrameDeviceFactory ChooseFrameDevice(const VideoSettings& settings, const Clock& clock);
}
#endif
