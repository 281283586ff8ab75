// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Trees of boxes over scattered points and over regular grids: quadtrees in 2-D, octrees in 3-D.
///
/// All trees that take part in one sum divide the same root cube, so boxes of two trees at one level
/// are equal or disjoint, and whether they touch is a comparison of integers.
#ifndef lacunaRadialTree_h
#define lacunaRadialTree_h

#include "lacunaRadialSum.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lacuna
{
/// Points at (Origin + index x Spacing), the first index fastest. Size >= 1, Spacing > 0.
template <int Dimension>
struct RegularGrid
{
  std::array<double, Dimension> Origin{};
  std::array<double, Dimension> Spacing{};
  std::array<std::int64_t, Dimension> Size{};

  std::int64_t GetNumberOfPoints() const
  {
    std::int64_t count = 1;
    for (const std::int64_t size : this->Size)
    {
      count *= size;
    }
    return count;
  }
};

/// Part of a grid: first index and the one after the last, along each axis.
template <int Dimension>
using GridPart = std::array<std::array<std::int64_t, 2>, Dimension>;

/// All of it.
template <int Dimension>
GridPart<Dimension> WholeGrid(const RegularGrid<Dimension>& grid)
{
  GridPart<Dimension> part;
  for (int c = 0; c < Dimension; ++c)
  {
    part[c] = { 0, grid.Size[c] };
  }
  return part;
}

/// The cube that the trees divide.
template <int Dimension>
struct RootCube
{
  /// Boxes can be halved so many times: a box's index takes 20 bits, three of them a 64-bit key.
  static constexpr int MaximumLevel = 20;

  std::array<double, Dimension> Low{};
  double Size = 0;

  /// The smallest cube around points, a little enlarged. Points must not be empty.
  static RootCube Around(const std::vector<std::array<double, Dimension>>& points);
  /// Grows the cube so that it contains another one.
  void Add(const RootCube& other);
  /// Index of the box at MaximumLevel that x is in, along one axis.
  std::uint32_t GetIndex(double x, int axis) const;
};

/// A box of a tree; of boxes without children the points are known.
template <int Dimension>
struct TreeCell
{
  int Level = 0;                                ///< its size is RootCube::Size / 2^Level
  std::array<std::uint32_t, Dimension> Index{}; ///< of the box among those of its level
  int Parent = -1;
  int FirstChild = -1; ///< children follow one another; empty ones are left out
  int Children = 0;
  std::int64_t First = 0; ///< first point in the order of the tree (point trees)
  std::int64_t Count = 0; ///< points in the box
  std::array<std::array<std::int32_t, 2>, Dimension> Range{}; ///< indices begin, end (grid trees)
};

/// Boxes level by level, from the root; a parent comes before its children.
template <int Dimension>
struct CellTree
{
  RootCube<Dimension> Root;
  std::vector<TreeCell<Dimension>> Cells;
  std::vector<int> LevelBegin; ///< first cell of each level, and the end

  int GetNumberOfLevels() const { return static_cast<int>(this->LevelBegin.size()) - 1; }
  double GetCellSize(int level) const;
  std::array<double, Dimension> GetCenter(const TreeCell<Dimension>& cell) const;
};

/// A tree over scattered points, which it keeps sorted by boxes.
template <int Dimension>
struct PointTree : CellTree<Dimension>
{
  std::vector<std::size_t> Order; ///< original index of each point
  std::array<std::vector<double>, Dimension> Axis;

  /// Divides boxes of more than capacity points. Throws std::length_error above 2^31 points.
  PointTree(const RootCube<Dimension>& root,
    const std::vector<std::array<double, Dimension>>& points, int capacity);
  Coordinates<Dimension> GetCoordinates(std::int64_t first) const;
};

/// A tree over the points of a grid.
template <int Dimension>
struct GridTree : CellTree<Dimension>
{
  RegularGrid<Dimension> Grid;

  /// Divides boxes of more than capacity points. Throws when there is no memory for the boxes.
  GridTree(const RootCube<Dimension>& root, const RegularGrid<Dimension>& grid, int capacity);
};

/// Whether two boxes have a point in common, be it of their boundaries.
template <int Dimension>
bool AreAdjacent(const TreeCell<Dimension>& a, const TreeCell<Dimension>& b);
}
#endif
