// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// OpenIGTLink's own library as the other side: its messages and its server.
#ifndef lacunaTestOpenIGTLink_h
#define lacunaTestOpenIGTLink_h

#include "lacunaMatrix4.h"
#include "lacunaOpenIGTLinkMessage.h"

#include <igtlImageMessage.h>
#include <igtlPositionMessage.h>
#include <igtlQuaternionTrackingDataMessage.h>
#include <igtlServerSocket.h>
#include <igtlStatusMessage.h>
#include <igtlStringMessage.h>
#include <igtlTrackingDataMessage.h>
#include <igtlTransformMessage.h>
#include <igtl_util.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace lacunaTest
{
/// For tests of any framework.
inline void Require(bool right, const char* what)
{
  if (!right)
  {
    throw std::logic_error(std::string("test set-up: ") + what);
  }
}

/// A pose that no mirror, transposition or exchange of axes leaves as it is.
inline lacuna::Matrix4 AsymmetricPose(double time = 0)
{
  return lacuna::Matrix4::Translation({ 120 + 30 * time, -45.5, 310.25 - 8 * time }) *
    lacuna::Matrix4::Rotation({ 0.3, -0.8, 0.5 }, 1.1 + 0.4 * time);
}

inline double LargestDifference(const lacuna::Matrix4& a, const lacuna::Matrix4& b)
{
  double largest = 0;
  for (int i = 0; i < 16; ++i)
  {
    largest = std::max(largest, std::abs(a.Data()[i] - b.Data()[i]));
  }
  return largest;
}

inline void ToIgtl(const lacuna::Matrix4& matrix, igtl::Matrix4x4& igtl)
{
  for (int row = 0; row < 4; ++row)
  {
    for (int column = 0; column < 4; ++column)
    {
      igtl[row][column] = static_cast<float>(matrix(row, column));
    }
  }
}

/// As the library packs it. Stamps are s; 0: none.
inline std::string Pack(igtl::MessageBase& message, const std::string& device, double stamp)
{
  const double seconds = std::floor(stamp);
  message.SetDeviceName(device.c_str());
  message.SetTimeStamp(
    static_cast<unsigned int>(seconds), static_cast<unsigned int>(std::ldexp(stamp - seconds, 32)));
  message.Pack();
  return { static_cast<const char*>(message.GetPackPointer()),
    static_cast<std::size_t>(message.GetPackSize()) };
}

inline std::string TransformBytes(
  const lacuna::Matrix4& pose, const std::string& device, double stamp = 0)
{
  const auto message = igtl::TransformMessage::New();
  igtl::Matrix4x4 matrix;
  ToIgtl(pose, matrix);
  message->SetMatrix(matrix);
  return Pack(*message, device, stamp);
}

inline std::string TrackingBytes(
  const std::map<std::string, lacuna::Matrix4>& poses, double stamp = 0, int type = 2)
{
  const auto message = igtl::TrackingDataMessage::New();
  for (const auto& [name, pose] : poses)
  {
    igtl::TrackingDataElement::Pointer element = igtl::TrackingDataElement::New();
    element->SetName(name.c_str());
    element->SetType(static_cast<igtlUint8>(type));
    igtl::Matrix4x4 matrix;
    ToIgtl(pose, matrix);
    element->SetMatrix(matrix);
    message->AddTrackingDataElement(element);
  }
  return Pack(*message, "TDATA_Elem", stamp);
}

/// plane: unit axes and the position of the first pixel; becomes that of the centre, as the protocol
/// has it.
inline std::string ImageBytes(int columns, int rows, const std::vector<char>& pixels,
  const std::string& device, double stamp = 0, int type = igtl::ImageMessage::TYPE_UINT8,
  int channels = 1, int endian = igtl::ImageMessage::ENDIAN_LITTLE,
  const std::array<float, 2>& spacing = { 0.2F, 0.3F },
  const lacuna::Matrix4& plane = AsymmetricPose())
{
  const auto message = igtl::ImageMessage::New();
  message->SetDimensions(columns, rows, 1);
  message->SetSpacing(spacing[0], spacing[1], 1);
  message->SetScalarType(type);
  message->SetNumComponents(channels);
  message->SetEndian(endian);
  message->AllocateScalars();
  Require(pixels.size() == static_cast<std::size_t>(message->GetImageSize()), "size of pixels");
  std::memcpy(message->GetScalarPointer(), pixels.data(), pixels.size());
  const lacuna::Vec3 centre =
    plane.Point({ 0.5 * (columns - 1) * spacing[0], 0.5 * (rows - 1) * spacing[1], 0 });
  igtl::Matrix4x4 matrix;
  ToIgtl(lacuna::Matrix4::FromColumns(plane.Column(0), plane.Column(1), plane.Column(2), centre),
    matrix);
  message->SetMatrix(matrix);
  return Pack(*message, device, stamp);
}

inline std::string StatusBytes(int code, const std::string& name, const std::string& text)
{
  const auto message = igtl::StatusMessage::New();
  message->SetCode(code);
  message->SetErrorName(name.c_str());
  message->SetStatusString(text.c_str());
  return Pack(*message, "Tracker", 0);
}

inline std::string BigEndian(std::uint64_t number, int size)
{
  std::string bytes;
  for (int i = size - 1; i >= 0; --i)
  {
    bytes += static_cast<char>(number >> (8 * i));
  }
  return bytes;
}

/// With another body, its size and checksum.
inline std::string WithBody(const std::string& message, std::string body)
{
  const std::uint64_t crc =
    crc64(reinterpret_cast<unsigned char*>(body.data()), static_cast<unsigned int>(body.size()), 0);
  return message.substr(0, 42) + BigEndian(body.size(), 8) + BigEndian(crc, 8) + body;
}

/// The message of header version 1 as one of version 2 or 3, as protocol 3 describes it: extended
/// header, content, index of the meta data, meta data.
inline std::string WithMetaData(
  const std::string& message, const std::map<std::string, std::string>& data, int version = 2)
{
  std::string index = BigEndian(data.size(), 2);
  std::string texts;
  for (const auto& [key, value] : data)
  {
    index += BigEndian(key.size(), 2) + BigEndian(3, 2) + BigEndian(value.size(), 4);
    texts += key + value;
  }
  const std::string extended =
    BigEndian(12, 2) + BigEndian(index.size(), 2) + BigEndian(texts.size(), 4) + BigEndian(77, 4);
  return BigEndian(static_cast<std::uint64_t>(version), 2) +
    WithBody(message, extended + message.substr(58) + index + texts).substr(2);
}

inline lacuna::OpenIGTLinkMessage Read(const std::string& bytes)
{
  return lacuna::MakeOpenIGTLinkMessage(lacuna::ReadOpenIGTLinkHeader(bytes.data()),
    std::vector<char>(bytes.begin() + 58, bytes.end()));
}

/// A server for one client after the other, on a port that the system chooses.
class Server
{
public:
  Server()
    : Socket(igtl::ServerSocket::New())
  {
    Require(this->Socket->CreateServer(0) == 0 && this->GetPort() > 0, "a server");
  }
  ~Server()
  {
    this->Hangup();
    this->Socket->CloseSocket();
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  int GetPort() { return this->Socket->GetServerPort(); }
  std::string GetAddress(const std::string& options = {})
  {
    return "igtl://127.0.0.1:" + std::to_string(this->GetPort()) + options;
  }
  /// False when no client came; the one before is kept then.
  bool Accept(unsigned long milliseconds = 2000)
  {
    const igtl::ClientSocket::Pointer client = this->Socket->WaitForConnection(milliseconds);
    if (client.IsNull())
    {
      return false;
    }
    this->Client = client;
    return true;
  }
  bool Send(const std::string& bytes)
  {
    return this->Client->Send(bytes.data(), static_cast<int>(bytes.size())) == 1;
  }
  std::string Receive(std::size_t size)
  {
    std::string bytes(size, '\0');
    this->Client->SetReceiveTimeout(2000);
    Require(this->Client->Receive(bytes.data(), static_cast<int>(size)) == static_cast<int>(size),
      "bytes of the client");
    return bytes;
  }
  void Hangup()
  {
    if (this->Client.IsNotNull())
    {
      this->Client->CloseSocket();
      this->Client = nullptr;
    }
  }

private:
  igtl::ServerSocket::Pointer Socket;
  igtl::ClientSocket::Pointer Client;
};
}
#endif
