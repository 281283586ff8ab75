// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSweepAcquisition.h"

#include "lacunaDeviceThread.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <utility>

namespace lacuna
{
// What the threads of a SweepAcquisition's devices work on together.

// Shared with the threads, which may outlive the acquisition. TakeMutex before Mutex.
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

//------------------------------------------------------------------------------
namespace
{
constexpr std::chrono::duration<double> LongestSettling{ 0.8 }; // of a capture's last frames
}

SweepAcquisition::SweepAcquisition(
  const AcquisitionDevices& devices, const AcquisitionRules& rules, const Clock& clock)
{
  CheckRules(rules);
  this->Work = std::make_shared<Core>(devices, rules, clock);
  this->OpenTracker(devices);
  this->OpenVideo(devices);
}

void SweepAcquisition::OpenTracker(const AcquisitionDevices& devices)
{
  this->Tracker =
    std::make_unique<DeviceThread>([core = this->Work, devices](DeviceThread::Control& control)
      { core->TrackPoses(devices, control); },
      devices.RetryTime);
}

void SweepAcquisition::OpenVideo(const AcquisitionDevices& devices)
{
  this->Video =
    std::make_unique<DeviceThread>([core = this->Work, devices](DeviceThread::Control& control)
      { core->ReadFrames(devices, control); },
      devices.RetryTime);
}

void SweepAcquisition::ReplaceTracker(const AcquisitionDevices& devices)
{
  const std::lock_guard<std::mutex> lock(this->DevicesMutex);
  this->Tracker.reset();
  this->Work->LosePoses();
  this->Work->BreakPoses();
  this->OpenTracker(devices);
}

void SweepAcquisition::ReplaceVideo(const AcquisitionDevices& devices)
{
  const std::lock_guard<std::mutex> lock(this->DevicesMutex);
  this->Video.reset();
  this->OpenVideo(devices);
}

SweepAcquisition::~SweepAcquisition()
{
  this->Tracker->Stop(); // both before either is waited for
  this->Video->Stop();
}

void SweepAcquisition::SetRules(const AcquisitionRules& rules)
{
  CheckRules(rules);
  {
    const std::lock_guard<std::mutex> taking(this->Work->TakeMutex);
    this->Work->TakeReady(); // by the rules of their time
    this->Work->Taking.SetRules(rules);
    const std::lock_guard<std::mutex> lock(this->Work->Mutex);
    this->Work->Rules = rules;
    this->Work->Pairing.SetHold(rules.HoldLastPose);
  }
  this->Work->CatchUp();
}

void SweepAcquisition::Start()
{
  const std::lock_guard<std::mutex> lock(this->Work->Mutex);
  this->Work->SetCapturing(true);
}

void SweepAcquisition::Stop()
{
  std::unique_lock<std::mutex> lock(this->Work->Mutex);
  this->Work->SetCapturing(false);
  // frames that are late by their clock wait for poses to come
  const double instant = this->Work->Pairing.GetLatestInstant().value_or(0);
  const std::chrono::duration<double> late{ std::max(instant - this->Work->Time.Now(), 0.0) };
  this->Work->Settled.wait_for(
    lock, LongestSettling + late, [this] { return this->Work->Pending == 0; });
}

AcquisitionState SweepAcquisition::Finish()
{
  {
    const std::lock_guard<std::mutex> lock(this->Work->Mutex);
    this->Work->Finished = true;
  }
  this->Stop();
  {
    const std::lock_guard<std::mutex> taking(this->Work->TakeMutex);
    this->Work->TakeLast();
    this->Work->Taking.Finish();
    const std::lock_guard<std::mutex> lock(this->Work->Mutex);
    this->Work->Publish(0, {});
  }
  return this->GetState();
}

void SweepAcquisition::BeginSweep(bool discard)
{
  this->Stop();
  {
    const std::lock_guard<std::mutex> taking(this->Work->TakeMutex);
    this->Work->TakeLast(); // they are of this sweep
    std::unique_lock<std::mutex> lock(this->Work->Mutex);
    const std::int64_t missing = this->Work->Missing;
    const std::uint64_t flipped = this->Work->CountFlipped();
    lock.unlock();
    this->Work->Taking.BeginSweep(discard); // a capture may begin while the disk is slow
    lock.lock();
    this->Work->Slices.clear();
    this->Work->Missing -= missing;
    this->Work->FlippedBefore = flipped;
    this->Work->Publish(0, {});
    this->Work->Sweep.reset();
  }
  this->Work->CatchUp();
}

std::vector<AcquiredSlice> SweepAcquisition::TakeSlices()
{
  const std::lock_guard<std::mutex> lock(this->Work->Mutex);
  return std::exchange(this->Work->Slices, {});
}

std::optional<SweepFrame> SweepAcquisition::GetSweep() const
{
  const std::lock_guard<std::mutex> lock(this->Work->Mutex);
  return this->Work->Sweep;
}

std::optional<LiveFrame> SweepAcquisition::GetLive() const
{
  std::unique_lock<std::mutex> lock(this->Work->Mutex);
  const auto live = this->Work->Live;
  lock.unlock();
  if (!live)
  {
    return std::nullopt;
  }
  return LiveFrame{ MakeSlice(live->first, live->second, this->Work->Epoch), live->second };
}

AcquisitionState SweepAcquisition::GetState() const
{
  std::unique_lock<std::mutex> devices(this->DevicesMutex);
  const DeviceThread::Health tracker = this->Tracker->GetHealth();
  const DeviceThread::Health video = this->Video->GetHealth();
  devices.unlock();
  Core& core = *this->Work;
  {
    // the disk goes on when no frames come
    const std::unique_lock<std::mutex> taking(core.TakeMutex, std::try_to_lock);
    if (taking.owns_lock())
    {
      core.Taking.RetryFile();
      const std::lock_guard<std::mutex> lock(core.Mutex);
      core.Publish(0, {});
    }
  }
  core.CatchUp();
  const std::lock_guard<std::mutex> lock(core.Mutex);
  AcquisitionState state = core.State;
  state.Capturing = core.Capturing;
  state.TrackerWorks = tracker.Working;
  state.VideoWorks = video.Working;
  state.Pending = core.Pending;
  state.Missing = core.Missing;
  state.Counts.Frames += core.Pending;
  state.Poses = core.CountPoses();
  state.Video = core.CountVideo();
  std::vector<std::string> messages;
  const auto describe = [&](const DeviceThread::Health& health, const char* waiting)
  {
    if (!health.Working && health.Failures > 0)
    {
      messages.push_back(health.Trouble);
    }
    else if (!health.Working)
    {
      state.Notes.emplace_back(waiting);
    }
  };
  if (tracker.Working || core.TrackerWarning.empty()) // else the newer reason is told below
  {
    describe(tracker, "The tracker is being set up");
  }
  describe(video, "The video is being opened");
  if (video.Working && !core.VideoWarning.empty())
  {
    messages.push_back(core.VideoWarning);
  }
  for (std::string& message : core.DescribePoses())
  {
    messages.push_back(std::move(message));
  }
  state.Messages.insert(state.Messages.begin(), messages.begin(), messages.end());
  if (!state.Capturing && state.File.Verified > 0 && state.File.Verified == state.File.Synced)
  {
    state.Notes.push_back(std::to_string(state.File.Verified) +
      " slices verified: read back from '" + state.File.FileName + "', each as it was taken");
  }
  return state;
}
}
