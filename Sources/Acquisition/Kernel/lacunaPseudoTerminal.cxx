// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPseudoTerminal.h"

#include "lacunaByteChannel.h"
#include "lacunaClock.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

namespace lacuna
{
namespace
{
constexpr double LongestWait = 0.05; // s

struct Rate
{
  speed_t Code;
  int Baud;
};
// those of the FASTRAK
constexpr std::array<Rate, 7> Rates{ { { B2400, 2400 }, { B4800, 4800 }, { B9600, 9600 },
  { B19200, 19200 }, { B38400, 38400 }, { B57600, 57600 }, { B115200, 115200 } } };

void Garble(char* bytes, std::size_t count)
{
  for (std::size_t i = 0; i < count; ++i)
  {
    bytes[i] = static_cast<char>(bytes[i] ^ (0xa5 + 2 * (i % 16)));
  }
}

[[noreturn]] void Throw(const std::string& what)
{
  throw ChannelError(ChannelError::Kind::Other, what + " (" + std::strerror(errno) + ")");
}
}

PseudoTerminal::PseudoTerminal(const std::string& link)
{
  this->Master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  std::array<char, 128> name{};
  if (this->Master < 0 || grantpt(this->Master) != 0 || unlockpt(this->Master) != 0 ||
    ptsname_r(this->Master, name.data(), name.size()) != 0 ||
    fcntl(this->Master, F_SETFL, O_NONBLOCK) != 0)
  {
    Throw("A pseudo-terminal cannot be made");
  }
  this->Terminal = name.data();
  this->Slave = open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios settings{};
  if (this->Slave < 0 || tcgetattr(this->Slave, &settings) != 0)
  {
    Throw("The pseudo-terminal " + this->Terminal + " cannot be set up");
  }
  cfmakeraw(&settings);
  tcsetattr(this->Slave, TCSANOW, &settings);
  if (!link.empty())
  {
    struct stat information = {};
    if (lstat(link.c_str(), &information) == 0 && S_ISLNK(information.st_mode) &&
      stat(link.c_str(), &information) != 0)
    {
      unlink(link.c_str()); // left over
    }
    if (symlink(name.data(), link.c_str()) != 0)
    {
      const int error = errno;
      close(this->Master);
      close(this->Slave);
      errno = error;
      Throw("The name '" + link + "' cannot be made to point at the port");
    }
    this->Link = link;
  }
}

PseudoTerminal::~PseudoTerminal()
{
  if (!this->Link.empty())
  {
    unlink(this->Link.c_str());
  }
  close(this->Slave);
  close(this->Master);
}

int PseudoTerminal::GetHostBaud() const
{
  termios settings{};
  const speed_t code = tcgetattr(this->Slave, &settings) == 0 ? cfgetospeed(&settings) : B0;
  const auto rate =
    std::find_if(Rates.begin(), Rates.end(), [&](const Rate& each) { return each.Code == code; });
  return rate == Rates.end() ? 0 : rate->Baud;
}

void PseudoTerminal::Serve(FastrakEmulator& emulator, const std::function<bool()>& stopped)
{
  const SteadyClock clock;
  std::array<char, 512> input{};
  while (!stopped())
  {
    const auto next = emulator.GetNextTime();
    const double wait = std::clamp(next ? *next - clock.Now() : LongestWait, 0.0, LongestWait);
    const auto nanoseconds = static_cast<long>(std::ceil(1e9 * wait));
    const timespec time{ 0, nanoseconds };
    pollfd line{ this->Master, POLLIN, 0 };
    ppoll(&line, 1, &time, nullptr);
    const ssize_t count = read(this->Master, input.data(), input.size());
    const bool understood = this->GetHostBaud() == emulator.GetBaud();
    if (count > 0)
    {
      if (!understood)
      {
        Garble(input.data(), static_cast<std::size_t>(count));
      }
      emulator.Receive({ input.data(), static_cast<std::size_t>(count) }, clock.Now());
    }
    std::string output = emulator.Send(clock.Now());
    if (!understood)
    {
      Garble(output.data(), output.size());
    }
    // a host that does not read loses bytes, as on a serial line
    if (!output.empty() && write(this->Master, output.data(), output.size()) < 0 &&
      errno != EAGAIN && errno != EINTR)
    {
      Throw("The pseudo-terminal " + this->Terminal + " is broken");
    }
  }
}
}
