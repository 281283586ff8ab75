// SPDX-License-Identifier: BSD-3-Clause
// Both devices as an acquisition has them: the tracker on a serial port, the video from the network.
#include "lacunaAtomicFile.h"
#include "lacunaCalibrationFile.h"
#include "lacunaFastrakTracker.h"
#include "lacunaPoseTrack.h"
#include "lacunaPseudoTerminal.h"
#include "lacunaSerialPort.h"
#include "lacunaTestDevice.h"
#include "lacunaTestPort.h"
#include "lacunaTestStall.h"
#include "lacunaUltrasoundEmulator.h"
#include "lacunaVideoService.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <thread>

using namespace lacuna;
using namespace lacunaTest;

namespace
{
constexpr double Latency = 0.08; // s; at 80 mm/s and more it is millimetres
constexpr double Aim = 2.7;
// s. The emulator answers a request when this computer lets it, and the FASTRAK at once: an answer
// that took longer may be of a later instant than the driver takes it to be. 8 ms are usual.
constexpr double RoundTrip = 0.012;
constexpr double MaximumGap = 0.06; // s between poses

constexpr double Acceleration = 500; // mm/s^2, of the image's corners

// To and fro through the scene within 80 mm/s.
Matrix4 Shake(double time, int)
{
  return Matrix4::Translation({ 250 + 6 * std::sin(1.9 * time), 18 * std::sin(4 * time),
           -90 + 5 * std::cos(2.2 * time) }) *
    FastrakRotation(
      Vec3{ 8 * std::sin(1.3 * time), 6 * std::cos(1.7 * time), 5 * std::sin(2.1 * time) });
}

struct Recorded
{
  VideoFrame Frame;
  std::optional<PoseAtInstant> Pose;
};

// Both emulators with one time.
class Devices
{
public:
  Devices()
    : Emulator(MakePhantomScene(Anatomy::Ellipsoids, 1), Settings())
    , Probe(Shake, 1, this->Emulator.GetScreen().GetImageToFace(), 60, Aim)
    , Begin(this->Time.Now())
    , Service(
        this->Emulator, this->Probe, this->Time, this->Video(), [this] { return this->Done(); })
    , Fastrak([this](double time, int station) { return Shake(time - this->Begin, station); },
        this->Options())
    , TrackerThread(
        [this] { this->Terminal.Serve(this->Fastrak, [this] { return this->Done(); }); })
    , VideoThread(
        [this]
        {
          this->Service.Run(
            this->Begin, [this](const VideoServiceCounts& counts) { this->Counts = counts; });
        })
  {
  }
  ~Devices() { this->Stop(); }
  Devices(const Devices&) = delete;
  Devices& operator=(const Devices&) = delete;

  void Stop()
  {
    this->Stopped = true;
    for (std::thread* thread : { &this->TrackerThread, &this->VideoThread })
    {
      if (thread->joinable())
      {
        thread->join();
      }
    }
  }
  bool Done() const { return this->Stopped; }
  static UltrasoundSettings Settings()
  {
    UltrasoundSettings settings;
    settings.SpeckleLevel = 0;
    return settings;
  }
  VideoServiceSettings Video()
  {
    VideoServiceSettings settings;
    settings.Sender.URL = this->URL;
    settings.Latency = Latency;
    return settings;
  }
  static FastrakEmulatorOptions Options()
  {
    FastrakEmulatorOptions options;
    options.Baud = 115200;
    return options;
  }

