// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaImplantMesh.h"

#include "lacunaPlanarLattice.h"
#include "lacunaPlanarTriangulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace lacuna
{
namespace
{
constexpr double Pi = 3.14159265358979323846;
constexpr double LatticeToRim = 0.6; // of TriangleSize: the rim's edges stay Delaunay edges
constexpr int LeastSides = 16;       // of a round hole
constexpr double OnLine = 1e-7;      // mm
constexpr int MostNewton = 30;
constexpr double BetweenHoles = 2; // mm of material between holes, and between holes and text
constexpr double NearRim = 0.8;    // of RimDistance, where the rim bends
constexpr double TextToRim = 2;    // mm
constexpr double TextSearch = 2;   // mm between places that are tried
constexpr double PlateSearch = 2;  // mm, the same
constexpr double ScrewArea = 3;    // mm around a screw in which bone is looked at

// A line in space and a frame across it.
struct Line
{
  Vec3 Point;
  Vec3 Way;
  Vec3 U;
  Vec3 V;
};

Line MakeLine(const ImplantSlab& slab, const Vec2& p)
{
  Line line;
  line.Point = slab.GetPoint(p, 0);
  line.Way = slab.GetNormal(p);
  // counterclockwise in the chart is so about the normal
  const double h = 0.5 * slab.Grid.Spacing[0];
  const Vec3 ahead = slab.GetPoint({ p[0] + h, p[1] }, 0) - line.Point;
  line.U = Normalized(ahead - Dot(ahead, line.Way) * line.Way);
  line.V = Cross(line.Way, line.U);
  return line;
}

bool IsFarInside(const ImplantSlab& slab, const Vec2& p)
{
  const double h = 1.5 * slab.Grid.Spacing[0];
  return slab.Covers(p) && slab.Covers({ p[0] + h, p[1] }) && slab.Covers({ p[0] - h, p[1] }) &&
    slab.Covers({ p[0], p[1] + h }) && slab.Covers({ p[0], p[1] - h });
}

// Moves p until the level's point there is x mm along U and y mm along V from the line.
bool FindBeside(
  const ImplantSlab& slab, double depth, const Line& line, double x, double y, Vec2& p)
{
  constexpr double h = 0.02;
  for (int step = 0; step < MostNewton && IsFarInside(slab, p); ++step)
  {
    const auto missing = [&](const Vec2& q)
    {
      const Vec3 d = slab.GetPoint(q, depth) - line.Point;
      return Vec2{ x - Dot(d, line.U), y - Dot(d, line.V) };
    };
    const Vec2 here = missing(p);
    if (std::hypot(here[0], here[1]) < OnLine)
    {
      return true;
    }
    const Vec2 right = missing({ p[0] + h, p[1] });
    const Vec2 above = missing({ p[0], p[1] + h });
    const double a = (here[0] - right[0]) / h;
    const double b = (here[0] - above[0]) / h;
    const double c = (here[1] - right[1]) / h;
    const double d = (here[1] - above[1]) / h;
    const double determinant = a * d - b * c;
    if (!(determinant > 0.1))
    {
      return false;
    }
    Vec2 move{ (d * here[0] - b * here[1]) / determinant,
      (a * here[1] - c * here[0]) / determinant };
    const double length = std::hypot(move[0], move[1]);
    const double part = std::min(1.0, 2 / std::max(length, 1e-12));
    p = { p[0] + part * move[0], p[1] + part * move[1] };
  }
  return false;
}

std::vector<std::vector<Vec3>> OnLevel(
  const ImplantSlab& slab, const std::vector<Loop>& loops, double depth)
{
  std::vector<std::vector<Vec3>> curves;
  for (const Loop& loop : loops)
  {
    curves.emplace_back();
    for (const Vec2& p : loop)
    {
      curves.back().push_back(slab.GetPoint(p, depth));
    }
  }
  return curves;
}

double Distance(const Vec2& a, const Vec2& b)
{
  return std::hypot(a[0] - b[0], a[1] - b[1]);
}

// Places along a loop, evenly, and the way out of the region there.
struct RimPlace
{
  Vec2 Foot;
  Vec2 Out;
};

std::vector<RimPlace> WalkRim(const Loop& loop, double spacing)
{
  constexpr std::ptrdiff_t reach = 4;
  const Loop fine = Resample(loop, std::min(0.5, 0.25 * spacing));
  double length = 0;
  for (std::size_t k = 0; k < fine.size(); ++k)
  {
    length += Distance(fine[k], fine[(k + 1) % fine.size()]);
  }
  const auto n = static_cast<std::ptrdiff_t>(fine.size());
  const auto count = static_cast<std::ptrdiff_t>(std::max(std::lround(length / spacing), 1L));
  std::vector<RimPlace> places;
  for (std::ptrdiff_t k = 0; k < count; ++k)
  {
    const std::ptrdiff_t at = k * n / count;
    const Vec2& before = fine[(at + n - reach) % n];
    const Vec2& after = fine[(at + reach) % n];
    const double way = std::max(Distance(before, after), 1e-9);
    places.push_back({ fine[at], { (after[1] - before[1]) / way, -(after[0] - before[0]) / way } });
  }
  return places;
}

// Goes inwards from the rim until it is so far away; false: there is no such place.
bool GoInwards(const ImplantRim& rim, const RimPlace& place, double distance, Vec2& p)
{
  double along = distance;
  for (int step = 0; step < 8; ++step)
  {
    p = { place.Foot[0] - along * place.Out[0], place.Foot[1] - along * place.Out[1] };
    Vec2 inner{};
    const double missing = distance - rim.Find(p, 2 * distance + 1, inner);
    if (std::abs(missing) < 0.02)
    {
      return true;
    }
    along = std::clamp(along + missing, 0.3 * distance, 3 * distance);
  }
  Vec2 inner{};
  return rim.Find(p, 2 * distance + 1, inner) > 0.9 * distance;
}
}

//------------------------------------------------------------------------------
std::vector<Loop> FindTunnel(const ImplantSlab& slab, const ImplantHole& hole, double spacing)
{
  if (!IsFarInside(slab, hole.Middle))
  {
    return {};
  }
  const Line line = MakeLine(slab, hole.Middle);
  const int sides =
    std::max(LeastSides, static_cast<int>(std::ceil(2 * Pi * hole.Radius / spacing)));
  std::vector<Loop> levels;
  for (int level = 0; level <= slab.Steps; ++level)
  {
    levels.emplace_back();
    for (int k = 0; k < sides; ++k)
    {
      const double angle = -2 * Pi * k / sides; // clockwise: what is inside is on the right
      const double x = hole.Radius * std::cos(angle);
      const double y = hole.Radius * std::sin(angle);
      Vec2 p = level == 0 ? Vec2{ hole.Middle[0] + x, hole.Middle[1] + y }
                          : levels[level - 1][static_cast<std::size_t>(k)];
      if (!FindBeside(slab, slab.DepthOf(level), line, x, y, p))
      {
        return {};
      }
      levels.back().push_back(p);
    }
  }
  return levels;
}

//------------------------------------------------------------------------------
ImplantRim::ImplantRim(const ImplantSlab& slab, const std::vector<std::vector<Loop>>& levels)
  : Slab(slab)
  , Levels(levels)
{
  for (int level = 0; level <= slab.Steps; ++level)
  {
    this->Rims.emplace_back(OnLevel(slab, levels[level], slab.DepthOf(level)), 2);
  }
}

//------------------------------------------------------------------------------
double ImplantRim::FindOn(int level, const Vec2& p, double limit) const
{
  const bool isIn = this->Slab.Covers(p) && IsInside(this->Levels[level], p);
  return isIn
    ? this->Rims[level].Find(this->Slab.GetPoint(p, this->Slab.DepthOf(level)), limit).Distance
    : -1;
}

//------------------------------------------------------------------------------
double ImplantRim::FindInner(const Vec2& p, double limit) const
{
  return this->FindOn(this->Slab.Steps, p, limit);
}

//------------------------------------------------------------------------------
double ImplantRim::Find(const Vec2& p, double limit, Vec2& inner) const
{
  if (!IsFarInside(this->Slab, p))
  {
    return -1;
  }
  const Line line = MakeLine(this->Slab, p);
  double least = limit;
  inner = p;
  for (int level = 0; level <= this->Slab.Steps && least >= 0; ++level)
  {
    least = level == 0 || FindBeside(this->Slab, this->Slab.DepthOf(level), line, 0, 0, inner)
      ? std::min(least, this->FindOn(level, inner, limit))
      : -1;
  }
  return least;
}

//------------------------------------------------------------------------------
double TextPlace::GetDistance(const Vec2& p) const
{
  const Vec2 d{ p[0] - this->Middle[0], p[1] - this->Middle[1] };
  const double across = std::abs(d[0] * this->Up[1] - d[1] * this->Up[0]) - this->HalfWidth;
  const double along = std::abs(d[0] * this->Up[0] + d[1] * this->Up[1]) - this->HalfHeight;
  return std::hypot(std::max(across, 0.0), std::max(along, 0.0));
}

//------------------------------------------------------------------------------
Vec2 TextPlace::At(double x, double y) const
{
  // seen from within, right is the other way than from outside
  return { this->Middle[0] - x * this->Up[1] + y * this->Up[0],
    this->Middle[1] + x * this->Up[0] + y * this->Up[1] };
}

//------------------------------------------------------------------------------
namespace
{
// The rectangle around text, mm as read.
struct TextBox
{
  Vec2 Middle;
  double HalfWidth;
  double HalfHeight;
};

TextBox FindBox(const std::vector<Loop>& text)
{
  Vec2 low{ std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity() };
  Vec2 high{ -low[0], -low[1] };
  for (const Loop& loop : text)
  {
    for (const Vec2& p : loop)
    {
      for (int a = 0; a < 2; ++a)
      {
        low[a] = std::min(low[a], p[a]);
        high[a] = std::max(high[a], p[a]);
      }
    }
  }
  return { { 0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]) }, 0.5 * (high[0] - low[0]),
    0.5 * (high[1] - low[1]) };
}

