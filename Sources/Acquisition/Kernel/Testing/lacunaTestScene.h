// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Acquisitions in a room of simulated time, and what is expected of them.
#ifndef lacunaTestScene_h
#define lacunaTestScene_h

#include "lacunaTestRoom.h"

#include <memory>
#include <string>
#include <utility>

namespace lacunaTest
{
/// An acquisition in a room.
struct Scene
{
  explicit Scene(const lacuna::AcquisitionRules& rules,
    Room::FrameScript frames = Room::NumberedFrame, Room::PoseScript poses = Room::FollowSweep)
  {
    this->Devices.Frames = this->Place.MakeVideo(std::move(frames));
    this->Devices.Poses = this->Place.MakeTracker(std::move(poses));
    this->Devices.RetryTime = 0.001;
    this->Rules = rules;
  }
  lacuna::SweepAcquisition& Open()
  {
    this->Acquisition =
      std::make_unique<lacuna::SweepAcquisition>(this->Devices, this->Rules, this->Place);
    return *this->Acquisition;
  }
  Room Place;
  lacuna::AcquisitionDevices Devices;
  lacuna::AcquisitionRules Rules;
  std::unique_ptr<lacuna::SweepAcquisition> Acquisition;
};

/// Without a speed limit.
inline lacuna::AcquisitionRules EveryFrame()
{
  lacuna::AcquisitionRules rules;
  rules.Mode = lacuna::CaptureMode::EveryFrame;
  rules.SpeedLimit = 0;
  return rules;
}

/// All frames are accounted for.
inline void ExpectNoneForgotten(const lacuna::AcquisitionState& state, bool movement)
{
  const lacuna::CaptureCounts& c = state.Counts;
  EXPECT_EQ(c.Frames,
    c.Slices + c.Still + c.WrongSize + c.PastLimit + state.Pending +
      (movement ? c.WithoutPose : 0));
}

/// The pose of a slice is the sweep's at its instant, but for the straight line between measurements.
inline double PoseError(const lacuna::AcquiredSlice& slice)
{
  const double straight = 350 * slice.Gap * slice.Gap / 8;
  return Norm(slice.ProbeToTracker.Column(3) - Sweep(slice.Timestamp, 1).Column(3)) - straight;
}

/// Whether one of the messages has these words.
inline bool HasMessage(const lacuna::AcquisitionState& state, const std::string& part)
{
  for (const std::string& message : state.Messages)
  {
    if (message.find(part) != std::string::npos)
    {
      return true;
    }
  }
  return false;
}
}
#endif
