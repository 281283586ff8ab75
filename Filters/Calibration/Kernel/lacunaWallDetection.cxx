// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaWallDetection.h"

#include "lacunaConsensus.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lacuna
{
namespace
{
constexpr int SmallestSize = 16;
constexpr double BrightPercentile = 0.995;
constexpr double StrongPart = 0.5;
constexpr double Tolerance = 0.01; // of the height
constexpr double SmallestCoverage = 0.5;
constexpr double SmallestSupport = 0.6;
constexpr double EndMargin = 0.1;
constexpr double LargestBrightPart = 0.2; // of the image: more is tissue or noise

// Where the first strong echo of a column is brightest, between rows; negative: there is none.
double FindEcho(const std::vector<float>& levels, int width, int height, int column, float strong)
{
  const auto level = [&](int row)
  {
    return levels[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
      static_cast<std::size_t>(column)];
  };
  int row = 0;
  while (row < height && level(row) < strong)
  {
    ++row;
  }
  int peak = row;
  for (; row < height && level(row) >= strong; ++row)
  {
    peak = level(row) > level(peak) ? row : peak;
  }
  if (peak >= height)
  {
    return -1;
  }
  if (peak == 0 || peak == height - 1)
  {
    return peak;
  }
  const double before = level(peak - 1), at = level(peak), after = level(peak + 1);
  const double curvature = before - 2 * at + after;
  return curvature < 0 ? peak + 0.5 * (before - after) / curvature : peak;
}
}

std::optional<WallLine> FindWall(const GreyImage& image)
{
  if (image.Width < SmallestSize || image.Height < SmallestSize)
  {
    return {};
  }
  const std::vector<float> levels = GetLevels(image);
  std::vector<float> sorted = levels;
  const auto bright = sorted.begin() +
    static_cast<std::ptrdiff_t>(BrightPercentile * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), bright, sorted.end());
  const float dark = *std::min_element(levels.begin(), levels.end());
  if (!(*bright > dark))
  {
    return {};
  }
  const float strong = dark + static_cast<float>(StrongPart) * (*bright - dark);
  const auto brightPixels =
    std::count_if(levels.begin(), levels.end(), [strong](float level) { return level >= strong; });
  if (static_cast<double>(brightPixels) > LargestBrightPart * static_cast<double>(levels.size()))
  {
    return {};
  }
  std::vector<BorderPoint> points;
  for (int column = 0; column < image.Width; ++column)
  {
    const double row = FindEcho(levels, image.Width, image.Height, column, strong);
    if (row >= 0)
    {
      points.push_back({ static_cast<double>(column), row });
    }
  }
  if (static_cast<double>(points.size()) < SmallestCoverage * image.Width)
  {
    return {};
  }
  // Equally on both sides: what lies nearer is a particle, what lies further a gap in the echo.
  const double tolerance = std::max(1.0, Tolerance * image.Height);
  const BorderLine line = FindBorderLine(points, 1, tolerance);
  double first = image.Width, last = 0, agreeing = 0;
  for (const BorderPoint& point : points)
  {
    if (std::abs(point.Across - line.At(point.Along)) <=
      tolerance * std::sqrt(1 + line.Slope * line.Slope))
    {
      first = std::min(first, point.Along);
      last = std::max(last, point.Along);
      agreeing += 1;
    }
  }
  WallLine wall;
  wall.Support = agreeing / static_cast<double>(points.size());
  if (wall.Support < SmallestSupport)
  {
    return {};
  }
  const double margin = EndMargin * (last - first);
  for (int end = 0; end < 2; ++end)
  {
    const double column = end == 0 ? first + margin : last - margin;
    wall.Points[static_cast<std::size_t>(end)] = { column, line.At(column) };
  }
  return wall;
}
}