// A direction in space as one in the chart, about, on the inner surface.
Vec2 FindUp(const ImplantSlab& slab, const Vec2& p, const Vec3& up)
{
  constexpr double h = 0.1;
  const Vec3 x = slab.GetPoint(p, 1);
  const Vec2 slope{ Dot(up, slab.GetPoint({ p[0] + h, p[1] }, 1) - x),
    Dot(up, slab.GetPoint({ p[0], p[1] + h }, 1) - x) };
  const double length = std::hypot(slope[0], slope[1]);
  return length > 1e-6 ? Vec2{ slope[0] / length, slope[1] / length } : Vec2{ 0, 1 };
}

// The rectangle around a middle that text of a box fills.
TextPlace MakePlace(const ImplantSlab& slab, const Vec2& middle, const TextBox& box, const Vec3& up)
{
  TextPlace place;
  place.Middle = middle;
  place.Up = FindUp(slab, middle, up);
  // the chart's mm are those of the outer surface, about
  const auto stretch = [&](double x, double y)
  { return Norm(slab.GetPoint(place.At(x, y), 1) - slab.GetPoint(place.At(-x, -y), 1)) / 2; };
  place.HalfWidth = box.HalfWidth / stretch(1, 0);
  place.HalfHeight = box.HalfHeight / stretch(0, 1);
  return place;
}

