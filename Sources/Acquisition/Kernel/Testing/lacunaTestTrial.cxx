// SPDX-License-Identifier: BSD-3-Clause
// What happens to an acquisition.
#include "lacunaTestTrial.h"

#include "lacunaOutputFile.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <future>
#include <thread>

using namespace lacuna;

namespace lacunaTest
{
VideoEvent Trial::Film(int number, VideoFrame& frame) const
{
  const FrameTruth& truth = this->Frames[static_cast<std::size_t>(number)];
  if (truth.Lost)
  {
    return VideoEvent::End;
  }
  Room::NumberedFrame(number, frame);
  frame.Damaged = truth.Damaged;
  if (truth.Turned)
  {
    std::swap(frame.Columns, frame.Rows);
  }
  return VideoEvent::Frame;
}

PoseDeviceFactory Trial::MakeTracker(double shift)
{
  return this->Scenery.Place.MakeTracker(
    [this, shift](double time, std::vector<TrackedPose>& poses)
    {
      const Fault fault = this->Trouble;
      if (fault == Fault::Unplugged)
      {
        throw std::runtime_error("gone");
      }
      if (fault == Fault::Silent)
      {
        return;
      }
      TrackedPose pose = Room::MakePose(time);
      pose.ReceiverToTransmitter = GetPose(time, shift);
      pose.Usable = fault != Fault::Unusable;
      pose.Button = this->Pressed;
      poses.push_back(pose);
    });
}

void Trial::Run(int frames, std::optional<bool> wanted)
{
  for (int i = 0; i < frames; ++i)
  {
    FrameTruth frame;
    frame.Lost = this->Random.Chance(0.01);
    frame.Number = frame.Lost ? this->NextNumber : this->NextNumber++;
    frame.Arrival = Room::FrameTime(static_cast<int>(this->Frames.size()));
    frame.Instant = frame.Arrival - this->Latency + this->Rules->TimeOffset;
    frame.Damaged = this->Random.Chance(0.03);
    frame.Turned = this->Turned;
    frame.Wanted = wanted.value_or(this->Capturing);
    frame.Rules = this->Rules;
    this->Wanted += frame.Wanted && !frame.Lost ? 1 : 0;
    this->Frames.push_back(frame);
  }
  this->Scenery.Place.RunTo(static_cast<int>(this->Frames.size()));
}

// Frames get poses later than their instants only when time goes on; when it does not, a second of
// real time is waited for them.
void Trial::WhileTimeGoesOn(const std::function<void()>& end)
{
  const bool waits = this->Work->GetState().Pending > 0 && this->Random.Chance(0.97);
  auto ended = std::async(std::launch::async, end);
  this->Capturing = false;
  while (this->Work->GetState().Capturing)
  {
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  if (waits)
  {
    this->Run(30);
  }
  ended.get();
}

void Trial::StartOrStop()
{
  this->Log += this->Capturing ? " stop" : " start";
  if (this->Capturing)
  {
    this->WhileTimeGoesOn([this] { this->Work->Stop(); });
  }
  else
  {
    this->Work->Start();
    this->Capturing = true;
  }
}

void Trial::ChangeRules()
{
  auto& dice = this->Random;
  AcquisitionRules rules = *this->Rules;
  const int which = dice.Whole(0, 10);
  this->Log += " rule" + std::to_string(which);
  switch (which)
  {
    case 0:
      rules.TimeOffset = dice.Pick({ 0.0, 1.0, -1.0, dice.Real(-0.1, 0.1), dice.Real(-0.4, 0.4) });
      break;
    case 1:
      rules.MemoryLimit = dice.Pick({ 0, 12 * 30, 12 * 100 });
      break;
    case 2:
      rules.Mode = dice.Pick({ CaptureMode::Movement, CaptureMode::EveryFrame });
      break;
    case 3:
      rules.MovementThreshold = dice.Pick({ 0.0, 0.5, 8.0 });
      break;
    case 4:
      rules.SpeedLimit = dice.Pick({ 0, 60, 120 });
      break;
    case 5:
      rules.ImageToProbe.reset();
      if (dice.Chance(0.8))
      {
        rules.ImageToProbe =
          Matrix4::Translation({ dice.Real(-50, 50), 3, 9 }) * Matrix4::Scaling({ 2, 3, 1 });
      }
      break;
    case 6:
      rules.TrackerToReference = Matrix4::Translation({ dice.Real(-50, 50), 1, 2 });
      break;
    case 7:
    case 8:
      rules.RecordFileName = dice.Pick<std::string>(
        { "", this->Folder / "a.mhd", this->Folder / "b.nhdr", this->Folder / "folder/c.mhd" });
      rules.RecordCompressionLevel = dice.Pick({ 0, 0, 1 });
      break;
    case 9:
      rules.ButtonStarts = !rules.ButtonStarts;
      break;
    default:
      rules.TimeOffset = 2; // cannot be: all stays as it is
      rules.RecordFileName = this->Folder / "other.mhd";
      EXPECT_THROW(this->Work->SetRules(rules), std::invalid_argument);
      return;
  }
  std::int64_t waiting = this->Work->GetState().Pending;
  for (auto frame = this->Frames.rbegin(); waiting > 0 && frame != this->Frames.rend(); ++frame)
  {
    frame->Rules.reset();
    waiting -= frame->Wanted && !frame->Doubtful && !frame->Lost ? 1 : 0;
  }
  this->Work->SetRules(rules);
  if (!this->FileName.empty() && !rules.RecordFileName.empty() &&
    rules.RecordFileName != this->FileName && this->Work->GetState().File.FileName.empty())
  {
    this->FileName = rules.RecordFileName;
    this->CompressionLevel = rules.RecordCompressionLevel;
  }
  this->MemoryLimit = rules.MemoryLimit == 0 || this->MemoryLimit == 0
    ? 0
    : std::max(this->MemoryLimit, rules.MemoryLimit);
  this->Rules = std::make_shared<AcquisitionRules>(rules);
}

void Trial::ChangeFault()
{
  const bool ends = this->Trouble != Fault::None;
  const Fault fault =
    ends ? Fault::None : this->Random.Pick({ Fault::Silent, Fault::Unusable, Fault::Unplugged });
  this->Log += " fault" + std::to_string(static_cast<int>(fault));
  const double now = this->Scenery.Place.Now();
  if (ends)
  {
    this->Outages.back().End = now;
  }
  else
  {
    this->Outages.push_back({ now, Never });
  }
  this->Trouble = fault;
}

void Trial::ReplaceTracker()
{
  this->Log += " tracker";
  const double now = this->Scenery.Place.Now();
  this->Trackers.push_back({ now, this->Random.Pick({ 0.0, 500.0, -300.0 }) });
  this->Abandoned.push_back({ now, now });
  this->Outages.insert(this->Outages.begin(), { now, now });
  AcquisitionDevices devices = this->Scenery.Devices;
  devices.Poses = this->MakeTracker(this->Trackers.back().Shift);
  this->Work->ReplaceTracker(devices);
  this->Run(0);
}

void Trial::ReplaceVideo()
{
  this->Log += " video";
  this->Latency = this->Random.Pick({ 0.0, 0.055, 0.2 });
  AcquisitionDevices devices = this->Scenery.Devices;
  devices.VideoLatency = this->Latency;
  this->Work->ReplaceVideo(devices);
}

void Trial::PressButton()
{
  if (this->Trouble == Fault::Silent || this->Trouble == Fault::Unplugged)
  {
    return;
  }
  this->Log += " press";
  const bool heeded = this->Rules->ButtonStarts;
  const std::int64_t full = this->Work->GetState().Counts.PastLimit;
  this->Pressed = true;
  const std::int64_t wanted = this->Wanted;
  this->Run(3, heeded || this->Capturing);
  this->Pressed = false;
  if (heeded)
  {
    std::for_each(
      this->Frames.end() - 3, this->Frames.end(), [](FrameTruth& frame) { frame.Doubtful = true; });
    this->Doubtful += this->Wanted - wanted;
    this->Wanted = wanted;
    const AcquisitionState state = this->Work->GetState();
    EXPECT_TRUE(state.Capturing != this->Capturing || state.Counts.PastLimit > full);
    this->Capturing = state.Capturing;
  }
  this->Run(3);
}

void Trial::ChangeDisk()
{
  if (this->Random.Chance(0.3))
  {
    this->Log += " folder";
    this->FolderIsThere = true;
    std::filesystem::create_directory(this->Folder / "folder");
  }
  else if (this->FullDisk)
  {
    this->Log += " room";
    this->FullDisk.reset();
  }
  else
  {
    this->Log += " full";
    this->FullDisk.emplace(static_cast<rlim_t>(this->Random.Whole(0, 30000)));
  }
}

// Of the names that recordings have, the last for which there is a file.
std::string Trial::FindNewestFile() const
{
  const std::filesystem::path name(this->FileName);
  std::string newest = this->FileName;
  for (int i = 2;; ++i)
  {
    const std::filesystem::path next = name.parent_path() /
      (name.stem().string() + "-" + std::to_string(i) + name.extension().string());
    if (!std::filesystem::exists(next))
    {
      return newest;
    }
    newest = next.string();
  }
}

void Trial::BeginSweep()
{
  if (this->Random.Chance(0.7) && this->Capturing)
  {
    this->StartOrStop();
    this->Check();
  }
  const bool discard = this->Random.Chance(0.2);
  this->Log += discard ? " discard" : " begin";
  const AcquisitionState state = this->Work->GetState();
  const bool open = !state.File.FileName.empty();
  const bool hasPlace = !this->FullDisk &&
    (open || this->FolderIsThere || this->FileName != this->Folder / "folder/c.mhd");
  const bool late =
    this->FileName.empty() && !this->Slices.empty() && !this->Rules->RecordFileName.empty();
  const double now = this->Scenery.Place.Now();
  bool begun = true;
  try
  {
    this->WhileTimeGoesOn([&] { this->Work->BeginSweep(discard); });
  }
  catch (const FileError&)
  {
    begun = false;
  }
  this->Abandoned.push_back({ now, this->Scenery.Place.Now() });
  EXPECT_TRUE(begun || !discard);
  EXPECT_TRUE(!begun || discard || !late);
  EXPECT_TRUE(begun || late || !hasPlace || this->Slices.empty());
  if (!begun)
  {
    this->Log += "(refused)";
    return;
  }
  if (!this->FileName.empty() && !discard)
  {
    this->CheckFile(
      open ? state.File.FileName : this->FindNewestFile(), static_cast<std::size_t>(state.Pending));
  }
  this->FirstFrame = this->Frames.size();
  this->Wanted = this->Doubtful = 0;
  this->Limited = false;
  this->MemoryLimit = this->Rules->MemoryLimit;
  this->Slices.clear();
  this->Taken.clear();
  this->FileName.clear();
  EXPECT_EQ(this->Work->GetState().Memory, 0);
  EXPECT_EQ(this->Work->GetState().Pending, 0);
}

void Trial::Step()
{
  const int what = this->Random.Whole(0, 99);
  if (what < 30)
  {
    const int frames = this->Random.Whole(1, 40);
    this->Log += " run" + std::to_string(frames);
    this->Run(frames);
  }
  else if (what < 50)
  {
    this->StartOrStop();
  }
  else if (what < 68)
  {
    this->ChangeRules();
  }
  else if (what < 73)
  {
    this->ChangeFault();
  }
  else if (what < 76)
  {
    this->ReplaceTracker();
  }
  else if (what < 80)
  {
    this->ReplaceVideo();
  }
  else if (what < 84)
  {
    this->Log += " turn";
    this->Turned = !this->Turned;
  }
  else if (what < 90)
  {
    this->PressButton();
  }
  else if (what < 94)
  {
    this->ChangeDisk();
  }
  else
  {
    this->BeginSweep();
  }
  this->Check();
}

void Trial::End()
{
  this->Log += " end";
  this->FullDisk.reset();
  std::filesystem::create_directory(this->Folder / "folder");
  if (this->Capturing)
  {
    this->StartOrStop();
  }
  const double now = this->Scenery.Place.Now();
  this->Abandoned.push_back({ now, now });
  const AcquisitionState state = this->Work->Finish();
  this->Check();
  EXPECT_EQ(state.Pending, 0);
  if (!this->FileName.empty())
  {
    EXPECT_EQ(state.File.Synced, state.Counts.Slices);
    this->CheckFile(state.File.FileName, 0);
  }
  this->Work->Start();
  this->Run(5, false);
  EXPECT_TRUE(this->Work->TakeSlices().empty());
  EXPECT_EQ(this->Work->GetState().Counts.Frames, state.Counts.Frames);
}
}
