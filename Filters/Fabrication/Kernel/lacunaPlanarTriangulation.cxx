// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPlanarTriangulation.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <unordered_set>
#include <utility>

namespace lacuna
{
namespace
{
using Index = std::int32_t;
__extension__ typedef __int128 Wide; // exact: products of four differences of 28 bits

constexpr int Bits = 24; // of a rounded coordinate

struct Node
{
  std::int64_t X;
  std::int64_t Y;
};

// Twice the signed area of a, b, c; positive when counterclockwise.
std::int64_t Orientation(const Node& a, const Node& b, const Node& c)
{
  return (b.X - a.X) * (c.Y - a.Y) - (b.Y - a.Y) * (c.X - a.X);
}

// Whether d is inside of the circle through a, b, c, which are counterclockwise.
bool IsInCircle(const Node& a, const Node& b, const Node& c, const Node& d)
{
  const std::int64_t ax = a.X - d.X;
  const std::int64_t ay = a.Y - d.Y;
  const std::int64_t bx = b.X - d.X;
  const std::int64_t by = b.Y - d.Y;
  const std::int64_t cx = c.X - d.X;
  const std::int64_t cy = c.Y - d.Y;
  return Wide(ax * ax + ay * ay) * (bx * cy - by * cx) -
    Wide(bx * bx + by * by) * (ax * cy - ay * cx) + Wide(cx * cx + cy * cy) * (ax * by - ay * bx) >
    0;
}

int Next(int i)
{
  return i == 2 ? 0 : i + 1;
}

int Previous(int i)
{
  return i == 0 ? 2 : i - 1;
}

// Position along a Hilbert curve of order Bits + 1, so that points that follow are neighbours.
std::uint64_t HilbertKey(const Node& node)
{
  std::uint64_t x = static_cast<std::uint64_t>(node.X + (std::int64_t{ 1 } << Bits));
  std::uint64_t y = static_cast<std::uint64_t>(node.Y + (std::int64_t{ 1 } << Bits));
  std::uint64_t key = 0;
  const std::uint64_t side = std::uint64_t{ 1 } << (Bits + 2);
  for (std::uint64_t s = side / 2; s > 0; s /= 2)
  {
    const std::uint64_t rx = (x & s) > 0;
    const std::uint64_t ry = (y & s) > 0;
    key += s * s * ((3 * rx) ^ ry);
    if (ry == 0)
    {
      if (rx == 1)
      {
        x = side - 1 - x;
        y = side - 1 - y;
      }
      std::swap(x, y);
    }
  }
  return key;
}

class Triangulation
{
public:
  explicit Triangulation(std::vector<Node> nodes)
    : Nodes(std::move(nodes))
    , Count(static_cast<Index>(this->Nodes.size()))
  {
    // a triangle far around all, taken away in the end
    const std::int64_t far = std::int64_t{ 1 } << (Bits + 2);
    this->Nodes.push_back({ -far, -far });
    this->Nodes.push_back({ far, -far });
    this->Nodes.push_back({ 0, far });
    this->Cells.push_back({ { this->Count, this->Count + 1, this->Count + 2 }, { -1, -1, -1 } });
    this->CellOf.assign(this->Nodes.size(), 0);

    std::vector<std::pair<std::uint64_t, Index>> order;
    order.reserve(static_cast<std::size_t>(this->Count));
    for (Index i = 0; i < this->Count; ++i)
    {
      order.emplace_back(HilbertKey(this->Nodes[i]), i);
    }
    std::sort(order.begin(), order.end());
    for (const auto& item : order)
    {
      this->Insert(item.second);
    }
  }

