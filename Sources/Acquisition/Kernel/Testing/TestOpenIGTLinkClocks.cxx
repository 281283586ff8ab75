// SPDX-License-Identifier: BSD-3-Clause
// The time stamps of a server.
#include "lacunaOpenIGTLinkClock.h"
#include "lacunaPoseTrack.h"
#include "lacunaTestOpenIGTLinkDevices.h"

#include <chrono>
#include <thread>

using namespace lacuna;
using namespace lacunaTest;

namespace
{
// Of which nothing is to be said.
std::string GoodPose(const std::string& device, double stamp)
{
  return WithMetaData(
    TransformBytes(AsymmetricPose(), device, stamp), { { "TransformStatus", "OK" } });
}
}

TEST(OpenIGTLinkClocks, TimesOfImagesAscendWhileTheClockBecomesKnown)
{
  Server server;
  const auto scanner = OpenFrames(server.GetAddress("?image=Image"));
  ASSERT_TRUE(server.Accept());
  // images 0.2 s after they were taken; that they are is known from the second on, when a pose came
  const double begin = TheClock.Now() + SenderAhead;
  const auto image = [&](double time) { return Grey(3, 2, "Image", begin + time - 0.2); };
  server.Send(image(0) + TransformBytes(AsymmetricPose(), "Probe", begin) + image(0.02));
  server.Send(image(0.1));
  std::this_thread::sleep_for(std::chrono::milliseconds(250));
  server.Send(image(0.25));
  VideoFrame first;
  VideoFrame second;
  EXPECT_EQ(scanner->Read(first), VideoEvent::Frame);
  EXPECT_EQ(scanner->Read(second), VideoEvent::Frame);
  EXPECT_GT(second.Arrival, first.Arrival);
  EXPECT_NEAR(*second.StreamTime, begin + 0.05, 1e-6);
  EXPECT_EQ(scanner->GetCounts().Frames, 2u);
  EXPECT_EQ(scanner->GetCounts().Missing, 2u);
}

TEST(OpenIGTLinkClocks, TheClockIsKnownFromMessagesThatNobodyWanted)
{
  Server server;
  const auto scanner = OpenFrames(server.GetAddress("?image=Image"));
  ASSERT_TRUE(server.Accept());
  const double begin = TheClock.Now() + SenderAhead;
  // statuses have stamps of no measurement
  const auto status = igtl::StatusMessage::New();
  status->SetCode(1);
  server.Send(Pack(*status, "Server", begin + 0.2) +
    TransformBytes(AsymmetricPose(), "Probe", begin) + Grey(3, 2, "Image", begin - 0.2));
  VideoFrame frame;
  EXPECT_EQ(scanner->Read(frame), VideoEvent::Frame);
  const double latest = TheClock.Now();
  EXPECT_LE(frame.Arrival, latest - 0.2);
  EXPECT_GE(frame.Arrival, begin - SenderAhead - 0.2 - 1e-6);
}

TEST(OpenIGTLinkClocks, ImagesOfAnotherClockThanThePosesAreWarnedOf)
{
  Server server;
  const Factories factories(server.GetAddress("?transform=Probe&image=Image"));
  const auto tracker = factories.Poses(Always);
  tracker->SetUp();
  auto scanner = factories.Frames(Always);
  ASSERT_TRUE(server.Accept());
  std::vector<TrackedPose> poses;
  // images that nobody takes may be of any time
  const auto send = [&](double lag)
  {
    const double stamp = TheClock.Now() + SenderAhead;
    server.Send(Grey(3, 2, "Image", stamp - lag) + Grey(3, 2, "Other", stamp - 50) +
      GoodPose("Probe", stamp));
    EXPECT_TRUE(tracker->Poll(poses));
    return tracker->GetWarning();
  };
  EXPECT_HAS(send(0.7), "The clocks of 'Probe' and 'Image' from " + server.GetAddress());
  EXPECT_HAS(send(0.7), "differ by 0.7 s");
  scanner.reset();
  EXPECT_EQ(send(0.7), "");
  scanner = factories.Frames(Always);
  EXPECT_HAS(send(0.7), "The clocks");
  EXPECT_EQ(send(0.3), ""); // the images came late before, not their clock
}

TEST(OpenIGTLinkClocks, StampsOfDevicesThatNobodyWantsMayBeAny)
{
  Server server;
  const auto device = OpenPoses(server.GetAddress("?transform=Probe"));
  ASSERT_TRUE(server.Accept());
  std::vector<TrackedPose> poses;
  const double begin = TheClock.Now() + SenderAhead;
  for (const int i : { 1, 200, 3, 100, 5 })
  {
    server.Send(TransformBytes(AsymmetricPose(), "Other", i) +
      GoodPose("Probe", TheClock.Now() + SenderAhead));
    ASSERT_TRUE(device->Poll(poses));
    EXPECT_EQ(device->GetWarning(), "");
    EXPECT_GE(poses.back().Time, begin - SenderAhead);
  }
}