  const std::string URL = FreeAddress();
  const SteadyClock Time;
  const Folder Place;
  PseudoTerminal Terminal{ this->Place / "tracker" };
  UltrasoundEmulator Emulator;
  EmulatedProbe Probe;
  VideoServiceCounts Counts;
  const double Begin;

private:
  std::atomic<bool> Stopped{ false };
  VideoService Service;
  FastrakEmulator Fastrak;
  std::thread TrackerThread;
  std::thread VideoThread;
};

// Reads frames and gives each its pose.
std::vector<Recorded> Record(Devices& devices, std::size_t count, double& offset)
{
  std::mutex mutex;
  PoseTrack track(60, MaximumGap);
  std::atomic<bool> ended{ false };
  SerialPort port("/dev/../../.." + devices.Terminal.GetName(), 115200);
  FastrakTracker tracker(port, devices.Time);
  tracker.SetUp();
  std::thread polling(
    [&]
    {
      std::vector<TrackedPose> poses;
      while (!ended)
      {
        poses.clear();
        tracker.Poll(poses);
        const std::lock_guard<std::mutex> lock(mutex);
        for (const TrackedPose& pose : poses)
        {
          if (pose.Arrival - pose.Request < RoundTrip)
          {
            track.Add(pose);
          }
        }
      }
    });
  std::this_thread::sleep_for(std::chrono::milliseconds(300)); // poses before the first frame
  std::vector<Recorded> recorded(count);
  VideoSettings settings;
  settings.URL = devices.URL;
  {
    VideoSource source(settings, devices.Time);
    offset = 1e9; // of the stream's clock: its quickest frame
    for (Recorded& each : recorded)
    {
      EXPECT_EQ(source.Read(each.Frame), VideoEvent::Frame);
      offset = std::min(offset, each.Frame.Arrival - each.Frame.StreamTime.value());
    }
    const double frames =
      25 * (recorded.back().Frame.StreamTime.value() - recorded.front().Frame.StreamTime.value()) +
      1;
    EXPECT_NEAR(static_cast<double>(count + source.GetCounts().Missing), frames, 0.1);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(200)); // poses of the last one
  ended = true;
  polling.join();
  for (Recorded& each : recorded)
  {
    each.Pose = track.At(offset + each.Frame.StreamTime.value() - Latency);
  }
  return recorded;
}

// Mean difference of a frame, or its mirror image, from the scene at a pose, levels.
double Compare(const Devices& devices, const VideoFrame& frame, const Matrix4& imageToScene,
  bool mirrored = false)
{
  double sum = 0;
  double count = 0;
  const auto& runs = devices.Emulator.GetScreen().GetRuns();
  for (std::size_t i = 0; i < runs.size(); i += 5)
  {
    for (int column = runs[i].First; column <= runs[i].Last; column += 5)
    {
      const int seen = mirrored ? runs[i].First + runs[i].Last - column : column;
      const double level = devices.Emulator.GetScene().Value(
        imageToScene.Point({ static_cast<double>(column), static_cast<double>(runs[i].Row), 0 }));
      sum += std::abs(frame.Grey[static_cast<std::size_t>(768 * runs[i].Row + seen)] - level);
      ++count;
    }
  }
  return sum / count;
}
}

TEST(EmulatedAcquisition, SlicesAreOfThePlaceThatTheirPosesSay)
{
  Devices devices;
  const std::string file = devices.Place / "calibration.xml";
  WriteFileAtomically(file, devices.Probe.FormatCalibration());
  const std::vector<NamedTransform> known = ReadCalibrationFile(file);
  const Matrix4 imageToProbe = known[0].Matrix;
  const Matrix4 trackerToScene = known[1].Matrix;

  std::vector<Recorded> recorded;
  int without = 0;
  for (int client = 0; client < 10 && recorded.size() < 70; ++client)
  {
    double offset = 0;
    for (Recorded& each : Record(devices, 100, offset))
    {
      if (each.Pose) // else this computer had too much to do
      {
        recorded.push_back(std::move(each));
      }
      else
      {
        ++without;
      }
    }
    EXPECT_NEAR(offset, devices.Begin, 0.02);
  }
  devices.Stop();
  ASSERT_GE(recorded.size(), 70u);
  if (!KeepsTime)
  {
    GTEST_SKIP() << "the sanitizer makes frames late";
  }
  int seen = 0;
  double right = 0;
  double late = 0;
  double mirrored = 0;
  std::vector<double> distances;
  for (const Recorded& each : recorded)
  {
    const double shown = each.Frame.StreamTime.value() - Latency;
    const Matrix4 pose = trackerToScene * each.Pose->ReceiverToTransmitter * imageToProbe;
    for (const Vec3& corner : { Vec3{ 0, 0, 0 }, Vec3{ 767, 0, 0 }, Vec3{ 0, 575, 0 } })
    {
      const Vec3 off = pose.Point(corner) - devices.Probe.ImageToScene(shown).Point(corner);
      const double straight = Acceleration * each.Pose->Gap * each.Pose->Gap / 8;
      distances.push_back(Norm(off) - straight);
    }
    const double difference = Compare(devices, each.Frame, pose);
    EXPECT_LT(difference, 1.5);
    if (Compare(devices, each.Frame, Matrix4::Translation({ 500, 0, 0 })) > 4) // not tissue alone
    {
      ++seen;
      right += difference;
      late += Compare(devices, each.Frame, devices.Probe.ImageToScene(shown + Latency));
      mirrored += Compare(devices, each.Frame, pose, true);
    }
  }
  std::sort(distances.begin(), distances.end());
  const double usual = distances[distances.size() / 2];
  EXPECT_LT(usual, 0.2); // mm; 6 without the latency
  EXPECT_LT(distances.back(), 0.6);
  EXPECT_GT(seen, 20);
  EXPECT_LT(right, 0.1 * late) << right / seen << " " << late / seen;
  EXPECT_LT(right, 0.02 * mirrored) << right / seen << " " << mirrored / seen;
  std::printf(
    "%d frames: corners %.2f mm off (at most %.2f), mean difference %.2f levels, with the latency "
    "ignored %.2f, mirrored %.2f; %d frames without pose\n",
    seen, usual, distances.back(), right / seen, late / seen, mirrored / seen, without);
}