  // Makes the edge from a to b by flips.
  void Constrain(Index a, Index b)
  {
    std::deque<std::pair<Index, Index>> crossing = this->FindCrossing(a, b);
    std::size_t idle = 0;
    while (!crossing.empty())
    {
      const auto edge = crossing.front();
      crossing.pop_front();
      if (this->Constraints.count(Key(edge.first, edge.second)))
      {
        throw std::runtime_error("boundaries cross");
      }
      const auto [cell, i] = this->FindEdge(edge.first, edge.second);
      const Index other = this->Cells[cell].Neighbours[i];
      const int j = this->Facing(other, cell);
      const Index p = this->Cells[cell].Corners[i];
      const Index d = this->Cells[other].Corners[j];
      const std::int64_t first = this->Turn(p, d, edge.first);
      const std::int64_t second = this->Turn(p, d, edge.second);
      const bool convex = (first > 0 && second < 0) || (first < 0 && second > 0);
      if (!convex)
      {
        crossing.push_back(edge);
        if (++idle > crossing.size())
        {
          throw std::runtime_error("boundaries meet");
        }
        continue;
      }
      idle = 0;
      this->Flip(cell, i, other, j);
      if (this->Crosses(a, b, p, d))
      {
        crossing.emplace_back(p, d);
      }
    }
    this->Constraints.insert(Key(a, b));
  }

  std::vector<Triangle> GetInside() const
  {
    std::vector<signed char> parity(this->Cells.size(), -1);
    std::vector<Index> stack{ this->CellOf[this->Count] };
    parity[stack[0]] = 0;
    std::vector<Triangle> inside;
    while (!stack.empty())
    {
      const Index cell = stack.back();
      stack.pop_back();
      const Cell& c = this->Cells[cell];
      if (parity[cell] == 1)
      {
        inside.push_back(c.Corners);
      }
      for (int i = 0; i < 3; ++i)
      {
        const Index neighbour = c.Neighbours[i];
        if (neighbour >= 0 && parity[neighbour] < 0)
        {
          const bool wall =
            this->Constraints.count(Key(c.Corners[Next(i)], c.Corners[Previous(i)]));
          parity[neighbour] = static_cast<signed char>(wall ? 1 - parity[cell] : parity[cell]);
          stack.push_back(neighbour);
        }
      }
    }
    return inside;
  }

private:
  // Neighbours[i] is across the edge opposite to Corners[i].
  struct Cell
  {
    Triangle Corners;
    std::array<Index, 3> Neighbours;
  };

  static std::uint64_t Key(Index a, Index b)
  {
    return static_cast<std::uint64_t>(std::min(a, b)) << 32 |
      static_cast<std::uint64_t>(std::max(a, b));
  }

  std::int64_t Turn(Index a, Index b, Index c) const
  {
    return Orientation(this->Nodes[a], this->Nodes[b], this->Nodes[c]);
  }

  int Facing(Index cell, Index neighbour) const
  {
    const auto& n = this->Cells[cell].Neighbours;
    return n[0] == neighbour ? 0 : n[1] == neighbour ? 1 : 2;
  }

  int CornerOf(Index cell, Index node) const
  {
    const auto& c = this->Cells[cell].Corners;
    return c[0] == node ? 0 : c[1] == node ? 1 : 2;
  }

  void Set(Index cell, const Triangle& corners, const std::array<Index, 3>& neighbours)
  {
    this->Cells[cell] = { corners, neighbours };
    for (const Index corner : corners)
    {
      this->CellOf[corner] = cell;
    }
  }

  void Relink(Index cell, Index from, Index to)
  {
    if (cell >= 0)
    {
      this->Cells[cell].Neighbours[this->Facing(cell, from)] = to;
    }
  }

  Index AddCell()
  {
    this->Cells.push_back({});
    return static_cast<Index>(this->Cells.size()) - 1;
  }

  // Triangles p a b and d b a become p a d and p d b.
  void Flip(Index t, int i, Index o, int j)
  {
    const Cell first = this->Cells[t];
    const Cell second = this->Cells[o];
    const Index p = first.Corners[i];
    const Index a = first.Corners[Next(i)];
    const Index b = first.Corners[Previous(i)];
    const Index d = second.Corners[j];
    const Index ad = second.Neighbours[Next(j)];
    const Index db = second.Neighbours[Previous(j)];
    const Index bp = first.Neighbours[Next(i)];
    const Index pa = first.Neighbours[Previous(i)];
    this->Set(t, { p, a, d }, { ad, o, pa });
    this->Set(o, { p, d, b }, { db, bp, t });
    this->Relink(ad, o, t);
    this->Relink(bp, t, o);
  }

