// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Drives a FASTRAK: sets it up and asks for one record after the other.
#ifndef lacunaFastrakTracker_h
#define lacunaFastrakTracker_h

#include "lacunaByteChannel.h"
#include "lacunaClock.h"
#include "lacunaFastrakParser.h"
#include "lacunaTrackedPose.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace lacuna
{
/// A measurement holds for the arrival of its request at the unit. What an answer took longer than
/// the quickest of late, its request may have waited for on the way: in a busy computer, an adapter.
class RoundTrips
{
public:
  /// tolerance: s more than the quickest. USB adapters collect bytes for up to 16 ms.
  explicit RoundTrips(double tolerance = 0.02)
    : Tolerance(tolerance)
  {
  }

  /// Of the next answer, seconds after its request. A line that has become slower for good is known
  /// after 50 to 100 answers.
  bool IsLate(double seconds)
  {
    constexpr int many = 50;
    if (this->Count == many)
    {
      this->Before = this->Quickest;
      this->Quickest = std::numeric_limits<double>::infinity();
      this->Count = 0;
    }
    ++this->Count;
    this->Quickest = std::min(this->Quickest, seconds);
    return seconds > std::min(this->Before, this->Quickest) + this->Tolerance;
  }

private:
  double Tolerance;
  double Quickest = std::numeric_limits<double>::infinity(); ///< of the newest answers
  double Before = std::numeric_limits<double>::infinity();   ///< of the 50 before them
  int Count = 0;
};

struct MotionLimits
{
  double Acceleration = 3000;      ///< mm/s^2 of the receiver
  double AngularAcceleration = 30; ///< rad/s^2, turning steadily at w counts as w^2
  double PositionNoise = 0.5;      ///< mm
  double AngularNoise = 0.005;     ///< rad
  double MaximumGap = 0.5;         ///< s after which the motion before says nothing
};

/// Detects damage that leaves a possible record, and the receiver's passage into the other
/// hemisphere, by continuity.
///
/// A pose is taken when it is where the two before it lead, as far as the limits allow. This is exact
/// for a uniformly accelerated motion; noise is extrapolated too. A pose whose position fits with all
/// three signs changed is taken with them changed. The FASTRAK's field is the same at opposite places:
/// there the orientation is right and the position mirrored through the origin. Others wait. Three in
/// a row that fit each other are a new motion and are taken together, late. Those that do not are
/// dropped when one fits the motion before.
///
/// A new motion after one that was in the other hemisphere is on the side that is nearer to its end.
/// One within 2 s of one that was not is in the other hemisphere when it is three times nearer there.
/// So is a pose that fits with either sign, as after 0.3 s without any within 8 cm of the transmitter.
///
/// Undetected errors are within the limits: at 50 poses a second 1.2 mm and three times the noise.
class MotionCheck
{
public:
  explicit MotionCheck(const MotionLimits& limits = {});
  /// Judges the next pose in time and adds what is taken now to accepted, in order of time. Poses
  /// that are not Usable pass and are not judged.
  void Judge(const TrackedPose& pose, std::vector<TrackedPose>& accepted);
  /// Forgets the motion.
  void Reset();

  std::uint64_t GetNumberOfDropped() const { return this->Dropped; }
  std::uint64_t GetNumberOfFlipped() const { return this->Flipped; }

private:
  bool Fits(const TrackedPose& first, const TrackedPose& second, const TrackedPose& third) const;
  bool IsInOtherHemisphere(const TrackedPose& first) const;

  MotionLimits Limits;
  std::vector<TrackedPose> Track;   ///< the last two that were taken, however old
  std::vector<TrackedPose> Waiting; ///< up to two that may begin a new motion
  std::uint64_t Dropped = 0;
  std::uint64_t Flipped = 0;
};

/// What of a unit's own settings is made undone before it is set up.
enum class FastrakReset
{
  Nothing, ///< an alignment and a boresight that were set stay: poses are in that frame
  Frames,  ///< alignment and boresight: poses are in the transmitter's frame
  Factory  ///< everything, but for the serial line: also filters and the stylus's tip
};
inline constexpr std::array<const char*, 3> FastrakResetNames{ "Nothing", "Frames", "Factory" };

struct FastrakSettings
{
  std::vector<int> Stations{ 1 }; ///< the receivers to follow, ascending
  /// Must have a pose. The binary record of 27 bytes allows 46 records a second and more at 19200
  /// baud. From 38400 baud on, list items twice (2 4 2 4): then every damage but an equal one to
  /// both is seen.
  FastrakLayout Layout{ { FastrakItem::Position, FastrakItem::Angles } };
  FastrakFormat Format{ true, LengthUnit::Centimetre };
  Vec3 Hemisphere{ 1, 0, 0 }; ///< zenith of the half of space the receivers are in at first
  FastrakReset Reset = FastrakReset::Frames;
  bool FiltersOff = false;       ///< no smoothing, which delays; false: as they are set
  double SampleLatency = 0.0035; ///< s from request to the instant of the pose (Carr 1996, ch. 2)
  double ResponseTime = 0.25;    ///< s without an answer after which a request has failed
  double GapTime = 0.03;         ///< s of silence within a record after which the rest is lost
  MotionLimits Motion;
};

/// Why there is no tracking; the text says what to do.
class TrackerError : public std::runtime_error
{
public:
  enum class Kind
  {
    Silent,      ///< no byte comes
    Garbage,     ///< bytes come that no FASTRAK sends: the wrong baud rate
    Complaint,   ///< the unit refuses a command
    WrongStation ///< records come from other receivers, or none
  };
  TrackerError(Kind kind, const std::string& message)
    : std::runtime_error(message)
    , Reason(kind)
  {
  }
  Kind GetKind() const { return this->Reason; }

private:
  Kind Reason;
};

/// Single-record mode only: the buffer of continuous output skips records, and a record that was
/// asked for has a known instant. The channel and the clock must live longer and have one time.
/// All functions throw ChannelError when the line breaks and Aborted when stopped.
class FastrakTracker
{
public:
  struct Counts
  {
    std::uint64_t Requests = 0;
    std::uint64_t Records = 0;     ///< right ones, of all stations
    std::uint64_t Silent = 0;      ///< requests without any byte for an answer
    std::uint64_t Damaged = 0;     ///< requests whose answer was incomplete or no record
    std::uint64_t Early = 0;       ///< of which sooner than the line can carry: an older answer
    std::uint64_t Late = 0;        ///< right answers whose poses are not used, see RoundTrips
    std::uint64_t Implausible = 0; ///< records that no motion explains
    std::uint64_t Flipped = 0;     ///< records whose hemisphere was set right
    std::uint64_t StrayBytes = 0;  ///< that came without being asked for
  };

  /// Throws std::invalid_argument for settings that cannot be. stopped is asked about ten times a
  /// second.
  FastrakTracker(ByteChannel& channel, const Clock& clock, const FastrakSettings& settings = {},
    std::function<bool()> stopped = {});

  /// Ends what the unit is doing, sets it up (format, stations, output lists, hemisphere) and makes
  /// sure that it answers with the records asked for; repeats steps that damage spoilt. Throws
  /// TrackerError.
  void SetUp();

  /// Asks for one record of each station and adds the poses that are taken now (see MotionCheck).
  /// One that came too late is not Usable, but tells of the button. False when no right record
  /// came. After failures it first makes sure of the unit's state; one that was restarted is set up
  /// again (TrackerError when that fails). Takes at most a second and a half otherwise.
  bool Poll(std::vector<TrackedPose>& poses);

  /// Of the unit, once set up.
  const FastrakStatus& GetStatus() const { return this->Status; }
  Counts GetCounts() const;
  /// The last complaint or error code of the unit in words; empty: none for 5 s.
  const std::string& GetWarning() const { return this->Warning; }

private:
  enum class Outcome
  {
    Records,
    Silent,
    Damaged
  };
  void CheckStopped() const;
  std::size_t Receive(double seconds, std::vector<FastrakMessage>& messages);
  void Settle(double quiet, double longest);
  bool AskStatus();
  void SendSettings();
  void CheckRecords();
  bool IsAsSet() const;
  bool MakeSure();
  bool IsWanted(int station) const;
  Outcome Request(std::vector<TrackedPose>& measured);
  TrackedPose MakePose(const FastrakRecord& record, double request, double arrival) const;
  void NoteReply(const FastrakReply& reply);
  void Warn(const std::string& text);

  ByteChannel& Channel;
  const Clock& Time;
  FastrakSettings Settings;
  std::function<bool()> Stopped;
  FastrakParser Parser;
  FastrakStatus Status;
  Counts Count;
  std::array<MotionCheck, FastrakStations> Motions;
  RoundTrips Trips;
  bool IsLate = false; ///< the newest answer
  std::string Warning;
  double WarnedAt = 0;
  std::string LastComplaint;
  int Failures = 0;              ///< requests in a row
  bool Doubted = false;          ///< no record has come since the unit was asked for its state
  std::size_t ReceivedBytes = 0; ///< since the unit was asked for its status
  int OtherStation = 0;          ///< from which a record came last that was not wanted
};
}
#endif
