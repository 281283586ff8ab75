// SPDX-License-Identifier: BSD-3-Clause
// The time stamps of a server.
#include "lacunaTestOpenIGTLinkDevices.h"

#include <chrono>
#include <thread>

using namespace lacuna;
using namespace lacunaTest;

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
      TransformBytes(AsymmetricPose(), "Probe", stamp));
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
      TransformBytes(AsymmetricPose(), "Probe", TheClock.Now() + SenderAhead));
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
    server.Send(TransformBytes(AsymmetricPose(), "Probe", stamp));
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
