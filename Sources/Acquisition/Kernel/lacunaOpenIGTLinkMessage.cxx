// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaOpenIGTLinkMessage.h"

#include "lacunaGeometryGate.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include <igtl_header.h>
#include <igtl_position.h>
#include <igtl_qtdata.h>
#include <igtl_tdata.h>
#include <igtl_transform.h>
#include <igtl_util.h>

namespace lacuna
{
namespace
{
constexpr int NewestVersion = 3;
constexpr std::size_t NameSize = IGTL_HEADER_NAME_SIZE;
constexpr std::size_t ExtendedHeaderSize = 12;
constexpr std::uint64_t LargestBody = std::uint64_t{ 1 } << 32; // of any message that makes sense

// Big endian, as all of a message but the pixels is.
std::uint64_t ReadNumber(std::string_view bytes, std::size_t position, std::size_t size)
{
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < size; ++i)
  {
    number = number << 8 | static_cast<unsigned char>(bytes[position + i]);
  }
  return number;
}

// Names and texts are of any bytes, and go into messages, which are UTF-8 and of one line.
std::string MakePrintable(std::string text)
{
  for (char& c : text)
  {
    c = c >= ' ' && c < 127 ? c : '?';
  }
  return text;
}

// Up to the first null.
std::string ReadText(const char* bytes, std::size_t size)
{
  return { bytes, std::find(bytes, bytes + size, '\0') };
}

std::string Describe(const OpenIGTLinkHeader& header)
{
  return "The " + header.Type + " message of '" + header.Device + "' ";
}

[[noreturn]] void ThrowSize(const OpenIGTLinkMessage& message)
{
  throw OpenIGTLinkError(Describe(message.Header) + "is damaged: its content of " +
    std::to_string(message.ContentSize) + " bytes cannot be");
}

void ReadMetaData(std::string_view index, std::string_view texts, OpenIGTLinkMessage& message)
{
  constexpr std::size_t entry = 8;
  const std::size_t count = index.size() < 2 ? 0 : ReadNumber(index, 0, 2);
  if (2 + count * entry > std::max<std::size_t>(index.size(), 2))
  {
    throw OpenIGTLinkError(
      Describe(message.Header) + "is damaged: its list of meta data is cut off");
  }
  for (std::size_t i = 0; i < count; ++i)
  {
    const std::size_t key = ReadNumber(index, 2 + i * entry, 2);
    const std::size_t value = ReadNumber(index, 2 + i * entry + 4, 4);
    if (key + value > texts.size())
    {
      throw OpenIGTLinkError(Describe(message.Header) + "is damaged: its meta data are cut off");
    }
    message.MetaData[MakePrintable(std::string(texts.substr(0, key)))] =
      MakePrintable(std::string(texts.substr(key, value)));
    texts.remove_prefix(key + value);
  }
}

Matrix4 MakeMatrix(const void* numbers)
{
  std::array<float, 12> n{};
  std::memcpy(n.data(), numbers, sizeof(n));
  return Matrix4::FromColumns(
    { n[0], n[1], n[2] }, { n[3], n[4], n[5] }, { n[6], n[7], n[8] }, { n[9], n[10], n[11] });
}

void SetFault(const GeometryFinding& finding, OpenIGTLinkPose& pose)
{
  if (GetAction(GeometryOrigin::Live, finding.Fault) == GeometryAction::Flag)
  {
    pose.Fault = "it " + finding.Text + ": " + finding.Advice;
  }
}

// Of position and unit quaternion x y z w; another one has a fault.
void SetPose(const void* position, const void* quaternion, OpenIGTLinkPose& pose)
{
  std::array<float, 3> p{};
  std::array<float, 4> q{};
  std::memcpy(p.data(), position, sizeof(p));
  std::memcpy(q.data(), quaternion, sizeof(q));
  const Vec3 axis{ q[0], q[1], q[2] };
  const double sine = Norm(axis);
  const double norm = std::hypot(sine, q[3]);
  if (norm == 0)
  {
    pose.Pose = Matrix4::Scaling({ 0, 0, 0 }); // of no tool that is seen
    return;
  }
  if (std::isfinite(norm))
  {
    SetFault(CheckQuaternion(norm), pose);
  }
  pose.Pose = Matrix4::Translation({ p[0], p[1], p[2] }) *
    (sine == 0 ? Matrix4() : Matrix4::Rotation(axis, 2 * std::atan2(sine, q[3])));
}

// "ProbeToTracker" of "ProbeToTrackerStatus".
std::optional<std::string> FindStem(const std::string& key, const std::string& ending)
{
  if (key.size() <= ending.size() ||
    key.compare(key.size() - ending.size(), ending.size(), ending) != 0)
  {
    return std::nullopt;
  }
  return key.substr(0, key.size() - ending.size());
}

void SetStatus(const std::string& status, OpenIGTLinkPose& pose)
{
  if (status.empty())
  {
    return;
  }
  pose.Status = status;
  const bool pressed = status.rfind("SWITCH", 0) == 0;
  pose.Button = pressed;
  pose.Usable = pressed || status == "OK";
}

// "OK", another status, or nothing. PLUS of 2018 has only TransformValid, 0 or 1.
std::string FindStatus(const OpenIGTLinkMessage& message)
{
  const auto& data = message.MetaData;
  for (const char* key : { "TransformStatus", "Status" })
  {
    if (const auto found = data.find(key); found != data.end())
    {
      return found->second;
    }
  }
  const auto valid = data.find("TransformValid");
  if (valid == data.end())
  {
    return {};
  }
  return valid->second == "1" || valid->second == "true" ? "OK" : "INVALID";
}

// Of an element, whose name may be cut: PLUS has NameStatus and NameIndex with the name in full.
void SetElementStatus(const OpenIGTLinkMessage& message, std::size_t index, OpenIGTLinkPose& pose)
{
  const std::string cut = pose.Name;
  for (const auto& [key, value] : message.MetaData)
  {
    const std::optional<std::string> name = FindStem(key, "Status");
    if (!name || !IsOpenIGTLinkName(cut, *name))
    {
      continue;
    }
    const auto place = message.MetaData.find(*name + "Index");
    if (place != message.MetaData.end() && place->second != std::to_string(index))
    {
      continue; // another element whose name begins with the same letters
    }
    pose.Name = *name;
    SetStatus(value, pose);
    if (!pose.Usable)
    {
      return;
    }
  }
}

void AddElements(const OpenIGTLinkMessage& message, std::vector<OpenIGTLinkPose>& poses)
{
  const bool quaternions = message.Header.Type == "QTDATA";
  const std::size_t size = quaternions ? IGTL_QTDATA_ELEMENT_SIZE : IGTL_TDATA_ELEMENT_SIZE;
  if (message.ContentSize % size != 0)
  {
    ThrowSize(message);
  }
  for (std::size_t begin = 0; begin < message.ContentSize; begin += size)
  {
    const char* bytes = message.GetContent().data() + begin;
    OpenIGTLinkPose pose;
    pose.Name = MakePrintable(ReadText(bytes, NameSize));
    const int type = bytes[NameSize];
    if (quaternions)
    {
      igtl_qtdata_element element = {};
      std::memcpy(&element, bytes, size);
      igtl_qtdata_convert_byte_order(&element, 1);
      SetPose(element.position, element.quaternion, pose);
    }
    else
    {
      igtl_tdata_element element = {};
      std::memcpy(&element, bytes, size);
      igtl_tdata_convert_byte_order(&element, 1);
      pose.Pose = MakeMatrix(element.transform);
    }
    if (type == IGTL_TDATA_TYPE_3D || type == IGTL_TDATA_TYPE_5D)
    {
      pose.Fault = "the tracker follows this tool's tip and not its whole orientation";
    }
    SetElementStatus(message, begin / size, pose);
    CheckOpenIGTLinkPose(pose);
    poses.push_back(pose);
  }
}

std::string MakeRequest(const std::string& type, int version, std::string body)
{
  igtl_header fields = {};
  type.copy(fields.name, sizeof(fields.name));
  const std::string client = "Lacuna";
  client.copy(fields.device_name, sizeof(fields.device_name));
  fields.body_size = body.size();
  fields.crc = crc64(reinterpret_cast<unsigned char*>(body.data()), body.size(), 0);
  igtl_header_convert_byte_order(&fields);
  std::string bytes(sizeof(fields), '\0');
  std::memcpy(bytes.data(), &fields, sizeof(fields));
  bytes[1] = static_cast<char>(version);
  return bytes + body;
}
}

