// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSweepTaking.h"

#include "lacunaGeometryGate.h"
#include "lacunaOutputFile.h"
#include "lacunaPixelSpacing.h"
#include "lacunaSweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace lacuna
{
namespace
{
constexpr double ArmLength = 100;  // mm
constexpr double LongestGap = 0.5; // s

double LargestDistance(const std::vector<Vec3>& a, const std::vector<Vec3>& b)
{
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    largest = std::max(largest, Norm(a[i] - b[i]));
  }
  return largest;
}
}

std::vector<Vec3> GetViewCorners(const Matrix4& imageToProbe, const std::array<int, 4>& window)
{
  std::vector<Vec3> corners;
  for (const int right : { 0, 1 })
  {
    for (const int bottom : { 0, 1 })
    {
      corners.push_back(imageToProbe.Point(
        { window[0] - 0.5 + right * window[2], window[1] - 0.5 + bottom * window[3], 0 }));
    }
  }
  return corners;
}

std::vector<Vec3> GetReceiverPoints()
{
  std::vector<Vec3> points;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    for (const double length : { -ArmLength, ArmLength })
    {
      Vec3 point{ 0, 0, 0 };
      point[axis] = length;
      points.push_back(point);
    }
  }
  return points;
}

CaptureRule::CaptureRule(
  CaptureMode mode, double threshold, double speedLimit, std::vector<Vec3> points)
  : Mode(mode)
  , Threshold(threshold)
  , SpeedLimit(speedLimit)
  , Points(std::move(points))
{
}

std::vector<Vec3> CaptureRule::Place(const Matrix4& pose) const
{
  std::vector<Vec3> places;
  places.reserve(this->Points.size());
  for (const Vec3& point : this->Points)
  {
    places.push_back(pose.Point(point));
  }
  return places;
}

CaptureRule::Verdict CaptureRule::Judge(const Matrix4& receiverToTransmitter, double instant)
{
  const std::vector<Vec3> places = this->Place(receiverToTransmitter);
  Verdict verdict;
  const double gap = instant - this->BeforeInstant;
  if (this->Before && gap > 0 && gap <= LongestGap)
  {
    verdict.Speed = LargestDistance(places, this->Place(*this->Before)) / gap;
    verdict.TooFast = this->SpeedLimit > 0 && *verdict.Speed > this->SpeedLimit;
  }
  verdict.Take = this->Mode == CaptureMode::EveryFrame || !this->LastTaken ||
    LargestDistance(places, this->Place(*this->LastTaken)) > this->Threshold;
  this->Before = receiverToTransmitter;
  this->BeforeInstant = instant;
  return verdict;
}

void CaptureRule::Continue(const CaptureRule& other)
{
  this->LastTaken = other.LastTaken;
  this->Before = other.Before;
  this->BeforeInstant = other.BeforeInstant;
}

//------------------------------------------------------------------------------
namespace
{
constexpr double NaN = std::numeric_limits<double>::quiet_NaN();

std::string SizeText(int columns, int rows)
{
  return std::to_string(columns) + " x " + std::to_string(rows);
}

std::string SpeedText(double speed)
{
  constexpr double most = 1e9; // any pose's speed is written
  if (speed < 10)
  {
    std::ostringstream text;
    text << std::setprecision(2) << speed;
    return text.str();
  }
  return std::to_string(std::lround(std::fmin(speed, most)));
}

// Whether the video says of its pixels what the calibration does.
std::string CompareSpacings(const VideoFrame& frame, const std::optional<Matrix4>& imageToProbe)
{
  if (!frame.PixelSpacing || !imageToProbe)
  {
    return {};
  }
  const Vec2& said = *frame.PixelSpacing;
  const Vec2 known = GetPixelSpacing(*imageToProbe);
  if (!IsPixelSpacing(said))
  {
    return "The video says that its pixels are " + FormatPixelSpacing(said) +
      ", which cannot be, so that nothing tells whether its depth is that of the calibration: "
      "mend what sends it, and compare the depth on the scanner's screen";
  }
  if (IsSameSpacing(said, known))
  {
    return {};
  }
  return "The video says that its pixels are " + FormatPixelSpacing(said) +
    ", the calibration that they are " + FormatPixelSpacing(known) +
    ": such slices are flagged as pose invalid. Set the scanner to the depth of the calibration, "
    "or "
    "take that of this depth";
}

CaptureRule MakeRule(const AcquisitionRules& rules, const std::array<int, 4>& window)
{
  return CaptureRule(rules.Mode, rules.MovementThreshold, rules.SpeedLimit,
    rules.ImageToProbe ? GetViewCorners(*rules.ImageToProbe, window) : GetReceiverPoints());
}
}

