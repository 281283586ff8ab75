// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Points that tell how something has been moved since they were taken.
#ifndef lacunaLandmarks_h
#define lacunaLandmarks_h

#include "lacunaMatrix4.h"
#include "lacunaVector.h"

#include <array>
#include <cstddef>
#include <vector>

namespace lacuna
{
/// Indices of four points that are far apart and not in a plane: the first one, the one farthest from
/// it, and those that span the largest triangle and tetrahedron with these. False when the points are
/// within a micrometre of a plane.
bool FindLandmarks(const std::vector<Vec3>& points, std::array<std::size_t, 4>& indices);

/// What has become of four landmarks.
struct LandmarkMove
{
  double Stretch = 0;    ///< mm, largest change of a distance between two of them
  bool Mirrored = false; ///< a left hand has become a right hand
  double Tilt = 0;       ///< degrees between the z axes before and after
  double Way = 0;        ///< mm, of the one that has moved most
  double Rise = 0;       ///< mm, mean change of z
};
LandmarkMove CompareLandmarks(const std::array<Vec3, 4>& before, const std::array<Vec3, 4>& after);

/// The affine map that takes four landmarks, not in a plane, to where they are.
Matrix4 MapLandmarks(const std::array<Vec3, 4>& before, const std::array<Vec3, 4>& after);
}
#endif