// mm from text in a place to the rim, -1 where the implant is too thin. It stops when this is not above enough.
double FindRoom(const ImplantSlab& slab, const ImplantRim& rim, const TextPlace& place,
  double leastThickness, double enough)
{
  double least = 1e3;
  constexpr int steps = 12;
  for (int i = -steps; i <= steps && least > enough; ++i)
  {
    for (const int j : { -1, 0, 1 })
    {
      const Vec2 p = place.At(place.HalfWidth * i / steps, place.HalfHeight * j);
      const bool isThick = slab.Covers(p) &&
        Norm(slab.GetPoint(p, 0) - slab.GetPoint(p, 1)) >= leastThickness + EngravedDepth;
      least = isThick ? std::min(least, rim.FindInner(p, 1e3)) : -1;
    }
  }
  return least;
}

// Text in its place, what is engraved on the left of each loop.
std::vector<Loop> Lay(const std::vector<Loop>& text, const TextBox& box, const TextPlace& place)
{
  std::vector<Loop> laid;
  for (const Loop& loop : text)
  {
    laid.emplace_back();
    for (const Vec2& p : loop)
    {
      laid.back().push_back(place.At((p[0] - box.Middle[0]) * place.HalfWidth / box.HalfWidth,
        (p[1] - box.Middle[1]) * place.HalfHeight / box.HalfHeight));
    }
  }
  for (std::size_t k = 0; k < laid.size(); ++k)
  {
    std::vector<Loop> others = laid;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    const bool isHollow = IsInside(others, laid[k][0]); // within an odd number of others
    if ((SignedArea(laid[k]) > 0) == isHollow)
    {
      std::reverse(laid[k].begin(), laid[k].end());
    }
  }
  return laid;
}
}

