// SPDX-License-Identifier: BSD-3-Clause
// Trackers and scanners behind a server of OpenIGTLink's own library, in this process, in real time.
#include "lacunaByteChannel.h"
#include "lacunaExecution.h"
#include "lacunaOpenIGTLinkDevices.h"
#include "lacunaPoseTrack.h"
#include "lacunaTestDevice.h"
#include "lacunaTestOpenIGTLink.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <future>
#include <thread>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

using namespace lacuna;
using namespace lacunaTest;

namespace
{
const SteadyClock TheClock;
const auto Always = [] { return false; };
constexpr double Single = 2e-5;       // mm
constexpr double SenderAhead = 1.7e9; // s of the server's clock before ours

struct Factories
{
  explicit Factories(const std::string& address)
    : Poses(MakeOpenIGTLinkPoseFactory(address, 3, TheClock))
    , Frames(MakeOpenIGTLinkFrameFactory(address, TheClock))
  {
  }
  PoseDeviceFactory Poses;
  FrameDeviceFactory Frames;
};

std::unique_ptr<PoseDevice> OpenPoses(const std::string& address)
{
  auto device = MakeOpenIGTLinkPoseFactory(address, 1, TheClock)(Always);
  device->SetUp();
  return device;
}

std::unique_ptr<FrameDevice> OpenFrames(const std::string& address)
{
  return MakeOpenIGTLinkFrameFactory(address, TheClock)(Always);
}

template <class Error, class Call>
std::string WhatOf(Call&& call)
{
  try
  {
    call();
  }
  catch (const Error& e)
  {
    return e.what();
  }
  return {};
}

std::string Grey(int columns, int rows, const std::string& device, double stamp = 0)
{
  std::vector<char> pixels;
  for (int i = 0; i < columns * rows; ++i)
  {
    pixels.push_back(static_cast<char>(3 * (i % columns) + 40 * (i / columns)));
  }
  return ImageBytes(columns, rows, pixels, device, stamp);
}

class Timer
{
public:
  double GetSeconds() const
  {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - this->Begin).count();
  }

private:
  std::chrono::steady_clock::time_point Begin = std::chrono::steady_clock::now();
};

/// Takes no connections: the queue of those that wait is full, so that more of them hang.
class BlackHole
{
public:
  BlackHole()
  {
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    this->Sockets.push_back(socket(AF_INET, SOCK_STREAM, 0));
    EXPECT_EQ(bind(this->Sockets[0], reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(listen(this->Sockets[0], 0), 0);
    EXPECT_EQ(getsockname(this->Sockets[0], reinterpret_cast<sockaddr*>(&address), &size), 0);
    this->Port = ntohs(address.sin_port);
    for (int i = 0; i < 3; ++i)
    {
      this->Sockets.push_back(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0));
      connect(this->Sockets.back(), reinterpret_cast<sockaddr*>(&address), size);
    }
  }
  ~BlackHole()
  {
    for (const int socket : this->Sockets)
    {
      close(socket);
    }
  }
  BlackHole(const BlackHole&) = delete;
  BlackHole& operator=(const BlackHole&) = delete;
  int Port = 0;

private:
  std::vector<int> Sockets;
};
}

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
      ++taken;
    }
  }
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
    if (i > 2) // the estimate of the clock is at rest by then
    {
      ASSERT_TRUE(pose);
      // the stamps have 0.2 microseconds; the straight line between the poses is almost right
      EXPECT_LT(
        LargestDifference(pose->ReceiverToTransmitter, AsymmetricPose(0.02 * i - 0.007)), 1e-3);
    }
  }
  sender.wait();
  EXPECT_EQ(tracker->GetCounts().Poses, 20u);
  EXPECT_EQ(scanner->GetCounts().Frames, 20u);
  EXPECT_EQ(scanner->GetLatency(), 0);
  EXPECT_EQ(tracker->GetCounts().Damaged + scanner->GetCounts().Undecodable, 0u);
}

TEST(OpenIGTLinkDevices, TimesOfImagesAscendWhileTheClockBecomesKnown)
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

TEST(OpenIGTLinkDevices, TheClockIsKnownFromMessagesThatNobodyWanted)
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

