// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPlateOutline.h"

#include "lacunaDefectContours.h"
#include "lacunaExecution.h"
#include "lacunaParameterText.h"
#include "lacunaReliefSurface.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr double Pi = 3.14159265358979323846;
constexpr double ChordError = 0.002; // mm between circle and polygon
constexpr int MaximumSteps = 50;
constexpr double Converged = 1e-11; // mm

// rho = Radius + Growth * s, with s along the axis.
struct Cone
{
  double Radius;
  double Growth;
};

// Newton's method for the point of the offset surface at an angle on a cone about the axis.
bool FindOnCone(const ReliefSurface& surface, const ReliefSurface::Frame& axis, const Vec3& u,
  const Vec3& v, double angle, const Cone& cone, double level, Vec2& p)
{
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  for (int step = 0; step < MaximumSteps; ++step)
  {
    const auto frame = surface.GetFrame(p);
    const Vec3 w = frame.Offset(level) - axis.Point;
    const Vec3 x = frame.AlongX + level * frame.NormalAlongX;
    const Vec3 y = frame.AlongY + level * frame.NormalAlongY;
    const double rho = cone.Radius + cone.Growth * Dot(w, axis.Normal);
    const double f = Dot(w, u) - rho * c;
    const double g = Dot(w, v) - rho * s;
    const double fx = Dot(x, u) - cone.Growth * Dot(x, axis.Normal) * c;
    const double fy = Dot(y, u) - cone.Growth * Dot(y, axis.Normal) * c;
    const double gx = Dot(x, v) - cone.Growth * Dot(x, axis.Normal) * s;
    const double gy = Dot(y, v) - cone.Growth * Dot(y, axis.Normal) * s;
    const double determinant = fx * gy - fy * gx;
    if (determinant == 0)
    {
      return false;
    }
    const Vec2 change{ (f * gy - g * fy) / determinant, (g * fx - f * gx) / determinant };
    p = { p[0] - change[0], p[1] - change[1] };
    if (!surface.Contains(p))
    {
      return false;
    }
    if (std::hypot(change[0], change[1]) < Converged)
    {
      return true;
    }
  }
  return false;
}
}

//------------------------------------------------------------------------------
bool FindFoot(const ReliefSurface& surface, const Vec3& p, Vec2& foot, double& offset)
{
  foot = { std::clamp(p[0], 0.0, surface.GetExtent()[0]),
    std::clamp(p[1], 0.0, surface.GetExtent()[1]) };
  offset = 0;
  for (int step = 0; step < MaximumSteps; ++step)
  {
    const auto frame = surface.GetFrame(foot);
    const Vec3 x = frame.AlongX + offset * frame.NormalAlongX;
    const Vec3 y = frame.AlongY + offset * frame.NormalAlongY;
    const Vec3 miss = p - frame.Offset(offset);
    const double determinant = Dot(Cross(x, y), frame.Normal);
    if (determinant == 0)
    {
      return false;
    }
    const double dx = Dot(Cross(miss, y), frame.Normal) / determinant;
    const double dy = Dot(Cross(x, miss), frame.Normal) / determinant;
    const double dt = Dot(Cross(x, y), miss) / determinant;
    foot = { foot[0] + dx, foot[1] + dy };
    offset += dt;
    if (!surface.Contains(foot))
    {
      return false;
    }
    if (std::abs(dx) + std::abs(dy) + std::abs(dt) < Converged)
    {
      return true;
    }
  }
  return false;
}

