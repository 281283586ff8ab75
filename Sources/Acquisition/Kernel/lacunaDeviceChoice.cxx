// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDeviceChoice.h"

#include "lacunaFrameDevice.h"
#include "lacunaOpenIGTLinkDevices.h"
#include "lacunaSerialPort.h"

#include <stdexcept>
#include <string>
#include <utility>

namespace lacuna
{
FastrakDevice::FastrakDevice(std::unique_ptr<ByteChannel> channel, const Clock& clock,
  const FastrakSettings& settings, std::function<bool()> stopped)
  : Channel(std::move(channel))
  , Tracker(*this->Channel, clock, settings, std::move(stopped))
{
}

PoseCounts FastrakDevice::GetCounts() const
{
  const FastrakTracker::Counts counts = this->Tracker.GetCounts();
  return { counts.Records, counts.Silent + counts.Late, counts.Damaged, counts.Implausible,
    counts.Flipped };
}

FastrakLayout ChooseFastrakLayout(int baud, bool withButton, bool binary)
{
  constexpr double longest = 0.0145; // s on the line, beside 10 ms of the unit
  std::vector<std::vector<int>> lists{ { 2, 4, 2, 4 }, { 2, 4 } };
  if (!binary)
  {
    lists = { { 52, 54, 52, 54 }, { 52, 54 }, { 2, 4 } };
  }
  for (std::vector<int>& list : lists)
  {
    if (withButton)
    {
      list.push_back(static_cast<int>(FastrakItem::Button));
    }
    FastrakLayout layout = FastrakLayout::FromNumbers(list);
    const auto bytes = static_cast<double>(layout.GetLength(binary));
    if (10 * bytes / baud < longest || &list == &lists.back())
    {
      return layout;
    }
  }
  return {};
}

PoseDeviceFactory MakeFastrakFactory(
  const std::string& port, int baud, const Clock& clock, const FastrakSettings& settings)
{
  return [port, baud, &clock, settings](const std::function<bool()>& stopped)
  {
    return std::make_unique<FastrakDevice>(
      std::make_unique<SerialPort>(port, baud), clock, settings, stopped);
  };
}

//------------------------------------------------------------------------------
namespace
{
// A video as an acquisition's source of frames.

class VideoDevice : public FrameDevice
{
public:
  // The clock goes on by itself and must live longer.
  VideoDevice(const VideoSettings& settings, const Clock& clock, std::function<bool()> stopped);

  VideoEvent Read(VideoFrame& frame) override { return this->Source.Read(frame); }
  // One frame's time for a frame grabber (/dev/...) whose rate is known; else 0.
  double GetLatency() const override;
  std::vector<std::optional<double>> TakeArrivals() override { return this->Source.TakeArrivals(); }
  VideoSource::Counts GetCounts() const override { return this->Source.GetCounts(); }

private:
  bool IsGrabber;
  VideoSource Source;
};

VideoDevice::VideoDevice(
  const VideoSettings& settings, const Clock& clock, std::function<bool()> stopped)
  : IsGrabber(settings.URL.rfind("/dev/", 0) == 0)
  , Source(settings, clock, std::move(stopped))
{
}

double VideoDevice::GetLatency() const
{
  const double rate = this->Source.GetFrameRate();
  return this->IsGrabber && rate > 0 ? 1 / rate : 0;
}

// Opens a video. The clock goes on by itself and must live longer.
FrameDeviceFactory MakeVideoFactory(const VideoSettings& settings, const Clock& clock)
{
  return [settings, &clock](const std::function<bool()>& stopped)
  { return std::make_unique<VideoDevice>(settings, clock, stopped); };
}

//------------------------------------------------------------------------------
std::string ListPorts()
{
  std::string text;
  for (const std::string& port : SerialPort::List())
  {
    text += (text.empty() ? "; this computer has " : ", ") + port;
  }
  return text.empty() ? "; this computer has none now: is the adapter plugged in?" : text;
}
}

PoseDeviceFactory ChoosePoseDevice(const TrackerChoice& choice, const Clock& clock)
{
  if (IsOpenIGTLinkAddress(choice.Connection))
  {
    return [choice, &clock](const std::function<bool()>& stopped)
    { return MakeOpenIGTLinkPoseFactory(choice.Connection, choice.Station, clock)(stopped); };
  }
  if (choice.Connection.empty() || choice.Connection.find("://") != std::string::npos)
  {
    return
      [connection = choice.Connection](const std::function<bool()>&) -> std::unique_ptr<PoseDevice>
    {
      throw std::invalid_argument((connection.empty() ? std::string("TrackerConnection is not set")
                                                      : "TrackerConnection '" + connection +
                                        "' is none that this Lacuna knows") +
        ": give the serial port of the tracker, such as /dev/ttyUSB0, or an OpenIGTLink server, "
        "such as igtl://localhost:18944" +
        ListPorts());
    };
  }
  FastrakSettings settings;
  settings.Stations = { choice.Station };
  settings.Hemisphere = choice.Hemisphere;
  settings.FiltersOff = choice.FiltersOff;
  settings.Format = choice.Format;
  settings.Reset = choice.Reset;
  settings.Layout = ChooseFastrakLayout(choice.BaudRate, choice.WithButton, choice.Format.Binary);
  return MakeFastrakFactory(choice.Connection, choice.BaudRate, clock, settings);
}

FrameDeviceFactory ChooseFrameDevice(const VideoSettings& settings, const Clock& clock)
{
  if (settings.URL.empty())
  {
    return [](const std::function<bool()>&) -> std::unique_ptr<FrameDevice>
    {
      throw std::invalid_argument(
        "VideoURL is not set: give a frame grabber (/dev/video0), a file, the address of a stream "
        "(rtsp://... or igtl://...) or a test signal (lavfi:testsrc2=size=768x576:rate=25)");
    };
  }
  if (IsOpenIGTLinkAddress(settings.URL))
  {
    return [url = settings.URL, &clock](const std::function<bool()>& stopped)
    { return MakeOpenIGTLinkFrameFactory(url, clock)(stopped); };
  }
  return MakeVideoFactory(settings, clock);
}
}
