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

// A vector divided by unit, each number after a comma.
std::string Fields(const Vec3& v, double unit = 1)
{
  return "," + FormatField(v[0] / unit) + "," + FormatField(v[1] / unit) + "," +
    FormatField(v[2] / unit);
}

std::string Filter(char letter, const std::array<double, 4>& parameters)
{
  std::string command(1, letter);
  const char* comma = "";
  for (const double parameter : parameters)
  {
    if (!(parameter >= 0 && parameter <= 1))
    {
      throw std::invalid_argument("The numbers of a FASTRAK's filter are from 0 to 1");
    }
    command += comma + FormatField(parameter);
    comma = ",";
  }
  return command + "\r";
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

std::string Boresight(int station)
{
  return Begin('B', station) + "\r";
}

std::string Unboresight(int station)
{
  return Begin('b', station) + "\r";
}

std::string ReferenceAngles(int station, const Vec3& angles)
{
  return Begin('G', station) + Fields(angles) + "\r";
}

std::string Alignment(
  int station, const Vec3& origin, const Vec3& onX, const Vec3& onY, LengthUnit unit)
{
  const double mm = GetMillimetres(unit);
  return Begin('A', station) + Fields(origin, mm) + Fields(onX, mm) + Fields(onY, mm) + "\r";
}

std::string ResetAlignment(int station)
{
  return Begin('R', station) + "\r";
}

std::string Mounting(int station, const Vec3& angles)
{
  return Begin('r', station) + Fields(angles) + "\r";
}

std::string TipOffset(int station, const Vec3& offset, LengthUnit unit)
{
  return Begin('N', station) + Fields(offset, GetMillimetres(unit)) + "\r";
}

std::string Increment(int station, double distance, LengthUnit unit)
{
  return Begin('I', station) + "," + FormatField(distance / GetMillimetres(unit)) + "\r";
}

std::string PositionEnvelope(int station, const Vec3& maximum, const Vec3& minimum, LengthUnit unit)
{
  const double mm = GetMillimetres(unit);
  return Begin('V', station) + Fields(maximum, mm) + Fields(minimum, mm) + "\r";
}

std::string AngularEnvelope(int station, const Vec3& maximum, const Vec3& minimum)
{
  return Begin('Q', station) + Fields(maximum) + Fields(minimum) + "\r";
}

std::string ButtonAsksForRecord(int station, bool on)
{
  return Begin('e', station) + (on ? ",1\r" : ",0\r");
}

std::string PositionFilter(const std::array<double, 4>& parameters)
{
  return Filter('x', parameters);
}

std::string PositionFilterOff()
{
  return "x,1\r";
}

std::string AttitudeFilter(const std::array<double, 4>& parameters)
{
  return Filter('v', parameters);
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

std::string Ask(char command, int station)
{
  return Begin(command, station) + "\r";
}
}
}
