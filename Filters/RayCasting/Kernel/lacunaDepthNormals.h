// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Surface normals from the depths of a map alone. Carr 1996, 3.3.2.
///
/// Along the row and along the column of a pixel a tangent of the surface is taken from the points
/// of its neighbours in space; the normal is perpendicular to both. So a plane has its exact normal
/// by every method, in perspective maps too. In parallel maps the tangents' slopes are the partial
/// derivatives of depth.
#ifndef lacunaDepthNormals_h
#define lacunaDepthNormals_h

#include "lacunaDepthDiscontinuity.h"
#include "lacunaDepthGrid.h"
#include "lacunaExecution.h"

#include <array>
#include <cstdint>

namespace lacuna
{
/// How the tangent follows from the differences to the pixel before (backward) and to the next
/// (forward). Where only one neighbour has a depth, its difference is taken; where neither has, slope
/// 0: the tangent is perpendicular to the ray.
enum class DepthNormalMethod
{
  CentralDifference, ///< between the two neighbours, whatever lies between (eq. 3.10)
  Gordon,            ///< mean of both slopes, each weighted by GordonWeight (eq. 3.11)
  Predicate          ///< the slope that SlopeRule names (figure 3.8)
};

/// Gordon's weight of a slope (mm of depth per mm across the ray): 1 up to 2 (63 degrees), 1e-5 from
/// 5 on (79 degrees), a half wave of the cosine between (eq. 3.12, mended).
double GordonWeight(double slope);

/// The normals of the pixels of extent, which lies within the grid, row-major: x 3, unit, world,
/// towards the viewer; 0 where there is no depth. Neighbours beyond extent are used where the grid
/// has them. A normal that cannot be computed (points that coincide, depths too large for arithmetic)
/// is towards the viewer. limits are those of Predicate.
void EstimateNormals(const DepthGrid& grid, DepthNormalMethod method,
  const DiscontinuityLimits& limits, const std::array<int, 4>& extent, float* normals,
  Execution& execution);

/// Where a pixel with a depth has no normal (zero or not finite), makes it point along the ray back
/// to the viewer; makes all others unit, and 0 where there is no depth. Returns how many had none.
std::int64_t MendNormals(
  const DepthGrid& grid, const std::array<int, 4>& extent, float* normals, Execution& execution);

/// Degrees between the normals a and b, 0..180, NaN where either is zero or not finite.
void AnglesBetween(
  const float* a, const float* b, std::int64_t count, float* degrees, Execution& execution);
}
#endif
