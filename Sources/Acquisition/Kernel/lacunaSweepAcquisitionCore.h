// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the threads of a SweepAcquisition's devices work on together.
#ifndef lacunaSweepAcquisitionCore_h
#define lacunaSweepAcquisitionCore_h

#include "lacunaDeviceThread.h"
#include "lacunaSweepAcquisition.h"

#include <atomic>
#include <condition_variable>
#include <deque>
#include <utility>

namespace lacuna
{
/// Shared with the threads, which may outlive the acquisition. TakeMutex before Mutex.
struct SweepAcquisition::Core
{
  Core(const AcquisitionDevices& devices, const AcquisitionRules& rules, const Clock& clock)
    : Time(clock)
    , Epoch(clock.Now())
    , Taking(devices.Crop, rules, this->Epoch)
    , Rules(rules)
    , Pairing(devices.Patience)
  {
    this->Pairing.SetHold(rules.HoldLastPose);
  }

  void TrackPoses(const AcquisitionDevices& devices, DeviceThread::Control& control);
  void ReadFrames(const AcquisitionDevices& devices, DeviceThread::Control& control);
  void AddPoses(
    const std::vector<TrackedPose>& poses, bool came, const PoseDevice& device, int station);
  double GetHold() const;
  void HeedButton(const TrackedPose& pose);
  void SetCapturing(bool on);
  void LosePoses();
  void BreakPoses();
  void AddFrame(
    FramePointer frame, double latency, FrameDevice& device, const DeviceThread::Control& control);
  void SetTimes(const std::vector<std::optional<double>>& arrivals);
  void Process();
  void CatchUp();
  void TakeReady();
  void TakeLast();
  void HeedStart();
  void Publish(std::int64_t processed, std::vector<AcquiredSlice> slices);
  std::uint64_t CountFlipped() const
  {
    return this->EarlierPoses.Flipped + this->NewestPoses.Flipped;
  }
  PoseCounts CountPoses() const; // over all connections
  VideoSource::Counts CountVideo() const;
  std::vector<std::string> DescribePoses() const;

  const Clock& Time;
  const double Epoch;

  std::mutex TakeMutex; // keeps frames in order; guards
  SweepTaking Taking;
  std::atomic<bool> Asked{ false }; // Process found it locked

  mutable std::mutex Mutex; // held for moments only; guards all below
  std::condition_variable Settled;
  AcquisitionRules Rules;
  FramePairing Pairing;
  bool Capturing = false;
  bool Started = false; // and Taking does not know it yet
  bool Finished = false;
  bool PosesCome = false; // a tracker is connected and has measured
  bool ButtonDown = false;
  bool ButtonBefore = false; // what the last record said
  double ButtonTime = 0;     // when that came
  std::int64_t NextNumber = 0;
  std::deque<std::pair<std::int64_t, double>>
    Untimed; // numbers and arrivals of frames of this video
  std::int64_t Pending = 0;
  std::int64_t Missing = 0;
  PoseCounts EarlierPoses; // of connections that ended
  PoseCounts NewestPoses;
  std::uint64_t FlippedBefore = 0; // the sweep
  VideoSource::Counts EarlierVideo;
  VideoSource::Counts NewestVideo;
  std::string TrackerWarning;
  std::string VideoWarning;
  std::optional<std::pair<PairedFrame, SweepFrame>> Live;
  int FramesSincePose = 0;
  std::vector<AcquiredSlice> Slices;
  AcquisitionState State; // of what Taking knows
  std::optional<SweepFrame> Sweep;
};
}
#endif