OpenIGTLinkHeader ReadOpenIGTLinkHeader(const char* bytes)
{
  igtl_header fields = {};
  std::memcpy(&fields, bytes, sizeof(fields));
  igtl_header_convert_byte_order(&fields);
  OpenIGTLinkHeader header;
  header.Version = static_cast<int>(ReadNumber({ bytes, 2 }, 0, 2)); // a field of changing name
  header.Type = ReadText(fields.name, sizeof(fields.name));
  header.Device = MakePrintable(ReadText(fields.device_name, sizeof(fields.device_name)));
  const bool letters =
    std::all_of(header.Type.begin(), header.Type.end(), [](char c) { return c > ' ' && c < 127; });
  header.BodySize = fields.body_size;
  header.Crc = fields.crc;
  if (header.Version < 1 || header.Version > NewestVersion || header.Type.empty() || !letters ||
    header.BodySize > LargestBody)
  {
    throw OpenIGTLinkError(
      "what comes is not OpenIGTLink, or bytes of it were lost: check the port of the server");
  }
  if (fields.timestamp != 0)
  {
    header.Stamp = std::ldexp(static_cast<double>(fields.timestamp), -32);
  }
  return header;
}

std::string OpenIGTLinkMessage::GetDevice() const
{
  const auto found = this->MetaData.find("IGTL_DEVICE_NAME");
  return found == this->MetaData.end() ? this->Header.Device : found->second;
}

