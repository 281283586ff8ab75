// SPDX-License-Identifier: BSD-3-Clause
// Trackers and scanners behind a server of OpenIGTLink's own library, in this process, in real time.
#include "lacunaExecution.h"
#include "lacunaPoseTrack.h"
#include "lacunaTestOpenIGTLinkDevices.h"

#include <chrono>
#include <cmath>
#include <cstdint>
#include <future>
#include <thread>

using namespace lacuna;
using namespace lacunaTest;

TEST(OpenIGTLinkDevices, DevicesOfOneServerShareItsConnection)
{
  Server server;
  const std::string address = server.GetAddress("?transform=ProbeToTracker&image=Image_Reference");
  const Factories factories(address);
  const auto tracker = factories.Poses(Always);
  tracker->SetUp();
  ASSERT_TRUE(server.Accept());
  const auto scanner = factories.Frames(Always);
  EXPECT_FALSE(server.Accept(100)); // 3D Slicer serves only one client
}

TEST(OpenIGTLinkDevices, ThePoseOfAFrameIsThatOfItsInstant)
{
  Server server;
  const std::string address = server.GetAddress("?transform=ProbeToTracker&image=Image_Reference");
  const Factories factories(address);
  const auto tracker = factories.Poses(Always);
  tracker->SetUp();
  const auto scanner = factories.Frames(Always);
  ASSERT_TRUE(server.Accept());
  // poses every 20 ms, frames between them, both later than they were taken, and unevenly
  const double begin = TheClock.Now() + SenderAhead - 0.1;
  const auto sender = std::async(std::launch::async,
    [&]
    {
      for (int i = 0; i < 20; ++i)
      {
        const double time = 0.02 * i;
        server.Send(TransformBytes(AsymmetricPose(time), "ProbeToTracker", begin + time));
        server.Send(TransformBytes(AsymmetricPose(9), "StylusToTracker", begin + time));
        server.Send(Grey(3, 2, "Other_Reference", begin + time));
        server.Send(Grey(4 + i / 10, 3, "Image_Reference", begin + time - 0.007));
        std::this_thread::sleep_for(std::chrono::milliseconds(i % 5 == 0 ? 60 : 10));
      }
    });
  PoseTrack track;
  std::vector<TrackedPose> poses;
  std::vector<double> offsets; // of the clocks, as they were estimated when each pose came
  std::size_t taken = 0;
  while (taken < 20)
  {
    poses.clear();
    ASSERT_TRUE(tracker->Poll(poses)) << tracker->GetWarning();
    for (const TrackedPose& pose : poses)
    {
      EXPECT_LT(LargestDifference(
                  pose.ReceiverToTransmitter, AsymmetricPose(0.02 * static_cast<double>(taken))),
        Single);
      EXPECT_TRUE(pose.Usable);
      EXPECT_EQ(pose.Station, 3);
      EXPECT_LE(pose.Time, pose.Arrival);
      track.Add(pose);
      offsets.push_back(pose.Time - (begin + 0.02 * static_cast<double>(taken)));
      ++taken;
    }
  }
  int judged = 0;
  for (int i = 0; i < 20; ++i)
  {
    VideoFrame frame;
    EXPECT_EQ(scanner->Read(frame), i == 10 ? VideoEvent::NewSize : VideoEvent::Frame);
    EXPECT_EQ(frame.Columns, 4 + i / 10);
    EXPECT_EQ(frame.Rows, 3);
    EXPECT_EQ(frame.Grey[1], 3);                                        // to the right
    EXPECT_EQ(frame.Grey[static_cast<std::size_t>(frame.Columns)], 40); // and down
    ASSERT_TRUE(frame.PixelSpacing);
    EXPECT_NEAR((*frame.PixelSpacing)[1], 0.3, 1e-6);
    EXPECT_NEAR(frame.PixelAspect, 2.0 / 3, 1e-6);
    EXPECT_NEAR(*frame.StreamTime, begin + 0.02 * i - 0.007, 1e-6);
    const auto pose = track.At(frame.Arrival);
    // Where the estimate of the clock was at rest: it is moved by a message that was under way for
    // less time than any before.
    const double offset = frame.Arrival - *frame.StreamTime;
    if (i > 2 && std::abs(offsets[i - 1] - offset) < 1e-5 && std::abs(offsets[i] - offset) < 1e-5)
    {
      ++judged;
      ASSERT_TRUE(pose);
      // the stamps have 0.2 microseconds; the straight line between the poses is almost right
      EXPECT_LT(
        LargestDifference(pose->ReceiverToTransmitter, AsymmetricPose(0.02 * i - 0.007)), 1e-3);
    }
  }
  EXPECT_GT(judged, 3);
  sender.wait();
  EXPECT_EQ(tracker->GetCounts().Poses, 20u);
  EXPECT_EQ(scanner->GetCounts().Frames, 20u);
  EXPECT_EQ(scanner->GetLatency(), 0);
  EXPECT_EQ(tracker->GetCounts().Damaged + scanner->GetCounts().Undecodable, 0u);
}

