// SPDX-License-Identifier: BSD-3-Clause
// A FASTRAK without hardware, on a pseudo-terminal, and the video of a scanner.
#include "lacunaAtomicFile.h"
#include "lacunaClock.h"
#include "lacunaEmulatorSettings.h"
#include "lacunaPseudoTerminal.h"

#include <algorithm>
#include <atomic>
#include <cctype>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

namespace
{
volatile std::sig_atomic_t interrupted = 0;

void Interrupt(int)
{
  interrupted = 1;
}

lacuna::UltrasoundSettings GetPicture(const lacuna::EmulatorSettings& settings)
{
  lacuna::UltrasoundSettings picture = settings.Video.Picture;
  picture.Seed = settings.Options.Seed;
  picture.Layout.Title = "LACUNA EMULATOR  ";
  for (const char c : settings.Video.Scene)
  {
    picture.Layout.Title += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return picture;
}

int GetStation(const lacuna::EmulatorSettings& settings)
{
  const auto& receivers = settings.Options.Receivers;
  return 1 +
    static_cast<int>(std::find(receivers.begin(), receivers.end(), true) - receivers.begin());
}

// Serves the video on a thread of its own, and says on standard output who came and went.
class VideoProgram
{
public:
  // Writes the calibration, and listens from now on. begin: the clock's time at which the motion
  // began. Throws std::runtime_error and std::invalid_argument.
  VideoProgram(const lacuna::EmulatorSettings& settings, const lacuna::Clock& clock, double begin);
  ~VideoProgram();
  VideoProgram(const VideoProgram&) = delete;
  VideoProgram& operator=(const VideoProgram&) = delete;

  bool HasFailed() const { return this->Failed; }
  // Ends the video; throws what it failed with.
  void Finish();

private:
  lacuna::UltrasoundEmulator Emulator;
  lacuna::EmulatedProbe Probe;
  std::atomic<bool> Stopped{ false };
  std::atomic<bool> Failed{ false };
  std::exception_ptr Failure;
  std::unique_ptr<lacuna::VideoService> Service;
  std::thread Thread;
};

VideoProgram::VideoProgram(
  const lacuna::EmulatorSettings& settings, const lacuna::Clock& clock, double begin)
  : Emulator(lacuna::MakeEmulatedScene(settings.Video.Scene), GetPicture(settings))
  , Probe(settings.Motion, GetStation(settings), this->Emulator.GetScreen().GetImageToFace(),
      settings.Video.Picture.Layout.Depth, settings.Video.Aim.value_or(0))
{
  if (!settings.Video.Calibration.empty())
  {
    lacuna::WriteFileAtomically(settings.Video.Calibration, this->Probe.FormatCalibration());
  }
  this->Service = std::make_unique<lacuna::VideoService>(this->Emulator, this->Probe, clock,
    settings.Video.Service, [this] { return this->Stopped.load(); });
  const lacuna::ScannerLayout& layout = settings.Video.Picture.Layout;
  std::printf("Video of %d x %d pixels of %.4f mm, %d Hz, on %s\n", layout.Columns, layout.Rows,
    this->Emulator.GetScreen().GetPixelSpacing(), settings.Video.Service.Sender.Rate,
    settings.Video.Service.Sender.URL.c_str());
  const lacuna::DetectedFan& region = this->Emulator.GetScreen().GetRegion();
  std::printf("The probe sees: CropRectangle %d %d %d %d", region.Rectangle[0], region.Rectangle[1],
    region.Rectangle[2], region.Rectangle[3]);
  if (region.IsSector)
  {
    const lacuna::Fan& fan = region.Sector;
    std::printf(", FanOrigin %g %g, FanAngles %g %g, FanRadii %g %g", fan.Origin[0], fan.Origin[1],
      fan.Angles[0], fan.Angles[1], fan.Radii[0], fan.Radii[1]);
  }
  std::printf("\n");
  std::fflush(stdout);
  this->Thread = std::thread(
    [this, begin]
    {
      try
      {
        this->Service->Run(begin,
          [](const lacuna::VideoServiceCounts& counts)
          {
            std::printf("Video: %lld frames sent, %lld left out\n",
              static_cast<long long>(counts.Sent), static_cast<long long>(counts.LeftOut));
            std::fflush(stdout);
          });
      }
      catch (...)
      {
        this->Failure = std::current_exception();
        this->Failed = true;
      }
    });
}

VideoProgram::~VideoProgram()
{
  this->Stopped = true;
  if (this->Thread.joinable())
  {
    this->Thread.join();
  }
}

void VideoProgram::Finish()
{
  this->Stopped = true;
  this->Thread.join();
  if (this->Failure)
  {
    std::rethrow_exception(this->Failure);
  }
}
}

int main(int count, char** arguments)
{
  lacuna::EmulatorSettings settings;
  try
  {
    settings = lacuna::ReadEmulatorSettings(
      std::vector<std::string>(arguments + 1, arguments + (count > 0 ? count : 1)));
    if (settings.Help)
    {
      std::fputs(lacuna::EmulatorHelp, stdout);
      return 0;
    }
  }
  catch (const std::exception& e)
  {
    std::fprintf(stderr, "lacuna-fastrak-emulator: %s\n", e.what());
    return 2;
  }
  std::signal(SIGINT, Interrupt);
  std::signal(SIGTERM, Interrupt);
  try
  {
    lacuna::PseudoTerminal terminal(settings.Link);
    const lacuna::SteadyClock clock;
    const double begin = clock.Now();
    lacuna::FastrakEmulator emulator([&](double time, int station)
      { return settings.Motion(time - begin, station); },
      settings.Options);
    std::printf("FASTRAK at %d baud on %s\n", settings.Options.Baud, terminal.GetName().c_str());
    std::fflush(stdout);
    std::unique_ptr<VideoProgram> video;
    if (!settings.Video.Service.Sender.URL.empty())
    {
      video = std::make_unique<VideoProgram>(settings, clock, begin);
    }
    std::size_t next = 0;
    terminal.Serve(emulator,
      [&]
      {
        const double time = clock.Now() - begin;
        for (; next < settings.Events.size() && settings.Events[next].Time <= time; ++next)
        {
          settings.Events[next].Apply(emulator, clock.Now());
        }
        return interrupted != 0 || time >= settings.Duration || (video && video->HasFailed());
      });
    if (video)
    {
      video->Finish();
    }
  }
  catch (const std::exception& e)
  {
    std::fprintf(stderr, "lacuna-fastrak-emulator: %s\n", e.what());
    return 1;
  }
  return 0;
}
