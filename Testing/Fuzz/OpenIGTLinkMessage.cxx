// SPDX-License-Identifier: BSD-3-Clause
// Messages of trackers and scanners in the network. The checksum is made right: it would keep all
// that is behind it from being tried.
#include "lacunaFuzzTarget.h"
#include "lacunaOpenIGTLinkMessage.h"

#include <igtl_util.h>

#include <cmath>

using namespace lacuna;
using namespace lacuna_fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  if (size < OpenIGTLinkHeader::Size)
  {
    return 0;
  }
  try
  {
    OpenIGTLinkHeader header = ReadOpenIGTLinkHeader(reinterpret_cast<const char*>(data));
    Require(!header.Stamp || std::isfinite(*header.Stamp), "a stamp is a number");
    const std::uint8_t* begin = data + OpenIGTLinkHeader::Size;
    std::vector<char> body(begin, data + size);
    header.BodySize = body.size();
    header.Crc = crc64(const_cast<std::uint8_t*>(begin), body.size(), 0);
    const OpenIGTLinkMessage message = MakeOpenIGTLinkMessage(header, std::move(body));
    for (const OpenIGTLinkPose& pose : ReadOpenIGTLinkPoses(message))
    {
      Require(
        !pose.Usable || !pose.Fault.empty() || pose.Pose.IsFinite(), "usable poses are numbers");
    }
    ReadOpenIGTLinkStatus(message);
    if (header.Type == "IMAGE")
    {
      const OpenIGTLinkImage image = ReadOpenIGTLinkImage(message);
      Require(image.Grey.size() == static_cast<std::size_t>(image.Columns) * image.Rows,
        "a level for each pixel");
    }
  }
  catch (const OpenIGTLinkError& error)
  {
    RequireSentence(error);
  }
  return 0;
}
