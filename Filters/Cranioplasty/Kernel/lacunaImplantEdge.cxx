// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaImplantEdge.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

namespace lacuna
{
namespace
{
constexpr double Pi = 3.14159265358979323846;
constexpr double LeastLimit = 3;        // mm, of clearances on the way
constexpr double BeyondClearance = 2.5; // mm: the same
constexpr double LeastStep = 0.15;      // mm along the way out
constexpr double DeepEnough = -1;       // mm in bone: no more is sought
constexpr double WantedTaper = 10;      // degrees
constexpr int DirectionSteps = 60;
constexpr double MostLean = 1;        // tangent of the angle from where the search starts
constexpr double NearStart = 1e-3;    // weight of the lean beside that of a wall
constexpr double MostOutwards = 6;    // mm, of the edge from the outline
constexpr double MostInwards = 1;     // mm
constexpr double MostLack = 0.1;      // mm, of the clearance
constexpr double Exact = 0.005;       // mm, of the clearance
constexpr int MostSearch = 40;        // steps of it
constexpr double OverBone = 0.7;      // cosine: bone is below rather than beside
constexpr double AtBone = 0.3;        // mm of more than the clearance: the outline is not at bone
constexpr int SmoothReach = 4;        // places on either side
constexpr double LeastSpacing = 0.3;  // of neighbours, of what it was
constexpr double MostSlopeAlong = 1;  // of the edge's width, mm a mm
constexpr double MostSlopeDown = 1.7; // the same from the outer to the inner surface
constexpr double UndercutReach = 5;   // mm
constexpr double LeastUndercut = 0.2; // mm

// Unit, along a closed loop, smooth.
std::vector<Vec2> GetTangents(const Loop& loop)
{
  const auto n = static_cast<std::ptrdiff_t>(loop.size());
  const std::ptrdiff_t reach = std::min<std::ptrdiff_t>(SmoothReach, (n - 1) / 4);
  std::vector<Vec2> tangents;
  for (std::ptrdiff_t k = 0; k < n; ++k)
  {
    Vec2 sum{ 0, 0 };
    for (std::ptrdiff_t r = 1; r <= std::max<std::ptrdiff_t>(reach, 1); ++r)
    {
      const Vec2& a = loop[(k + n - r) % n];
      const Vec2& b = loop[(k + r) % n];
      sum = { sum[0] + b[0] - a[0], sum[1] + b[1] - a[1] };
    }
    const double length = std::hypot(sum[0], sum[1]);
    tangents.push_back(length > 0 ? Vec2{ sum[0] / length, sum[1] / length } : Vec2{ 1, 0 });
  }
  return tangents;
}

// A place of the outline and how far the edge is moved from it.
struct Place
{
  Vec2 Foot{};
  Vec2 Out{};
  double Most = MostOutwards; // mm
  double Height = 0;          // mm, from level to level
  std::vector<double> Moved;  // on each level
};

Vec2 GetMoved(const Place& place, double t)
{
  return { place.Foot[0] + t * place.Out[0], place.Foot[1] + t * place.Out[1] };
}
}

//------------------------------------------------------------------------------
bool ImplantSlab::Covers(const Vec2& p) const
{
  const double x = (p[0] - this->Grid.Origin[0]) / this->Grid.Spacing[0];
  const double y = (p[1] - this->Grid.Origin[1]) / this->Grid.Spacing[1];
  if (!(x >= 0 && y >= 0 && x < static_cast<double>(this->Grid.Columns - 1) &&
        y < static_cast<double>(this->Grid.Rows - 1)))
  {
    return false;
  }
  const std::int64_t node =
    static_cast<std::int64_t>(x) + this->Grid.Columns * static_cast<std::int64_t>(y);
  return this->IsKnown[node] && this->IsKnown[node + 1] &&
    this->IsKnown[node + this->Grid.Columns] && this->IsKnown[node + this->Grid.Columns + 1];
}

//------------------------------------------------------------------------------
Vec3 ImplantSlab::GetPoint(const Vec2& p, double depth) const
{
  const double x = (p[0] - this->Grid.Origin[0]) / this->Grid.Spacing[0];
  const double y = (p[1] - this->Grid.Origin[1]) / this->Grid.Spacing[1];
  const auto i = static_cast<std::int64_t>(x);
  const auto j = static_cast<std::int64_t>(y);
  const double u = x - static_cast<double>(i);
  const double v = y - static_cast<double>(j);
  const auto at = [&](std::int64_t node)
  { return (1 - depth) * this->Outer[node] + depth * this->Inner[node]; };
  const std::int64_t node = i + this->Grid.Columns * j;
  const std::int64_t above = node + this->Grid.Columns;
  return ((1 - u) * (1 - v)) * at(node) + (u * (1 - v)) * at(node + 1) + ((1 - u) * v) * at(above) +
    (u * v) * at(above + 1);
}

//------------------------------------------------------------------------------
Vec3 ImplantSlab::GetNormal(const Vec2& p) const
{
  const auto i = static_cast<std::int64_t>((p[0] - this->Grid.Origin[0]) / this->Grid.Spacing[0]);
  const auto j = static_cast<std::int64_t>((p[1] - this->Grid.Origin[1]) / this->Grid.Spacing[1]);
  const std::int64_t node = i + this->Grid.Columns * j;
  const std::int64_t above = node + this->Grid.Columns;
  return Normalized(
    Cross(this->Outer[above + 1] - this->Outer[node] - (this->Outer[above] - this->Outer[node + 1]),
      this->Outer[above + 1] - this->Outer[node] + (this->Outer[above] - this->Outer[node + 1])));
}

//------------------------------------------------------------------------------
InsertionPath::InsertionPath(const BoneDistance& bone, const Vec3& direction, double clearance)
  : Bone(bone)
  , Direction(Normalized(direction))
  , Limit(std::max(LeastLimit, clearance + BeyondClearance))
  , Bounds(bone.GetBounds())
{
}

//------------------------------------------------------------------------------
double InsertionPath::GetWay(const Vec3& x) const
{
  double way = std::numeric_limits<double>::infinity();
  for (int a = 0; a < 3; ++a)
  {
    const double speed = -this->Direction[a];
    const double end =
      speed > 0 ? this->Bounds[1][a] + this->Limit : this->Bounds[0][a] - this->Limit;
    way = speed == 0 ? way : std::min(way, (end - x[a]) / speed);
  }
  return std::max(way, 0.0);
}

//------------------------------------------------------------------------------
double InsertionPath::GetClearance(const Vec3& x) const
{
  const double way = this->GetWay(x);
  double least = this->Limit;
  for (double along = 0;;)
  {
    const double distance = this->Bone.Find(x - along * this->Direction, this->Limit).Distance;
    least = std::min(least, distance);
    if (least < DeepEnough || along >= way)
    {
      return least;
    }
    // until then no bone can be nearer than least, nor a surface be met
    along += std::max(LeastStep, distance >= this->Limit ? this->Limit : 0.5 * (distance - least));
  }
}

//------------------------------------------------------------------------------
Vec3 FindInsertionDirection(const std::vector<Vec3>& walls, const Vec3& start)
{
  const double wanted = std::sin(WantedTaper * Pi / 180);
  const Vec3 out = -1 * Normalized(start);
  const Vec3 u =
    Normalized(std::abs(out[0]) < 0.8 ? Cross(out, Vec3{ 1, 0, 0 }) : Cross(out, Vec3{ 0, 1, 0 }));
  const Vec3 v = Cross(out, u);
  // out + x u + y v: so the width of an undercut is linear in x and y, and the sum convex
  double x = 0;
  double y = 0;
  for (int step = 0; step < DirectionSteps && !walls.empty(); ++step)
  {
    const double held = NearStart * static_cast<double>(walls.size());
    double xx = held;
    double xy = 0;
    double yy = held;
    Vec2 right{ -held * x, -held * y };
    for (const Vec3& wall : walls)
    {
      const Vec2 slope{ Dot(wall, u), Dot(wall, v) };
      const double missing = wanted - Dot(wall, out) - x * slope[0] - y * slope[1];
      if (missing > 0)
      {
        xx += slope[0] * slope[0];
        xy += slope[0] * slope[1];
        yy += slope[1] * slope[1];
        right = { right[0] + missing * slope[0], right[1] + missing * slope[1] };
      }
    }
    const double determinant = xx * yy - xy * xy;
    x += 0.5 * (yy * right[0] - xy * right[1]) / determinant;
    y += 0.5 * (xx * right[1] - xy * right[0]) / determinant;
    const double length = std::hypot(x, y);
    if (length > MostLean)
    {
      x *= MostLean / length;
      y *= MostLean / length;
    }
  }
  return -1 * Normalized(out + x * u + y * v);
}

namespace
{
class WallFollower
{
public:
  WallFollower(const ImplantSlab& slab, const BoneDistance& bone, const InsertionPath& path,
    double clearance, Execution& execution)
    : Slab(slab)
    , Bone(bone)
    , Path(path)
    , Clearance(clearance)
    , Run(execution)
  {
  }

