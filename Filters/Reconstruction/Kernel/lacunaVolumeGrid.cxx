// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVolumeGrid.h"

#include "lacunaMemory.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace lacuna
{
namespace
{
constexpr double VoxelsFromData = 8388608; // 2^23: fine enough to look at, made in a moment
// A slice further off than this many times the usual distance is named as the likely culprit.
constexpr double WildDistance = 10;
constexpr std::array<char, 3> AxisNames{ 'x', 'y', 'z' };

struct Box
{
  Vec3 Minimum, Maximum;
  double GetLength(int axis) const { return this->Maximum[axis] - this->Minimum[axis]; }
};

Box GetBox(const std::vector<SliceImage>& slices)
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Box box{ { infinity, infinity, infinity }, { -infinity, -infinity, -infinity } };
  for (const SliceImage& slice : slices)
  {
    for (const Vec3& corner : GetCorners(slice))
    {
      for (int a = 0; a < 3; ++a)
      {
        box.Minimum[a] = std::min(box.Minimum[a], corner[a]);
        box.Maximum[a] = std::max(box.Maximum[a], corner[a]);
      }
    }
  }
  return box;
}

// Returns in what the bounds miss the box, nothing when they meet.
std::string CutToBounds(Box& box, const std::array<double, 6>& bounds)
{
  std::string miss;
  for (std::size_t a = 0; a < 3; ++a)
  {
    const double low = bounds[2 * a];
    const double high = bounds[2 * a + 1];
    if (low == 1 && high == -1)
    {
      continue;
    }
    std::ostringstream message;
    message << "OutputBounds along " << AxisNames[a] << " are " << low << " to " << high << " mm; ";
    if (!std::isfinite(low) || !std::isfinite(high) || low > high)
    {
      message << "give the minimum first, or 1 -1 for all that the slices cover";
      throw std::invalid_argument(message.str());
    }
    if (low > box.Maximum[a] || high < box.Minimum[a])
    {
      message << "the slices lie between " << box.Minimum[a] << " and " << box.Maximum[a] << " mm";
      miss = message.str();
    }
    box.Minimum[a] = low;
    box.Maximum[a] = high;
  }
  return miss;
}

double GetLargestPixelSpacing(const std::vector<SliceImage>& slices)
{
  double largest = 0;
  for (const SliceImage& slice : slices)
  {
    largest = std::max(
      { largest, Norm(slice.PixelToReference.Column(0)), Norm(slice.PixelToReference.Column(1)) });
  }
  return largest;
}

double RoundUpToTwoDigits(double x)
{
  const double unit = std::pow(10, std::floor(std::log10(x)) - 1);
  return std::ceil(x / unit - 1e-9) * unit;
}

double CountVoxels(const Box& box, const Vec3& spacing)
{
  double count = 1;
  for (int a = 0; a < 3; ++a)
  {
    count *= std::floor(box.GetLength(a) / spacing[a] + 0.5) + 1;
  }
  return count;
}

// The smallest spacing of two digits with which the box has at most so many voxels.
double FitSpacing(const Box& box, double smallest, double voxels)
{
  double spacing = smallest;
  // Each step at least as large as the error of counting one voxel more than the lengths give.
  while (CountVoxels(box, { spacing, spacing, spacing }) > voxels)
  {
    const double ratio = std::cbrt(CountVoxels(box, { spacing, spacing, spacing }) / voxels);
    spacing = RoundUpToTwoDigits(spacing * std::max(ratio, 1.001));
  }
  return spacing;
}

Vec3 GetCentre(const SliceImage& slice)
{
  return slice.PixelToReference.Point({ 0.5 * (slice.Width - 1), 0.5 * (slice.Height - 1), 0 });
}

double Median(std::vector<double> values)
{
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Says which slice stretches the box, when one lies far from all others.
std::string DescribeWildSlice(const std::vector<SliceImage>& slices)
{
  Vec3 middle{};
  for (int a = 0; a < 3; ++a)
  {
    std::vector<double> coordinates;
    coordinates.reserve(slices.size());
    for (const SliceImage& slice : slices)
    {
      coordinates.push_back(GetCentre(slice)[a]);
    }
    middle[a] = Median(coordinates);
  }
  std::vector<double> distances;
  distances.reserve(slices.size());
  for (const SliceImage& slice : slices)
  {
    distances.push_back(Norm(GetCentre(slice) - middle));
  }
  const auto farthest = std::max_element(distances.begin(), distances.end());
  if (!(*farthest > WildDistance * Median(distances)))
  {
    return {};
  }
  std::ostringstream text;
  text << " " << slices[farthest - distances.begin()].Label << " lies " << *farthest
       << " mm from the middle of the sweep, its pose is probably wrong: mark it invalid "
          "(SliceStatus 1), or set OutputBounds.";
  return text.str();
}
}

VolumeGrid MakeVolumeGrid(const std::vector<SliceImage>& slices, const VolumeGridRequest& request)
{
  if (slices.empty())
  {
    throw std::invalid_argument("there are no slices to make a volume of");
  }
  Box box = GetBox(slices);
  VolumeGrid grid;
  grid.Miss = CutToBounds(box, request.Bounds);
  double fromData = 0;
  for (int a = 0; a < 3; ++a)
  {
    const double wanted = request.Spacing[a];
    VolumeGridRequest::SpacingRange.Check("OutputSpacing", wanted);
    if (wanted == 0 && fromData == 0)
    {
      fromData = FitSpacing(box, GetLargestPixelSpacing(slices), VoxelsFromData);
    }
    grid.Spacing[a] = wanted > 0 ? wanted : fromData;
  }
  grid.Origin = box.Minimum;

  const double voxels = CountVoxels(box, grid.Spacing);
  const double bytes = voxels * static_cast<double>(request.BytesPerVoxel);
  const double limit = request.MemoryLimit > 0 ? request.MemoryLimit : 9e18; // of 64-bit sizes
  bool fits = bytes <= limit;
  std::ostringstream size;
  for (int a = 0; a < 3; ++a)
  {
    const double n = std::floor(box.GetLength(a) / grid.Spacing[a] + 0.5) + 1;
    size << (a > 0 ? " x " : "") << n;
    if (n < std::numeric_limits<int>::max())
    {
      grid.Dimensions[a] = static_cast<int>(n);
    }
    else
    {
      fits = false;
    }
  }
  if (!fits)
  {
    const double allowed = std::min(limit / static_cast<double>(request.BytesPerVoxel), 1e15);
    std::ostringstream message;
    message << "the volume would have " << size.str() << " voxels and take " << DescribeBytes(bytes)
            << "; MemoryLimit allows " << DescribeBytes(limit) << "." << DescribeWildSlice(slices)
            << " An OutputSpacing of "
            << FitSpacing(
                 box, *std::min_element(grid.Spacing.data(), grid.Spacing.data() + 3), allowed)
            << " mm would fit.";
    throw std::invalid_argument(message.str());
  }
  return grid;
}
}
