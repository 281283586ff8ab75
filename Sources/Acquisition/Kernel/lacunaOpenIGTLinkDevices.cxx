// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaOpenIGTLinkDevices.h"

#include "lacunaOpenIGTLinkConnection.h"

#include <chrono>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace lacuna
{
namespace
{
constexpr double PollTime = 1;      // s
constexpr double FrameTime = 3;     // s without an image after which there is none
constexpr double WorstJitter = 0.1; // s
constexpr double TroubleLasts = 10; // s that a complaint is shown
constexpr int ManyFaults = 5;       // in a row: no accidents

bool IsPoseType(const std::string& type)
{
  return type == "TRANSFORM" || type == "POSITION" || type == "QTRANS";
}

OpenIGTLinkInbox::Filter MakePoseFilter(const std::string& wanted)
{
  return [wanted](const OpenIGTLinkHeader& header)
  {
    const std::string& type = header.Type;
    const bool named = !wanted.empty() && IsOpenIGTLinkName(header.Device, wanted);
    return type == "STATUS" || type == "TDATA" || type == "QTDATA" ||
      (IsPoseType(type) && (wanted.empty() || named)) || (type == "IMAGE" && named);
  };
}

OpenIGTLinkInbox::Filter MakeImageFilter(const std::string& wanted)
{
  return [wanted](const OpenIGTLinkHeader& header)
  {
    return header.Type == "STATUS" ||
      (header.Type == "IMAGE" && (wanted.empty() || IsOpenIGTLinkName(header.Device, wanted)));
  };
}

std::string FormatTenths(double value)
{
  const auto tenths = static_cast<long>(std::floor(10 * value + 0.5));
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10);
}

// What the server sends instead of a device that was asked for.
std::string DescribeDevices(const OpenIGTLinkConnection& connection)
{
  const std::string devices = connection.GetDevices();
  return devices.empty() ? "; it sends nothing at all: is it an OpenIGTLink server, is its device "
                           "connected, and does it serve only one client, another one?"
                         : "; it sends " + devices;
}

// The first device that comes is the one, unless another comes too.
void Choose(const std::string& name, const std::string& option, const std::string& server,
  std::string& chosen)
{
  if (!chosen.empty() && name != chosen)
  {
    throw std::invalid_argument("The server " + server + " sends the " + option + "s '" + chosen +
      "' and '" + name + "': choose one, as " + server + "?" + option + "=" + chosen);
  }
  chosen = name;
}
}

OpenIGTLinkPoseDevice::OpenIGTLinkPoseDevice(const OpenIGTLinkAddress& address, int station,
  std::shared_ptr<OpenIGTLinkConnection> connection, std::function<bool()> stopped)
  : Address(address)
  , Station(station)
  , Connection(std::move(connection))
  , Inbox(std::make_unique<OpenIGTLinkInbox>(MakePoseFilter(address.Transform)))
  , Stopped(std::move(stopped))
{
}

OpenIGTLinkPoseDevice::~OpenIGTLinkPoseDevice()
{
  this->Connection->Detach(*this->Inbox);
}

void OpenIGTLinkPoseDevice::SetUp()
{
  this->Connection->Attach(*this->Inbox);
  if (!this->Address.StartTrackingData.empty())
  {
    this->Connection->Send(MakeOpenIGTLinkTrackingRequest(this->Address.StartTrackingData));
  }
}

bool OpenIGTLinkPoseDevice::Poll(std::vector<TrackedPose>& poses)
{
  using Clock = std::chrono::steady_clock;
  const std::size_t before = poses.size();
  const auto begin = Clock::now();
  for (double left = PollTime; left > 0 && poses.size() == before;)
  {
    auto arrival = this->Inbox->Wait(left, this->Stopped);
    for (; arrival; arrival = this->Inbox->Wait(0, this->Stopped))
    {
      this->Take(*arrival, poses);
    }
    left = PollTime - std::chrono::duration<double>(Clock::now() - begin).count();
  }
  const bool any = poses.size() > before;
  this->Silence = any ? 0 : this->Silence + 1;
  this->Warning = this->FindWarning();
  return any;
}