//------------------------------------------------------------------------------
TextPlace PlaceText(const ImplantSlab& slab, const ImplantRim& rim,
  const std::vector<Loop>& outline, const std::vector<Loop>& text, const Vec3& up,
  double leastThickness)
{
  TextPlace best;
  if (text.empty() || outline.empty())
  {
    return best;
  }
  const TextBox box = FindBox(text);
  double most = TextToRim;
  const PlanarGrid grid = MakeGrid(outline[0], 0, TextSearch);
  for (std::int64_t node = 0; node < grid.Columns * grid.Rows; ++node)
  {
    const Vec2 middle = grid.GetNode(node % grid.Columns, node / grid.Columns);
    if (rim.FindInner(middle, most) < most || !IsFarInside(slab, middle))
    {
      continue;
    }
    const TextPlace place = MakePlace(slab, middle, box, up);
    const double room = FindRoom(slab, rim, place, leastThickness, most);
    if (room > most)
    {
      most = room;
      best = place;
      best.IsGood = true;
    }
  }
  if (best.IsGood)
  {
    best.Text = Lay(text, box, best);
  }
  return best;
}

//------------------------------------------------------------------------------
namespace
{
// The least thickness of the bone around a direction, 0 where there is none. outer: the radius of its outer table.
double FindThickness(const SkullRays& rays, const Vec3& direction, double reach, double& outer)
{
  double least = std::numeric_limits<double>::infinity();
  double nearest = std::cos(reach);
  for (std::size_t i = 0; i < rays.Directions.size(); ++i)
  {
    const double cosine = Dot(rays.Directions[i], direction);
    if (cosine >= std::cos(reach))
    {
      const double thickness = rays.Outer[i] - rays.Inner[i];
      least = thickness > 0 ? std::min(least, thickness) : 0; // NaN: there is no bone
      if (cosine >= nearest)
      {
        nearest = cosine;
        outer = rays.Outer[i];
      }
    }
  }
  return least < MostBoneThickness ? least : 0;
}

struct PlateCandidate
{
  ImplantPlateScrews Screws;
  std::size_t Number; // of the place along the rim
};

// For a part of the rim, in places: the candidate nearest to its middle whose bone is as thick as screws are long, else
// the one with the thickest bone. Null: there is none.
const PlateCandidate* ChoosePlate(
  const std::vector<PlateCandidate>& candidates, double middle, double length, double screwLength)
{
  const PlateCandidate* best = nullptr;
  const auto offOf = [&](const PlateCandidate& c)
  { return std::abs(static_cast<double>(c.Number) - middle); };
  for (const PlateCandidate& c : candidates)
  {
    if (offOf(c) > 0.3 * length) // plates keep apart
    {
      continue;
    }
    const bool isThick = c.Screws.BoneThickness >= screwLength;
    const bool wasThick = best && best->Screws.BoneThickness >= screwLength;
    const bool isBetter = !best || (isThick && (!wasThick || offOf(c) < offOf(*best))) ||
      (!isThick && !wasThick && c.Screws.BoneThickness > best->Screws.BoneThickness);
    best = isBetter ? &c : best;
  }
  return best;
}
}