  ImplantEdge Follow(const std::vector<Loop>& outline)
  {
    ImplantEdge edge;
    edge.Levels.resize(this->Slab.Steps + 1);
    edge.LeastTaper = 90;
    for (const Loop& loop : outline)
    {
      std::vector<Place> places = MakePlaces(loop);
      this->Run.For(static_cast<std::int64_t>(places.size()), 8,
        [&](std::int64_t begin, std::int64_t end)
        {
          for (std::int64_t k = begin; k < end; ++k)
          {
            this->Search(places[k]);
          }
        });
      LimitSlopes(places);
      for (int level = 0; level <= this->Slab.Steps; ++level)
      {
        Loop moved;
        for (const Place& place : places)
        {
          moved.push_back(GetMoved(place, place.Moved[level]));
        }
        edge.Levels[level].push_back(std::move(moved));
      }
    }
    this->Measure(edge);
    return edge;
  }

private:
  // Where the edge may go: not so far that neighbours meet.
  std::vector<Place> MakePlaces(const Loop& loop) const
  {
    const std::vector<Vec2> tangents = GetTangents(loop);
    std::vector<Place> places(loop.size());
    for (std::size_t k = 0; k < loop.size(); ++k)
    {
      places[k].Foot = loop[k];
      places[k].Out = { tangents[k][1], -tangents[k][0] };
      places[k].Moved.assign(this->Slab.Steps + 1, 0);
    }
    for (std::size_t k = 0; k < loop.size(); ++k)
    {
      Place& a = places[k];
      Place& b = places[(k + 1) % loop.size()];
      const Vec2 way{ b.Foot[0] - a.Foot[0], b.Foot[1] - a.Foot[1] };
      const double square = way[0] * way[0] + way[1] * way[1];
      const double closing = (b.Out[0] - a.Out[0]) * way[0] + (b.Out[1] - a.Out[1]) * way[1];
      if (closing < 0)
      {
        const double most = (1 - LeastSpacing) * square / -closing;
        a.Most = std::min(a.Most, most);
        b.Most = std::min(b.Most, most);
      }
    }
    return places;
  }