void OpenIGTLinkPoseDevice::Take(const OpenIGTLinkArrival& arrival, std::vector<TrackedPose>& poses)
{
  const OpenIGTLinkMessage& message = arrival.Message;
  if (!this->Trouble.empty() && arrival.Arrival > this->TroubleTime + TroubleLasts)
  {
    this->Trouble.clear();
  }
  try
  {
    if (message.Header.Type == "STATUS")
    {
      this->Trouble = ReadOpenIGTLinkStatus(message);
      this->TroubleTime = arrival.Arrival;
    }
    else if (message.Header.Type == "IMAGE")
    {
      this->TakePose(ReadOpenIGTLinkImage(message).Plane, arrival, poses);
    }
    for (const OpenIGTLinkPose& pose : ReadOpenIGTLinkPoses(message))
    {
      if (this->Address.Transform.empty() || IsOpenIGTLinkName(pose.Name, this->Address.Transform))
      {
        this->TakePose(pose, arrival, poses);
      }
    }
  }
  catch (const OpenIGTLinkError& e)
  {
    ++this->Damaged;
    this->Trouble = e.what();
    this->TroubleTime = arrival.Arrival;
  }
}

void OpenIGTLinkPoseDevice::TakePose(
  const OpenIGTLinkPose& pose, const OpenIGTLinkArrival& arrival, std::vector<TrackedPose>& poses)
{
  const std::string server = this->Connection->GetName();
  Choose(pose.Name, "transform", server, this->Name);
  const OpenIGTLinkHeader& header = arrival.Message.Header;
  const bool first = this->Poses == 0;
  if (!first &&
    ((header.Stamp && header.Stamp == this->LastStamp) ||
      (arrival.Time <= this->LastTime && arrival.Epoch.Fits(this->LastEpoch))))
  {
    this->Repeats = true;
    return; // servers repeat the last one when there is none newer
  }
  this->Repeats = false;
  this->LastStamp = header.Stamp;
  this->LastTime = arrival.Time;
  this->LastEpoch = arrival.Epoch;
  if (!pose.Fault.empty())
  {
    const std::string text =
      "The pose of '" + pose.Name + "' from " + server + " cannot be used: " + pose.Fault;
    if (++this->Faults >= ManyFaults || this->Poses == 0)
    {
      throw std::runtime_error(text);
    }
    throw OpenIGTLinkError(text);
  }
  this->Faults = 0;
  this->WatchClock(arrival);
  this->WatchStatus(pose, arrival);
  this->Usable = pose.Usable;
  TrackedPose tracked;
  tracked.Request = arrival.Time;
  tracked.Arrival = arrival.Arrival;
  tracked.Time = arrival.Time;
  tracked.Station = this->Station;
  tracked.ReceiverToTransmitter = pose.Pose;
  tracked.Usable = pose.Usable;
  tracked.Error = pose.Usable ? ' ' : 'I';
  tracked.Button = pose.Button;
  tracked.Epoch = arrival.Epoch;
  poses.push_back(tracked);
  ++this->Poses;
}

// Once a connection: servers other than PLUS can do nothing about it.
void OpenIGTLinkPoseDevice::WatchStatus(
  const OpenIGTLinkPose& pose, const OpenIGTLinkArrival& arrival)
{
  this->Status = pose.Status;
  if (!pose.Status.empty() || !pose.Usable)
  {
    this->NoStatusTime.reset();
  }
  else if (this->Poses == 0)
  {
    this->NoStatusTime = arrival.Arrival;
  }
  else if (this->NoStatusTime && arrival.Arrival > *this->NoStatusTime + TroubleLasts)
  {
    this->NoStatusTime.reset();
  }
}

void OpenIGTLinkPoseDevice::WatchClock(const OpenIGTLinkArrival& arrival)
{
  const OpenIGTLinkClockState clock = this->Connection->GetClock(arrival.Message.Header);
  if (this->ClockOffset && clock.Offset && clock.Steps != this->ClockSteps)
  {
    this->Trouble = "The clock of " + this->Connection->GetName() + " was set by " +
      FormatTenths(std::abs(*this->ClockOffset - *clock.Offset)) +
      " s: poses and frames of that moment may not fit together";
    this->TroubleTime = arrival.Arrival;
  }
  this->ClockOffset = clock.Offset;
  this->ClockSteps = clock.Steps;
  this->Jitter = clock.Jitter;
  this->OtherClock = clock.Other;
  this->OtherStep = clock.OtherStep;
}

