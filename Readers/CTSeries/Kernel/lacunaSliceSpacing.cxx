// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSliceSpacing.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr double MostPlanes = 1e6;
constexpr int MostParts = 5; // a grid that is finer still would be mostly interpolated

std::vector<double> GetGaps(const std::vector<double>& positions)
{
  std::vector<double> gaps;
  for (std::size_t i = 1; i < positions.size(); ++i)
  {
    gaps.push_back(positions[i] - positions[i - 1]);
  }
  return gaps;
}

double GetUsualGap(std::vector<double> gaps, double tolerance)
{
  std::sort(gaps.begin(), gaps.end());
  const std::size_t enough = std::max<std::size_t>(3, gaps.size() / 10);
  for (std::size_t i = 0; i + enough <= gaps.size(); ++i)
  {
    // rounded positions make a gap wrong by twice their own error
    const double width = std::min(2 * tolerance, 0.1 * gaps[i]);
    if (gaps[i + enough - 1] - gaps[i] <= width)
    {
      const auto end = std::upper_bound(gaps.begin(), gaps.end(), gaps[i] + width);
      return gaps[(i + static_cast<std::size_t>(end - gaps.begin())) / 2];
    }
  }
  return gaps[gaps.size() / 2];
}

// The planes on which all slices lie; false when there are none.
bool FitPlanes(const std::vector<double>& positions, SliceSpacing& planes)
{
  const std::size_t count = positions.size();
  std::vector<double> index(count, 0.0);
  double sum = 0;
  double mean = positions[0];
  for (std::size_t i = 1; i < count; ++i)
  {
    const double steps = std::round((positions[i] - positions[i - 1]) / planes.Spacing);
    if (steps < 1)
    {
      return false;
    }
    index[i] = index[i - 1] + steps;
    sum += index[i];
    mean += positions[i];
  }
  mean /= static_cast<double>(count);
  const double center = sum / static_cast<double>(count);
  double numerator = 0;
  double denominator = 0;
  for (std::size_t i = 0; i < count; ++i)
  {
    numerator += (index[i] - center) * (positions[i] - mean);
    denominator += (index[i] - center) * (index[i] - center);
  }
  const double spacing = numerator / denominator;
  const double first = mean - spacing * center;
  double deviation = 0;
  for (std::size_t i = 0; i < count; ++i)
  {
    deviation = std::max(deviation, std::abs(positions[i] - (first + spacing * index[i])));
  }
  if (!(deviation <= planes.Tolerance))
  {
    return false;
  }
  // What rounding of the sums did is no property of the data.
  const bool exact = deviation < 1e-9;
  planes.First = exact ? positions[0] : first;
  planes.Spacing = exact ? (positions.back() - positions[0]) / index.back() : spacing;
  planes.Deviation = exact ? 0 : deviation;
  planes.Planes = static_cast<std::int64_t>(index.back()) + 1;
  for (std::size_t i = 1; i < count; ++i)
  {
    for (double k = index[i - 1] + 1; k < index[i]; ++k)
    {
      planes.Missing.push_back(static_cast<std::int64_t>(k));
    }
  }
  return true;
}
}

//------------------------------------------------------------------------------
SliceSpacing FindSliceSpacing(const std::vector<double>& positions, double tolerance)
{
  SliceSpacing planes;
  const std::vector<double> gaps = GetGaps(positions);
  planes.First = positions[0];
  planes.Spacing = planes.Usual = GetUsualGap(gaps, tolerance);
  planes.Tolerance = std::min(tolerance, 0.25 * planes.Spacing);
  const double length = (positions.back() - positions[0]) / planes.Spacing;
  if (!(length < MostPlanes))
  {
    std::ostringstream message;
    message << "at " << planes.Spacing << " mm from slice to slice that would be " << length
            << " slices";
    throw std::runtime_error(message.str());
  }
  if (FitPlanes(positions, planes))
  {
    return planes;
  }
  for (std::size_t i = 0; i < gaps.size(); ++i)
  {
    const double steps = std::max(1.0, std::round(gaps[i] / planes.Usual));
    if (std::abs(gaps[i] - steps * planes.Usual) > planes.Tolerance)
    {
      planes.UnequalGaps.push_back(i);
    }
  }
  for (int parts = 2; parts <= MostParts && parts * length < MostPlanes; ++parts)
  {
    SliceSpacing finer = planes;
    finer.Spacing = planes.Usual / parts;
    finer.Tolerance = std::min(tolerance, 0.25 * finer.Spacing);
    if (FitPlanes(positions, finer))
    {
      finer.Missing.clear(); // planes that no scanner meant to measure
      return finer;
    }
  }
  const double steps = std::max(1.0, std::round(length));
  planes.Planes = static_cast<std::int64_t>(steps) + 1;
  planes.Spacing = (positions.back() - positions[0]) / steps;
  planes.Tolerance = std::min(tolerance, 0.25 * planes.Spacing);
  return planes;
}
}
