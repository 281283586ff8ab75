// SPDX-License-Identifier: BSD-3-Clause
// The whole of a live acquisition in real time: an emulated FASTRAK with damage behind the real
// libserialport, an emulated scanner's video through the network, every frame a slice and recorded.
// The devices are a process of their own, so that what the acquisition takes can be measured.
#include "lacunaDeviceChoice.h"
#include "lacunaExecution.h"
#include "lacunaPseudoTerminal.h"
#include "lacunaSequenceHeader.h"
#include "lacunaSweepAcquisition.h"
#include "lacunaTestDevice.h"
#include "lacunaTestPairing.h"
#include "lacunaTestPort.h"
#include "lacunaTestStall.h"
#include "lacunaTestUnit.h"
#include "lacunaUltrasoundEmulator.h"
#include "lacunaVideoSender.h"
#include "lacunaVideoService.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <fstream>
#include <new>
#include <thread>

#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>

using namespace lacuna;
using namespace lacunaTest;

namespace
{
constexpr double Latency = 0.04; // s of the video
constexpr double Rate = 25;
constexpr std::int64_t MostFrames = 20000;
constexpr std::size_t Bits = 20; // of a frame's number, as blocks in its topmost lines
constexpr int Block = 16;        // pixels
constexpr double HalfFrame = 0.5 / Rate;

// What both processes know; times are of the computer's one clock.
struct Account
{
  std::atomic<bool> Ready{ false };
  std::atomic<bool> Ended{ false };
  std::atomic<std::int64_t> Sent{ 0 };                    // frames
  std::array<std::atomic<double>, MostFrames> DueTimes{}; // when they were to be sent
  std::atomic<double> Stall{ 0 };
};

void WriteNumber(std::int64_t number, int columns, std::uint8_t* pixels)
{
  for (std::size_t bit = 0; bit < Bits; ++bit)
  {
    for (int row = 0; row < Block; ++row)
    {
      std::fill_n(pixels + row * columns + bit * Block, Block,
        static_cast<std::uint8_t>(number >> bit & 1 ? 240 : 16));
    }
  }
}

// Of a frame's first line.
std::int64_t ReadNumber(const std::uint8_t* pixels)
{
  std::int64_t number = 0;
  for (std::size_t bit = 0; bit < Bits; ++bit)
  {
    number |= std::int64_t{ pixels[bit * Block + Block / 2] > 128 } << bit;
  }
  return number;
}

// Frame n shows where the probe was when it was due, less the latency.
void SendVideo(const std::string& url, Account& account)
{
  const SteadyClock clock;
  const auto stopped = [&] { return account.Ended.load(); };
  const UltrasoundEmulator emulator(MakePhantomScene(Anatomy::Ellipsoids, 1), {});
  const double begin = clock.Now();
  const EmulatedProbe probe(lacunaTest::Sweep, 1, emulator.GetScreen().GetImageToFace(),
    emulator.GetScreen().GetLayout().Depth, begin);
  VideoSenderSettings settings;
  settings.URL = url;
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(settings.Columns) * settings.Rows);
  VideoSender sender(settings, stopped);
  account.Ready = true;
  sender.Open();
  const double first = clock.Now() + 0.1;
  for (std::int64_t number = 0; number < MostFrames; ++number)
  {
    const double due = first + static_cast<double>(number) / Rate;
    emulator.Render(probe.ImageToScene(due - Latency), due, number, pixels.data());
    WriteNumber(number, settings.Columns, pixels.data());
    while (clock.Now() < due)
    {
      std::this_thread::sleep_for(std::chrono::duration<double>(due - clock.Now()));
    }
    account.DueTimes[static_cast<std::size_t>(number)] = due;
    if (!sender.Send(pixels.data(), number))
    {
      return;
    }
    account.Sent = number + 1;
  }
}

