// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaScanRegion.h"

#include "lacunaActivityMap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr int SmallestSize = 16;
constexpr int MostWindows = 3;       // one within the other
constexpr std::size_t MostParts = 2; // a screen around the window may be larger than the region
constexpr double LeastGrain = 0.3;
constexpr double GrainOfRange = 1.0 / 256; // what neighbours differ by, of the range of grey levels
constexpr double LeastAgreement = 0.95;
constexpr double ConfidenceOfDispute = 0.5;

bool IsSame(const std::array<int, 4>& rectangle, const SliceImage& image)
{
  return rectangle[0] <= 2 && rectangle[1] <= 2 && rectangle[0] + rectangle[2] >= image.Width - 2 &&
    rectangle[1] + rectangle[3] >= image.Height - 2;
}

// Whether a pixel belongs to the region.
class Region
{
public:
  Region(const DetectedFan& fan, int width, int height, const Vec2& pixelSpacing)
    : Rectangle(fan.Rectangle)
  {
    if (fan.IsSector)
    {
      this->Mask = std::make_unique<FanMask>(fan.Sector, width, height, pixelSpacing);
    }
  }
  bool Has(int column, int row) const
  {
    const std::array<int, 4>& r = this->Rectangle;
    return this->Mask ? this->Mask->Contains(column, row)
                      : column >= r[0] && column < r[0] + r[2] && row >= r[1] && row < r[1] + r[3];
  }

private:
  std::array<int, 4> Rectangle;
  std::unique_ptr<FanMask> Mask;
};

// Part of the region's pixels that differ from their neighbours.
double GetGrain(const SliceImage& image, const Region& region)
{
  return DispatchScalars(image.Type, image.Pixels,
    [&](const auto* pixels)
    {
      const auto level = [&](int column, int row)
      {
        const auto value = static_cast<double>(pixels[image.RowStride * row + column]);
        return std::isfinite(value) ? value : 0;
      };
      double low = std::numeric_limits<double>::infinity();
      double high = -low;
      for (int row = 0; row < image.Height; ++row)
      {
        for (int column = 0; column < image.Width; ++column)
        {
          low = std::min(low, level(column, row));
          high = std::max(high, level(column, row));
        }
      }
      const double step = GrainOfRange * (high - low);
      double all = 0, differ = 0;
      for (int row = 1; row < image.Height; ++row)
      {
        for (int column = 1; column < image.Width; ++column)
        {
          if (region.Has(column, row))
          {
            const double here = level(column, row);
            all += 1;
            // both: bars are shaded along one direction only
            differ += std::abs(here - level(column - 1, row)) > step &&
                std::abs(here - level(column, row - 1)) > step
              ? 1
              : 0;
          }
        }
      }
      return all > 0 ? differ / all : 0.0;
    });
}

double GetAgreement(
  const DetectedFan& a, const DetectedFan& b, int width, int height, const Vec2& pixelSpacing)
{
  const Region first(a, width, height, pixelSpacing), second(b, width, height, pixelSpacing);
  double both = 0, any = 0;
  for (int row = 0; row < height; ++row)
  {
    for (int column = 0; column < width; ++column)
    {
      const bool inFirst = first.Has(column, row), inSecond = second.Has(column, row);
      both += inFirst && inSecond ? 1 : 0;
      any += inFirst || inSecond ? 1 : 0;
    }
  }
  return any > 0 ? both / any : 0;
}

void Move(DetectedFan& fan, int column, int row)
{
  fan.Sector.Origin[0] += column;
  fan.Sector.Origin[1] += row;
  fan.Rectangle[0] += column;
  fan.Rectangle[1] += row;
}

