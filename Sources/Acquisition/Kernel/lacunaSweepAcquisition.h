// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A tracker and a video become tracked slices, live.
#ifndef lacunaSweepAcquisition_h
#define lacunaSweepAcquisition_h

#include "lacunaAcquiredSlice.h"
#include "lacunaClock.h"
#include "lacunaFrameDevice.h"
#include "lacunaFramePairing.h"
#include "lacunaPoseDevice.h"
#include "lacunaSweepTaking.h"

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace lacuna
{
class DeviceThread;

struct AcquisitionDevices
{
  PoseDeviceFactory Poses;
  FrameDeviceFactory Frames;
  int Station = 1;                    ///< whose poses are the probe's
  std::optional<double> VideoLatency; ///< s; not set: what the frame device says
  /// First column, first row, columns and rows that are kept of a frame; 0 columns or rows: to its
  /// end.
  std::array<int, 4> Crop{ 0, 0, 0, 0 };
  bool ReopenEndedVideo = false; ///< a stream of the network may begin again, a file shall not
  double RetryTime = 1;          ///< s until a device that failed is opened again
  double Patience = 0.5;         ///< s that a frame waits for its pose
};

struct AcquisitionState
{
  bool Capturing = false;
  bool TrackerWorks = false;
  bool VideoWorks = false;
  CaptureCounts Counts;        ///< of the sweep
  std::int64_t Pending = 0;    ///< frames of the capture that wait for their pose
  std::int64_t Missing = 0;    ///< frames that did not come, or not whole, during captures
  std::optional<double> Speed; ///< mm/s, now
  double LargestResidual = 0;  ///< s, of the sweep's slices
  PoseCounts Poses;            ///< since the beginning, over all connections
  VideoSource::Counts Video;
  SweepFile::State File;
  std::int64_t Memory = 0; ///< see SweepTaking::GetMemory
  /// What is wrong now and what to do, the most important first; empty: nothing is.
  std::vector<std::string> Messages;
  /// What goes on, for the user's patience; no trouble.
  std::vector<std::string> Notes;
};

/// The newest frame that has passed the pairing, as a slice; for a dormant display.
struct LiveFrame
{
  AcquiredSlice Slice;
  SweepFrame Sweep; ///< with the window that would be taken of it
};

/// Opens a tracker and a video, each on a thread of its own, and keeps them going. A frame's instant
/// is its arrival, less the video's latency, plus TimeOffset; its pose is interpolated between the
/// measurements on either side of that, never extrapolated. While capturing, frames become slices by
/// the rule of CaptureRule.
///
/// Frames that come during a capture are all accounted for, see CaptureCounts.
///
/// All functions may be called from any thread. They never wait for a device, and for the disk only
/// at the end of a recording; Stop waits for the poses of the last frames, at most 0.8 s.
class SweepAcquisition
{
public:
  /// Throws std::invalid_argument for devices or rules that cannot be. The clock must live longer,
  /// also than a thread that a call of the system holds.
  SweepAcquisition(
    const AcquisitionDevices& devices, const AcquisitionRules& rules, const Clock& clock);
  /// Closes the devices, within a second; writes what is recorded.
  ~SweepAcquisition();
  SweepAcquisition(const SweepAcquisition&) = delete;
  SweepAcquisition& operator=(const SweepAcquisition&) = delete;

  void SetRules(const AcquisitionRules& rules);

  /// Closes the tracker, within a second, and opens the one of these devices in its place; the
  /// capture goes on.
  void ReplaceTracker(const AcquisitionDevices& devices);
  /// The same of the video.
  void ReplaceVideo(const AcquisitionDevices& devices);

  /// Takes slices from the frames that come from now on; after Stop it goes on with the sweep.
  void Start();
  /// Ends the capture; what came before is kept.
  void Stop();
  /// Ends the capture and its recording, and with that this acquisition: nothing is captured after
  /// it. Slices that cannot be written are told by the state.
  AcquisitionState Finish();
  /// Ends the capture and its recording; the next one begins a new sweep. The slices that were not
  /// asked for are dropped. Throws FileError, and the sweep stays, when slices that are to be
  /// recorded cannot be written, unless discard is set.
  void BeginSweep(bool discard = false);

  /// The slices taken since the last call, in order. The memory limit counts them all the same.
  std::vector<AcquiredSlice> TakeSlices();
  /// What the slices of the sweep have in common; nothing before its first frame. The calibration is
  /// that of the newest.
  std::optional<SweepFrame> GetSweep() const;
  /// Nothing before the first frame.
  std::optional<LiveFrame> GetLive() const;
  AcquisitionState GetState() const;

private:
  struct Core;
  void OpenTracker(const AcquisitionDevices& devices);
  void OpenVideo(const AcquisitionDevices& devices);

  std::shared_ptr<Core> Work;
  mutable std::mutex DevicesMutex; ///< guards the two
  std::unique_ptr<DeviceThread> Tracker;
  std::unique_ptr<DeviceThread> Video;
};
}
#endif