  void Insert(Index p)
  {
    int edge = -1;
    const Index cell = this->Locate(p, edge);
    if (edge < 0)
    {
      this->SplitCell(cell, p);
    }
    else
    {
      this->SplitEdge(cell, edge, p);
    }
    this->FlipAround(p);
    this->Last = this->CellOf[p];
  }

  // The triangle in which p is. edge: on which p is, -1 for none.
  Index Locate(Index p, int& edge) const
  {
    Index cell = this->Last;
    for (bool found = false; !found;)
    {
      found = true;
      edge = -1;
      const Cell& c = this->Cells[cell];
      for (int i = 0; i < 3; ++i)
      {
        const std::int64_t turn = this->Turn(c.Corners[Next(i)], c.Corners[Previous(i)], p);
        if (turn < 0)
        {
          cell = c.Neighbours[i];
          found = false;
          break;
        }
        if (turn == 0)
        {
          if (edge >= 0)
          {
            throw std::runtime_error("two points coincide");
          }
          edge = i;
        }
      }
    }
    return cell;
  }

  // Makes three triangles of one; Stack gets them.
  void SplitCell(Index cell, Index p)
  {
    const auto [v, n] = this->Cells[cell];
    const Index second = this->AddCell();
    const Index third = this->AddCell();
    this->Set(cell, { p, v[0], v[1] }, { n[2], second, third });
    this->Set(second, { p, v[1], v[2] }, { n[0], third, cell });
    this->Set(third, { p, v[2], v[0] }, { n[1], cell, second });
    this->Relink(n[0], cell, second);
    this->Relink(n[1], cell, third);
    this->Stack = { cell, second, third };
  }

  // Halves both triangles at an edge; Stack gets the four.
  void SplitEdge(Index cell, int edge, Index p)
  {
    const Cell old = this->Cells[cell];
    const Index other = old.Neighbours[edge];
    const Cell across = this->Cells[other];
    const int j = this->Facing(other, cell);
    const Index top = old.Corners[edge];
    const Index a = old.Corners[Next(edge)];
    const Index b = old.Corners[Previous(edge)];
    const Index d = across.Corners[j];
    const Index topA = old.Neighbours[Previous(edge)];
    const Index bTop = old.Neighbours[Next(edge)];
    const Index aD = across.Neighbours[Next(j)];
    const Index dB = across.Neighbours[Previous(j)];
    const Index third = this->AddCell();
    const Index fourth = this->AddCell();
    this->Set(cell, { p, top, a }, { topA, other, third });
    this->Set(other, { p, a, d }, { aD, fourth, cell });
    this->Set(third, { p, b, top }, { bTop, cell, fourth });
    this->Set(fourth, { p, d, b }, { dB, third, other });
    this->Relink(bTop, cell, third);
    this->Relink(dB, other, fourth);
    this->Stack = { cell, other, third, fourth };
  }

  // Flips edges opposite to p, beginning with the triangles of Stack, until all are Delaunay's.
  void FlipAround(Index p)
  {
    std::vector<Index>& stack = this->Stack;
    while (!stack.empty())
    {
      const Index t = stack.back();
      stack.pop_back();
      const int i = this->CornerOf(t, p);
      const Index o = this->Cells[t].Neighbours[i];
      if (o < 0)
      {
        continue;
      }
      const int j = this->Facing(o, t);
      const Triangle& c = this->Cells[t].Corners;
      if (IsInCircle(this->Nodes[c[0]], this->Nodes[c[1]], this->Nodes[c[2]],
            this->Nodes[this->Cells[o].Corners[j]]))
      {
        this->Flip(t, i, o, j);
        stack.push_back(t);
        stack.push_back(o);
      }
    }
  }

  // Whether the segments a b and c d cross between their ends.
  bool Crosses(Index a, Index b, Index c, Index d) const
  {
    if (a == c || a == d || b == c || b == d)
    {
      return false;
    }
    const std::int64_t left = this->Turn(a, b, c);
    const std::int64_t right = this->Turn(a, b, d);
    return (left > 0) != (right > 0) && (this->Turn(c, d, a) > 0) != (this->Turn(c, d, b) > 0);
  }

