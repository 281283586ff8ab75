// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaEmulatorSettings.h"

#include "lacunaFastrakCommand.h"
#include "lacunaPoseScript.h"
#include "lacunaWaterBath.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string_view>

namespace lacuna
{
namespace
{
constexpr double EdgeWidth = 1; // mm, of anatomies
}

bool ReadVideoOption(
  const std::string& option, const NextWord& word, const NextNumber& number, VideoOptions& options)
{
  ScannerLayout& layout = options.Picture.Layout;
  const auto whole = [&](double least, double most, const char* what)
  {
    const double value = number(least, most, what);
    if (value != std::floor(value))
    {
      throw std::runtime_error(option + " takes whole numbers, " + what);
    }
    return static_cast<int>(value);
  };
  if (option == "--video")
  {
    options.Service.Sender.URL = word();
  }
  else if (option == "--scene")
  {
    options.Scene = word();
    MakeEmulatedScene(options.Scene);
  }
  else if (option == "--aim")
  {
    options.Aim = number(0, 1e9, "a time in s");
  }
  else if (option == "--calibration")
  {
    options.Calibration = word();
  }
  else if (option == "--depth")
  {
    layout.Depth = number(5, 400, "5 to 400 mm");
  }
  else if (option == "--linear")
  {
    layout.Shape = ScannerLayout::Probe::Linear;
    layout.Width = number(5, 400, "5 to 400 mm");
  }
  else if (option == "--bare")
  {
    layout.Furniture = false;
  }
  else if (option == "--size")
  {
    layout.Columns = whole(16, 4096, "two sizes from 16 to 4096 pixels");
    layout.Rows = whole(16, 4096, "two sizes from 16 to 4096 pixels");
  }
  else if (option == "--rate")
  {
    options.Service.Sender.Rate = whole(1, 100, "1 to 100 frames a second");
  }
  else if (option == "--speckle")
  {
    options.Picture.SpeckleLevel = number(0, 1, "a level from 0 to 1");
  }
  else if (option == "--video-latency")
  {
    options.Service.Latency = number(0, 1, "a time from 0 to 1 s");
  }
  else
  {
    return false;
  }
  options.First = options.First.empty() ? option : options.First;
  return true;
}

void CheckVideoOptions(const VideoOptions& options)
{
  if (!options.First.empty() && options.Service.Sender.URL.empty())
  {
    throw std::runtime_error(options.First + " belongs to --video, which is missing (see --help)");
  }
}

std::unique_ptr<PhantomScene> MakeEmulatedScene(const std::string& name)
{
  if (name == "Floor")
  {
    return std::make_unique<WaterBath>();
  }
  const char* const anatomies[] = { "Ellipsoids", "Kumara", "Vessels", "Linear" };
  const auto* const found = std::find(std::begin(anatomies), std::end(anatomies), name);
  if (found == std::end(anatomies))
  {
    throw std::runtime_error("There is no scene '" + name + "' (see --help)");
  }
  return MakePhantomScene(static_cast<Anatomy>(found - std::begin(anatomies)), EdgeWidth);
}

//------------------------------------------------------------------------------
const char* const EmulatorHelp =
  "lacuna-fastrak-emulator [option]...\n"
  "A Polhemus FASTRAK without hardware: it makes a pseudo-terminal, prints its name and answers\n"
  "there in real time until it is interrupted. With --video also the video of an ultrasound "
  "scanner\n"
  "whose probe carries the first receiver.\n"
  "\n"
  "  --link NAME           a name that points at the terminal, removed in the end\n"
  "  --baud RATE           2400 ... 115200 (default 19200); at another rate of the host every "
  "byte\n"
  "                        is another one, as on a line\n"
  "  --receivers LIST      stations that are plugged in, 1,3 (default 1)\n"
  "  --poses FILE          motion: lines of time station x y z azimuth elevation roll in s, mm "
  "and\n"
  "                        degrees (default: a sweep to and fro by 80 mm every 8 s)\n"
  "  --loop                begins the motion again when it has ended\n"
  "  --noise MM DEGREES    standard deviations of each coordinate and angle (default 0 0)\n"
  "  --latency S S         from request to the pose's instant, and to the answer (0.0035 0.0055)\n"
  "  --seed N              of noise and faults (default 1)\n"
  "  --fault [TIME:]KIND   from a time in s (default 0) on, in addition to those before:\n"
  "                          changed=P lost=P added=P  each byte to the host, with probability P\n"
  "                          silent     nothing is sent\n"
  "                          garbage    every byte is another one\n"
  "                          error=C    the error code of all records\n"
  "                          ignored=L  commands of these letters have no effect\n"
  "                          refused=L  they are answered with *ERROR*\n"
  "                          none       ends all\n"
  "  --button TIME         presses the stylus's button (or a foot switch there) for 0.2 s; may be\n"
  "                        repeated, as --fault may\n"
  "  --seconds S           ends after a time\n"
  "  --help                prints this\n"
  "\n"
  "  --video URL           tcp://127.0.0.1:5004 serves one client after the other, without loss;\n"
  "                        udp://127.0.0.1:5004 sends MPEG-2 there; else a file, .mkv or .ts\n"
  "  --scene NAME          what is scanned: Ellipsoids (default), Kumara, Vessels, Linear (see "
  "the\n"
  "                        page of Phantom Sweep) or Floor (a water bath, for calibrations)\n"
  "  --aim S               the instant of the motion at which the probe looks straight at the\n"
  "                        scene's middle (default: half way)\n"
  "  --calibration FILE    writes the truth as XML: Image to Probe, and Tracker to\n"
  "                        Reference, which is the scene's frame\n"
  "  --depth MM            that the probe sees (default 60)\n"
  "  --linear MM           a linear probe of this width (default: a curved one)\n"
  "  --bare                no ruler and texts: what the probe sees fills the frame\n"
  "  --size COLUMNS ROWS   of the frame (default 768 576)\n"
  "  --rate HZ             frames a second (default 25)\n"
  "  --speckle LEVEL       0 ... 1, relative to the grey level (default 0.25)\n"
  "  --video-latency S     a frame is sent so much later than what it shows (default 0.04)\n"
  "\n"
  "Lacuna opens ports by libserialport, which refuses pseudo-terminals. Preload\n"
  "libLacunaPseudoTerminalPorts.so (LD_PRELOAD) into the program that opens the port, and give it\n"
  "the name of a link as /dev/../../..LINK, LINK being its full path from the root.\n";

namespace
{
constexpr double PressTime = 0.2; // s

double ReadNumber(std::string_view word, double minimum, double maximum, const std::string& what)
{
  double number = 0;
  const auto result = std::from_chars(word.data(), word.data() + word.size(), number);
  if (result.ec != std::errc() || result.ptr != word.data() + word.size() ||
    !(number >= minimum && number <= maximum))
  {
    throw std::runtime_error(what + ", not '" + std::string(word) + "' (see --help)");
  }
  return number;
}

std::array<bool, FastrakStations> ReadReceivers(const std::string& list)
{
  std::array<bool, FastrakStations> receivers{};
  std::size_t begin = 0;
  while (begin <= list.size())
  {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const std::string_view word = std::string_view(list).substr(begin, end - begin);
    if (word.size() != 1 || word[0] < '1' || word[0] > '0' + FastrakStations)
    {
      throw std::runtime_error(
        "--receivers takes stations 1 to 4 parted by commas, not '" + list + "' (see --help)");
    }
    receivers[static_cast<std::size_t>(word[0] - '1')] = true;
    begin = end + 1;
  }
  return receivers;
}

// Changes the faults as a word says.
std::function<void(FastrakFaults&)> ReadFault(const std::string& word)
{
  const std::size_t equals = word.find('=');
  const std::string kind = word.substr(0, equals);
  const std::string value = equals == std::string::npos ? std::string() : word.substr(equals + 1);
  const auto probability = [&](double FastrakFaults::*fault)
  {
    const double number =
      ReadNumber(value, 0, 1, "--fault " + kind + " takes a probability 0 to 1");
    return [fault, number](FastrakFaults& faults) { faults.*fault = number; };
  };
  if (kind == "changed")
  {
    return probability(&FastrakFaults::Changed);
  }
  if (kind == "lost")
  {
    return probability(&FastrakFaults::Lost);
  }
  if (kind == "added")
  {
    return probability(&FastrakFaults::Added);
  }
  if (kind == "error" && value.size() == 1)
  {
    return [code = value[0]](FastrakFaults& faults) { faults.Error = code; };
  }
  if ((kind == "ignored" || kind == "refused") && !value.empty())
  {
    std::string FastrakFaults::*letters =
      kind == "ignored" ? &FastrakFaults::Ignored : &FastrakFaults::Refused;
    return [letters, value](FastrakFaults& faults) { faults.*letters = value; };
  }
  if (word == "silent")
  {
    return [](FastrakFaults& faults) { faults.Silent = true; };
  }
  if (word == "garbage")
  {
    return [](FastrakFaults& faults) { faults.Garbage = true; };
  }
  if (word == "none")
  {
    return [](FastrakFaults& faults) { faults = FastrakFaults(); };
  }
  throw std::runtime_error("There is no fault '" + word + "' (see --help)");
}

struct TimedFault
{
  double Time;
  std::function<void(FastrakFaults&)> Change;
};

TimedFault ReadTimedFault(const std::string& word)
{
  const std::size_t colon = word.find(':');
  if (colon == std::string::npos || word.find('=') < colon)
  {
    return { 0, ReadFault(word) };
  }
  const double time =
    ReadNumber(std::string_view(word).substr(0, colon), 0, 1e9, "--fault begins at a time in s");
  return { time, ReadFault(word.substr(colon + 1)) };
}

// aim: half way.
FastrakEmulator::PoseScript ReadMotion(const std::string& fileName, bool loop, double& aim)
{
  if (fileName.empty())
  {
    aim = 0.5 * EverydayPeriod;
    return EverydaySweep;
  }
  std::ifstream file(fileName);
  if (!file)
  {
    throw std::runtime_error("The file '" + fileName + "' cannot be read");
  }
  PoseScript script(file, fileName);
  const double duration = script.GetDuration();
  aim = 0.5 * duration;
  if (loop && duration > 0)
  {
    return [script, duration](double time, int station)
    { return script(time - duration * std::floor(time / duration), station); };
  }
  return script;
}

constexpr double Longest = 1e9; // s

// Reads an option of the tracker that is a setting; false when it is none.
bool ReadTrackerOption(const std::string& option, const NextWord& word, const NextNumber& number,
  FastrakEmulatorOptions& options)
{
  if (option == "--baud")
  {
    options.Baud = static_cast<int>(number(1, 1e6, "a rate in baud"));
  }
  else if (option == "--receivers")
  {
    options.Receivers = ReadReceivers(word());
  }
  else if (option == "--noise")
  {
    options.PositionNoise = number(0, 1000, "mm and degrees");
    options.AngularNoise = number(0, 180, "mm and degrees");
  }
  else if (option == "--latency")
  {
    options.SampleLatency = number(0, 10, "two times up to 10 s");
    options.AnswerLatency = number(0, 10, "two times up to 10 s");
  }
  else if (option == "--seed")
  {
    options.Seed = static_cast<std::uint32_t>(number(0, 4294967295.0, "a number of 32 bits"));
  }
  else
  {
    return false;
  }
  return true;
}

// The button is pressed at a time and let go.
void AddPress(double time, EmulatorSettings& settings)
{
  settings.Events.push_back(
    { time, [](FastrakEmulator& emulator, double now) { emulator.SetButton(true, now); } });
  settings.Events.push_back({ time + PressTime,
    [](FastrakEmulator& emulator, double now) { emulator.SetButton(false, now); } });
}

// Each fault adds to those before it.
void AddFaults(std::vector<TimedFault> faults, EmulatorSettings& settings)
{
  std::stable_sort(faults.begin(), faults.end(),
    [](const TimedFault& a, const TimedFault& b) { return a.Time < b.Time; });
  FastrakFaults sum;
  for (const TimedFault& fault : faults)
  {
    fault.Change(sum);
    settings.Events.push_back(
      { fault.Time, [sum](FastrakEmulator& emulator, double) { emulator.SetFaults(sum); } });
  }
}
}

EmulatorSettings ReadEmulatorSettings(const std::vector<std::string>& words)
{
  EmulatorSettings settings;
  std::vector<TimedFault> faults;
  std::string poses;
  bool loop = false;
  for (std::size_t i = 0; i < words.size(); ++i)
  {
    const std::string& option = words[i];
    const auto next = [&]() -> const std::string&
    {
      if (i + 1 == words.size())
      {
        throw std::runtime_error(option + " needs a value (see --help)");
      }
      return words[++i];
    };
    const auto number = [&](double minimum, double maximum, const char* what)
    { return ReadNumber(next(), minimum, maximum, option + " takes " + what); };
    if (option == "--help" || option == "-h")
    {
      settings.Help = true;
    }
    else if (option == "--link")
    {
      settings.Link = next();
    }
    else if (option == "--poses")
    {
      poses = next();
    }
    else if (option == "--loop")
    {
      loop = true;
    }
    else if (option == "--fault")
    {
      faults.push_back(ReadTimedFault(next()));
    }
    else if (option == "--button")
    {
      AddPress(number(0, Longest, "a time in s"), settings);
    }
    else if (option == "--seconds")
    {
      settings.Duration = number(0, Longest, "a time in s");
    }
    else if (!ReadTrackerOption(option, next, number, settings.Options) &&
      !ReadVideoOption(option, next, number, settings.Video))
    {
      throw std::runtime_error("There is no option '" + option + "' (see --help)");
    }
  }
  CheckVideoOptions(settings.Video);
  AddFaults(faults, settings);
  std::stable_sort(settings.Events.begin(), settings.Events.end(),
    [](const auto& a, const auto& b) { return a.Time < b.Time; });
  double aim = 0;
  settings.Motion = ReadMotion(poses, loop, aim);
  settings.Video.Aim = settings.Video.Aim.value_or(aim);
  FastrakCommand::SerialRate(settings.Options.Baud); // throws for one that the unit does not have
  return settings;
}
}