// What differs from the background, in windows within windows. Throws when there is nothing.
DetectedFan FindByContrast(std::vector<SliceImage> frames, const Vec2& pixelSpacing)
{
  DetectedFan best;
  std::string doubt;
  int column = 0, row = 0;
  for (int window = 0; window < MostWindows; ++window)
  {
    DetectedFan found;
    try
    {
      const ActivityMap map = ActivityMap::OfContrast(frames);
      if (!(map.GetLargestChange() > 0))
      {
        throw std::runtime_error("the image is all of one grey");
      }
      found = DetectFan(map, pixelSpacing, "differ from the background", MostParts);
    }
    catch (const std::runtime_error& error)
    {
      doubt += (doubt.empty() ? "" : "; within it ") + std::string(error.what());
      break;
    }
    const bool isAll = !found.IsSector && IsSame(found.Rectangle, frames.front());
    const Region region(found, frames.front().Width, frames.front().Height, pixelSpacing);
    double grain = 0;
    for (const SliceImage& frame : frames)
    {
      grain = std::max(grain, GetGrain(frame, region));
    }
    const std::array<int, 4> inner = found.Rectangle;
    if (!(isAll && best.Rectangle[2] > 0) && grain >= LeastGrain)
    {
      best = found;
      Move(best, column, row);
    }
    else if (grain < LeastGrain)
    {
      doubt = "what differs from the background has not the grain of ultrasound: only " +
        std::to_string(std::lround(100 * grain)) + " % of its pixels differ from their neighbours";
    }
    if (found.IsSector || isAll || inner[2] < SmallestSize || inner[3] < SmallestSize)
    {
      break;
    }
    column += inner[0];
    row += inner[1];
    for (SliceImage& frame : frames)
    {
      CutSlice(frame, inner[0], inner[1], inner[2], inner[3]);
    }
  }
  if (best.Rectangle[2] == 0)
  {
    throw std::runtime_error(doubt);
  }
  return best;
}

void Check(const std::vector<SliceImage>& frames, const Vec2& pixelSpacing)
{
  if (frames.empty())
  {
    throw std::invalid_argument("there is no frame to find the scan region in");
  }
  const int width = frames.front().Width, height = frames.front().Height;
  if (width < SmallestSize || height < SmallestSize)
  {
    throw std::invalid_argument("the frame has " + std::to_string(width) + " x " +
      std::to_string(height) + " pixels; at least 16 x 16 are needed to find the scan region");
  }
  for (const SliceImage& frame : frames)
  {
    if (frame.Width != width || frame.Height != height)
    {
      throw std::invalid_argument("frames of " + std::to_string(width) + " x " +
        std::to_string(height) + " and of " + std::to_string(frame.Width) + " x " +
        std::to_string(frame.Height) + " pixels cannot be compared");
    }
  }
  for (const double spacing : pixelSpacing)
  {
    if (!(spacing > 0) || !std::isfinite(spacing))
    {
      throw std::invalid_argument("width and height of pixels must be above 0");
    }
  }
}
}

ScanRegion FindScanRegion(const std::vector<SliceImage>& frames, const Vec2& pixelSpacing)
{
  Check(frames, pixelSpacing);
  const int width = frames.front().Width, height = frames.front().Height;
  std::string changeDoubt, contrastDoubt;
  DetectedFan ofChange, ofContrast;
  try
  {
    ofChange = DetectFan(frames, pixelSpacing);
  }
  catch (const std::runtime_error& error)
  {
    changeDoubt = error.what();
  }
  try
  {
    ofContrast = FindByContrast(frames, pixelSpacing);
  }
  catch (const std::runtime_error& error)
  {
    contrastDoubt = error.what();
  }
  const bool hasChange = changeDoubt.empty(), hasContrast = contrastDoubt.empty();
  ScanRegion region;
  region.IsFound = hasChange || hasContrast;
  if (!region.IsFound)
  {
    region.Text = "the scan region is not found. By its contrast: " + contrastDoubt +
      (frames.size() < 3
          ? ". Give several frames of a moving probe, or ClipRectangle and fan by hand"
          : ". By what changes: " + changeDoubt + ". Give ClipRectangle and fan by hand");
    return region;
  }
  region.Fan = hasChange ? ofChange : ofContrast;
  region.Confidence = region.Fan.Support;
  region.Text = region.Fan.IsSector ? "a sector, found by " : "a rectangle, found by ";
  if (hasChange && hasContrast)
  {
    const double agreement = GetAgreement(ofChange, ofContrast, width, height, pixelSpacing);
    if (agreement >= LeastAgreement)
    {
      region.Confidence = 1 - (1 - ofChange.Support) * (1 - ofContrast.Support);
      region.Text += "what changes and by its contrast, which agree";
    }
    else
    {
      region.Confidence *= ConfidenceOfDispute;
      region.Text += "what changes; by its contrast another region is found (they share " +
        std::to_string(std::lround(100 * agreement)) + " %): check it";
    }
  }
  else
  {
    region.Text += hasChange ? "what changes" : "its contrast to the background";
  }
  return region;
}
}
