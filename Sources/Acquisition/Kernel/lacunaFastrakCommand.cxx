// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFastrakCommand.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

namespace lacuna
{
namespace FastrakCommand
{
namespace
{
std::string FormatField(double value)
{
  if (!std::isfinite(value))
  {
    throw std::invalid_argument("A number for a FASTRAK must be finite");
  }
  std::array<char, 400> text{};
  const auto result =
    std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, 4);
  return { text.data(), result.ptr };
}

std::string Begin(char letter, int station)
{
  if (station < 1 || station > FastrakStations)
  {
    throw std::invalid_argument(
      "A FASTRAK has the stations 1 to 4, not " + std::to_string(station));
  }
  return std::string(1, letter) + std::to_string(station);
}

std::string Fields(const Vec3& v)
{
  return "," + FormatField(v[0]) + "," + FormatField(v[1]) + "," + FormatField(v[2]);
}
}

std::string OutputList(int station, const FastrakLayout& layout)
{
  std::string command = Begin('O', station);
  for (const FastrakItem item : layout.GetItems())
  {
    command += "," + std::to_string(static_cast<int>(item));
  }
  return command + "\r";
}

std::string Hemisphere(int station, const Vec3& zenith)
{
  return Begin('H', station) + Fields(zenith) + "\r";
}

std::string Active(int station, bool on)
{
  return Begin('l', station) + (on ? ",1\r" : ",0\r");
}

std::string Unboresight(int station)
{
  return Begin('b', station) + "\r";
}

std::string ResetAlignment(int station)
{
  return Begin('R', station) + "\r";
}

std::string ButtonAsksForRecord(int station, bool on)
{
  return Begin('e', station) + (on ? ",1\r" : ",0\r");
}

std::string PositionFilterOff()
{
  return "x,1\r";
}

std::string AttitudeFilterOff()
{
  return "v,1\r";
}

std::string SerialRate(int baud)
{
  constexpr std::array<int, 7> rates{ 2400, 4800, 9600, 19200, 38400, 57600, 115200 };
  if (std::find(rates.begin(), rates.end(), baud) == rates.end())
  {
    throw std::invalid_argument("A FASTRAK has the rates 2400, 4800, 9600, 19200, 38400, 57600 and "
                                "115200 baud, not " +
      std::to_string(baud));
  }
  return "o" + std::to_string(baud / 100) + ",N,8,0\r";
}
}
}