//------------------------------------------------------------------------------
std::vector<ImplantPlateScrews> PlacePlates(const ImplantSlab& slab, const SkullRays& rays,
  const Chart& chart, const std::vector<std::vector<Loop>>& levels,
  const SkullImplantOptions& options, const std::function<bool(const Vec3&)>& hasRoom)
{
  std::vector<ImplantPlateScrews> plates;
  if (options.Plates == 0)
  {
    return plates;
  }
  const ImplantRim rim(slab, levels);
  std::vector<PlateCandidate> candidates;
  const std::vector<RimPlace> places = WalkRim(levels[0][0], PlateSearch);
  for (std::size_t k = 0; k < places.size(); ++k)
  {
    ImplantPlateScrews screws;
    if (!GoInwards(rim, places[k], options.RimDistance, screws.Foot) ||
      !hasRoom(slab.GetPoint(screws.Foot, 0)))
    {
      continue;
    }
    const double beyond = options.EdgeClearance + options.RimDistance;
    const Vec3 direction = chart.ToDirection({ places[k].Foot[0] + beyond * places[k].Out[0],
      places[k].Foot[1] + beyond * places[k].Out[1] });
    double outer = 0;
    screws.BoneThickness = FindThickness(rays, direction, ScrewArea / chart.GetScale(), outer);
    if (screws.BoneThickness > 0)
    {
      screws.OnImplant = slab.GetPoint(screws.Foot, 0);
      screws.OnBone = rays.Center + outer * direction;
      candidates.push_back({ screws, k });
    }
  }
  const double share = static_cast<double>(places.size()) / options.Plates;
  for (int plate = 0; plate < options.Plates; ++plate)
  {
    if (const PlateCandidate* best =
          ChoosePlate(candidates, (plate + 0.5) * share, share, options.ScrewLength))
    {
      plates.push_back(best->Screws);
    }
  }
  return plates;
}

//------------------------------------------------------------------------------
double GetLeastToRim(const SkullImplantOptions& options, double diameter)
{
  return std::max(NearRim * options.RimDistance, 0.5 * diameter + LeastHoleToRim);
}

//------------------------------------------------------------------------------
std::vector<ImplantHole> PlaceHoles(const ImplantSlab& slab, const ImplantRim& rim,
  const std::vector<Loop>& outline, const std::vector<Vec2>& screws, const TextPlace& text,
  const SkullImplantOptions& options, Execution& execution)
{
  std::vector<ImplantHole> holes;
  std::vector<std::array<Vec3, 2>> axes;
  const auto add = [&](const Vec2& p, double radius, double toRim)
  {
    Vec2 inner{};
    if (rim.Find(p, toRim + 1, inner) < toRim ||
      (text.IsGood && text.GetDistance(inner) < radius + BetweenHoles))
    {
      return;
    }
    const std::array<Vec3, 2> axis{ slab.GetPoint(p, 0), slab.GetPoint(inner, 1) };
    for (std::size_t k = 0; k < holes.size(); ++k)
    {
      if (std::min(Norm(axis[0] - axes[k][0]), Norm(axis[1] - axes[k][1])) <
        holes[k].Radius + radius + BetweenHoles)
      {
        return;
      }
    }
    holes.push_back({ p, radius });
    axes.push_back(axis);
  };
  for (const Vec2& p : screws)
  {
    add(p, 0.5 * options.ScrewDiameter, GetLeastToRim(options, options.ScrewDiameter));
  }
  if (options.SutureSpacing > 0)
  {
    for (const Loop& loop : outline)
    {
      for (const RimPlace& place : WalkRim(loop, options.SutureSpacing))
      {
        Vec2 p{};
        if (GoInwards(rim, place, options.RimDistance, p))
        {
          add(p, 0.5 * options.SutureDiameter, GetLeastToRim(options, options.SutureDiameter));
        }
      }
    }
  }
  if (options.DrainageSpacing > 0)
  {
    const double radius = 0.5 * options.DrainageDiameter;
    for (const Vec2& p : FillWithLattice(execution, outline, options.DrainageSpacing, 1))
    {
      add(p, radius, options.RimDistance + radius);
    }
  }
  return holes;
}

