// SPDX-License-Identifier: BSD-3-Clause
// Servers that send what they should not, or nothing, or are gone.
#include "lacunaByteChannel.h"
#include "lacunaExecution.h"
#include "lacunaTestOpenIGTLinkDevices.h"

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

TEST(OpenIGTLinkTroubles, WhatIsWrongIsWarnedOf)
{
  Server server;
  const auto device = OpenPoses(server.GetAddress("?transform=Probe"));
  ASSERT_TRUE(server.Accept());
  std::vector<TrackedPose> poses;
  const Timer timer;
  EXPECT_FALSE(device->Poll(poses));
  EXPECT_LT(timer.GetSeconds(), 1.5);
  EXPECT_HAS(device->GetWarning(), "it sends nothing at all");
  EXPECT_HAS(device->GetWarning(), "add &start=TDATA (or &start=QTDATA) to the address");
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

TEST(OpenIGTLinkTroubles, UnknownDamagedAndGiantMessagesArePassedOver)
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

TEST(OpenIGTLinkTroubles, WhatNobodyTakesIsDroppedAndCounted)
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

TEST(OpenIGTLinkTroubles, SilenceOfAScannerIsAnError)
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

TEST(OpenIGTLinkTroubles, LostConnectionAndReturn)
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

TEST(OpenIGTLinkTroubles, WhatIsNotOpenIGTLinkIsSaid)
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

TEST(OpenIGTLinkTroubles, HostsThatAreNotThere)
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

TEST(OpenIGTLinkTroubles, StopsWithinASecondWhateverItDoes)
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

TEST(OpenIGTLinkTroubles, AComplaintIsShownForTenSeconds)
{
  SkippingClock clock;
  clock.Skipped =
    5000; // so late that ten seconds and twice the time of the complaint are not alike
  Server server;
  const auto device =
    MakeOpenIGTLinkPoseFactory(server.GetAddress("?transform=Probe"), 1, clock)(Always);
  device->SetUp();
  ASSERT_TRUE(server.Accept());
  std::vector<TrackedPose> poses;
  server.Send(StatusBytes(18, "Failure", "coil") + TransformBytes(AsymmetricPose(), "Probe", 1));
  ASSERT_TRUE(device->Poll(poses));
  EXPECT_HAS(device->GetWarning(), "reports status 18");
  clock.Skipped = clock.Skipped + 8;
  server.Send(TransformBytes(AsymmetricPose(1), "Probe", 9));
  ASSERT_TRUE(device->Poll(poses));
  EXPECT_HAS(device->GetWarning(), "reports status 18");
  clock.Skipped = clock.Skipped + 4;
  server.Send(TransformBytes(AsymmetricPose(2), "Probe", 13));
  ASSERT_TRUE(device->Poll(poses));
  EXPECT_EQ(device->GetWarning().find("reports status 18"), std::string::npos)
    << device->GetWarning();
}