TEST(OpenIGTLinkDevices, ThePlaneOfAnImageIsAPoseToo)
{
  Server server;
  const auto device = OpenPoses(server.GetAddress("?transform=Image_Reference"));
  ASSERT_TRUE(server.Accept());
  server.Send(Grey(40, 30, "Image_Reference", 5));
  std::vector<TrackedPose> poses;
  ASSERT_TRUE(device->Poll(poses));
  EXPECT_LT(LargestDifference(poses[0].ReceiverToTransmitter, AsymmetricPose()), 2 * Single);
}

TEST(OpenIGTLinkDevices, TakesTheOnlyDeviceAndAsksWhenThereAreTwo)
{
  Server server;
  const auto device = OpenPoses(server.GetAddress());
  ASSERT_TRUE(server.Accept());
  server.Send(TransformBytes(AsymmetricPose(), "ProbeToTracker", 1));
  std::vector<TrackedPose> poses;
  ASSERT_TRUE(device->Poll(poses));
  server.Send(TransformBytes(AsymmetricPose(), "StylusToTracker", 1));
  const std::string text = WhatOf<std::invalid_argument>([&] { device->Poll(poses); });
  EXPECT_HAS(text, "'ProbeToTracker' and 'StylusToTracker'");
  EXPECT_HAS(text, "?transform=ProbeToTracker");

  Server pictures;
  const auto scanner = OpenFrames(pictures.GetAddress());
  ASSERT_TRUE(pictures.Accept());
  pictures.Send(Grey(3, 2, "Image_A") + Grey(3, 2, "Image_B"));
  VideoFrame frame;
  EXPECT_EQ(scanner->Read(frame), VideoEvent::Frame);
  EXPECT_HAS(
    WhatOf<std::invalid_argument>([&] { scanner->Read(frame); }), "choose one, as igtl://127");
}

TEST(OpenIGTLinkDevices, ScaledAndMirroredPosesAreRefused)
{
  for (const auto& [scale, word] : { std::pair<Vec3, std::string>{ { 0.2, 0.2, 0.2 },
                                       "it is not rigid: its columns have the lengths 0.2" },
         { { 1, -1, 1 }, "it mirrors" } })
  {
    Server server;
    const auto device = OpenPoses(server.GetAddress("?transform=ImageToReference"));
    ASSERT_TRUE(server.Accept());
    server.Send(TransformBytes(AsymmetricPose() * Matrix4::Scaling(scale), "ImageToReference"));
    std::vector<TrackedPose> poses;
    EXPECT_HAS(WhatOf<std::runtime_error>([&] { device->Poll(poses); }), word);
    EXPECT_TRUE(poses.empty());
  }
}

