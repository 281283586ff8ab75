// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFastrakEmulator.h"

#include "lacunaFastrakCommand.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

namespace lacuna
{
namespace
{
constexpr double Cycle = 1 / 120.0;     // one receiver's measurement
constexpr double LongestBacklog = 0.25; // s of output; records beyond are skipped, as by the unit
constexpr std::string_view WithoutEffect = "BbGINoQrVvXxy";
constexpr std::string_view Letters = "PCcFfUuSWDd\x0b\x19\x13\x11"; // that are whole commands
constexpr std::size_t LongestLine = 256;

enum Code
{
  Missing = -1,
  NotNumeric = -2,
  OutOfRange = -3,
  Unknown = -99
};

// The numbers after a command's letter; an empty field is nothing. False when one is no number.
bool SplitFields(std::string_view text, std::vector<std::optional<double>>& fields)
{
  while (true)
  {
    const std::size_t comma = text.find(',');
    const std::string_view field = text.substr(0, comma);
    fields.emplace_back();
    if (!field.empty())
    {
      double value = 0;
      const auto result = std::from_chars(field.data(), field.data() + field.size(), value);
      if (result.ec != std::errc() || result.ptr != field.data() + field.size())
      {
        return false;
      }
      fields.back() = value;
    }
    if (comma == std::string_view::npos)
    {
      return true;
    }
    text.remove_prefix(comma + 1);
  }
}

std::string FormatColumn(double value)
{
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%7.2f", value);
  std::replace(text.begin(), text.end(), ',', '.');
  return text.data();
}

std::string DescribeLayout(const FastrakLayout& layout)
{
  std::string items;
  for (const FastrakItem item : layout.GetItems())
  {
    const std::string text = std::to_string(static_cast<int>(item));
    items += std::string(2 - text.size(), ' ') + text;
  }
  return items;
}

// From the fields of a command after the station's number; false where they make no layout.
bool SetLayout(const std::vector<std::optional<double>>& fields, FastrakLayout& layout)
{
  std::vector<int> numbers;
  for (std::size_t i = 1; i < fields.size(); ++i)
  {
    const double item = fields[i].value_or(-1);
    numbers.push_back(item >= 0 && item < 100 ? static_cast<int>(item) : -1);
  }
  try
  {
    layout = FastrakLayout::FromNumbers(numbers);
  }
  catch (const std::invalid_argument&)
  {
    return false;
  }
  return true;
}
}

FastrakEmulator::FastrakEmulator(PoseScript script, const FastrakEmulatorOptions& options)
  : Script(std::move(script))
  , Options(options)
  , Random(options.Seed)
{
  FastrakCommand::SerialRate(options.Baud); // throws for one that the unit does not have
  this->Reset();
}

void FastrakEmulator::Reset()
{
  for (int i = 0; i < FastrakStations; ++i)
  {
    this->Stations[i] = Station();
    this->Stations[i].Active = this->Options.Receivers[i];
  }
  this->Format = FastrakFormat();
  this->Continuous = false;
  this->Suspended = false;
  this->ButtonAsks = true;
  this->Line.clear();
}

void FastrakEmulator::Receive(std::string_view bytes, double time)
{
  const double byteTime = 10.0 / this->Options.Baud;
  for (const char c : bytes)
  {
    const double begin = std::max(time, this->InputFree);
    this->InputFree = begin + byteTime;
    this->SendContinuous(begin);
    if (begin >= this->DeafUntil)
    {
      this->Take(c, begin, this->InputFree);
    }
  }
}

void FastrakEmulator::Take(char c, double begin, double end)
{
  if (c == '\r')
  {
    const std::string line = std::exchange(this->Line, std::string());
    if (!line.empty())
    {
      this->ActOnLine(line, end);
    }
    return;
  }
  if (c == '\n' || (this->Line.empty() && this->ActOnLetter(c, begin, end)))
  {
    return;
  }
  this->Line += c;
  if (this->Line.size() > LongestLine)
  {
    const std::string start = this->Line.substr(0, 8);
    this->Line.clear();
    this->Complain(start, Unknown, end);
  }
}

// Whether a fault takes a command away.
bool FastrakEmulator::IsSpoilt(const std::string& command, double end)
{
  const FastrakFaults& faults = this->Options.Faults;
  if (faults.Refused.find(command[0]) != std::string::npos)
  {
    this->Complain(command, Unknown, end);
    return true;
  }
  return faults.Ignored.find(command[0]) != std::string::npos;
}

bool FastrakEmulator::ActOnLetter(char c, double begin, double end)
{
  if (Letters.find(c) != std::string_view::npos && this->IsSpoilt(std::string(1, c), end))
  {
    return true;
  }
  switch (c)
  {
    case FastrakCommand::Point:
      this->SendRecords(begin + this->Options.SampleLatency, end + this->Options.AnswerLatency);
      return true;
    case FastrakCommand::Continuous:
      this->Continuous = true;
      this->NextContinuous = end;
      return true;
    case FastrakCommand::StopContinuous:
      this->Continuous = false;
      return true;
    case FastrakCommand::Ascii:
    case FastrakCommand::Binary:
      this->Format.Binary = c == FastrakCommand::Binary;
      return true;
    case FastrakCommand::Inches:
      this->Format.Unit = LengthUnit::Inch;
      return true;
    case FastrakCommand::Centimetres:
      this->Format.Unit = LengthUnit::Centimetre;
      return true;
    case FastrakCommand::Status:
      this->AnswerStatus(end);
      return true;
    case FastrakCommand::Defaults:
      this->Reset();
      return true;
    case FastrakCommand::Save:
    case FastrakCommand::CompensationOn:
    case FastrakCommand::CompensationOff:
      return true;
    case FastrakCommand::Reinitialise:
      this->Reset();
      this->Output.clear();
      this->DeafUntil = end + this->Options.StartTime;
      return true;
    case FastrakCommand::Suspend:
      this->Suspended = true;
      return true;
    case FastrakCommand::Resume:
      this->Suspended = false;
      return true;
    default:
      return false;
  }
}

void FastrakEmulator::ActOnLine(const std::string& line, double end)
{
  const char letter = line[0];
  if (this->IsSpoilt(line, end))
  {
    return;
  }
  if (WithoutEffect.find(letter) != std::string_view::npos)
  {
    return;
  }
  if (std::string_view("lOHeAR").find(letter) == std::string_view::npos)
  {
    this->Complain(line, Unknown, end);
    return;
  }
  std::vector<std::optional<double>> fields;
  if (!SplitFields(std::string_view(line).substr(1), fields))
  {
    this->Complain(line, NotNumeric, end);
    return;
  }
  if (!fields[0])
  {
    this->Complain(line, Missing, end);
    return;
  }
  const int number =
    *fields[0] >= 1 && *fields[0] <= FastrakStations ? static_cast<int>(*fields[0]) : 0;
  if (number != *fields[0])
  {
    this->Complain(line, OutOfRange, end);
    return;
  }
  this->ActOnStation(line, number, fields, end);
}

void FastrakEmulator::ActOnStation(
  const std::string& line, int number, const std::vector<std::optional<double>>& fields, double end)
{
  Station& station = this->Stations[number - 1];
  const char letter = line[0];
  const std::string head{ '2', static_cast<char>('0' + number), letter };
  const bool asks = fields.size() < 2;
  switch (letter)
  {
    case 'l':
      if (asks)
      {
        this->Answer(head + this->DescribeActive() + "\r\n", end);
      }
      else
      {
        station.Active = fields[1].value_or(0) != 0 && this->Options.Receivers[number - 1];
      }
      break;
    case 'R':
      station.TransmitterToFrame = Matrix4();
      break;
    case 'A':
      if (!this->Align(station, fields))
      {
        this->Complain(line, Missing, end);
      }
      break;
    case 'e':
      this->ButtonAsks = asks || fields[1].value_or(0) != 0;
      break;
    case 'H':
      if (asks)
      {
        this->Answer(head + FormatColumn(station.Zenith[0]) + FormatColumn(station.Zenith[1]) +
            FormatColumn(station.Zenith[2]) + "\r\n",
          end);
      }
      for (std::size_t i = 1; i < std::min<std::size_t>(fields.size(), 4); ++i)
      {
        double& value = station.Zenith[static_cast<int>(i) - 1];
        value = fields[i].value_or(value);
      }
      break;
    default: // 'O'
      if (asks)
      {
        this->Answer(head + DescribeLayout(station.Layout) + "\r\n", end);
      }
      else if (!SetLayout(fields, station.Layout))
      {
        this->Complain(line, OutOfRange, end);
      }
  }
}

std::string FastrakEmulator::DescribeActive() const
{
  std::string states;
  for (const Station& each : this->Stations)
  {
    states += each.Active ? '1' : '0';
  }
  return states;
}

// A frame by its origin, a point on its x axis and one in its xy plane, in the frame before.
bool FastrakEmulator::Align(
  Station& station, const std::vector<std::optional<double>>& fields) const
{
  std::array<Vec3, 3> points{};
  for (std::size_t i = 0; i < 9; ++i)
  {
    if (i + 1 >= fields.size() || !fields[i + 1])
    {
      return false;
    }
    points[i / 3][static_cast<int>(i % 3)] = *fields[i + 1] * GetMillimetres(this->Format.Unit);
  }
  const Vec3 along = points[1] - points[0];
  const Vec3 normal = Cross(along, points[2] - points[0]);
  if (!(Norm(normal) > 0))
  {
    return false;
  }
  const Vec3 x = Normalized(along);
  const Vec3 z = Normalized(normal);
  const Matrix4 frame = Matrix4::FromColumns(x, Cross(z, x), z, points[0]);
  station.TransmitterToFrame = frame.Inverse() * station.TransmitterToFrame;
  return true;
}

void FastrakEmulator::AnswerStatus(double time)
{
  const int flags = 0x3f0 + (this->Format.Binary ? 1 : 0) +
    (this->Format.Unit == LengthUnit::Centimetre ? 2 : 0) + (this->Continuous ? 8 : 0);
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "21S%3X    F3%d  %-6s%-32s\r\n", flags & 0xfff, 0, "2.00",
    "Lacuna FASTRAK emulator");
  this->Answer(text.data(), time);
}

