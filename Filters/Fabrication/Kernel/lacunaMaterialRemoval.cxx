// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMaterialRemoval.h"

#include "lacunaExecution.h"
#include "lacunaMemory.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lacuna
{
namespace
{
constexpr double Infinity = std::numeric_limits<double>::infinity();
constexpr double LargestBinCount = 1e6;
constexpr double LargestMap = 4e6; // points
constexpr double Touching = 0.002; // mm

double Square(double x)
{
  return x * x;
}

// Squared distance of (s, z) from what is on or above a segment from (0, first) to (length, last).
double StripDistance2(double s, double z, double length, double first, double last)
{
  if (!(length > 0))
  {
    return Square(s) + Square(std::max(0.0, std::min(first, last) - z));
  }
  if (s <= 0 && z >= first)
  {
    return Square(s);
  }
  if (s >= length && z >= last)
  {
    return Square(s - length);
  }
  const double rise = last - first;
  if (s >= 0 && s <= length && z >= first + rise * s / length)
  {
    return 0;
  }
  const double t =
    std::clamp((s * length + (z - first) * rise) / (length * length + rise * rise), 0.0, 1.0);
  const double toSegment = Square(s - t * length) + Square(z - first - t * rise);
  // below the lower end of a rising motion the upright border may be nearer
  const double toFirst = Square(s) + Square(std::max(0.0, first - z));
  const double toLast = Square(s - length) + Square(std::max(0.0, last - z));
  return std::min({ toSegment, toFirst, toLast });
}
}

//------------------------------------------------------------------------------
MaterialRemoval::MaterialRemoval(const ToolPath& path, const MillTool& tool)
  : Ball(tool.Shape == ToolShape::Ball)
  , Radius(tool.Radius)
  , StockTop(path.StockTop)
{
  const double offset = this->Ball ? this->Radius : 0;
  RequireMemory("the motions of the tool", static_cast<double>(path.Points.size()) * 80);
  for (const ToolPath::Run& run : path.Runs)
  {
    for (std::int64_t k = run.First + 1; run.Kind != Motion::Rapid && k < run.First + run.Count;
         ++k)
    {
      const Vec3& a = path.Points[k - 1];
      const Vec3& b = path.Points[k];
      Segment s{ { a[0], a[1], a[2] + offset }, 1, 0, std::hypot(b[0] - a[0], b[1] - a[1]),
        b[2] + offset };
      if (s.Length > 0)
      {
        s.Hx = (b[0] - a[0]) / s.Length;
        s.Hy = (b[1] - a[1]) / s.Length;
      }
      this->Segments.push_back(s);
    }
  }
  this->AddToBins();
}

//------------------------------------------------------------------------------
void MaterialRemoval::AddToBins()
{
  double high[2] = { -Infinity, -Infinity };
  this->Low[0] = this->Low[1] = Infinity;
  const auto end = [](const Segment& s) {
    return Vec2{ s.Start[0] + s.Length * s.Hx, s.Start[1] + s.Length * s.Hy };
  };
  for (const Segment& s : this->Segments)
  {
    const Vec2 last = end(s);
    for (int c = 0; c < 2; ++c)
    {
      this->Low[c] = std::min({ this->Low[c], s.Start[c], last[c] });
      high[c] = std::max({ high[c], s.Start[c], last[c] });
    }
  }
  if (this->Segments.empty())
  {
    this->Low[0] = this->Low[1] = high[0] = high[1] = 0;
  }
  const double area = (high[0] - this->Low[0]) * (high[1] - this->Low[1]);
  const double longest = std::max(high[0] - this->Low[0], high[1] - this->Low[1]);
  this->BinSize = std::max(
    { this->Radius / 2, std::sqrt(area / LargestBinCount), longest / LargestBinCount, 1e-3 });
  for (int c = 0; c < 2; ++c)
  {
    this->Bins[c] = static_cast<std::int64_t>((high[c] - this->Low[c]) / this->BinSize) + 1;
  }
  this->BinStarts.assign(this->Bins[0] * this->Bins[1] + 1, 0);
  this->BinLowest.assign(this->Bins[0] * this->Bins[1], Infinity);
  const auto forEachBin = [&](const Segment& s, const auto& body)
  {
    const Vec2 last = end(s);
    std::int64_t range[2][2];
    for (int c = 0; c < 2; ++c)
    {
      // a hair wider, so that rounding loses no bin
      const double low = std::min(s.Start[c], last[c]) - this->Low[c] - 1e-9;
      const double top = std::max(s.Start[c], last[c]) - this->Low[c] + 1e-9;
      range[c][0] = std::max<std::int64_t>(0, static_cast<std::int64_t>(low / this->BinSize));
      range[c][1] = std::min(this->Bins[c] - 1, static_cast<std::int64_t>(top / this->BinSize));
    }
    for (std::int64_t v = range[1][0]; v <= range[1][1]; ++v)
    {
      for (std::int64_t u = range[0][0]; u <= range[0][1]; ++u)
      {
        body(u + this->Bins[0] * v);
      }
    }
  };
  for (const Segment& s : this->Segments)
  {
    forEachBin(s,
      [&](std::int64_t bin)
      {
        ++this->BinStarts[bin + 1];
        this->BinLowest[bin] = std::min({ this->BinLowest[bin], s.Start[2], s.EndZ });
      });
  }
  for (std::size_t k = 1; k < this->BinStarts.size(); ++k)
  {
    this->BinStarts[k] += this->BinStarts[k - 1];
  }
  this->BinSegments.resize(this->BinStarts.back());
  std::vector<std::int64_t> next = this->BinStarts;
  for (std::size_t k = 0; k < this->Segments.size(); ++k)
  {
    forEachBin(this->Segments[k],
      [&](std::int64_t bin) { this->BinSegments[next[bin]++] = static_cast<std::int64_t>(k); });
  }
}

//------------------------------------------------------------------------------
// The lowest z that the tool reaches at p's x, y; best if that is lower.
double MaterialRemoval::GetHeight(const Segment& s, const Vec3& p, double best) const
{
  const double x = p[0] - s.Start[0];
  const double y = p[1] - s.Start[1];
  const double along = s.Hx * x + s.Hy * y;
  const double w2 = Square(this->Radius) - Square(s.Hx * y - s.Hy * x);
  const double beside = std::max({ 0.0, -along, along - s.Length });
  const double above = std::max(0.0, std::min(s.Start[2], s.EndZ) - best);
  if (w2 < beside * beside || (this->Ball && w2 - beside * beside <= above * above))
  {
    return best; // out of reach, or not lower even where the tool is lowest
  }
  const double w = std::sqrt(w2);
  const double first = std::max(0.0, along - w);
  const double last = std::min(s.Length, along + w);
  if (!(s.Length > 0))
  {
    const double z = std::min(s.Start[2], s.EndZ);
    return std::min(best, this->Ball ? z - std::sqrt(std::max(0.0, w2 - along * along)) : z);
  }
  const double slope = (s.EndZ - s.Start[2]) / s.Length;
  if (!this->Ball)
  {
    return std::min(best, s.Start[2] + slope * (slope > 0 ? first : last));
  }
  const double at = std::clamp(along - w * slope / std::sqrt(1 + slope * slope), first, last);
  return std::min(
    best, s.Start[2] + slope * at - std::sqrt(std::max(0.0, w2 - Square(at - along))));
}

//------------------------------------------------------------------------------
// Signed distance of p from what the tool sweeps; best if that is less.
double MaterialRemoval::GetDistance(const Segment& s, const Vec3& p, double best) const
{
  const double x = p[0] - s.Start[0];
  const double y = p[1] - s.Start[1];
  const double along = s.Hx * x + s.Hy * y;
  const double across = s.Hx * y - s.Hy * x;
  if (std::abs(across) >= this->Radius + best)
  {
    return best;
  }
  if (this->Ball)
  {
    const double d2 = across * across + StripDistance2(along, p[2], s.Length, s.Start[2], s.EndZ);
    const double reach = this->Radius + best;
    return d2 < reach * reach || best < 0 ? std::min(best, std::sqrt(d2) - this->Radius) : best;
  }
  // convex in the way: golden section
  const auto distance = [&](double t)
  {
    const double out = std::sqrt(Square(across) + Square(along - t)) - this->Radius;
    const double z = s.Length > 0 ? s.Start[2] + (s.EndZ - s.Start[2]) * t / s.Length
                                  : std::min(s.Start[2], s.EndZ);
    const double up = z - p[2];
    return out <= 0 || up <= 0 ? std::max(out, up) : std::sqrt(out * out + up * up);
  };
  double low = 0;
  double high = s.Length;
  constexpr double Golden = 0.6180339887498949;
  double a = high - Golden * (high - low);
  double b = low + Golden * (high - low);
  double atA = distance(a);
  double atB = distance(b);
  for (int round = 0; round < 40 && high - low > 1e-7; ++round)
  {
    if (atA < atB)
    {
      high = b;
      b = a;
      atB = atA;
      a = high - Golden * (high - low);
      atA = distance(a);
    }
    else
    {
      low = a;
      a = b;
      atA = atB;
      b = low + Golden * (high - low);
      atB = distance(b);
    }
  }
  return std::min({ best, atA, atB, distance(0), distance(s.Length) });
}

//------------------------------------------------------------------------------
void MaterialRemoval::Visit(
  std::int64_t u, std::int64_t v, const Vec3& p, Result& result, std::int64_t& nearest) const
{
  const std::int64_t bin = u + this->Bins[0] * v;
  if (this->BinStarts[bin] == this->BinStarts[bin + 1])
  {
    return;
  }
  const double x = this->Low[0] + static_cast<double>(u) * this->BinSize - p[0];
  const double y = this->Low[1] + static_cast<double>(v) * this->BinSize - p[1];
  const double d2 = Square(std::max({ 0.0, x, -x - this->BinSize })) +
    Square(std::max({ 0.0, y, -y - this->BinSize }));
  const double r2 = Square(this->Radius);
  const double lowest = this->BinLowest[bin];
  const double up = std::max(0.0, lowest - p[2]);
  const bool nearer = this->Ball ? d2 + up * up < Square(this->Radius + result.LeftOver)
                                 : up < std::max(result.LeftOver, 0.0) &&
      d2 < Square(this->Radius + std::max(result.LeftOver, 0.0));
  const bool lower =
    d2 <= r2 && (this->Ball ? lowest - std::sqrt(r2 - d2) : lowest) < result.Height;
  // where it is in the tool the flat end's depth needs all that is near
  const bool inside = !this->Ball && d2 <= r2 && lowest < p[2];
  if (!nearer && !lower && !inside)
  {
    return;
  }
  for (std::int64_t k = this->BinStarts[bin]; k < this->BinStarts[bin + 1]; ++k)
  {
    const Segment& s = this->Segments[this->BinSegments[k]];
    if (lower)
    {
      result.Height = this->GetHeight(s, p, result.Height);
    }
    if (nearer || inside)
    {
      const double distance = this->GetDistance(s, p, result.LeftOver);
      if (distance < result.LeftOver)
      {
        result.LeftOver = distance;
        nearest = this->BinSegments[k];
      }
    }
  }
}

//------------------------------------------------------------------------------
MaterialRemoval::Result MaterialRemoval::At(const Vec3& p, std::int64_t& nearest) const
{
  Result result{ this->StockTop, this->StockTop - p[2] };
  if (nearest >= 0)
  {
    // what is near a neighbour is near here, so that little else has to be looked at
    result.LeftOver = this->GetDistance(this->Segments[nearest], p, result.LeftOver);
    result.Height = this->GetHeight(this->Segments[nearest], p, result.Height);
  }
  std::int64_t centre[2];
  for (int c = 0; c < 2; ++c)
  {
    const double t = p[c] - this->Low[c];
    centre[c] = std::clamp<std::int64_t>(
      static_cast<std::int64_t>(std::floor(t / this->BinSize)), 0, this->Bins[c] - 1);
  }
  const std::int64_t rings = std::max(
    { centre[0], this->Bins[0] - 1 - centre[0], centre[1], this->Bins[1] - 1 - centre[1] });
  for (std::int64_t ring = 0; ring <= rings; ++ring)
  {
    const double least = static_cast<double>(ring - 1) * this->BinSize;
    if (ring > 1 && least >= this->Radius + std::max(0.0, result.LeftOver))
    {
      break;
    }
    const std::int64_t low[2] = { centre[0] - ring, centre[1] - ring };
    const std::int64_t high[2] = { centre[0] + ring, centre[1] + ring };
    for (std::int64_t v = std::max<std::int64_t>(0, low[1]);
         v <= std::min(this->Bins[1] - 1, high[1]); ++v)
    {
      const bool whole = v == low[1] || v == high[1];
      const std::int64_t step = whole || ring == 0 ? 1 : 2 * ring;
      for (std::int64_t u = low[0]; u <= high[0]; u += step)
      {
        if (u >= 0 && u < this->Bins[0])
        {
          this->Visit(u, v, p, result, nearest);
        }
      }
    }
  }
  return result;
}

//------------------------------------------------------------------------------
std::vector<double> FindUnreachable(
  Execution& execution, const MillSurface& surface, const MillTool& tool)
{
  const DropCutter cutter(surface, tool);
  const std::vector<Vec3> normals = surface.GetNormals();
  const std::vector<Vec3>& points = surface.GetPoints();
  std::vector<double> result(points.size(), 0.0);
  execution.For(static_cast<std::int64_t>(points.size()), 256,
    [&](std::int64_t begin, std::int64_t end)
    {
      DropCutter::Scratch scratch;
      for (std::int64_t k = begin; k < end; ++k)
      {
        // where it would touch a plane with this normal
        const Vec3& p = points[k];
        const Vec3& n = normals[k];
        const double flat = std::hypot(n[0], n[1]);
        const double out = tool.Shape == ToolShape::Ball ? tool.Radius
          : flat > 1e-6                                  ? tool.Radius / flat
                                                         : 0;
        const double tip = p[2] + (tool.Shape == ToolShape::Ball ? tool.Radius * (n[2] - 1) : 0);
        const double lift = cutter.Drop(p[0] + out * n[0], p[1] + out * n[1], scratch) - tip;
        result[k] = std::max(0.0, lift * n[2]);
      }
    });
  if (*std::max_element(result.begin(), result.end()) < Touching)
  {
    return result;
  }
  // where it does not fit another place may be better: above any point of the surface
  ToolPath everywhere;
  everywhere.StockTop = surface.GetHighest()[2] + 4 * tool.Radius;
  everywhere.Points.resize(2 * points.size());
  execution.For(static_cast<std::int64_t>(points.size()), 256,
    [&](std::int64_t begin, std::int64_t end)
    {
      DropCutter::Scratch scratch;
      for (std::int64_t k = begin; k < end; ++k)
      {
        const Vec3& p = points[k];
        everywhere.Points[2 * k] = { p[0], p[1], cutter.Drop(p[0], p[1], scratch) };
        everywhere.Points[2 * k + 1] = everywhere.Points[2 * k];
      }
    });
  for (std::int64_t k = 0; k < static_cast<std::int64_t>(points.size()); ++k)
  {
    everywhere.Runs.push_back({ Motion::Plunge, 0, 2 * k, 2 });
  }
  const MaterialRemoval removal(everywhere, tool);
  execution.For(static_cast<std::int64_t>(points.size()), 256,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t k = begin; k < end; ++k)
      {
        if (result[k] >= Touching)
        {
          std::int64_t nearest = -1;
          result[k] = std::min(result[k], std::max(0.0, removal.At(points[k], nearest).LeftOver));
        }
      }
    });
  return result;
}

