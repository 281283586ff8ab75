// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSerialPort.h"

#include <libserialport.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>

#include <sys/file.h>
#include <sys/ioctl.h>

namespace lacuna
{
namespace
{
constexpr unsigned int WriteTime = 500; // ms for a few hundred bytes at any rate

std::string ListText()
{
  std::string text;
  for (const std::string& port : SerialPort::List())
  {
    text += (text.empty() ? " The ports of this computer are " : ", ") + port;
  }
  return text.empty() ? " This computer has no serial port now: is the adapter plugged in?"
                      : text + ".";
}

[[noreturn]] void ThrowUnplugged(const std::string& name, const std::string& reason)
{
  throw ChannelError(ChannelError::Kind::Unplugged,
    "The port " + name + " is gone (" + reason + "): plug its adapter in again");
}

[[noreturn]] void ThrowBusy(const std::string& name)
{
  throw ChannelError(ChannelError::Kind::Busy,
    "The port " + name + " is in use: end the other program that has it open");
}

[[noreturn]] void ThrowOpening(const std::string& name, sp_return result)
{
  const int error = result == SP_ERR_FAIL ? sp_last_error_code() : 0;
  switch (error)
  {
    case EACCES:
    case EPERM:
      throw ChannelError(ChannelError::Kind::Permission,
        "You may not open the port " + name +
          ": on Debian, as root run 'adduser USER dialout' with your name for USER, and log in "
          "again");
    case EBUSY:
    case EWOULDBLOCK: // locked, since libserialport 0.1.2
      ThrowBusy(name);
    case ENOENT:
    case ENODEV:
    case ENXIO:
      throw ChannelError(
        ChannelError::Kind::NotFound, "There is no port " + name + "." + ListText());
    default:
      throw ChannelError(ChannelError::Kind::Other,
        "The port " + name + " cannot be opened" +
          (error ? std::string(" (") + std::strerror(error) + ")" : "") + "." + ListText());
  }
}

// What the library says of a call that failed on an open port.
std::string Reason(int result)
{
  return result == SP_ERR_FAIL ? std::strerror(sp_last_error_code())
                               : "error " + std::to_string(result);
}
}

struct SerialPort::Handle
{
  ~Handle()
  {
    if (this->Open)
    {
      ioctl(this->GetFile(), TIOCNXCL);
      sp_close(this->Port);
    }
    sp_free_port(this->Port);
    sp_free_event_set(this->Events);
  }
  int GetFile() const
  {
    int file = -1;
    sp_get_port_handle(this->Port, &file);
    return file;
  }
  sp_port* Port = nullptr;
  sp_event_set* Events = nullptr;
  bool Open = false;
};

SerialPort::SerialPort(const std::string& name, int baud)
  : Name(name)
  , Baud(baud)
  , Port(std::make_unique<Handle>())
{
  if (baud <= 0)
  {
    throw ChannelError(ChannelError::Kind::Unsupported,
      "The baud rate of a port is positive, not " + std::to_string(baud));
  }
  sp_return result = sp_get_port_by_name(name.c_str(), &this->Port->Port);
  if (result == SP_ERR_ARG)
  {
    std::error_code none;
    const char* const hint = name.rfind("/dev/", 0) != 0 && std::filesystem::exists(name, none)
      ? ": such a file is there, but ports are below /dev; the user guide's page on emulated "
        "devices says how a pseudo-terminal is opened."
      : ".";
    throw ChannelError(
      ChannelError::Kind::NotFound, "There is no port " + name + hint + ListText());
  }
  if (result == SP_OK)
  {
    result = sp_open(this->Port->Port, SP_MODE_READ_WRITE);
  }
  if (result != SP_OK)
  {
    ThrowOpening(name, result);
  }
  this->Port->Open = true;
  // the library shares the port: two programs would each get some of the bytes
  if (flock(this->Port->GetFile(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
  {
    ThrowBusy(name);
  }
  ioctl(this->Port->GetFile(), TIOCEXCL);
  sp_port* port = this->Port->Port;
  for (const sp_return set :
    { sp_set_baudrate(port, baud), sp_set_bits(port, 8), sp_set_parity(port, SP_PARITY_NONE),
      sp_set_stopbits(port, 1), sp_set_flowcontrol(port, SP_FLOWCONTROL_NONE) })
  {
    if (set != SP_OK)
    {
      throw ChannelError(ChannelError::Kind::Unsupported,
        "The port " + name + " does not take " + std::to_string(baud) +
          " baud, 8 data bits, no parity (" + Reason(set) + ")");
    }
  }
  sp_flush(port, SP_BUF_BOTH);
  if (sp_new_event_set(&this->Port->Events) != SP_OK ||
    sp_add_port_events(this->Port->Events, port, SP_EVENT_RX_READY) != SP_OK)
  {
    throw ChannelError(ChannelError::Kind::Other, "The port " + name + " cannot be watched");
  }
}

SerialPort::~SerialPort() = default;

std::size_t SerialPort::Read(char* bytes, std::size_t size, double seconds)
{
  // a time of 0 would mean for ever; and the wait itself does not take the bytes one by one
  const auto milliseconds = static_cast<unsigned int>(std::ceil(1000 * seconds));
  // a number of bytes, which is none of the enumeration's values
  int count = sp_nonblocking_read(this->Port->Port, bytes, size);
  if (count == 0 && milliseconds > 0)
  {
    const sp_return waited = sp_wait(this->Port->Events, milliseconds);
    if (waited != SP_OK)
    {
      ThrowUnplugged(this->Name, Reason(waited));
    }
    count = sp_nonblocking_read(this->Port->Port, bytes, size);
  }
  if (count < 0)
  {
    ThrowUnplugged(this->Name, Reason(count));
  }
  if (count == 0 && sp_input_waiting(this->Port->Port) < 0)
  {
    ThrowUnplugged(this->Name, Reason(SP_ERR_FAIL)); // hung up: ready to read for ever
  }
  return static_cast<std::size_t>(count);
}

void SerialPort::Write(std::string_view bytes)
{
  const int count = sp_blocking_write(this->Port->Port, bytes.data(), bytes.size(), WriteTime);
  if (count < 0)
  {
    ThrowUnplugged(this->Name, Reason(count));
  }
  if (static_cast<std::size_t>(count) < bytes.size())
  {
    throw ChannelError(ChannelError::Kind::Other,
      "The port " + this->Name + " takes no bytes: a handshake of its adapter holds it");
  }
}

std::vector<std::string> SerialPort::List()
{
  std::vector<std::string> names;
  sp_port** ports = nullptr;
  if (sp_list_ports(&ports) != SP_OK)
  {
    return names;
  }
  for (sp_port** port = ports; *port; ++port)
  {
    const char* description = sp_get_port_description(*port);
    names.push_back(std::string(sp_get_port_name(*port)) +
      (description ? " (" + std::string(description) + ")" : ""));
  }
  sp_free_port_list(ports);
  return names;
}
}
