// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which of the bright spots of a sweep's slices is the wire that is followed.
#ifndef lacunaSpotTracking_h
#define lacunaSpotTracking_h

#include "lacunaSpotDetection.h"

#include <optional>
#include <vector>

namespace lacuna
{
/// A slice of a sweep that shows one wire or none.
struct SpotSlice
{
  std::vector<Spot> Spots;   ///< as found
  std::optional<Vec2> Known; ///< where the wire is, if someone has said so
};

/// The slices' spots that belong together, or none: the choice that costs least. A spot costs what
/// its Score times its brightness lacks to 1; 60 % of what is usual for the best spots of the slices
/// is bright enough. A slice without costs 0.5. A step from slice to slice costs the more the farther
/// it is (by the square), up to that of a jump from reach on (pixels a slice). A jump costs 2 in a
/// sweep, 0.15 where most of the best spots move by more than half of reach: there slices do not
/// follow one another closely and each is judged for itself, as after 10 slices without. The
/// result's Score is that product. Known places
/// are fixed (Score 1, Level 0); in a sweep they lead the others.
///
/// Throws std::invalid_argument when reach is not above 0.
std::vector<std::optional<Spot>> TrackSpots(const std::vector<SpotSlice>& slices, double reach);
}
#endif
