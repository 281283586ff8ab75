// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaHoleSupport.h"

#include "lacunaDistanceTransform.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <queue>
#include <tuple>
#include <utility>

namespace lacuna
{
namespace
{
constexpr std::int64_t None = -1;

// Visits the edge neighbours of pixel in the order left, right, above, below, with their distance.
template <class Visitor>
void ForNeighbours(const MapGrid& grid, std::size_t pixel, const Visitor& visit)
{
  const std::size_t width = grid.Width;
  const std::size_t i = pixel % width;
  const std::size_t j = pixel / width;
  if (i > 0)
  {
    visit(pixel - 1, grid.Spacing[0]);
  }
  if (i + 1 < width)
  {
    visit(pixel + 1, grid.Spacing[0]);
  }
  if (j > 0)
  {
    visit(pixel - width, grid.Spacing[1]);
  }
  if (j + 1 < static_cast<std::size_t>(grid.Height))
  {
    visit(pixel + width, grid.Spacing[1]);
  }
}

// Number of each pixel's piece of mask, None outside; pieces are numbered by their first pixel and
// connected over edges for which connects(pixel, neighbour, distance) holds. Returns their sizes.
template <class Predicate>
std::vector<std::size_t> Label(const MapGrid& grid, const MapMask& mask, const Predicate& connects,
  std::vector<std::int64_t>& labels)
{
  labels.assign(mask.size(), None);
  std::vector<std::size_t> sizes;
  std::vector<std::size_t> open;
  for (std::size_t start = 0; start < mask.size(); ++start)
  {
    if (!mask[start] || labels[start] != None)
    {
      continue;
    }
    const auto label = static_cast<std::int64_t>(sizes.size());
    sizes.push_back(0);
    labels[start] = label;
    open.push_back(start);
    while (!open.empty())
    {
      const std::size_t pixel = open.back();
      open.pop_back();
      ++sizes.back();
      ForNeighbours(grid, pixel,
        [&](std::size_t neighbour, double distance)
        {
          if (mask[neighbour] && labels[neighbour] == None && connects(pixel, neighbour, distance))
          {
            labels[neighbour] = label;
            open.push_back(neighbour);
          }
        });
    }
  }
  return sizes;
}

// Pieces that are connected over edges without a depth step.
std::vector<std::size_t> LabelSmooth(const MapGrid& grid, const std::vector<double>& depth,
  double maximumSlope, const MapMask& mask, std::vector<std::int64_t>& labels)
{
  const auto isSmooth = [&](std::size_t a, std::size_t b, double distance)
  { return std::abs(depth[a] - depth[b]) <= maximumSlope * distance; };
  return Label(grid, mask, isSmooth, labels);
}

// Of each pixel the one of mask from which it is reached on the shortest way over edges and corners:
// almost always the nearest one. None if mask is empty.
std::vector<std::int64_t> FindNearest(const MapGrid& grid, const MapMask& mask)
{
  std::vector<std::int64_t> nearest(mask.size(), None);
  using Entry = std::tuple<double, std::size_t, std::size_t>; // squared distance, pixel, of mask
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto width = static_cast<std::int64_t>(grid.Width);
  const auto visit = [&](std::int64_t i, std::int64_t j, std::size_t of)
  {
    if (i >= 0 && j >= 0 && i < width && j < grid.Height && nearest[j * width + i] == None)
    {
      const double x =
        grid.Spacing[0] * static_cast<double>(i - static_cast<std::int64_t>(of) % width);
      const double y =
        grid.Spacing[1] * static_cast<double>(j - static_cast<std::int64_t>(of) / width);
      open.emplace(x * x + y * y, j * width + i, of);
    }
  };
  for (std::size_t pixel = 0; pixel < mask.size(); ++pixel)
  {
    if (mask[pixel])
    {
      open.emplace(0, pixel, pixel);
    }
  }
  while (!open.empty())
  {
    const std::size_t pixel = std::get<1>(open.top());
    const std::size_t of = std::get<2>(open.top());
    open.pop();
    if (nearest[pixel] != None)
    {
      continue;
    }
    nearest[pixel] = static_cast<std::int64_t>(of);
    const auto i = static_cast<std::int64_t>(pixel) % width;
    const auto j = static_cast<std::int64_t>(pixel) / width;
    for (std::int64_t k = 0; k < 9; ++k)
    {
      visit(i + k % 3 - 1, j + k / 3 - 1, of);
    }
  }
  return nearest;
}

using PiecePairs = std::map<std::pair<std::int64_t, std::int64_t>, double>;

// Pairs of different pieces that touch, so that a step divides them, with the largest step, mm.
PiecePairs FindSteps(
  const MapGrid& grid, const std::vector<double>& depth, const std::vector<std::int64_t>& labels)
{
  PiecePairs steps;
  for (std::size_t pixel = 0; pixel < labels.size(); ++pixel)
  {
    ForNeighbours(grid, pixel,
      [&](std::size_t neighbour, double)
      {
        if (labels[pixel] != None && labels[neighbour] != None &&
          labels[pixel] != labels[neighbour])
        {
          double& step = steps[{ labels[pixel], labels[neighbour] }];
          step = std::max(step, std::abs(depth[pixel] - depth[neighbour]));
        }
      });
  }
  return steps;
}

// Pairs of pieces of mask that face each other over pixels that are not in it, with the step, mm,
// where they are nearest to each other, if it is one there.
PiecePairs FindStepsOverGaps(const MapGrid& grid, const std::vector<double>& depth,
  double maximumSlope, const std::vector<std::int64_t>& labels, const MapMask& mask)
{
  struct Gap
  {
    double Distance = std::numeric_limits<double>::infinity();
    double Step = 0;
  };
  std::map<std::pair<std::int64_t, std::int64_t>, Gap> gaps;
  const std::vector<std::int64_t> nearest = FindNearest(grid, mask);
  for (std::size_t pixel = 0; pixel < mask.size(); ++pixel)
  {
    ForNeighbours(grid, pixel,
      [&](std::size_t neighbour, double)
      {
        const std::int64_t a = nearest[pixel];
        const std::int64_t b = nearest[neighbour];
        if (a == None || b == None || labels[a] == labels[b])
        {
          return;
        }
        const double distance =
          std::hypot(grid.Spacing[0] * static_cast<double>(grid.GetColumn(a) - grid.GetColumn(b)),
            grid.Spacing[1] * static_cast<double>(grid.GetRow(a) - grid.GetRow(b)));
        const double step = std::abs(depth[a] - depth[b]);
        Gap& gap = gaps[{ labels[a], labels[b] }];
        // of equally near ones the smaller step: one way without a step is enough
        const double tie = 1e-9 * distance;
        if (distance < gap.Distance - tie || (distance <= gap.Distance + tie && step < gap.Step))
        {
          gap = { distance, step };
        }
      });
  }
  PiecePairs steps;
  for (const auto& [pieces, gap] : gaps)
  {
    if (gap.Step > maximumSlope * gap.Distance)
    {
      steps[pieces] = gap.Step;
    }
  }
  return steps;
}

// Number of the lattice point to whose square x = index * pixel belongs.
std::int64_t GetLatticePoint(std::int64_t index, double pixel, double spacing)
{
  // The small number keeps rounding from moving a pixel that lies between two squares.
  return spacing <= pixel ? index
                          : static_cast<std::int64_t>(std::floor(
                              static_cast<double>(index) * pixel / spacing + (0.5 + 1e-9)));
}
}

//------------------------------------------------------------------------------
MapMask FindInteriorHoles(const MapGrid& grid, const MapMask& mask)
{
  MapMask holes(mask.size());
  std::transform(
    mask.begin(), mask.end(), holes.begin(), [](unsigned char m) { return m ? 0 : 1; });
  std::vector<std::int64_t> labels;
  const std::vector<std::size_t> sizes = Label(
    grid, holes, [](std::size_t, std::size_t, double) { return true; }, labels);
  MapMask open(sizes.size(), 0); // reaches the border
  for (std::size_t pixel = 0; pixel < mask.size(); ++pixel)
  {
    int neighbours = 0;
    ForNeighbours(grid, pixel, [&](std::size_t, double) { ++neighbours; });
    if (neighbours < 4 && labels[pixel] != None)
    {
      open[labels[pixel]] = 1;
    }
  }
  for (std::size_t pixel = 0; pixel < mask.size(); ++pixel)
  {
    holes[pixel] = labels[pixel] != None && !open[labels[pixel]];
  }
  return holes;
}

//------------------------------------------------------------------------------
MapMask FindEnclosed(const MapGrid& grid, const std::vector<Vec2>& polygon)
{
  MapMask mask(grid.GetSize(), 0);
  std::vector<std::pair<double, int>> crossings; // of a row: where, and whether down or up
  for (int j = 0; j < grid.Height; ++j)
  {
    const double y = (static_cast<double>(grid.FirstRow) + j) * grid.Spacing[1];
    crossings.clear();
    for (std::size_t k = 0; k < polygon.size(); ++k)
    {
      const Vec2& a = polygon[k];
      const Vec2& b = polygon[k + 1 < polygon.size() ? k + 1 : 0];
      if ((a[1] <= y) != (b[1] <= y))
      {
        crossings.emplace_back(
          a[0] + (y - a[1]) * ((b[0] - a[0]) / (b[1] - a[1])), b[1] > a[1] ? 1 : -1);
      }
    }
    std::sort(crossings.begin(), crossings.end());
    int winding = 0;
    auto next = crossings.begin();
    for (int i = 0; i < grid.Width; ++i)
    {
      const double x = (static_cast<double>(grid.FirstColumn) + i) * grid.Spacing[0];
      for (; next != crossings.end() && next->first <= x; ++next)
      {
        winding += next->second;
      }
      mask[static_cast<std::size_t>(j) * grid.Width + i] = winding != 0;
    }
  }
  return mask;
}

//------------------------------------------------------------------------------
MapMask SelectWithin(Execution& execution, const MapGrid& grid, const MapMask& region,
  double margin, const MapMask& candidates)
{
  const std::vector<double> squared =
    SquaredDistanceTransform(execution, grid.Width, grid.Height, grid.Spacing, region);
  const double limit = margin * margin * (1 + 1e-12);
  MapMask selected(candidates.size());
  for (std::size_t pixel = 0; pixel < selected.size(); ++pixel)
  {
    selected[pixel] = candidates[pixel] && squared[pixel] <= limit;
  }
  return selected;
}

//------------------------------------------------------------------------------
MapMask FindHoles(Execution& execution, const MapGrid& grid, const std::vector<double>& depth,
  double maximumSlope, double rim, const MapMask& valid)
{
  std::vector<std::int64_t> labels;
  const std::vector<std::size_t> sizes = LabelSmooth(grid, depth, maximumSlope, valid, labels);
  const std::int64_t largest = std::max_element(sizes.begin(), sizes.end()) - sizes.begin();
  MapMask surface(valid.size());
  for (std::size_t pixel = 0; pixel < surface.size(); ++pixel)
  {
    surface[pixel] = labels[pixel] == largest;
  }
  const MapMask holes = FindInteriorHoles(grid, surface);
  return SelectWithin(execution, grid, holes, rim, MapMask(valid.size(), 1));
}

//------------------------------------------------------------------------------
StepReport RemoveBeyondSteps(
  const MapGrid& grid, const std::vector<double>& depth, const StepSlopes& slopes, MapMask& support)
{
  std::vector<std::int64_t> labels;
  const std::vector<std::size_t> sizes = LabelSmooth(grid, depth, slopes.Touching, support, labels);

  std::vector<std::int64_t> order(sizes.size());
  for (std::size_t i = 0; i < order.size(); ++i)
  {
    order[i] = static_cast<std::int64_t>(i);
  }
  std::stable_sort(order.begin(), order.end(),
    [&](std::int64_t a, std::int64_t b) { return sizes[a] > sizes[b]; });
  StepReport report;
  std::vector<char> removed(sizes.size(), 0);
  std::vector<char> kept(sizes.size(), 0);
  // Of those that are not removed yet; returns whether one was.
  const auto remove = [&](const PiecePairs& steps)
  {
    bool any = false;
    std::fill(kept.begin(), kept.end(), 0);
    for (const std::int64_t piece : order)
    {
      if (removed[piece])
      {
        continue;
      }
      for (auto it = steps.lower_bound({ piece, 0 }); it != steps.end() && it->first.first == piece;
           ++it)
      {
        if (kept[it->first.second])
        {
          removed[piece] = 1;
          report.LargestStep = std::max(report.LargestStep, it->second);
        }
      }
      kept[piece] = !removed[piece];
      report.RemovedPixels += removed[piece] ? sizes[piece] : 0;
      any = any || removed[piece];
    }
    return any;
  };
  remove(FindSteps(grid, depth, labels));
  bool changed = std::count(kept.begin(), kept.end(), 1) > 1;
  while (changed) // what lay between is gone, and others face each other
  {
    for (std::size_t pixel = 0; pixel < support.size(); ++pixel)
    {
      support[pixel] = labels[pixel] != None && kept[labels[pixel]];
    }
    changed = remove(FindStepsOverGaps(grid, depth, slopes.OverGap, labels, support));
  }
  bool first = true;
  for (std::size_t pixel = 0; pixel < support.size(); ++pixel)
  {
    support[pixel] = labels[pixel] != None && kept[labels[pixel]];
    if (first && labels[pixel] != None && !support[pixel])
    {
      report.FirstPixel = pixel;
      first = false;
    }
  }
  return report;
}

//------------------------------------------------------------------------------
std::vector<std::size_t> ThinNodes(const MapGrid& grid, const MapMask& support, double nodeSpacing)
{
  struct Best
  {
    std::size_t Pixel;
    double Distance; // squared, from the lattice point
  };
  std::map<std::pair<std::int64_t, std::int64_t>, Best> squares;
  const double tie = 1e-9 * nodeSpacing * nodeSpacing;
  for (std::size_t pixel = 0; pixel < support.size(); ++pixel)
  {
    if (!support[pixel])
    {
      continue;
    }
    const std::int64_t index[2] = { grid.GetColumn(pixel), grid.GetRow(pixel) };
    std::int64_t lattice[2];
    double distance = 0;
    for (int c = 0; c < 2; ++c)
    {
      lattice[c] = GetLatticePoint(index[c], grid.Spacing[c], nodeSpacing);
      const double d = static_cast<double>(index[c]) * grid.Spacing[c] -
        static_cast<double>(lattice[c]) * nodeSpacing;
      distance += d * d;
    }
    const auto [entry, isNew] = squares.insert({ { lattice[1], lattice[0] }, { pixel, distance } });
    if (!isNew && distance < entry->second.Distance - tie)
    {
      entry->second = { pixel, distance };
    }
  }
  std::vector<std::size_t> nodes;
  nodes.reserve(squares.size());
  for (const auto& square : squares)
  {
    nodes.push_back(square.second.Pixel);
  }
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}
}
