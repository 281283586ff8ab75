// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Parallel lines over a surface and the tool dropped along them.
#ifndef lacunaRaster_h
#define lacunaRaster_h

#include "lacunaDropCutter.h"
#include "lacunaToolPath.h"

#include <limits>
#include <vector>

namespace lacuna
{
class Execution;

/// Parallel lines over the rectangle around a surface, seen along -z.
class Raster
{
public:
  /// overrun: mm by which the rectangle is larger on each side.
  Raster(const MillSurface& surface, double degrees, double overrun = 0);

  /// A line from its first to its last point; both sit on the rectangle's border.
  struct Line
  {
    Vec2 First;
    Vec2 Last;
    double GetLength() const;
  };
  /// Across the lines, from one end of the rectangle to the other.
  double GetFirst() const { return this->Range[0]; }
  double GetLast() const { return this->Range[1]; }
  /// The line at offset; its length is 0 when it touches the rectangle in a point.
  Line GetLine(double offset) const;

  /// Offsets from GetFirst to GetLast in equal steps of at most step.
  std::vector<double> GetOffsets(double step) const;
  /// Offsets such that the tool's places on neighbouring lines are at most distance apart in space,
  /// as long as no step is less than a quarter of it. positions are along apart.
  std::vector<double> GetOffsets(
    Execution& execution, const DropCutter& cutter, double distance, double along) const;

private:
  Vec2 Along;
  Vec2 Across;
  Vec2 Low;
  Vec2 High;
  double Overrun;
  double Range[2];
};

/// Rounds to whole micrometres: x and y to the nearest, z up.
Vec3 ToMicrometres(double x, double y, double z);

/// Straight motions that follow a surface.
class PathTracer
{
public:
  /// beyond: positions outside of the surface are those of DropCutter::DropBeyond. floor: the tool's
  /// tip goes no lower.
  PathTracer(const DropCutter& cutter, double tolerance, bool beyond,
    double floor = -std::numeric_limits<double>::infinity())
    : Cutter(cutter)
    , Tolerance(tolerance)
    , Beyond(beyond)
    , Floor(floor)
  {
  }

  /// The position at x, y; its z is -infinity where there is no surface.
  Vec3 GetPosition(double x, double y);

  /// Adds a straight motion to point, which is a position, to points, which are not empty: with
  /// positions between where it would cut into the surface or (follow) leave too much. Where
  /// positions between do not help both ends are lifted.
  void Connect(std::vector<Vec3>& points, Vec3 point, bool follow);

private:
  const DropCutter& Cutter;
  double Tolerance;
  bool Beyond;
  double Floor;
  DropCutter::Scratch Scratch;
};
}
#endif
