// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVideoService.h"

#include "lacunaCalibrationFile.h"
#include "lacunaExecution.h"
#include "lacunaFastrakRecord.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

namespace lacuna
{
namespace
{
// The face's x, y and z lie along the receiver's x, z and -y, but for some degrees.
Matrix4 FaceToReceiver()
{
  return Matrix4::Translation({ 18, -12, 74 }) * FastrakRotation(Vec3{ 5, -8, 3 }) *
    Matrix4::FromColumns({ 1, 0, 0 }, { 0, 0, 1 }, { 0, -1, 0 }, { 0, 0, 0 });
}
}

EmulatedProbe::EmulatedProbe(FastrakEmulator::PoseScript motion, int station,
  const Matrix4& imageToFace, double depth, double aim)
  : Motion(std::move(motion))
  , Station(station)
  , ImageToReceiver(FaceToReceiver() * imageToFace)
  , TransmitterToScene(
      (this->Motion(aim, station) * FaceToReceiver() * Matrix4::Translation({ 0, 0.5 * depth, 0 }))
        .Inverse())
{
}

Matrix4 EmulatedProbe::ImageToScene(double time) const
{
  return this->TransmitterToScene * this->Motion(time, this->Station) * this->ImageToReceiver;
}

std::string EmulatedProbe::FormatCalibration() const
{
  return lacuna::FormatCalibration({ { "Image", "Probe", this->ImageToReceiver },
                                     { "Tracker", "Reference", this->TransmitterToScene } },
    "The truth of lacuna-fastrak-emulator. Image: column, row, 0; mm. Reference: the scene.");
}

//------------------------------------------------------------------------------
namespace
{
constexpr double LongestSleep = 0.05; // s
constexpr double LongestDelay = 0.2;  // s
constexpr double LongestLatency = 1;  // s

VideoSenderSettings GetSender(
  const UltrasoundEmulator& emulator, const VideoServiceSettings& settings)
{
  if (!(settings.Latency >= 0 && settings.Latency <= LongestLatency) || settings.Sender.Rate < 1 ||
    settings.Sender.Rate > 100)
  {
    std::ostringstream message;
    message << "the video has " << settings.Sender.Rate << " frames a second and a latency of "
            << settings.Latency << " s; they must be 1 to 100 and 0 to " << LongestLatency;
    throw std::invalid_argument(message.str());
  }
  VideoSenderSettings sender = settings.Sender;
  sender.Columns = emulator.GetScreen().GetLayout().Columns;
  sender.Rows = emulator.GetScreen().GetLayout().Rows;
  return sender;
}
}

VideoService::VideoService(const UltrasoundEmulator& emulator, const EmulatedProbe& probe,
  const Clock& clock, const VideoServiceSettings& settings, std::function<bool()> stopped)
  : Emulator(emulator)
  , Probe(probe)
  , Time(clock)
  , Settings(settings)
  , Stopped(std::move(stopped))
  , Sender(GetSender(emulator, settings), this->Stopped)
{
}

void VideoService::WaitUntil(double time) const
{
  while (true)
  {
    if (this->Stopped())
    {
      throw Aborted();
    }
    const double left = time - this->Time.Now();
    if (!(left > 0))
    {
      return;
    }
    std::this_thread::sleep_for(std::chrono::duration<double>(std::min(left, LongestSleep)));
  }
}

void VideoService::ServeClient(double begin, VideoServiceCounts& counts)
{
  const ScannerLayout& layout = this->Emulator.GetScreen().GetLayout();
  const double rate = this->Settings.Sender.Rate;
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(layout.Columns) * layout.Rows);
  const auto next = [&] // the first frame that can still be in time
  { return static_cast<std::int64_t>(std::ceil(rate * (this->Time.Now() - begin))); };
  std::int64_t number = std::max<std::int64_t>(next() + 1, 0);
  while (true)
  {
    if (this->Time.Now() > begin + static_cast<double>(number) / rate + LongestDelay)
    {
      const std::int64_t now = next();
      counts.LeftOut += now - number;
      number = now;
    }
    const double due = static_cast<double>(number) / rate;
    const double shown = due - this->Settings.Latency;
    this->Emulator.Render(this->Probe.ImageToScene(shown), shown, number, pixels.data());
    this->WaitUntil(begin + due);
    if (!this->Sender.Send(pixels.data(), number))
    {
      return;
    }
    ++counts.Sent;
    ++number;
  }
}

void VideoService::Run(double begin, const std::function<void(const VideoServiceCounts&)>& left)
{
  try
  {
    do
    {
      this->Sender.Open();
      VideoServiceCounts counts;
      try
      {
        this->ServeClient(begin, counts);
      }
      catch (const Aborted&)
      {
      }
      this->Sender.Close();
      left(counts);
    } while (this->Sender.IsServer() && !this->Stopped());
  }
  catch (const Aborted&) // nobody came
  {
  }
}
}