void AcquisitionRules::Describe(Properties& properties) const
{
  constexpr double largest = 1; // a video that is later than that is no live image
  properties.Add("TimeOffset", this->TimeOffset, ValueRange::Between(-largest, largest, "s"))
    .Add("HoldLastPose", this->HoldLastPose, ValueRange::Above(0, "s").OrZero("not held"))
    .Add("CaptureMode", static_cast<int>(this->Mode), CaptureModeNames)
    .Add("MovementThreshold", this->MovementThreshold, ValueRange::AtLeast(0, "mm"))
    .Add("SpeedLimit", this->SpeedLimit, ValueRange::Above(0, "mm/s").OrZero("no limit"));
}

void CheckRules(const AcquisitionRules& rules)
{
  const auto require = [](bool right, const char* text)
  {
    if (!right)
    {
      throw std::invalid_argument(text);
    }
  };
  Properties properties;
  rules.Describe(properties);
  properties
    .Add("RecordCompression", rules.RecordCompressionLevel, AcquisitionRules::CompressionRange)
    .Check();
  require(rules.MemoryLimit >= 0, "MemoryLimit is a size, or 0 for none");
  const auto isAffine = [](const Matrix4& matrix)
  { return matrix.IsFinite() && matrix.IsAffine(); };
  require(!rules.ImageToProbe || isAffine(*rules.ImageToProbe),
    "ImageToProbe must be an affine matrix of finite numbers");
  require(isAffine(rules.TrackerToReference),
    "TrackerToReference must be an affine matrix of finite numbers");
  if (!rules.RecordFileName.empty())
  {
    SweepFile(rules.RecordFileName, rules.RecordCompressionLevel);
  }
}

AcquiredSlice MakeSlice(const PairedFrame& frame, const SweepFrame& window, double epoch)
{
  const VideoFrame& video = *frame.Frame;
  const auto [column, row, columns, rows] = window.Window;
  auto pixels = std::make_shared<std::vector<std::uint8_t>>();
  pixels->reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (int i = row; i < row + rows; ++i)
  {
    const auto line =
      video.Grey.begin() + static_cast<std::ptrdiff_t>(std::int64_t{ i } * video.Columns + column);
    pixels->insert(pixels->end(), line, line + columns);
  }
  AcquiredSlice slice;
  slice.Pixels = std::move(pixels);
  slice.FrameNumber = frame.Number;
  slice.Timestamp = frame.Instant - epoch;
  slice.ProbeToTracker = frame.Pose ? frame.Pose->ReceiverToTransmitter : NoPose();
  slice.Status = static_cast<unsigned char>(
    (frame.Pose ? 0 : Sweep::PoseInvalid) | (video.Damaged ? Sweep::ImageInvalid : 0));
  slice.PixelSpacing = video.PixelSpacing;
  slice.Residual = frame.Pose ? frame.Pose->Nearest : NaN;
  slice.Gap = frame.Pose ? frame.Pose->Gap : NaN;
  slice.Held = frame.Pose && frame.Pose->Held;
  slice.Speed = NaN;
  return slice;
}

SweepTaking::SweepTaking(
  const std::array<int, 4>& crop, const AcquisitionRules& rules, double epoch)
  : Crop(crop)
  , Rules(rules)
  , Epoch(epoch)
  , Rule(MakeRule(rules, crop))
{
  if (*std::min_element(crop.begin(), crop.end()) < 0)
  {
    throw std::invalid_argument(
      "The crop is first column, first row, columns and rows, none of them "
      "negative");
  }
}

void SweepTaking::SetRules(const AcquisitionRules& rules)
{
  this->Rules = rules;
  this->RenewRule();
  if (this->File && !rules.RecordFileName.empty())
  {
    this->File->Rename(rules.RecordFileName, rules.RecordCompressionLevel);
    this->File->Retry();
  }
  this->Resume();
}