//------------------------------------------------------------------------------
PlateHole MakePlateHole(const ReliefSurface& surface, const Vec2& foot, const PlateLevels& levels,
  const HoleShape& shape, double spacing)
{
  const auto axis = surface.GetFrame(foot);
  const double radius = 0.5 * shape.Diameter;
  const double head = 0.5 * shape.CountersinkDiameter;
  const bool sunk = shape.CountersinkDiameter > 0;
  PlateHole hole;
  hole.Foot = foot;
  hole.Axis = axis.Normal;
  hole.Centre = axis.Offset(levels.Outer);
  hole.Radius = std::max(radius, head);

  const Vec3 u = Normalized(Cross({ 0, 1, 0 }, axis.Normal));
  const Vec3 v = Cross(axis.Normal, u);
  const double step =
    std::min(spacing / hole.Radius, 2 * std::acos(1 - std::min(1.0, ChordError / hole.Radius)));
  const int count = 4 * std::max(6, static_cast<int>(std::ceil(2 * Pi / step / 4)));

  Cone cone{ radius, 0 };
  double waist = 0; // where the cone meets the cylinder, along the axis
  if (sunk)
  {
    cone.Growth = std::tan(shape.CountersinkAngle * Pi / 360);
    cone.Radius = head - levels.Outer * cone.Growth;
    waist = levels.Outer - (head - radius) / cone.Growth;
  }
  hole.Rings.resize(sunk ? 3 : 2);
  hole.Land = levels.Outer - levels.Inner;
  for (int k = 0; k < count; ++k)
  {
    const double angle = 2 * Pi * k / count;
    const Vec3 direction = std::cos(angle) * u + std::sin(angle) * v;
    Vec2 outer{ foot[0] + hole.Radius * direction[0], foot[1] + hole.Radius * direction[1] };
    Vec2 inner{ foot[0] + radius * direction[0], foot[1] + radius * direction[1] };
    if (!FindOnCone(surface, axis, u, v, angle, cone, levels.Outer, outer) ||
      !FindOnCone(surface, axis, u, v, angle, { radius, 0 }, levels.Inner, inner))
    {
      throw std::runtime_error("does not lie within the plate");
    }
    hole.OuterFeet.push_back(outer);
    hole.InnerFeet.push_back(inner);
    const Vec3 top = surface.GetFrame(outer).Offset(levels.Outer);
    const Vec3 bottom = surface.GetFrame(inner).Offset(levels.Inner);
    hole.Rings.front().push_back(top);
    hole.Rings.back().push_back(bottom);
    if (sunk)
    {
      hole.Rings[1].push_back(axis.Point + waist * axis.Normal + radius * direction);
      hole.Land = std::min(hole.Land, waist - Dot(bottom - axis.Point, axis.Normal));
      if (Dot(top - axis.Point, axis.Normal) <= waist)
      {
        throw std::runtime_error("has a countersink that the plate is too curved for");
      }
    }
  }
  if (sunk && hole.Land < 0.1 * (levels.Outer - levels.Inner))
  {
    throw std::runtime_error("has a countersink that leaves " + FormatNumber(hole.Land) +
      " mm of the plate; make CountersinkDiameter smaller or CountersinkAngle larger");
  }
  return hole;
}

//------------------------------------------------------------------------------
namespace
{
constexpr double MaximumNodes = 3e7;

std::vector<Vec3> Lift(const ReliefSurface& surface, const Loop& loop)
{
  std::vector<Vec3> curve;
  curve.reserve(loop.size());
  for (const Vec2& p : loop)
  {
    curve.push_back(surface.GetPoint(p));
  }
  return curve;
}

// Points of the loop at equal distances in space of about spacing.
Loop Resample(const ReliefSurface& surface, const Loop& loop, double spacing, double& length)
{
  const std::vector<Vec3> curve = Lift(surface, loop);
  std::vector<double> at(loop.size() + 1, 0);
  for (std::size_t k = 0; k < loop.size(); ++k)
  {
    at[k + 1] = at[k] + Norm(curve[(k + 1) % loop.size()] - curve[k]);
  }
  length = at.back();
  const auto count =
    std::max<std::size_t>(8, static_cast<std::size_t>(std::ceil(length / spacing)));
  Loop result;
  result.reserve(count);
  std::size_t k = 0;
  for (std::size_t i = 0; i < count; ++i)
  {
    const double s = length * static_cast<double>(i) / static_cast<double>(count);
    while (at[k + 1] < s)
    {
      ++k;
    }
    const double t = at[k + 1] > at[k] ? (s - at[k]) / (at[k + 1] - at[k]) : 0;
    const Vec2& a = loop[k];
    const Vec2& b = loop[(k + 1) % loop.size()];
    result.push_back({ a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]) });
  }
  return result;
}

