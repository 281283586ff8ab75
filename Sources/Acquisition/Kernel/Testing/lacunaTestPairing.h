// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Video at 25 frames a second beside a tracker, in any time.
#ifndef lacunaTestPairing_h
#define lacunaTestPairing_h

#include "lacunaFastrakTracker.h"
#include "lacunaPoseTrack.h"
#include "lacunaTestFastrak.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lacunaTest
{
/// A probe that goes to and fro by 100 mm and turns, within 0.2 m/s and 0.5 m/s^2.
inline lacuna::Matrix4 Sweep(double time, int station)
{
  return lacuna::Matrix4::Translation({ 250 + 20 * std::sin(0.9 * time),
           50 * std::sin(2.3 * time) + 300.0 * (station - 1), -90 + 30 * std::cos(1.1 * time) }) *
    lacuna::FastrakRotation(
      lacuna::Vec3{ 30 * std::sin(time), 20 * std::cos(0.8 * time), 15 * std::sin(1.3 * time) });
}

struct Pairing
{
  int Frames = 0;
  int Lost = 0;     ///< frames without a pose
  double Worst = 0; ///< mm of a frame's pose from Sweep's, beyond what is explained
  double Late = 0;  ///< s by which the slowest record came after the quickest
};

/// Polls a tracker that follows Sweep and gives every frame its pose. The straight line between
/// poses is up to a gap^2 / 8 off.
inline Pairing PairFrames(
  lacuna::FastrakTracker& tracker, const lacuna::Clock& clock, double seconds)
{
  constexpr double acceleration = 350; // of Sweep, mm/s^2
  lacuna::PoseTrack track;
  const double begin = clock.Now() + 1;
  Pairing pairing;
  double quickest = 1;
  double slowest = 0;
  std::vector<lacuna::TrackedPose> poses;
  while (pairing.Frames < 25 * seconds)
  {
    poses.clear();
    tracker.Poll(poses);
    for (const lacuna::TrackedPose& pose : poses)
    {
      if (!pose.Usable)
      {
        continue; // it came late
      }
      track.Add(pose);
      quickest = std::min(quickest, pose.Arrival - pose.Request);
      slowest = std::max(slowest, pose.Arrival - pose.Request);
    }
    for (; !track.IsAhead(begin + 0.04 * pairing.Frames) && pairing.Frames < 25 * seconds;
         ++pairing.Frames)
    {
      const double time = begin + 0.04 * pairing.Frames;
      const auto pose = track.At(time);
      if (!pose)
      {
        ++pairing.Lost;
        continue;
      }
      const double straight = acceleration * pose->Gap * pose->Gap / 8;
      const double error =
        Norm(pose->ReceiverToTransmitter.Column(3) - Sweep(time, 1).Column(3)) - straight;
      pairing.Worst = std::max(pairing.Worst, error);
    }
  }
  pairing.Late = slowest - quickest;
  return pairing;
}
}
#endif
