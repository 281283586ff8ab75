// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaImplantSpace.h"

#include "lacunaParameterText.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <utility>

namespace lacuna
{
namespace
{
constexpr double GridSpacing = 0.4; // mm of the map in which the free space is found
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
constexpr double Beside = 3;     // mm of the surfaces beside the hole, for walls that open outwards
constexpr double WallReach = 5;  // mm from the outline, within which its wall is
constexpr double WallFace = 0.8; // cosine between wall and surface: the bone is a table, no wall
constexpr std::size_t WallSmoothing = 4; // mm on either side
constexpr std::int64_t Sparse = 8;       // nodes between those from which the free space is sought
constexpr double Interesting = 2.5;      // mm of clearance: nodes around may have less
constexpr double ThickEnough = 1.01;     // of the least thickness

Chart MakeChart(const SkullRays& rays, const std::vector<int>& defect, const SkullShape& shape,
  Execution& execution)
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

// Unit, of the outer surface, by the nodes beside one.
Vec3 GetNormalOf(const ImplantSlab& slab, std::int64_t node, const Vec3& direction)
{
  const auto count = static_cast<std::int64_t>(slab.Outer.size());
  const auto along = [&](std::int64_t step)
  {
    const bool before = node - step >= 0 && slab.IsKnown[node - step];
    const bool after = node + step < count && slab.IsKnown[node + step];
    return slab.Outer[after ? node + step : node] - slab.Outer[before ? node - step : node];
  };
  const Vec3 normal = Cross(along(1), along(slab.Grid.Columns));
  return HasDirection(normal) ? Normalized(normal) : direction;
}
}

//------------------------------------------------------------------------------
PartBone::PartBone(const BoneDistance& bone, const Vec3& axis, double low, double high)
  : Bone(bone)
  , Axis(axis)
  , Low(low)
  , High(high)
{
}

//------------------------------------------------------------------------------
double PartBone::GetDistanceOfCuts(const Vec3& x) const
{
  const double along = Dot(x, this->Axis);
  return std::min(along - this->Low, this->High - along);
}

//------------------------------------------------------------------------------
NearestBone PartBone::Find(const Vec3& x, double limit) const
{
  const NearestBone bone = this->Bone.Find(x, limit);
  const double cut = this->GetDistanceOfCuts(x);
  if (cut >= bone.Distance)
  {
    return bone;
  }
  if (cut <= -limit)
  {
    return { -limit, x };
  }
  const double along = Dot(x, this->Axis);
  const double shift = along - this->Low < this->High - along ? -cut : cut;
  return { cut, x + shift * this->Axis };
}

//------------------------------------------------------------------------------
ImplantSpace::ImplantSpace(const VoxelVolume& volume, const SkullRays& rays,
  const std::vector<int>& defect, const SkullShape& shape, const BoneDistance& bone,
  const SkullImplantOptions& options, Execution& execution)
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

//------------------------------------------------------------------------------
std::vector<Vec3> ImplantSpace::DirectionsOf(const std::vector<Vec2>& points) const
{
  std::vector<Vec3> directions;
  directions.reserve(points.size());
  for (const Vec2& p : points)
  {
    directions.push_back(this->Plane.ToDirection(p));
  }
  return directions;
}

//------------------------------------------------------------------------------
Vec3 ImplantSpace::PointAt(const Vec3& direction, double radius) const
{
  return this->Rays.Center + radius * direction;
}

//------------------------------------------------------------------------------
std::vector<Loop> ImplantSpace::FindHole()
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
    this->Warnings.push_back(
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
      this->Warnings.push_back("bone divides the hole: a part of " +
        FormatNumber(std::round(static_cast<double>(parts[p].size()) * nodeArea / 100)) +
        " cm^2 is left out");
    }
  }
  return KeepLargest(FindContours(this->Grid, this->Free, 0));
}

//------------------------------------------------------------------------------
bool ImplantSpace::IsInScan(const Vec3& x) const
{
  const Vec3 index = this->WorldToIndex.Point(x);
  bool isIn = true;
  for (int a = 0; a < 3; ++a)
  {
    isIn = isIn && index[a] >= 0 && index[a] <= this->Volume.Size[a] - 1;
  }
  return isIn;
}

//------------------------------------------------------------------------------
void ImplantSpace::SetSlab(const std::vector<std::int64_t>& nodes)
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
    const Vec3 normal = GetNormalOf(slab, node, directions[k]);
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
  this->SetSteps();
}

//------------------------------------------------------------------------------
void ImplantSpace::SetSteps()
{
  double most = 0;
  for (std::size_t node = 0; node < this->Slab.Outer.size(); ++node)
  {
    most = std::max(most, Norm(this->Slab.Outer[node] - this->Slab.Inner[node]));
  }
  this->Slab.Steps = std::max(ImplantSlab{}.Steps, static_cast<int>(std::ceil(most / MostStep)));
}

//------------------------------------------------------------------------------
double ImplantSpace::FindUnknownArea() const
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