// The loop of the largest area among those that go counterclockwise; empty without one. others
// counts the rest with more than a speck of area.
Loop TakeLargest(const std::vector<Loop>& loops, double speck, int& pieces, int& islands)
{
  const Loop* largest = nullptr;
  double area = 0;
  pieces = islands = 0;
  for (const Loop& loop : loops)
  {
    const double a = SignedArea(loop);
    pieces += a > speck;
    islands += a < -speck;
    if (a > area)
    {
      area = a;
      largest = &loop;
    }
  }
  return largest ? *largest : Loop();
}

Loop FindDefect(GridSize size, const Vec2& spacing, const std::vector<unsigned char>& mask,
  std::vector<std::string>& warnings)
{
  int pieces;
  int islands;
  Loop loop = TakeLargest(FindDefectContours(size, spacing, mask), 0, pieces, islands);
  if (loop.size() < 8)
  {
    throw std::runtime_error(
      "the defect is too small for a plate: fewer than a few pixels of FilledMask are marked");
  }
  if (pieces > 1)
  {
    warnings.push_back("the map has " + std::to_string(pieces) +
      " separate defects; the plate is made for the largest. Mark one alone with DefectRegion of "
      "RBF Hole Filler to make it for another");
  }
  if (islands > 0)
  {
    warnings.push_back(
      std::to_string(islands) + " islands of sound bone lie in the defect; the plate covers them");
  }
  return SmoothStaircase(loop, std::sqrt(spacing[0] * spacing[1]));
}

// mm: notches are not sharper. Two fronts of an overlap that meet would else leave a slit that the
// faces cannot follow. A plate within the defect must not grow over the bone in a notch.
double GetNotchRadius(const PlateOutlineOptions& options)
{
  return options.Clearance < 0
    ? std::max(options.Spacing, std::min(options.CornerRadius, -options.Clearance))
    : std::min(options.Spacing, options.Clearance);
}

// Signed distances in space to a loop on the surface, positive inside, exact up to limit.
std::vector<double> GetDistances(Execution& execution, const ReliefSurface& surface,
  const PlanarGrid& grid, const Loop& loop, double limit)
{
  const CurveIndex index({ Lift(surface, loop) }, 2 * std::max(grid.Spacing[0], grid.Spacing[1]));
  std::vector<double> distances(static_cast<std::size_t>(grid.Columns * grid.Rows));
  execution.For(grid.Rows, 4,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t j = begin; j < end; ++j)
      {
        const std::vector<double> crossings = FindCrossings({ loop }, grid.GetNode(0, j)[1]);
        std::size_t passed = 0;
        for (std::int64_t i = 0; i < grid.Columns; ++i)
        {
          const Vec2 p = grid.GetNode(i, j);
          while (passed < crossings.size() && crossings[passed] <= p[0])
          {
            ++passed;
          }
          const double d = index.Find(surface.GetPoint(p), limit).Distance;
          distances[i + grid.Columns * j] = passed % 2 ? d : -d;
        }
      }
    });
  return distances;
}
}

//------------------------------------------------------------------------------
Vec2 PlateOutline::GetInset(std::size_t k, double distance) const
{
  const double t = distance / this->CornerRadius;
  const Vec2& p = this->Points[k];
  const Vec2& q = this->Core[k];
  return { p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1]) };
}

//------------------------------------------------------------------------------
namespace
{
// A lattice over a loop and a margin around it.
PlanarGrid CoverLoop(const Loop& loop, double margin, double h)
{
  PlanarGrid grid;
  grid.Spacing = { h, h };
  double high[2];
  for (int i = 0; i < 2; ++i)
  {
    const auto less = [i](const Vec2& a, const Vec2& b) { return a[i] < b[i]; };
    const auto range = std::minmax_element(loop.begin(), loop.end(), less);
    grid.Origin[i] = (*range.first)[i] - margin;
    high[i] = (*range.second)[i] + margin;
  }
  const double columns = std::ceil((high[0] - grid.Origin[0]) / h) + 1;
  const double rows = std::ceil((high[1] - grid.Origin[1]) / h) + 1;
  if (columns * rows > MaximumNodes)
  {
    throw std::runtime_error("the outline would be sought on over thirty million points; make "
                             "TriangleSize larger than " +
      FormatNumber(h) + " mm");
  }
  grid.Columns = static_cast<std::int64_t>(columns);
  grid.Rows = static_cast<std::int64_t>(rows);
  return grid;
}

// Moves loops along the surface.
struct LoopMover
{
  Execution& Run;
  const ReliefSurface& Surface;
  const PlanarGrid Grid;
  int Pieces = 0; // of the last loop
  int Islands = 0;

