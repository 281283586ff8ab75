// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where a tracked receiver has been, and when it came back.
#ifndef lacunaReceiverPlaces_h
#define lacunaReceiverPlaces_h

#include "lacunaMatrix4.h"

#include <cstddef>
#include <vector>

namespace lacuna
{
/// Poses that are alike make a place: its first pose is the middle, and the others lie within a
/// distance of it and are turned by no more than an angle. A pose belongs to the nearest place. A
/// visit of a place lasts until the receiver has been twice as far from its middle, or turned twice
/// as much: then coming back is another visit.
struct ReceiverPlaces
{
  /// poses: rigid, in the order in which they were taken, positions below 1e6 mm. distance in mm and
  /// angle in degrees, both above 0.
  ReceiverPlaces(const std::vector<Matrix4>& poses, double distance, double angle);

  std::vector<std::size_t> Place;   ///< of each pose
  std::vector<std::size_t> Visit;   ///< of each pose, numbered through all places
  std::vector<std::size_t> Middles; ///< of each place, the number of its first pose
  std::vector<std::size_t> Visited; ///< of each visit, the place
};

/// By which angle, 0 to 180 degrees, two rigid poses are turned against each other.
double GetTurn(const Matrix4& a, const Matrix4& b);
}
#endif
