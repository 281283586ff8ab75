// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVideoOptions.h"

#include "lacunaWaterBath.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

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
}
