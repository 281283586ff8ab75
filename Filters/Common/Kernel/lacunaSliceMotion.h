// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How fast the probe moved, and how far off a tracked point is to be expected.
#ifndef lacunaSliceMotion_h
#define lacunaSliceMotion_h

#include "lacunaMatrix4.h"

#include <array>
#include <vector>

namespace lacuna
{
/// For each slice the speed in mm/s of its fastest corner since the slice before that is usable and
/// has a time; for the first one, to the slice after it (Carr 1996, ch. 2: the extreme points of
/// the field of view). poses map corners (column, row, 0) to mm. NaN where there is no speed: for
/// slices that are not usable or whose time is not finite, and where two slices have no time
/// between them or times run backwards.
std::vector<double> GetSliceSpeeds(const std::vector<Matrix4>& poses,
  const std::vector<char>& usable, const std::vector<double>& times,
  const std::array<Vec3, 4>& corners);

/// Root mean square errors of a tracker.
struct TrackerAccuracy
{
  double Translation = 1.38; ///< mm, of the three axes together
  double Angle = 0.26;       ///< degrees, likewise
};

/// Root mean square error in mm to be expected of a point that lies distance mm from the tracker's
/// sensor on the probe: e^2 = translation^2 + (2 distance sin(angle / 2))^2 (Carr 1996, ch. 2).
double GetRegistrationError(const TrackerAccuracy& accuracy, double distance);
}
#endif
