// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Makes slices of the frames of a capture.
#ifndef lacunaSweepTaking_h
#define lacunaSweepTaking_h

#include "lacunaAcquiredSlice.h"
#include "lacunaFramePairing.h"
#include "lacunaMatrix4.h"
#include "lacunaProperties.h"
#include "lacunaSweepFile.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lacuna
{
/// What is taken.
enum class CaptureMode
{
  Movement,  ///< a frame is taken when an extreme point has moved since the last one that was taken
  EveryFrame ///< every frame is
};
inline constexpr std::array<const char*, 2> CaptureModeNames{ "Movement", "EveryFrame" };

/// The corners of the field of view, mm in the receiver's coordinates: the outer corners of the
/// pixels of a window that begins at (column, row) and has a size.
std::vector<Vec3> GetViewCorners(const Matrix4& imageToProbe, const std::array<int, 4>& window);

/// What stands for them while the probe is not calibrated: the ends of axes of 100 mm through the
/// receiver's origin, both ways. They move as far as the receiver, and when it turns as an image
/// does that is so far from it.
std::vector<Vec3> GetReceiverPoints();

class CaptureRule
{
public:
  struct Verdict
  {
    bool Take = false;
    bool TooFast = false;
    std::optional<double>
      Speed; ///< mm/s of the fastest point since the frame before; may be unknown
  };

  /// threshold: mm; speedLimit: mm/s, 0: none. points are fixed to the receiver.
  CaptureRule(CaptureMode mode, double threshold, double speedLimit, std::vector<Vec3> points);

  /// Judges the next frame, by the receiver's pose at its instant. The speed is not known after a gap
  /// of half a second.
  Verdict Judge(const Matrix4& receiverToTransmitter, double instant);
  /// The frame that was judged last is taken.
  void Take() { this->LastTaken = this->Before; }
  /// The next frame is the first of a sweep.
  void BeginSweep() { this->LastTaken.reset(); }
  /// Goes on with the sweep of another rule.
  void Continue(const CaptureRule& other);

private:
  std::vector<Vec3> Place(const Matrix4& pose) const;

  CaptureMode Mode;
  double Threshold;
  double SpeedLimit;
  std::vector<Vec3> Points;
  std::optional<Matrix4> LastTaken; ///< poses of the receiver
  std::optional<Matrix4> Before;
  double BeforeInstant = 0;
};

/// What may change while an acquisition runs.
struct AcquisitionRules
{
  static constexpr ValueRange CompressionRange = ValueRange::Between(0, 9);

  CaptureMode Mode = CaptureMode::Movement;
  double MovementThreshold = 0.5; ///< mm
  double SpeedLimit = 23;         ///< mm/s (Carr 1996, ch. 2); 0: none
  double TimeOffset = 0;          ///< s, from temporal calibration; negative when the video is late
  double HoldLastPose = 0;        ///< s, see PoseTrack::SetHold; 0: off
  std::optional<Matrix4> ImageToProbe; ///< (column, row, 0, 1) of the whole frame to mm
  Matrix4 TrackerToReference;
  bool ButtonStarts = false;      ///< a press of the stylus's button starts or stops the capture
  std::int64_t MemoryLimit = 0;   ///< bytes of pixels, taken or waiting for the disk; 0: none
  std::string RecordFileName;     ///< .mhd or .nhdr; empty: none. Used from the next sweep on
  int RecordCompressionLevel = 0; ///< 0 (none) to 9

  /// Mode and the numbers before ImageToProbe, with their ranges.
  void Describe(Properties& properties) const;
};

/// Throws std::invalid_argument for rules that cannot be.
void CheckRules(const AcquisitionRules& rules);

/// The slice of a frame: its window's pixels, its pose and flags. epoch: the clock's time of Timestamp
/// 0. Its speed is not known, and its Delay 0.
AcquiredSlice MakeSlice(const PairedFrame& frame, const SweepFrame& window, double epoch);

/// What became of the frames of a sweep: Frames = Slices + Still + WrongSize + PastLimit and, by
/// movement, + WithoutPose.
struct CaptureCounts
{
  std::int64_t Frames = 0;
  std::int64_t Slices = 0;
  std::int64_t Still = 0;       ///< not taken as nothing had moved
  std::int64_t WithoutPose = 0; ///< not taken by movement; of every frame taken and flagged
  std::int64_t WrongSize = 0;   ///< another size than the sweep's, or than the crop needs
  std::int64_t PastLimit = 0;   ///< came when the memory was full
  std::int64_t TooFast = 0;     ///< taken and flagged
  std::int64_t Damaged = 0;     ///< taken and flagged
};

/// Not for more than one thread at a time.
class SweepTaking
{
public:
  /// crop: see AcquisitionDevices. epoch: the clock's time of Timestamp 0.
  SweepTaking(const std::array<int, 4>& crop, const AcquisitionRules& rules, double epoch);

  void SetRules(const AcquisitionRules& rules);
  /// See SweepAcquisition.
  void BeginSweep(bool discard);
  /// Writes what waits, if that can be, and ends the file; frames that come later are of no sweep.
  void Finish();
  /// The next frame in time, wanted or not; now: the clock's time. Adds its slice, if it becomes
  /// one.
  void Add(const PairedFrame& frame, double now, std::vector<AcquiredSlice>& slices);

  const CaptureCounts& GetCounts() const { return this->Counts; }
  /// Of the newest frame that was wanted.
  const std::optional<SweepFrame>& GetSweep() const { return this->Sweep; }
  /// The window that would be taken of a frame; nothing when the crop does not fit it.
  std::optional<SweepFrame> GetWindow(const VideoFrame& frame) const;
  /// Hands over to the file what waits for it, if that can be.
  void RetryFile();
  /// See SweepRecorder::Verify.
  void VerifyFile();
  bool IsFull() const { return this->Full; }
  /// Tries again what was full.
  void Resume();
  double GetLargestResidual() const { return this->LargestResidual; }
  std::optional<double> GetSpeed() const { return this->Speed; }
  SweepFile::State GetFile() const;
  /// Bytes of the sweep's pixels, and of those that wait for the disk; what MemoryLimit is about.
  std::int64_t GetMemory() const;
  /// How many frames before and with the newest have no pose.
  int GetFramesSincePose() const { return this->FramesSincePose; }
  /// What else is wrong with the newest frame or the sweep, and what to do.
  std::vector<std::string> GetMessages() const;

private:
  void RenewRule();
  bool Fits(const VideoFrame& frame, const SweepFrame& window);
  bool HasRoom();
  bool IsUnrecorded() const; ///< though it was to be
  void Record(const AcquiredSlice& slice, const SweepFrame& window);

  std::array<int, 4> Crop;
  AcquisitionRules Rules;
  double Epoch;
  CaptureRule Rule;
  std::array<int, 4> RuleWindow{ 0, 0, 0, 0 }; ///< whose corners Rule watches
  CaptureCounts Counts;
  std::optional<SweepFrame> Sweep;
  std::array<int, 2> FrameSize{ 0, 0 }; ///< of the sweep's whole frames
  std::int64_t SliceBytes = 0;
  double LargestResidual = 0;
  std::optional<double> Speed;
  std::unique_ptr<SweepFile> File;
  bool Finished = false;
  bool Full = false;
  bool OutOfMemory = false;   ///< why it is
  std::string SizeTrouble;    ///< of the newest frame
  std::string SpacingTrouble; ///< the same
  int FramesSincePose = 0;
  bool ImageDamaged = false;
};
}
#endif
