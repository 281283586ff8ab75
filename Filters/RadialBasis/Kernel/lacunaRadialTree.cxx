// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRadialTree.h"

#include "lacunaMemory.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

namespace lacuna
{
namespace
{
// Interleaves the bits of a box's index, the first axis lowest.
template <int Dimension>
std::uint64_t GetKey(const std::array<std::uint32_t, Dimension>& index)
{
  std::uint64_t key = 0;
  for (int bit = 0; bit < RootCube<Dimension>::MaximumLevel; ++bit)
  {
    for (int c = 0; c < Dimension; ++c)
    {
      key |= static_cast<std::uint64_t>((index[c] >> bit) & 1U) << (bit * Dimension + c);
    }
  }
  return key;
}

template <int Dimension>
TreeCell<Dimension> MakeChild(const TreeCell<Dimension>& parent, int parentId, int octant)
{
  TreeCell<Dimension> child;
  child.Level = parent.Level + 1;
  child.Parent = parentId;
  for (int c = 0; c < Dimension; ++c)
  {
    child.Index[c] = 2 * parent.Index[c] + ((static_cast<unsigned>(octant) >> c) & 1U);
  }
  return child;
}

// Level by level, divides the boxes of more than capacity points; divide(parent, child, octant)
// says what is in a child.
template <int Dimension, class Divide>
void DivideCells(CellTree<Dimension>& tree, std::int64_t capacity, const Divide& divide)
{
  tree.LevelBegin = { 0, 1 };
  for (int level = 0; level < RootCube<Dimension>::MaximumLevel; ++level)
  {
    for (int id = tree.LevelBegin[level]; id < tree.LevelBegin[level + 1]; ++id)
    {
      if (tree.Cells[id].Count <= capacity)
      {
        continue;
      }
      const TreeCell<Dimension> parent = tree.Cells[id];
      tree.Cells[id].FirstChild = static_cast<int>(tree.Cells.size());
      for (int octant = 0; octant < 1 << Dimension; ++octant)
      {
        TreeCell<Dimension> child = MakeChild(parent, id, octant);
        divide(parent, child, octant);
        if (child.Count > 0)
        {
          tree.Cells.push_back(child);
          ++tree.Cells[id].Children;
        }
      }
    }
    if (static_cast<int>(tree.Cells.size()) == tree.LevelBegin.back())
    {
      return;
    }
    tree.LevelBegin.push_back(static_cast<int>(tree.Cells.size()));
  }
}
}

//------------------------------------------------------------------------------
template <int Dimension>
RootCube<Dimension> RootCube<Dimension>::Around(
  const std::vector<std::array<double, Dimension>>& points)
{
  RootCube cube;
  cube.Low = points.front();
  std::array<double, Dimension> high = cube.Low;
  for (const std::array<double, Dimension>& p : points)
  {
    for (int c = 0; c < Dimension; ++c)
    {
      cube.Low[c] = std::min(cube.Low[c], p[c]);
      high[c] = std::max(high[c], p[c]);
    }
  }
  for (int c = 0; c < Dimension; ++c)
  {
    cube.Size = std::max(cube.Size, high[c] - cube.Low[c]);
  }
  // No point on the upper boundary; and a single point still has a cube.
  cube.Size = std::max(cube.Size * (1 + 1e-9), std::numeric_limits<double>::min());
  return cube;
}

template <int Dimension>
void RootCube<Dimension>::Add(const RootCube& other)
{
  std::array<double, Dimension> low;
  double size = 0;
  for (int c = 0; c < Dimension; ++c)
  {
    low[c] = std::min(this->Low[c], other.Low[c]);
    size = std::max(size, std::max(this->Low[c] + this->Size, other.Low[c] + other.Size) - low[c]);
  }
  this->Low = low;
  this->Size = size;
}

template <int Dimension>
std::uint32_t RootCube<Dimension>::GetIndex(double x, int axis) const
{
  constexpr double count = 1 << MaximumLevel;
  const double index = std::floor((x - this->Low[axis]) / this->Size * count);
  return static_cast<std::uint32_t>(std::min(std::max(index, 0.0), count - 1));
}

//------------------------------------------------------------------------------
template <int Dimension>
double CellTree<Dimension>::GetCellSize(int level) const
{
  return std::ldexp(this->Root.Size, -level);
}

template <int Dimension>
std::array<double, Dimension> CellTree<Dimension>::GetCenter(const TreeCell<Dimension>& cell) const
{
  std::array<double, Dimension> center;
  for (int c = 0; c < Dimension; ++c)
  {
    center[c] = this->Root.Low[c] + (cell.Index[c] + 0.5) * this->GetCellSize(cell.Level);
  }
  return center;
}

//------------------------------------------------------------------------------
template <int Dimension>
PointTree<Dimension>::PointTree(const RootCube<Dimension>& root,
  const std::vector<std::array<double, Dimension>>& points, int capacity)
{
  if (points.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
  {
    throw std::length_error("more than 2^31 points");
  }
  this->Root = root;
  std::vector<std::pair<std::uint64_t, std::size_t>> sorted(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    std::array<std::uint32_t, Dimension> index;
    for (int c = 0; c < Dimension; ++c)
    {
      index[c] = root.GetIndex(points[i][c], c);
    }
    sorted[i] = { GetKey<Dimension>(index), i };
  }
  std::sort(sorted.begin(), sorted.end());
  this->Order.resize(points.size());
  for (int c = 0; c < Dimension; ++c)
  {
    this->Axis[c].resize(points.size());
  }
  for (std::size_t k = 0; k < points.size(); ++k)
  {
    this->Order[k] = sorted[k].second;
    for (int c = 0; c < Dimension; ++c)
    {
      this->Axis[c][k] = points[sorted[k].second][c];
    }
  }

  this->Cells.emplace_back();
  this->Cells[0].Count = static_cast<std::int64_t>(points.size());
  DivideCells<Dimension>(*this, capacity,
    [&](const TreeCell<Dimension>& parent, TreeCell<Dimension>& child, int octant)
    {
      // The points of the parent are sorted by octant: that digit of the key.
      const int shift = Dimension * (RootCube<Dimension>::MaximumLevel - child.Level);
      const auto begin = sorted.begin() + parent.First;
      const auto find = [&](int o)
      {
        return std::partition_point(begin, begin + parent.Count,
          [&](const std::pair<std::uint64_t, std::size_t>& s)
          { return static_cast<int>((s.first >> shift) & ((1 << Dimension) - 1)) < o; });
      };
      const auto first = find(octant);
      child.First = first - sorted.begin();
      child.Count = find(octant + 1) - first;
    });
}

template <int Dimension>
Coordinates<Dimension> PointTree<Dimension>::GetCoordinates(std::int64_t first) const
{
  Coordinates<Dimension> coordinates;
  for (int c = 0; c < Dimension; ++c)
  {
    coordinates.Axis[c] = this->Axis[c].data() + first;
  }
  return coordinates;
}

//------------------------------------------------------------------------------
namespace
{
// Boxes, or along an axis intervals, that are alike: how many there are, points of each, and into how
// many with points each is divided.
struct AlikeBoxes
{
  double Number;
  double Points;
  double Children;
};

// The intervals of a level along an axis; index: of its points, in order.
std::vector<AlikeBoxes> GetIntervals(const std::vector<std::uint32_t>& index, int shift)
{
  std::map<std::pair<std::ptrdiff_t, int>, double> number;
  for (auto begin = index.begin(); begin != index.end();)
  {
    const std::uint32_t interval = *begin >> shift;
    const auto end = std::partition_point(
      begin, index.end(), [&](std::uint32_t i) { return (i >> shift) == interval; });
    const bool both = ((*begin ^ *(end - 1)) >> (shift - 1)) != 0;
    ++number[{ end - begin, both ? 2 : 1 }];
    begin = end;
  }
  std::vector<AlikeBoxes> intervals;
  for (const auto& [kind, times] : number)
  {
    intervals.push_back({ times, static_cast<double>(kind.first), 1.0 * kind.second });
  }
  return intervals;
}

// How many boxes DivideCells makes of a grid, level by level until there are more than `most`. Points
// are in rows, so that of few kinds of intervals along each axis follows how many boxes have how many.
template <int Dimension>
double CountBoxes(
  const std::array<std::vector<std::uint32_t>, Dimension>& index, int capacity, double most)
{
  double all = 1;
  for (int shift = RootCube<Dimension>::MaximumLevel; shift > 0 && all <= most; --shift)
  {
    std::vector<AlikeBoxes> boxes{ { 1, 1, 1 } };
    for (const std::vector<std::uint32_t>& axis : index)
    {
      std::vector<AlikeBoxes> rows;
      for (const AlikeBoxes& interval : GetIntervals(axis, shift))
      {
        for (const AlikeBoxes& box : boxes)
        {
          rows.push_back({ box.Number * interval.Number, box.Points * interval.Points,
            box.Children * interval.Children });
        }
      }
      boxes = std::move(rows);
    }
    double next = 0;
    for (const AlikeBoxes& box : boxes)
    {
      next += box.Points > capacity ? box.Number * box.Children : 0;
    }
    if (next == 0)
    {
      break;
    }
    all += next;
  }
  return all;
}

// Throws when a grid is divided into more boxes than there is memory, or numbers, for; gives how many.
template <int Dimension>
std::size_t RequireBoxes(const RegularGrid<Dimension>& grid,
  const std::array<std::vector<std::uint32_t>, Dimension>& index, int capacity)
{
  constexpr double most = std::numeric_limits<std::int32_t>::max();
  const double boxes = CountBoxes<Dimension>(index, capacity, most);
  // others have some numbers for each box, too
  const double bytes = boxes * (sizeof(TreeCell<Dimension>) + 72.0);
  const std::string what = "the boxes of a grid of " + std::to_string(grid.GetNumberOfPoints()) +
    " points, of which all parts need all,";
  if (boxes > most)
  {
    throw std::length_error(
      what + " would need more than " + DescribeBytes(bytes) + "; take a coarser grid");
  }
  RequireMemory(what, bytes);
  return static_cast<std::size_t>(boxes);
}
}

template <int Dimension>
GridTree<Dimension>::GridTree(
  const RootCube<Dimension>& root, const RegularGrid<Dimension>& grid, int capacity)
  : Grid(grid)
{
  this->Root = root;
  std::array<std::vector<std::uint32_t>, Dimension> index;
  for (int c = 0; c < Dimension; ++c)
  {
    index[c].resize(static_cast<std::size_t>(grid.Size[c]));
    for (std::int64_t i = 0; i < grid.Size[c]; ++i)
    {
      index[c][i] = root.GetIndex(grid.Origin[c] + static_cast<double>(i) * grid.Spacing[c], c);
    }
  }
  this->Cells.reserve(RequireBoxes<Dimension>(grid, index, capacity));
  this->Cells.emplace_back();
  this->Cells[0].Count = grid.GetNumberOfPoints();
  for (int c = 0; c < Dimension; ++c)
  {
    this->Cells[0].Range[c] = { 0, static_cast<std::int32_t>(grid.Size[c]) };
  }
  DivideCells<Dimension>(*this, capacity,
    [&](const TreeCell<Dimension>& parent, TreeCell<Dimension>& child, int octant)
    {
      child.Count = 1;
      for (int c = 0; c < Dimension; ++c)
      {
        const int shift = RootCube<Dimension>::MaximumLevel - child.Level;
        const auto begin = index[c].begin();
        const auto middle = std::partition_point(begin + parent.Range[c][0],
          begin + parent.Range[c][1], [&](std::uint32_t i) { return ((i >> shift) & 1U) == 0; });
        const auto split = static_cast<std::int32_t>(middle - begin);
        child.Range[c] = ((static_cast<unsigned>(octant) >> c) & 1U) != 0
          ? std::array<std::int32_t, 2>{ split, parent.Range[c][1] }
          : std::array<std::int32_t, 2>{ parent.Range[c][0], split };
        child.Count *= child.Range[c][1] - child.Range[c][0];
      }
    });
}

//------------------------------------------------------------------------------
template <int Dimension>
bool AreAdjacent(const TreeCell<Dimension>& a, const TreeCell<Dimension>& b)
{
  // in units of the boxes of the finer one
  const TreeCell<Dimension>& coarse = a.Level < b.Level ? a : b;
  const TreeCell<Dimension>& fine = a.Level < b.Level ? b : a;
  const int shift = fine.Level - coarse.Level;
  for (int c = 0; c < Dimension; ++c)
  {
    const std::int64_t low = static_cast<std::int64_t>(coarse.Index[c]) << shift;
    const std::int64_t high = low + (std::int64_t(1) << shift);
    const std::int64_t i = fine.Index[c];
    if (i + 1 < low || i > high)
    {
      return false;
    }
  }
  return true;
}

template struct RootCube<2>;
template struct RootCube<3>;
template struct CellTree<2>;
template struct CellTree<3>;
template struct PointTree<2>;
template struct PointTree<3>;
template struct GridTree<2>;
template struct GridTree<3>;
template bool AreAdjacent<2>(const TreeCell<2>&, const TreeCell<2>&);
template bool AreAdjacent<3>(const TreeCell<3>&, const TreeCell<3>&);
}
