// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSkullImplant.h"

#include "lacunaParameterText.h"
#include "lacunaPlanarCurves.h"
#include "lacunaPlanarLattice.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace lacuna
{
namespace
{
constexpr double Pi = 3.14159265358979323846;
constexpr double GridSpacing = 0.4; // mm of the map in which the free space is found
constexpr double ErrorSpacing = 3;  // mm: standard errors vary slowly
constexpr double FarFromRim = 3;    // mm: where distances to the rim do not matter any more
// mm: of a ball that fits into all of the implant's outline, seen from outside. What is narrower than twice as
// much is a gap in thin bone, a suture or a drill hole.
constexpr double LeastRadius = 2;
constexpr double Slack = 0.4;      // mm: of that, for what is not exact
constexpr double MostAngle = 2.4;  // radians from the middle of a defect
constexpr double ValueScale = 500; // of grey levels a mm, at the edge of bone; only the sign counts
constexpr double LeastPart = 100;  // mm^2: of a free space that is told of
constexpr double ScanEnd = 20;     // mm^2: of a hole beyond the scan
constexpr double Infinity = std::numeric_limits<double>::infinity();
constexpr double LatticeToRim = 0.6; // of TriangleSize: the rim's edges stay Delaunay edges
constexpr int InsertionSteps = 400;

// Directions as points of a plane: the distance from the middle is the angle (azimuthal equidistant), mm at
// a typical radius.
class Chart
{
public:
  Chart(const Vec3& axis, const Vec3& beside, double scale)
    : Axis(axis)
    , U(Normalized(beside - Dot(beside, axis) * axis))
    , V(Cross(axis, U))
    , Scale(scale)
  {
  }
  Vec2 ToPlane(const Vec3& direction) const
  {
    const double x = Dot(direction, this->U);
    const double y = Dot(direction, this->V);
    const double angle = std::atan2(std::hypot(x, y), Dot(direction, this->Axis));
    const double factor = angle < 1e-9 ? 1 : angle / std::hypot(x, y);
    return { this->Scale * factor * x, this->Scale * factor * y };
  }
  Vec3 ToDirection(const Vec2& p) const
  {
    const double angle = std::hypot(p[0], p[1]) / this->Scale;
    const double factor = angle < 1e-9 ? 1 / this->Scale : std::sin(angle) / (angle * this->Scale);
    return Normalized(
      std::cos(angle) * this->Axis + (factor * p[0]) * this->U + (factor * p[1]) * this->V);
  }
  double GetScale() const { return this->Scale; }

private:
  Vec3 Axis;
  Vec3 U;
  Vec3 V;
  double Scale;
};

PlanarGrid MakeGrid(const std::vector<Vec2>& points, double margin, double spacing)
{
  Vec2 low = points[0];
  Vec2 high = points[0];
  for (const Vec2& p : points)
  {
    for (int a = 0; a < 2; ++a)
    {
      low[a] = std::min(low[a], p[a] - margin);
      high[a] = std::max(high[a], p[a] + margin);
    }
  }
  PlanarGrid grid;
  grid.Origin = low;
  grid.Spacing = { spacing, spacing };
  grid.Columns = static_cast<std::int64_t>(std::ceil((high[0] - low[0]) / spacing)) + 2;
  grid.Rows = static_cast<std::int64_t>(std::ceil((high[1] - low[1]) / spacing)) + 2;
  return grid;
}

// For each node the distance to the nearest of some points, at most limit.
std::vector<double> FindDistances(
  const PlanarGrid& grid, const std::vector<Vec2>& points, double limit)
{
  std::vector<double> distances(static_cast<std::size_t>(grid.Columns * grid.Rows), limit);
  const auto reach = static_cast<std::int64_t>(std::ceil(limit / grid.Spacing[0]));
  for (const Vec2& p : points)
  {
    const auto i = static_cast<std::int64_t>((p[0] - grid.Origin[0]) / grid.Spacing[0]);
    const auto j = static_cast<std::int64_t>((p[1] - grid.Origin[1]) / grid.Spacing[1]);
    for (std::int64_t n = std::max<std::int64_t>(0, j - reach);
         n <= std::min(grid.Rows - 1, j + reach + 1); ++n)
    {
      for (std::int64_t m = std::max<std::int64_t>(0, i - reach);
           m <= std::min(grid.Columns - 1, i + reach + 1); ++m)
      {
        const Vec2 node = grid.GetNode(m, n);
        double& distance = distances[m + grid.Columns * n];
        distance = std::min(distance, std::hypot(node[0] - p[0], node[1] - p[1]));
      }
    }
  }
  return distances;
}

// Connected nodes (four neighbours) where values are positive, the most first.
std::vector<std::vector<std::int64_t>> FindFreeParts(
  const PlanarGrid& grid, const std::vector<double>& values)
{
  std::vector<std::vector<std::int64_t>> parts;
  std::vector<bool> seen(values.size(), false);
  for (std::size_t start = 0; start < values.size(); ++start)
  {
    if (seen[start] || values[start] <= 0)
    {
      continue;
    }
    std::vector<std::int64_t> part{ static_cast<std::int64_t>(start) };
    seen[start] = true;
    for (std::size_t k = 0; k < part.size(); ++k)
    {
      for (const std::int64_t step :
        { std::int64_t{ -1 }, std::int64_t{ 1 }, -grid.Columns, grid.Columns })
      {
        const std::int64_t other = part[k] + step; // the border has no positive values
        if (!seen[other] && values[other] > 0)
        {
          seen[other] = true;
          part.push_back(other);
        }
      }
    }
    parts.push_back(std::move(part));
  }
  std::stable_sort(
    parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return parts;
}

// Points about so far apart along a closed polygon.
Loop Resample(const Loop& loop, double spacing)
{
  std::vector<double> along{ 0 };
  for (std::size_t k = 0; k < loop.size(); ++k)
  {
    const Vec2& a = loop[k];
    const Vec2& b = loop[(k + 1) % loop.size()];
    along.push_back(along.back() + std::hypot(b[0] - a[0], b[1] - a[1]));
  }
  const int count = std::max(8, static_cast<int>(std::lround(along.back() / spacing)));
  Loop points;
  std::size_t k = 0;
  for (int i = 0; i < count; ++i)
  {
    const double s = along.back() * i / count;
    while (k + 1 < loop.size() && along[k + 1] <= s)
    {
      ++k;
    }
    const Vec2& a = loop[k];
    const Vec2& b = loop[(k + 1) % loop.size()];
    const double t = along[k + 1] > along[k] ? (s - along[k]) / (along[k + 1] - along[k]) : 0;
    points.push_back({ a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]) });
  }
  return points;
}

// The loop of the largest area and the loops within it.
std::vector<Loop> KeepLargest(std::vector<Loop> loops)
{
  const auto largest = std::max_element(loops.begin(), loops.end(),
    [](const Loop& a, const Loop& b) { return SignedArea(a) < SignedArea(b); });
  if (largest == loops.end() || !(SignedArea(*largest) > 0))
  {
    return {};
  }
  std::vector<Loop> kept{ *largest };
  for (const Loop& loop : loops)
  {
    if (SignedArea(loop) < 0 && IsInside(std::vector<Loop>{ kept[0] }, loop[0]))
    {
      kept.push_back(loop);
    }
  }
  return kept;
}

double GetArea(const std::vector<Loop>& loops)
{
  double area = 0;
  for (const Loop& loop : loops)
  {
    area += SignedArea(loop);
  }
  return area;
}

class Builder
{
public:
  Builder(const VoxelVolume& volume, const SkullRays& rays, const std::vector<int>& defect,
    const SkullShape& shape, const SkullImplantOptions& options, Execution& execution)
    : Volume(volume)
    , Rays(rays)
    , Shape(shape)
    , Options(options)
    , Run(execution)
    , Plane(MakeChart(rays, defect, shape, execution))
  {
    for (const int ray : defect)
    {
      if (Dot(rays.Directions[ray], this->Plane.ToDirection({ 0, 0 })) > std::cos(MostAngle))
      {
        this->Defect.push_back(this->Plane.ToPlane(rays.Directions[ray]));
      }
    }
    if (this->Defect.empty())
    {
      throw std::runtime_error("the hole goes around the whole skull");
    }
  }

  SkullImplant Make()
  {
    this->Run.SetStage(0.05, 0.2);
    std::vector<Loop> hole = this->FindHole();
    this->Run.SetStage(0.35, 0.4);
    std::vector<Loop> outline = this->MoveInwards(hole);
    for (Loop& loop : outline)
    {
      loop = Resample(loop, 0.5 * this->Options.TriangleSize);
    }
    this->OutlineArea = GetArea(outline);
    this->Run.SetStage(0.4, 0.5);
    this->AddMesh(outline);
    this->Run.SetStage(0.5, 1);
    this->AddErrors();
    this->Measure();
    this->SetHoleArea(hole);
    this->FindInsertion(outline);
    return std::move(this->Implant);
  }

private:
  static Chart MakeChart(const SkullRays& rays, const std::vector<int>& defect,
    const SkullShape& shape, Execution& execution)
  {
    Vec3 axis{ 0, 0, 0 };
    std::vector<Vec3> directions;
    for (const int ray : defect)
    {
      directions.push_back(rays.Directions[ray]);
      axis = axis + directions.back();
    }
    axis = Normalized(axis);
    std::vector<double> radii;
    for (const SkullEstimate& e : shape.PredictSurfaces(directions, execution))
    {
      radii.push_back(e.Outer);
    }
    std::nth_element(radii.begin(), radii.begin() + radii.size() / 2, radii.end());
    // Rays turn with the volume, so that the chart does.
    const std::size_t n = rays.Directions.size();
    const Vec3& first = rays.Directions[0];
    const Vec3& beside = std::abs(Dot(first, axis)) < 0.9 ? first : rays.Directions[n / 2];
    return { axis, beside, radii[radii.size() / 2] };
  }

  std::vector<Vec3> DirectionsOf(const std::vector<Vec2>& points) const
  {
    std::vector<Vec3> directions;
    directions.reserve(points.size());
    for (const Vec2& p : points)
    {
      directions.push_back(this->Plane.ToDirection(p));
    }
    return directions;
  }

  Vec3 PointAt(const Vec3& direction, double radius) const
  {
    return this->Rays.Center + radius * direction;
  }

  //----------------------------------------------------------------------------
  // Outlines of the space that is free of bone, in the chart.
  std::vector<Loop> FindHole()
  {
    const double near = 2 * this->Rays.Spacing * this->Plane.GetScale(); // of rays beside bone
    this->Grid = MakeGrid(this->Defect, near + 2 * GridSpacing, GridSpacing);
    const std::vector<double> away = FindDistances(this->Grid, this->Defect, 2 * near);
    std::vector<std::int64_t> nodes;
    std::vector<Vec2> points;
    for (std::size_t k = 0; k < away.size(); ++k)
    {
      if (away[k] < near + 2 * GridSpacing)
      {
        const auto node = static_cast<std::int64_t>(k);
        nodes.push_back(node);
        points.push_back(this->Grid.GetNode(node % this->Grid.Columns, node / this->Grid.Columns));
      }
    }
    const std::vector<Vec3> directions = this->DirectionsOf(points);
    const std::vector<SkullEstimate> shape = this->Shape.PredictSurfaces(directions, this->Run);
    this->Run.SetStage(0.2, 0.3);
    std::vector<RaySegment> segments;
    for (std::size_t k = 0; k < nodes.size(); ++k)
    {
      const double outer = shape[k].Outer + this->Options.EdgeClearance;
      const double inner = shape[k].Outer - shape[k].Thickness - this->Options.EdgeClearance;
      segments.push_back({ directions[k], std::max(inner, 1.0), outer });
    }
    const std::vector<double> largest =
      FindLargestAlong(this->Volume, this->Rays.Center, segments, this->Run);
    this->Run.SetStage(0.3, 0.35);
    this->Free.assign(away.size(), -1);
    this->Inner.assign(away.size(), 0);
    for (std::size_t k = 0; k < nodes.size(); ++k)
    {
      this->Free[nodes[k]] =
        std::clamp((this->Options.Level - largest[k]) / ValueScale, -near, near - away[nodes[k]]);
      this->Inner[nodes[k]] = shape[k].Outer - shape[k].Thickness;
    }
    const std::vector<std::vector<std::int64_t>> parts = FindFreeParts(this->Grid, this->Free);
    if (parts.empty())
    {
      throw std::runtime_error("bone fills the hole: between the predicted surfaces no space is "
                               "free. Check the level, and that the hole is a hole");
    }
    const double nodeArea = GridSpacing * GridSpacing;
    // where the scan ends: within an outline that was drawn, or beside the rays that surely miss bone
    const auto beyond = static_cast<double>(std::count(largest.begin(), largest.end(), Infinity));
    if (beyond * nodeArea > ScanEnd || this->FindUnknownArea() > ScanEnd)
    {
      this->Implant.Warnings.push_back(
        "the scan ends within the hole: the implant ends there, too, and does not meet bone");
    }
    for (std::size_t p = 1; p < parts.size(); ++p)
    {
      for (const std::int64_t node : parts[p])
      {
        this->Free[node] = -1;
      }
      if (static_cast<double>(parts[p].size()) * nodeArea > LeastPart)
      {
        this->Implant.Warnings.push_back("bone divides the hole: a part of " +
          FormatNumber(std::round(static_cast<double>(parts[p].size()) * nodeArea / 100)) +
          " cm^2 is left out");
      }
    }
    return KeepLargest(FindContours(this->Grid, this->Free, 0));
  }

  // Of the rays next to the defect that leave the scan before they come to the skull, mm^2.
  double FindUnknownArea() const
  {
    const double edge = this->Rays.Spacing * this->Plane.GetScale();
    double area = 0;
    for (std::size_t i = 0; i < this->Rays.Kinds.size(); ++i)
    {
      if (this->Rays.Kinds[i] == SkullRayKind::Unknown)
      {
        const Vec2 p = this->Plane.ToPlane(this->Rays.Directions[i]);
        area += std::any_of(this->Defect.begin(), this->Defect.end(),
                  [&](const Vec2& q) { return std::hypot(p[0] - q[0], p[1] - q[1]) < 1.6 * edge; })
          ? 0.866 * edge * edge
          : 0;
      }
    }
    return area;
  }

  // Linear between nodes.
  double InnerAt(const Vec2& p) const
  {
    const auto i = static_cast<std::int64_t>((p[0] - this->Grid.Origin[0]) / GridSpacing);
    const auto j = static_cast<std::int64_t>((p[1] - this->Grid.Origin[1]) / GridSpacing);
    const double x = (p[0] - this->Grid.Origin[0]) / GridSpacing - static_cast<double>(i);
    const double y = (p[1] - this->Grid.Origin[1]) / GridSpacing - static_cast<double>(j);
    double sum = 0;
    double weights = 0;
    for (const int m : { 0, 1 })
    {
      for (const int n : { 0, 1 })
      {
        const std::int64_t node = std::min(i + m, this->Grid.Columns - 1) +
          this->Grid.Columns * std::min(j + n, this->Grid.Rows - 1);
        const double weight = (m ? x : 1 - x) * (n ? y : 1 - y);
        sum += this->Inner[node] > 0 ? weight * this->Inner[node] : 0;
        weights += this->Inner[node] > 0 ? weight : 0;
      }
    }
    return weights > 0 ? sum / weights : this->Plane.GetScale();
  }

  std::vector<Loop> MoveInwards(const std::vector<Loop>& hole)
  {
    if (hole.empty())
    {
      throw std::runtime_error("no space in the hole is free of bone");
    }
    const CurveIndex rim(this->OnInner(hole), 2);
    std::vector<double> distances(this->Free.size(), -FarFromRim);
    const double limit = FarFromRim + this->Options.EdgeClearance;
    this->Run.For(this->Grid.Rows, 8,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t j = begin; j < end; ++j)
        {
          for (std::int64_t i = 0; i < this->Grid.Columns; ++i)
          {
            const std::int64_t node = i + this->Grid.Columns * j;
            if (this->Inner[node] > 0)
            {
              const Vec3 direction = this->Plane.ToDirection(this->Grid.GetNode(i, j));
              const double distance =
                rim.Find(this->PointAt(direction, this->Inner[node]), limit).Distance;
              distances[node] = this->Free[node] > 0 ? distance : -distance;
            }
          }
        }
      });
    return this->WithoutTongues(std::move(distances));
  }

  // The outline at the clearance from the rim, without what is narrow (an opening).
  std::vector<Loop> WithoutTongues(std::vector<double> distances)
  {
    const double clearance = this->Options.EdgeClearance;
    const std::vector<Loop> core =
      KeepLargest(FindContours(this->Grid, distances, clearance + LeastRadius));
    if (core.empty())
    {
      throw std::runtime_error("the hole is nowhere wider than " +
        FormatNumber(2 * (clearance + LeastRadius)) +
        " mm: it may be a gap in thin bone, which this level does not show");
    }
    const double before = GetArea(KeepLargest(FindContours(this->Grid, distances, clearance)));
    const CurveIndex edge(this->OnInner(core), 2);
    const double limit = LeastRadius + Slack;
    this->Run.For(this->Grid.Rows, 8,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t j = begin; j < end; ++j)
        {
          for (std::int64_t i = 0; i < this->Grid.Columns; ++i)
          {
            double& distance = distances[i + this->Grid.Columns * j];
            const Vec2 node = this->Grid.GetNode(i, j);
            if (distance > clearance && !IsInside(core, node))
            {
              const Vec3 point = this->PointAt(
                this->Plane.ToDirection(node), this->Inner[i + this->Grid.Columns * j]);
              distance =
                std::min(distance, clearance + limit - edge.Find(point, 2 * limit).Distance);
            }
          }
        }
      });
    std::vector<Loop> outline = KeepLargest(FindContours(this->Grid, distances, clearance));
    const double without = before - GetArea(outline);
    if (without > LeastPart)
    {
      this->Implant.Warnings.push_back("the hole has parts that are narrower than " +
        FormatNumber(2 * (clearance + LeastRadius)) + " mm, or that are behind such: " +
        FormatNumber(std::round(without / 10) / 10) + " cm^2 are left out");
    }
    return outline;
  }

  std::vector<std::vector<Vec3>> OnInner(const std::vector<Loop>& loops) const
  {
    std::vector<std::vector<Vec3>> curves;
    for (const Loop& loop : loops)
    {
      curves.emplace_back();
      for (const Vec2& p : loop)
      {
        curves.back().push_back(this->PointAt(this->Plane.ToDirection(p), this->InnerAt(p)));
      }
    }
    return curves;
  }

  //----------------------------------------------------------------------------
  void AddMesh(const std::vector<Loop>& outline)
  {
    const double h = this->Options.TriangleSize;
    std::vector<std::vector<std::int32_t>> edges;
    for (const Loop& loop : outline)
    {
      edges.emplace_back();
      for (const Vec2& p : loop)
      {
        edges.back().push_back(static_cast<std::int32_t>(this->Feet.size()));
        this->Feet.push_back(p);
      }
    }
    const Loop lattice = FillWithLattice(this->Run, outline, h, LatticeToRim * h);
    this->Feet.insert(this->Feet.end(), lattice.begin(), lattice.end());
    std::vector<Vec2> rounded = this->Feet;
    const std::vector<Triangle> triangles = TriangulateRegion(rounded, edges);
    const std::vector<Vec3> directions = this->DirectionsOf(this->Feet);
    const std::vector<SkullEstimate> shape = this->Shape.PredictSurfaces(directions, this->Run);
    const auto n = static_cast<std::int32_t>(this->Feet.size());
    SkullImplant& implant = this->Implant;
    for (const bool outer : { true, false })
    {
      for (std::int32_t k = 0; k < n; ++k)
      {
        const double radius = shape[k].Outer - (outer ? 0 : shape[k].Thickness);
        if (!(radius > 1))
        {
          throw std::runtime_error("the inner surface reaches the middle of the skull");
        }
        implant.Points.push_back(this->PointAt(directions[k], radius));
        implant.Thickness.push_back(shape[k].Thickness);
      }
    }
    // counterclockwise in the chart is so from outside
    for (const Triangle& t : triangles)
    {
      this->AddTriangle(t[0], t[1], t[2], SkullImplantFace::Outer);
      this->AddTriangle(n + t[0], n + t[2], n + t[1], SkullImplantFace::Inner);
    }
    for (const std::vector<std::int32_t>& edge : edges)
    {
      for (std::size_t k = 0; k < edge.size(); ++k)
      {
        const std::int32_t a = edge[k];
        const std::int32_t b = edge[(k + 1) % edge.size()];
        this->AddTriangle(a, n + a, n + b, SkullImplantFace::Edge);
        this->AddTriangle(a, n + b, b, SkullImplantFace::Edge);
      }
    }
  }

  void AddTriangle(std::int32_t a, std::int32_t b, std::int32_t c, SkullImplantFace face)
  {
    this->Implant.Triangles.push_back({ a, b, c });
    this->Implant.Faces.push_back(face);
  }

  //----------------------------------------------------------------------------
  // Of a coarse grid, linear between its nodes.
  void AddErrors()
  {
    const PlanarGrid grid = MakeGrid(this->Feet, ErrorSpacing, ErrorSpacing);
    struct Cell
    {
      std::int64_t Node;
      double X;
      double Y;
    };
    std::vector<Cell> cells;
    std::vector<int> used(static_cast<std::size_t>(grid.Columns * grid.Rows), -1);
    std::vector<Vec2> points;
    for (const Vec2& p : this->Feet)
    {
      const double x = (p[0] - grid.Origin[0]) / ErrorSpacing;
      const double y = (p[1] - grid.Origin[1]) / ErrorSpacing;
      const auto i = static_cast<std::int64_t>(x);
      const auto j = static_cast<std::int64_t>(y);
      cells.push_back(
        { i + grid.Columns * j, x - static_cast<double>(i), y - static_cast<double>(j) });
      for (const int m : { 0, 1 })
      {
        for (const int n : { 0, 1 })
        {
          const std::int64_t node = i + m + grid.Columns * (j + n);
          if (used[node] < 0)
          {
            used[node] = static_cast<int>(points.size());
            points.push_back(grid.GetNode(i + m, j + n));
          }
        }
      }
    }
    const std::vector<SkullEstimate> estimates =
      this->Shape.Predict(this->DirectionsOf(points), this->Run);
    SkullImplant& implant = this->Implant;
    const std::size_t count = this->Feet.size();
    implant.Errors.resize(2 * count);
    implant.ThicknessErrors.resize(2 * count);
    for (std::size_t k = 0; k < count; ++k)
    {
      const Cell& cell = cells[k];
      double error = 0;
      double thickness = 0;
      for (const int m : { 0, 1 })
      {
        for (const int n : { 0, 1 })
        {
          const SkullEstimate& e = estimates[used[cell.Node + m + grid.Columns * n]];
          const double weight = (m ? cell.X : 1 - cell.X) * (n ? cell.Y : 1 - cell.Y);
          error += weight * e.OuterError;
          thickness += weight * e.ThicknessError;
        }
      }
      implant.Errors[k] = implant.Errors[count + k] = error;
      implant.ThicknessErrors[k] = implant.ThicknessErrors[count + k] = thickness;
      if (error > implant.LargestError)
      {
        implant.LargestError = error;
        implant.LargestErrorPoint = implant.Points[k];
      }
    }
  }

  void Measure()
  {
    SkullImplant& implant = this->Implant;
    double square = 0;
    for (std::size_t t = 0; t < implant.Triangles.size(); ++t)
    {
      const Triangle& triangle = implant.Triangles[t];
      const Vec3 a = implant.Points[triangle[0]] - this->Rays.Center;
      const Vec3 b = implant.Points[triangle[1]] - this->Rays.Center;
      const Vec3 c = implant.Points[triangle[2]] - this->Rays.Center;
      implant.Volume += Dot(a, Cross(b, c)) / 6;
      if (implant.Faces[t] == SkullImplantFace::Outer)
      {
        const double area = 0.5 * Norm(Cross(b - a, c - a));
        implant.OuterArea += area;
        for (const std::int32_t corner : triangle)
        {
          implant.DoubtfulArea +=
            area / 3 * std::erfc(1 / (std::sqrt(2.0) * implant.Errors[corner]));
          square += area / 3 * implant.Errors[corner] * implant.Errors[corner];
        }
      }
    }
    implant.ErrorRMS = std::sqrt(square / implant.OuterArea);
  }

  // By the ratio of areas in the chart: the surface goes on evenly over the clearance.
  void SetHoleArea(const std::vector<Loop>& hole)
  {
    this->Implant.HoleArea = this->Implant.OuterArea * GetArea(hole) / this->OutlineArea;
  }

  // The direction that is farthest from all walls: each wall that is nearest turns it a little.
  void FindInsertion(const std::vector<Loop>& outline)
  {
    std::vector<Vec3> walls; // unit normals, into the implant
    Vec3 out{ 0, 0, 0 };
    std::size_t first = 0;
    for (const Loop& loop : outline)
    {
      for (std::size_t k = 0; k < loop.size(); ++k)
      {
        const Vec3 here = this->Implant.Points[first + k] - this->Rays.Center;
        const Vec3 next = this->Implant.Points[first + (k + 1) % loop.size()] - this->Rays.Center;
        walls.push_back(Normalized(Cross(here, next)));
        out = out + Normalized(here);
      }
      first += loop.size();
    }
    out = Normalized(out);
    Vec3 best = out;
    double bestTaper = -1;
    for (int step = 0; step < InsertionSteps; ++step)
    {
      const auto nearest = std::min_element(walls.begin(), walls.end(),
        [&](const Vec3& a, const Vec3& b) { return Dot(a, out) < Dot(b, out); });
      const double taper = Dot(*nearest, out);
      if (taper > bestTaper)
      {
        bestTaper = taper;
        best = out;
      }
      out = Normalized(out + (0.5 / (step + 2)) * *nearest);
    }
    this->Implant.InsertionDirection = -1 * best;
    this->Implant.LeastTaper = std::asin(std::clamp(bestTaper, -1.0, 1.0)) * 180 / Pi;
  }

  const VoxelVolume& Volume;
  const SkullRays& Rays;
  const SkullShape& Shape;
  const SkullImplantOptions& Options;
  Execution& Run;
  Chart Plane;
  std::vector<Vec2> Defect;
  PlanarGrid Grid;
  std::vector<double> Free;  // of each node; positive where no bone is
  std::vector<double> Inner; // radius of the inner surface; 0 away from the defect
  std::vector<Vec2> Feet;    // of the outer points, then of the inner ones
  double OutlineArea = 0;
  SkullImplant Implant;
};
}

//------------------------------------------------------------------------------
SkullImplant MakeSkullImplant(const VoxelVolume& volume, const SkullRays& rays,
  const std::vector<int>& defect, const SkullShape& shape, const SkullImplantOptions& options,
  Execution& execution)
{
  if (defect.empty())
  {
    throw std::invalid_argument("there is no defect to fill");
  }
  if (!(options.EdgeClearance >= 0 && options.EdgeClearance <= 5))
  {
    throw std::invalid_argument("EdgeClearance is " + FormatNumber(options.EdgeClearance) +
      " mm; it must be between 0 and 5");
  }
  if (!(options.TriangleSize >= 0.2 && options.TriangleSize <= 5))
  {
    throw std::invalid_argument("TriangleSize is " + FormatNumber(options.TriangleSize) +
      " mm; it must be between 0.2 and 5");
  }
  const Execution::NestedStages nested(execution);
  execution.SetStage(0, 0.05);
  return Builder(volume, rays, defect, shape, options, execution).Make();
}
}
