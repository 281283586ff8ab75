// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Trackers and scanners behind an OpenIGTLink server as an acquisition's sources.
#ifndef lacunaOpenIGTLinkDevices_h
#define lacunaOpenIGTLinkDevices_h

#include "lacunaClock.h"
#include "lacunaFrameDevice.h"
#include "lacunaOpenIGTLinkAddress.h"
#include "lacunaPoseDevice.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace lacuna
{
class OpenIGTLinkConnection;
class OpenIGTLinkInbox;
struct OpenIGTLinkArrival;
struct OpenIGTLinkPose;

/// The poses of one TRANSFORM, POSITION or QTRANS device, of one element of TDATA or QTDATA, or of
/// one IMAGE device's plane. A pose is as the server gives it: mm, probe to tracker where the device
/// is ProbeToTracker. Time is that of the message's stamp. Repeated stamps are left out.
class OpenIGTLinkPoseDevice : public PoseDevice
{
public:
  OpenIGTLinkPoseDevice(const OpenIGTLinkAddress& address, int station,
    std::shared_ptr<OpenIGTLinkConnection> connection, std::function<bool()> stopped);
  ~OpenIGTLinkPoseDevice() override;

  void SetUp() override;
  /// Throws std::runtime_error when the first pose scales or mirrors, or five in a row do (fewer count
  /// as damaged), and std::invalid_argument when the server sends poses of several devices and the
  /// address names none.
  bool Poll(std::vector<TrackedPose>& poses) override;
  PoseCounts GetCounts() const override;
  std::string GetWarning() const override { return this->Warning; }
  void AllowSilence(double seconds) override { this->AllowedSilence = seconds; }

private:
  void Take(const OpenIGTLinkArrival& arrival, std::vector<TrackedPose>& poses);
  void TakePose(const OpenIGTLinkPose& pose, const OpenIGTLinkArrival& arrival,
    std::vector<TrackedPose>& poses);
  void WatchClock(const OpenIGTLinkArrival& arrival);
  void WatchStatus(const OpenIGTLinkPose& pose, const OpenIGTLinkArrival& arrival);
  std::string AdviseStart() const;
  std::string FindWarning() const;

  OpenIGTLinkAddress Address;
  int Station;
  std::shared_ptr<OpenIGTLinkConnection> Connection;
  std::unique_ptr<OpenIGTLinkInbox> Inbox;
  std::function<bool()> Stopped;
  std::string Name; ///< the device that is taken; empty: none came yet
  std::optional<double> LastStamp;
  double LastTime = 0;
  ClockEpoch LastEpoch;
  int Silence = 0; ///< s without a pose
  double AllowedSilence = 0;
  bool Usable = true;   ///< of the last pose
  bool Repeats = false; ///< the last message was as old as the one before
  std::optional<double> ClockOffset;
  int ClockSteps = 0;
  std::string OtherClock; ///< the images whose stamps are of another clock
  double OtherStep = 0;   ///< s
  double Jitter = 0;
  std::string Status;                 ///< what the sender said of the last pose
  std::optional<double> NoStatusTime; ///< when the first pose came, that it said nothing of
  std::string Trouble;                ///< what a STATUS message complained of, and the like
  double TroubleTime = 0;
  std::string Warning;
  std::uint64_t Poses = 0;
  std::uint64_t Damaged = 0; ///< messages whose content cannot be, or cannot be used
  int Faults = 0;            ///< poses in a row that cannot be used
};

/// The images of one IMAGE device. Arrival is the instant of the message's stamp, in the
/// acquisition's time; where it has none, when it came. StreamTime is the stamp. Arrivals ascend:
/// images that are not later than the one before, as long as the server's clock is hardly known, count
/// as missing.
class OpenIGTLinkFrameDevice : public FrameDevice
{
public:
  OpenIGTLinkFrameDevice(const OpenIGTLinkAddress& address,
    std::shared_ptr<OpenIGTLinkConnection> connection, std::function<bool()> stopped);
  ~OpenIGTLinkFrameDevice() override;

  /// Throws VideoError when no image comes for 3 s, or when the first one or five in a row cannot be
  /// used; fewer count as undecodable. Throws std::invalid_argument when the server sends images of
  /// several devices and the address names none.
  VideoEvent Read(VideoFrame& frame) override;
  /// 0: a stamp is of the instant.
  double GetLatency() const override { return 0; }
  VideoSource::Counts GetCounts() const override;
  std::string GetWarning() const override;

private:
  bool Take(const OpenIGTLinkArrival& arrival, VideoFrame& frame);
  [[noreturn]] void ThrowSilent() const;

  OpenIGTLinkAddress Address;
  std::shared_ptr<OpenIGTLinkConnection> Connection;
  std::unique_ptr<OpenIGTLinkInbox> Inbox;
  std::function<bool()> Stopped;
  std::string Name;
  std::string Trouble;
  std::optional<double> LastStamp;
  std::optional<double> LastTime;
  std::uint64_t Backward = 0; ///< images that are not later than the one before
  int Columns = 0;
  int Rows = 0;
  std::uint64_t Frames = 0;
  std::uint64_t Damaged = 0; ///< images that cannot be used
  int Faults = 0;            ///< of them in a row
};

/// Opens the tracker of an OpenIGTLink address; station is what its poses carry. The clock must live
/// longer; it is the computer's. All devices of one server share a connection while any is open.
/// Throws std::invalid_argument for a wrong address. In a build without libopenigtlink
/// (LACUNA_WITH_OPENIGTLINK) the factory throws.
PoseDeviceFactory MakeOpenIGTLinkPoseFactory(
  const std::string& address, int station, const Clock& clock);

/// Opens the images of an OpenIGTLink address; as above.
FrameDeviceFactory MakeOpenIGTLinkFrameFactory(const std::string& address, const Clock& clock);
}
#endif