  // The triangle and corner opposite to the edge a b.
  std::pair<Index, int> FindEdge(Index a, Index b) const
  {
    Index cell = this->CellOf[a];
    const Index first = cell;
    do
    {
      const Cell& c = this->Cells[cell];
      const int i = this->CornerOf(cell, a);
      if (c.Corners[Next(i)] == b)
      {
        return { cell, Previous(i) };
      }
      cell = c.Neighbours[Next(i)];
    } while (cell != first);
    throw std::runtime_error("boundaries meet");
  }

  // The edges between a and b, empty when they are joined.
  std::deque<std::pair<Index, Index>> FindCrossing(Index a, Index b) const
  {
    Index cell = this->CellOf[a];
    const Index first = cell;
    int i = 0;
    for (;;)
    {
      const Cell& c = this->Cells[cell];
      i = this->CornerOf(cell, a);
      const Index right = c.Corners[Next(i)];
      const Index left = c.Corners[Previous(i)];
      if (right == b || left == b)
      {
        return {};
      }
      if (this->Turn(a, b, right) < 0 && this->Turn(a, b, left) > 0)
      {
        break;
      }
      cell = c.Neighbours[Next(i)];
      if (cell == first)
      {
        throw std::runtime_error("a point lies on a boundary");
      }
    }
    std::deque<std::pair<Index, Index>> crossing;
    for (;;)
    {
      const Cell& c = this->Cells[cell];
      const Index right = c.Corners[Next(i)];
      const Index left = c.Corners[Previous(i)];
      crossing.emplace_back(right, left);
      const Index other = c.Neighbours[i];
      const int j = this->Facing(other, cell);
      const Index apex = this->Cells[other].Corners[j];
      if (apex == b)
      {
        return crossing;
      }
      const std::int64_t turn = this->Turn(a, b, apex);
      if (turn == 0)
      {
        throw std::runtime_error("a point lies on a boundary");
      }
      // go on through the edge whose ends are on both sides of a b
      i = this->CornerOf(other, turn > 0 ? left : right);
      cell = other;
    }
  }

  std::vector<Node> Nodes;
  Index Count;
  std::vector<Cell> Cells;
  std::vector<Index> CellOf; // one triangle of each node
  std::vector<Index> Stack;
  std::unordered_set<std::uint64_t> Constraints;
  Index Last = 0;
};
}

//------------------------------------------------------------------------------
std::vector<Triangle> TriangulateRegion(
  std::vector<Vec2>& points, const std::vector<std::vector<std::int32_t>>& loops)
{
  if (points.size() > static_cast<std::size_t>(std::numeric_limits<Index>::max() / 4))
  {
    throw std::runtime_error("too many points to triangulate");
  }
  double low[2] = { std::numeric_limits<double>::infinity(),
    std::numeric_limits<double>::infinity() };
  double high[2] = { -low[0], -low[1] };
  for (const Vec2& point : points)
  {
    for (int i = 0; i < 2; ++i)
    {
      if (!std::isfinite(point[i]))
      {
        throw std::invalid_argument("a point to triangulate is not finite");
      }
      low[i] = std::min(low[i], point[i]);
      high[i] = std::max(high[i], point[i]);
    }
  }
  if (points.empty())
  {
    return {};
  }
  const double extent = std::max({ high[0] - low[0], high[1] - low[1], 1e-300 });
  const double scale = std::exp2(Bits - std::ceil(std::log2(extent)));
  const std::int64_t middle[2] = { std::llround(0.5 * (low[0] + high[0]) * scale),
    std::llround(0.5 * (low[1] + high[1]) * scale) };
  std::vector<Node> nodes;
  nodes.reserve(points.size());
  for (Vec2& point : points)
  {
    const std::int64_t x = std::llround(point[0] * scale);
    const std::int64_t y = std::llround(point[1] * scale);
    point = { static_cast<double>(x) / scale, static_cast<double>(y) / scale };
    nodes.push_back({ x - middle[0], y - middle[1] });
  }
  Triangulation triangulation(std::move(nodes));
  for (const auto& loop : loops)
  {
    for (std::size_t k = 0; k < loop.size(); ++k)
    {
      triangulation.Constrain(loop[k], loop[(k + 1) % loop.size()]);
    }
  }
  return triangulation.GetInside();
}
}