TEST(OpenIGTLinkDevices, ImagesOfAnotherClockThanThePosesAreWarnedOf)
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

TEST(OpenIGTLinkDevices, StampsOfDevicesThatNobodyWantsMayBeAny)
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
  for (const auto& [scale, word] : { std::pair<Vec3, std::string>{ { 0.2, 0.2, 0.2 }, "it scales" },
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
  EXPECT_HAS(tracker->GetWarning(), "it scales");
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
    "it scales");
}

TEST(OpenIGTLinkDevices, TrackingDataAreAskedForAndTheElementChosen)
{
  Server server;
  const auto device = OpenPoses(server.GetAddress("?transform=Stylus&start=TDATA"));
  ASSERT_TRUE(server.Accept());
  EXPECT_EQ(server.Receive(94).substr(2, 9), "STT_TDATA");
  server.Send(
    TrackingBytes({ { "Probe", AsymmetricPose(1) }, { "Stylus", AsymmetricPose(2) } }, 3));
  std::vector<TrackedPose> poses;
  ASSERT_TRUE(device->Poll(poses));
  ASSERT_EQ(poses.size(), 1u);
  EXPECT_LT(LargestDifference(poses[0].ReceiverToTransmitter, AsymmetricPose(2)), Single);
}

TEST(OpenIGTLinkDevices, RepeatedStampsAreOneMeasurement)
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

TEST(OpenIGTLinkDevices, WhatIsWrongIsWarnedOf)
{
  Server server;
  const auto device = OpenPoses(server.GetAddress("?transform=Probe"));
  ASSERT_TRUE(server.Accept());
  std::vector<TrackedPose> poses;
  const Timer timer;
  EXPECT_FALSE(device->Poll(poses));
  EXPECT_LT(timer.GetSeconds(), 1.5);
  EXPECT_HAS(device->GetWarning(), "it sends nothing at all");
  server.Send(TransformBytes(AsymmetricPose(), "Prob", 1) + Grey(3, 2, "Image", 1));
  EXPECT_FALSE(device->Poll(poses));
  EXPECT_HAS(device->GetWarning(), "No pose of 'Probe' has come");
  EXPECT_HAS(device->GetWarning(), "for 2 s; it sends IMAGE 'Image', TRANSFORM 'Prob'");
  server.Send(WithMetaData(
    TransformBytes(AsymmetricPose(), "Probe", 1), { { "TransformStatus", "OUT_OF_VIEW" } }));
  ASSERT_TRUE(device->Poll(poses));
  EXPECT_FALSE(poses[0].Usable);
  EXPECT_HAS(device->GetWarning(), "does not see 'Probe' (OUT_OF_VIEW)");
  server.Send(
    StatusBytes(18, "Failure", "coil") + TransformBytes(AsymmetricPose(1), "Probe", 1.01));
  ASSERT_TRUE(device->Poll(poses));
  EXPECT_TRUE(poses[1].Usable);
  EXPECT_HAS(device->GetWarning(), "reports status 18 (Failure: coil)");
  server.Send(StatusBytes(1, "OK", "") + TransformBytes(AsymmetricPose(2), "Probe", 1.02));
  ASSERT_TRUE(device->Poll(poses));
  EXPECT_EQ(device->GetWarning(), "");
  server.Send(TransformBytes(AsymmetricPose(3), "Probe", 101));
  ASSERT_TRUE(device->Poll(poses));
  EXPECT_HAS(device->GetWarning(), "The clock of " + server.GetAddress() + " was set by 100.0 s");
  server.Send(TransformBytes(AsymmetricPose(4), "Probe", 101));
  EXPECT_FALSE(device->Poll(poses));
  EXPECT_HAS(device->GetWarning(), "time stamp stands still");
}

