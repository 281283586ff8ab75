// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSkullImplant.h"

#include "lacunaImplantEdge.h"
#include "lacunaParameterText.h"
#include "lacunaPlanarCurves.h"
#include "lacunaPlanarLattice.h"
#include "lacunaSkullChart.h"

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
constexpr double Beside = 3;     // mm of the surfaces beside the hole, for walls that open outwards
constexpr double WallReach = 5;  // mm from the outline, within which its wall is
constexpr double WallFace = 0.8; // cosine between wall and surface: the bone is a table, no wall
constexpr std::size_t WallSmoothing = 4; // mm on either side
constexpr std::int64_t Sparse = 8;       // nodes between those from which the free space is sought
constexpr double Interesting = 2.5;      // mm of clearance: nodes around may have less
constexpr double ThickEnough = 1.01;     // of the least thickness

class Builder
{
public:
  Builder(const VoxelVolume& volume, const SkullRays& rays, const std::vector<int>& defect,
    const SkullShape& shape, const BoneDistance& bone, const SkullImplantOptions& options,
    Execution& execution)
    : Volume(volume)
    , WorldToIndex(volume.IndexToWorld.Inverse())
    , Rays(rays)
    , Shape(shape)
    , Bone(bone)
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
    this->Run.SetStage(0.25, 0.3);
    std::vector<Loop> outline = this->MoveInwards(hole);
    this->Run.SetStage(0.3, 0.5);
    const InsertionPath path(this->Bone, this->ChooseDirection(outline));
    outline = this->WithoutTongues(this->FindFreeWays(path), 0);
    if (outline.empty())
    {
      throw std::runtime_error(
        "no implant can be put in along this direction: bone is above all of "
        "the hole. Give another direction");
    }
    for (Loop& loop : outline)
    {
      loop = Resample(loop, 0.5 * this->Options.TriangleSize);
    }
    this->Run.SetStage(0.5, 0.55);
    const ImplantEdge edge =
      FollowWall(this->Slab, this->Bone, path, outline, this->Options.EdgeClearance, this->Run);
    this->Run.SetStage(0.55, 0.6);
    this->AddMesh(edge);
    this->Run.SetStage(0.6, 0.95);
    this->AddErrors();
    this->Run.SetStage(0.95, 1);
    this->Measure();
    this->MeasureThickness();
    this->SetHoleArea(hole, edge.Levels[0]);
    this->SetInsertion(edge, path);
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
    const double reach = near + Beside;
    this->Grid = MakeGrid(this->Defect, reach + 2 * GridSpacing, GridSpacing);
    const std::vector<double> away = FindDistances(this->Grid, this->Defect, 2 * reach);
    std::vector<std::int64_t> nodes;
    for (std::size_t k = 0; k < away.size(); ++k)
    {
      if (away[k] < reach + 2 * GridSpacing)
      {
        nodes.push_back(static_cast<std::int64_t>(k));
      }
    }
    this->SetSlab(nodes);
    this->Run.SetStage(0.2, 0.25);
    std::vector<RaySegment> segments;
    for (const std::int64_t node : nodes)
    {
      const Vec3 outer = this->Slab.Outer[node] - this->Rays.Center;
      const double inner = Norm(this->Slab.Inner[node] - this->Rays.Center);
      const double clearance = this->Options.EdgeClearance;
      segments.push_back(
        { Normalized(outer), std::max(inner - clearance, 1.0), Norm(outer) + clearance });
    }
    const std::vector<double> largest =
      FindLargestAlong(this->Volume, this->Rays.Center, segments, this->Run);
    this->Free.assign(away.size(), -1);
    for (std::size_t k = 0; k < nodes.size(); ++k)
    {
      this->Free[nodes[k]] =
        std::clamp((this->Options.Level - largest[k]) / ValueScale, -reach, near - away[nodes[k]]);
      this->Slab.IsKnown[nodes[k]] =
        largest[k] < Infinity && this->IsInScan(this->Slab.Outer[nodes[k]]);
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

  bool IsInScan(const Vec3& x) const
  {
    const Vec3 index = this->WorldToIndex.Point(x);
    bool isIn = true;
    for (int a = 0; a < 3; ++a)
    {
      isIn = isIn && index[a] >= 0 && index[a] <= this->Volume.Size[a] - 1;
    }
    return isIn;
  }

  // Both surfaces at some nodes.
  void SetSlab(const std::vector<std::int64_t>& nodes)
  {
    std::vector<Vec2> points;
    for (const std::int64_t node : nodes)
    {
      points.push_back(this->Grid.GetNode(node % this->Grid.Columns, node / this->Grid.Columns));
    }
    const std::vector<Vec3> directions = this->DirectionsOf(points);
    const std::vector<SkullEstimate> shape = this->Shape.PredictSurfaces(directions, this->Run);
    const auto count = static_cast<std::size_t>(this->Grid.Columns * this->Grid.Rows);
    ImplantSlab& slab = this->Slab;
    slab.Grid = this->Grid;
    slab.IsKnown.assign(count, false);
    slab.Outer.assign(count, Vec3{ 0, 0, 0 });
    for (std::size_t k = 0; k < nodes.size(); ++k)
    {
      slab.IsKnown[nodes[k]] = true;
      slab.Outer[nodes[k]] = this->PointAt(directions[k], shape[k].Outer);
    }
    slab.Inner = slab.Outer;
    for (std::size_t k = 0; k < nodes.size(); ++k)
    {
      const std::int64_t node = nodes[k];
      const Vec3 normal = this->GetNormal(node, directions[k]);
      const double least = ThickEnough * this->Options.MinimumThickness;
      if (this->Options.Thickness > 0)
      {
        slab.Inner[node] = slab.Outer[node] - std::max(this->Options.Thickness, least) * normal;
        continue;
      }
      const double cosine = std::max(Dot(normal, directions[k]), 0.3);
      const double inner = shape[k].Outer - std::max(shape[k].Thickness, least / cosine);
      if (!(inner > 1))
      {
        throw std::runtime_error("the inner surface reaches the middle of the skull");
      }
      slab.Inner[node] = this->PointAt(directions[k], inner);
    }
  }

  // Of the outer surface, by the nodes beside one.
  Vec3 GetNormal(std::int64_t node, const Vec3& direction) const
  {
    const ImplantSlab& slab = this->Slab;
    const auto count = static_cast<std::int64_t>(slab.Outer.size());
    const auto along = [&](std::int64_t step)
    {
      const bool before = node - step >= 0 && slab.IsKnown[node - step];
      const bool after = node + step < count && slab.IsKnown[node + step];
      return slab.Outer[after ? node + step : node] - slab.Outer[before ? node - step : node];
    };
    const Vec3 normal = Cross(along(1), along(this->Grid.Columns));
    return HasDirection(normal) ? Normalized(normal) : direction;
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
            if (this->Slab.IsKnown[node])
            {
              const double distance = rim.Find(this->Slab.Inner[node], limit).Distance;
              distances[node] = this->Free[node] > 0 ? distance : -distance;
            }
          }
        }
      });
    this->FromHole = distances;
    std::vector<Loop> outline =
      this->WithoutTongues(std::move(distances), this->Options.EdgeClearance);
    if (outline.empty())
    {
      throw std::runtime_error("the hole is nowhere wider than " +
        FormatNumber(2 * (this->Options.EdgeClearance + LeastRadius)) +
        " mm: it may be a gap in thin bone, which this level does not show");
    }
    return outline;
  }

  // The outline where distances are a limit, without what is narrow (an opening). Empty: nothing is wide.
  std::vector<Loop> WithoutTongues(std::vector<double> distances, double limit)
  {
    const std::vector<Loop> core =
      KeepLargest(FindContours(this->Grid, distances, limit + LeastRadius));
    if (core.empty())
    {
      return {};
    }
    const double before = GetArea(KeepLargest(FindContours(this->Grid, distances, limit)));
    const CurveIndex edge(this->OnInner(core), 2);
    const double reach = LeastRadius + Slack;
    this->Run.For(this->Grid.Rows, 8,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t j = begin; j < end; ++j)
        {
          for (std::int64_t i = 0; i < this->Grid.Columns; ++i)
          {
            const std::int64_t node = i + this->Grid.Columns * j;
            double& distance = distances[node];
            if (distance > limit && !IsInside(core, this->Grid.GetNode(i, j)))
            {
              distance = std::min(
                distance, limit + reach - edge.Find(this->Slab.Inner[node], 2 * reach).Distance);
            }
          }
        }
      });
    std::vector<Loop> outline = KeepLargest(FindContours(this->Grid, distances, limit));
    const double without = before - GetArea(outline);
    if (without > LeastPart && limit > 0)
    {
      this->Implant.Warnings.push_back("the hole has parts that are narrower than " +
        FormatNumber(2 * (this->Options.EdgeClearance + LeastRadius)) +
        " mm, or that are behind such: " + FormatNumber(std::round(without / 10) / 10) +
        " cm^2 are left out");
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
        curves.back().push_back(this->Slab.GetPoint(p, 1));
      }
    }
    return curves;
  }

  //----------------------------------------------------------------------------
  // Unit, out of the wall of bone beside a place of the outline; zero where there is none.
  Vec3 FindWall(const Vec2& p, double depth) const
  {
    const Vec3 x = this->Slab.GetPoint(p, depth);
    const NearestBone bone = this->Bone.Find(x, WallReach);
    const Vec3 wall = Normalized(x - bone.Point);
    const bool isWall = bone.Distance > 0 && bone.Distance < WallReach &&
      std::abs(Dot(wall, this->Slab.GetNormal(p))) < WallFace;
    return isWall ? wall : Vec3{ 0, 0, 0 };
  }

  // The way in: as given, or that of the walls of bone along an outline.
  Vec3 ChooseDirection(const std::vector<Loop>& outline) const
  {
    Vec3 in{ 0, 0, 0 };
    std::vector<Vec3> walls;
    for (const Loop& loop : outline)
    {
      const Loop places = Resample(loop, 1);
      for (const Vec2& p : places)
      {
        in = in - this->Slab.GetNormal(p);
      }
      for (const double depth : { 0.35, 0.5, 0.65 }) // away from rounded edges
      {
        std::vector<Vec3> found;
        for (const Vec2& p : places)
        {
          found.push_back(this->FindWall(p, depth));
        }
        const std::size_t n = found.size();
        for (std::size_t k = 0; k < n; ++k)
        {
          Vec3 sum{ 0, 0, 0 }; // single places of rough bone do not decide
          for (std::size_t r = 0; r <= 2 * WallSmoothing; ++r)
          {
            sum = sum + found[(k + n + r - std::min(WallSmoothing, n)) % n];
          }
          if (Norm(sum) > WallSmoothing)
          {
            walls.push_back(Normalized(sum));
          }
        }
      }
    }
    const Vec3& given = this->Options.InsertionDirection;
    return HasDirection(given) ? Normalized(given) : FindInsertionDirection(walls, in);
  }

  // Of each node the least clearance of both surfaces and what is between them, on the way out, without EdgeClearance.
  std::vector<double> FindFreeWays(const InsertionPath& path) const
  {
    std::vector<double> free(this->Free.size(), -FarFromRim);
    std::vector<bool> wanted(free.size(), false);
    std::vector<std::int64_t> nodes;
    for (std::int64_t node = 0; node < static_cast<std::int64_t>(free.size()); ++node)
    {
      const bool isSparse =
        node % this->Grid.Columns % Sparse == 0 && node / this->Grid.Columns % Sparse == 0;
      const bool isHole = this->Free[node] > 0;
      free[node] = isHole ? InsertionPath::Limit : -FarFromRim;
      if (this->Slab.IsKnown[node] && (std::abs(this->FromHole[node]) < 1 || (isHole && isSparse)))
      {
        nodes.push_back(node);
        wanted[node] = true;
      }
    }
    while (!nodes.empty())
    {
      this->Run.For(static_cast<std::int64_t>(nodes.size()), 64,
        [&](std::int64_t begin, std::int64_t end)
        {
          for (std::int64_t k = begin; k < end; ++k)
          {
            double least = InsertionPath::Limit;
            for (int level = 0; level <= WallSteps && least > -1; ++level)
            {
              const double depth = static_cast<double>(level) / WallSteps;
              const Vec3 x =
                (1 - depth) * this->Slab.Outer[nodes[k]] + depth * this->Slab.Inner[nodes[k]];
              least = std::min(least, path.GetClearance(x) - this->Options.EdgeClearance);
            }
            free[nodes[k]] = least;
          }
        });
      std::vector<std::int64_t> next;
      for (const std::int64_t node : nodes)
      {
        for (const std::int64_t step :
          { std::int64_t{ -1 }, std::int64_t{ 1 }, -this->Grid.Columns, this->Grid.Columns })
        {
          const std::int64_t other = node + step; // nodes at the border are not known
          if (free[node] > -1 && free[node] < Interesting && this->Slab.IsKnown[other] &&
            !wanted[other])
          {
            wanted[other] = true;
            next.push_back(other);
          }
        }
      }
      nodes = std::move(next);
    }
    return free;
  }

  //----------------------------------------------------------------------------
  // Points of both surfaces are those of the slab.
  void AddMesh(const ImplantEdge& edge)
  {
    std::vector<std::vector<std::int32_t>> rings; // level by level, loop by loop
    for (int level = 0; level <= WallSteps; ++level)
    {
      for (const Loop& loop : edge.Levels[level])
      {
        rings.emplace_back();
        for (const Vec2& p : loop)
        {
          rings.back().push_back(this->AddPoint(p, static_cast<double>(level) / WallSteps));
        }
      }
    }
    const std::size_t loops = edge.Levels[0].size();
    this->AddFace(edge.Levels.front(), &rings[0], SkullImplantFace::Outer);
    this->AddFace(edge.Levels.back(), &rings[WallSteps * loops], SkullImplantFace::Inner);
    for (std::size_t r = 0; r < WallSteps * loops; ++r)
    {
      const std::vector<std::int32_t>& upper = rings[r];
      const std::vector<std::int32_t>& lower = rings[r + loops];
      for (std::size_t k = 0; k < upper.size(); ++k)
      {
        const std::size_t next = (k + 1) % upper.size();
        this->AddTriangle(upper[k], lower[k], lower[next], SkullImplantFace::Edge);
        this->AddTriangle(upper[k], lower[next], upper[next], SkullImplantFace::Edge);
      }
    }
  }

  std::int32_t AddPoint(const Vec2& p, double depth)
  {
    this->Feet.push_back(p);
    this->Implant.Points.push_back(this->Slab.GetPoint(p, depth));
    this->Implant.Thickness.push_back(Norm(this->Slab.GetPoint(p, 0) - this->Slab.GetPoint(p, 1)));
    return static_cast<std::int32_t>(this->Feet.size()) - 1;
  }

  // rings: points of the loops.
  void AddFace(
    const std::vector<Loop>& loops, const std::vector<std::int32_t>* rings, SkullImplantFace face)
  {
    const double h = this->Options.TriangleSize;
    const bool isOuter = face == SkullImplantFace::Outer;
    Loop feet;
    std::vector<std::int32_t> points;
    std::vector<std::vector<std::int32_t>> edges;
    for (std::size_t l = 0; l < loops.size(); ++l)
    {
      edges.emplace_back();
      for (std::size_t k = 0; k < loops[l].size(); ++k)
      {
        edges.back().push_back(static_cast<std::int32_t>(feet.size()));
        feet.push_back(loops[l][k]);
        points.push_back(rings[l][k]);
      }
    }
    for (const Vec2& p : FillWithLattice(this->Run, loops, h, LatticeToRim * h))
    {
      feet.push_back(p);
      points.push_back(this->AddPoint(p, isOuter ? 0 : 1));
    }
    // counterclockwise in the chart is so from outside
    for (const Triangle& t : TriangulateRegion(feet, edges))
    {
      this->AddTriangle(points[t[0]], points[t[isOuter ? 1 : 2]], points[t[isOuter ? 2 : 1]], face);
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
    implant.Errors.resize(count);
    implant.ThicknessErrors.resize(count);
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
      implant.Errors[k] = error;
      implant.ThicknessErrors[k] = thickness;
      if (error > implant.LargestError)
      {
        implant.LargestError = error;
        implant.LargestErrorPoint = this->Slab.GetPoint(this->Feet[k], 0);
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
  void SetHoleArea(const std::vector<Loop>& hole, const std::vector<Loop>& outline)
  {
    double length = 0;
    for (const Loop& loop : outline)
    {
      for (std::size_t k = 0; k < loop.size(); ++k)
      {
        const Vec2& next = loop[(k + 1) % loop.size()];
        length += std::hypot(next[0] - loop[k][0], next[1] - loop[k][1]);
      }
    }
    const double area = GetArea(outline);
    const double whole = std::max(GetArea(hole), area + this->Options.EdgeClearance * length);
    this->Implant.HoleArea = this->Implant.OuterArea * whole / area;
  }

  // Of the points of one face that are not at the edge, the least distance to the triangles of the other.
  void MeasureThickness()
  {
    SkullImplant& implant = this->Implant;
    TriangleSurface inner;
    inner.Points = implant.Points;
    std::vector<bool> isOuter(implant.Points.size(), false);
    for (std::size_t t = 0; t < implant.Triangles.size(); ++t)
    {
      if (implant.Faces[t] == SkullImplantFace::Inner)
      {
        inner.Triangles.push_back(implant.Triangles[t]);
      }
      for (const std::int32_t corner : implant.Triangles[t])
      {
        isOuter[corner] = isOuter[corner] || implant.Faces[t] == SkullImplantFace::Outer;
      }
    }
    std::vector<std::size_t> points;
    for (std::size_t k = 0; k < isOuter.size(); ++k)
    {
      if (isOuter[k])
      {
        points.push_back(k);
      }
    }
    const TriangleBone face(std::move(inner), [](const Vec3&) { return false; });
    std::vector<double> distances(points.size());
    this->Run.For(static_cast<std::int64_t>(points.size()), 256,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t k = begin; k < end; ++k)
        {
          const Vec3& x = implant.Points[points[k]];
          distances[k] = face.Find(x, 1.1 * implant.Thickness[points[k]] + 0.1).Distance;
        }
      });
    const auto least = std::min_element(distances.begin(), distances.end());
    implant.MinimumThickness = *least;
    implant.ThinnestPoint = implant.Points[points[least - distances.begin()]];
  }

  void SetInsertion(const ImplantEdge& edge, const InsertionPath& path)
  {
    SkullImplant& implant = this->Implant;
    implant.InsertionDirection = path.GetDirection();
    implant.LeastTaper = edge.LeastTaper;
    implant.UndercutVolume = edge.UndercutVolume;
    implant.UndercutWidth = edge.UndercutWidth;
    implant.UndercutPoint = edge.UndercutPoint;
    std::vector<double> clearances(implant.Points.size());
    this->Run.For(static_cast<std::int64_t>(clearances.size()), 256,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t k = begin; k < end; ++k)
        {
          clearances[k] = path.GetClearance(implant.Points[k]);
        }
      });
    implant.InsertionClearance = *std::min_element(clearances.begin(), clearances.end());
  }

  const VoxelVolume& Volume;
  Matrix4 WorldToIndex;
  const SkullRays& Rays;
  const SkullShape& Shape;
  const BoneDistance& Bone;
  const SkullImplantOptions& Options;
  Execution& Run;
  Chart Plane;
  std::vector<Vec2> Defect;
  PlanarGrid Grid;
  ImplantSlab Slab;
  std::vector<double> Free; // of each node; positive where no bone is
  std::vector<double>
    FromHole;             // the same: mm from the rim on the inner surface, positive in the hole
  std::vector<Vec2> Feet; // of the implant's points
  SkullImplant Implant;
};
}

//------------------------------------------------------------------------------
SkullImplant MakeSkullImplant(const VoxelVolume& volume, const SkullRays& rays,
  const std::vector<int>& defect, const SkullShape& shape, const BoneDistance& bone,
  const SkullImplantOptions& options, Execution& execution)
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
  if (!(options.Thickness == 0 || (options.Thickness >= 0.5 && options.Thickness <= 20)))
  {
    throw std::invalid_argument("Thickness is " + FormatNumber(options.Thickness) +
      " mm; it must be 0 (that of bone) or between 0.5 and 20");
  }
  if (!(options.MinimumThickness >= 0 && options.MinimumThickness <= 10))
  {
    throw std::invalid_argument("MinimumThickness is " + FormatNumber(options.MinimumThickness) +
      " mm; it must be between 0 and 10");
  }
  const Execution::NestedStages nested(execution);
  execution.SetStage(0, 0.05);
  return Builder(volume, rays, defect, shape, bone, options, execution).Make();
}
}