//------------------------------------------------------------------------------
std::vector<Loop> ImplantSpace::MoveInwards(const std::vector<Loop>& hole)
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

//------------------------------------------------------------------------------
std::vector<Loop> ImplantSpace::WithoutTongues(std::vector<double> distances, double limit)
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
    this->Warnings.push_back("the hole has parts that are narrower than " +
      FormatNumber(2 * (this->Options.EdgeClearance + LeastRadius)) +
      " mm, or that are behind such: " + FormatNumber(std::round(without / 10) / 10) +
      " cm^2 are left out");
  }
  return outline;
}

//------------------------------------------------------------------------------
std::vector<std::vector<Vec3>> ImplantSpace::OnInner(const std::vector<Loop>& loops) const
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

//------------------------------------------------------------------------------
Vec3 ImplantSpace::FindWall(const Vec2& p, double depth) const
{
  const Vec3 x = this->Slab.GetPoint(p, depth);
  const NearestBone bone = this->Bone.Find(x, WallReach);
  const Vec3 wall = Normalized(x - bone.Point);
  const bool isWall = bone.Distance > 0 && bone.Distance < WallReach &&
    std::abs(Dot(wall, this->Slab.GetNormal(p))) < WallFace;
  return isWall ? wall : Vec3{ 0, 0, 0 };
}

//------------------------------------------------------------------------------
Vec3 ImplantSpace::ChooseDirection(const std::vector<Loop>& outline) const
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

//------------------------------------------------------------------------------
std::vector<double> ImplantSpace::FindFreeWays(const InsertionPath& path) const
{
  std::vector<double> free(this->Free.size(), -FarFromRim);
  std::vector<bool> wanted(free.size(), false);
  const double edge = std::max(1.0, this->Options.EdgeClearance + 0.5);
  std::vector<std::int64_t> nodes;
  for (std::int64_t node = 0; node < static_cast<std::int64_t>(free.size()); ++node)
  {
    const bool isSparse =
      node % this->Grid.Columns % Sparse == 0 && node / this->Grid.Columns % Sparse == 0;
    const bool isHole = this->Free[node] > 0;
    free[node] = isHole ? path.GetLimit() : -FarFromRim;
    const bool isNearEdge = this->FromHole[node] > -1 && this->FromHole[node] < edge;
    if (this->Slab.IsKnown[node] && (isNearEdge || (isHole && isSparse)))
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
          double least = path.GetLimit();
          for (int level = 0; level <= this->Slab.Steps && least > -1; ++level)
          {
            const double depth = this->Slab.DepthOf(level);
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

//------------------------------------------------------------------------------
std::vector<Loop> ImplantSpace::FindOutline(const std::vector<double>& free)
{
  return this->WithoutTongues(free, 0);
}

//------------------------------------------------------------------------------
std::vector<double> ImplantSpace::FindPart(
  std::vector<double> free, const PartBone& cuts, double clearance) const
{
  for (std::size_t node = 0; node < free.size(); ++node)
  {
    for (const double depth : { 0.0, 1.0 })
    {
      if (this->Slab.IsKnown[node])
      {
        const Vec3 x = (1 - depth) * this->Slab.Outer[node] + depth * this->Slab.Inner[node];
        free[node] = std::min(free[node], cuts.GetDistanceOfCuts(x) - clearance);
      }
    }
  }
  return free;
}

//------------------------------------------------------------------------------
void ImplantSpace::Offset(const std::vector<Loop>& hole)
{
  const double outer = this->Options.OuterOffset;
  const double inner = this->Options.InnerOffset;
  if (outer == 0 && inner == 0)
  {
    return;
  }
  std::vector<std::vector<Vec3>> curves;
  for (const Loop& loop : hole)
  {
    curves.emplace_back();
    for (const Vec2& p : loop)
    {
      curves.back().push_back(this->Slab.GetPoint(p, 0));
    }
  }
  const CurveIndex rim(curves, 2);
  const ImplantSlab before = this->Slab;
  const double fade = this->Options.OffsetFade;
  const double least = ThickEnough * this->Options.MinimumThickness;
  this->Run.For(static_cast<std::int64_t>(this->Free.size()), 256,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t node = begin; node < end; ++node)
      {
        if (!before.IsKnown[node] || !(this->Free[node] > 0))
        {
          continue;
        }
        const Vec3& x = before.Outer[node];
        const double t = fade > 0 ? rim.Find(x, fade).Distance / fade : 1;
        const double part = t * t * t * (t * (6 * t - 15) + 10); // even to its second slope
        const Vec3 normal = GetNormalOf(before, node, Normalized(x - this->Rays.Center));
        this->Slab.Outer[node] = x + part * outer * normal;
        const Vec3 below = before.Inner[node] + part * inner * normal;
        const Vec3 way = below - this->Slab.Outer[node];
        this->Slab.Inner[node] =
          Dot(way, normal) > -least ? below - (least + Dot(way, normal)) * normal : below;
      }
    });
  this->SetSteps();
}
}
