// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// An emulated FASTRAK that the real libserialport opens. Link LacunaPseudoTerminalPorts.
#ifndef lacunaTestUnit_h
#define lacunaTestUnit_h

#include "lacunaClock.h"
#include "lacunaFastrakEmulator.h"
#include "lacunaPseudoTerminal.h"

#include <atomic>
#include <string>
#include <thread>
#include <utility>

namespace lacunaTest
{
/// The library takes names only that begin with /dev/.
inline std::string GetPort(const std::string& link)
{
  return "/dev/../../.." + link;
}

/// Plugged in, and unplugged when it is destroyed.
struct EmulatedUnit
{
  EmulatedUnit(const std::string& link, const lacuna::FastrakEmulatorOptions& options,
    lacuna::FastrakEmulator::PoseScript script)
    : Terminal(link)
    , Emulator(std::move(script), options)
    , Thread(
        [this]
        {
          this->Terminal.Serve(this->Emulator,
            [this]
            {
              this->Emulator.SetButton(this->Pressed, this->Clock.Now());
              return this->Ended.load();
            });
        })
  {
  }
  ~EmulatedUnit()
  {
    this->Ended = true;
    this->Thread.join();
  }
  lacuna::PseudoTerminal Terminal;
  lacuna::FastrakEmulator Emulator;
  lacuna::SteadyClock Clock;
  std::atomic<bool> Pressed{ false }; ///< the stylus's button
  std::atomic<bool> Ended{ false };
  std::thread Thread;
};
}
#endif
