// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaEmulatedChannel.h"

#include <algorithm>

namespace lacuna
{
EmulatedChannel::EmulatedChannel(FastrakEmulator& emulator, int baud, double time)
  : Emulator(emulator)
  , Baud(baud)
  , Time(time)
{
}

std::size_t EmulatedChannel::Read(char* bytes, std::size_t size, double seconds)
{
  const double end = this->Time + std::max(0.0, seconds);
  this->Arrived += this->Emulator.Send(this->Time);
  while (this->Arrived.empty() && this->Time < end)
  {
    const auto next = this->Emulator.GetNextTime();
    this->Time = next ? std::clamp(*next, this->Time, end) : end;
    this->Arrived += this->Emulator.Send(this->Time);
  }
  const std::size_t count = std::min(size, this->Arrived.size());
  std::copy_n(this->Arrived.begin(), count, bytes);
  this->Arrived.erase(0, count);
  return count;
}

void EmulatedChannel::Write(std::string_view bytes)
{
  this->Emulator.Receive(bytes, this->Time);
}
}
