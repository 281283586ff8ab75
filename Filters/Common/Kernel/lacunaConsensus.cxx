// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaConsensus.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lacuna
{
namespace
{
constexpr double WeightOfOutside = 2;

// How well a line fits: outwards is -1 where the part lies at larger Across, else 1.
double GetScore(
  const std::vector<BorderPoint>& points, const BorderLine& line, double outwards, double tolerance)
{
  double score = 0;
  const double scale = outwards / std::sqrt(1 + line.Slope * line.Slope);
  for (const BorderPoint& p : points)
  {
    const double distance = scale * (p.Across - line.At(p.Along));
    score += distance > tolerance ? -WeightOfOutside : distance >= -tolerance ? 1 : 0;
  }
  return score;
}

void Refine(const std::vector<BorderPoint>& points, BorderLine& line, double tolerance)
{
  const double reach = tolerance * std::sqrt(1 + line.Slope * line.Slope);
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const BorderPoint& p : points)
  {
    if (std::abs(p.Across - line.At(p.Along)) <= reach)
    {
      n += 1;
      x += p.Along;
      y += p.Across;
      xx += p.Along * p.Along;
      xy += p.Along * p.Across;
    }
  }
  const double spread = n * xx - x * x;
  if (n >= 3 && spread > 0)
  {
    line.Slope = (n * xy - x * y) / spread;
    line.Offset = (y - line.Slope * x) / n;
  }
}
}

BorderLine FindBorderLine(const std::vector<BorderPoint>& points, double outwards, double tolerance)
{
  BorderLine best;
  if (points.size() < 8)
  {
    return best;
  }
  constexpr std::size_t candidates = 64;
  const std::size_t step = std::max<std::size_t>(1, points.size() / candidates);
  double bestScore = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.size(); i += step)
  {
    for (std::size_t j = i + 4 * step; j < points.size(); j += step)
    {
      BorderLine line;
      line.Slope = (points[j].Across - points[i].Across) / (points[j].Along - points[i].Along);
      line.Offset = points[i].Across - line.Slope * points[i].Along;
      const double score = GetScore(points, line, outwards, tolerance);
      if (score > bestScore)
      {
        bestScore = score;
        best = line;
      }
    }
  }
  for (int n = 0; n < 5; ++n)
  {
    Refine(points, best, tolerance);
  }
  best.Support = GetScore(points, best, outwards, tolerance) / static_cast<double>(points.size());
  return best;
}

BorderLevel FindBorderLevel(const std::vector<double>& values, double outwards, double tolerance)
{
  BorderLevel best;
  double bestScore = -std::numeric_limits<double>::infinity();
  for (const double candidate : values)
  {
    double score = 0;
    double sum = 0;
    double agreeing = 0;
    for (const double value : values)
    {
      const double distance = outwards * (value - candidate);
      if (distance > tolerance)
      {
        score -= WeightOfOutside;
      }
      else if (distance >= -tolerance)
      {
        score += 1;
        sum += value;
        agreeing += 1;
      }
    }
    if (score > bestScore)
    {
      bestScore = score;
      best = { sum / agreeing, score / static_cast<double>(values.size()) };
    }
  }
  return best;
}
}
