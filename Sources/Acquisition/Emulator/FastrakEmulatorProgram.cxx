// SPDX-License-Identifier: BSD-3-Clause
// A FASTRAK without hardware, on a pseudo-terminal, and the video of a scanner.
#include "lacunaClock.h"
#include "lacunaEmulatorSettings.h"
#include "lacunaPseudoTerminal.h"
#include "lacunaVideoProgram.h"

#include <csignal>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <memory>
#include <stdexcept>
#include <vector>

namespace
{
volatile std::sig_atomic_t interrupted = 0;

void Interrupt(int)
{
  interrupted = 1;
}
}

int main(int count, char** arguments)
{
  lacuna::EmulatorSettings settings;
  try
  {
    settings = lacuna::ReadEmulatorSettings(
      std::vector<std::string>(arguments + 1, arguments + (count > 0 ? count : 1)));
    if (settings.Help)
    {
      std::fputs(lacuna::EmulatorHelp, stdout);
      return 0;
    }
  }
  catch (const std::exception& e)
  {
    std::fprintf(stderr, "lacuna-fastrak-emulator: %s\n", e.what());
    return 2;
  }
  std::signal(SIGINT, Interrupt);
  std::signal(SIGTERM, Interrupt);
  try
  {
    lacuna::PseudoTerminal terminal(settings.Link);
    const lacuna::SteadyClock clock;
    const double begin = clock.Now();
    lacuna::FastrakEmulator emulator([&](double time, int station)
      { return settings.Motion(time - begin, station); },
      settings.Options);
    std::printf("FASTRAK at %d baud on %s\n", settings.Options.Baud, terminal.GetName().c_str());
    std::fflush(stdout);
    std::unique_ptr<lacuna::VideoProgram> video;
    if (!settings.Video.Service.Sender.URL.empty())
    {
      video = std::make_unique<lacuna::VideoProgram>(settings, clock, begin);
    }
    std::size_t next = 0;
    terminal.Serve(emulator,
      [&]
      {
        const double time = clock.Now() - begin;
        for (; next < settings.Events.size() && settings.Events[next].Time <= time; ++next)
        {
          settings.Events[next].Apply(emulator, clock.Now());
        }
        return interrupted != 0 || time >= settings.Duration || (video && video->HasFailed());
      });
    if (video)
    {
      video->Finish();
    }
  }
  catch (const std::exception& e)
  {
    std::fprintf(stderr, "lacuna-fastrak-emulator: %s\n", e.what());
    return 1;
  }
  return 0;
}
