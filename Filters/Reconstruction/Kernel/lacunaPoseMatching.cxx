// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPoseMatching.h"

#include "lacunaGeometryGate.h"
#include "lacunaItemList.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <iomanip>
#include <limits>
#include <numeric>
#include <sstream>
#include <stdexcept>

namespace lacuna
{
std::vector<PoseMatch> MatchByOrder(std::size_t slices, std::size_t rows)
{
  if (slices != rows)
  {
    std::ostringstream message;
    message << "there are " << slices << " slices but " << rows
            << " rows of poses; matched by order, each slice takes one row. Set MatchBy to "
               "FrameNumber or Time where the rows say to which slice or instant they belong";
    throw std::runtime_error(message.str());
  }
  std::vector<PoseMatch> matches(slices);
  for (std::size_t i = 0; i < slices; ++i)
  {
    matches[i].First = matches[i].Second = static_cast<std::ptrdiff_t>(i);
  }
  return matches;
}

//------------------------------------------------------------------------------
std::vector<PoseMatch> MatchByFrameNumber(
  std::size_t slices, const std::vector<double>& frames, double firstFrame)
{
  const double lastFrame = firstFrame + static_cast<double>(slices) - 1;
  if (lastFrame > INT_MAX)
  {
    std::ostringstream message;
    message << std::fixed << std::setprecision(0) << "FirstFrameNumber is " << firstFrame
            << ": the last of " << slices << " slices would have the number " << lastFrame
            << "; a frame number is at most " << INT_MAX;
    throw std::runtime_error(message.str());
  }
  std::vector<PoseMatch> matches(slices);
  bool any = false;
  for (std::size_t row = 0; row < frames.size(); ++row)
  {
    if (!(frames[row] == std::floor(frames[row])))
    {
      std::ostringstream message;
      message << "the frame number in row " << row << " is " << frames[row]
              << "; it must be a whole number";
      throw std::runtime_error(message.str());
    }
    const double slice = frames[row] - firstFrame;
    if (!(slice >= 0 && slice < static_cast<double>(slices)))
    {
      continue;
    }
    PoseMatch& match = matches[static_cast<std::size_t>(slice)];
    if (match.First != PoseMatch::None)
    {
      std::ostringstream message;
      message << "rows " << match.First << " and " << row << " both have the frame number "
              << frames[row];
      throw std::runtime_error(message.str());
    }
    match.First = match.Second = static_cast<std::ptrdiff_t>(row);
    any = true;
  }
  if (!any && slices > 0)
  {
    const auto ends = std::minmax_element(frames.begin(), frames.end());
    std::ostringstream message;
    message << "no row belongs to a slice: the slices have the frame numbers " << firstFrame
            << " to " << lastFrame << ", the rows ";
    if (frames.empty())
    {
      message << "none";
    }
    else
    {
      message << *ends.first << " to " << *ends.second;
    }
    message << "; set FirstFrameNumber to that of the first slice";
    throw std::runtime_error(message.str());
  }
  return matches;
}

//------------------------------------------------------------------------------
std::vector<PoseMatch> MatchByTime(const std::vector<double>& sliceTimes,
  const std::vector<double>& rowTimes, const std::vector<char>& usable, double maximumGap)
{
  std::vector<std::size_t> rows(rowTimes.size());
  std::iota(rows.begin(), rows.end(), std::size_t{ 0 });
  rows.erase(std::remove_if(rows.begin(), rows.end(), [&](std::size_t r) { return !usable[r]; }),
    rows.end());
  for (const std::size_t row : rows)
  {
    if (!std::isfinite(rowTimes[row]))
    {
      throw std::runtime_error("row " + std::to_string(row) + " has a pose but no time");
    }
  }
  std::stable_sort(rows.begin(), rows.end(),
    [&](std::size_t a, std::size_t b) { return rowTimes[a] < rowTimes[b]; });
  rows.erase(std::unique(rows.begin(), rows.end(),
               [&](std::size_t a, std::size_t b) { return rowTimes[a] == rowTimes[b]; }),
    rows.end());

  std::vector<PoseMatch> matches(sliceTimes.size());
  bool any = false;
  for (std::size_t i = 0; i < sliceTimes.size(); ++i)
  {
    const double time = sliceTimes[i];
    if (!std::isfinite(time))
    {
      throw std::runtime_error("slice " + std::to_string(i) + " has no time");
    }
    const auto after = std::lower_bound(
      rows.begin(), rows.end(), time, [&](std::size_t row, double t) { return rowTimes[row] < t; });
    if (after == rows.end() || (after == rows.begin() && rowTimes[*after] != time))
    {
      continue;
    }
    PoseMatch& match = matches[i];
    match.Second = static_cast<std::ptrdiff_t>(*after);
    match.First = match.Second;
    if (rowTimes[*after] != time)
    {
      const std::size_t before = *(after - 1);
      const double gap = rowTimes[*after] - rowTimes[before];
      if (maximumGap > 0 && gap > maximumGap)
      {
        match = PoseMatch();
        continue;
      }
      match.First = static_cast<std::ptrdiff_t>(before);
      match.Weight = (time - rowTimes[before]) / gap;
    }
    any = true;
  }
  if (!any && !sliceTimes.empty())
  {
    const auto ends = std::minmax_element(sliceTimes.begin(), sliceTimes.end());
    std::ostringstream message;
    message.precision(15);
    message << "no slice has a pose at its time: the slices were taken from " << *ends.first
            << " s to " << *ends.second << " s, ";
    if (rows.empty())
    {
      message << "and no row has a pose";
    }
    else
    {
      message << "the poses from " << rowTimes[rows.front()] << " s to " << rowTimes[rows.back()]
              << " s, and MaximumTimeGap is " << maximumGap
              << " s; set TimeOffset to what the slices' clock is behind";
    }
    throw std::runtime_error(message.str());
  }
  return matches;
}

//------------------------------------------------------------------------------
std::string DescribeEmptyKeys(const std::string& name, const std::vector<double>& keys)
{
  std::vector<std::size_t> zeros;
  double last = -std::numeric_limits<double>::infinity();
  std::size_t pending = 0; // zeros since last that may be in their place
  for (std::size_t row = 0; row < keys.size(); ++row)
  {
    if (keys[row] == 0)
    {
      zeros.push_back(row);
      pending += last <= 0 ? 1 : 0;
    }
    else if (std::isfinite(keys[row]))
    {
      if (keys[row] < last)
      {
        return {}; // in no order: nothing is known
      }
      if (keys[row] > 0 && last <= 0)
      {
        // the zeros between a negative key and a positive one, or before all
        zeros.erase(zeros.end() - static_cast<std::ptrdiff_t>(pending), zeros.end());
      }
      pending = 0;
      last = keys[row];
    }
  }
  if (last <= 0)
  {
    zeros.resize(zeros.size() - pending);
  }
  if (zeros.empty())
  {
    return {};
  }
  return name + " is 0 in " + DescribeItems("row", zeros) +
    " and grows from row to row otherwise: if the cell is empty, write nan there, since ParaView "
    "reads empty cells as 0";
}

//------------------------------------------------------------------------------
std::vector<Matrix4> GatherPoses(const PoseTable& table, const std::vector<PoseMatch>& matches)
{
  std::vector<Matrix4> poses(matches.size(), NoPose());
  for (std::size_t i = 0; i < matches.size(); ++i)
  {
    const PoseMatch& match = matches[i];
    if (match.First == PoseMatch::None || !table.Usable[match.First] || !table.Usable[match.Second])
    {
      continue;
    }
    poses[i] = match.First == match.Second ? table.ToReference[match.First]
                                           : InterpolatePose(table.ToReference[match.First],
                                               table.ToReference[match.Second], match.Weight);
  }
  return poses;
}
}