TEST(OpenIGTLinkClocks, RepeatedStampsAreOneMeasurement)
{
  Server server;
  const auto device = OpenPoses(server.GetAddress());
  ASSERT_TRUE(server.Accept());
  for (const double stamp : { 7.0, 7.0, 7.0, 7.05 })
  {
    server.Send(GoodPose("Probe", stamp));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  std::vector<TrackedPose> poses;
  while (poses.size() < 2)
  {
    ASSERT_TRUE(device->Poll(poses));
  }
  EXPECT_EQ(poses.size(), 2u);
  EXPECT_NEAR(poses[1].Time - poses[0].Time, 0.05, 1e-6);
  EXPECT_EQ(device->GetWarning(), "");
  server.Send(TransformBytes(AsymmetricPose(), "Probe"));
  ASSERT_TRUE(device->Poll(poses));
  EXPECT_EQ(poses[2].Time, poses[2].Arrival);
  EXPECT_HAS(device->GetWarning(), "no time stamps");
}

TEST(OpenIGTLinkClocks, ImagesWithoutStampsAreWarnedOf)
{
  Server server;
  const auto scanner = OpenFrames(server.GetAddress("?image=Image"));
  ASSERT_TRUE(server.Accept());
  EXPECT_EQ(scanner->GetWarning(), "");
  VideoFrame frame;
  const double begin = TheClock.Now();
  server.Send(Grey(3, 2, "Image"));
  EXPECT_EQ(scanner->Read(frame), VideoEvent::Frame);
  EXPECT_GE(frame.Arrival, begin);
  EXPECT_LE(frame.Arrival, TheClock.Now());
  EXPECT_HAS(scanner->GetWarning(), "images of 'Image' have no time stamps");
  server.Send(Grey(3, 2, "Image", TheClock.Now() + SenderAhead));
  EXPECT_EQ(scanner->Read(frame), VideoEvent::Frame);
  EXPECT_EQ(scanner->GetWarning(), "");
}

TEST(OpenIGTLinkClocks, AnEstimateThatChangesByMuchIsARevision)
{
  OpenIGTLinkClock clock;
  const auto pose = [&](double stamp, double way) { clock.ToLocal("Probe", stamp, stamp + way); };
  const auto image = [&](double stamp, double way) { clock.ToLocal("Image", stamp, stamp + way); };
  image(1, 0.12); // the first one was held up
  EXPECT_EQ(clock.GetRevision(), 0);
  pose(1.01, 0.06); // also when the faster one is another device's first
  EXPECT_EQ(clock.GetRevision(), 1);
  image(1.04, 0.06);
  pose(1.05, 0.055);
  EXPECT_EQ(clock.GetRevision(), 1);
  image(1.08, 0.02);
  EXPECT_EQ(clock.GetRevision(), 2); // one for both
  pose(1.09, 0.02);
  EXPECT_EQ(clock.GetRevision(), 2);
  pose(1.11, 0.016); // little by little
  pose(1.13, 0.0125);
  EXPECT_EQ(clock.GetRevision(), 2);
  pose(1.15, 0.009);
  EXPECT_EQ(clock.GetRevision(), 3);
  for (int i = 0; i < 100000; ++i) // an hour of clocks that are 50 parts in a million apart
  {
    const double stamp = 1.17 + 0.04 * i;
    clock.ToLocal("Probe", stamp, stamp * (1 + 5e-5) + 0.009);
  }
  EXPECT_EQ(clock.GetRevision(), 3);
}

// The first image and the poses around it come together and late: by the arrivals its pose would be
// anywhere between them.
TEST(OpenIGTLinkClocks, WhatCameBeforeTheClockWasKnownIsNotPairedWithWhatCameAfter)
{
  Server server;
  const Factories factories(server.GetAddress());
  const auto tracker = factories.Poses(Always);
  tracker->SetUp();
  const auto scanner = factories.Frames(Always);
  ASSERT_TRUE(server.Accept());
  const double begin = TheClock.Now() + SenderAhead;
  const auto sendPose = [&](double stamp)
  { server.Send(TransformBytes(AsymmetricPose(stamp - begin), "Probe", stamp)); };
  sendPose(begin - 0.12);
  server.Send(Grey(3, 2, "Image", begin - 0.1));
  sendPose(begin - 0.06);
  for (int i = 0; i < 4; ++i)
  {
    const double stamp = TheClock.Now() + SenderAhead;
    sendPose(stamp);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    server.Send(Grey(3, 2, "Image", stamp + 0.01));
  }
  std::vector<TrackedPose> poses;
  while (poses.size() < 6)
  {
    ASSERT_TRUE(tracker->Poll(poses));
  }
  PoseTrack track;
  for (const TrackedPose& pose : poses)
  {
    track.Add(pose);
  }
  for (int i = 0; i < 4; ++i)
  {
    VideoFrame frame;
    scanner->Read(frame);
    const auto pose = track.At(frame.Arrival, frame.Epoch);
    EXPECT_FALSE(i == 0 && pose); // however near a pose is
    if (pose)                     // on a busy computer some have none
    {
      // 8 ms, and the straight line, at 31 mm/s
      EXPECT_LT(Norm(pose->ReceiverToTransmitter.Column(3) -
                  AsymmetricPose(*frame.StreamTime - begin).Column(3)),
        0.4);
    }
  }
}
