// SPDX-License-Identifier: BSD-3-Clause
// A program that misbehaves in the place of lacuna-decode, in the way that its name says.
#include "lacunaDecoderProtocol.h"

#include <string>

#include <sys/socket.h>
#include <unistd.h>

int main(int, char* arguments[])
{
  const std::string path = arguments[0];
  const std::string name = path.substr(path.rfind('/') + 1);
  lacuna::DecoderReply hello;
  if (name == "missing-library")
  {
    return 127;
  }
  if (name == "silent")
  {
    pause();
  }
  if (name == "another")
  {
    ++hello.Version;
  }
  if (send(lacuna::DecoderSocket, &hello, sizeof hello, 0) < 0 || name == "short")
  {
    return 1;
  }
  pause(); // takes images and says nothing
  return 0;
}
