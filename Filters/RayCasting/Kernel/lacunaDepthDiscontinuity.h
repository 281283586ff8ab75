// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The nine cases: where a row of depths is torn, and which slope holds at a pixel. Shared by normals
/// and triangles, so that both see the same edges. Carr 1996, 3.3.2.2 and figure 3.8.
#ifndef lacunaDepthDiscontinuity_h
#define lacunaDepthDiscontinuity_h

namespace lacuna
{
struct DiscontinuityLimits
{
  double MaximumAngle = 65;       ///< degrees, 0..90
  double MaximumAngleChange = 20; ///< degrees, 0..180

  /// Throws std::invalid_argument that names the angle that is out of range or not a number.
  void Check() const;
};

/// The cases in the order in which they are tried; the first that holds counts. "Backward" is the
/// interval from the pixel before to this one, "forward" that from this one to the next. A
/// discontinuity lies in both intervals of a spike, in the forward one of TornForward, in the
/// backward one of TornBackward, and nowhere in the other cases.
enum class SlopeCase
{
  Alone = 1,        ///< neither neighbour has a depth: slope 0
  ForwardOnly = 2,  ///< only the next has one: forward slope
  BackwardOnly = 3, ///< only the one before has one: backward slope (figure 3.8 misprints it)
  Smooth = 4,       ///< the slopes differ by less than MaximumAngleChange: central slope
  Spike = 5,        ///< both steeper than MaximumAngle, opposite signs: slope 0
  Steep = 6,        ///< both steeper than MaximumAngle, same sign: central slope
  TornForward = 7,  ///< only the forward one is steeper: backward slope
  TornBackward = 8, ///< only the backward one is steeper: forward slope
  Crease = 9        ///< neither is steeper: central slope
};

/// The case of a pixel whose intervals have these angles against the plane perpendicular to the ray,
/// in degrees; NaN where the neighbour has no depth.
SlopeCase ClassifySlopes(double backward, double forward, const DiscontinuityLimits& limits);

inline bool IsTornForward(SlopeCase c)
{
  return c == SlopeCase::Spike || c == SlopeCase::TornForward;
}

inline bool IsTornBackward(SlopeCase c)
{
  return c == SlopeCase::Spike || c == SlopeCase::TornBackward;
}
}
#endif
