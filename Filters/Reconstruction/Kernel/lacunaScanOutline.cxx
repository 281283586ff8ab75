// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaScanOutline.h"

#include "lacunaPixelSet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace lacuna
{
namespace
{
constexpr int SmallestSize = 16;
constexpr std::int64_t FewestSlices = 3;
// Of the screen.
constexpr double Stillness = 1.0 / 16; // brighter than this part of the range in all slices
constexpr double LetterHeight = 0.035; // of the larger of the image's width and height
constexpr int SmallestLetter = 5;      // pixels
constexpr int StrokeRadius = 3;        // thin: narrower than 7 pixels
constexpr double ThickLine = 0.2;      // the part of lines that is not thin: where they cross
constexpr double ThickWord = 0.6;      // of words whose letters run into each other
constexpr int FlickerReach = 3;        // pixels around letters that flicker with them
constexpr double FilledBox = 0.8;
constexpr double LargestBox = 0.02;            // of the image
constexpr std::int64_t FewestFlickering = 200; // pixels, to learn the flicker from
constexpr double BrightAsLetters = 0.75;
constexpr double LeastBright = 0.5;
constexpr double FilledFigure = 0.85; // figures of a clock, all that were seen together
constexpr double NoiseFactor = 3;     // from the first quartile of ranges to the largest one
// Of what changes.
constexpr int PixelsNeeded = 2; // of 3 x 3: no single pixels
// With texts or noise no lines one pixel wide either: what is left of figures and of noise.
constexpr int PixelsNeededOnScreens = 4;
constexpr double LeastChanging = 0.004;
constexpr double SmallestBox = 0.05;
// Of sectors.
constexpr double LargestArea = 0.83;
constexpr double LeastFree = 1.0 / 3;
constexpr double LeastFarSupport = 0.4;
constexpr double ArcTolerance = 0.03; // of the far radius
constexpr double WidestOpening = 190; // degrees
constexpr double SmallestOpening = 6;
constexpr int Directions = 60;
constexpr double HighestConfidence = 0.45;
constexpr double Pi = 3.14159265358979323846;

double GetQuantile(std::vector<float> values, double fraction)
{
  if (values.empty())
  {
    return 0;
  }
  const auto place =
    values.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

// The most frequent level, in 256 steps.
double GetMostFrequent(const std::vector<float>& levels)
{
  constexpr std::size_t steps = 256;
  const auto [low, high] = std::minmax_element(levels.begin(), levels.end());
  const double step = (double(*high) - double(*low)) / (steps - 1);
  if (!(step > 0))
  {
    return *low;
  }
  std::array<std::int64_t, steps> counts{};
  for (const float level : levels)
  {
    ++counts[static_cast<std::size_t>(std::lround((double(level) - double(*low)) / step))];
  }
  return *low + step * double(std::max_element(counts.begin(), counts.end()) - counts.begin());
}

// What the slices show of a pixel, above the background.
struct Screen
{
  std::size_t At(int column, int row) const
  {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(this->Width) +
      static_cast<std::size_t>(column);
  }
  int Width, Height;
  std::vector<float> Lowest, Highest, Ranges; ///< Lowest: second lowest from 4 slices on
  double Top = 0;                             ///< the largest of Highest
};

// Texts, rulers, frames and bars, and what the probe sees always, such as its own face.
struct StillThings
{
  PixelSet Furniture, Others;
  std::vector<PixelRectangle> Words;
  double LetterLevel = 0; ///< 0: there are too few
  double Flicker = 0;
};

StillThings FindStillThings(const Screen& screen, int letter)
{
  const int width = screen.Width, height = screen.Height;
  const PixelSet still = PixelSet::Select(width, height,
    [&](int column, int row)
    { return screen.Lowest[screen.At(column, row)] > Stillness * screen.Top; });
  constexpr int stroke = StrokeRadius;
  const PixelSet thick = still.Gathered(stroke, stroke, 0).Grown(stroke, stroke);
  StillThings found{ PixelSet(width, height), PixelSet(width, height), {}, 0, 0 };
  for (const PixelPart& part : still.GetParts())
  {
    const double thickness = part.GetFraction([&](int x, int y) { return thick.Has(x, y); });
    const PixelRectangle& box = part.Bounds;
    const auto size = static_cast<double>(part.Pixels.size());
    const bool isBox = size > FilledBox * box.GetArea() && size < LargestBox * width * height;
    const int smaller = std::min(box.GetWidth(), box.GetHeight());
    const int larger = std::max(box.GetWidth(), box.GetHeight());
    const bool isFurniture = isBox || larger <= letter || thickness < ThickLine ||
      (smaller <= letter && thickness < ThickWord);
    (isFurniture ? found.Furniture : found.Others).Put(part);
  }
  for (const PixelPart& word : found.Furniture.Grown(2, 0).GetParts())
  {
    if (word.Bounds.GetHeight() >= SmallestLetter && word.Bounds.GetHeight() <= letter)
    {
      found.Words.push_back(word.Bounds);
    }
  }
  std::vector<float> levels, ranges;
  found.Furniture.ForEach(
    [&](int column, int row)
    {
      const std::size_t i = screen.At(column, row);
      levels.push_back(screen.Lowest[i]);
      ranges.push_back(screen.Ranges[i]);
    });
  if (static_cast<std::int64_t>(levels.size()) >= FewestFlickering)
  {
    found.LetterLevel = GetQuantile(levels, 0.75);
    found.Flicker = GetQuantile(ranges, 0.5);
  }
  return found;
}

// A figure of a clock, or several.
bool IsText(const PixelPart& part, const StillThings& still, const Screen& screen, int letter)
{
  const PixelRectangle& box = part.Bounds;
  if (box.GetHeight() > letter || box.GetWidth() > 6 * letter)
  {
    return false;
  }
  const bool isInLine = box.GetWidth() <= 3 * letter &&
    std::any_of(still.Words.begin(), still.Words.end(),
      [&](const PixelRectangle& word)
      {
        return box.Top >= word.Top - 2 && box.Bottom <= word.Bottom + 2 &&
          std::max(box.Left - word.Right, word.Left - box.Right) <= letter;
      });
  if (isInLine)
  {
    return true;
  }
  const auto isBright = [&](int column, int row)
  { return screen.Highest[screen.At(column, row)] >= BrightAsLetters * still.LetterLevel; };
  return still.LetterLevel > 0 && box.GetHeight() >= SmallestLetter &&
    static_cast<double>(part.Pixels.size()) >= FilledFigure * box.GetArea() &&
    part.GetFraction(isBright) >= LeastBright;
}

// What changes, without what belongs to the screen.
PixelSet FindMoving(const Screen& screen)
{
  const int width = screen.Width, height = screen.Height;
  const int letter = static_cast<int>(LetterHeight * std::max(width, height));
  const StillThings still = FindStillThings(screen, letter);
  const double least = std::max(still.Flicker, NoiseFactor * GetQuantile(screen.Ranges, 0.25));
  const PixelSet around = still.Furniture.Grown(FlickerReach, FlickerReach);
  const PixelSet changing = PixelSet::Select(width, height,
    [&](int column, int row)
    { return screen.Ranges[screen.At(column, row)] > least && !around.Has(column, row); });
  const bool isClean = !(least > 0) && !(still.LetterLevel > 0);
  const PixelSet cores = changing.Gathered(1, 1, isClean ? PixelsNeeded : PixelsNeededOnScreens);
  const auto getChanging = [&](const PixelSet& set)
  {
    return PixelSet::Select(
      width, height, [&](int x, int y) { return set.Has(x, y) && changing.Has(x, y); });
  };
  const PixelSet dense = getChanging(getChanging(cores).Grown(1, 1));
  PixelSet moving(width, height);
  for (const PixelPart& part : dense.GetParts())
  {
    if (!IsText(part, still, screen, letter))
    {
      moving.Put(part);
    }
  }
  const PixelRectangle box = moving.GetBounds();
  for (const PixelPart& part : still.Others.GetParts())
  {
    if (part.GetFraction([&](int x, int y) { return box.Has(x, y); }) >= 0.5)
    {
      moving.Put(part);
    }
  }
  return moving;
}

// A sector that opens downwards. Lengths are in columns.
struct Wedge
{
  Vec2 Origin{ 0, 0 };
  Vec2 Radii{ 0, 0 };
  Vec2 Angles{ 0, 0 }; ///< radians

  bool Has(const Vec2& point) const
  {
    const double x = point[0] - this->Origin[0], y = point[1] - this->Origin[1];
    const double square = x * x + y * y;
    if (square < this->Radii[0] * this->Radii[0] || square > this->Radii[1] * this->Radii[1])
    {
      return false;
    }
    const double angle = std::atan2(x, y);
    return angle >= this->Angles[0] && angle <= this->Angles[1];
  }
};

Wedge Enclose(const std::vector<Vec2>& points, const Vec2& origin)
{
  Wedge wedge;
  wedge.Origin = origin;
  wedge.Angles = { Pi, -Pi };
  Vec2 squares{ std::numeric_limits<double>::infinity(), 0 };
  for (const Vec2& point : points)
  {
    const double x = point[0] - origin[0], y = point[1] - origin[1];
    const double square = x * x + y * y, angle = std::atan2(x, y);
    squares = { std::min(squares[0], square), std::max(squares[1], square) };
    wedge.Angles = { std::min(wedge.Angles[0], angle), std::max(wedge.Angles[1], angle) };
  }
  wedge.Radii = { std::sqrt(squares[0]), std::sqrt(squares[1]) };
  return wedge;
}

// Finds the wedge of the smallest area within the rectangle that holds a set.
class WedgeSearch
{
public:
  WedgeSearch(const PixelSet& set, double aspect)
    : Set(set)
    , Aspect(aspect)
    , Bounds(set.GetBounds())
  {
    // the outermost pixels of rows and columns say all but the near radius at the sides
    for (const std::vector<PixelRectangle>& lines : set.GetLines())
    {
      for (const PixelRectangle& line : lines)
      {
        if (line.Right > 0)
        {
          this->Outermost.push_back(this->GetPoint(line.Left, line.Top));
          this->Outermost.push_back(this->GetPoint(line.Right - 1, line.Bottom - 1));
        }
      }
    }
    const int step = std::max(1, std::max(this->Bounds.GetWidth(), this->Bounds.GetHeight()) / 80);
    for (int row = this->Bounds.Top; row < this->Bounds.Bottom; row += step)
    {
      for (int column = this->Bounds.Left; column < this->Bounds.Right; column += step)
      {
        this->Samples.push_back(this->GetPoint(column, row));
      }
    }
  }

  Vec2 GetPoint(double column, double row) const { return { column, this->Aspect * row }; }

  // Part of the rectangle that is in the wedge.
  double GetArea(const Wedge& wedge) const
  {
    const double opening = (wedge.Angles[1] - wedge.Angles[0]) * 180 / Pi;
    // An oblique line is an arc of a far circle: what a probe sees has beams across its face.
    const bool hasUpright = wedge.Angles[0] < 0 && wedge.Angles[1] > 0;
    if (opening > WidestOpening || opening < SmallestOpening || !hasUpright)
    {
      return std::numeric_limits<double>::infinity();
    }
    const auto count = std::count_if(this->Samples.begin(), this->Samples.end(),
      [&](const Vec2& point) { return wedge.Has(point); });
    return static_cast<double>(count) / static_cast<double>(this->Samples.size());
  }

  Wedge Find() const
  {
    const Vec2 first = this->GetPoint(this->Bounds.Left, this->Bounds.Top);
    const Vec2 last = this->GetPoint(this->Bounds.Right - 1, this->Bounds.Bottom - 1);
    const Vec2 size{ last[0] - first[0], last[1] - first[1] };
    std::vector<std::pair<double, Vec2>> starts;
    const auto area = [&](const Vec2& origin)
    { return this->GetArea(Enclose(this->Outermost, origin)); };
    for (int column = 0; column <= 12; ++column)
    {
      // parts of the height above the rectangle; the first ones are in it
      for (const double above :
        { -0.15, -0.1, -0.05, 0.0, 0.05, 0.1, 0.15, 0.23, 0.36, 0.55, 0.84, 1.3, 2.0 })
      {
        const Vec2 origin{ first[0] + size[0] * (0.1 * column - 0.1), first[1] - above * size[1] };
        starts.emplace_back(area(origin), origin);
      }
    }
    constexpr std::ptrdiff_t best = 6;
    std::partial_sort(starts.begin(), starts.begin() + best, starts.end(),
      [](const auto& a, const auto& b) { return a.first < b.first; });
    starts.resize(best);
    for (auto& [smallest, origin] : starts)
    {
      for (double step = std::max(size[0], size[1]) / 12; step > 0.5;)
      {
        bool isBetter = false;
        for (int way = 0; way < 9 && !isBetter; ++way)
        {
          const Vec2 moved{ origin[0] + step * (way % 3 - 1), origin[1] + step * (way / 3 - 1) };
          const double value = way == 4 ? smallest : area(moved);
          if (value < smallest - 1e-6)
          {
            smallest = value;
            origin = moved;
            isBetter = true;
          }
        }
        step = isBetter ? step : step / 2;
      }
    }
    const Vec2 origin = std::min_element(starts.begin(), starts.end(),
      [](const auto& a, const auto& b) {
        return a.first < b.first;
      })->second;
    std::vector<Vec2> all;
    this->Set.ForEach([&](int column, int row) { all.push_back(this->GetPoint(column, row)); });
    return Enclose(all, origin);
  }

  const PixelSet& Set;
  double Aspect;
  PixelRectangle Bounds;

private:
  std::vector<Vec2> Outermost, Samples;
};

struct Proposal
{
  bool IsTrusted = false;
  Wedge Shape;
  double Area = 1;
  double Between = 0; ///< part of the shape that lies between changes
};

Proposal TryWedge(const PixelSet& moving, double aspect)
{
  const WedgeSearch search(moving, aspect);
  Proposal proposal;
  proposal.Shape = search.Find();
  const Wedge& wedge = proposal.Shape;
  proposal.Area = search.GetArea(wedge);
  if (!(proposal.Area <= LargestArea))
  {
    return proposal;
  }
  struct Beam
  {
    double Nearest = std::numeric_limits<double>::infinity();
    double Farthest = 0;
    double Begin = 0, End = 0; ///< in the wedge and the rectangle
  };
  std::array<Beam, Directions> beams;
  const double opening = wedge.Angles[1] - wedge.Angles[0];
  moving.ForEach(
    [&](int column, int row)
    {
      const Vec2 point = search.GetPoint(column, row);
      const double x = point[0] - wedge.Origin[0], y = point[1] - wedge.Origin[1];
      const double along = (std::atan2(x, y) - wedge.Angles[0]) / opening;
      Beam& beam =
        beams[static_cast<std::size_t>(std::clamp(along * Directions, 0.0, Directions - 1.0))];
      const double radius = std::hypot(x, y);
      beam.Nearest = std::min(beam.Nearest, radius);
      beam.Farthest = std::max(beam.Farthest, radius);
    });
  const PixelRectangle& box = search.Bounds;
  int free = 0, confirmed = 0;
  double all = 0, between = 0;
  for (std::size_t d = 0; d < beams.size(); ++d)
  {
    Beam& beam = beams[d];
    const double angle = wedge.Angles[0] + (double(d) + 0.5) / Directions * opening;
    for (double radius = wedge.Radii[0]; radius <= wedge.Radii[1]; radius += 1)
    {
      const double column = wedge.Origin[0] + radius * std::sin(angle);
      const double row = (wedge.Origin[1] + radius * std::cos(angle)) / aspect;
      if (column > box.Left - 1 && column < box.Right && row > box.Top - 1 && row < box.Bottom)
      {
        beam.Begin = beam.Begin > 0 ? beam.Begin : radius;
        beam.End = radius;
      }
    }
    if (beam.End > wedge.Radii[1] - 1.5)
    {
      ++free;
      const double tolerance = std::max(3.0, ArcTolerance * wedge.Radii[1]);
      confirmed += beam.Farthest > wedge.Radii[1] - tolerance ? 1 : 0;
    }
    const double nearest = std::max(beam.Nearest, beam.Begin);
    const double farthest = std::min(beam.Farthest, beam.End);
    all += beam.End * beam.End - beam.Begin * beam.Begin;
    between += farthest > nearest ? farthest * farthest - nearest * nearest : 0;
  }
  proposal.Between = all > 0 ? between / all : 0;
  proposal.IsTrusted = free >= LeastFree * Directions && confirmed >= LeastFarSupport * free;
  return proposal;
}

// Part of a box that lies between the outermost pixels of rows, or of columns.
double GetBetween(const PixelSet& set, const PixelRectangle& box)
{
  const auto [rows, columns] = set.GetLines();
  double inRows = 0, inColumns = 0;
  for (const PixelRectangle& row : rows)
  {
    inRows += row.Right > 0 ? row.GetWidth() : 0;
  }
  for (const PixelRectangle& column : columns)
  {
    inColumns += column.Right > 0 ? column.GetHeight() : 0;
  }
  return std::max(inRows, inColumns) / box.GetArea();
}

Fan MakeFan(const Wedge& wedge, double aspect, double width, bool isFlipped, int height)
{
  constexpr double halfPixel = 0.5;
  Fan fan;
  fan.Origin = { wedge.Origin[0], wedge.Origin[1] / aspect };
  const double margin = halfPixel / wedge.Radii[1];
  fan.Angles = { (wedge.Angles[0] - margin) * 180 / Pi, (wedge.Angles[1] + margin) * 180 / Pi };
  fan.Radii = { width * std::max(0.0, wedge.Radii[0] - halfPixel),
    width * (wedge.Radii[1] + halfPixel * std::max(1.0, aspect)) };
  if (isFlipped)
  {
    fan.Origin[1] = height - 1 - fan.Origin[1];
    fan.Angles = { 180 - fan.Angles[1], 180 - fan.Angles[0] };
  }
  return fan;
}

std::string Percent(double fraction)
{
  return std::to_string(std::lround(1000 * fraction) / 10) + "." +
    std::to_string(std::lround(1000 * fraction) % 10) + " %";
}
}

void ScanOutline::Put(const SliceImage& slice)
{
  if (this->Count == 0)
  {
    if (slice.Width < SmallestSize || slice.Height < SmallestSize)
    {
      throw std::invalid_argument("the frame has " + std::to_string(slice.Width) + " x " +
        std::to_string(slice.Height) +
        " pixels; at least 16 x 16 are needed to find the scan region");
    }
    this->Width = slice.Width;
    this->Height = slice.Height;
    constexpr float none = std::numeric_limits<float>::infinity();
    this->Pixels.assign(
      static_cast<std::size_t>(this->Width) * static_cast<std::size_t>(this->Height),
      { none, none, -none });
  }
  if (slice.Width != this->Width || slice.Height != this->Height)
  {
    throw std::invalid_argument("frames of " + std::to_string(this->Width) + " x " +
      std::to_string(this->Height) + " and of " + std::to_string(slice.Width) + " x " +
      std::to_string(slice.Height) + " pixels cannot be compared");
  }
  ++this->Count;
  DispatchScalars(slice.Type, slice.Pixels,
    [&](const auto* pixels)
    {
      Levels* levels = this->Pixels.data();
      for (int row = 0; row < slice.Height; ++row)
      {
        for (int column = 0; column < slice.Width; ++column, ++levels)
        {
          const auto level = static_cast<float>(pixels[slice.RowStride * row + column]);
          if (std::isfinite(level))
          {
            levels->SecondLowest = std::min(levels->SecondLowest, std::max(level, levels->Lowest));
            levels->Lowest = std::min(levels->Lowest, level);
            levels->Highest = std::max(levels->Highest, level);
          }
        }
      }
    });
}

ScanRegion ScanOutline::Propose(const Vec2& pixelSpacing) const
{
  for (const double spacing : pixelSpacing)
  {
    if (!(spacing > 0) || !std::isfinite(spacing))
    {
      throw std::invalid_argument("width and height of pixels must be above 0");
    }
  }
  ScanRegion region;
  if (this->Count < FewestSlices)
  {
    region.Text = "the outline of what changes needs 3 frames or more";
    return region;
  }
  Screen screen{ this->Width, this->Height, {}, {}, {}, 0 };
  for (const Levels& levels : this->Pixels)
  {
    const bool isSeen = levels.Lowest <= levels.Highest; // else it is no number in any slice
    const float lowest = this->Count < 4 ? levels.Lowest : levels.SecondLowest;
    screen.Lowest.push_back(isSeen ? std::min(lowest, levels.Highest) : 0);
    screen.Highest.push_back(isSeen ? levels.Highest : 0);
    screen.Ranges.push_back(isSeen ? levels.Highest - levels.Lowest : 0);
  }
  const auto background = static_cast<float>(GetMostFrequent(screen.Lowest));
  for (std::vector<float>* levels : { &screen.Lowest, &screen.Highest })
  {
    for (float& level : *levels)
    {
      level -= background;
    }
  }
  screen.Top = *std::max_element(screen.Highest.begin(), screen.Highest.end());
  const PixelSet moving = FindMoving(screen);
  const double size = double(this->Width) * this->Height;
  const double part = static_cast<double>(moving.GetSize()) / size;
  if (part < LeastChanging)
  {
    region.Text = part > 0 ? "besides texts only " + Percent(part) + " of the pixels change"
                           : "besides texts nothing changes";
    return region;
  }
  const PixelRectangle box = moving.GetBounds();
  if (box.GetArea() < SmallestBox * size)
  {
    region.Text =
      "all that changes besides texts is in " + Percent(box.GetArea() / size) + " of the image";
    return region;
  }
  region.Fan.Rectangle = { box.Left, box.Top, box.GetWidth(), box.GetHeight() };
  const double aspect = pixelSpacing[1] / pixelSpacing[0];
  const Proposal upright = TryWedge(moving, aspect), turned = TryWedge(moving.Flipped(), aspect);
  const bool isFlipped = turned.IsTrusted && !(upright.IsTrusted && upright.Area <= turned.Area);
  const Proposal& sector = isFlipped ? turned : upright;
  region.Fan.IsSector = sector.IsTrusted;
  if (sector.IsTrusted)
  {
    region.Fan.Sector = MakeFan(sector.Shape, aspect, pixelSpacing[0], isFlipped, this->Height);
  }
  else if (box.GetArea() >= size)
  {
    region.Text = "changes reach all edges of the image: perhaps all of it is the scan region";
    return region;
  }
  region.IsFound = true;
  region.Fan.Support = sector.IsTrusted ? sector.Between : GetBetween(moving, box);
  region.Confidence = HighestConfidence * region.Fan.Support;
  region.Text = std::string("a proposal: the smallest ") +
    (sector.IsTrusted ? "sector, cut to a rectangle," : "rectangle") +
    " that holds all changes, except texts and single pixels. Nothing but what lies in it has "
    "changed; the true region may be larger: check it";
  return region;
}
}