PoseCounts OpenIGTLinkPoseDevice::GetCounts() const
{
  const OpenIGTLinkCounts counts = this->Inbox->GetCounts();
  PoseCounts result;
  result.Poses = this->Poses;
  result.Missing = counts.Dropped;
  result.Damaged = counts.Damaged + this->Damaged;
  return result;
}

// The usual reason of a tracker that sends nothing.
std::string OpenIGTLinkPoseDevice::AdviseStart() const
{
  if (!this->Address.StartTrackingData.empty() || this->Poses > 0 || this->Connection->SendsPoses())
  {
    return {};
  }
  const std::string sign = this->Address.Transform.empty() ? "?" : "&";
  return "Many trackers send poses only when asked: add " + sign + "start=TDATA (or " + sign +
    "start=QTDATA) to the address";
}

std::string OpenIGTLinkPoseDevice::FindWarning() const
{
  const std::string server = this->Connection->GetName();
  const std::string fault = this->Inbox->GetFault();
  if (this->Silence > (this->Poses > 0 ? this->AllowedSilence : 0))
  {
    std::string text = "No pose " +
      (this->Address.Transform.empty() ? "" : "of '" + this->Address.Transform + "' ") +
      "has come from " + server + " for " + std::to_string(this->Silence) + " s" +
      DescribeDevices(*this->Connection);
    for (const std::string& more : { this->AdviseStart(),
           std::string(this->Repeats
               ? "The pose's time stamp stands still: does its tracker still measure?"
               : ""),
           this->Trouble, fault })
    {
      text += more.empty() ? "" : (text.back() == '?' ? " " : ". ") + more;
    }
    return text;
  }
  if (!this->Trouble.empty())
  {
    return this->Trouble;
  }
  if (!this->Usable)
  {
    return "The tracker of " + server + " does not see '" + this->Name + "' (" +
      (this->Status.empty() ? "it sends no number, or the identity" : this->Status) +
      "): bring it into its field";
  }
  if (!this->LastStamp)
  {
    return "The poses of '" + this->Name + "' have no time stamps: the time of arrival is taken, " +
      "with all delays of the network";
  }
  if (this->OtherStep > 0)
  {
    return "The clocks of '" + this->Name + "' and '" + this->OtherClock + "' from " + server +
      " differ by " + FormatTenths(this->OtherStep) +
      " s: images get the poses of when they arrived, not of their stamps. Let one clock stamp "
      "both; if the images are that old, give VideoLatency their age";
  }
  if (this->NoStatusTime)
  {
    return "The poses of '" + this->Name + "' from " + server +
      " have no status: nothing tells when the tracker does not see the tool, and a wrong pose may "
      "be "
      "taken for a right one. Have the server leave such poses out (PLUS: "
      "SendValidTransformsOnly=\"true\")";
  }
  if (this->Jitter > WorstJitter)
  {
    return "Messages of " + server + " come up to " + FormatTenths(this->Jitter) +
      " s late; their stamps make up for it, the display lags: use a cable, not a wireless network";
  }
  return {};
}

OpenIGTLinkFrameDevice::OpenIGTLinkFrameDevice(const OpenIGTLinkAddress& address,
  std::shared_ptr<OpenIGTLinkConnection> connection, std::function<bool()> stopped)
  : Address(address)
  , Connection(std::move(connection))
  , Inbox(std::make_unique<OpenIGTLinkInbox>(MakeImageFilter(address.Image)))
  , Stopped(std::move(stopped))
{
  this->Connection->Attach(*this->Inbox);
}

OpenIGTLinkFrameDevice::~OpenIGTLinkFrameDevice()
{
  this->Connection->Detach(*this->Inbox);
}

VideoEvent OpenIGTLinkFrameDevice::Read(VideoFrame& frame)
{
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  for (double left = FrameTime; left > 0;)
  {
    const auto arrival = this->Inbox->Wait(left, this->Stopped);
    if (arrival && this->Take(*arrival, frame))
    {
      const bool other =
        this->Frames > 0 && (frame.Columns != this->Columns || frame.Rows != this->Rows);
      this->Columns = frame.Columns;
      this->Rows = frame.Rows;
      ++this->Frames;
      return other ? VideoEvent::NewSize : VideoEvent::Frame;
    }
    left = FrameTime - std::chrono::duration<double>(Clock::now() - begin).count();
  }
  this->ThrowSilent();
}

