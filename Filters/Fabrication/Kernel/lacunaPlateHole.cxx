// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPlateHole.h"

#include "lacunaParameterText.h"

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
}
