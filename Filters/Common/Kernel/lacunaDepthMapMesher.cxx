// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDepthMapMesher.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace lacuna
{
namespace
{
/// The triangles that a square of pixels can hold; its corners are, from top left, row by row, 0 1
/// / 2 3. Wound so that their normal is towards the viewer: columns go right and rows down.
constexpr int Corners[4][3] = { { 0, 2, 3 }, { 0, 3, 1 }, { 0, 2, 1 }, { 1, 2, 3 } };
constexpr int RowGrain = 16;
constexpr double MaximumStepRatio = 3;

/// True when an edge steps so much farther along the rays than the next that they cannot be one
/// surface. The next may be undefined.
bool IsJump(const DepthEdge& edge, const DepthEdge& next)
{
  return next.IsDefined() &&
    std::abs(edge.Along) * next.Across > MaximumStepRatio * std::abs(next.Along) * edge.Across;
}
}

DepthMapMesher::DepthMapMesher(const DepthGrid& grid, const DiscontinuityRule& rule, int firstRow,
  int lastRow, Execution& execution)
  : Grid(grid)
  , Break(rule.Break)
  , Cases(rule.Limits)
  , FirstRow(firstRow)
{
  const auto& e = grid.Extent;
  if (firstRow < e[2] || lastRow > e[3] || e[1] < e[0])
  {
    throw std::invalid_argument("rows " + std::to_string(firstRow) + " to " +
      std::to_string(lastRow) + " are not within the depth map, which has rows " +
      std::to_string(e[2]) + " to " + std::to_string(e[3]));
  }
  const std::int64_t columns = static_cast<std::int64_t>(e[1]) - e[0] + 1;
  const std::int64_t rows = std::int64_t(lastRow) - firstRow + 1;
  const std::int64_t squareRows = rows > 0 ? rows - 1 : 0;
  this->PointOffsets.assign(rows > 0 ? rows + 1 : 1, 0);
  this->TriangleOffsets.assign(squareRows + 1, 0);
  this->Triangles.resize((columns - 1) * squareRows);
  execution.For(rows, RowGrain,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t r = begin; r < end; ++r)
      {
        const int row = static_cast<int>(firstRow + r);
        std::int64_t points = 0;
        for (int c = e[0]; c <= e[1]; ++c)
        {
          points += this->Grid.IsDefined(c, row);
        }
        this->PointOffsets[r + 1] = points;
        if (r == squareRows)
        {
          continue;
        }
        std::int64_t triangles = 0;
        unsigned char* flags = this->Triangles.data() + r * (columns - 1);
        for (int c = e[0]; c < e[1]; ++c, ++flags)
        {
          *flags = this->ChooseTriangles(c, row);
          for (int t = 0; t < 4; ++t)
          {
            triangles += *flags >> t & 1;
          }
        }
        this->TriangleOffsets[r + 1] = triangles;
      }
    });
  for (std::size_t i = 1; i < this->PointOffsets.size(); ++i)
  {
    this->PointOffsets[i] += this->PointOffsets[i - 1];
  }
  for (std::size_t i = 1; i < this->TriangleOffsets.size(); ++i)
  {
    this->TriangleOffsets[i] += this->TriangleOffsets[i - 1];
  }
}

bool DepthMapMesher::IsJoined(int column, int row, int right, int down) const
{
  const DepthGrid& grid = this->Grid;
  if (!grid.IsDefined(column, row) || !grid.IsDefined(column + right, row + down))
  {
    return false;
  }
  if (!this->Break)
  {
    return true;
  }
  const DepthEdge edge = grid.EdgeFrom(column, row, right, down);
  if (!this->Cases.IsSteep(edge))
  {
    return true; // in none of the cases is an edge torn that is not steep
  }
  const DepthEdge before = grid.EdgeFrom(column - right, row - down, right, down);
  const DepthEdge after = grid.EdgeFrom(column + right, row + down, right, down);
  return !IsTornForward(this->Cases.Classify(before, edge)) &&
    !IsTornBackward(this->Cases.Classify(edge, after)) && !IsJump(edge, before) &&
    !IsJump(edge, after);
}

unsigned char DepthMapMesher::ChooseTriangles(int column, int row) const
{
  const bool top = this->IsJoined(column, row, 1, 0);
  const bool bottom = this->IsJoined(column, row + 1, 1, 0);
  const bool left = this->IsJoined(column, row, 0, 1);
  const bool right = this->IsJoined(column + 1, row, 0, 1);
  if (top + bottom + left + right < 2)
  {
    return 0;
  }
  const bool falling = this->IsJoined(column, row, 1, 1);
  const bool rising = this->IsJoined(column, row + 1, 1, -1);
  const unsigned char alongFalling =
    (left && bottom && falling ? 1 : 0) | (top && right && falling ? 2 : 0);
  const unsigned char alongRising =
    (left && top && rising ? 4 : 0) | (right && bottom && rising ? 8 : 0);
  const int excess =
    (alongFalling & 1) + (alongFalling >> 1) - (alongRising >> 2 & 1) - (alongRising >> 3);
  if (excess != 0)
  {
    return excess > 0 ? alongFalling : alongRising;
  }
  const double* depth = this->Grid.Depth;
  const double fall =
    depth[this->Grid.PixelOf(column + 1, row + 1)] - depth[this->Grid.PixelOf(column, row)];
  const double rise =
    depth[this->Grid.PixelOf(column + 1, row)] - depth[this->Grid.PixelOf(column, row + 1)];
  return std::abs(rise) < std::abs(fall) ? alongRising : alongFalling;
}

void DepthMapMesher::FillPoints(double* points, long long* pixels, Execution& execution) const
{
  const auto& e = this->Grid.Extent;
  execution.For(static_cast<std::int64_t>(this->PointOffsets.size()) - 1, RowGrain,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t r = begin; r < end; ++r)
      {
        const int row = static_cast<int>(this->FirstRow + r);
        std::int64_t i = this->PointOffsets[r];
        for (int c = e[0]; c <= e[1]; ++c)
        {
          if (this->Grid.IsDefined(c, row))
          {
            const Vec3 p = this->Grid.PointOf(c, row);
            points[3 * i] = p[0];
            points[3 * i + 1] = p[1];
            points[3 * i + 2] = p[2];
            pixels[i] = this->Grid.PixelOf(c, row);
            ++i;
          }
        }
      }
    });
}

void DepthMapMesher::FillTriangles(long long* corners, Execution& execution) const
{
  const auto& e = this->Grid.Extent;
  execution.For(static_cast<std::int64_t>(this->TriangleOffsets.size()) - 1, RowGrain,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t r = begin; r < end; ++r)
      {
        const int row = static_cast<int>(this->FirstRow + r);
        std::int64_t upper = this->PointOffsets[r];
        std::int64_t lower = this->PointOffsets[r + 1];
        const unsigned char* flags = this->Triangles.data() + r * (e[1] - e[0]);
        long long* out = corners + 3 * this->TriangleOffsets[r];
        for (int c = e[0]; c < e[1]; ++c, ++flags)
        {
          const std::int64_t nextUpper = upper + this->Grid.IsDefined(c, row);
          const std::int64_t nextLower = lower + this->Grid.IsDefined(c, row + 1);
          const std::int64_t square[4] = { upper, nextUpper, lower, nextLower };
          for (int t = 0; t < 4; ++t)
          {
            for (int corner = 0; (*flags >> t & 1) && corner < 3; ++corner)
            {
              *out++ = square[Corners[t][corner]];
            }
          }
          upper = nextUpper;
          lower = nextLower;
        }
      }
    });
}
}
