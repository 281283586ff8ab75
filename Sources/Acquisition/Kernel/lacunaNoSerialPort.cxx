// SPDX-License-Identifier: BSD-3-Clause
// SerialPort of a build without libserialport.
#include "lacunaSerialPort.h"

namespace lacuna
{
struct SerialPort::Handle
{
};

SerialPort::SerialPort(const std::string& name, int baud)
  : Name(name)
  , Baud(baud)
{
  throw ChannelError(ChannelError::Kind::Unsupported,
    "The port " + name +
      " cannot be opened: this Lacuna was built without libserialport "
      "(LACUNA_WITH_SERIALPORT=OFF)");
}

SerialPort::~SerialPort() = default;

std::size_t SerialPort::Read(char*, std::size_t, double)
{
  return 0;
}

void SerialPort::Write(std::string_view) {}

std::vector<std::string> SerialPort::List()
{
  return {};
}
}
