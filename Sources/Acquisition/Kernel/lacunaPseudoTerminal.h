// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// An emulated FASTRAK that other programs open as a serial port.
#ifndef lacunaPseudoTerminal_h
#define lacunaPseudoTerminal_h

#include "lacunaFastrakEmulator.h"

#include <functional>
#include <string>

namespace lacuna
{
/// A pseudo-terminal with an emulator behind it, in real time. Throws ChannelError.
class PseudoTerminal
{
public:
  /// link, if not empty, is a name that is made to point at the terminal and removed in the end; it
  /// must not exist, unless as a link to nowhere.
  explicit PseudoTerminal(const std::string& link = {});
  ~PseudoTerminal();
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  /// The port to open.
  const std::string& GetName() const { return this->Link.empty() ? this->Terminal : this->Link; }
  /// Carries bytes to and fro at the emulator's pace until stopped says so, asked at least every
  /// 50 ms. Times are those of SteadyClock. While the host has set another baud rate than the
  /// emulator's, every byte becomes another, both ways, as on a line.
  void Serve(FastrakEmulator& emulator, const std::function<bool()>& stopped);

private:
  int GetHostBaud() const;

  int Master = -1;
  int Slave = -1; ///< kept open, so that a host can close and open again
  std::string Terminal;
  std::string Link;
};
}
#endif
