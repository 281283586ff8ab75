// SPDX-License-Identifier: BSD-3-Clause
// An acquisition with the protocol of the FASTRAK, in simulated time.
#include "lacunaSweep.h"
#include "lacunaTestScene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <iostream>
#include <thread>

using namespace lacuna;
using namespace lacunaTest;

// What the FASTRAK itself makes known, through its protocol.
TEST(AcquisitionTracker, SaysWhatIsWrongWithTheTracker)
{
  struct Case
  {
    const char* Words;
    std::function<void(FastrakEmulatorOptions&, FastrakSettings&)> Spoil;
  };
  const std::vector<Case> cases{
    { "does not answer at 19200 baud", [](auto& options, auto&) { options.Faults.Silent = true; } },
    { "the baud rate is wrong", [](auto& options, auto&) { options.Faults.Garbage = true; } },
    { "plugged into station 2", [](auto&, auto& settings) { settings.Stations = { 2 }; } },
    { "answers for station 1 and not as asked for 2",
      [](auto& options, auto& settings)
      {
        options.Faults.Ignored = "l";
        settings.Stations = { 2 };
      } },
    { "did not understand the command 'H1",
      [](auto& options, auto&) { options.Faults.Refused = "H"; } },
    { "weak", [](auto& options, auto&) { options.Faults.Error = 'k'; } },
    { "each once",
      [](auto&, auto& settings) {
        settings.Stations = { 2, 1 };
      } } // cannot be
  };
  for (const Case& test : cases)
  {
    FastrakEmulatorOptions options;
    FastrakSettings settings;
    test.Spoil(options, settings);
    FastrakEmulator emulator(lacunaTest::Sweep, options);
    Scene scene(EveryFrame());
    scene.Devices.Poses = scene.Place.MakeFastrak(emulator, settings);
    scene.Devices.Station = settings.Stations.front();
    SweepAcquisition& acquisition = scene.Open();
    scene.Place.Run();
    acquisition.Start();
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    bool said = false;
    while (!said && std::chrono::steady_clock::now() < end)
    {
      said = HasMessage(acquisition.GetState(), test.Words);
      std::this_thread::sleep_for(
        std::chrono::milliseconds(1)); // the threads shall have their turn
    }
    EXPECT_TRUE(said) << test.Words << "\n"
                      << testing::PrintToString(acquisition.GetState().Messages);
    acquisition.Stop();
    for (const AcquiredSlice& slice : acquisition.TakeSlices())
    {
      EXPECT_EQ(slice.Status, lacuna::Sweep::PoseInvalid); // not one with a pose that is none
    }
  }
}

// The signs that the unit gives there are wrong.
TEST(AcquisitionTracker, AReceiverInTheOtherHalfOfSpaceIsFollowedAndSaid)
{
  const auto script = [](double time, int) {
    return Matrix4::Translation({ 100 * std::cos(0.3 * time), 200 + 20 * time / 60, 50 });
  };
  FastrakEmulatorOptions options;
  options.Baud = 115200;
  FastrakEmulator emulator(script, options);
  FastrakSettings settings;
  settings.Layout = ChooseFastrakLayout(options.Baud, false);
  Scene scene(EveryFrame());
  scene.Devices.Poses = scene.Place.MakeFastrak(emulator, settings);
  SweepAcquisition& acquisition = scene.Open();
  scene.Place.RunTo(60);
  acquisition.Start();
  scene.Place.RunTo(400); // x changes its sign after 5.2 s
  scene.Place.Run();
  acquisition.Stop();
  EXPECT_TRUE(HasMessage(acquisition.GetState(), "other half of space"));
  double least = 0;
  for (const AcquiredSlice& slice : acquisition.TakeSlices())
  {
    ASSERT_EQ(slice.Status, 0);
    EXPECT_LT(Norm(slice.ProbeToTracker.Column(3) - script(slice.Timestamp, 1).Column(3)), 0.01);
    least = std::min(least, slice.ProbeToTracker(0, 3));
  }
  EXPECT_LT(least, -90);
  acquisition.BeginSweep(); // to whose slices it did not happen
  EXPECT_FALSE(HasMessage(acquisition.GetState(), "other half of space"));
}

// Also when its state is asked for between the press and the next frame.
TEST(AcquisitionTracker, TheButtonStartsAgainWhatWasFull)
{
  AcquisitionRules rules = EveryFrame();
  rules.ButtonStarts = true;
  rules.MemoryLimit = 12 * 10;
  Scene scene(rules, Room::NumberedFrame,
    [](double time, std::vector<TrackedPose>& poses)
    {
      TrackedPose pose = Room::MakePose(time);
      pose.Button = std::fmod(time, 2) < 0.2;
      poses.push_back(pose);
    });
  SweepAcquisition& acquisition = scene.Open();
  for (int frame = 1; frame < 200; ++frame) // presses at 0, 2, 4, 6 and 8 s
  {
    scene.Place.RunTo(frame);
    acquisition.GetState();
  }
  EXPECT_EQ(acquisition.GetState().Counts.Slices, 10);
  EXPECT_EQ(acquisition.GetState().Counts.PastLimit, 5);
  acquisition.Finish();
  scene.Place.RunTo(300);
  EXPECT_EQ(acquisition.GetState().Counts.PastLimit, 5);
  EXPECT_FALSE(acquisition.GetState().Capturing);
}

