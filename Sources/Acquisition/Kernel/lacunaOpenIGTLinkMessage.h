// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Messages of OpenIGTLink: what their bytes mean.
#ifndef lacunaOpenIGTLinkMessage_h
#define lacunaOpenIGTLinkMessage_h

#include "lacunaMatrix4.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace lacuna
{
/// A message that is damaged, or one that cannot be used; the text says which and why.
class OpenIGTLinkError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// The first 58 bytes of a message.
struct OpenIGTLinkHeader
{
  static constexpr std::size_t Size = 58;
  int Version = 1;             ///< of the header; from 2 on (protocol 3) there are meta data
  std::string Type;            ///< "TRANSFORM"
  std::string Device;          ///< its name, up to 20 characters
  std::optional<double> Stamp; ///< s of the sender's clock; nothing where the message has none
  std::uint64_t BodySize = 0;
  std::uint64_t Crc = 0; ///< of the body
};

/// Throws OpenIGTLinkError where no message of OpenIGTLink begins.
OpenIGTLinkHeader ReadOpenIGTLinkHeader(const char* bytes);

struct OpenIGTLinkMessage
{
  OpenIGTLinkHeader Header;
  std::vector<char> Body;
  std::size_t ContentBegin = 0; ///< in the body, of the part that the type defines
  std::size_t ContentSize = 0;
  std::map<std::string, std::string, std::less<>> MetaData;

  std::string_view GetContent() const
  {
    return { this->Body.data() + this->ContentBegin, this->ContentSize };
  }
  /// The name in full, which PLUS puts into the meta data when it is too long for the header.
  std::string GetDevice() const;
};

/// Checks the body by its CRC and takes it apart. Throws OpenIGTLinkError when it is damaged.
OpenIGTLinkMessage MakeOpenIGTLinkMessage(
  const OpenIGTLinkHeader& header, std::vector<char>&& body);

/// Whether a device of this name is the one that was asked for; names may have been cut to the 20
/// bytes that a header has. Names, meta data and statuses have '?' for each byte that is no printable
/// ASCII, as their encoding is not told; those asked for are compared so.
bool IsOpenIGTLinkName(const std::string& name, const std::string& wanted);

/// One of the poses in a message.
struct OpenIGTLinkPose
{
  std::string Name; ///< the device, or the element of tracking data
  Matrix4 Pose;     ///< mm
  /// False when the sender says so (Status), and for the values that senders write for a tool that is
  /// out of sight: no number, a rotation of zeros only, and exactly the identity (unless Status is OK).
  bool Usable = true;
  /// What the meta data say of it, "OK", "OUT_OF_VIEW"; empty: nothing. Read from PLUS's
  /// TransformStatus or TransformValid, an element's NameStatus, the statuses beside an image.
  std::string Status;
  std::optional<bool> Button; ///< PLUS's SWITCH1_IS_ON and the like
  std::string Fault;          ///< why it never can be used; empty: it can
};

/// Sets Usable and Fault of one that is no number, the identity, or no rotation and translation.
void CheckOpenIGTLinkPose(OpenIGTLinkPose& pose);

/// The poses of a TRANSFORM, POSITION, QTRANS, TDATA or QTDATA message; of other types none. One that
/// scales or mirrors has a Fault. Throws OpenIGTLinkError when the sizes do not fit.
std::vector<OpenIGTLinkPose> ReadOpenIGTLinkPoses(const OpenIGTLinkMessage& message);

struct OpenIGTLinkImage
{
  int Columns = 0;
  int Rows = 0;
  /// By the rule of lacunaVideoGrey.h: integer levels over the range of their type to 0..255 (of
  /// signed ones negative levels are black), colours to the luminance of lacunaLuminance.h. Rows as
  /// they are sent: j = 0 first.
  std::vector<std::uint8_t> Grey;
  /// mm of a column and a row, as sent: they may be none. Nothing where both are exactly 1, which
  /// senders write that do not know it.
  std::optional<Vec2> PixelSpacing;
  /// Of the image's plane: millimetres along the rows, the columns and its normal, from the centre of
  /// the first pixel, to the sender's frame (the message has that of the image's centre).
  OpenIGTLinkPose Plane;
  bool Valid = true; ///< false: the meta data have an ImageStatus other than OK
};

/// Of an IMAGE message. Throws OpenIGTLinkError when the sizes do not fit, for volumes, parts of
/// images, and levels that are not integers of 8 or 16 bits.
OpenIGTLinkImage ReadOpenIGTLinkImage(const OpenIGTLinkMessage& message);

/// Sets what the meta data say of an image and its Plane, whose Name is set.
void SetOpenIGTLinkStatuses(const OpenIGTLinkMessage& message, OpenIGTLinkImage& image);

/// What a STATUS message complains of; empty: all is well.
std::string ReadOpenIGTLinkStatus(const OpenIGTLinkMessage& message);

/// A message that asks a server for tracking data as fast as it has them. type: "TDATA" or "QTDATA".
/// Its header has version 1, which every server reads.
std::string MakeOpenIGTLinkTrackingRequest(const std::string& type);

/// A GET_STATUS message of header version 2. PLUS sends meta data, and so the status of poses, only to
/// clients that have sent a message of version 2. Other servers answer or skip it.
std::string MakeOpenIGTLinkStatusRequest();
}
#endif