OpenIGTLinkMessage MakeOpenIGTLinkMessage(const OpenIGTLinkHeader& header, std::vector<char>&& body)
{
  OpenIGTLinkMessage message;
  message.Header = header;
  message.Body = std::move(body);
  if (crc64(reinterpret_cast<unsigned char*>(message.Body.data()), message.Body.size(), 0) !=
    header.Crc)
  {
    throw OpenIGTLinkError(Describe(header) + "is damaged: its checksum is wrong");
  }
  message.ContentSize = message.Body.size();
  if (header.Version < 2)
  {
    return message;
  }
  const std::string_view bytes(message.Body.data(), message.Body.size());
  const std::size_t extended = bytes.size() < ExtendedHeaderSize ? 0 : ReadNumber(bytes, 0, 2);
  const std::size_t index = extended == 0 ? 0 : ReadNumber(bytes, 2, 2);
  const std::size_t texts = extended == 0 ? 0 : ReadNumber(bytes, 4, 4);
  if (extended < ExtendedHeaderSize || extended + index + texts > bytes.size())
  {
    throw OpenIGTLinkError(
      Describe(header) + "is damaged: the sizes of its parts are more than all");
  }
  message.ContentBegin = extended;
  message.ContentSize = bytes.size() - extended - index - texts;
  ReadMetaData(
    bytes.substr(bytes.size() - index - texts, index), bytes.substr(bytes.size() - texts), message);
  return message;
}

bool IsOpenIGTLinkName(const std::string& name, const std::string& wanted)
{
  const std::string printable = MakePrintable(wanted);
  return name == printable || (name.size() == NameSize && name == printable.substr(0, NameSize));
}

namespace
{
// What senders write for a tool that is out of sight.
bool IsNotSeen(const OpenIGTLinkPose& pose)
{
  constexpr double none = 1e27; // NDI's trackers have -3.7e28 for no number
  bool identity = true;
  bool number = true;
  for (int i = 0; i < 16; ++i)
  {
    const double element = pose.Pose.Data()[i];
    identity = identity && element == (i % 5 == 0 ? 1 : 0);
    number = number && std::abs(element) < none; // false for NaN
  }
  const bool zero =
    Norm(pose.Pose.Column(0)) + Norm(pose.Pose.Column(1)) + Norm(pose.Pose.Column(2)) == 0;
  return !number || zero || (identity && pose.Status.empty());
}
}

void CheckOpenIGTLinkPose(OpenIGTLinkPose& pose)
{
  if (!pose.Fault.empty())
  {
    return;
  }
  if (IsNotSeen(pose))
  {
    pose.Usable = false;
    return;
  }
  SetFault(CheckPose(pose.Pose), pose);
}

std::vector<OpenIGTLinkPose> ReadOpenIGTLinkPoses(const OpenIGTLinkMessage& message)
{
  const std::string& type = message.Header.Type;
  const std::string_view content = message.GetContent();
  std::vector<OpenIGTLinkPose> poses;
  if (type == "TDATA" || type == "QTDATA")
  {
    AddElements(message, poses);
    return poses;
  }
  OpenIGTLinkPose pose;
  pose.Name = message.GetDevice();
  if (type == "TRANSFORM")
  {
    std::array<igtl_float32, 12> numbers{};
    if (content.size() != sizeof(numbers))
    {
      ThrowSize(message);
    }
    std::memcpy(numbers.data(), content.data(), sizeof(numbers));
    igtl_transform_convert_byte_order(numbers.data());
    pose.Pose = MakeMatrix(numbers.data());
  }
  else if (type == "POSITION" || type == "QTRANS")
  {
    igtl_position fields = {};
    if (content.size() != IGTL_POSITION_MESSAGE_DEFAULT_SIZE &&
      content.size() != IGTL_POSITION_MESSAGE_WITH_QUATERNION3_SIZE &&
      content.size() != IGTL_POSITION_MESSAGE_POSITON_ONLY_SIZE)
    {
      ThrowSize(message);
    }
    std::memcpy(&fields, content.data(), content.size());
    igtl_position_convert_byte_order(&fields);
    if (content.size() == IGTL_POSITION_MESSAGE_WITH_QUATERNION3_SIZE)
    {
      const double vector = fields.quaternion[0] * fields.quaternion[0] +
        fields.quaternion[1] * fields.quaternion[1] + fields.quaternion[2] * fields.quaternion[2];
      fields.quaternion[3] = static_cast<float>(std::sqrt(std::max(0.0, 1 - vector)));
    }
    if (content.size() == IGTL_POSITION_MESSAGE_POSITON_ONLY_SIZE)
    {
      pose.Fault = "it has no orientation: have the sender give it, or TRANSFORM messages";
    }
    else
    {
      SetPose(fields.position, fields.quaternion, pose);
    }
  }
  else
  {
    return poses;
  }
  SetStatus(FindStatus(message), pose);
  CheckOpenIGTLinkPose(pose);
  poses.push_back(pose);
  return poses;
}

