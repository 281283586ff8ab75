// SPDX-License-Identifier: BSD-3-Clause
// A capture that goes on with other devices, in simulated time.
#include "lacunaSweep.h"
#include "lacunaTestNoThreads.h"
#include "lacunaTestScene.h"

#include <gtest/gtest.h>

#include <future>
#include <limits>
#include <memory>
#include <optional>

using namespace lacuna;
using namespace lacunaTest;

TEST(AcquisitionDevices, ABrokenTrackerIsReplacedDuringACapture)
{
  AcquisitionRules rules = EveryFrame();
  rules.TimeOffset = -0.05; // the next frame is of the moment between the two
  Scene scene(rules);
  const PoseDeviceFactory works = scene.Devices.Poses;
  scene.Devices.Poses = [](const Room::Stopped&) -> std::unique_ptr<PoseDevice>
  { throw std::invalid_argument("TrackerConnection is not set"); }; // final
  SweepAcquisition& acquisition = scene.Open();
  acquisition.Start();
  while (!HasMessage(acquisition.GetState(), "is not set"))
  {
    std::this_thread::sleep_for(std::chrono::milliseconds(1)); // the threads shall have their turn
  }
  scene.Devices.Poses = works;
  acquisition.ReplaceTracker(scene.Devices);
  scene.Place.RunTo(50);
  EXPECT_TRUE(acquisition.GetState().TrackerWorks);

  // another one, whose poses are 10 mm away and of another station
  scene.Devices.Station = 2;
  scene.Devices.Poses = scene.Place.MakeTracker(
    [](double time, std::vector<TrackedPose>& poses)
    {
      TrackedPose pose = Room::MakePose(time);
      pose.ReceiverToTransmitter = Matrix4::Translation({ 10, 0, 0 }) * pose.ReceiverToTransmitter;
      pose.Station = 2;
      poses.push_back(pose);
    });
  acquisition.ReplaceTracker(scene.Devices);
  scene.Place.RunTo(150);
  acquisition.Stop();
  const AcquisitionState state = acquisition.GetState();
  EXPECT_TRUE(state.TrackerWorks);
  ExpectNoneForgotten(state, false);
  EXPECT_GE(state.Poses.Poses, 250u); // of both
  const std::vector<AcquiredSlice> slices = acquisition.TakeSlices();
  ASSERT_GE(slices.size(), 140u);
  int first = 0;
  int second = 0;
  int valid = 0;
  for (const AcquiredSlice& slice : slices)
  {
    if (slice.Status == 0)
    {
      ++valid;
      const double off = slice.ProbeToTracker(0, 3) - lacunaTest::Sweep(slice.Timestamp, 1)(0, 3);
      first += std::abs(off) < 0.1 ? 1 : 0;
      second += std::abs(off - 10) < 0.1 ? 1 : 0;
    }
  }
  EXPECT_GT(first, 40);
  EXPECT_GT(second, 90);
  EXPECT_LE(slices.size() - static_cast<std::size_t>(first + second), 5u);
  EXPECT_EQ(first + second, valid); // no pose between the two
}

TEST(AcquisitionDevices, WithoutAThreadForAnotherOneTheCaptureStays)
{
  Scene scene(EveryFrame());
  SweepAcquisition& acquisition = scene.Open();
  acquisition.Start();
  scene.Place.RunTo(20);
  {
    const NoThreads none;
    acquisition.ReplaceTracker(scene.Devices);
  }
  EXPECT_TRUE(HasMessage(acquisition.GetState(), "No thread can be started"));
  acquisition.ReplaceTracker(scene.Devices);
  scene.Place.RunTo(40);
  EXPECT_TRUE(acquisition.GetState().TrackerWorks);
  acquisition.Stop();
  EXPECT_EQ(acquisition.TakeSlices().size(), 40u);
}

TEST(AcquisitionDevices, ABrokenVideoIsReplacedDuringACapture)
{
  Scene scene(EveryFrame());
  const FrameDeviceFactory works = scene.Devices.Frames;
  scene.Devices.Frames = [](const Room::Stopped&) -> std::unique_ptr<FrameDevice>
  { throw std::invalid_argument("VideoURL is not set"); };
  SweepAcquisition& acquisition = scene.Open();
  acquisition.Start();
  while (!HasMessage(acquisition.GetState(), "VideoURL"))
  {
    std::this_thread::sleep_for(std::chrono::milliseconds(1)); // the threads shall have their turn
  }
  scene.Devices.Frames = works;
  scene.Devices.VideoLatency = 0.1;
  acquisition.ReplaceVideo(scene.Devices);
  scene.Place.RunTo(50);
  acquisition.Stop();
  EXPECT_TRUE(acquisition.GetState().VideoWorks);
  const std::vector<AcquiredSlice> slices = acquisition.TakeSlices();
  ASSERT_GE(slices.size(), 40u);
  for (const AcquiredSlice& slice : slices)
  {
    EXPECT_NEAR(slice.Timestamp, Room::FrameTime(static_cast<int>(slice.FrameNumber)) - 0.1, 1e-9);
  }
}

