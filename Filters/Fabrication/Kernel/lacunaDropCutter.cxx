// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDropCutter.h"

#include "lacunaParameterText.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace lacuna
{
namespace
{
constexpr std::int64_t LargestSide = 1 << 30;

[[noreturn]] void ThrowAt(
  std::int64_t i, std::int64_t j, const std::string& what, const Vec3* place = nullptr)
{
  std::string message =
    what + " at column " + std::to_string(i) + ", row " + std::to_string(j) + " of the surface";
  if (place)
  {
    message += " (x " + FormatNumber((*place)[0]) + ", y " + FormatNumber((*place)[1]) + ")";
  }
  throw std::invalid_argument(message);
}

// Twice the signed area of a triangle as the mill sees it.
double Area(const Vec3& a, const Vec3& b, const Vec3& c)
{
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

double Angle(const Vec3& a, const Vec3& b, const Vec3& c)
{
  return std::atan2(Norm(Cross(b - a, c - a)), Dot(b - a, c - a));
}
}

//------------------------------------------------------------------------------
MillSurface::MillSurface(GridSize size, std::vector<Vec3> points)
  : Size(size)
  , Points(std::move(points))
{
  if (size.Columns < 2 || size.Rows < 2 || size.Columns > LargestSide || size.Rows > LargestSide ||
    this->Points.size() != static_cast<std::size_t>(size.Columns * size.Rows))
  {
    throw std::invalid_argument("the surface has " + std::to_string(size.Columns) + " x " +
      std::to_string(size.Rows) + " points; a surface to mill has at least 2 x 2");
  }
  this->Lowest = this->Highest = this->Points.front();
  for (std::size_t k = 0; k < this->Points.size(); ++k)
  {
    const Vec3& p = this->Points[k];
    if (!IsFinite(p))
    {
      const auto index = static_cast<std::int64_t>(k);
      ThrowAt(index % size.Columns, index / size.Columns,
        "the surface has a hole: the point is not finite,");
    }
    for (int c = 0; c < 3; ++c)
    {
      this->Lowest[c] = std::min(this->Lowest[c], p[c]);
      this->Highest[c] = std::max(this->Highest[c], p[c]);
    }
  }
  if (!(Norm(this->Lowest) < 1e5 && Norm(this->Highest) < 1e5))
  {
    throw std::invalid_argument("the surface reaches beyond 100 m; coordinates are in mm");
  }
  this->CheckTriangles();
  double sums[2] = { 0, 0 };
  for (std::int64_t j = 0; j < size.Rows; ++j)
  {
    const Vec3 d = this->At(size.Columns - 1, j) - this->At(0, j);
    sums[0] += std::hypot(d[0], d[1]);
  }
  for (std::int64_t i = 0; i < size.Columns; ++i)
  {
    const Vec3 d = this->At(i, size.Rows - 1) - this->At(i, 0);
    sums[1] += std::hypot(d[0], d[1]);
  }
  this->Spacing = std::min(sums[0] / static_cast<double>(size.Rows * (size.Columns - 1)),
    sums[1] / static_cast<double>(size.Columns * (size.Rows - 1)));
  this->MakeBlocks();
  this->MakeBins();
}

//------------------------------------------------------------------------------
void MillSurface::CheckTriangles() const
{
  const double extent =
    std::max(this->Highest[0] - this->Lowest[0], this->Highest[1] - this->Lowest[1]);
  const double sense = Area(this->At(0, 0), this->At(1, 0), this->At(1, 1)) < 0 ? -1 : 1;
  for (std::int64_t j = 0; j + 1 < this->Size.Rows; ++j)
  {
    for (std::int64_t i = 0; i + 1 < this->Size.Columns; ++i)
    {
      const Vec3& p = this->At(i, j);
      const Vec3& q = this->At(i + 1, j + 1);
      const double least = sense *
        (std::min(sense * Area(p, this->At(i + 1, j), q), sense * Area(p, q, this->At(i, j + 1))));
      if (!(std::abs(least) > 1e-12 * extent * extent))
      {
        ThrowAt(i, j,
          "the surface is upright or has no area, so that the mill, which looks along -z, cannot "
          "see it,",
          &p);
      }
      if (least * sense < 0)
      {
        ThrowAt(i, j,
          "the surface folds back: the mill, which looks along -z, sees more than one layer of it",
          &p);
      }
    }
  }
}

//------------------------------------------------------------------------------
void MillSurface::MakeBlocks()
{
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const auto cellColumns = static_cast<std::int32_t>(this->Size.Columns - 1);
  const auto cellRows = static_cast<std::int32_t>(this->Size.Rows - 1);
  for (std::int32_t row = 0; row < cellRows; row += BlockSize)
  {
    for (std::int32_t column = 0; column < cellColumns; column += BlockSize)
    {
      Vec3 low = this->At(column, row);
      Vec3 high = low;
      for (std::int32_t j = row; j <= std::min(row + BlockSize, cellRows); ++j)
      {
        for (std::int32_t i = column; i <= std::min(column + BlockSize, cellColumns); ++i)
        {
          for (int c = 0; c < 3; ++c)
          {
            low[c] = std::min(low[c], this->At(i, j)[c]);
            high[c] = std::max(high[c], this->At(i, j)[c]);
          }
        }
      }
      Block block{ column, row, { 0, 0 }, { 0, 0 }, high[2] };
      for (int c = 0; c < 2; ++c)
      {
        block.Low[c] = std::nextafter(static_cast<float>(low[c]), -infinity);
        block.High[c] = std::nextafter(static_cast<float>(high[c]), infinity);
      }
      this->Blocks.push_back(block);
    }
  }
}

//------------------------------------------------------------------------------
MillSurface::BinRange MillSurface::GetBins(const Vec2& low, const Vec2& high) const
{
  BinRange range{};
  for (int c = 0; c < 2; ++c)
  {
    const auto bin = [&](double x)
    {
      const double index = std::floor((x - this->Lowest[c]) / this->BinSize[c]);
      return static_cast<std::int32_t>(std::clamp(index, 0.0, double(this->Bins[c] - 1)));
    };
    range.First[c] = bin(low[c]);
    range.Last[c] = bin(high[c]);
  }
  return range;
}

//------------------------------------------------------------------------------
void MillSurface::MakeBins()
{
  // about one block a bin
  const double extent[2] = { this->Highest[0] - this->Lowest[0],
    this->Highest[1] - this->Lowest[1] };
  const auto blocks = static_cast<double>(this->Blocks.size());
  const double side = std::sqrt(extent[0] * extent[1] / blocks);
  for (int c = 0; c < 2; ++c)
  {
    const double wanted = std::clamp(std::ceil(extent[c] / side), 1.0, 4 * blocks);
    this->Bins[c] = static_cast<std::int32_t>(std::min(wanted, 32768.0));
    this->BinSize[c] = extent[c] / this->Bins[c];
  }
  std::vector<BinRange> ranges;
  ranges.reserve(this->Blocks.size());
  this->BinStarts.assign(std::size_t(this->Bins[0]) * this->Bins[1] + 1, 0);
  const auto forEachBin = [this](const BinRange& range, const auto& body)
  {
    for (std::int32_t v = range.First[1]; v <= range.Last[1]; ++v)
    {
      for (std::int32_t u = range.First[0]; u <= range.Last[0]; ++u)
      {
        body(u + std::int64_t{ this->Bins[0] } * v);
      }
    }
  };
  for (const Block& block : this->Blocks)
  {
    ranges.push_back(
      this->GetBins({ block.Low[0], block.Low[1] }, { block.High[0], block.High[1] }));
    forEachBin(ranges.back(), [this](std::int64_t bin) { ++this->BinStarts[bin + 1]; });
  }
  for (std::size_t k = 1; k < this->BinStarts.size(); ++k)
  {
    this->BinStarts[k] += this->BinStarts[k - 1];
  }
  std::vector<std::int64_t> next = this->BinStarts;
  this->Entries.resize(this->BinStarts.back());
  for (std::size_t b = 0; b < this->Blocks.size(); ++b)
  {
    const BinRange& range = ranges[b];
    forEachBin(range,
      [&](std::int64_t bin)
      {
        this->Entries[next[bin]++] = { static_cast<std::int32_t>(b),
          { range.First[0], range.First[1] } };
      });
  }
}

//------------------------------------------------------------------------------
std::vector<Vec3> MillSurface::GetNormals() const
{
  std::vector<Vec3> normals(this->Points.size(), Vec3{ 0, 0, 0 });
  const auto add = [&](std::int64_t a, std::int64_t b, std::int64_t c)
  {
    const std::int64_t corners[3] = { a, b, c };
    const Vec3 n =
      Normalized(Cross(this->Points[b] - this->Points[a], this->Points[c] - this->Points[a]));
    for (int k = 0; k < 3; ++k)
    {
      const std::int64_t p = corners[k];
      normals[p] = normals[p] +
        Angle(
          this->Points[p], this->Points[corners[(k + 1) % 3]], this->Points[corners[(k + 2) % 3]]) *
          (n[2] < 0 ? -1.0 : 1.0) * n;
    }
  };
  const std::int64_t columns = this->Size.Columns;
  for (std::int64_t j = 0; j + 1 < this->Size.Rows; ++j)
  {
    for (std::int64_t i = 0; i + 1 < columns; ++i)
    {
      const std::int64_t p = i + columns * j;
      add(p, p + 1, p + columns + 1);
      add(p, p + columns + 1, p + columns);
    }
  }
  for (Vec3& n : normals)
  {
    n = Normalized(n);
  }
  return normals;
}

//------------------------------------------------------------------------------
namespace
{
constexpr double Infinity = std::numeric_limits<double>::infinity();
// mm; bounds are this much too high, so that rounding never hides what is higher
constexpr double Slack = 1e-9;
// of the radius, along which the slope at the border is taken
constexpr double SlopeBase = 0.1;
// than that slope, since a border that slopes down mostly bends down, too
constexpr double Steeper = 2;

double Square(double x)
{
  return x * x;
}

// Squared distance in x and y of a box from a box.
double BoxDistance2(
  const double lowA[2], const double highA[2], const double lowB[2], const double highB[2])
{
  double sum = 0;
  for (int c = 0; c < 2; ++c)
  {
    sum += Square(std::max({ 0.0, lowA[c] - highB[c], lowB[c] - highA[c] }));
  }
  return sum;
}

// An edge as the mill sees it.
struct Edge
{
  const Vec3& Start;
  double X, Y; // from start to end
  double Length2;
  Edge(const Vec3& p, const Vec3& q)
    : Start(p)
    , X(q[0] - p[0])
    , Y(q[1] - p[1])
    , Length2(X * X + Y * Y)
  {
  }
};

// Calls for all vertices, edges and facets of a block; shared ones once in the surface.
template <class Features>
void Visit(const MillSurface& surface, const MillSurface::Block& block, Features& features)
{
  const std::int64_t columns = surface.GetSize().Columns;
  const std::int64_t rows = surface.GetSize().Rows;
  const auto end = [](std::int64_t first, std::int64_t size)
  { return first + MillSurface::BlockSize >= size - 1 ? size : first + MillSurface::BlockSize; };
  const std::int64_t endColumn = end(block.Column, columns);
  const std::int64_t endRow = end(block.Row, rows);
  for (std::int64_t j = block.Row; j < endRow; ++j)
  {
    for (std::int64_t i = block.Column; i < endColumn; ++i)
    {
      features.Vertex(surface.At(i, j));
    }
  }
  for (std::int64_t j = block.Row; j < endRow; ++j)
  {
    for (std::int64_t i = block.Column; i < endColumn; ++i)
    {
      const Vec3& p = surface.At(i, j);
      const bool right = i + 1 < columns;
      const bool below = j + 1 < rows;
      if (right)
      {
        features.EdgeOf(p, surface.At(i + 1, j));
      }
      if (below)
      {
        features.EdgeOf(p, surface.At(i, j + 1));
      }
      if (right && below)
      {
        const Vec3& q = surface.At(i + 1, j + 1);
        features.EdgeOf(p, q);
        features.Facet(p, surface.At(i + 1, j), q);
        features.Facet(p, q, surface.At(i, j + 1));
      }
    }
  }
}
}

//------------------------------------------------------------------------------
// One position: the highest reference point over all features.
struct DropCutter::Dropping
{
  const bool Ball;
  const double R;
  const double R2;
  const double X;
  const double Y;
  double Best = -Infinity;

  Dropping(const DropCutter& cutter, double x, double y)
    : Ball(cutter.Ball)
    , R(cutter.Radius)
    , R2(R * R)
    , X(x)
    , Y(y)
  {
  }

  // Squared distance below which something of height top may be higher than Best.
  double Reach2(double top) const
  {
    const double t = this->Best - Slack - top;
    return t < 0 ? this->R2 : (this->Ball ? this->R2 - t * t : -1);
  }

  void Vertex(const Vec3& p)
  {
    const double d2 = Square(p[0] - this->X) + Square(p[1] - this->Y);
    if (d2 < this->Reach2(p[2]))
    {
      this->Best = std::max(this->Best, this->Ball ? p[2] + std::sqrt(this->R2 - d2) : p[2]);
    }
  }

  void EdgeOf(const Vec3& p, const Vec3& q)
  {
    const Edge e(p, q);
    const double x = this->X - p[0];
    const double y = this->Y - p[1];
    const double cross = e.X * y - e.Y * x;
    if (cross * cross >= e.Length2 * this->Reach2(std::max(p[2], q[2])))
    {
      return;
    }
    const double length = std::sqrt(e.Length2);
    const double along = (e.X * x + e.Y * y) / length;
    if (along <= -this->R || along >= length + this->R)
    {
      return;
    }
    const double slope = (q[2] - p[2]) / length;
    const double w = std::sqrt(std::max(0.0, this->R2 - cross * cross / e.Length2));
    if (this->Ball)
    {
      const double secant = std::sqrt(1 + slope * slope);
      const double foot = along + w * slope / secant;
      if (foot >= 0 && foot <= length)
      {
        this->Best = std::max(this->Best, p[2] + slope * along + w * secant);
      }
    }
    else
    {
      const double foot = slope < 0 ? along - w : along + w;
      if (foot >= 0 && foot <= length)
      {
        this->Best = std::max(this->Best, p[2] + slope * foot);
      }
    }
  }

  void Facet(const Vec3& p, const Vec3& q, const Vec3& s)
  {
    const double low[2] = { std::min({ p[0], q[0], s[0] }), std::min({ p[1], q[1], s[1] }) };
    const double high[2] = { std::max({ p[0], q[0], s[0] }), std::max({ p[1], q[1], s[1] }) };
    const double here[2] = { this->X, this->Y };
    if (BoxDistance2(low, high, here, here) >= this->Reach2(std::max({ p[2], q[2], s[2] })))
    {
      return;
    }
    const Vec3 a = q - p;
    const Vec3 b = s - p;
    const double determinant = a[0] * b[1] - a[1] * b[0];
    const double gx = (a[2] * b[1] - b[2] * a[1]) / determinant;
    const double gy = (b[2] * a[0] - a[2] * b[0]) / determinant;
    const double g2 = gx * gx + gy * gy;
    double shift = 0; // from the axis to the contact, in gradients
    double rise = 0;  // from the contact to the reference point
    if (this->Ball)
    {
      rise = this->R / std::sqrt(1 + g2);
      shift = rise;
    }
    else if (g2 > 0)
    {
      shift = this->R / std::sqrt(g2);
    }
    const double x = this->X + shift * gx - p[0];
    const double y = this->Y + shift * gy - p[1];
    const double u = (x * b[1] - y * b[0]) / determinant;
    const double v = (a[0] * y - a[1] * x) / determinant;
    if (u >= 0 && v >= 0 && u + v <= 1)
    {
      this->Best = std::max(this->Best, p[2] + gx * x + gy * y + rise);
    }
  }
};

//------------------------------------------------------------------------------
// One straight motion: the highest reference point over all features, above the motion's own. At
// the highest place the contact is within a facet, an edge, or at a vertex, and what the tool's
// height over that one feature exceeds the motion is stationary there. Over a facet it is linear in
// the way, so that its largest value is found at an edge or an end of the motion as well.
struct DropCutter::Sweeping
{
  const bool Ball;
  const double R;
  const double R2;
  const Vec3 A;  // reference point
  double Hx, Hy; // unit direction
  double Length;
  double Slope;
  double Low[2], High[2];
  double LowestZ;
  double Best; // excess
  double BestS = 0;

  Sweeping(const DropCutter& cutter, const Vec3& a, const Vec3& b, double tolerance)
    : Ball(cutter.Ball)
    , R(cutter.Radius)
    , R2(R * R)
    , A{ a[0], a[1], a[2] - cutter.TipOffset }
    , Length(std::hypot(b[0] - a[0], b[1] - a[1]))
    , Best(tolerance)
  {
    this->Hx = (b[0] - a[0]) / this->Length;
    this->Hy = (b[1] - a[1]) / this->Length;
    this->Slope = (b[2] - a[2]) / this->Length;
    for (int c = 0; c < 2; ++c)
    {
      this->Low[c] = std::min(a[c], b[c]);
      this->High[c] = std::max(a[c], b[c]);
    }
    this->LowestZ = std::min(a[2], b[2]) - cutter.TipOffset;
  }

  double Reach2(double top) const
  {
    const double t = this->LowestZ + this->Best - Slack - top;
    return t < 0 ? this->R2 : (this->Ball ? this->R2 - t * t : -1);
  }

  void Try(double s, double height)
  {
    const double excess = height - (this->A[2] + this->Slope * s);
    if (excess > this->Best)
    {
      this->Best = excess;
      this->BestS = s;
    }
  }

  void Vertex(const Vec3& p)
  {
    const double x = p[0] - this->A[0];
    const double y = p[1] - this->A[1];
    const double along = this->Hx * x + this->Hy * y;
    const double d2 = Square(this->Hx * y - this->Hy * x);
    if (d2 >= this->Reach2(p[2]) || along <= -this->R || along >= this->Length + this->R)
    {
      return;
    }
    const double w = std::sqrt(this->R2 - d2);
    if (this->Ball)
    {
      const double secant = std::sqrt(1 + this->Slope * this->Slope);
      const double s = along - w * this->Slope / secant;
      if (s >= 0 && s <= this->Length)
      {
        this->Try(s, p[2] + w / secant);
      }
    }
    else
    {
      const double first = std::max(0.0, along - w);
      const double last = std::min(this->Length, along + w);
      if (first <= last)
      {
        this->Try(this->Slope > 0 ? first : last, p[2]);
      }
    }
  }

  void EdgeOf(const Vec3& p, const Vec3& q)
  {
    const double low[2] = { std::min(p[0], q[0]), std::min(p[1], q[1]) };
    const double high[2] = { std::max(p[0], q[0]), std::max(p[1], q[1]) };
    if (BoxDistance2(low, high, this->Low, this->High) >= this->Reach2(std::max(p[2], q[2])))
    {
      return;
    }
    const Edge e(p, q);
    const double length = std::sqrt(e.Length2);
    const double x = this->A[0] - p[0];
    const double y = this->A[1] - p[1];
    // the axis from the edge's line and along it, both linear in the way s
    const double across0 = (e.X * y - e.Y * x) / length;
    const double acrossRate = (e.X * this->Hy - e.Y * this->Hx) / length;
    const double along0 = (e.X * x + e.Y * y) / length;
    const double alongRate = (e.X * this->Hx + e.Y * this->Hy) / length;
    const double slope = (q[2] - p[2]) / length;
    const double secant = this->Ball ? std::sqrt(1 + slope * slope) : std::abs(slope);
    const double rise = slope * alongRate - this->Slope;
    const double turn = secant * acrossRate;
    const double norm = std::sqrt(rise * rise + turn * turn);
    if (!(norm > 0) || acrossRate == 0)
    {
      return; // as high all along the edge: its vertices or the motion's ends tell
    }
    const double across = (acrossRate < 0 ? -1 : 1) * this->R * rise / norm;
    const double s = (across - across0) / acrossRate;
    if (!(s >= 0 && s <= this->Length))
    {
      return;
    }
    const double w = this->R * std::abs(turn) / norm;
    const double along = along0 + alongRate * s;
    const double foot = along + (this->Ball ? w * slope / secant : (slope < 0 ? -w : w));
    if (foot >= 0 && foot <= length)
    {
      this->Try(s, p[2] + slope * along + secant * w);
    }
  }

  void Facet(const Vec3&, const Vec3&, const Vec3&) {}
};

//------------------------------------------------------------------------------
DropCutter::DropCutter(const MillSurface& surface, const MillTool& tool, double allowance)
  : Surface(surface)
  , Ball(tool.Shape == ToolShape::Ball)
  , Radius(tool.Radius + allowance)
  , TipOffset(tool.Shape == ToolShape::Ball ? -tool.Radius : allowance)
{
  if (!(tool.Radius > 0 && tool.Radius <= 1000 && allowance >= 0 && allowance <= 1000))
  {
    throw std::invalid_argument(
      "the tool's radius must be above 0 and at most 1000 mm, the allowance 0 to 1000 mm");
  }
}

//------------------------------------------------------------------------------
double DropCutter::Drop(double x, double y, Scratch& scratch) const
{
  Dropping drop(*this, x, y);
  const double here[2] = { x, y };
  const double reach = this->Radius;
  scratch.Candidates.clear();
  std::size_t first = 0;
  this->Surface.VisitBlocks({ x - reach, y - reach }, { x + reach, y + reach },
    [&](const MillSurface::Block& block)
    {
      const double low[2] = { block.Low[0], block.Low[1] };
      const double high[2] = { block.High[0], block.High[1] };
      const double d2 = BoxDistance2(low, high, here, here);
      if (d2 < drop.R2)
      {
        const double bound = block.Top + (this->Ball ? std::sqrt(drop.R2 - d2) : 0);
        scratch.Candidates.push_back({ bound + Slack, &block });
        if (bound + Slack > scratch.Candidates[first].Bound)
        {
          first = scratch.Candidates.size() - 1;
        }
      }
    });
  if (!scratch.Candidates.empty())
  {
    std::swap(scratch.Candidates.front(), scratch.Candidates[first]);
  }
  for (const Scratch::Candidate& candidate : scratch.Candidates)
  {
    if (candidate.Bound > drop.Best)
    {
      Visit(this->Surface, *candidate.Block, drop);
    }
  }
  return drop.Best + this->TipOffset;
}

//------------------------------------------------------------------------------
double DropCutter::DropBeyond(double x, double y, Scratch& scratch) const
{
  const Vec3& low = this->Surface.GetLowest();
  const Vec3& high = this->Surface.GetHighest();
  const double edge[2] = { std::clamp(x, low[0], high[0]), std::clamp(y, low[1], high[1]) };
  const double dx = x - edge[0];
  const double dy = y - edge[1];
  const double distance = std::hypot(dx, dy);
  const double here = this->Drop(x, y, scratch);
  if (!(distance > 0))
  {
    return here;
  }
  const double there = this->Drop(edge[0], edge[1], scratch);
  const double base = SlopeBase * this->Radius;
  const double before =
    this->Drop(edge[0] - base * dx / distance, edge[1] - base * dy / distance, scratch);
  if (!std::isfinite(there) || !std::isfinite(before))
  {
    return std::max(here, there);
  }
  const double slope = Steeper * std::max(0.0, before - there) / base;
  // A tool a radius away is beside the surface. A ball that touches an edge, leaning with the slope,
  // has its tip so much below it; deeper there is nothing to cut but what holds the block.
  const double below = this->Ball ? this->Radius * (1 - 1 / std::sqrt(1 + slope * slope)) : 0;
  const double lowest = std::min(there, low[2] - below);
  return std::max({ here, lowest, there - slope * std::min(distance, this->Radius) });
}

//------------------------------------------------------------------------------
DropCutter::Excess DropCutter::FindExcess(const Vec3& a, const Vec3& b, double tolerance) const
{
  Sweeping sweep(*this, a, b, tolerance);
  if (!(sweep.Length > 0))
  {
    return { -Infinity, 0 }; // upright
  }
  const double reach = this->Radius;
  this->Surface.VisitBlocks({ sweep.Low[0] - reach, sweep.Low[1] - reach },
    { sweep.High[0] + reach, sweep.High[1] + reach },
    [&](const MillSurface::Block& block)
    {
      const double low[2] = { block.Low[0], block.Low[1] };
      const double high[2] = { block.High[0], block.High[1] };
      if (BoxDistance2(low, high, sweep.Low, sweep.High) < sweep.Reach2(block.Top))
      {
        Visit(this->Surface, block, sweep);
      }
    });
  if (!(sweep.Best > tolerance))
  {
    return { -Infinity, 0 };
  }
  return { sweep.Best, sweep.BestS / sweep.Length };
}
}