  Loop Move(const Loop& loop, double inwards)
  {
    const double h = this->Grid.Spacing[0];
    const std::vector<double> distances =
      GetDistances(this->Run, this->Surface, this->Grid, loop, std::abs(inwards) + 8 * h);
    return TakeLargest(
      FindContours(this->Grid, distances, inwards), h * h, this->Pieces, this->Islands);
  }
};

// The defect's outline moved inwards by the clearance and the radius of corners, without notches that are too narrow.
Loop FindCore(LoopMover& mover, PlateOutline& outline, const PlateOutlineOptions& options)
{
  const double radius = options.CornerRadius;
  const double notch = GetNotchRadius(options);
  const double inset = options.Clearance + radius;
  Loop core = outline.Defect;
  if (notch > 0)
  {
    core = mover.Move(core, options.Clearance - notch);
  }
  if (core.size() >= 3)
  {
    core = mover.Move(core, notch > 0 ? notch + radius : inset);
  }
  if (core.size() < 3)
  {
    throw std::runtime_error("no plate is left: the defect is nowhere wider than twice " +
      FormatNumber(std::round(100 * inset) / 100) +
      " mm (EdgeClearance plus the radius of corners, which is at least Bevel plus TriangleSize)");
  }
  if (mover.Pieces > 1)
  {
    outline.Warnings.push_back("the outline is narrower than " +
      FormatNumber(std::round(200 * inset) / 100) +
      " mm at places, where the plate would come apart into " + std::to_string(mover.Pieces) +
      " pieces; only the largest is made. Reduce EdgeClearance, Bevel or CornerRadius");
  }
  return core;
}

// Moves the outline's points so that they are exactly at the radius of corners from the core.
void PlaceExactly(const ReliefSurface& surface, const Loop& core, double h, PlateOutline& outline)
{
  const double radius = outline.CornerRadius;
  const CurveIndex index({ Lift(surface, core) }, 2 * h);
  for (Vec2& p : outline.Points)
  {
    Vec2 q = p;
    for (int iteration = 0; iteration < 4; ++iteration)
    {
      const CurveIndex::Nearest nearest = index.Find(surface.GetPoint(p), 2 * radius + 8 * h);
      q = { nearest.Point[0], nearest.Point[1] };
      const double t = nearest.Distance > 0 ? radius / nearest.Distance : 0;
      p = { q[0] + t * (p[0] - q[0]), q[1] + t * (p[1] - q[1]) };
    }
    outline.Core.push_back(q);
    if (!surface.Contains(p))
    {
      throw std::runtime_error(
        "the plate would reach beyond the fitted surface; raise "
        "SupportMargin or OutputMargin of RBF Hole Filler, or EdgeClearance");
    }
  }
}
}

//------------------------------------------------------------------------------
PlateOutline FindPlateOutline(Execution& execution, const ReliefSurface& surface, GridSize size,
  const Vec2& spacing, const std::vector<unsigned char>& mask, const PlateOutlineOptions& options)
{
  PlateOutline outline;
  outline.CornerRadius = options.CornerRadius;
  outline.Defect = FindDefect(size, spacing, mask, outline.Warnings);
  const double h = options.Spacing;
  const double margin = std::max(0.0, GetNotchRadius(options) - options.Clearance) + 4 * h;
  LoopMover mover{ execution, surface, CoverLoop(outline.Defect, margin, h) };
  const Loop core = FindCore(mover, outline, options);
  const Loop outer = mover.Move(core, -options.CornerRadius);
  outline.Points = Resample(surface, outer, h, outline.Length);
  PlaceExactly(surface, core, h, outline);
  return outline;
}
}
