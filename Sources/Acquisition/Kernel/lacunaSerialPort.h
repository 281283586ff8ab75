// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Serial ports, through libserialport.
#ifndef lacunaSerialPort_h
#define lacunaSerialPort_h

#include "lacunaByteChannel.h"

#include <memory>
#include <string>
#include <vector>

namespace lacuna
{
/// An open port: 8 data bits, no parity, one stop bit, no handshake. Unplugging makes Read and Write
/// throw ChannelError::Kind::Unplugged; a new SerialPort is needed then. All functions throw
/// ChannelError; in a build without libserialport (LACUNA_WITH_SERIALPORT) the constructor does.
class SerialPort : public ByteChannel
{
public:
  /// name as the system has it, "/dev/ttyUSB0".
  SerialPort(const std::string& name, int baud);
  ~SerialPort() override;
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  std::size_t Read(char* bytes, std::size_t size, double seconds) override;
  void Write(std::string_view bytes) override;
  std::string GetName() const override { return this->Name; }
  int GetBaud() const override { return this->Baud; }

  /// The ports of this computer, "/dev/ttyUSB0 (USB-Serial Controller)", for messages and choices.
  static std::vector<std::string> List();

private:
  struct Handle;
  std::string Name;
  int Baud;
  std::unique_ptr<Handle> Port;
};
}
#endif
