// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSweepAcquisition.h"

#include "lacunaSweepAcquisitionCore.h"

#include <algorithm>
#include <chrono>
#include <mutex>
#include <utility>

namespace lacuna
{
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
