// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The bright spot that a thin wire or a small ball is in a B-scan.
#ifndef lacunaSpotDetection_h
#define lacunaSpotDetection_h

#include "lacunaGreyImage.h"
#include "lacunaVector.h"

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
}
#endif
