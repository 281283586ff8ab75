// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPoseOutliers.h"

#include <algorithm>
#include <limits>

namespace lacuna
{
namespace
{
// Far beyond what a hand does between two slices and far below what ruins a volume.
constexpr double JumpInMedianSteps = 20;
// More slices than this at one place are hardly a slip of the tracker.
constexpr std::size_t LargestOutlierGroup = 3;
constexpr std::size_t OutlierFraction = 4;

double GetMedian(std::vector<double> values)
{
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Groups among which a slice after a jump looks for the one it continues.
constexpr std::size_t GroupsToSearch = 8;

// mm for each slice number.
double GetStepPerNumber(const SlicePlace& a, const SlicePlace& b)
{
  return GetStep(a, b) / static_cast<double>(std::max<std::int64_t>(1, b.Number - a.Number));
}

// The slices of each group, in their order.
std::vector<std::vector<std::size_t>> MakeGroups(
  const std::vector<SlicePlace>& slices, double longestStep)
{
  std::vector<std::vector<std::size_t>> groups{ { 0 } };
  std::size_t current = 0;
  for (std::size_t i = 1; i < slices.size(); ++i)
  {
    const auto continues = [&](std::size_t group)
    { return GetStepPerNumber(slices[groups[group].back()], slices[i]) <= longestStep; };
    if (!continues(current))
    {
      const std::size_t oldest = groups.size() - std::min(GroupsToSearch, groups.size());
      current = groups.size();
      for (std::size_t group = oldest; group < groups.size(); ++group)
      {
        // the group of the latest slice that can be continued
        if (continues(group) &&
          (current == groups.size() || groups[group].back() > groups[current].back()))
        {
          current = group;
        }
      }
      if (current == groups.size())
      {
        groups.emplace_back();
      }
    }
    groups[current].push_back(i);
  }
  return groups;
}
}

double GetStep(const SlicePlace& a, const SlicePlace& b)
{
  double largest = 0;
  for (std::size_t c = 0; c < 4; ++c)
  {
    largest = std::max(largest, Norm(a.Corners[c] - b.Corners[c]));
  }
  return largest;
}

PoseOutliers FindPoseOutliers(const std::vector<SlicePlace>& slices)
{
  PoseOutliers found;
  if (slices.size() < 2)
  {
    return found;
  }
  std::vector<double> diagonals;
  std::vector<double> steps; // before each slice but the first
  for (std::size_t i = 0; i < slices.size(); ++i)
  {
    const std::array<Vec3, 4>& corners = slices[i].Corners;
    diagonals.push_back(std::max(Norm(corners[3] - corners[0]), Norm(corners[2] - corners[1])));
    if (i > 0)
    {
      steps.push_back(GetStepPerNumber(slices[i - 1], slices[i]));
    }
  }
  found.MedianStep = GetMedian(steps);
  found.LongestStep = std::max(GetMedian(diagonals), JumpInMedianSteps * found.MedianStep);

  const std::vector<std::vector<std::size_t>> groups = MakeGroups(slices, found.LongestStep);
  std::size_t longest = 0;
  for (const std::vector<std::size_t>& group : groups)
  {
    longest = std::max(longest, group.size());
  }
  std::vector<char> isOutlier(slices.size(), 0);
  for (const std::vector<std::size_t>& group : groups)
  {
    for (const std::size_t i : group)
    {
      isOutlier[i] = group.size() <= std::min(LargestOutlierGroup, longest / OutlierFraction);
    }
  }
  std::vector<std::size_t> next(slices.size(), slices.size()); // that is no outlier
  for (std::size_t i = slices.size() - 1; i > 0; --i)
  {
    next[i - 1] = isOutlier[i] ? next[i] : i;
  }
  std::size_t previous = slices.size();
  for (std::size_t i = 0; i < slices.size(); ++i)
  {
    if (!isOutlier[i])
    {
      previous = i;
      continue;
    }
    PoseOutliers::Outlier outlier{ i, std::numeric_limits<double>::infinity() };
    for (const std::size_t kept : { previous, next[i] })
    {
      if (kept < slices.size())
      {
        outlier.Distance = std::min(outlier.Distance, GetStep(slices[i], slices[kept]));
      }
    }
    found.Outliers.push_back(outlier);
  }
  return found;
}
}