  double GetExcess(const Vec3& x) const { return this->Path.GetClearance(x) - this->Clearance; }

  bool IsOverBone(const Vec2& p, const Vec3& x) const
  {
    const double reach = this->Clearance + 1;
    const NearestBone bone = this->Bone.Find(x, reach);
    return std::abs(bone.Distance) < reach &&
      Dot(x - bone.Point, this->Slab.GetNormal(p)) > OverBone * std::abs(bone.Distance);
  }

  void Search(Place& place) const
  {
    std::vector<double> excess(this->Slab.Steps + 1);
    double least = this->Path.GetLimit();
    for (int level = 0; level <= this->Slab.Steps; ++level)
    {
      excess[level] = this->GetExcess(this->Slab.GetPoint(place.Foot, this->Slab.DepthOf(level)));
      least = std::min(least, excess[level]);
    }
    place.Height = Norm(this->Slab.GetPoint(place.Foot, 0) - this->Slab.GetPoint(place.Foot, 1)) /
      this->Slab.Steps;
    if (least > AtBone)
    {
      return; // the outline leaves something out
    }
    for (int level = 0; level <= this->Slab.Steps; ++level)
    {
      place.Moved[level] = this->SearchLevel(place, this->Slab.DepthOf(level), excess[level]);
    }
  }