void SweepTaking::RetryFile()
{
  if (this->File)
  {
    this->File->Retry();
  }
}

void SweepTaking::VerifyFile()
{
  if (this->File)
  {
    this->File->Verify();
  }
}

void SweepTaking::Resume()
{
  this->Full = false; // unless the next slice finds it so
  this->OutOfMemory = false;
}

void SweepTaking::RenewRule()
{
  CaptureRule rule = MakeRule(this->Rules, this->RuleWindow);
  rule.Continue(this->Rule);
  this->Rule = std::move(rule);
}

void SweepTaking::Finish()
{
  this->Finished = true;
  try
  {
    if (this->File)
    {
      this->File->Finish();
    }
  }
  catch (const FileError&) // the file's state has it
  {
  }
}

void SweepTaking::BeginSweep(bool discard)
{
  try
  {
    if (this->File)
    {
      this->File->Finish(); // it may be possible by now
    }
  }
  catch (const FileError&)
  {
    const SweepFile::State state = this->File->GetState();
    if (!discard && state.Synced < state.Added) // all else can be read
    {
      throw;
    }
  }
  if (this->IsUnrecorded() && !discard)
  {
    throw FileError(FileError::Kind::Other, this->GetFile().Trouble);
  }
  this->File.reset();
  this->Counts = {};
  this->Sweep.reset();
  this->LargestResidual = 0;
  this->Resume();
  this->Rule.BeginSweep();
}

std::optional<SweepFrame> SweepTaking::GetWindow(const VideoFrame& frame) const
{
  SweepFrame window;
  window.Window = this->Crop;
  auto& [column, row, columns, rows] = window.Window;
  columns = columns > 0 ? columns : frame.Columns - column;
  rows = rows > 0 ? rows : frame.Rows - row;
  if (columns <= 0 || rows <= 0 || columns > frame.Columns - column || rows > frame.Rows - row)
  {
    return std::nullopt;
  }
  window.Calibrated = this->Rules.ImageToProbe.has_value();
  window.ImageToProbe = this->Rules.ImageToProbe.value_or(Matrix4());
  window.TrackerToReference = this->Rules.TrackerToReference;
  return window;
}

bool SweepTaking::Fits(const VideoFrame& frame, const SweepFrame& window)
{
  if (this->Counts.Slices > 0 &&
    (this->FrameSize[0] != frame.Columns || this->FrameSize[1] != frame.Rows))
  {
    this->SizeTrouble = "The video is now " + SizeText(frame.Columns, frame.Rows) +
      " pixels and was " + SizeText(this->FrameSize[0], this->FrameSize[1]) +
      " when the sweep began: its frames are left out. Set the scanner back, or begin a new sweep";
    return false;
  }
  this->FrameSize = { frame.Columns, frame.Rows };
  this->SliceBytes = std::int64_t{ window.Window[2] } * window.Window[3];
  this->Sweep = window;
  return true;
}

bool SweepTaking::HasRoom()
{
  this->Full =
    this->Rules.MemoryLimit > 0 && this->GetMemory() + this->SliceBytes > this->Rules.MemoryLimit;
  return !this->Full;
}

void SweepTaking::Record(const AcquiredSlice& slice, const SweepFrame& window)
{
  if (!this->File && this->Counts.Slices == 0 && !this->Rules.RecordFileName.empty())
  {
    this->File =
      std::make_unique<SweepFile>(this->Rules.RecordFileName, this->Rules.RecordCompressionLevel);
  }
  if (this->File)
  {
    this->File->Add(slice, window);
  }
}

