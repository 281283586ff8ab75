// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSweepAcquisitionCore.h"

#include <algorithm>
#include <exception>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr int ManyFrames = 10;       // without a pose: half a second
constexpr double LongestSilence = 3; // s of a tracker that worked

PoseCounts Sum(const PoseCounts& a, const PoseCounts& b)
{
  return { a.Poses + b.Poses, a.Missing + b.Missing, a.Damaged + b.Damaged,
    a.Implausible + b.Implausible, a.Flipped + b.Flipped };
}

VideoSource::Counts Sum(const VideoSource::Counts& a, const VideoSource::Counts& b)
{
  VideoSource::Counts sum;
  sum.Frames = a.Frames + b.Frames;
  sum.Damaged = a.Damaged + b.Damaged;
  sum.Undecodable = a.Undecodable + b.Undecodable;
  sum.Missing = a.Missing + b.Missing;
  return sum;
}
}

void SweepAcquisition::Core::TrackPoses(
  const AcquisitionDevices& devices, DeviceThread::Control& control)
{
  const auto device = devices.Poses([&control] { return control.IsStopped(); });
  device->SetUp();
  try
  {
    double last = this->Time.Now();
    std::vector<TrackedPose> poses;
    while (!control.IsStopped())
    {
      poses.clear();
      const double hold = this->GetHold();
      device->AllowSilence(hold);
      const bool came = device->Poll(poses);
      if (control.IsStopped())
      {
        return; // there may be another tracker
      }
      this->AddPoses(poses, came, *device, devices.Station);
      if (came)
      {
        control.SetWorking();
        last = this->Time.Now();
      }
      if (this->Time.Now() - last > std::max(LongestSilence, hold))
      {
        const std::string why = device->GetWarning();
        throw std::runtime_error(!why.empty()
            ? why
            : "The tracker sends nothing any more: is it switched on and its cable plugged in?");
      }
    }
  }
  catch (...)
  {
    if (!control.IsStopped())
    {
      this->LosePoses();
    }
    throw;
  }
}

double SweepAcquisition::Core::GetHold() const
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  return this->Rules.HoldLastPose;
}

void SweepAcquisition::Core::AddPoses(
  const std::vector<TrackedPose>& poses, bool came, const PoseDevice& device, int station)
{
  const PoseCounts counts = device.GetCounts();
  std::string warning = device.GetWarning();
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    this->NewestPoses = counts;
    this->TrackerWarning = std::move(warning);
    this->PosesCome = this->PosesCome || came;
    for (const TrackedPose& pose : poses)
    {
      if (pose.Station == station)
      {
        this->HeedButton(pose);
        this->Pairing.AddPose(pose);
      }
    }
  }
  this->Process();
}

void SweepAcquisition::Core::HeedButton(const TrackedPose& pose)
{
  if (!pose.Button || pose.Arrival < this->ButtonTime)
  {
    return; // it waited, see MotionCheck, and newer ones did not
  }
  this->ButtonTime = pose.Arrival;
  // two records must agree: a damaged one presses nothing
  if (*pose.Button == this->ButtonBefore && *pose.Button != this->ButtonDown)
  {
    this->ButtonDown = *pose.Button;
    if (this->ButtonDown && this->Rules.ButtonStarts)
    {
      this->SetCapturing(!this->Capturing);
    }
  }
  this->ButtonBefore = *pose.Button;
}

void SweepAcquisition::Core::SetCapturing(bool on)
{
  this->Started = this->Capturing = on && !this->Finished;
}

void SweepAcquisition::Core::LosePoses()
{
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    this->EarlierPoses = this->CountPoses();
    this->NewestPoses = {};
    this->TrackerWarning.clear();
    this->PosesCome = false;
    this->ButtonBefore = this->ButtonDown; // one that is held is not pressed again
    this->Pairing.EndHold();
    this->Pairing.Abandon();
  }
  this->Process();
}

void SweepAcquisition::Core::BreakPoses()
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  this->Pairing.Break();
}

void SweepAcquisition::Core::ReadFrames(
  const AcquisitionDevices& devices, DeviceThread::Control& control)
{
  const auto device = devices.Frames([&control] { return control.IsStopped(); });
  const double latency = devices.VideoLatency.value_or(device->GetLatency());
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    if (control.IsStopped())
    {
      return; // it took long to open, and another one counts by now
    }
    this->EarlierVideo = this->CountVideo();
    this->NewestVideo = {};
    this->Untimed.clear();
    this->VideoWarning.clear();
  }
  while (!control.IsStopped())
  {
    auto frame = std::make_shared<VideoFrame>();
    if (device->Read(*frame) == VideoEvent::End)
    {
      const std::string text = "The video has ended";
      if (devices.ReopenEndedVideo)
      {
        throw std::runtime_error(
          text + ": does its sender still run? It is opened again when it does");
      }
      throw DeviceEnded(text + ": no more frames come");
    }
    control.SetWorking();
    this->AddFrame(std::move(frame), latency, *device, control);
  }
}

// With the lock, from the thread of the present video: each arrival belongs to a frame that it gave
// with Timed false, so Untimed has as many at least.
void SweepAcquisition::Core::SetTimes(const std::vector<std::optional<double>>& arrivals)
{
  for (const std::optional<double>& arrival : arrivals)
  {
    const auto [number, before] = this->Untimed.front();
    this->Untimed.pop_front();
    this->Pairing.SetTime(
      number, arrival ? std::optional<double>(*arrival - before) : std::nullopt);
  }
}

