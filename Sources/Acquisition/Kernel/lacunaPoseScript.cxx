// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPoseScript.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <istream>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace lacuna
{
namespace
{
constexpr double Endless = std::numeric_limits<double>::infinity();
constexpr double StationDistance = 100; // mm
constexpr std::size_t Columns = 8;

[[noreturn]] void ThrowLine(const std::string& name, int number, const char* why)
{
  throw std::runtime_error(name + ", line " + std::to_string(number) + ": " + why);
}

// The numbers of a line; nothing when a word is none.
std::optional<std::vector<double>> ReadNumbers(std::string_view line)
{
  constexpr std::string_view separators = " \t\r,;";
  std::vector<double> numbers;
  line = line.substr(0, line.find('#'));
  for (std::size_t begin = line.find_first_not_of(separators); begin != std::string_view::npos;
       begin = line.find_first_not_of(separators))
  {
    line.remove_prefix(begin);
    const std::string_view word = line.substr(0, line.find_first_of(separators));
    double number = 0;
    const auto result = std::from_chars(word.data(), word.data() + word.size(), number);
    if (result.ec != std::errc() || result.ptr != word.data() + word.size() ||
      !std::isfinite(number))
    {
      return std::nullopt;
    }
    numbers.push_back(number);
    line.remove_prefix(word.size());
  }
  return numbers;
}
}

PoseScript::PoseScript(std::istream& text, const std::string& name)
{
  for (Motion& motion : this->Motions)
  {
    motion.Track = PoseTrack(Endless, Endless);
  }
  std::string line;
  for (int number = 1; std::getline(text, line); ++number)
  {
    const auto fail = [&](const char* why) { ThrowLine(name, number, why); };
    const auto read = ReadNumbers(line);
    if (read && read->empty())
    {
      continue;
    }
    if (!read || read->size() != Columns)
    {
      fail("a line has 8 numbers, time station x y z azimuth elevation roll (s, mm, degrees)");
    }
    const std::vector<double>& values = *read;
    const int station =
      values[1] >= 1 && values[1] <= FastrakStations ? static_cast<int>(values[1]) : 0;
    if (station != values[1])
    {
      fail("the station is 1 to 4");
    }
    TrackedPose pose;
    pose.Time = values[0];
    pose.Station = station;
    pose.ReceiverToTransmitter = Matrix4::Translation({ values[2], values[3], values[4] }) *
      FastrakRotation(Vec3{ values[5], values[6], values[7] });
    Motion& motion = this->Motions[station - 1];
    if (!motion.Track.IsAhead(pose.Time))
    {
      fail("the times of a station ascend");
    }
    motion.Track.Add(pose);
    motion.First = motion.Present ? motion.First : pose;
    motion.Last = pose;
    motion.Present = true;
    this->FirstStation = this->FirstStation ? this->FirstStation : station;
    this->Duration = std::max(this->Duration, pose.Time);
  }
  if (this->FirstStation == 0)
  {
    throw std::runtime_error(name + " has no poses");
  }
}

Matrix4 PoseScript::operator()(double time, int station) const
{
  const Motion& motion = this->Motions[station - 1];
  if (!motion.Present)
  {
    return Matrix4::Translation({ 0, StationDistance * (station - this->FirstStation), 0 }) *
      (*this)(time, this->FirstStation);
  }
  const double within = std::clamp(time, motion.First.Time, motion.Last.Time);
  return motion.Track.At(within)->ReceiverToTransmitter;
}

Matrix4 EverydaySweep(double time, int station)
{
  constexpr double turn = 2 * 3.14159265358979323846 / EverydayPeriod;
  return Matrix4::Translation({ 200 + 3 * std::sin(1.7 * time),
           40 * std::sin(turn * time) + StationDistance * (station - 1),
           -60 + 2 * std::cos(1.3 * time) }) *
    FastrakRotation(
      Vec3{ 4 * std::sin(0.9 * time), 20 + 3 * std::cos(0.7 * time), 2 * std::sin(1.1 * time) });
}
}
