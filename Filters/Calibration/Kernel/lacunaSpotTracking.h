// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which of the bright spots of a sweep's slices is the wire that is followed.
#ifndef lacunaSpotTracking_h
#define lacunaSpotTracking_h

#include "lacunaGreyImage.h"
#include "lacunaVector.h"

#include <optional>
#include <vector>

namespace lacuna
{
struct Spot
{
  Vec2 Pixel{ 0, 0 }; ///< column and row of its centre, between pixels
  double Level = 0;   ///< grey levels by which its peak is above its surroundings
  /// 0 to 1: how far it stands out of what is around it. 1: nothing else is there, 0: something half
  /// as bright. Wires in water have over 0.7, the best peaks of mere speckle 0.2 to 0.45.
  double Score = 0;
};

/// The spots of a slice whose Score is above 0.1, the most likely one (Score times Level) first, at
/// most 8.
///
/// A spot is a peak of the slightly smoothed image (a Gaussian of 1.5 pixels) that falls to its
/// half within a twelfth of the image's width at both sides and a twentieth of its height above, and
/// is brighter than what is in a ring around it. What lies below is not asked: wires have tails and
/// echoes there. A spot below a brighter or nearly as bright one is taken for its echo, and its Score
/// is halved. The centre is that of the levels above 70 % of the peak, so that tails weaker than
/// that do not move it, nor does saturation.
///
/// Empty for images smaller than 16 x 16 or all of one grey.
std::vector<Spot> FindSpots(const GreyImage& image);

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