TEST(OpenIGTLinkDevices, SinglePosesAndImagesThatCannotBeUsedAreDamage)
{
  Server server;
  const Factories factories(server.GetAddress("?transform=Probe&image=Image"));
  const auto tracker = factories.Poses(Always);
  tracker->SetUp();
  const auto scanner = factories.Frames(Always);
  ASSERT_TRUE(server.Accept());
  double stamp = TheClock.Now() + SenderAhead - 10;
  const auto send = [&](int good, int bad)
  {
    std::string bytes;
    for (int i = 0; i < good + bad; ++i)
    {
      stamp += 0.02;
      const Matrix4 scale = Matrix4::Scaling({ 1, i < good ? 1.0 : 2.0, 1 });
      // servers repeat the last pose
      const std::string pose = TransformBytes(AsymmetricPose() * scale, "Probe", stamp);
      bytes += pose + pose;
      bytes += i < good ? Grey(3, 2, "Image", stamp)
                        : ImageBytes(1, 1, std::vector<char>(4, 1), "Image", stamp,
                            igtl::ImageMessage::TYPE_FLOAT32);
    }
    server.Send(bytes);
  };
  std::vector<TrackedPose> poses;
  VideoFrame frame;
  for (const auto& [good, bad] : { std::pair(1, 1), { 2, 4 }, { 1, 4 }, { 1, 0 } })
  {
    send(good, bad);
    for (int i = 0; i < good; ++i)
    {
      EXPECT_EQ(scanner->Read(frame), VideoEvent::Frame);
    }
  }
  while (poses.size() < 5)
  {
    ASSERT_TRUE(tracker->Poll(poses));
  }
  EXPECT_EQ(tracker->GetCounts().Poses, 5u);
  EXPECT_EQ(tracker->GetCounts().Damaged, 9u);
  EXPECT_EQ(scanner->GetCounts().Frames, 5u);
  EXPECT_EQ(scanner->GetCounts().Undecodable, 9u);
  EXPECT_HAS(tracker->GetWarning(), "The pose of 'Probe' from " + server.GetAddress());
  EXPECT_HAS(tracker->GetWarning(), "it is not rigid: its columns have the lengths 1, 2 and 1");
  send(1, 5);
  EXPECT_EQ(scanner->Read(frame), VideoEvent::Frame);
  EXPECT_HAS(Complaint<VideoError>(VideoError::Kind::Unsupported, [&] { scanner->Read(frame); }),
    "integers of 8 or 16 bits");
  EXPECT_HAS(WhatOf<std::runtime_error>(
               [&]
               {
                 tracker->Poll(poses);
                 tracker->Poll(poses);
               }),
    "it is not rigid: its columns have the lengths 1, 2 and 1");
}

TEST(OpenIGTLinkDevices, TrackingDataAreAskedForAndTheElementChosen)
{
  Server server;
  const auto device = OpenPoses(server.GetAddress("?transform=Stylus&start=TDATA"));
  ASSERT_TRUE(server.Accept());
  EXPECT_EQ(server.Receive(116).substr(2, 10), "GET_STATUS");
  EXPECT_EQ(server.Receive(94).substr(2, 9), "STT_TDATA");
  server.Send(
    TrackingBytes({ { "Probe", AsymmetricPose(1) }, { "Stylus", AsymmetricPose(2) } }, 3));
  std::vector<TrackedPose> poses;
  ASSERT_TRUE(device->Poll(poses));
  ASSERT_EQ(poses.size(), 1u);
  EXPECT_LT(LargestDifference(poses[0].ReceiverToTransmitter, AsymmetricPose(2)), Single);
}

TEST(OpenIGTLinkDevices, UnusableImagesAreAnError)
{
  Server server;
  const auto scanner = OpenFrames(server.GetAddress());
  ASSERT_TRUE(server.Accept());
  server.Send(
    ImageBytes(1, 1, std::vector<char>(4, 1), "Image", 1, igtl::ImageMessage::TYPE_FLOAT32));
  VideoFrame frame;
  EXPECT_HAS(Complaint<VideoError>(VideoError::Kind::Unsupported, [&] { scanner->Read(frame); }),
    "integers of 8 or 16 bits");
}

TEST(OpenIGTLinkDevices, QuaternionTrackingDataAreAskedFor)
{
  Server server;
  const auto device = OpenPoses(server.GetAddress("?start=QTDATA"));
  ASSERT_TRUE(server.Accept());
  server.Receive(116);
  EXPECT_EQ(server.Receive(94).substr(2, 10), "STT_QTDATA");
  const auto message = igtl::QuaternionTrackingDataMessage::New();
  igtl::QuaternionTrackingDataElement::Pointer element = igtl::QuaternionTrackingDataElement::New();
  element->SetName("Probe");
  element->SetType(2);
  element->SetPosition(10, -20, 30);
  element->SetQuaternion(0, 0, 0.6F, 0.8F);
  message->AddQuaternionTrackingDataElement(element);
  server.Send(Pack(*message, "Tracker", 3));
  std::vector<TrackedPose> poses;
  ASSERT_TRUE(device->Poll(poses));
  EXPECT_LT(LargestDifference(poses[0].ReceiverToTransmitter,
              Matrix4::Translation({ 10, -20, 30 }) *
                Matrix4::Rotation({ 0, 0, 1 }, 2 * std::atan2(0.6, 0.8))),
    Single);
}

