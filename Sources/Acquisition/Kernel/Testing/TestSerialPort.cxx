// SPDX-License-Identifier: BSD-3-Clause
// The real libserialport, over a pseudo-terminal to the emulator, in real time.
#include "lacunaClock.h"
#include "lacunaFastrakTracker.h"
#include "lacunaSerialPort.h"
#include "lacunaTestDevice.h"
#include "lacunaTestPairing.h"
#include "lacunaTestStall.h"
#include "lacunaTestUnit.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <thread>

#include <sys/stat.h>
#include <unistd.h>

using namespace lacuna;
using namespace lacunaTest;

namespace
{
Matrix4 Pose(double time, int station)
{
  return Matrix4::Translation({ 200.0 * station + 20 * std::sin(time), 30 * std::cos(time), -50 }) *
    FastrakRotation(Vec3{ 10 * std::sin(time), 20, 30 });
}

// An emulated unit that is plugged in.
struct Unit : public EmulatedUnit
{
  explicit Unit(const std::string& link, const FastrakEmulatorOptions& options = {},
    FastrakEmulator::PoseScript script = Pose)
    : EmulatedUnit(link, options, std::move(script))
  {
  }
};

FastrakEmulatorOptions Baud(int baud)
{
  FastrakEmulatorOptions options;
  options.Baud = baud;
  return options;
}

// Polls until there are so many poses, for at most a minute: a busy computer may miss some.
std::vector<TrackedPose> Follow(FastrakTracker& tracker, std::size_t count)
{
  const SteadyClock clock;
  const double begin = clock.Now();
  std::vector<TrackedPose> poses;
  while (poses.size() < count && clock.Now() < begin + 60)
  {
    tracker.Poll(poses);
  }
  return poses;
}
}

TEST(SerialPort, TheDriverFollowsTheEmulatorThroughTheRealLibrary)
{
  const Folder folder;
  for (const int baud : { 19200, 115200 })
  {
    const Unit unit(folder / "tracker", Baud(baud));
    SerialPort port(GetPort(folder / "tracker"), baud);
    const SteadyClock clock;
    FastrakTracker tracker(port, clock);
    tracker.SetUp();
    EXPECT_TRUE(tracker.GetStatus().Binary);
    const std::vector<TrackedPose> poses = Follow(tracker, 100);
    ASSERT_GE(poses.size(), 100u);
    for (const TrackedPose& pose : poses)
    {
      // the emulator's instant is when it saw the request, a little after it was written
      const double late = 40 * (pose.Arrival - pose.Request);
      EXPECT_LT(Distance(pose.ReceiverToTransmitter, Pose(pose.Time, 1)), 2e-4 + late);
      EXPECT_GE(pose.Arrival - pose.Request, 28 * 10.0 / baud); // 1 byte there, 27 back
    }
    std::cout << baud << " baud: " << 99 / (poses.back().Request - poses.front().Request)
              << " records a second\n";
  }
}

// As the soak in simulated time, but through the system and in real time: minutes.
class SerialPortSoak : public testing::TestWithParam<double>
{
};

TEST_P(SerialPortSoak, NoFrameIsLostOrMispaired)
{
  const Folder folder;
  FastrakEmulatorOptions options = Baud(115200);
  options.Faults.Changed = 0.01;
  const Unit unit(folder / "tracker", options, Sweep);
  SerialPort port(GetPort(folder / "tracker"), 115200);
  FastrakSettings settings;
  settings.Layout = FastrakLayout::FromNumbers({ 2, 4, 2, 4 });
  settings.Motion = { 600, 6, 0.1, 0.001 };
  const SteadyClock clock;
  FastrakTracker tracker(port, clock, settings);
  tracker.SetUp();
  const StallWatch watch;
  const Pairing pairing = PairFrames(tracker, clock, GetParam());
  const auto counts = tracker.GetCounts();
  std::cout << pairing.Frames << " frames, " << pairing.Lost << " lost, worst " << pairing.Worst
            << " mm; " << counts.Requests << " requests, " << counts.Damaged
            << " damaged answers, latest " << 1000 * pairing.Late << " ms, longest stall "
            << 1000 * watch.GetLongest() << " ms\n";
  if (pairing.Lost > 0 && watch.GetLongest() > 0.05)
  {
    GTEST_SKIP() << "no verdict: this computer stood still for longer than a frame";
  }
  EXPECT_EQ(pairing.Lost, 0);
  // the emulator sees a request, and so takes its sample, as late as this computer makes it
  EXPECT_LT(pairing.Worst, 0.05 + 170 * pairing.Late);
  EXPECT_GT(counts.Damaged, counts.Requests / 10);
}

INSTANTIATE_TEST_SUITE_P(Soak, SerialPortSoak, testing::Values(600.0));

TEST(SerialPort, WrongBaudRateIsSaid)
{
  const Folder folder;
  const Unit unit(folder / "tracker", Baud(9600));
  SerialPort port(GetPort(folder / "tracker"), 115200);
  const SteadyClock clock;
  FastrakTracker tracker(port, clock);
  // the unit does not understand either: whether it answers at all is chance
  std::string text;
  try
  {
    tracker.SetUp();
  }
  catch (const TrackerError& e)
  {
    text = e.what();
  }
  EXPECT_HAS(text, "115200 baud");
  EXPECT_HAS(text, "baud rate");
}

