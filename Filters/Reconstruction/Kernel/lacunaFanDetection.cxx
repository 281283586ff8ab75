// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFanDetection.h"

#include "lacunaActivityMap.h"
#include "lacunaConsensus.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace lacuna
{
namespace
{
constexpr double Tolerance = 1.5; // pixels, the larger of the two spacings
constexpr double LeastSupport = 1.0 / 3;
constexpr double LeastSupportOfRectangles = 0.4; // more than a small disc gives
constexpr double LeastInside = 0.98;
constexpr double LeastCovered = 0.5;
// Fractions of the largest change below which a pixel counts as unchanged.
constexpr std::array<double, 6> Thresholds{ 0, 1.0 / 256, 1.0 / 128, 1.0 / 64, 1.0 / 32, 1.0 / 16 };
constexpr double SmallestOpening = 6; // degrees
constexpr int MostDirections = 240;
constexpr int FewestDirections = 16;
// The region of change cannot be narrower than its neighbourhoods: nearer to the tip of a sector
// than this many pixels across, its border says nothing.
constexpr double TipWidth = 36;
// The outermost pixels that change lie half a pixel, on average, within the border.
constexpr double HalfPixel = 0.5;
constexpr int EdgeWidth = 3;
constexpr double SmallestPart = 0.05; // of the image: a clock changes, too
constexpr double Pi = 3.14159265358979323846;

// A shape under test.
struct Trial
{
  DetectedFan Fan;
  std::string Doubt; ///< why it cannot be trusted; empty when it can
};

// Borders of a part of an image, in pixels.
class Outline
{
public:
  explicit Outline(const PixelSet& part)
    : Width(part.GetWidth())
    , Height(part.GetHeight())
    , Top(static_cast<std::size_t>(part.GetWidth()), part.GetHeight())
    , Bottom(static_cast<std::size_t>(part.GetWidth()), -1)
  {
    for (int row = 0; row < this->Height; ++row)
    {
      int first = this->Width;
      int last = -1;
      for (int column = 0; column < this->Width; ++column)
      {
        if (part.Has(column, row))
        {
          first = std::min(first, column);
          last = column;
          const auto c = static_cast<std::size_t>(column);
          this->Top[c] = std::min(this->Top[c], row);
          this->Bottom[c] = row;
        }
      }
      if (last >= 0)
      {
        this->Rows.push_back({ row, first, last });
      }
    }
  }

  struct Row
  {
    int Number, First, Last;
  };
  int Width, Height;
  std::vector<Row> Rows;
  std::vector<int> Top, Bottom; ///< per column; Bottom -1 where there is none
};

std::string Percent(double fraction)
{
  return std::to_string(static_cast<int>(std::lround(100 * std::max(0.0, fraction)))) + " %";
}

// Fraction of the part inside of a shape (grown by the tolerance), and of the shape in the part.
template <class Inside, class NearlyInside>
std::string CompareAreas(
  const PixelSet& part, const std::string& verb, const Inside& inside, const NearlyInside& nearly)
{
  std::int64_t both = 0, shape = 0, partNear = 0, partAll = 0;
  for (int row = 0; row < part.GetHeight(); ++row)
  {
    for (int column = 0; column < part.GetWidth(); ++column)
    {
      const bool has = part.Has(column, row);
      const bool in = inside(column, row);
      shape += in ? 1 : 0;
      both += in && has ? 1 : 0;
      partAll += has ? 1 : 0;
      partNear += has && nearly(column, row) ? 1 : 0;
    }
  }
  const double insideFraction = static_cast<double>(partNear) / std::max(1.0, double(partAll));
  const double covered = static_cast<double>(both) / std::max(1.0, double(shape));
  if (insideFraction < LeastInside)
  {
    return "only " + Percent(insideFraction) + " of the pixels that " + verb + " lie in it";
  }
  if (covered < LeastCovered)
  {
    return "only " + Percent(covered) + " of its pixels " + verb;
  }
  return {};
}

Trial TryRectangle(const PixelSet& part, const Outline& outline, const std::string& verb)
{
  std::vector<double> left, right, top, bottom;
  for (const Outline::Row& row : outline.Rows)
  {
    left.push_back(row.First);
    right.push_back(row.Last);
  }
  for (std::size_t c = 0; c < outline.Bottom.size(); ++c)
  {
    if (outline.Bottom[c] >= 0)
    {
      top.push_back(outline.Top[c]);
      bottom.push_back(outline.Bottom[c]);
    }
  }
  const BorderLevel sides[4] = { FindBorderLevel(left, -1, Tolerance),
    FindBorderLevel(right, 1, Tolerance), FindBorderLevel(top, -1, Tolerance),
    FindBorderLevel(bottom, 1, Tolerance) };
  constexpr std::array<const char*, 4> names{ "left", "right", "upper", "lower" };
  const auto round = [](double value) { return static_cast<int>(std::lround(value)); };
  Trial trial;
  const int first[2] = { round(sides[0].Value), round(sides[2].Value) };
  const int last[2] = { round(sides[1].Value), round(sides[3].Value) };
  trial.Fan.Rectangle = { first[0], first[1], last[0] - first[0] + 1, last[1] - first[1] + 1 };
  trial.Fan.Support = 1;
  for (std::size_t s = 0; s < 4 && trial.Doubt.empty(); ++s)
  {
    trial.Fan.Support = std::min(trial.Fan.Support, sides[s].Support);
    if (sides[s].Support < LeastSupportOfRectangles)
    {
      trial.Doubt = std::string("the ") + names[s] + " side of a rectangle is confirmed by only " +
        Percent(sides[s].Support) + " of its length";
    }
  }
  if (trial.Doubt.empty())
  {
    const auto within = [&](int column, int row, int margin)
    {
      return column >= first[0] - margin && column <= last[0] + margin &&
        row >= first[1] - margin && row <= last[1] + margin;
    };
    trial.Doubt = CompareAreas(
      part, verb, [&](int x, int y) { return within(x, y, 0); },
      [&](int x, int y) { return within(x, y, 2); });
    trial.Doubt = trial.Doubt.empty() ? "" : "of a rectangle: " + trial.Doubt;
  }
  return trial;
}

double GetQuantile(std::vector<double> values, double fraction)
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

// Radii of the part's borders, one per direction from the origin; lengths are in columns.
struct PolarOutline
{
  std::vector<double> Nearest, Farthest;
  bool IsCutNear = false; ///< most of what is nearest lies at the image's edge
  bool IsCutFar = false;
  double LargestRadius = 0;
};

PolarOutline MakePolarOutline(
  const PixelSet& part, const Vec2& origin, const Vec2& angles, double aspect, int directions)
{
  struct Bin
  {
    double Nearest = std::numeric_limits<double>::infinity();
    double Farthest = -1;
    bool IsNearestAtEdge = false;
    bool IsFarthestAtEdge = false;
  };
  std::vector<Bin> bins(static_cast<std::size_t>(directions));
  const double range = angles[1] - angles[0];
  for (int row = 0; row < part.GetHeight(); ++row)
  {
    for (int column = 0; column < part.GetWidth(); ++column)
    {
      const double x = column - origin[0];
      const double y = aspect * (row - origin[1]);
      // a fortieth at the sides is left to the sides
      const double along = (std::atan2(x, y) - angles[0]) / range;
      if (!part.Has(column, row) || along < 0.025 || along >= 0.975)
      {
        continue;
      }
      Bin& bin = bins[static_cast<std::size_t>((along - 0.025) / 0.95 * directions)];
      const double radius = std::sqrt(x * x + y * y);
      const bool atEdge =
        column == 0 || row == 0 || column == part.GetWidth() - 1 || row == part.GetHeight() - 1;
      if (radius < bin.Nearest)
      {
        bin.Nearest = radius;
        bin.IsNearestAtEdge = atEdge;
      }
      if (radius > bin.Farthest)
      {
        bin.Farthest = radius;
        bin.IsFarthestAtEdge = atEdge;
      }
    }
  }
  PolarOutline outline;
  std::size_t cutNear = 0;
  std::size_t cutFar = 0;
  for (const Bin& bin : bins)
  {
    if (bin.Farthest >= 0)
    {
      cutNear += bin.IsNearestAtEdge ? 1 : 0;
      cutFar += bin.IsFarthestAtEdge ? 1 : 0;
      outline.LargestRadius = std::max(outline.LargestRadius, bin.Farthest);
      if (!bin.IsNearestAtEdge)
      {
        outline.Nearest.push_back(bin.Nearest);
      }
      if (!bin.IsFarthestAtEdge)
      {
        outline.Farthest.push_back(bin.Farthest);
      }
    }
  }
  outline.IsCutNear = cutNear > outline.Nearest.size();
  outline.IsCutFar = cutFar > outline.Farthest.size();
  return outline;
}

// The left and the right side of a sector that opens downwards; lengths are in columns.
std::array<BorderLine, 2> FindSides(const Outline& outline, double aspect, double tolerance)
{
  std::vector<BorderPoint> leftPoints, rightPoints;
  for (const Outline::Row& row : outline.Rows)
  {
    if (row.First > 0)
    {
      leftPoints.push_back({ aspect * row.Number, double(row.First) });
    }
    if (row.Last < outline.Width - 1)
    {
      rightPoints.push_back({ aspect * row.Number, double(row.Last) });
    }
  }
  return { FindBorderLine(leftPoints, -1, tolerance), FindBorderLine(rightPoints, 1, tolerance) };
}

// Why these are no sides of a sector; empty: they are.
std::string DoubtSides(const BorderLine& left, const BorderLine& right, const Vec2& angles)
{
  if (left.Support < LeastSupport || right.Support < LeastSupport)
  {
    return std::string("the ") + (left.Support < right.Support ? "left" : "right") +
      " side of a sector is confirmed by only " + Percent(std::min(left.Support, right.Support)) +
      " of its length";
  }
  if (!((angles[1] - angles[0]) * 180 / Pi > SmallestOpening))
  {
    return "its sides do not open like those of a sector";
  }
  return {};
}

// Where the sides meet.
Vec2 FindOrigin(BorderLine left, BorderLine right, double aspect)
{
  left.Offset -= HalfPixel * std::sqrt(1 + left.Slope * left.Slope);
  right.Offset += HalfPixel * std::sqrt(1 + right.Slope * right.Slope);
  const double y = (left.Offset - right.Offset) / (right.Slope - left.Slope);
  return { left.At(y), y / aspect };
}

// Of the arcs of a sector, in columns; the trial is told their support, or why they are doubtful.
Vec2 FindRadii(const PixelSet& part, const Vec2& origin, const Vec2& angles, double aspect,
  double tolerance, Trial& trial)
{
  const double opening = angles[1] - angles[0];
  const PolarOutline polar = MakePolarOutline(part, origin, angles, aspect, MostDirections);
  const BorderLevel outer = FindBorderLevel(polar.Farthest, 1, tolerance);
  // a direction must be wider than a pixel, else its nearest one is a matter of chance
  const double nearArc = opening * GetQuantile(polar.Nearest, 0.5);
  const PolarOutline nearPolar = MakePolarOutline(part, origin, angles, aspect,
    static_cast<int>(std::clamp<double>(nearArc / 2.5, FewestDirections, MostDirections)));
  const BorderLevel inner = FindBorderLevel(nearPolar.Nearest, -1, tolerance);
  Vec2 radii{ inner.Value - HalfPixel,
    polar.IsCutFar ? polar.LargestRadius : outer.Value + HalfPixel };
  if (nearPolar.IsCutNear)
  {
    radii[0] = 0;
  }
  else if (inner.Support < LeastSupport)
  {
    if (nearArc > TipWidth)
    {
      trial.Doubt = "the near arc of a sector is confirmed by only " + Percent(inner.Support) +
        " of its length";
      return radii;
    }
    radii[0] = GetQuantile(nearPolar.Nearest, 0.1) - HalfPixel;
  }
  else if (nearArc > TipWidth)
  {
    trial.Fan.Support = std::min(trial.Fan.Support, inner.Support);
  }
  if (radii[0] < 2 * tolerance) // a phased probe: the beams begin in one point
  {
    radii[0] = 0;
  }
  if (!polar.IsCutFar && outer.Support < LeastSupport)
  {
    trial.Doubt =
      "the far arc of a sector is confirmed by only " + Percent(outer.Support) + " of its length";
  }
  else if (!polar.IsCutFar)
  {
    trial.Fan.Support = std::min(trial.Fan.Support, outer.Support);
  }
  return radii;
}

// A sector that is larger by a margin (mm) on all sides; its angles are in radians.
Fan Grow(const Fan& sector, const Vec2& angles, double margin, const Vec2& pixelSpacing)
{
  Fan grown = sector;
  grown.Radii = { std::max(0.0, grown.Radii[0] - margin), grown.Radii[1] + margin };
  // sides moved outwards by the margin: the origin moves back along the bisector
  const double half = 0.5 * (angles[1] - angles[0]);
  const double middle = 0.5 * (angles[1] + angles[0]);
  const double back = margin / std::sin(half);
  grown.Origin = { sector.Origin[0] - back * std::sin(middle) / pixelSpacing[0],
    sector.Origin[1] - back * std::cos(middle) / pixelSpacing[1] };
  grown.Radii[1] += back;
  return grown;
}

// First column and row, columns and rows of what a mask lets through.
std::array<int, 4> GetBox(const FanMask& mask, int width, int height)
{
  int box[4] = { width, height, -1, -1 };
  for (int row = 0; row < height; ++row)
  {
    for (const IndexInterval& run : mask.GetRuns(row))
    {
      box[0] = std::min(box[0], static_cast<int>(run.First));
      box[2] = std::max(box[2], static_cast<int>(run.Last));
      box[1] = std::min(box[1], row);
      box[3] = row;
    }
  }
  return { box[0], box[1], box[2] - box[0] + 1, box[3] - box[1] + 1 };
}

// A sector that opens downwards.
Trial TrySector(
  const PixelSet& part, const Outline& outline, const Vec2& pixelSpacing, const std::string& verb)
{
  const double aspect = pixelSpacing[1] / pixelSpacing[0];
  const double tolerance = Tolerance * std::max(1.0, aspect);
  Trial trial;
  const auto [left, right] = FindSides(outline, aspect, tolerance);
  const Vec2 angles{ std::atan(left.Slope), std::atan(right.Slope) };
  trial.Doubt = DoubtSides(left, right, angles);
  if (!trial.Doubt.empty())
  {
    return trial;
  }
  trial.Fan.Support = std::min(left.Support, right.Support);
  const Vec2 origin = FindOrigin(left, right, aspect);
  const Vec2 radii = FindRadii(part, origin, angles, aspect, tolerance, trial);
  if (!trial.Doubt.empty())
  {
    return trial;
  }
  const double mm = pixelSpacing[0];
  trial.Fan.IsSector = true;
  trial.Fan.Sector.Origin = origin;
  trial.Fan.Sector.Angles = { angles[0] * 180 / Pi, angles[1] * 180 / Pi };
  trial.Fan.Sector.Radii = { radii[0] * mm, radii[1] * mm };
  if (!(radii[0] < radii[1]))
  {
    trial.Doubt = "its arcs do not fit each other";
    return trial;
  }
  const FanMask mask(trial.Fan.Sector, part.GetWidth(), part.GetHeight(), pixelSpacing);
  const FanMask nearly(Grow(trial.Fan.Sector, angles, 1.5 * tolerance * mm, pixelSpacing),
    part.GetWidth(), part.GetHeight(), pixelSpacing);
  trial.Doubt = CompareAreas(
    part, verb, [&](int c, int r) { return mask.Contains(c, r); },
    [&](int c, int r) { return nearly.Contains(c, r); });
  trial.Doubt = trial.Doubt.empty() ? "" : "of a sector: " + trial.Doubt;
  trial.Fan.Rectangle = GetBox(mask, part.GetWidth(), part.GetHeight());
  return trial;
}

Trial TryFlippedSector(const PixelSet& part, const Vec2& pixelSpacing, const std::string& verb)
{
  const PixelSet flipped = part.Flipped();
  Trial trial = TrySector(flipped, Outline(flipped), pixelSpacing, verb);
  Fan& sector = trial.Fan.Sector;
  sector.Origin[1] = part.GetHeight() - 1 - sector.Origin[1];
  sector.Angles = { 180 - sector.Angles[1], 180 - sector.Angles[0] };
  trial.Fan.Rectangle[1] = part.GetHeight() - trial.Fan.Rectangle[1] - trial.Fan.Rectangle[3];
  return trial;
}
}

DetectedFan DetectFan(const std::vector<SliceImage>& slices, const Vec2& pixelSpacing)
{
  if (slices.size() < 3)
  {
    throw std::runtime_error("the fan cannot be found in " + std::to_string(slices.size()) +
      " slices: at least 3 are needed, what changes between them is taken for the fan");
  }
  const ActivityMap activity(slices);
  if (!(activity.GetLargestChange() > 0))
  {
    throw std::runtime_error("the fan cannot be found: nothing changes from slice to slice");
  }
  return DetectFan(activity, pixelSpacing, "change", 1);
}

DetectedFan DetectFan(
  const ActivityMap& activity, const Vec2& pixelSpacing, const std::string& verb, std::size_t parts)
{
  const int width = activity.GetWidth();
  const int height = activity.GetHeight();
  std::string smallness;
  std::array<std::string, 3> doubts; // of a rectangle, of a sector, of one upside down
  DetectedFan whole;
  bool isWhole = false;
  std::size_t rank = 0;
  for (std::size_t attempt = 0; rank < parts && !(isWhole && rank > 0);
       rank = ++attempt / Thresholds.size())
  {
    const double fraction = Thresholds[attempt % Thresholds.size()];
    const PixelSet part = activity.GetLargestPart(fraction * activity.GetLargestChange(), rank);
    const double size = static_cast<double>(part.GetSize()) / (static_cast<double>(width) * height);
    if (size < SmallestPart)
    {
      if (rank == 0)
      {
        smallness = "; the pixels that " + verb + " cover only " + Percent(size) + " of the image";
      }
      attempt = (rank + 1) * Thresholds.size() - 1; // the next part
      continue;
    }
    const Outline outline(part);
    const std::array<Trial, 3> trials{ TryRectangle(part, outline, verb),
      TrySector(part, outline, pixelSpacing, verb), TryFlippedSector(part, pixelSpacing, verb) };
    for (std::size_t n = 0; n < trials.size(); ++n)
    {
      const Trial& trial = trials[n];
      const std::array<int, 4>& r = trial.Fan.Rectangle;
      const bool isWide = r[0] < EdgeWidth && r[0] + r[2] > width - EdgeWidth;
      if (!trial.Doubt.empty())
      {
        doubts[n] = rank == 0 ? "; " + trial.Doubt : doubts[n];
      }
      else if (!trial.Fan.IsSector && isWide && r[1] < EdgeWidth &&
        r[1] + r[3] > height - EdgeWidth)
      {
        isWhole = true;
        whole = trial.Fan;
        break;
      }
      else if (trial.Fan.IsSector || !isWhole ||
        (r[0] >= EdgeWidth && r[0] + r[2] <= width - EdgeWidth))
      {
        return trial.Fan;
      }
    }
  }
  if (isWhole)
  {
    return whole;
  }
  throw std::runtime_error(
    "the fan cannot be found for certain" + smallness + doubts[0] + doubts[1]);
}
}