void FastrakEmulator::Complain(const std::string& command, int code, double time)
{
  std::string echo = command;
  std::replace_if(
    echo.begin(), echo.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  this->Answer(
    "2 E*ERROR*" + echo + "*ERROR* EC " + std::to_string(code) + " *PS 0 *FL 0 *ST 0\r\n", time);
}

void FastrakEmulator::Answer(const std::string& bytes, double time)
{
  this->OutputFree = std::max(this->OutputFree, time);
  for (const char c : bytes)
  {
    this->OutputFree += 10.0 / this->Options.Baud;
    this->Corrupt(c, this->OutputFree);
  }
}

void FastrakEmulator::Corrupt(char value, double time)
{
  const FastrakFaults& faults = this->Options.Faults;
  std::uniform_real_distribution<double> chance(0, 1);
  const auto anyByte = [this]() { return static_cast<char>(this->Random() & 0xff); };
  if (faults.Silent || chance(this->Random) < faults.Lost)
  {
    return;
  }
  if (chance(this->Random) < faults.Added)
  {
    this->Output.push_back({ time, anyByte() });
  }
  if (faults.Garbage || chance(this->Random) < faults.Changed)
  {
    value = static_cast<char>(value ^ (1 + this->Random() % 255));
  }
  this->Output.push_back({ time, value });
}

FastrakRecord FastrakEmulator::Measure(int number, double time)
{
  Station& station = this->Stations[number - 1];
  const Matrix4 pose = station.TransmitterToFrame * this->Script(time, number);
  std::normal_distribution<double> noise(0, 1);
  Vec3 position = pose.Column(3);
  Vec3 angles = FastrakAngles(pose);
  for (int i = 0; i < 3; ++i)
  {
    position[i] += this->Options.PositionNoise * noise(this->Random);
    angles[i] += this->Options.AngularNoise * noise(this->Random);
  }
  if (Dot(position, station.Zenith) < 0)
  {
    position = -1 * position;
  }
  const Matrix4 rotation = FastrakRotation(angles);
  FastrakRecord record;
  record.Station = number;
  record.Error = this->Options.Faults.Error;
  record.Position = position;
  record.RelativePosition = position - station.LastPosition;
  record.Angles = FastrakAngles(rotation);
  record.Axes = { rotation.Column(0), rotation.Column(1), rotation.Column(2) };
  record.Quaternion = FastrakQuaternion(rotation);
  record.Button = number == 1 && this->ButtonPressed;
  station.LastPosition = position;
  return record;
}

void FastrakEmulator::SendRecords(double sample, double ready)
{
  int position = 0;
  for (int number = 1; number <= FastrakStations; ++number)
  {
    if (this->Stations[number - 1].Active)
    {
      const double turn = Cycle * position++;
      this->Answer(EncodeFastrakRecord(this->Measure(number, sample + turn),
                     this->Stations[number - 1].Layout, this->Format),
        ready + turn);
    }
  }
}

int FastrakEmulator::CountActive() const
{
  return static_cast<int>(std::count_if(this->Stations.begin(), this->Stations.end(),
    [](const Station& station) { return station.Active; }));
}

void FastrakEmulator::SendContinuous(double time)
{
  const auto active = this->CountActive();
  while (this->Continuous && active > 0 && this->NextContinuous <= time)
  {
    if (this->OutputFree < this->NextContinuous + LongestBacklog)
    {
      this->SendRecords(this->NextContinuous + this->Options.SampleLatency,
        this->NextContinuous + this->Options.AnswerLatency);
    }
    this->NextContinuous += Cycle * active;
  }
}

std::string FastrakEmulator::Send(double time)
{
  this->SendContinuous(time);
  std::string bytes;
  while (!this->Suspended && !this->Output.empty() && this->Output.front().Time <= time)
  {
    bytes += this->Output.front().Value;
    this->Output.pop_front();
  }
  return bytes;
}

std::optional<double> FastrakEmulator::GetNextTime()
{
  if (this->Suspended)
  {
    return std::nullopt;
  }
  if (this->Output.empty() && this->Continuous && this->CountActive() > 0)
  {
    return this->NextContinuous;
  }
  return this->Output.empty() ? std::nullopt : std::optional<double>(this->Output.front().Time);
}

void FastrakEmulator::SetButton(bool pressed, double time)
{
  const bool begins = pressed && !this->ButtonPressed;
  this->ButtonPressed = pressed;
  if (begins && this->ButtonAsks && this->Stations[0].Active && time >= this->DeafUntil)
  {
    this->SendRecords(time + this->Options.SampleLatency, time + this->Options.AnswerLatency);
  }
}
}