// It is stopped after it has read a frame, and gives times of its frames when another video has frames
// that wait for theirs.
TEST(AcquisitionDevices, AVideoThatIsLateSetsNoTimesOfItsSuccessor)
{
  struct Meeting
  {
    std::promise<void> Stuck;
    std::promise<void> Released;
    std::promise<void> Gone;
  };
  struct First : public FrameDevice
  {
    explicit First(std::shared_ptr<Meeting> meeting)
      : Point(std::move(meeting))
    {
    }
    ~First() override { this->Point->Gone.set_value(); }
    VideoEvent Read(VideoFrame& frame) override
    {
      frame.Arrival = 0.1 * ++this->Frames;
      frame.Timed = false;
      return Room::NumberedFrame(1000 + this->Frames, frame);
    }
    std::vector<std::optional<double>> TakeArrivals() override
    {
      if (this->Frames < 2)
      {
        return {};
      }
      this->Point->Stuck.set_value();
      this->Point->Released.get_future().wait();
      return { 0.05 };
    }
    double GetLatency() const override { return 0; }
    VideoSource::Counts GetCounts() const override { return {}; }
    std::shared_ptr<Meeting> Point;
    int Frames = 0;
  };
  struct Second : public FrameDevice
  {
    explicit Second(std::unique_ptr<FrameDevice> inner)
      : Inner(std::move(inner))
    {
    }
    VideoEvent Read(VideoFrame& frame) override
    {
      const VideoEvent event = this->Inner->Read(frame);
      this->Number = Room::ReadNumber(frame.Grey);
      frame.Timed = this->Number >= 10;
      return event;
    }
    std::vector<std::optional<double>> TakeArrivals() override
    {
      std::vector<std::optional<double>> arrivals;
      for (int i = 0; this->Number == 10 && i < 10; ++i)
      {
        arrivals.emplace_back(Room::FrameTime(i) - 0.01);
      }
      return arrivals;
    }
    double GetLatency() const override { return 0; }
    VideoSource::Counts GetCounts() const override { return this->Inner->GetCounts(); }
    std::unique_ptr<FrameDevice> Inner;
    int Number = -1;
  };
  Scene scene(EveryFrame());
  const FrameDeviceFactory works = scene.Devices.Frames;
  const auto meeting = std::make_shared<Meeting>();
  scene.Devices.Frames = [meeting](const Room::Stopped&)
  { return std::make_unique<First>(meeting); };
  SweepAcquisition& acquisition = scene.Open();
  meeting->Stuck.get_future().wait();
  scene.Devices.Frames = [works](const Room::Stopped& stopped)
  { return std::make_unique<Second>(works(stopped)); };
  acquisition.ReplaceVideo(scene.Devices);
  acquisition.Start();
  scene.Place.RunTo(10);
  meeting->Released.set_value();
  meeting->Gone.get_future().wait();
  scene.Place.RunTo(20);
  acquisition.Stop();
  const std::vector<AcquiredSlice> slices = acquisition.TakeSlices();
  ASSERT_EQ(slices.size(), 20u);
  for (int i = 0; i < 20; ++i)
  {
    EXPECT_EQ(Room::ReadNumber(*slices[i].Pixels), i);
    EXPECT_NEAR(slices[i].Timestamp, Room::FrameTime(i) - (i < 10 ? 0.01 : 0), 1e-9) << i;
    EXPECT_EQ(slices[i].Status, 0) << i;
  }
}

TEST(AcquisitionDevices, PixelsOfAnotherSizeThanTheCalibrationsAreSaid)
{
  AcquisitionRules rules = EveryFrame();
  rules.ImageToProbe = Matrix4::Translation({ 5, 6, 7 }) * FastrakRotation(Vec3{ 20, 30, 40 }) *
    Matrix4::Scaling({ 0.2, 0.3, 0.2 });
  Vec2 spacing{ 0.2, 0.3 };
  Scene scene(rules,
    [&](int number, VideoFrame& frame)
    {
      frame.PixelSpacing = spacing;
      return Room::NumberedFrame(number, frame);
    });
  SweepAcquisition& acquisition = scene.Open();
  scene.Place.RunTo(20);
  EXPECT_FALSE(HasMessage(acquisition.GetState(), "pixels"));
  for (const Vec2& other : { Vec2{ 0.25, 0.3 }, Vec2{ 0.2, 0.2875 } })
  {
    spacing = other;
    scene.Place.RunTo(other[0] == 0.25 ? 40 : 60);
    const AcquisitionState state = acquisition.GetState();
    EXPECT_TRUE(HasMessage(
      state, other[0] == 0.25 ? "its pixels are 0.25 x 0.3 mm" : "its pixels are 0.2 x 0.2875 mm"));
    EXPECT_TRUE(HasMessage(state, "the calibration that they are 0.2 x 0.3 mm"));
  }
  spacing = { 0.2, 0.303 };
  int end = 80;
  scene.Place.RunTo(end);
  EXPECT_FALSE(HasMessage(acquisition.GetState(), "pixels"));
  for (const double none :
    { 0.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity() })
  {
    spacing = { none, 0.3 };
    scene.Place.RunTo(end += 20);
    EXPECT_TRUE(HasMessage(acquisition.GetState(), "which cannot be")) << none;
    spacing = { 0.2, none };
    scene.Place.RunTo(end += 20);
    EXPECT_TRUE(HasMessage(acquisition.GetState(), "which cannot be")) << none;
  }
}