// A process with both devices; ended and waited for in the end.
class DeviceProcess
{
public:
  DeviceProcess()
  {
    void* memory =
      mmap(nullptr, sizeof(Account), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    this->Shared = new (memory) Account;
    this->Child = fork();
    if (this->Child == 0)
    {
      this->Run();
    }
  }
  ~DeviceProcess()
  {
    this->Stop();
    munmap(this->Shared, sizeof(Account));
  }
  DeviceProcess(const DeviceProcess&) = delete;
  DeviceProcess& operator=(const DeviceProcess&) = delete;

  void Stop()
  {
    this->Shared->Ended = true;
    if (this->Child > 0)
    {
      waitpid(this->Child, nullptr, 0);
      this->Child = 0;
    }
  }
  std::string GetTracker() const { return GetPort(this->Place / "tracker"); }
  const std::string& GetURL() const { return this->URL; }
  const Account& GetAccount() const { return *this->Shared; }

private:
  [[noreturn]] void Run()
  {
    try
    {
      const StallWatch watch;
      FastrakEmulatorOptions options;
      options.Baud = 115200;
      options.Faults.Changed = 0.01;
      const EmulatedUnit unit(this->Place / "tracker", options, lacunaTest::Sweep);
      try
      {
        SendVideo(this->URL, *this->Shared);
      }
      catch (const Aborted&)
      {
      }
      this->Shared->Stall = watch.GetLongest();
    }
    catch (const std::exception& e)
    {
      std::cerr << "the devices: " << e.what() << "\n";
    }
    std::_Exit(0);
  }

  const Folder Place;
  const std::string URL = FreeAddress();
  Account* Shared = nullptr;
  pid_t Child = 0;
};

double GetCpu()
{
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time)
  { return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// mm that a pose is off the motion's at a time; how fast that is in s.
struct PoseCheck
{
  double Off = 0;
  double Speed = 0;
};

PoseCheck Check(const AcquiredSlice& slice, double time)
{
  constexpr double acceleration = 350; // of Sweep, mm/s^2
  constexpr double step = 0.001;
  const auto at = [](double t) { return lacunaTest::Sweep(t, 1).Column(3); };
  PoseCheck check;
  check.Off =
    Norm(slice.ProbeToTracker.Column(3) - at(time)) - acceleration * slice.Gap * slice.Gap / 8;
  check.Speed = Norm(at(time + step) - at(time - step)) / (2 * step);
  return check;
}

struct Spread
{
  std::vector<double> Values;
  double At(double part)
  {
    std::sort(this->Values.begin(), this->Values.end());
    return this->Values.empty()
      ? 0
      : this->Values[static_cast<std::size_t>(part * static_cast<double>(this->Values.size() - 1))];
  }
};

std::ostream& operator<<(std::ostream& out, Spread& spread)
{
  return out << spread.At(0.5) << " (99 %: " << spread.At(0.99) << ", most " << spread.At(1) << ")";
}

// The recording holds these frames, each with its pose, and nothing else.
void CheckRecording(const std::string& path, std::int64_t first, std::int64_t count)
{
  const SequenceHeader header = ReadSequenceHeader(path);
  ASSERT_EQ(header.Frames, count);
  ASSERT_EQ(header.GetFrameSize(), 768 * 576);
  std::ifstream file(header.DataFileName, std::ios::binary);
  std::vector<char> line(Bits * Block);
  const auto& status = header.FrameFields.at("SliceStatus");
  for (std::int64_t i = 0; i < count; ++i)
  {
    file.seekg(header.DataOffset + i * header.GetFrameSize());
    file.read(line.data(), static_cast<std::streamsize>(line.size()));
    ASSERT_TRUE(file.good()) << i;
    ASSERT_EQ(ReadNumber(reinterpret_cast<const std::uint8_t*>(line.data())), first + i);
    ASSERT_EQ(status[static_cast<std::size_t>(i)], "0") << i;
  }
}
}

class LiveSoak : public testing::TestWithParam<double>
{
};

TEST_P(LiveSoak, NoFrameIsLostOrMispaired)
{
  const Folder folder;
  const auto frames = static_cast<std::int64_t>(Rate * GetParam());
  ASSERT_LT(frames, MostFrames - 500);
  if (std::filesystem::space(folder.GetPath()).available <
    static_cast<std::uintmax_t>(1.2 * 768 * 576) * static_cast<std::uintmax_t>(frames))
  {
    GTEST_SKIP() << "no room for the recording";
  }
  DeviceProcess process; // before there are threads
  const SteadyClock clock;
  for (int i = 0; i < 3000 && !process.GetAccount().Ready; ++i)
  {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  TrackerChoice tracker;
  tracker.Connection = process.GetTracker();
  VideoSettings video;
  video.URL = process.GetURL();
  AcquisitionDevices devices;
  devices.Poses = ChoosePoseDevice(tracker, clock);
  devices.Frames = ChooseFrameDevice(video, clock);
  devices.VideoLatency = Latency;
  devices.RetryTime = 0.1;
  AcquisitionRules rules;
  rules.Mode = CaptureMode::EveryFrame;
  rules.SpeedLimit = 0;
  rules.RecordFileName = folder / "soak.mhd";
  const double epoch = clock.Now();
  auto acquisition = std::make_unique<SweepAcquisition>(devices, rules, clock);
  const auto works = [&]
  {
    const AcquisitionState state = acquisition->GetState();
    return state.TrackerWorks && state.VideoWorks;
  };
  while (!works() && clock.Now() < epoch + 30)
  {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ASSERT_TRUE(works());
  std::this_thread::sleep_for(std::chrono::milliseconds(500));

  const StallWatch watch;
  const AcquisitionState before = acquisition->GetState();
  const double cpu = GetCpu();
  const double begin = clock.Now();
  std::int64_t first = -1;
  std::int64_t count = 0;
  int lost = 0;
  int mispaired = 0;
  Spread delays;   // ms from a frame's arrival to its slice
  Spread requests; // ms from the request for the first measurement that its pose needs
  Spread late;     // ms from when a frame was due to its arrival
  Spread off;      // ms of the motion between a slice's instant and its pose
  acquisition->Start();
  const auto take = [&]
  {
    for (const AcquiredSlice& slice : acquisition->TakeSlices())
    {
      const std::int64_t number = ReadNumber(slice.Pixels->data());
      first = first < 0 ? number : first;
      lost += static_cast<int>(number - first - count);
      count = number - first + 1;
      if (slice.Status != 0)
      {
        ++lost;
        continue;
      }
      const double instant = epoch + slice.Timestamp;
      const double due = process.GetAccount().DueTimes[static_cast<std::size_t>(number)];
      const PoseCheck check = Check(slice, instant);
      const double arrived = instant + Latency - due;
      const bool right = std::abs(arrived) < HalfFrame && check.Off < 0.2 + HalfFrame * check.Speed;
      mispaired += right ? 0 : 1;
      delays.Values.push_back(1000 * slice.Delay);
      requests.Values.push_back(1000 * (slice.Delay + 0.0035 + slice.Gap));
      late.Values.push_back(1000 * arrived);
      if (check.Speed > 50)
      {
        off.Values.push_back(1000 * std::max(check.Off, 0.0) / check.Speed);
      }
    }
  };
  while (clock.Now() < begin + GetParam())
  {
    std::this_thread::sleep_for(std::chrono::milliseconds(40)); // as ParaView polls
    take();
  }
  const double time = clock.Now() - begin;
  const double used = 100 * (GetCpu() - cpu) / time;
  acquisition->Stop();
  take();
  const AcquisitionState after = acquisition->GetState();
  acquisition->BeginSweep(); // writes what waits
  acquisition.reset();
  process.Stop();
  const auto records = static_cast<double>(after.Poses.Poses - before.Poses.Poses);
  const auto damaged = static_cast<double>(after.Poses.Damaged - before.Poses.Damaged);
  const double stall = std::max<double>(watch.GetLongest(), process.GetAccount().Stall);
  std::cout << count << " frames in " << time << " s, " << lost << " lost, " << mispaired
            << " mispaired; " << records / time << " records a second, "
            << 100 * damaged / (records + damaged)
            << " % of the answers damaged; ms: slice after frame " << delays
            << ", after the request " << requests << ", frame after it was due " << late
            << ", pose off by the motion of " << off << "; " << used
            << " % of one core; longest stall of this computer " << 1000 * stall << " ms\n";
  if (!KeepsTime)
  {
    GTEST_SKIP() << "the sanitizer makes frames late";
  }
  if ((lost > 0 || mispaired > 0) && stall > HalfFrame)
  {
    GTEST_SKIP() << "no verdict: this computer stood still for longer than half a frame";
  }
  EXPECT_EQ(lost, 0);
  EXPECT_EQ(mispaired, 0);
  EXPECT_GT(static_cast<double>(count), 0.95 * Rate * GetParam());
  EXPECT_EQ(after.Counts.Slices, count);
  EXPECT_EQ(after.Counts.Frames, count);
  EXPECT_EQ(after.Missing, 0);
  EXPECT_GT(damaged, 0.1 * records);
  CheckRecording(folder / "soak.mhd", first, count);
}

INSTANTIATE_TEST_SUITE_P(Short, LiveSoak, testing::Values(4.0));
INSTANTIATE_TEST_SUITE_P(Soak, LiveSoak, testing::Values(600.0));