  double SearchLevel(const Place& place, double depth, double excess) const
  {
    double here = 0;
    for (int step = 0; step < MostSearch && std::abs(excess) > Exact; ++step)
    {
      // no clearance changes by more than the way
      const double next =
        std::clamp(here + (excess > 0 ? 0.9 : 1.1) * excess, -MostInwards, place.Most);
      const Vec2 p = GetMoved(place, next);
      if (next == here || !this->Slab.Covers(p))
      {
        return here;
      }
      const Vec3 x = this->Slab.GetPoint(p, depth);
      if (next > 0 && this->IsOverBone(p, x))
      {
        return here;
      }
      here = next;
      excess = this->GetExcess(x);
    }
    // where bone is too rough for steps of that size
    for (double back = here - 0.1; excess < -MostLack && back > -MostInwards; back -= 0.1)
    {
      const Vec2 p = GetMoved(place, back);
      if (this->Slab.Covers(p))
      {
        here = back;
        excess = this->GetExcess(this->Slab.GetPoint(p, depth));
      }
    }
    return here;
  }

  void LimitSlopes(std::vector<Place>& places) const
  {
    const std::size_t n = places.size();
    const auto limit = [&](std::size_t from, std::size_t to)
    {
      const Place& a = places[from];
      Place& b = places[to];
      const double way = std::hypot(a.Foot[0] - b.Foot[0], a.Foot[1] - b.Foot[1]);
      for (int level = 0; level <= this->Slab.Steps; ++level)
      {
        b.Moved[level] = std::min(b.Moved[level], a.Moved[level] + MostSlopeAlong * way);
      }
      for (int level = 1; level <= this->Slab.Steps; ++level)
      {
        b.Moved[level] = std::min(b.Moved[level], b.Moved[level - 1] + MostSlopeDown * b.Height);
      }
      for (int level = this->Slab.Steps; level > 0; --level)
      {
        b.Moved[level - 1] =
          std::min(b.Moved[level - 1], b.Moved[level] + MostSlopeDown * b.Height);
      }
    };
    for (std::size_t k = 0; k < 2 * n; ++k)
    {
      limit(k % n, (k + 1) % n);
    }
    for (std::size_t k = 2 * n; k > 0; --k)
    {
      limit(k % n, (k - 1) % n);
    }
  }

  void Measure(ImplantEdge& edge) const
  {
    const Vec3 out = -1 * this->Path.GetDirection();
    for (std::size_t l = 0; l < edge.Levels[0].size(); ++l)
    {
      const std::size_t n = edge.Levels[0][l].size();
      for (std::size_t k = 0; k < n; ++k)
      {
        const auto at = [&](std::size_t place, int level) {
          return this->Slab.GetPoint(edge.Levels[level][l][place % n], this->Slab.DepthOf(level));
        };
        const std::size_t reach = std::min<std::size_t>(SmoothReach, n / 4);
        const Vec3 up = at(k, 0) - at(k, this->Slab.Steps);
        const Vec3 along =
          at(k + reach, this->Slab.Steps / 2) - at(k + n - reach, this->Slab.Steps / 2);
        const Vec3 wall = Normalized(Cross(up, along));
        edge.LeastTaper =
          std::min(edge.LeastTaper, std::asin(std::clamp(Dot(wall, out), -1.0, 1.0)) * 180 / Pi);
        const double width =
          0.5 * Norm(at(k + 1, this->Slab.Steps / 2) - at(k + n - 1, this->Slab.Steps / 2));
        for (int level = 0; level <= this->Slab.Steps; ++level)
        {
          const Vec3 x = at(k, level);
          const double clearance = this->Path.GetClearance(x);
          const double free = this->Bone.Find(x, UndercutReach).Distance - clearance;
          if (clearance < this->Clearance + AtBone && free > LeastUndercut)
          {
            const double part = (level % this->Slab.Steps == 0 ? 0.5 : 1.0) / this->Slab.Steps;
            edge.UndercutVolume += free * width * part * Norm(up);
            if (free > edge.UndercutWidth)
            {
              edge.UndercutWidth = free;
              edge.UndercutPoint = x;
            }
          }
        }
      }
    }
  }

  const ImplantSlab& Slab;
  const BoneDistance& Bone;
  const InsertionPath& Path;
  double Clearance;
  Execution& Run;
};
}

//------------------------------------------------------------------------------
ImplantEdge FollowWall(const ImplantSlab& slab, const BoneDistance& bone, const InsertionPath& path,
  const std::vector<Loop>& outline, double clearance, Execution& execution)
{
  return WallFollower(slab, bone, path, clearance, execution).Follow(outline);
}
}
