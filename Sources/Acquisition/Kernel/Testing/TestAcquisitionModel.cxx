// SPDX-License-Identifier: BSD-3-Clause
// What must hold whatever was done to an acquisition.
#include "lacunaSequenceText.h"
#include "lacunaSweep.h"
#include "lacunaTestTrial.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <set>
#include <thread>

using namespace lacuna;

namespace
{
bool AreSame(const Matrix4& a, const Matrix4& b)
{
  return std::equal(a.Data(), a.Data() + 16, b.Data());
}
}

namespace lacunaTest
{
void Trial::Check()
{
  const bool begins = this->Slices.empty();
  for (AcquiredSlice& slice : this->Work->TakeSlices())
  {
    this->CheckSlice(slice);
    this->Slices.push_back(std::move(slice));
  }
  const AcquisitionState state = this->Work->GetState();
  if (begins && !this->Slices.empty())
  {
    this->FileName = this->Rules->RecordFileName;
    this->CompressionLevel = this->Rules->RecordCompressionLevel;
  }
  this->CheckCounts(state);
  if (!this->Limited && this->Doubtful == 0 && state.Pending == 0)
  {
    this->CheckNotTaken();
  }
  if (!this->FileName.empty() && state.File.FileName.empty() && state.File.Trouble.empty())
  {
    std::this_thread::sleep_for(std::chrono::milliseconds(5)); // the disk is slow to open it
    this->Run(1);
    this->Check();
  }
}

void Trial::CheckCounts(const AcquisitionState& state)
{
  const CaptureCounts& c = state.Counts;
  this->Limited = this->Limited || c.PastLimit > 0;
  EXPECT_TRUE(state.Capturing == this->Capturing || (this->Capturing && this->Limited));
  this->Capturing = state.Capturing;
  EXPECT_EQ(c.Slices, static_cast<std::int64_t>(this->Slices.size()));
  EXPECT_LE(c.Frames, this->Wanted + this->Doubtful);
  EXPECT_TRUE(c.Frames >= this->Wanted || this->Limited);
  std::int64_t flagged = 0; // those that every frame's mode took
  for (const AcquiredSlice& slice : this->Slices)
  {
    flagged += slice.Status & lacuna::Sweep::PoseInvalid ? 1 : 0;
  }
  const std::int64_t accounted =
    c.Slices + c.Still + c.WrongSize + c.PastLimit + state.Pending + c.WithoutPose - flagged;
  EXPECT_GE(accounted, c.Frames);
  EXPECT_LE(accounted, c.Frames + c.PastLimit); // that has some without a pose, too
  if (!this->Slices.empty())
  {
    const auto bytes = static_cast<std::int64_t>(this->Slices[0].Pixels->size());
    EXPECT_GE(state.Memory, c.Slices * bytes);
    EXPECT_LE(state.Memory, c.Slices * bytes + state.File.WaitingBytes);
    EXPECT_TRUE(this->MemoryLimit == 0 || c.Slices * bytes <= this->MemoryLimit);
    const bool recorded = !this->FileName.empty() || !this->Rules->RecordFileName.empty();
    EXPECT_EQ(state.File.Added, recorded ? c.Slices : 0);
  }
  if (const auto live = this->Work->GetLive())
  {
    const FrameTruth& frame = this->Frames[Room::ReadNumber(*live->Slice.Pixels)];
    EXPECT_EQ(live->Slice.FrameNumber, frame.Number);
    EXPECT_NEAR(live->Slice.Timestamp, frame.Instant, 1e-9);
  }
}

bool Trial::MayLackPose(const FrameTruth& frame) const
{
  const auto isLate = [&](const Outage& outage)
  { return frame.Arrival <= outage.End + 0.05 && frame.Instant > outage.Begin - 0.06; };
  const auto isWithin = [&](const Outage& outage)
  { return frame.Instant > outage.Begin - 0.03 && frame.Instant < outage.End + 0.05; };
  return std::any_of(this->Outages.begin(), this->Outages.end(),
           [&](const Outage& outage) { return isLate(outage) || isWithin(outage); }) ||
    std::any_of(this->Abandoned.begin(), this->Abandoned.end(), isLate);
}

double Trial::FindShift(double instant) const
{
  const auto after = std::find_if(this->Trackers.begin() + 1, this->Trackers.end(),
    [&](const TrackerTruth& tracker) { return tracker.Begin > instant; });
  return std::prev(after)->Shift;
}

void Trial::CheckSlice(const AcquiredSlice& slice)
{
  const int number = Room::ReadNumber(*slice.Pixels);
  const FrameTruth& frame = this->Frames[static_cast<std::size_t>(number)];
  SCOPED_TRACE("frame " + std::to_string(number));
  EXPECT_TRUE(frame.Wanted);
  EXPECT_GE(static_cast<std::size_t>(number), this->FirstFrame);
  EXPECT_EQ(slice.FrameNumber, frame.Number);
  EXPECT_NEAR(slice.Timestamp, frame.Instant, 1e-9);
  const auto window = this->GetWindow(frame);
  EXPECT_EQ(static_cast<int>(slice.Pixels->size()), window[2] * window[3]);
  EXPECT_EQ((slice.Status & lacuna::Sweep::ImageInvalid) != 0, frame.Damaged);
  EXPECT_TRUE(this->Slices.empty() || this->Slices.back().FrameNumber < slice.FrameNumber);
  if (slice.Status & lacuna::Sweep::PoseInvalid)
  {
    EXPECT_TRUE(std::isnan(slice.ProbeToTracker(0, 0)));
    EXPECT_TRUE(this->MayLackPose(frame)) << frame.Instant;
    EXPECT_TRUE(!frame.Rules || frame.Rules->Mode == CaptureMode::EveryFrame);
    return;
  }
  const Matrix4 pose = GetPose(slice.Timestamp, this->FindShift(slice.Timestamp));
  EXPECT_LE(slice.Gap, 0.25);
  EXPECT_LE(slice.Residual, 0.5 * slice.Gap + 1e-9);
  EXPECT_LE(
    Norm(slice.ProbeToTracker.Column(3) - pose.Column(3)), 350 * slice.Gap * slice.Gap / 8 + 1e-9)
    << slice.Timestamp;
  if (frame.Rules)
  {
    const double limit = frame.Rules->SpeedLimit;
    EXPECT_EQ((slice.Status & lacuna::Sweep::TooFast) != 0, limit > 0 && slice.Speed > limit);
    if (frame.Rules->Mode == CaptureMode::Movement && !this->Taken.empty())
    {
      EXPECT_GT(this->GetWay(this->Taken.rbegin()->second, slice.ProbeToTracker, frame),
        frame.Rules->MovementThreshold - 1e-9);
    }
  }
  this->Taken.emplace(number, slice.ProbeToTracker);
}

// Why each frame that is no slice is none.
void Trial::CheckNotTaken()
{
  constexpr double tolerance = 0.3; // mm, of the straight line between measurements
  std::set<std::int64_t> taken;
  for (const AcquiredSlice& slice : this->Slices)
  {
    taken.insert(slice.FrameNumber);
  }
  std::int64_t wrong = 0;
  const FrameTruth* first = nullptr;
  const Matrix4* last = nullptr;
  for (std::size_t i = this->FirstFrame; i < this->Frames.size(); ++i)
  {
    const FrameTruth& frame = this->Frames[i];
    if (const auto pose = this->Taken.find(static_cast<int>(i)); pose != this->Taken.end())
    {
      last = &pose->second;
    }
    if (!frame.Wanted || frame.Lost)
    {
      continue;
    }
    if (taken.count(frame.Number) > 0)
    {
      first = first ? first : &frame;
      EXPECT_EQ(frame.Turned, first->Turned);
    }
    else if (this->GetWindow(frame)[2] == 0 || (first && first->Turned != frame.Turned))
    {
      ++wrong;
    }
    else if (frame.Rules && !this->MayLackPose(frame))
    {
      EXPECT_EQ(frame.Rules->Mode, CaptureMode::Movement) << i;
      const Matrix4 pose = GetPose(frame.Instant, this->FindShift(frame.Instant));
      ASSERT_TRUE(last) << i;
      EXPECT_LE(this->GetWay(*last, pose, frame), frame.Rules->MovementThreshold + tolerance) << i;
    }
  }
  EXPECT_EQ(this->Work->GetState().Counts.WrongSize, wrong);
}

std::array<int, 4> Trial::GetWindow(const FrameTruth& frame) const
{
  const auto& crop = this->Scenery.Devices.Crop;
  const int columns = frame.Turned ? 3 : 4;
  const int rows = frame.Turned ? 4 : 3;
  if (crop[2] > columns || crop[3] > rows)
  {
    return {};
  }
  return { 0, 0, crop[2] > 0 ? crop[2] : columns, crop[3] > 0 ? crop[3] : rows };
}

double Trial::GetWay(const Matrix4& from, const Matrix4& to, const FrameTruth& frame) const
{
  double way = 0;
  const auto& image = frame.Rules->ImageToProbe;
  for (const Vec3& point :
    image ? GetViewCorners(*image, this->GetWindow(frame)) : GetReceiverPoints())
  {
    way = std::max(way, Norm(to.Point(point) - from.Point(point)));
  }
  return way;
}

// Has the slices, and at most so many more that nobody has asked for.
void Trial::CheckFile(const std::string& path, std::size_t mostUnseen)
{
  if (this->Slices.empty())
  {
    return;
  }
  SCOPED_TRACE(path);
  const ReadBack read(path);
  EXPECT_EQ(read.Warning, "");
  ASSERT_GE(read.Frames.size(), this->Slices.size());
  EXPECT_LE(read.Frames.size(), this->Slices.size() + mostUnseen);
  for (std::size_t i = 0; i < this->Slices.size(); ++i)
  {
    const AcquiredSlice& slice = this->Slices[i];
    ASSERT_EQ(read.Frames[i], std::string(slice.Pixels->begin(), slice.Pixels->end())) << i;
    std::map<std::string, std::string> fields;
    for (auto& [name, text] : read.GetFields(i))
    {
      fields[name] = text;
    }
    const auto readMatrix = [&](const std::string& name)
    {
      Matrix4 matrix;
      EXPECT_EQ(ParseMatrix(fields[name], matrix), "") << name;
      return matrix;
    };
    const bool valid = (slice.Status & lacuna::Sweep::PoseInvalid) == 0;
    ASSERT_EQ(fields["ProbeToTrackerTransformStatus"], valid ? "OK" : "INVALID");
    EXPECT_TRUE(!valid || AreSame(readMatrix("ProbeToTrackerTransform"), slice.ProbeToTracker));
    EXPECT_EQ(fields["FrameNumber"], std::to_string(slice.FrameNumber));
    EXPECT_EQ(fields["SliceStatus"], std::to_string(int(slice.Status)));
    EXPECT_EQ(std::stod(fields["Timestamp"]), slice.Timestamp);
    const int number = Room::ReadNumber(*slice.Pixels);
    if (const RulesPointer& rules = this->Frames[static_cast<std::size_t>(number)].Rules)
    {
      EXPECT_TRUE(AreSame(readMatrix("TrackerToReferenceTransform"), rules->TrackerToReference));
      ASSERT_EQ(fields.count("ImageToProbeTransform") > 0, rules->ImageToProbe.has_value());
      EXPECT_TRUE(
        !rules->ImageToProbe || AreSame(readMatrix("ImageToProbeTransform"), *rules->ImageToProbe));
    }
  }
}
}

using lacunaTest::Trial;

class AcquisitionModel : public testing::TestWithParam<int>
{
};

TEST_P(AcquisitionModel, WhateverIsDoneNothingIsLostOrWrong)
{
  Trial trial(GetParam());
  try
  {
    for (int i = 0; i < 60 && !HasFailure(); ++i)
    {
      trial.Step();
    }
    if (!HasFailure())
    {
      trial.End();
    }
  }
  catch (const std::exception& e)
  {
    ADD_FAILURE() << e.what();
  }
  EXPECT_FALSE(HasFailure()) << trial.Log;
}

INSTANTIATE_TEST_SUITE_P(Short, AcquisitionModel, testing::Range(0, 25));
INSTANTIATE_TEST_SUITE_P(Soak, AcquisitionModel, testing::Range(100, 2100));
