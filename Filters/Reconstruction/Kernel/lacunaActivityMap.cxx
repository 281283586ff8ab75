// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaActivityMap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace lacuna
{
namespace
{
constexpr std::size_t MostSlices = 32;
constexpr int NeighbourhoodRadius = 4;
// The border of the dense region is ragged by this much: changing pixels so near belong to it.
constexpr int BorderRadius = 2;

// The two lowest and the two highest grey levels of a pixel.
struct Extremes
{
  float Lowest = std::numeric_limits<float>::infinity();
  float SecondLowest = std::numeric_limits<float>::infinity();
  float Highest = -std::numeric_limits<float>::infinity();
  float SecondHighest = -std::numeric_limits<float>::infinity();

  void Put(float value)
  {
    if (value < this->SecondLowest)
    {
      this->SecondLowest = std::max(value, this->Lowest);
      this->Lowest = std::min(value, this->Lowest);
    }
    if (value > this->SecondHighest)
    {
      this->SecondHighest = std::min(value, this->Highest);
      this->Highest = std::max(value, this->Highest);
    }
  }
};

// Sums over rectangles of an image in constant time.
class SumTable
{
public:
  template <class Function>
  SumTable(int width, int height, const Function& value)
    : Width(width)
    , Height(height)
    , Sums((static_cast<std::size_t>(width) + 1) * (static_cast<std::size_t>(height) + 1), 0)
  {
    for (int row = 0; row < height; ++row)
    {
      std::int64_t line = 0;
      for (int column = 0; column < width; ++column)
      {
        line += value(column, row);
        this->At(column + 1, row + 1) = this->At(column + 1, row) + line;
      }
    }
  }

  // Mean over the square of the given radius, cut to the image.
  double GetMean(int column, int row, int radius)
  {
    const int left = std::max(0, column - radius);
    const int right = std::min(this->Width, column + radius + 1);
    const int top = std::max(0, row - radius);
    const int bottom = std::min(this->Height, row + radius + 1);
    const std::int64_t sum =
      this->At(right, bottom) - this->At(left, bottom) - this->At(right, top) + this->At(left, top);
    return static_cast<double>(sum) / (static_cast<double>(right - left) * (bottom - top));
  }

private:
  std::int64_t& At(int column, int row)
  {
    return this->Sums[static_cast<std::size_t>(row) * (static_cast<std::size_t>(this->Width) + 1) +
      static_cast<std::size_t>(column)];
  }
  int Width, Height;
  std::vector<std::int64_t> Sums;
};

// Gives all pixels of a part that is connected (by edges) and not labelled (0) yet a label. Returns
// how many they are. Pixels that belong to nothing have the label -1.
std::int64_t LabelPart(
  std::vector<int>& labels, int width, int height, int column, int row, int label)
{
  const auto index = [&](int x, int y)
  { return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + x; };
  std::vector<std::pair<int, int>> pending{ { column, row } };
  labels[index(column, row)] = label;
  std::int64_t size = 0;
  while (!pending.empty())
  {
    const auto [x, y] = pending.back();
    pending.pop_back();
    ++size;
    const std::pair<int, int> neighbours[] = { { x - 1, y }, { x + 1, y }, { x, y - 1 },
      { x, y + 1 } };
    for (const auto& [nx, ny] : neighbours)
    {
      if (nx >= 0 && nx < width && ny >= 0 && ny < height && labels[index(nx, ny)] == 0)
      {
        labels[index(nx, ny)] = label;
        pending.emplace_back(nx, ny);
      }
    }
  }
  return size;
}
template <class Function>
void ForEachSlice(const std::vector<SliceImage>& slices, const Function& f)
{
  for (const std::size_t i : ActivityMap::ChooseSlices(slices.size()))
  {
    f(slices[i]);
  }
}

template <class Function>
void ForEachLevel(const SliceImage& slice, const Function& f)
{
  DispatchScalars(slice.Type, slice.Pixels,
    [&](const auto* pixels)
    {
      for (int row = 0; row < slice.Height; ++row)
      {
        for (int column = 0; column < slice.Width; ++column)
        {
          f(static_cast<float>(pixels[slice.RowStride * row + column]));
        }
      }
    });
}

// The most frequent grey level, in 256 steps.
float GetBackground(const SliceImage& slice)
{
  constexpr std::size_t steps = 256;
  float low = std::numeric_limits<float>::infinity();
  float high = -low;
  ForEachLevel(slice,
    [&](float level)
    {
      low = std::isfinite(level) ? std::min(low, level) : low;
      high = std::isfinite(level) ? std::max(high, level) : high;
    });
  if (!(high > low))
  {
    return low;
  }
  const double step = (double(high) - double(low)) / (steps - 1);
  std::array<std::int64_t, steps> counts{};
  ForEachLevel(slice,
    [&](float level)
    {
      if (std::isfinite(level))
      {
        ++counts[static_cast<std::size_t>(std::lround((double(level) - double(low)) / step))];
      }
    });
  const auto most = std::max_element(counts.begin(), counts.end()) - counts.begin();
  return static_cast<float>(double(low) + step * static_cast<double>(most));
}
}

std::vector<std::size_t> ActivityMap::ChooseSlices(std::size_t count)
{
  std::vector<std::size_t> chosen(std::min(MostSlices, count));
  for (std::size_t n = 0; n < chosen.size(); ++n)
  {
    chosen[n] = chosen.size() > 1 ? n * (count - 1) / (chosen.size() - 1) : 0;
  }
  return chosen;
}

ActivityMap::ActivityMap(const std::vector<SliceImage>& slices)
  : ActivityMap(slices.front().Width, slices.front().Height)
{
  const std::size_t count = std::min(MostSlices, slices.size());
  std::vector<Extremes> extremes(
    static_cast<std::size_t>(this->Width) * static_cast<std::size_t>(this->Height));
  ForEachSlice(slices,
    [&](const SliceImage& slice)
    {
      auto extreme = extremes.begin();
      ForEachLevel(slice, [&](float level) { (extreme++)->Put(level); });
    });
  this->Changes.reserve(extremes.size());
  for (const Extremes& e : extremes)
  {
    const float change = count < 4 ? e.Highest - e.Lowest : e.SecondHighest - e.SecondLowest;
    this->Changes.push_back(change > 0 ? change : 0); // or not a number
    this->Largest = std::max<double>(this->Largest, this->Changes.back());
  }
}

ActivityMap ActivityMap::OfContrast(const std::vector<SliceImage>& slices)
{
  ActivityMap map(slices.front().Width, slices.front().Height);
  std::vector<Extremes> extremes(
    static_cast<std::size_t>(map.Width) * static_cast<std::size_t>(map.Height));
  ForEachSlice(slices,
    [&](const SliceImage& slice)
    {
      const float background = GetBackground(slice);
      auto extreme = extremes.begin();
      ForEachLevel(slice, [&](float level) { (extreme++)->Put(std::abs(level - background)); });
    });
  map.Changes.reserve(extremes.size());
  for (const Extremes& e : extremes)
  {
    const float contrast = slices.size() < 4 ? e.Highest : e.SecondHighest;
    map.Changes.push_back(std::isfinite(contrast) ? contrast : 0);
    map.Largest = std::max<double>(map.Largest, map.Changes.back());
  }
  return map;
}

PixelSet ActivityMap::GetLargestPart(double threshold, std::size_t rank) const
{
  const auto index = [&](int x, int y)
  { return static_cast<std::size_t>(y) * static_cast<std::size_t>(this->Width) + x; };
  const auto changes = [&](int x, int y) { return this->Changes[index(x, y)] > threshold ? 1 : 0; };
  SumTable changing(this->Width, this->Height, changes);
  std::vector<int> labels(this->Changes.size(), -1);
  for (int row = 0; row < this->Height; ++row)
  {
    for (int column = 0; column < this->Width; ++column)
    {
      if (changing.GetMean(column, row, NeighbourhoodRadius) > 0.5)
      {
        labels[index(column, row)] = 0;
      }
    }
  }
  std::vector<std::pair<std::int64_t, int>> parts; // minus size, label
  for (int row = 0; row < this->Height; ++row)
  {
    for (int column = 0; column < this->Width; ++column)
    {
      if (labels[index(column, row)] == 0)
      {
        const int label = static_cast<int>(parts.size()) + 1;
        parts.emplace_back(
          -LabelPart(labels, this->Width, this->Height, column, row, label), label);
      }
    }
  }
  std::sort(parts.begin(), parts.end());
  const int largest = rank < parts.size() ? parts[rank].second : 0;
  const auto isInside = [&](int x, int y) { return labels[index(x, y)] == largest ? 1 : 0; };
  SumTable inside(this->Width, this->Height, isInside);
  PixelSet part(this->Width, this->Height);
  for (int row = 0; row < this->Height; ++row)
  {
    for (int column = 0; column < this->Width; ++column)
    {
      const double density = inside.GetMean(column, row, BorderRadius);
      // a pixel on a straight border has 6 neighbours of 9, one beside it by chance 3
      if (density > 0.999 ||
        (density > 0 && changes(column, row) && changing.GetMean(column, row, 1) > 0.4))
      {
        part.Put(column, row);
      }
    }
  }
  return part;
}
}