TEST(SerialPort, UnpluggedAndPluggedInAgain)
{
  const Folder folder;
  auto unit = std::make_unique<Unit>(folder / "tracker", Baud(115200));
  const SteadyClock clock;
  {
    SerialPort port(GetPort(folder / "tracker"), 115200);
    FastrakTracker tracker(port, clock);
    tracker.SetUp();
    std::vector<TrackedPose> poses = Follow(tracker, 1);
    EXPECT_FALSE(poses.empty());
    unit.reset();
    const double begin = clock.Now();
    const std::string gone = Complaint<ChannelError>(ChannelError::Kind::Unplugged,
      [&]
      {
        while (clock.Now() < begin + 20)
        {
          tracker.Poll(poses);
        }
      });
    EXPECT_LT(clock.Now(), begin + 5);
    EXPECT_HAS(gone, "plug its adapter in again");
    EXPECT_HAS(gone, "/tracker");
    // also for one that only listens
    char byte = 0;
    Complaint<ChannelError>(ChannelError::Kind::Unplugged, [&] { port.Read(&byte, 1, 10); });
    EXPECT_LT(clock.Now(), begin + 5);
  }
  EXPECT_HAS(Complaint<ChannelError>(ChannelError::Kind::NotFound,
               [&] { SerialPort again(GetPort(folder / "tracker"), 115200); }),
    "There is no port");
  unit = std::make_unique<Unit>(folder / "tracker", Baud(115200));
  SerialPort port(GetPort(folder / "tracker"), 115200);
  FastrakTracker tracker(port, clock);
  tracker.SetUp();
  EXPECT_FALSE(Follow(tracker, 1).empty());
}

TEST(SerialPort, SaysWhyItCannotBeOpened)
{
  for (const char* name : { "/dev/ttyLacunaNone", "COM7", "", "/etc/passwd", "/dev/null" })
  {
    const std::string text =
      Complaint<ChannelError>(ChannelError::Kind::NotFound, [&] { SerialPort port(name, 19200); });
    EXPECT_HAS(text, "There is no port " + std::string(name));
    EXPECT_EQ(text.find("such a file is there") != text.npos, name == std::string("/etc/passwd"));
    EXPECT_HAS(text, SerialPort::List().empty() ? "no serial port now" : SerialPort::List()[0]);
  }
  const Folder folder;
  const PseudoTerminal terminal(folder / "tracker");
  const std::string name = GetPort(folder / "tracker");
  const std::string device = std::filesystem::canonical(terminal.GetName());
  ASSERT_EQ(chmod(device.c_str(), 0), 0);
  {
    const AsUser user;
    EXPECT_HAS(Complaint<ChannelError>(
                 ChannelError::Kind::Permission, [&] { SerialPort port(name, 19200); }),
      "adduser");
  }
  ASSERT_EQ(chmod(device.c_str(), 0666), 0);
  for (const int baud : { 0, -5 })
  {
    EXPECT_HAS(Complaint<ChannelError>(
                 ChannelError::Kind::Unsupported, [&] { SerialPort port(name, baud); }),
      "positive, not " + std::to_string(baud));
  }
  SerialPort port(name, 19200);
  EXPECT_HAS(
    Complaint<ChannelError>(ChannelError::Kind::Busy, [&] { SerialPort second(name, 19200); }),
    "end the other program");
}

TEST(SerialPort, OnlyOneProgramHasIt)
{
  const Folder folder;
  const PseudoTerminal terminal(folder / "tracker");
  const std::string name = GetPort(folder / "tracker");
  const std::string device = std::filesystem::canonical(terminal.GetName());
  ASSERT_EQ(chmod(device.c_str(), 0666), 0);
  const AsUser user; // root may always open
  for (int i = 0; i < 2; ++i)
  {
    const SerialPort port(name, 19200);
    Complaint<ChannelError>(ChannelError::Kind::Busy, [&] { SerialPort second(name, 19200); });
  }
}

TEST(SerialPort, WaitsNoLongerThanTold)
{
  const Folder folder;
  const PseudoTerminal terminal(folder / "tracker");
  SerialPort port(GetPort(folder / "tracker"), 19200);
  const SteadyClock clock;
  std::array<char, 10> bytes{};
  for (const double seconds : { 0.0, 0.0001, 0.2 })
  {
    const double begin = clock.Now();
    EXPECT_EQ(port.Read(bytes.data(), bytes.size(), seconds), 0u);
    EXPECT_GE(clock.Now() - begin, seconds);
    EXPECT_LT(clock.Now() - begin, seconds + 5);
  }
}

TEST(PseudoTerminal, KeepsFilesThatHaveTheNameOfItsLink)
{
  const Folder folder;
  const std::string link = folder / "tracker";
  std::filesystem::create_symlink("/dev/pts/nowhere", link); // left over
  {
    const PseudoTerminal terminal(link);
    EXPECT_EQ(terminal.GetName(), link);
    EXPECT_TRUE(std::filesystem::exists(link));
    EXPECT_HAS(
      Complaint<ChannelError>(ChannelError::Kind::Other, [&] { PseudoTerminal second(link); }),
      "tracker");
    EXPECT_TRUE(std::filesystem::exists(link));
  }
  EXPECT_FALSE(std::filesystem::is_symlink(link));
  std::filesystem::create_directory(link);
  Complaint<ChannelError>(ChannelError::Kind::Other, [&] { PseudoTerminal second(link); });
  EXPECT_TRUE(std::filesystem::is_directory(link));
}