TEST(OpenIGTLinkDevices, UnknownDamagedAndGiantMessagesArePassedOver)
{
  Server server;
  const std::string address = server.GetAddress("?transform=Probe&image=Image");
  const Factories factories(address);
  const auto device = factories.Poses(Always);
  device->SetUp();
  const auto scanner = factories.Frames(Always);
  ASSERT_TRUE(server.Accept());
  const auto text = igtl::StringMessage::New();
  text->SetString("what nobody asked for");
  server.Send(Pack(*text, "Probe", 1));
  std::string damaged = TransformBytes(AsymmetricPose(), "Probe", 1);
  damaged[80] = static_cast<char>(damaged[80] ^ 4);
  server.Send(damaged);
  // of a size that cannot be, though its checksum is right
  const std::string odd = TransformBytes(AsymmetricPose(), "Probe", 1);
  server.Send(WithBody(odd, odd.substr(58, 47)));
  const auto sender = std::async(std::launch::async,
    [&]
    {
      // an image of 160 MiB is passed over; so is one of any size that is not wanted
      for (const char* name : { "Image", "Other" })
      {
        const std::string one = Grey(3, 2, name, 1);
        server.Send(one.substr(0, 42) + BigEndian(160 << 20, 8) + one.substr(50, 8));
        const std::string zeros(1 << 20, '\0');
        for (int i = 0; i < 160; ++i)
        {
          server.Send(zeros);
        }
      }
      server.Send(Grey(3, 2, "Image", 2));
      for (const char byte : TransformBytes(AsymmetricPose(), "Probe", 2))
      {
        server.Send(std::string(1, byte));
      }
    });
  std::vector<TrackedPose> poses;
  for (int i = 0; i < 20 && !device->Poll(poses); ++i)
  {
  }
  sender.wait();
  ASSERT_EQ(poses.size(), 1u);
  EXPECT_EQ(device->GetCounts().Damaged, 2u);
  VideoFrame frame;
  EXPECT_EQ(scanner->Read(frame), VideoEvent::Frame);
  EXPECT_EQ(scanner->GetCounts().Undecodable, 1u);
}