namespace
{
class Mesher
{
public:
  Mesher(const ImplantSlab& slab, double size, Execution& execution, SkullImplant& implant)
    : Slab(slab)
    , Size(size)
    , Run(execution)
    , Implant(implant)
  {
  }

  // Points of both surfaces are those of the slab.
  std::vector<Vec2> Make(
    const std::vector<std::vector<Loop>>& levels, const std::vector<Loop>& text)
  {
    Rings rings; // level by level, loop by loop
    for (int level = 0; level <= this->Slab.Steps; ++level)
    {
      this->AddRings(levels[level], this->Slab.DepthOf(level), rings);
    }
    const std::size_t loops = levels[0].size();
    this->AddFace(levels.front(), &rings[0], 0, SkullImplantFace::Outer);
    const std::size_t above = this->Slab.Steps * loops;
    for (std::size_t r = 0; r < above; ++r)
    {
      this->AddWall(rings[r], rings[r + loops], SkullImplantFace::Edge);
    }
    Rings below(rings.begin() + static_cast<std::ptrdiff_t>(above), rings.end());
    std::vector<Loop> face = levels.back();
    face.insert(face.end(), text.begin(), text.end());
    this->AddRings(text, 1, below);
    this->AddFace(face, &below[0], 1, SkullImplantFace::Inner);
    if (!text.empty())
    {
      Rings floor;
      this->AddRings(text, Floor, floor);
      this->AddFace(text, &floor[0], Floor, SkullImplantFace::Text);
      for (std::size_t k = 0; k < floor.size(); ++k)
      {
        this->AddWall(below[loops + k], floor[k], SkullImplantFace::Text);
      }
    }
    return std::move(this->Feet);
  }

private:
  using Ring = std::vector<std::int32_t>;
  using Rings = std::vector<Ring>;
  static constexpr double Floor = -1; // a depth: of engraved text

  void AddRings(const std::vector<Loop>& loops, double depth, Rings& rings)
  {
    for (const Loop& loop : loops)
    {
      rings.emplace_back();
      for (const Vec2& p : loop)
      {
        rings.back().push_back(this->AddPoint(p, depth));
      }
    }
  }

  std::int32_t AddPoint(const Vec2& p, double depth)
  {
    const double thickness = Norm(this->Slab.GetPoint(p, 0) - this->Slab.GetPoint(p, 1));
    const double taken = depth == Floor ? EngravedDepth : 0;
    const double part = depth == Floor ? 1 - taken / thickness : depth;
    this->Feet.push_back(p);
    this->Implant.Points.push_back(this->Slab.GetPoint(p, part));
    this->Implant.Thickness.push_back(thickness - taken);
    return static_cast<std::int32_t>(this->Implant.Points.size()) - 1;
  }

  // What is solid is on the left of the rings.
  void AddWall(const Ring& upper, const Ring& lower, SkullImplantFace face)
  {
    for (std::size_t k = 0; k < upper.size(); ++k)
    {
      const std::size_t next = (k + 1) % upper.size();
      this->AddTriangle(upper[k], lower[k], lower[next], face);
      this->AddTriangle(upper[k], lower[next], upper[next], face);
    }
  }

  // rings: points of the loops.
  void AddFace(
    const std::vector<Loop>& loops, const Ring* rings, double depth, SkullImplantFace face)
  {
    const bool isOuter = face == SkullImplantFace::Outer;
    Loop feet;
    std::vector<std::int32_t> points;
    Rings edges;
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
    for (const Vec2& p : FillWithLattice(this->Run, loops, this->Size, LatticeToRim * this->Size))
    {
      feet.push_back(p);
      points.push_back(this->AddPoint(p, depth));
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

  const ImplantSlab& Slab;
  double Size;
  Execution& Run;
  SkullImplant& Implant;
  std::vector<Vec2> Feet; // of the points that are added
};
}

//------------------------------------------------------------------------------
std::vector<Vec2> AddImplantMesh(const ImplantSlab& slab,
  const std::vector<std::vector<Loop>>& levels, const std::vector<Loop>& text, double triangleSize,
  Execution& execution, SkullImplant& implant)
{
  return Mesher(slab, triangleSize, execution, implant).Make(levels, text);
}
}
