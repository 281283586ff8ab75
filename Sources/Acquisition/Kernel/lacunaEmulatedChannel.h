// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// An emulated FASTRAK in simulated time: half an hour passes in a second.
#ifndef lacunaEmulatedChannel_h
#define lacunaEmulatedChannel_h

#include "lacunaByteChannel.h"
#include "lacunaClock.h"
#include "lacunaFastrakEmulator.h"

#include <string>

namespace lacuna
{
/// A line to an emulator whose time goes on while a reader waits, and only then. It is the clock of
/// that time.
class EmulatedChannel
  : public ByteChannel
  , public Clock
{
public:
  /// The emulator must live longer; baud is its rate, time when the line is opened, not before the
  /// end of an earlier line to it.
  EmulatedChannel(FastrakEmulator& emulator, int baud, double time = 0);

  std::size_t Read(char* bytes, std::size_t size, double seconds) override;
  void Write(std::string_view bytes) override;
  std::string GetName() const override { return "emulated FASTRAK"; }
  int GetBaud() const override { return this->Baud; }
  double Now() const override { return this->Time; }

private:
  FastrakEmulator& Emulator;
  int Baud;
  double Time;
  std::string Arrived;
};
}
#endif