//------------------------------------------------------------------------------
LeftOverMap MapLeftOver(Execution& execution, const MillSurface& surface, const MillTool& tool,
  const ToolPath& path, double spacing)
{
  const Execution::NestedStages nested(execution);
  execution.SetStage(0, 0.2);
  const std::vector<double> unreachable = FindUnreachable(execution, surface, tool);
  const MaterialRemoval removal(path, tool);
  const GridSize cells{ surface.GetSize().Columns - 1, surface.GetSize().Rows - 1 };
  const double cellCount = static_cast<double>(cells.Columns) * static_cast<double>(cells.Rows);
  const double wanted = std::ceil(surface.GetSpacing() / spacing - 1e-9);
  const auto n = static_cast<std::int64_t>(
    std::max(1.0, std::min(wanted, std::floor(std::sqrt(LargestMap / cellCount)))));
  LeftOverMap map;
  map.Size = { cells.Columns * n + 1, cells.Rows * n + 1 };
  map.Spacing = surface.GetSpacing() / static_cast<double>(n);
  const auto count = static_cast<std::size_t>(map.Size.Columns * map.Size.Rows);
  RequireMemory("the map of what is left", static_cast<double>(count) * 48);
  map.Points.resize(count);
  map.LeftOver.resize(count);
  map.Height.resize(count);
  map.Unreachable.resize(count);
  std::vector<double> gouges(map.Size.Rows, 0.0);
  execution.SetStage(0.2, 1);
  execution.For(map.Size.Rows, 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t row = begin; row < end; ++row)
      {
        std::int64_t nearest = -1;
        const std::int64_t j = std::min(row / n, cells.Rows - 1);
        const double v = static_cast<double>(row - j * n) / static_cast<double>(n);
        for (std::int64_t column = 0; column < map.Size.Columns; ++column)
        {
          const std::int64_t i = std::min(column / n, cells.Columns - 1);
          const double u = static_cast<double>(column - i * n) / static_cast<double>(n);
          // corners of the triangle and their weights
          const std::int64_t first = i + surface.GetSize().Columns * j;
          const std::int64_t opposite = first + surface.GetSize().Columns + 1;
          const std::int64_t third = u >= v ? first + 1 : opposite - 1;
          const double weights[3] = { 1 - std::max(u, v), std::min(u, v), std::abs(u - v) };
          const std::vector<Vec3>& points = surface.GetPoints();
          const auto k = static_cast<std::size_t>(column + map.Size.Columns * row);
          map.Points[k] =
            weights[0] * points[first] + weights[1] * points[opposite] + weights[2] * points[third];
          map.Unreachable[k] = weights[0] * unreachable[first] +
            weights[1] * unreachable[opposite] + weights[2] * unreachable[third];
          const MaterialRemoval::Result left = removal.At(map.Points[k], nearest);
          map.Height[k] = left.Height;
          map.LeftOver[k] = std::max(0.0, left.LeftOver);
          map.Unreachable[k] = std::min(map.Unreachable[k], map.LeftOver[k]);
          gouges[row] = std::max(gouges[row], -left.LeftOver);
        }
      }
    });
  map.LargestGouge = *std::max_element(gouges.begin(), gouges.end());
  map.LargestLeftOver = *std::max_element(map.LeftOver.begin(), map.LeftOver.end());
  return map;
}
}