// False when it is no new image.
bool OpenIGTLinkFrameDevice::Take(const OpenIGTLinkArrival& arrival, VideoFrame& frame)
{
  const OpenIGTLinkMessage& message = arrival.Message;
  const std::string server = this->Connection->GetName();
  try
  {
    if (message.Header.Type == "STATUS")
    {
      this->Trouble = ReadOpenIGTLinkStatus(message);
      return false;
    }
    Choose(message.GetDevice(), "image", server, this->Name);
    if (message.Header.Stamp && message.Header.Stamp == this->LastStamp)
    {
      return false;
    }
    this->LastStamp = message.Header.Stamp;
    OpenIGTLinkImage image = ReadOpenIGTLinkImage(message);
    this->Faults = 0;
    if (this->LastTime && arrival.Time <= *this->LastTime)
    {
      ++this->Backward; // its clock became known better; times that go back serve nobody
      return false;
    }
    this->LastTime = arrival.Time;
    frame.Columns = image.Columns;
    frame.Rows = image.Rows;
    frame.Grey = std::move(image.Grey);
    frame.PixelSpacing = image.PixelSpacing;
    const double aspect =
      image.PixelSpacing ? (*image.PixelSpacing)[0] / (*image.PixelSpacing)[1] : 1;
    frame.PixelAspect = std::isfinite(aspect) && aspect > 0 ? aspect : 1;
    frame.Arrival = arrival.Time;
    frame.StreamTime = message.Header.Stamp;
    frame.Epoch = arrival.Epoch;
    frame.Damaged = !image.Valid;
    return true;
  }
  catch (const OpenIGTLinkError& e)
  {
    if (++this->Faults >= ManyFaults || this->Frames == 0)
    {
      throw VideoError(VideoError::Kind::Unsupported,
        "The images from " + server + " cannot be used: " + e.what());
    }
    this->Trouble = e.what();
    ++this->Damaged;
    return false;
  }
}

void OpenIGTLinkFrameDevice::ThrowSilent() const
{
  const std::string fault = this->Inbox->GetFault();
  throw VideoError(VideoError::Kind::Silent,
    "No new image " + (this->Address.Image.empty() ? "" : "of '" + this->Address.Image + "' ") +
      "has come from " + this->Connection->GetName() + " for 3 s" +
      DescribeDevices(*this->Connection) + (this->Trouble.empty() ? "" : ". " + this->Trouble) +
      (fault.empty() ? "" : ". " + fault));
}

VideoSource::Counts OpenIGTLinkFrameDevice::GetCounts() const
{
  const OpenIGTLinkCounts counts = this->Inbox->GetCounts();
  VideoSource::Counts result;
  result.Frames = this->Frames;
  result.Undecodable = counts.Damaged + this->Damaged;
  result.Missing = counts.Dropped + this->Backward;
  return result;
}

std::string OpenIGTLinkFrameDevice::GetWarning() const
{
  return this->Frames == 0 || this->LastStamp ? std::string()
                                              : "The images of '" + this->Name +
      "' have no time stamps: the time of arrival is taken, with all delays of the network. Give "
      "VideoLatency what they usually are";
}

PoseDeviceFactory MakeOpenIGTLinkPoseFactory(
  const std::string& address, int station, const Clock& clock)
{
  const OpenIGTLinkAddress parts = ParseOpenIGTLinkAddress(address);
  return [parts, station, &clock](const std::function<bool()>& stopped)
  {
    return std::make_unique<OpenIGTLinkPoseDevice>(
      parts, station, OpenIGTLinkConnection::Open(parts, clock, stopped), stopped);
  };
}

FrameDeviceFactory MakeOpenIGTLinkFrameFactory(const std::string& address, const Clock& clock)
{
  const OpenIGTLinkAddress parts = ParseOpenIGTLinkAddress(address);
  return [parts, &clock](const std::function<bool()>& stopped)
  {
    return std::make_unique<OpenIGTLinkFrameDevice>(
      parts, OpenIGTLinkConnection::Open(parts, clock, stopped), stopped);
  };
}
}
