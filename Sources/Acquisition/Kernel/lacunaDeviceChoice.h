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
