// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Outlines of a surface in planes: the surface's normals there, and the error of its volume.
#ifndef lacunaOutlines_h
#define lacunaOutlines_h

#include "lacunaSurfaceSpline.h"
#include "lacunaTriangleSurface.h"
#include "lacunaVector.h"

#include <cstddef>
#include <vector>

namespace lacuna
{
class Execution;

/// Expected error of normals at outlines, as a tangent. They say the side and the scale; where the
/// surface goes is for the points to say.
constexpr double OutlineNormalError = 0.1;

/// Finds the normals of outlines (points with Free directions). They are known within their planes
/// only, but the slope there depends on the angle between plane and surface: it is its sine. So a
/// spline is fitted several times, each with the normals of the last one. data's normals become
/// these.
void FindOutlineNormals(
  Execution& execution, OrientedPoints& data, const SurfaceSplineOptions& options);

/// Standard error of the volume in a surface through outlines that errors of these cause, mm^3. The
/// misses of the outlines change their signs at random, a third of the extent at once since errors may
/// be alike along a line, and the surface is fitted again, 16 times (the wild bootstrap of clusters).
/// What no outline shows (a bulge between two of them) is not in it.
///
/// data as FindOutlineNormals leaves it; fit and surface are those of all points.
double EstimateVolumeError(Execution& execution, const OrientedPoints& data,
  const SurfaceSplineOptions& options, const SurfaceSplineReport& fit,
  const TriangleSurface& surface);

/// Numbers the pieces of outlines (points with Free directions, one after the other), each at most so
/// long, mm: one number for each point. Other points have one each.
std::vector<std::size_t> FindRuns(
  const std::vector<Vec3>& points, const std::vector<Vec3>& free, double longest);
}
#endif