TEST(OpenIGTLinkDevices, WhatNobodyTakesIsDroppedAndCounted)
{
  Server server;
  const auto scanner = OpenFrames(server.GetAddress());
  ASSERT_TRUE(server.Accept());
  const std::vector<char> pixels(1000 * 1000, 1);
  for (int i = 0; i < 100; ++i)
  {
    ASSERT_TRUE(server.Send(ImageBytes(1000, 1000, pixels, "Image", 1 + i)));
  }
  VideoFrame frame;
  int count = 0;
  while (!frame.StreamTime || *frame.StreamTime < 100)
  {
    scanner->Read(frame);
    ++count;
  }
  EXPECT_GE(scanner->GetCounts().Missing, 20u);
  EXPECT_EQ(scanner->GetCounts().Missing + static_cast<std::uint64_t>(count), 100u);
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

TEST(OpenIGTLinkDevices, SilenceOfAScannerIsAnError)
{
  Server server;
  const auto scanner = OpenFrames(server.GetAddress("?image=Image"));
  ASSERT_TRUE(server.Accept());
  server.Send(StatusBytes(13, "NotReady", "warming up") + Grey(3, 2, "Image_Reference", 1));
  VideoFrame frame;
  const std::string text =
    Complaint<VideoError>(VideoError::Kind::Silent, [&] { scanner->Read(frame); });
  EXPECT_HAS(text, "No new image of 'Image' has come");
  EXPECT_HAS(text, "it sends IMAGE 'Image_Reference', STATUS 'Tracker'");
  EXPECT_HAS(text, "status 13 (NotReady: warming up)");
}

TEST(OpenIGTLinkDevices, LostConnectionAndReturn)
{
  Server server;
  const std::string address = server.GetAddress();
  const Factories factories(address);
  auto device = factories.Poses(Always);
  device->SetUp();
  auto scanner = factories.Frames(Always);
  ASSERT_TRUE(server.Accept());
  server.Send(TransformBytes(AsymmetricPose(1), "Probe", 1));
  const std::string half = Grey(30, 20, "Image", 1);
  server.Send(half.substr(0, half.size() / 2));
  std::vector<TrackedPose> poses;
  ASSERT_TRUE(device->Poll(poses));
  server.Hangup();
  VideoFrame frame;
  EXPECT_HAS(Complaint<ChannelError>(ChannelError::Kind::Unplugged, [&] { device->Poll(poses); }),
    "is gone");
  EXPECT_HAS(Complaint<ChannelError>(ChannelError::Kind::Unplugged, [&] { scanner->Read(frame); }),
    "start the server again");
  device.reset();
  device = factories.Poses(Always); // the scanner still has the broken connection
  device->SetUp();
  scanner.reset();
  scanner = factories.Frames(Always);
  ASSERT_TRUE(server.Accept());
  EXPECT_FALSE(server.Accept(50));
  server.Send(TransformBytes(AsymmetricPose(2), "Probe", 1) + Grey(3, 2, "Image", 1));
  poses.clear();
  ASSERT_TRUE(device->Poll(poses));
  EXPECT_LT(LargestDifference(poses[0].ReceiverToTransmitter, AsymmetricPose(2)), Single);
  EXPECT_EQ(scanner->Read(frame), VideoEvent::Frame);
}

TEST(OpenIGTLinkDevices, WhatIsNotOpenIGTLinkIsSaid)
{
  std::vector<TrackedPose> poses;
  Server web;
  auto device = OpenPoses(web.GetAddress());
  ASSERT_TRUE(web.Accept());
  web.Send("HTTP/1.1 400 Bad Request\r\nContent-Type: text/plain; charset=utf-8\r\n\r\n");
  EXPECT_HAS(Complaint<ChannelError>(ChannelError::Kind::Other, [&] { device->Poll(poses); }),
    "check the port");
  Server shell;
  device = OpenPoses(shell.GetAddress());
  ASSERT_TRUE(shell.Accept());
  shell.Send("SSH-2.0-OpenSSH_9.2p1\r\n");
  std::string text;
  for (int i = 0; i < 10 && text.empty(); ++i)
  {
    text = WhatOf<ChannelError>([&] { device->Poll(poses); });
  }
  EXPECT_HAS(text, "sends what is not OpenIGTLink");
}

TEST(OpenIGTLinkDevices, HostsThatAreNotThere)
{
  const std::string gone = Server().GetAddress();
  EXPECT_HAS(Complaint<ChannelError>(ChannelError::Kind::NotFound, [&] { OpenPoses(gone); }),
    "No server listens at " + gone);
  EXPECT_HAS(Complaint<ChannelError>(ChannelError::Kind::NotFound,
               [] { OpenPoses("igtl://no-such-host.invalid:18944"); }),
    "There is no host 'no-such-host.invalid'");
  EXPECT_THROW(MakeOpenIGTLinkPoseFactory("igtl://", 1, TheClock), std::invalid_argument);
  EXPECT_THROW(MakeOpenIGTLinkFrameFactory("igtl://x:y", TheClock), std::invalid_argument);
}

TEST(OpenIGTLinkDevices, StopsWithinASecondWhateverItDoes)
{
  std::atomic<bool> stop{ false };
  const auto stopped = [&] { return stop.load(); };
  const auto during = [&](const std::function<void()>& call)
  {
    stop = false;
    const auto later = std::async(std::launch::async,
      [&]
      {
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
        stop = true;
      });
    const Timer timer;
    EXPECT_THROW(call(), Aborted);
    EXPECT_LT(timer.GetSeconds(), 1);
    later.wait();
  };
  const BlackHole hole;
  const std::string nowhere = "igtl://127.0.0.1:" + std::to_string(hole.Port);
  const Factories factories(nowhere);
  during([&] { factories.Poses(stopped); });
  during(
    [&]
    {
      const auto other =
        std::async(std::launch::async, [&] { EXPECT_THROW(factories.Poses(stopped), Aborted); });
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      EXPECT_THROW(factories.Frames(stopped), Aborted); // waits for the other to connect
      other.wait();
      throw Aborted();
    });
  stop = false;
  Server server;
  const std::string address = server.GetAddress();
  const Factories silent(address);
  const auto device = silent.Poses(stopped);
  device->SetUp();
  std::vector<TrackedPose> poses;
  during([&] { device->Poll(poses); });
  stop = false;
  const auto scanner = silent.Frames(stopped);
  VideoFrame frame;
  during([&] { scanner->Read(frame); });
  ASSERT_TRUE(server.Accept());
  const std::string half = Grey(30, 20, "Image", 1);
  server.Send(half.substr(0, half.size() / 2));
  during([&] { scanner->Read(frame); });
}