// Whose first poses have no status: PLUS answers in the version that its client has used.
TEST(OpenIGTLinkDevices, PosesBeforeTheAnswerInVersion2AreNotTaken)
{
  Server server;
  const auto device = OpenPoses(server.GetAddress());
  ASSERT_TRUE(server.Accept());
  const OpenIGTLinkMessage request = Read(server.Receive(116));
  EXPECT_EQ(request.Header.Type, "GET_STATUS");
  EXPECT_EQ(request.Header.Version, 2);
  const auto send = [&](int i, const std::string& status)
  {
    const std::string bytes = TransformBytes(AsymmetricPose(i), "ProbeToTracker", 1 + 0.02 * i);
    server.Send(status.empty() ? bytes : WithMetaData(bytes, { { "TransformStatus", status } }));
  };
  send(0, "");
  send(1, "");
  send(2, "OK");
  send(3, "OUT_OF_VIEW");
  std::vector<TrackedPose> poses;
  for (int i = 0; i < 3 && poses.size() < 2; ++i)
  {
    device->Poll(poses);
  }
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_LT(LargestDifference(poses[0].ReceiverToTransmitter, AsymmetricPose(2)), Single * 4);
  EXPECT_TRUE(poses[0].Usable);
  EXPECT_FALSE(poses[1].Usable);
  EXPECT_HAS(device->GetWarning(), "does not see 'ProbeToTracker' (OUT_OF_VIEW)");
}

TEST(OpenIGTLinkDevices, OfAServerOfVersion1AllPosesAreTakenAndWarnedOfOnce)
{
  SkippingClock clock;
  Server server;
  const auto device = MakeOpenIGTLinkPoseFactory(server.GetAddress(), 1, clock)(Always);
  device->SetUp();
  ASSERT_TRUE(server.Accept());
  std::vector<TrackedPose> poses;
  server.Send(TransformBytes(AsymmetricPose(0), "Probe", 1)); // as 3D Slicer: one when it connects
  ASSERT_TRUE(device->Poll(poses));
  server.Send(TransformBytes(AsymmetricPose(1), "Probe", 1.02));
  ASSERT_TRUE(device->Poll(poses));
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_TRUE(poses[0].Usable && poses[1].Usable);
  EXPECT_HAS(device->GetWarning(), "'Probe' from " + server.GetAddress() + " have no status");
  EXPECT_HAS(device->GetWarning(), "SendValidTransformsOnly=\"true\"");
  clock.Skipped = 11;
  server.Send(TransformBytes(AsymmetricPose(2), "Probe", 12.04));
  ASSERT_TRUE(device->Poll(poses));
  EXPECT_EQ(device->GetWarning().find("no status"), std::string::npos) << device->GetWarning();
}

TEST(OpenIGTLinkDevices, AServerThatHangsUpAtVersion2IsNotAskedAThirdTime)
{
  Server server;
  std::vector<TrackedPose> poses;
  for (int i = 0; i < 2; ++i)
  {
    const auto device = OpenPoses(server.GetAddress());
    ASSERT_TRUE(server.Accept());
    server.Receive(116);
    server.Hangup();
    EXPECT_THROW(device->Poll(poses), std::runtime_error);
  }
  const auto device = OpenPoses(server.GetAddress("?start=TDATA"));
  ASSERT_TRUE(server.Accept());
  EXPECT_EQ(server.Receive(94).substr(2, 9), "STT_TDATA"); // nothing before it
  server.Send(TransformBytes(AsymmetricPose(), "Probe", 1));
  ASSERT_TRUE(device->Poll(poses));
}

TEST(OpenIGTLinkDevices, AnImageThatItsSenderMarksIsDamaged)
{
  Server server;
  const auto scanner = OpenFrames(server.GetAddress());
  ASSERT_TRUE(server.Accept());
  VideoFrame frame;
  for (int i = 0; i < 3; ++i)
  {
    server.Send(WithMetaData(
      Grey(3, 2, "Image", 1 + 0.04 * i), { { "ImageStatus", i == 1 ? "INVALID" : "OK" } }));
    EXPECT_EQ(scanner->Read(frame), VideoEvent::Frame);
    EXPECT_EQ(frame.Damaged, i == 1);
  }
}

// As 3D Slicer and robots do, which send a pose when a client connects and when it changes.
TEST(OpenIGTLinkDevices, APoseThatIsSentOnceAtTheBeginningIsNotLost)
{
  Server server;
  const Factories factories(server.GetAddress());
  const auto scanner = factories.Frames(Always); // opens the connection
  ASSERT_TRUE(server.Accept());
  server.Send(TransformBytes(AsymmetricPose(), "Probe", 1));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  const auto tracker = factories.Poses(Always);
  tracker->SetUp();
  std::vector<TrackedPose> poses;
  ASSERT_TRUE(tracker->Poll(poses));
  EXPECT_LT(LargestDifference(poses[0].ReceiverToTransmitter, AsymmetricPose()), Single);
}
