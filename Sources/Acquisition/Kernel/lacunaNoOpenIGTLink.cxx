// SPDX-License-Identifier: BSD-3-Clause
// Devices behind OpenIGTLink servers in a build without libopenigtlink.
#include "lacunaByteChannel.h"
#include "lacunaOpenIGTLinkDevices.h"

namespace lacuna
{
namespace
{
// Throws for any call.
template <class Device>
auto MakeFactory(const std::string& text)
{
  const std::string server = ParseOpenIGTLinkAddress(text).GetServer();
  return [server](const std::function<bool()>&) -> std::unique_ptr<Device>
  {
    throw ChannelError(ChannelError::Kind::Unsupported,
      "The server " + server +
        " cannot be connected: this Lacuna was built without libopenigtlink "
        "(LACUNA_WITH_OPENIGTLINK=OFF)");
  };
}
}

PoseDeviceFactory MakeOpenIGTLinkPoseFactory(const std::string& address, int, const Clock&)
{
  return MakeFactory<PoseDevice>(address);
}

FrameDeviceFactory MakeOpenIGTLinkFrameFactory(const std::string& address, const Clock&)
{
  return MakeFactory<FrameDevice>(address);
}
}
