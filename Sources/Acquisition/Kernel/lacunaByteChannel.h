// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A line to a device, both ways.
#ifndef lacunaByteChannel_h
#define lacunaByteChannel_h

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace lacuna
{
/// Why a channel does not work; the text names it and says what to do.
class ChannelError : public std::runtime_error
{
public:
  enum class Kind
  {
    NotFound,    ///< there is no such port
    Permission,  ///< the user may not open it
    Busy,        ///< another program has it
    Unplugged,   ///< it was there and is gone
    Unsupported, ///< its settings, or this build
    Other
  };
  ChannelError(Kind kind, const std::string& message)
    : std::runtime_error(message)
    , Reason(kind)
  {
  }
  Kind GetKind() const { return this->Reason; }

private:
  Kind Reason;
};

/// All functions throw ChannelError when the line is broken.
class ByteChannel
{
public:
  virtual ~ByteChannel() = default;
  /// Waits up to the seconds given for at least one byte and returns how many it took; 0: none came.
  virtual std::size_t Read(char* bytes, std::size_t size, double seconds) = 0;
  /// Gives all bytes to the line, without waiting until they have left.
  virtual void Write(std::string_view bytes) = 0;
  /// For messages.
  virtual std::string GetName() const = 0;
  /// Bits a second, ten to a byte; 0: not known, or it has none.
  virtual int GetBaud() const = 0;
};
}
#endif
