// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSkullRays.h"

#include "lacunaSkullChart.h"

#include "lacunaPlanarCurves.h"
#include "lacunaSkullEllipsoid.h"
#include "lacunaSymmetricFactorization.h"
#include "lacunaVoxelSampler.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <utility>

namespace lacuna
{
namespace
{
constexpr double Pi = 3.14159265358979323846;
constexpr double NotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr double TypicalRadius = 90; // mm
// A sound table: how far from the median of the rays around, their range, bone's thickness; mm.
constexpr double MostStep = 2.5;
constexpr double MostRange = 8;
constexpr double SoundThickness = 14;
// Of the fitted ellipsoid's radius: where a skull's bone is.
constexpr double MostDeviation = 0.17;
// The same: where the scan surely ends before the skull, and surely behind it.
constexpr double NearEnd[] = { 0.95, 1.05 };
constexpr double RoundedEdge = 1.5; // voxels
constexpr double NarrowPart = 20;   // mm: what opens into a defect and is none
// Of a defect's border, what is sound: without doubt, and after narrow parts are taken off.
constexpr double ClearBorder = 0.5;
constexpr double LeastBorder = 0.4;
constexpr std::size_t LeastSound = 100;

struct RayTables
{
  double Outer = NotANumber;
  double Inner = NotANumber;
  double Exit = 0;  ///< where the ray leaves the volume
  bool Cut = false; ///< there is bone where it leaves
};

template <class T>
RayTables FollowRay(const VoxelSampler<T>& sample, const Vec3& center, const Vec3& direction,
  double level, double step)
{
  RayTables tables;
  double before = NotANumber; // the value one step farther out
  const int steps = static_cast<int>(std::ceil((MostSkullRadius - LeastSkullRadius) / step));
  for (int s = steps; s >= 0; --s)
  {
    const double radius = LeastSkullRadius + s * step;
    if (radius < tables.Outer - MostBoneThickness)
    {
      break;
    }
    const double value = sample(center + radius * direction);
    const bool bone = value > level;
    if (tables.Exit == 0 && !std::isnan(value))
    {
      tables.Exit = radius;
      tables.Cut = bone;
    }
    const bool wasBone = before > level;
    const double crossing = radius + step * (value - level) / (value - before);
    if (bone && std::isnan(tables.Outer))
    {
      tables.Outer = std::isnan(before) ? radius : crossing;
    }
    if (!bone && wasBone)
    {
      tables.Inner = std::isnan(value) ? radius + step : crossing;
    }
    else if (bone)
    {
      tables.Inner = radius; // until it ends
    }
    before = value;
  }
  return tables;
}

// Directions are in the order of their third coordinate in some frame, which falls evenly from 1 to -1: those
// within an angle are no more than so many places away.
int GetBand(int count, double angle)
{
  return static_cast<int>(std::ceil(0.5 * count * angle)) + 1;
}

// Steps from the start to each ray for which may is true; -1 for all that they do not reach.
template <class May>
std::vector<int> CountSteps(
  const std::vector<std::vector<int>>& neighbors, std::vector<int> start, const May& may)
{
  std::vector<int> steps(neighbors.size(), -1);
  for (const int i : start)
  {
    steps[i] = 0;
  }
  for (std::size_t k = 0; k < start.size(); ++k)
  {
    for (const int other : neighbors[start[k]])
    {
      if (steps[other] < 0 && may(other))
      {
        steps[other] = steps[start[k]] + 1;
        start.push_back(other);
      }
    }
  }
  return steps;
}

// A part without what is narrower than 2 width steps (an orbit into which a defect opens), in pieces.
std::vector<std::vector<int>> WithoutNarrowParts(
  const std::vector<std::vector<int>>& neighbors, const std::vector<int>& part, int width)
{
  std::vector<bool> inPart(neighbors.size(), false);
  for (const int i : part)
  {
    inPart[i] = true;
  }
  const auto isInside = [&](int i) { return inPart[i]; };
  std::vector<int> outside;
  for (std::size_t i = 0; i < neighbors.size(); ++i)
  {
    if (!inPart[i])
    {
      outside.push_back(static_cast<int>(i));
    }
  }
  const std::vector<int> depth = CountSteps(neighbors, outside, isInside);
  std::vector<int> cores;
  std::copy_if(
    part.begin(), part.end(), std::back_inserter(cores), [&](int i) { return depth[i] > width; });
  // a step more than the border was moved by, for corners
  const std::vector<int> steps = CountSteps(neighbors, cores, isInside);
  return FindParts(neighbors, [&](int i) { return steps[i] >= 0 && steps[i] <= width + 1; });
}

std::vector<Vec3> PointsOf(const SkullRays& rays, const std::vector<int>& chosen)
{
  std::vector<Vec3> points;
  for (const int i : chosen)
  {
    points.push_back(rays.Center + rays.Outer[i] * rays.Directions[i]);
  }
  return points;
}

// Whether a ray meets bone that goes on smoothly all around it.
bool IsSmooth(const SkullRays& rays, int ray, const std::vector<int>& around)
{
  const double here = rays.Outer[ray];
  if (std::isnan(here) || here - rays.Inner[ray] >= SoundThickness || around.empty())
  {
    return false;
  }
  std::vector<double> others{ here };
  for (const int j : around)
  {
    if (std::isnan(rays.Outer[j]))
    {
      return false;
    }
    others.push_back(rays.Outer[j]);
  }
  std::sort(others.begin(), others.end());
  return others.back() - others.front() < MostRange &&
    std::abs(here - others[others.size() / 2]) < MostStep;
}

std::vector<RayTables> Follow(const VoxelVolume& volume, double level, const Vec3& center,
  const std::vector<Vec3>& directions, Execution& execution)
{
  CheckVolumeSize(volume.Size);
  if (!std::isfinite(level))
  {
    throw std::invalid_argument("the level of bone is not finite");
  }
  const auto n = static_cast<std::int64_t>(directions.size());
  std::vector<RayTables> tables(n);
  const double step = std::clamp(0.5 * SmallestEdgeOf(volume.IndexToWorld), 0.1, 1.0);
  DispatchScalars(volume.Type, volume.Voxels,
    [&](const auto* voxels)
    {
      const VoxelSampler sample(volume, voxels);
      if (std::isnan(sample(center)))
      {
        throw std::invalid_argument(
          "the middle of the skull is outside the volume: the scan shows too little of the vault. "
          "Take a scan of the whole vault, and check that the level is that of bone");
      }
      execution.For(n, 64,
        [&](std::int64_t begin, std::int64_t end)
        {
          for (std::int64_t i = begin; i < end; ++i)
          {
            tables[i] = FollowRay(sample, center, directions[i], level, step);
          }
        });
    });
  return tables;
}

// Sets the kinds of rays that have all else.
void Classify(SkullRays& rays, const std::vector<RayTables>& tables)
{
  const auto n = static_cast<int>(rays.Directions.size());
  const std::vector<std::vector<int>> around = FindNeighbors(rays.Directions, 1.6 * rays.Spacing);
  std::vector<bool> smooth(n);
  for (int i = 0; i < n; ++i)
  {
    smooth[i] = IsSmooth(rays, i, around[i]);
  }
  const std::vector<std::vector<int>> parts = FindParts(around, [&](int i) { return smooth[i]; });
  if (parts.empty() || parts[0].size() < LeastSound)
  {
    throw std::invalid_argument(
      "around the middle of what is bone there is too little of a smooth vault: the scan has to "
      "show the whole vault of the skull, and the level has to be that of bone");
  }
  // The vault's ellipsoid, then without what lies beside it.
  std::vector<int> vault = parts[0];
  SkullEllipsoid ellipsoid(rays.Center, PointsOf(rays, vault));
  for (const double limit : { MostDeviation, 0.7 * MostDeviation })
  {
    std::vector<int> inside;
    std::copy_if(vault.begin(), vault.end(), std::back_inserter(inside),
      [&](int i)
      { return std::abs(rays.Outer[i] / ellipsoid.GetRadius(rays.Directions[i]) - 1) < limit; });
    if (inside.size() < LeastSound)
    {
      break;
    }
    ellipsoid = SkullEllipsoid(rays.Center, PointsOf(rays, inside));
  }
  rays.Kinds.resize(n);
  // Where the scan may end before the skull does: the ellipsoid is not the skull. It does beside
  // where it surely does, such as at bone that is cut off.
  std::vector<bool> ends(n, false);
  for (int i = 0; i < n; ++i)
  {
    const double radius = ellipsoid.GetRadius(rays.Directions[i]);
    const bool there = std::abs(rays.Outer[i] / radius - 1) < MostDeviation;
    const double exit = tables[i].Exit / radius;
    rays.Kinds[i] = there                     ? SkullRayKind::Rough
      : tables[i].Cut || !(exit > NearEnd[0]) ? SkullRayKind::Unknown
                                              : SkullRayKind::Open;
    ends[i] = rays.Kinds[i] == SkullRayKind::Open && !(exit > NearEnd[1]);
    if (!there)
    {
      rays.Outer[i] = rays.Inner[i] = NotANumber;
    }
  }
  for (const std::vector<int>& part : FindParts(around, [&](int i) { return ends[i]; }))
  {
    const bool isCut = std::any_of(part.begin(), part.end(),
      [&](int i)
      {
        return std::any_of(around[i].begin(), around[i].end(),
          [&](int j) { return rays.Kinds[j] == SkullRayKind::Unknown && !ends[j]; });
      });
    for (const int i : part)
    {
      rays.Kinds[i] = isCut ? SkullRayKind::Unknown : SkullRayKind::Open;
    }
  }
  for (const int i : vault)
  {
    if (rays.Kinds[i] == SkullRayKind::Rough)
    {
      rays.Kinds[i] = SkullRayKind::Sound;
    }
  }
}
}

//------------------------------------------------------------------------------
std::vector<Vec3> SpreadDirections(double spacing, const Matrix4& axes)
{
  const int count = static_cast<int>(std::ceil(4 * Pi / (spacing * spacing * 0.866)));
  const double golden = Pi * (3 - std::sqrt(5.0));
  std::vector<Vec3> directions;
  for (int i = 0; i < count; ++i)
  {
    const double z = 1 - 2 * (i + 0.5) / count;
    const double r = std::sqrt(1 - z * z);
    directions.push_back((r * std::cos(golden * i)) * Normalized(axes.Column(0)) +
      (r * std::sin(golden * i)) * Normalized(axes.Column(1)) + z * Normalized(axes.Column(2)));
  }
  return directions;
}

//------------------------------------------------------------------------------
// |x|^2 = 2 middle . x + rest, with x from the centre.
Vec3 FindSphereMiddle(const Vec3& center, const std::vector<Vec3>& points)
{
  constexpr std::size_t count = 4;
  SquareMatrix normal(count);
  std::fill_n(normal.Column(0), count * count, 0.0);
  std::vector<double> right(count, 0.0);
  for (const Vec3& p : points)
  {
    const Vec3 x = (1 / TypicalRadius) * (p - center);
    const double terms[count] = { x[0], x[1], x[2], 1 };
    for (std::size_t j = 0; j < count; ++j)
    {
      right[j] += terms[j] * Dot(x, x);
      for (std::size_t i = j; i < count; ++i)
      {
        normal.Column(j)[i] += terms[i] * terms[j];
      }
    }
  }
  SymmetricFactorization(std::move(normal)).Solve(right);
  return center + (0.5 * TypicalRadius) * Vec3{ right[0], right[1], right[2] };
}

//------------------------------------------------------------------------------
std::vector<std::vector<int>> FindNeighbors(const std::vector<Vec3>& directions, double angle)
{
  const auto n = static_cast<int>(directions.size());
  const double cosine = std::cos(angle);
  const int band = GetBand(n, angle);
  std::vector<std::vector<int>> neighbors(n);
  for (int i = 0; i < n; ++i)
  {
    for (int j = i + 1; j < std::min(n, i + band + 1); ++j)
    {
      if (Dot(directions[i], directions[j]) > cosine)
      {
        neighbors[i].push_back(j);
        neighbors[j].push_back(i); // all lists are in order
      }
    }
  }
  return neighbors;
}

//------------------------------------------------------------------------------
std::vector<std::vector<int>> FindParts(
  const std::vector<std::vector<int>>& neighbors, const std::function<bool(int)>& chosen)
{
  std::vector<std::vector<int>> parts;
  std::vector<bool> seen(neighbors.size(), false);
  for (std::size_t start = 0; start < neighbors.size(); ++start)
  {
    if (seen[start] || !chosen(static_cast<int>(start)))
    {
      continue;
    }
    std::vector<int> part{ static_cast<int>(start) };
    seen[start] = true;
    for (std::size_t k = 0; k < part.size(); ++k)
    {
      for (const int other : neighbors[part[k]])
      {
        if (!seen[other] && chosen(other))
        {
          seen[other] = true;
          part.push_back(other);
        }
      }
    }
    std::sort(part.begin(), part.end());
    parts.push_back(std::move(part));
  }
  std::stable_sort(
    parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return parts;
}

//------------------------------------------------------------------------------
SkullRays TraceSkull(
  const VoxelVolume& volume, double level, const Vec3& center, double spacing, Execution& execution)
{
  if (!(spacing > 0.2 && spacing < 30))
  {
    throw std::invalid_argument("rays are not between 0.2 and 30 mm apart");
  }
  SkullRays rays;
  rays.Center = center;
  rays.Spacing = spacing / TypicalRadius;
  rays.Directions = SpreadDirections(rays.Spacing, volume.IndexToWorld);
  const std::vector<RayTables> tables = Follow(volume, level, center, rays.Directions, execution);
  for (const RayTables& t : tables)
  {
    rays.Outer.push_back(t.Cut ? NotANumber : t.Outer);
    rays.Inner.push_back(t.Cut ? NotANumber : t.Inner);
  }
  double edge = 0;
  for (int a = 0; a < 3; ++a)
  {
    edge = std::max(edge, Norm(volume.IndexToWorld.Column(a)));
  }
  rays.RoundedEdge = RoundedEdge * edge;
  Classify(rays, tables);
  return rays;
}

//------------------------------------------------------------------------------
RayRadii TraceRays(const VoxelVolume& volume, double level, const Vec3& center,
  const std::vector<Vec3>& directions, Execution& execution)
{
  RayRadii radii;
  for (const RayTables& t : Follow(volume, level, center, directions, execution))
  {
    radii.Outer.push_back(t.Cut ? NotANumber : t.Outer);
    radii.Inner.push_back(t.Cut ? NotANumber : t.Inner);
  }
  return radii;
}

//------------------------------------------------------------------------------
SkullRays ClassifySkull(
  const Vec3& center, const std::vector<Vec3>& directions, double spacing, RayRadii radii)
{
  SkullRays rays;
  rays.Center = center;
  rays.Directions = directions;
  rays.Spacing = spacing;
  rays.Outer = std::move(radii.Outer);
  rays.Inner = std::move(radii.Inner);
  RayTables open;
  open.Exit = std::numeric_limits<double>::infinity();
  Classify(rays, std::vector<RayTables>(directions.size(), open));
  return rays;
}

//------------------------------------------------------------------------------
Vec3 FindMeanOfBone(const VoxelVolume& volume, double level, Execution& execution)
{
  CheckVolumeSize(volume.Size);
  struct Mean
  {
    double Count = 0;
    Vec3 Sum{ 0, 0, 0 };
    Mean& operator+=(const Mean& other)
    {
      this->Count += other.Count;
      this->Sum = this->Sum + other.Sum;
      return *this;
    }
  };
  const Mean mean = DispatchScalars(volume.Type, volume.Voxels,
    [&](const auto* voxels)
    {
      return SumOverBlocks<Mean>(execution, volume.Size[2], 1,
        [&](std::int64_t first, std::int64_t)
        {
          Mean sum;
          const auto* voxel = voxels + first * volume.Size[0] * volume.Size[1];
          for (int j = 0; j < volume.Size[1]; ++j)
          {
            for (int i = 0; i < volume.Size[0]; ++i, ++voxel)
            {
              if (static_cast<double>(*voxel) >= level)
              {
                sum.Count += 1;
                sum.Sum = sum.Sum +
                  Vec3{ static_cast<double>(i), static_cast<double>(j),
                    static_cast<double>(first) };
              }
            }
          }
          return sum;
        });
    });
  if (!(mean.Count > 0))
  {
    throw std::invalid_argument("no voxel is at or above the level: there is no bone");
  }
  return volume.IndexToWorld.Point((1 / mean.Count) * mean.Sum);
}

//------------------------------------------------------------------------------
Vec3 FindSkullCenter(
  const VoxelVolume& volume, double level, const MirrorPlane& plane, Execution& execution)
{
  const auto project = [&](const Vec3& x) { return x - plane.Distance(x) * plane.Normal; };
  Vec3 center = project(FindMeanOfBone(volume, level, execution));
  for (int pass = 0; pass < 3; ++pass)
  {
    const SkullRays rays = TraceSkull(volume, level, center, 8, execution);
    std::vector<Vec3> points; // both sides: the middle of their sphere is on the plane
    for (std::size_t i = 0; i < rays.Kinds.size(); ++i)
    {
      if (rays.Kinds[i] == SkullRayKind::Sound)
      {
        points.push_back(center + rays.Outer[i] * rays.Directions[i]);
        points.push_back(plane.Reflect(points.back()));
      }
    }
    center = project(FindSphereMiddle(center, points));
  }
  return center;
}

//------------------------------------------------------------------------------
std::vector<double> FindLargestAlong(const VoxelVolume& volume, const Vec3& center,
  const std::vector<RaySegment>& segments, Execution& execution)
{
  CheckVolumeSize(volume.Size);
  std::vector<double> largest(segments.size());
  const double step = std::clamp(0.5 * SmallestEdgeOf(volume.IndexToWorld), 0.1, 1.0);
  DispatchScalars(volume.Type, volume.Voxels,
    [&](const auto* voxels)
    {
      const VoxelSampler sample(volume, voxels);
      execution.For(static_cast<std::int64_t>(segments.size()), 256,
        [&](std::int64_t begin, std::int64_t end)
        {
          for (std::int64_t i = begin; i < end; ++i)
          {
            const RaySegment& segment = segments[i];
            const int count =
              std::max(1, static_cast<int>(std::ceil((segment.To - segment.From) / step)));
            double most = std::isnan(sample(center + segment.From * segment.Direction))
              ? std::numeric_limits<double>::infinity()
              : std::numeric_limits<double>::lowest();
            for (int s = 0; s <= count; ++s)
            {
              const double r = segment.From + (segment.To - segment.From) * s / count;
              const double value = sample(center + r * segment.Direction);
              most = value > most ? value : most; // NaN is not
            }
            largest[i] = most;
          }
        });
    });
  return largest;
}

//------------------------------------------------------------------------------
SoundBone GetSoundBone(const SkullRays& rays)
{
  SoundBone bone;
  bone.Center = rays.Center;
  const auto n = static_cast<int>(rays.Kinds.size());
  for (int i = 0; i < n; ++i)
  {
    if (rays.Kinds[i] != SkullRayKind::Sound)
    {
      continue;
    }
    const double angle = rays.RoundedEdge / rays.Outer[i];
    const int band = GetBand(n, angle);
    bool isRounded = false;
    for (int j = std::max(0, i - band); j < std::min(n, i + band + 1) && !isRounded; ++j)
    {
      isRounded = rays.Kinds[j] == SkullRayKind::Open &&
        Dot(rays.Directions[i], rays.Directions[j]) > std::cos(angle);
    }
    if (!isRounded)
    {
      bone.Directions.push_back(rays.Directions[i]);
      bone.Outer.push_back(rays.Outer[i]);
      bone.Thickness.push_back(rays.Outer[i] - rays.Inner[i]);
    }
  }
  return bone;
}

//------------------------------------------------------------------------------
std::vector<std::vector<int>> FindDefects(const SkullRays& rays, double leastArea)
{
  const std::vector<std::vector<int>> around = FindNeighbors(rays.Directions, 1.6 * rays.Spacing);
  const std::vector<std::vector<int>> wide = FindNeighbors(rays.Directions, 4 * rays.Spacing);
  const std::vector<std::vector<int>> parts =
    FindParts(around, [&](int i) { return rays.Kinds[i] == SkullRayKind::Open; });
  const auto isDefect = [&](const std::vector<int>& part, double least)
  {
    std::vector<int> border;
    for (const int i : part)
    {
      std::copy_if(wide[i].begin(), wide[i].end(), std::back_inserter(border),
        [&](int j) { return rays.Kinds[j] != SkullRayKind::Open; });
    }
    std::sort(border.begin(), border.end());
    border.erase(std::unique(border.begin(), border.end()), border.end());
    double sound = 0;
    double radii = 0;
    for (const int j : border)
    {
      sound += rays.Kinds[j] == SkullRayKind::Sound ? 1 : 0;
      radii += rays.Kinds[j] == SkullRayKind::Sound ? rays.Outer[j] : 0;
    }
    const double edge = sound > 0 ? rays.Spacing * radii / sound : 0;
    return 0.866 * edge * edge * static_cast<double>(part.size()) >= leastArea &&
      sound >= least * static_cast<double>(border.size());
  };
  const int narrow =
    std::max(1, static_cast<int>(0.5 * NarrowPart / (rays.Spacing * TypicalRadius)));
  std::vector<std::vector<int>> defects;
  for (const std::vector<int>& part : parts)
  {
    if (isDefect(part, ClearBorder))
    {
      defects.push_back(part);
      continue;
    }
    for (std::vector<int>& piece : WithoutNarrowParts(around, part, narrow))
    {
      if (isDefect(piece, LeastBorder))
      {
        defects.push_back(std::move(piece));
      }
    }
  }
  std::stable_sort(defects.begin(), defects.end(),
    [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return defects;
}

//------------------------------------------------------------------------------
std::vector<int> FindRaysWithin(const SkullRays& rays, const std::vector<Vec3>& curve)
{
  if (curve.size() < 3)
  {
    throw std::invalid_argument("the outline of the defect has fewer than three points");
  }
  Vec3 axis{ 0, 0, 0 };
  std::vector<Vec3> directions;
  for (std::size_t k = 0; k < curve.size(); ++k)
  {
    // by length, so that it does not matter where points are dense
    const double length = Norm(curve[(k + 1) % curve.size()] - curve[k]) +
      Norm(curve[k] - curve[(k + curve.size() - 1) % curve.size()]);
    directions.push_back(Normalized(curve[k] - rays.Center));
    axis = axis + length * directions.back();
  }
  axis = Normalized(axis);
  const Vec3 u = Normalized(
    std::abs(axis[0]) < 0.8 ? Cross(axis, Vec3{ 1, 0, 0 }) : Cross(axis, Vec3{ 0, 1, 0 }));
  const Vec3 v = Cross(axis, u);
  // seen from the pole on the other side (stereographic): closed curves keep their inside
  const auto toPlane = [&](const Vec3& d)
  {
    const double scale = 1 / (1 + Dot(d, axis));
    return Vec2{ scale * Dot(d, u), scale * Dot(d, v) };
  };
  Loop loop;
  for (const Vec3& d : directions)
  {
    if (!(Dot(d, axis) > -0.5))
    {
      throw std::invalid_argument(
        "the outline of the defect goes around more than half of the skull");
    }
    loop.push_back(toPlane(d));
  }
  if (CrossesItself(loop))
  {
    throw std::invalid_argument("the outline of the defect crosses itself: draw it once around");
  }
  const std::vector<Loop> curves{ loop };
  std::vector<int> within;
  for (std::size_t i = 0; i < rays.Directions.size(); ++i)
  {
    if (Dot(rays.Directions[i], axis) > -0.5)
    {
      if (IsInside(curves, toPlane(rays.Directions[i])))
      {
        within.push_back(static_cast<int>(i));
      }
    }
  }
  return within;
}
}
