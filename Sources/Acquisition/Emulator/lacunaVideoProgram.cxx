// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVideoProgram.h"

#include "lacunaAtomicFile.h"

#include <algorithm>
#include <cctype>
#include <cstdio>

namespace lacuna
{
namespace
{
UltrasoundSettings GetPicture(const EmulatorSettings& settings)
{
  UltrasoundSettings picture = settings.Video.Picture;
  picture.Seed = settings.Options.Seed;
  picture.Layout.Title = "LACUNA EMULATOR  ";
  for (const char c : settings.Video.Scene)
  {
    picture.Layout.Title += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return picture;
}

int GetStation(const EmulatorSettings& settings)
{
  const auto& receivers = settings.Options.Receivers;
  return 1 +
    static_cast<int>(std::find(receivers.begin(), receivers.end(), true) - receivers.begin());
}
}

VideoProgram::VideoProgram(const EmulatorSettings& settings, const Clock& clock, double begin)
  : Emulator(MakeEmulatedScene(settings.Video.Scene), GetPicture(settings))
  , Probe(settings.Motion, GetStation(settings), this->Emulator.GetScreen().GetImageToFace(),
      settings.Video.Picture.Layout.Depth, settings.Video.Aim.value_or(0))
{
  if (!settings.Video.Calibration.empty())
  {
    WriteFileAtomically(settings.Video.Calibration, this->Probe.FormatCalibration());
  }
  this->Service = std::make_unique<VideoService>(this->Emulator, this->Probe, clock,
    settings.Video.Service, [this] { return this->Stopped.load(); });
  const ScannerLayout& layout = settings.Video.Picture.Layout;
  std::printf("Video of %d x %d pixels of %.4f mm, %d Hz, on %s\n", layout.Columns, layout.Rows,
    this->Emulator.GetScreen().GetPixelSpacing(), settings.Video.Service.Sender.Rate,
    settings.Video.Service.Sender.URL.c_str());
  const DetectedFan& region = this->Emulator.GetScreen().GetRegion();
  std::printf("The probe sees: CropRectangle %d %d %d %d", region.Rectangle[0], region.Rectangle[1],
    region.Rectangle[2], region.Rectangle[3]);
  if (region.IsSector)
  {
    const Fan& fan = region.Sector;
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
          [](const VideoServiceCounts& counts)
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
