// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Connections to servers of the network.
#ifndef lacunaTcpChannel_h
#define lacunaTcpChannel_h

#include "lacunaByteChannel.h"

#include <functional>
#include <string>

namespace lacuna
{
/// A TCP connection. When the other side closes it, or the network between breaks for some seconds,
/// Read and Write throw ChannelError::Kind::Unplugged; a new TcpChannel is needed then.
class TcpChannel : public ByteChannel
{
public:
  /// Connects, and gives up with a ChannelError after so many seconds for each address of the host,
  /// or with Aborted when stopped says so, which is asked every 50 ms. name is for messages.
  TcpChannel(const std::string& host, int port, const std::string& name, double seconds,
    const std::function<bool()>& stopped);
  ~TcpChannel() override;
  TcpChannel(const TcpChannel&) = delete;
  TcpChannel& operator=(const TcpChannel&) = delete;

  std::size_t Read(char* bytes, std::size_t size, double seconds) override;
  void Write(std::string_view bytes) override;
  std::string GetName() const override { return this->Name; }
  int GetBaud() const override { return 0; }

private:
  [[noreturn]] void ThrowLost(const std::string& reason) const;

  std::string Name;
  int Socket = -1;
};
}
#endif
