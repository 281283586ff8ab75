// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Addresses of this computer for tests.
#ifndef lacunaTestPort_h
#define lacunaTestPort_h

#include <gtest/gtest.h>

#include <string>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace lacunaTest
{
/// An address at which nobody listens now.
inline std::string FreeAddress()
{
  const int line = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  EXPECT_EQ(bind(line, reinterpret_cast<sockaddr*>(&address), size), 0);
  EXPECT_EQ(getsockname(line, reinterpret_cast<sockaddr*>(&address), &size), 0);
  close(line);
  return "tcp://127.0.0.1:" + std::to_string(ntohs(address.sin_port));
}
}
#endif