void SweepAcquisition::Core::AddFrame(
  FramePointer frame, double latency, FrameDevice& device, const DeviceThread::Control& control)
{
  const std::vector<std::optional<double>> arrivals = device.TakeArrivals();
  const VideoSource::Counts counts = device.GetCounts();
  std::string warning = device.GetWarning();
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    if (control.IsStopped())
    {
      return; // another video may count by now, and these are not its frames
    }
    this->SetTimes(arrivals);
    PairedFrame paired;
    paired.Instant = frame->Arrival - latency + this->Rules.TimeOffset;
    paired.Epoch = frame->Epoch;
    paired.Timed = frame->Timed;
    if (!frame->Timed)
    {
      this->Untimed.emplace_back(this->NextNumber, frame->Arrival);
    }
    paired.Frame = std::move(frame);
    paired.Number = this->NextNumber++;
    paired.Wanted = this->Capturing;
    if (this->Capturing)
    {
      ++this->Pending;
      this->Missing += static_cast<std::int64_t>(counts.Missing - this->NewestVideo.Missing +
        counts.Undecodable - this->NewestVideo.Undecodable);
    }
    this->NewestVideo = counts;
    this->VideoWarning = std::move(warning);
    this->Pairing.AddFrame(std::move(paired), this->Time.Now());
    if (!this->PosesCome)
    {
      this->Pairing.Abandon();
    }
  }
  this->Process();
}

// Devices never wait here, while a disk ends a recording for instance: what they measured later would
// get times that are too late. Who has the lock does their work afterwards.
void SweepAcquisition::Core::Process()
{
  this->Asked = true;
  while (this->Asked)
  {
    const std::unique_lock<std::mutex> taking(this->TakeMutex, std::try_to_lock);
    if (!taking.owns_lock())
    {
      return;
    }
    this->Asked = false;
    this->TakeReady();
  }
}

void SweepAcquisition::Core::CatchUp()
{
  if (this->Asked)
  {
    this->Process();
  }
}

// With TakeMutex.
void SweepAcquisition::Core::TakeReady()
{
  std::vector<PairedFrame> ready;
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    ready = this->Pairing.Take(this->Time.Now());
    this->HeedStart();
    // what waits for its time is shown all the same
    const std::optional<PairedFrame> untimed = this->Pairing.FindUntimed();
    if (const auto window = untimed ? this->Taking.GetWindow(*untimed->Frame) : std::nullopt)
    {
      this->Live = std::pair(*untimed, *window);
    }
  }
  if (ready.empty())
  {
    return;
  }
  std::vector<AcquiredSlice> slices;
  std::int64_t processed = 0;
  std::exception_ptr error; // slices that were taken are told all the same
  for (const PairedFrame& frame : ready)
  {
    processed += frame.Wanted ? 1 : 0;
    try
    {
      this->Taking.Add(frame, this->Time.Now(), slices);
    }
    catch (...)
    {
      error = std::current_exception();
    }
  }
  const std::lock_guard<std::mutex> lock(this->Mutex);
  if (const auto window = this->Taking.GetWindow(*ready.back().Frame))
  {
    this->Live = std::pair(std::move(ready.back()), *window);
  }
  this->Publish(processed, std::move(slices));
  if (error)
  {
    std::rethrow_exception(error);
  }
}

// With TakeMutex. Frames that wait for poses go without.
void SweepAcquisition::Core::TakeLast()
{
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    this->Pairing.Abandon();
  }
  this->TakeReady();
}

// With both locks.
void SweepAcquisition::Core::HeedStart()
{
  if (std::exchange(this->Started, false))
  {
    this->Taking.Resume();
  }
}

// With both locks.
void SweepAcquisition::Core::Publish(std::int64_t processed, std::vector<AcquiredSlice> slices)
{
  this->HeedStart();
  this->Slices.insert(this->Slices.end(), std::make_move_iterator(slices.begin()),
    std::make_move_iterator(slices.end()));
  this->Pending -= processed;
  this->Capturing = this->Capturing && !this->Taking.IsFull();
  if (!this->Capturing && this->Pending == 0)
  {
    this->Taking.VerifyFile();
  }
  this->State.Counts = this->Taking.GetCounts();
  this->State.Speed = this->Taking.GetSpeed();
  this->State.LargestResidual = this->Taking.GetLargestResidual();
  this->State.File = this->Taking.GetFile();
  this->State.Memory = this->Taking.GetMemory();
  this->FramesSincePose = this->Taking.GetFramesSincePose();
  this->State.Messages = this->Taking.GetMessages();
  this->Sweep = this->Taking.GetSweep();
  this->Settled.notify_all();
}

PoseCounts SweepAcquisition::Core::CountPoses() const
{
  return Sum(this->EarlierPoses, this->NewestPoses);
}

VideoSource::Counts SweepAcquisition::Core::CountVideo() const
{
  return Sum(this->EarlierVideo, this->NewestVideo);
}

std::vector<std::string> SweepAcquisition::Core::DescribePoses() const
{
  std::vector<std::string> messages;
  if (!this->TrackerWarning.empty())
  {
    messages.push_back(this->TrackerWarning);
  }
  if (this->FramesSincePose >= ManyFrames && this->PosesCome)
  {
    messages.push_back(
      "The newest frames have no pose: no two measurements of the tracker, at most "
      "0.25 s apart, are around their instants. See whether the tracker stutters; if it "
      "sends a pose only when it changes, set HoldLastPose");
  }
  const std::uint64_t flipped = this->CountFlipped() - this->FlippedBefore;
  if (flipped > 0)
  {
    messages.push_back("The receiver was in the other half of space (" + std::to_string(flipped) +
      " records), and the signs of its position were set right. Keep it on the side of the "
      "transmitter that Hemisphere points to");
  }
  return messages;
}
}
