// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How an OpenIGTLink server, and what to take from it, is written.
#ifndef lacunaOpenIGTLinkAddress_h
#define lacunaOpenIGTLinkAddress_h

#include <string>

namespace lacuna
{
/// "igtl://host:port?transform=ProbeToTracker&image=Image_Reference&start=TDATA". All but the host
/// may be left out; start is TDATA or QTDATA. An IPv6 address is in brackets, "igtl://[::1]:18944". In names, %20 stands for a
/// blank, %26 for &, and so on.
struct OpenIGTLinkAddress
{
  std::string Host;
  int Port = 18944; ///< that of PLUS and 3D Slicer
  /// The device whose poses to take, or the element of tracking data, or an image, whose own
  /// position is then taken; empty: the only one that has poses.
  std::string Transform;
  std::string Image; ///< the device whose images to take; empty: the only one
  /// "TDATA" or "QTDATA": asks for tracking data, which many servers send only then; empty: does not.
  std::string StartTrackingData;

  /// "igtl://host:port".
  std::string GetServer() const;
};

/// Whether a text begins with "igtl://", in any case of letters.
bool IsOpenIGTLinkAddress(const std::string& text);

/// Throws std::invalid_argument that says what is wrong and what would be right.
OpenIGTLinkAddress ParseOpenIGTLinkAddress(const std::string& text);
}
#endif
