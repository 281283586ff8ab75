// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Anything is done to an acquisition in any order, and a simple model says what must hold after it.
#ifndef lacunaTestTrial_h
#define lacunaTestTrial_h

#include "FileSizeLimit.h"
#include "WrittenSequence.h"
#include "lacunaDice.h"
#include "lacunaTestScene.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lacunaTest
{
constexpr double Never = std::numeric_limits<double>::infinity();
using RulesPointer = std::shared_ptr<const lacuna::AcquisitionRules>;

enum class Fault
{
  None,
  Silent,
  Unusable,
  Unplugged
};

struct FrameTruth
{
  std::int64_t Number = 0; // of those that came
  double Arrival = 0;
  double Instant = 0;
  bool Damaged = false;
  bool Turned = false; // 3 x 4 pixels, not 4 x 3
  bool Lost = false;   // the video failed in its place
  bool Wanted = false;
  bool Doubtful = false; // the button's moment decided whether it was
  RulesPointer Rules;    // null: it waited while they changed
};

struct TrackerTruth
{
  double Begin;
  double Shift; // mm
};

struct Outage
{
  double Begin;
  double End;
};

inline lacuna::Matrix4 GetPose(double time, double shift)
{
  return lacuna::Matrix4::Translation({ shift, 0, 0 }) * Sweep(time, 1);
}

/// One acquisition; the seed says what happens.
class Trial
{
public:
  explicit Trial(int seed)
    : Random(static_cast<std::uint64_t>(seed))
    , Scenery(EveryFrame(),
        [this](int number, lacuna::VideoFrame& frame) { return this->Film(number, frame); })
  {
    this->Scenery.Devices.Poses = this->MakeTracker(0);
    this->Scenery.Devices.ReopenEndedVideo = true;
    this->Scenery.Devices.RetryTime = 1e-5;
    this->Scenery.Devices.Crop =
      this->Random.Pick<std::array<int, 4>>({ { 0, 0, 0, 0 }, { 0, 0, 3, 0 }, { 0, 0, 4, 3 } });
    this->Scenery.Rules.Mode =
      this->Random.Pick({ lacuna::CaptureMode::Movement, lacuna::CaptureMode::EveryFrame });
    this->Rules = std::make_shared<lacuna::AcquisitionRules>(this->Scenery.Rules);
    this->Work = &this->Scenery.Open();
  }

  void Step();
  void End();
  std::string Log;

private:
  // What the devices do; called by their threads while Run waits.
  lacuna::VideoEvent Film(int number, lacuna::VideoFrame& frame) const;
  lacuna::PoseDeviceFactory MakeTracker(double shift);

  // What may happen.
  void Run(int frames, std::optional<bool> wanted = {});
  void StartOrStop();
  void ChangeRules();
  void ChangeFault();
  void ReplaceTracker();
  void ReplaceVideo();
  void PressButton();
  void ChangeDisk();
  void BeginSweep();
  std::string FindNewestFile() const;
  void WhileTimeGoesOn(const std::function<void()>& end);

  // What must hold.
  void Check();
  void CheckCounts(const lacuna::AcquisitionState& state);
  void CheckSlice(const lacuna::AcquiredSlice& slice);
  void CheckNotTaken();
  void CheckFile(const std::string& path, std::size_t mostUnseen);
  bool MayLackPose(const FrameTruth& frame) const;
  double FindShift(double instant) const;
  std::array<int, 4> GetWindow(const FrameTruth& frame) const;
  double GetWay(
    const lacuna::Matrix4& from, const lacuna::Matrix4& to, const FrameTruth& frame) const;

  lacunaProperties::Dice Random;
  TemporaryFolder Folder;
  std::optional<FileSizeLimit> FullDisk;
  bool FolderIsThere = false;

  std::deque<FrameTruth> Frames; // by the room's number
  std::vector<TrackerTruth> Trackers{ { 0, 0 } };
  std::vector<Outage> Outages{ { -Never, 0.03 } };
  std::vector<Outage> Abandoned; // when those that waited went without a pose
  std::atomic<Fault> Trouble{ Fault::None };
  std::atomic<bool> Pressed{ false };
  std::int64_t NextNumber = 0;
  bool Turned = false;
  double Latency = 0;

  RulesPointer Rules;
  bool Capturing = false;
  // of the sweep
  std::size_t FirstFrame = 0;
  std::int64_t Wanted = 0;
  std::int64_t Doubtful = 0; // frames of which the button's moment decides
  bool Limited = false;      // so does the memory's
  std::int64_t MemoryLimit = 0;
  std::vector<lacuna::AcquiredSlice> Slices;
  std::map<int, lacuna::Matrix4> Taken; // poses by the room's number
  std::string FileName;                 // by which it was to be recorded
  int CompressionLevel = 0;

  Scene Scenery;
  lacuna::SweepAcquisition* Work = nullptr;
};
}
#endif
