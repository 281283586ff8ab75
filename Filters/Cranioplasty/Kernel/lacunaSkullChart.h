// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Directions from the middle of a skull as points of a plane, and areas in it.
#ifndef lacunaSkullChart_h
#define lacunaSkullChart_h

#include "lacunaPlanarCurves.h"
#include "lacunaVector.h"

#include <cmath>
#include <cstdint>
#include <vector>

namespace lacuna
{
/// Directions as points of a plane: the distance from the middle is the angle (azimuthal equidistant), mm at
/// a typical radius.
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

/// Nodes that cover points and a margin around them.
PlanarGrid MakeGrid(const std::vector<Vec2>& points, double margin, double spacing);

/// For each node the distance to the nearest of some points, at most limit.
std::vector<double> FindDistances(
  const PlanarGrid& grid, const std::vector<Vec2>& points, double limit);

/// Connected nodes (four neighbours) where values are positive, the most first. Values at the border must not be.
std::vector<std::vector<std::int64_t>> FindFreeParts(
  const PlanarGrid& grid, const std::vector<double>& values);

/// Points about so far apart along a closed polygon.
Loop Resample(const Loop& loop, double spacing);

/// The loop of the largest area and the loops within it.
std::vector<Loop> KeepLargest(std::vector<Loop> loops);

double GetArea(const std::vector<Loop>& loops);

bool CrossesItself(const Loop& loop);
}
#endif