void SweepTaking::Add(const PairedFrame& frame, double now, std::vector<AcquiredSlice>& slices)
{
  if (this->Finished)
  {
    return;
  }
  this->RetryFile();
  this->SizeTrouble.clear();
  this->SpacingTrouble = CompareSpacings(*frame.Frame, this->Rules.ImageToProbe);
  this->FramesSincePose = frame.Pose ? 0 : this->FramesSincePose + 1;
  this->ImageDamaged = frame.Frame->Damaged;
  this->Counts.Frames += frame.Wanted ? 1 : 0;
  const std::optional<SweepFrame> window = this->GetWindow(*frame.Frame);
  if (!window)
  {
    this->SizeTrouble = "The crop does not fit the video's " +
      SizeText(frame.Frame->Columns, frame.Frame->Rows) + " pixels: no frame is taken";
    this->Counts.WrongSize += frame.Wanted ? 1 : 0;
    return;
  }
  if (this->RuleWindow != window->Window)
  {
    this->RuleWindow = window->Window;
    this->RenewRule();
  }
  CaptureRule::Verdict verdict;
  verdict.Take = this->Rules.Mode == CaptureMode::EveryFrame;
  if (frame.Pose)
  {
    verdict = this->Rule.Judge(frame.Pose->ReceiverToTransmitter, frame.Instant);
  }
  this->Speed = verdict.Speed;
  if (!frame.Wanted)
  {
    return;
  }
  if (!this->Fits(*frame.Frame, *window))
  {
    ++this->Counts.WrongSize;
    return;
  }
  this->Counts.WithoutPose += frame.Pose ? 0 : 1;
  if (!verdict.Take)
  {
    this->Counts.Still += frame.Pose ? 1 : 0;
    return;
  }
  if (!this->HasRoom())
  {
    ++this->Counts.PastLimit;
    return;
  }
  const std::size_t before = slices.size();
  try
  {
    slices.push_back(MakeSlice(frame, *window, this->Epoch));
    AcquiredSlice& slice = slices.back();
    slice.Speed = verdict.Speed.value_or(NaN);
    slice.Status |= verdict.TooFast ? Sweep::TooFast : 0;
    slice.Delay = now - frame.Frame->Arrival;
    this->Record(slice, *window);
  }
  catch (const std::bad_alloc&) // MemoryLimit was set too high
  {
    slices.resize(before); // as the recording, which has not taken it either
    this->Full = true;
    this->OutOfMemory = true;
    ++this->Counts.PastLimit;
    return;
  }
  if (frame.Pose)
  {
    this->Rule.Take();
  }
  ++this->Counts.Slices;
  this->Counts.TooFast += verdict.TooFast ? 1 : 0;
  this->Counts.Damaged += frame.Frame->Damaged ? 1 : 0;
  this->LargestResidual = std::fmax(this->LargestResidual, slices.back().Residual);
}

bool SweepTaking::IsUnrecorded() const
{
  return !this->File && this->Counts.Slices > 0 && !this->Rules.RecordFileName.empty();
}

SweepFile::State SweepTaking::GetFile() const
{
  SweepFile::State state = this->File ? this->File->GetState() : SweepFile::State();
  if (this->IsUnrecorded())
  {
    state.Added = this->Counts.Slices;
    state.Trouble =
      "This sweep is not recorded: it had begun when RecordFileName was set, which is "
      "for the next one. Save its slices and begin a new sweep";
  }
  return state;
}

std::int64_t SweepTaking::GetMemory() const
{
  return this->Counts.Slices * this->SliceBytes + this->GetFile().WaitingBytes;
}

std::vector<std::string> SweepTaking::GetMessages() const
{
  std::vector<std::string> messages;
  if (this->Full)
  {
    const std::string kept = "; all " + std::to_string(this->Counts.Slices) + " slices are kept. ";
    messages.push_back(this->OutOfMemory
        ? "The capture has ended, there is no memory for more" + kept +
          "Close what needs memory and start again, or save them and begin a new sweep; and set a "
          "lower MemoryLimit"
        : "The capture has ended at MemoryLimit" + kept +
          "Save them and begin a new sweep, or set a higher limit and start again");
  }
  if (!this->SizeTrouble.empty())
  {
    messages.push_back(this->SizeTrouble);
  }
  if (!this->SpacingTrouble.empty())
  {
    messages.push_back(this->SpacingTrouble);
  }
  if (this->Speed && this->Rules.SpeedLimit > 0 && *this->Speed > this->Rules.SpeedLimit)
  {
    messages.push_back("Too fast: the image moves at " + SpeedText(*this->Speed) +
      " mm/s, more than SpeedLimit (" + SpeedText(this->Rules.SpeedLimit) +
      "): such slices are flagged");
  }
  if (this->ImageDamaged)
  {
    messages.push_back("The video comes damaged: look at its cable or network; such slices are "
                       "flagged");
  }
  const SweepFile::State file = this->GetFile();
  for (const std::string& message : { file.Trouble, file.Notice })
  {
    if (!message.empty())
    {
      messages.push_back(message);
    }
  }
  return messages;
}
}
