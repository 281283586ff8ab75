// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFastrakTracker.h"

#include "lacunaExecution.h"
#include "lacunaFastrakCommand.h"

#include <algorithm>
#include <array>
#include <utility>

namespace lacuna
{
namespace
{
TrackedPose Flip(TrackedPose pose)
{
  for (int i = 0; i < 3; ++i)
  {
    pose.ReceiverToTransmitter(i, 3) *= -1;
  }
  pose.Flipped = true;
  return pose;
}
}

MotionCheck::MotionCheck(const MotionLimits& limits)
  : Limits(limits)
{
}

void MotionCheck::Reset()
{
  this->Track.clear();
  this->Dropped += this->Waiting.size();
  this->Waiting.clear();
}

bool MotionCheck::Fits(
  const TrackedPose& first, const TrackedPose& second, const TrackedPose& third) const
{
  const double before = second.Time - first.Time;
  const double after = third.Time - second.Time;
  if (!(before > 0) || !(after > 0))
  {
    return false;
  }
  const double ratio = after / before;
  const double bend = 0.5 * after * (after + before);
  const double noise = 1 + 2 * ratio;
  for (int column = 0; column < 4; ++column)
  {
    const Vec3 a = first.ReceiverToTransmitter.Column(column);
    const Vec3 b = second.ReceiverToTransmitter.Column(column);
    const Vec3 expected = b + ratio * (b - a);
    const double limit = column == 3
      ? this->Limits.Acceleration * bend + this->Limits.PositionNoise * noise
      : this->Limits.AngularAcceleration * bend + this->Limits.AngularNoise * noise;
    if (!(Norm(third.ReceiverToTransmitter.Column(column) - expected) <= limit))
    {
      return false;
    }
  }
  return true;
}

// Of the first pose after a gap or of a new motion. A tracker that was silent for a moment, or a
// jerk, hides how the receiver went on: it has hardly gone round the transmitter. Into the other
// hemisphere it has gone only when it would come out near where it was, and soon.
bool MotionCheck::IsInOtherHemisphere(const TrackedPose& first) const
{
  constexpr double near = 3; // times nearer
  constexpr double soon = 2; // s
  if (this->Track.empty())
  {
    return false;
  }
  const Vec3 last = this->Track.back().ReceiverToTransmitter.Column(3);
  const Vec3 position = first.ReceiverToTransmitter.Column(3);
  const double there = Norm(-1 * position - last);
  const double here = Norm(position - last);
  return this->Track.back().Flipped
    ? there < here
    : near * there < here && first.Time - this->Track.back().Time < soon;
}

void MotionCheck::Judge(const TrackedPose& pose, std::vector<TrackedPose>& accepted)
{
  if (!pose.Usable)
  {
    accepted.push_back(pose);
    return;
  }
  const auto isOld = [&](const TrackedPose& earlier)
  { return pose.Time - earlier.Time > this->Limits.MaximumGap; };
  const auto firstYoung = std::find_if_not(this->Waiting.begin(), this->Waiting.end(), isOld);
  this->Dropped += static_cast<std::uint64_t>(firstYoung - this->Waiting.begin());
  this->Waiting.erase(this->Waiting.begin(), firstYoung);

  if (this->Track.size() == 2 && !isOld(this->Track.back()))
  {
    const TrackedPose flipped = Flip(pose);
    const bool here = this->Fits(this->Track[0], this->Track[1], pose);
    const bool there = this->Fits(this->Track[0], this->Track[1], flipped);
    if (here || there)
    {
      // after some tenths of a second both may fit near the transmitter
      const bool flip = there && (!here || this->IsInOtherHemisphere(pose));
      this->Flipped += flip ? 1 : 0;
      accepted.push_back(flip ? flipped : pose);
      this->Track = { this->Track[1], accepted.back() };
      this->Dropped += this->Waiting.size();
      this->Waiting.clear();
      return;
    }
  }
  if (this->Waiting.size() == 2)
  {
    if (this->Fits(this->Waiting[0], this->Waiting[1], pose))
    {
      this->Waiting.push_back(pose);
      if (this->IsInOtherHemisphere(this->Waiting.front()))
      {
        std::transform(this->Waiting.begin(), this->Waiting.end(), this->Waiting.begin(), Flip);
        this->Flipped += this->Waiting.size();
      }
      accepted.insert(accepted.end(), this->Waiting.begin(), this->Waiting.end());
      this->Track = { this->Waiting[1], this->Waiting[2] };
      this->Waiting.clear();
      return;
    }
    ++this->Dropped;
    this->Waiting.erase(this->Waiting.begin());
  }
  this->Waiting.push_back(pose);
}

//------------------------------------------------------------------------------
namespace
{
constexpr double StopInterval = 0.1; // s
constexpr double StatusTime = 1;     // s to wait for a status record
constexpr int Attempts = 6;          // of each step of the set-up
constexpr int RecordAttempts = 12;
constexpr int DoubtfulFailures = 12; // in a row, after which the unit's state is asked for
constexpr double CommandTime = 0.1;  // s of silence after which no complaint comes
constexpr double WarningTime = 5;    // s that a warning stays when nothing is wrong any more

std::string BaudText(const ByteChannel& channel)
{
  return channel.GetBaud() > 0 ? " at " + std::to_string(channel.GetBaud()) + " baud" : "";
}
}

FastrakTracker::FastrakTracker(ByteChannel& channel, const Clock& clock,
  const FastrakSettings& settings, std::function<bool()> stopped)
  : Channel(channel)
  , Time(clock)
  , Settings(settings)
  , Stopped(std::move(stopped))
  , Parser(settings.Format, settings.Layout)
{
  std::vector<int>& stations = this->Settings.Stations;
  if (stations.empty() || stations.front() < 1 || stations.back() > FastrakStations ||
    std::adjacent_find(stations.begin(), stations.end(), std::greater_equal<>()) != stations.end())
  {
    throw std::invalid_argument("The stations of a FASTRAK are 1 to 4, each once and ascending");
  }
  if (!settings.Layout.HasPose())
  {
    throw std::invalid_argument("The record of a tracker must have the position (item 2) and the "
                                "angles (4), the quaternion (11) or all axes (5 6 7)");
  }
  if (!IsFinite(settings.Hemisphere))
  {
    throw std::invalid_argument("The zenith of the hemisphere must be finite");
  }
  this->Motions.fill(MotionCheck(settings.Motion));
}

void FastrakTracker::CheckStopped() const
{
  if (this->Stopped && this->Stopped())
  {
    throw Aborted();
  }
}

bool FastrakTracker::IsWanted(int station) const
{
  const std::vector<int>& stations = this->Settings.Stations;
  return std::find(stations.begin(), stations.end(), station) != stations.end();
}

std::size_t FastrakTracker::Receive(double seconds, std::vector<FastrakMessage>& messages)
{
  std::array<char, 256> bytes{};
  const double end = this->Time.Now() + seconds;
  std::size_t count = 0;
  double left = seconds;
  do
  {
    this->CheckStopped();
    count = this->Channel.Read(bytes.data(), bytes.size(), std::clamp(left, 0.0, StopInterval));
    left = end - this->Time.Now();
  } while (count == 0 && left > 0);
  this->ReceivedBytes += count;
  this->Parser.Feed({ bytes.data(), count }, messages);
  return count;
}

void FastrakTracker::Settle(double quiet, double longest)
{
  const double end = this->Time.Now() + longest;
  std::vector<FastrakMessage> messages;
  while (this->Receive(quiet, messages) > 0 && this->Time.Now() < end)
  {
  }
  for (const FastrakMessage& message : messages)
  {
    if (const auto* reply = std::get_if<FastrakReply>(&message))
    {
      this->NoteReply(*reply);
    }
    else if (!this->IsWanted(std::get<FastrakRecord>(message).Station))
    {
      this->OtherStation = std::get<FastrakRecord>(message).Station;
    }
  }
  this->Parser.EndOfTransmission();
}

void FastrakTracker::Warn(const std::string& text)
{
  this->Warning = text;
  this->WarnedAt = this->Time.Now();
}

void FastrakTracker::NoteReply(const FastrakReply& reply)
{
  if (const auto complaint = ReadFastrakComplaint(reply))
  {
    this->LastComplaint = DescribeFastrakComplaint(*complaint);
    this->Warn("The FASTRAK " + this->LastComplaint);
  }
}

bool FastrakTracker::AskStatus()
{
  this->Channel.Write(std::string(1, FastrakCommand::Status));
  std::vector<FastrakMessage> messages;
  const double end = this->Time.Now() + StatusTime;
  double wait = StatusTime;
  while (this->Time.Now() < end && this->Receive(wait, messages) > 0)
  {
    wait = std::min(this->Settings.GapTime, end - this->Time.Now()); // it comes in one piece
    for (const FastrakMessage& message : messages)
    {
      const auto* reply = std::get_if<FastrakReply>(&message);
      const auto status = reply ? ReadFastrakStatus(*reply) : std::nullopt;
      if (status)
      {
        this->Status = *status;
        return true;
      }
    }
  }
  this->Settle(this->Settings.GapTime, StatusTime);
  return false;
}

void FastrakTracker::SendSettings()
{
  const FastrakFormat& format = this->Settings.Format;
  std::string commands{ FastrakCommand::StopContinuous,
    format.Unit == LengthUnit::Inch ? FastrakCommand::Inches : FastrakCommand::Centimetres,
    format.Binary ? FastrakCommand::Binary : FastrakCommand::Ascii };
  for (int station = 1; station <= FastrakStations; ++station)
  {
    commands += FastrakCommand::Active(station, this->IsWanted(station));
  }
  for (const int station : this->Settings.Stations)
  {
    if (this->Settings.Reset != FastrakReset::Nothing)
    {
      commands += FastrakCommand::ResetAlignment(station) + FastrakCommand::Unboresight(station);
    }
    commands += FastrakCommand::OutputList(station, this->Settings.Layout) +
      FastrakCommand::Hemisphere(station, this->Settings.Hemisphere);
  }
  if (this->IsWanted(1))
  {
    commands += FastrakCommand::ButtonAsksForRecord(1, false);
  }
  if (this->Settings.FiltersOff)
  {
    commands += FastrakCommand::PositionFilterOff() + FastrakCommand::AttitudeFilterOff();
  }
  this->LastComplaint.clear();
  this->Channel.Write(commands);
  const double transfer = this->Channel.GetBaud() > 0
    ? 10.0 * static_cast<double>(commands.size()) / this->Channel.GetBaud()
    : 0;
  this->Settle(CommandTime + transfer, 1 + transfer);
}

void FastrakTracker::SetUp()
{
  const std::string device = "The device on " + this->Channel.GetName();
  for (MotionCheck& motion : this->Motions)
  {
    motion.Reset();
  }
  this->Warning.clear();
  this->ReceivedBytes = 0;
  bool alive = false;
  for (int i = 0; i < Attempts && !alive; ++i)
  {
    // ends a command that was begun, resumes held output, ends continuous output
    this->Channel.Write(
      std::string{ '\r', FastrakCommand::Resume, FastrakCommand::StopContinuous });
    this->Settle(CommandTime, 1);
    alive = this->AskStatus();
    if (i == 1 && this->ReceivedBytes == 0)
    {
      throw TrackerError(TrackerError::Kind::Silent,
        device + " does not answer" + BaudText(this->Channel) +
          ". Is the FASTRAK switched on (it needs 10 s to start), is this its port, does the cable "
          "cross the lines as its manual says, and is the baud rate that of the switches at its "
          "rear?");
    }
  }
  if (!alive)
  {
    throw TrackerError(TrackerError::Kind::Garbage,
      device + " sends bytes (" + std::to_string(this->ReceivedBytes) +
        ") that no FASTRAK does. Most likely the baud rate is wrong" + BaudText(this->Channel) +
        ": set the one of the switches at its rear (115200, 19200 and 9600 are usual), 8 data "
        "bits, "
        "no parity; or another device is on this port.");
  }
  if (this->Settings.Reset == FastrakReset::Factory)
  {
    this->Channel.Write(std::string(1, FastrakCommand::Defaults));
    this->Settle(CommandTime, 1);
  }
  for (int i = 0; i < Attempts; ++i)
  {
    this->SendSettings();
    if (this->AskStatus() && this->IsAsSet() && this->LastComplaint.empty())
    {
      break;
    }
    if (i + 1 == Attempts)
    {
      throw TrackerError(TrackerError::Kind::Complaint,
        this->LastComplaint.empty() ? device +
            " answers, but does not keep to the records that it is set to: switch it off "
            "and on"
                                    : "The FASTRAK on " + this->Channel.GetName() + " " +
            this->LastComplaint + ": its firmware may be older than this program expects");
    }
  }
  this->CheckRecords();
}

void FastrakTracker::CheckRecords()
{
  this->OtherStation = 0;
  std::size_t damaged = 0;
  for (int i = 0; i < RecordAttempts; ++i)
  {
    std::vector<TrackedPose> measured;
    const Outcome outcome = this->Request(measured);
    if (outcome == Outcome::Records)
    {
      return;
    }
    damaged += outcome == Outcome::Damaged ? 1 : 0;
  }
  const std::string wanted = std::to_string(this->Settings.Stations.front());
  const std::string begin = "The FASTRAK on " + this->Channel.GetName() + " answers";
  if (this->OtherStation != 0)
  {
    throw TrackerError(TrackerError::Kind::WrongStation,
      begin + " for station " + std::to_string(this->OtherStation) + " and not as asked for " +
        wanted + ": set Station to " + std::to_string(this->OtherStation) +
        " or plug the receiver into " + wanted);
  }
  if (damaged == 0)
  {
    throw TrackerError(TrackerError::Kind::WrongStation,
      begin + ", but sends no record: is a receiver plugged into station " + wanted + "?");
  }
  throw TrackerError(TrackerError::Kind::Garbage,
    begin +
      ", but its records are damaged or incomplete. Are all stations that were asked for "
      "plugged in? Else look at the cable, keep it from mains leads, and choose a lower baud "
      "rate.");
}

TrackedPose FastrakTracker::MakePose(
  const FastrakRecord& record, double request, double arrival) const
{
  constexpr double cycle = 1 / 120.0; // of one receiver; they are measured in turn
  const std::vector<int>& stations = this->Settings.Stations;
  const auto turn = std::find(stations.begin(), stations.end(), record.Station) - stations.begin();
  TrackedPose pose;
  pose.Request = request;
  pose.Arrival = arrival;
  pose.Time = request + this->Settings.SampleLatency + cycle * static_cast<double>(turn);
  pose.Station = record.Station;
  const auto matrix = record.GetPose();
  pose.ReceiverToTransmitter = matrix.value_or(Matrix4());
  pose.Error = record.Error;
  pose.Usable = matrix && IsFastrakErrorHarmless(record.Error);
  pose.Button = record.Button;
  return pose;
}

FastrakTracker::Outcome FastrakTracker::Request(std::vector<TrackedPose>& measured)
{
  std::vector<FastrakMessage> messages;
  while (const std::size_t stray = this->Receive(0, messages))
  {
    this->Count.StrayBytes += stray;
  }
  this->Parser.EndOfTransmission();
  messages.clear();

  const std::size_t expected =
    this->Settings.Layout.GetLength(this->Settings.Format.Binary) * this->Settings.Stations.size();
  ++this->Count.Requests;
  const double request = this->Time.Now();
  this->Channel.Write(std::string(1, FastrakCommand::Point));
  std::size_t received = 0;
  double wait = this->Settings.ResponseTime;
  bool damaged = false;
  while (measured.size() < this->Settings.Stations.size() && !damaged)
  {
    messages.clear();
    const std::size_t count = this->Receive(wait, messages);
    const double arrival = this->Time.Now();
    received += count;
    wait = this->Settings.GapTime;
    for (const FastrakMessage& message : messages)
    {
      const auto* record = std::get_if<FastrakRecord>(&message);
      if (!record)
      {
        this->NoteReply(std::get<FastrakReply>(message));
      }
      else if (!this->IsWanted(record->Station))
      {
        this->OtherStation = record->Station;
        damaged = true;
      }
      else
      {
        measured.push_back(this->MakePose(*record, request, arrival));
      }
    }
    damaged = damaged || count == 0 ||
      (received >= expected && measured.size() < this->Settings.Stations.size());
  }
  // An answer to an earlier request that was given up would have a wrong time.
  const double shortest = this->Channel.GetBaud() > 0
    ? 10.0 * static_cast<double>(received) / this->Channel.GetBaud()
    : 0;
  const bool early = !damaged && measured.back().Arrival - request < 0.9 * shortest;
  const auto same = [](const TrackedPose& a, const TrackedPose& b)
  {
    return a.Station >= b.Station; // each once, ascending
  };
  if (!damaged && !early && received == expected &&
    std::adjacent_find(measured.begin(), measured.end(), same) == measured.end())
  {
    this->IsLate = this->Trips.IsLate(measured.back().Arrival - request);
    this->Count.Late += this->IsLate ? 1 : 0;
    this->Count.Records += this->IsLate ? 0 : measured.size();
    return Outcome::Records;
  }
  measured.clear();
  this->Count.Early += early ? 1 : 0;
  ++(received == 0 ? this->Count.Silent : this->Count.Damaged);
  this->Settle(0.002, this->Settings.GapTime);
  return received == 0 ? Outcome::Silent : Outcome::Damaged;
}

bool FastrakTracker::Poll(std::vector<TrackedPose>& poses)
{
  if (this->Failures >= DoubtfulFailures && !this->MakeSure())
  {
    return false;
  }
  std::vector<TrackedPose> measured;
  const Outcome outcome = this->Request(measured);
  if (outcome != Outcome::Records)
  {
    // an answer that did not come may still come, and must not be taken for that to another request
    this->Failures = outcome == Outcome::Silent ? DoubtfulFailures : this->Failures + 1;
    return false;
  }
  this->Failures = 0;
  this->Doubted = false;
  if (this->Time.Now() - this->WarnedAt > WarningTime)
  {
    this->Warning.clear();
  }
  for (TrackedPose& pose : measured)
  {
    if (!pose.Usable)
    {
      this->Warn("The FASTRAK reports for station " + std::to_string(pose.Station) + ": " +
        DescribeFastrakError(pose.Error));
    }
    pose.Usable = pose.Usable && !this->IsLate;
    this->Motions[pose.Station - 1].Judge(pose, poses);
  }
  return true;
}

bool FastrakTracker::IsAsSet() const
{
  const FastrakFormat& format = this->Settings.Format;
  return this->Status.Binary == format.Binary &&
    this->Status.Centimetres == (format.Unit == LengthUnit::Centimetre) && !this->Status.Continuous;
}

bool FastrakTracker::MakeSure()
{
  // answers come in order: after this one none to an earlier request does
  if (!this->AskStatus())
  {
    return false;
  }
  this->Failures = 0;
  // a restarted unit's records are ASCII in inches, which those wanted may be too, but for their list
  if (!this->IsAsSet() || std::exchange(this->Doubted, true))
  {
    this->Doubted = false;
    this->SetUp();
    this->Warn("The FASTRAK had been restarted and was set up again");
  }
  return true;
}

FastrakTracker::Counts FastrakTracker::GetCounts() const
{
  Counts counts = this->Count;
  for (const MotionCheck& motion : this->Motions)
  {
    counts.Implausible += motion.GetNumberOfDropped();
    counts.Flipped += motion.GetNumberOfFlipped();
  }
  return counts;
}
}
