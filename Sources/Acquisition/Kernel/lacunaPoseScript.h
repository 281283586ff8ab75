// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Motions of the emulator's receivers.
#ifndef lacunaPoseScript_h
#define lacunaPoseScript_h

#include "lacunaFastrakRecord.h"
#include "lacunaPoseTrack.h"

#include <array>
#include <iosfwd>
#include <string>

namespace lacuna
{
/// A motion from a text: a line for each pose, "time station x y z azimuth elevation roll" in s, mm
/// and degrees, parted by blanks or commas; # begins a comment. The times of a station ascend.
/// Between two poses the position goes straight on and the receiver turns evenly about one axis;
/// before the first and after the last it rests.
class PoseScript
{
public:
  /// Throws std::runtime_error with name and line for one that is no such text, or an empty one.
  PoseScript(std::istream& text, const std::string& name);

  /// Receiver to transmitter, mm. A station without poses is where the first one of the text is,
  /// 100 mm further along y per station.
  Matrix4 operator()(double time, int station) const;
  /// Seconds from 0 to the last pose of all stations.
  double GetDuration() const { return this->Duration; }

private:
  struct Motion
  {
    PoseTrack Track;
    TrackedPose First;
    TrackedPose Last;
    bool Present = false;
  };
  std::array<Motion, FastrakStations> Motions;
  int FirstStation = 0;
  double Duration = 0;
};

/// A hand that sweeps to and fro by 80 mm every 8 s and wobbles by a few mm and degrees; at most
/// 35 mm/s. Stations are 100 mm apart along y.
Matrix4 EverydaySweep(double time, int station);
constexpr double EverydayPeriod = 8; ///< s
}
#endif
