// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How steeply a depth map rises, where its surface may break off between pixels.
#ifndef lacunaDepthSlope_h
#define lacunaDepthSlope_h

#include <cmath>

namespace lacuna
{
/// Slope of the depth along a line of pixels: mm of depth per mm, from a pixel (here) and its
/// neighbours on the line, spacing mm away. NaN is a neighbour without a depth; here is a number.
/// With the angles of the backward, forward and central differences against the image plane
/// (Carr 1996, 3.3.2.2 and figure 3.8):
/// 1. no neighbour has a depth: 0
/// 2. 3. only one has: the difference from it
/// 4. the backward and forward angles differ by less than 20 degrees: central
/// 5. both are steeper than 65 degrees, one up and one down: 0
/// 6. both are, the same way: central
/// 7. 8. only one is: the other, for the surface breaks off on the steep side
/// 9. else: central
inline double GetDepthSlope(double before, double here, double after, double spacing)
{
  constexpr double steep = 2.1445069205095586;              // tan 65 degrees
  constexpr double squareOfSmallChange = 0.883022221559489; // of cos 20 degrees
  const double backward = (here - before) / spacing;
  const double forward = (after - here) / spacing;
  if (std::isnan(backward))
  {
    return std::isnan(forward) ? 0 : forward;
  }
  if (std::isnan(forward))
  {
    return backward;
  }
  const double central = 0.5 * (backward + forward);
  // the cosine of the angle between (1, backward) and (1, forward)
  const double product = 1 + backward * forward;
  if (product > 0 &&
    product * product > squareOfSmallChange * (1 + backward * backward) * (1 + forward * forward))
  {
    return central;
  }
  const bool steepBackward = std::abs(backward) > steep;
  const bool steepForward = std::abs(forward) > steep;
  if (steepBackward && steepForward)
  {
    return (backward > 0) == (forward > 0) ? central : 0;
  }
  return steepForward ? backward : steepBackward ? forward : central;
}
}
#endif
