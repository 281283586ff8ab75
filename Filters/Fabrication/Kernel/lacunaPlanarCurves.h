// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Closed curves in a plane: contours of sampled functions, insides, nearest points.
#ifndef lacunaPlanarCurves_h
#define lacunaPlanarCurves_h

#include "lacunaVector.h"

#include <cstdint>
#include <vector>

namespace lacuna
{
/// A closed polygon; the last point is joined to the first.
using Loop = std::vector<Vec2>;

/// Positive when the loop is counterclockwise (x to y).
double SignedArea(const Loop& loop);

/// Nodes Origin + Spacing * (i, j), i fastest.
struct PlanarGrid
{
  Vec2 Origin{};
  Vec2 Spacing{};
  std::int64_t Columns = 0;
  std::int64_t Rows = 0;

  Vec2 GetNode(std::int64_t i, std::int64_t j) const
  {
    return { this->Origin[0] + this->Spacing[0] * static_cast<double>(i),
      this->Origin[1] + this->Spacing[1] * static_cast<double>(j) };
  }
};

/// Where the values, linear along grid lines, are level: closed loops with the greater values on
/// their left. Values on the border of the grid must be below level.
std::vector<Loop> FindContours(
  const PlanarGrid& grid, const std::vector<double>& values, double level);

/// The x where the horizontal line at y crosses the loops, ascending: inside are the first to the
/// second, the third to the fourth, ...
std::vector<double> FindCrossings(const std::vector<Loop>& loops, double y);
/// Whether x is inside, of the crossings of one line.
bool IsInside(const std::vector<double>& crossings, double x);
/// Whether a point is inside of the loops. For many points of one line FindCrossings once is quicker.
bool IsInside(const std::vector<Loop>& loops, const Vec2& p);

/// The nearest points of closed polygons in space, sorted by their x and y.
class CurveIndex
{
public:
  struct Nearest
  {
    double Distance; ///< in space
    Vec3 Point;
  };

  /// cell: about the length of a few edges.
  CurveIndex(const std::vector<std::vector<Vec3>>& curves, double cell);
  /// The nearest point within limit; without one, Distance is limit and Point is p.
  Nearest Find(const Vec3& p, double limit) const;

private:
  struct Edge
  {
    Vec3 A;
    Vec3 B;
  };
  std::vector<Edge> Edges;
  std::vector<std::int64_t> First; // of each cell in Items
  std::vector<std::int32_t> Items;
  Vec2 Low{};
  Vec2 High{};
  double Cell;
  std::int64_t Columns = 1;
  std::int64_t Rows = 1;
};
}
#endif