// PLUS sends all fields of its frame beside an image. Those of the transform that the device is named
// after decide. Without them nothing says which transforms make it: it is as good as the worst.
void SetOpenIGTLinkStatuses(const OpenIGTLinkMessage& message, OpenIGTLinkImage& image)
{
  const auto& data = message.MetaData;
  if (const auto found = data.find("ImageStatus"); found != data.end())
  {
    image.Valid = found->second == "OK";
  }
  const std::string ending = "TransformStatus";
  std::string own = image.Plane.Name;
  if (const std::size_t line = own.find('_'); line != std::string::npos)
  {
    own.replace(line, 1, "To");
  }
  if (const auto found = data.find(own + ending); found != data.end())
  {
    SetStatus(found->second, image.Plane);
    return;
  }
  for (auto i = data.begin(); i != data.end() && image.Plane.Usable; ++i)
  {
    const std::optional<std::string> name = FindStem(i->first, ending);
    if (name)
    {
      SetStatus(i->second, image.Plane);
      image.Plane.Status = image.Plane.Usable ? "OK" : *name + " is " + i->second;
    }
  }
}

std::string ReadOpenIGTLinkStatus(const OpenIGTLinkMessage& message)
{
  constexpr std::size_t nameBegin = 10; // after the code and the sub-code
  constexpr std::size_t textBegin = nameBegin + NameSize;
  constexpr std::size_t longest = 500;
  const std::string_view content = message.GetContent();
  if (content.size() < textBegin)
  {
    ThrowSize(message);
  }
  const std::uint64_t code = ReadNumber(content, 0, 2);
  if (code == 1)
  {
    return {};
  }
  std::string text = ReadText(content.data() + nameBegin, NameSize);
  const std::string_view rest = content.substr(textBegin);
  const std::string more = ReadText(rest.data(), std::min(rest.size(), longest));
  text += (text.empty() || more.empty() ? "" : ": ") + more;
  std::replace_if(
    text.begin(), text.end(), [](char c) { return c >= 0 && c < ' '; }, ' ');
  text = MakePrintable(text);
  return "The sender's device '" + message.Header.Device + "' reports status " +
    std::to_string(code) + (text.empty() ? "" : " (" + text + ")");
}

std::string MakeOpenIGTLinkTrackingRequest(const std::string& type)
{
  static_assert(IGTL_STT_QTDATA_SIZE == IGTL_STT_TDATA_SIZE);
  // no shortest interval, no name of coordinates
  return MakeRequest("STT_" + type, 1, std::string(IGTL_STT_TDATA_SIZE, '\0'));
}

std::string MakeOpenIGTLinkStatusRequest()
{
  // Extended header, index and text of one entry of meta data. All is as long as a header, and would be
  // one of an unknown version, no type and no body: libopenigtlink 1.11 unpacks no header of version 2
  // and reads the next one where this body begins.
  const std::string key = "Client";
  constexpr std::size_t indexSize = 10;
  const std::size_t textSize = sizeof(igtl_header) - ExtendedHeaderSize - indexSize;
  std::string body(sizeof(igtl_header), '\0');
  body[1] = static_cast<char>(ExtendedHeaderSize);
  body[3] = static_cast<char>(indexSize);
  body[7] = static_cast<char>(textSize);
  char* index = body.data() + ExtendedHeaderSize;
  index[1] = 1; // entry
  index[3] = static_cast<char>(key.size());
  index[5] = 3; // US-ASCII
  index[9] = static_cast<char>(textSize - key.size());
  key.copy(index + indexSize, key.size());
  return MakeRequest("GET_STATUS", 2, body);
}
}