TEST(AcquisitionTracker, AButtonThatIsHeldWhileTheTrackerComesBackIsNotPressedAgain)
{
  AcquisitionRules rules = EveryFrame();
  rules.ButtonStarts = true;
  std::atomic<bool> gone{ false };
  Scene scene(rules, Room::NumberedFrame,
    [&](double time, std::vector<TrackedPose>& poses)
    {
      if (time > 2.5 && !gone.exchange(true))
      {
        throw std::runtime_error("gone");
      }
      TrackedPose pose = Room::MakePose(time);
      pose.Button = (time > 2 && time < 3) || time > 4;
      poses.push_back(pose);
    });
  SweepAcquisition& acquisition = scene.Open();
  scene.Place.RunTo(70);
  EXPECT_TRUE(gone);
  EXPECT_TRUE(acquisition.GetState().Capturing);
  scene.Place.RunTo(90);
  EXPECT_FALSE(acquisition.GetState().Capturing); // the next press
}

// Those that are not Usable do not wait with others for a new motion.
TEST(AcquisitionTracker, AButtonInPosesThatComeOutOfOrderIsPressedOnce)
{
  AcquisitionRules rules = EveryFrame();
  rules.ButtonStarts = true;
  std::vector<TrackedPose> waiting;
  Scene scene(rules, Room::NumberedFrame,
    [&](double time, std::vector<TrackedPose>& poses)
    {
      TrackedPose pose = Room::MakePose(time);
      pose.Arrival = time;
      pose.Button = time > 2 && time < 2.3;
      pose.Usable = time < 1.95 || time > 2.09;
      if (time > 1.95 && time < 1.99)
      {
        waiting.push_back(pose);
        return;
      }
      if (pose.Usable)
      {
        poses.insert(poses.end(), waiting.begin(), waiting.end());
        waiting.clear();
      }
      poses.push_back(pose);
    });
  SweepAcquisition& acquisition = scene.Open();
  scene.Place.RunTo(80);
  EXPECT_TRUE(acquisition.GetState().Capturing);
  EXPECT_GT(acquisition.GetState().Counts.Frames, 40);
}

// The FASTRAK's protocol at its pace, one byte in a hundred damaged: every frame becomes a slice and
// every pose is right.
class AcquisitionSoak : public testing::TestWithParam<double>
{
};

TEST_P(AcquisitionSoak, NoFrameIsLostOrMispaired)
{
  FastrakEmulatorOptions options;
  options.Baud = 115200;
  options.Faults.Changed = 0.01;
  FastrakEmulator emulator(lacunaTest::Sweep, options);
  FastrakSettings settings;
  settings.Layout = ChooseFastrakLayout(options.Baud, false);
  settings.Motion = { 600, 6, 0.1, 0.001 }; // the sweep's, with a margin
  Scene scene(EveryFrame());
  scene.Devices.Poses = scene.Place.MakeFastrak(emulator, settings);
  SweepAcquisition& acquisition = scene.Open();
  scene.Place.RunTo(75); // it is set up by then
  acquisition.Start();
  std::int64_t expected = -1;
  double worst = 0;
  double residual = 0;
  double delay = 0;
  const int frames = static_cast<int>(25 * GetParam());
  for (int seen = 100; seen < frames;)
  {
    seen = std::min(seen + 1000, frames);
    scene.Place.RunTo(seen);
    for (const AcquiredSlice& slice : acquisition.TakeSlices())
    {
      expected = expected < 0 ? slice.FrameNumber : expected;
      ASSERT_EQ(slice.FrameNumber, expected++);
      ASSERT_EQ(Room::ReadNumber(*slice.Pixels), slice.FrameNumber);
      ASSERT_EQ(slice.Status, 0);
      worst = std::max(worst, PoseError(slice));
      residual = std::max(residual, slice.Residual);
      delay = std::max(delay, slice.Delay);
    }
  }
  scene.Place.Run(); // for the last ones' poses
  acquisition.Stop();
  const AcquisitionState state = acquisition.GetState();
  std::cout << state.Counts.Slices << " slices, " << state.Poses.Poses << " records, "
            << state.Poses.Damaged << " damaged, worst pose " << worst << " mm, residual "
            << 1000 * residual << " ms, latest slice " << 1000 * delay << " ms after its frame\n";
  EXPECT_EQ(state.Counts.Slices, state.Counts.Frames);
  EXPECT_GT(state.Counts.Slices, frames - 300);
  EXPECT_EQ(state.Counts.WithoutPose, 0);
  EXPECT_GT(state.Poses.Damaged, state.Poses.Poses / 10);
  EXPECT_LT(worst, 0.05);
  ExpectNoneForgotten(state, false);
}

INSTANTIATE_TEST_SUITE_P(Short, AcquisitionSoak, testing::Values(60.0));
INSTANTIATE_TEST_SUITE_P(Soak, AcquisitionSoak, testing::Values(1800.0));
