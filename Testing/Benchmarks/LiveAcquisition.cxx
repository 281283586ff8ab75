// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a live acquisition takes: an emulated FASTRAK behind the real libserialport, at 115200 baud,
/// and a test signal of FFmpeg of 768 x 576 at 25 frames a second, every frame a slice.
///
/// Counters: slices a second, records a second of the tracker; delay, ms from a frame's arrival until
/// its slice with its pose is there (median, 99 %, most); request, the same from the request for the
/// earliest measurement that its pose needs, at the latest; load, % of one core of all threads but the
/// emulator's, with the making of the test signal (signal: 0 a grey field, which costs next to
/// nothing as a frame grabber does, 1 a picture that FFmpeg draws); lost, frames without a pose.
#include "lacunaBenchmark.h"
#include "lacunaDeviceChoice.h"
#include "lacunaPoseScript.h"
#include "lacunaSweepAcquisition.h"
#include "lacunaTestUnit.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <pthread.h>

using namespace lacuna;
using namespace lacunaTest;

namespace
{
double GetCpu(clockid_t clock)
{
  timespec time = {};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void Sleep(double seconds)
{
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

void Live(benchmark::State& state)
{
  const auto seconds = static_cast<double>(state.range(0));
  const std::string signal = state.range(1) == 0 ? "color=gray:" : "testsrc2=";
  std::string folder =
    (std::filesystem::temp_directory_path() / "lacuna-live-benchmark-XXXXXX").string();
  if (!mkdtemp(folder.data()))
  {
    state.SkipWithError("no folder for the emulator's port");
    return;
  }
  const SteadyClock clock;
  {
    FastrakEmulatorOptions options;
    options.Baud = 115200;
    EmulatedUnit unit(folder + "/tracker", options, EverydaySweep);
    clockid_t emulator = 0;
    pthread_getcpuclockid(unit.Thread.native_handle(), &emulator);
    TrackerChoice tracker;
    tracker.Connection = GetPort(folder + "/tracker");
    VideoSettings video;
    video.URL = "lavfi:" + signal + "size=768x576:rate=25,format=gray";
    AcquisitionDevices devices;
    devices.Poses = ChoosePoseDevice(tracker, clock);
    devices.Frames = ChooseFrameDevice(video, clock);
    AcquisitionRules rules;
    rules.Mode = CaptureMode::EveryFrame;
    SweepAcquisition acquisition(devices, rules, clock);
    while (!acquisition.GetState().TrackerWorks || !acquisition.GetState().VideoWorks)
    {
      Sleep(0.01);
    }
    Sleep(0.5);
    for (auto _ : state)
    {
      acquisition.Start();
      const AcquisitionState before = acquisition.GetState();
      const double own = GetCpu(CLOCK_PROCESS_CPUTIME_ID) - GetCpu(emulator);
      const double begin = clock.Now();
      std::vector<double> delays;
      std::vector<double> requests;
      while (clock.Now() < begin + seconds)
      {
        Sleep(0.04); // as ParaView polls
        for (const AcquiredSlice& slice : acquisition.TakeSlices())
        {
          delays.push_back(1000 * slice.Delay);
          requests.push_back(1000 * (slice.Delay + 0.0035 + slice.Gap));
        }
      }
      const double time = clock.Now() - begin;
      const double cpu = GetCpu(CLOCK_PROCESS_CPUTIME_ID) - GetCpu(emulator) - own;
      acquisition.Stop();
      const AcquisitionState after = acquisition.GetState();
      if (delays.empty())
      {
        state.SkipWithError("no slices");
        return;
      }
      std::sort(delays.begin(), delays.end());
      std::sort(requests.begin(), requests.end());
      const auto at = [](const std::vector<double>& sorted, double part)
      { return sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))]; };
      state.counters["slices"] = static_cast<double>(delays.size()) / time;
      state.counters["records"] =
        static_cast<double>(after.Poses.Poses - before.Poses.Poses) / time;
      state.counters["delay50"] = at(delays, 0.5);
      state.counters["delay99"] = at(delays, 0.99);
      state.counters["delayMost"] = delays.back();
      state.counters["request50"] = at(requests, 0.5);
      state.counters["request99"] = at(requests, 0.99);
      state.counters["load"] = 100 * cpu / time;
      state.counters["lost"] = static_cast<double>(after.Counts.WithoutPose);
    }
  }
  std::filesystem::remove_all(folder);
}
}

BENCHMARK(Live)
  ->ArgNames({ "seconds", "signal" })
  ->ArgsProduct({ { 1, 30 }, { 0, 1 } })
  ->Iterations(1)
  ->Apply(lacunaBenchmark::Measure);
BENCHMARK_MAIN();
