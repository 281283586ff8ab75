// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDeviceChoice.h"

#include "lacunaFastrakDevice.h"
#include "lacunaOpenIGTLinkDevices.h"
#include "lacunaSerialPort.h"
#include "lacunaVideoDevice.h"

#include <stdexcept>

namespace lacuna
{
namespace
{
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
