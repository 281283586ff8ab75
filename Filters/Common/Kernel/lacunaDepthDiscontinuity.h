// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The nine cases: where a line of depths is torn, and which slope holds at a pixel. Shared by all
/// normals from depths and by triangles, so that they see the same edges. Carr 1996, 3.3.2.2 and
/// figure 3.8.
#ifndef lacunaDepthDiscontinuity_h
#define lacunaDepthDiscontinuity_h

#include "lacunaProperties.h"

#include <cmath>
#include <limits>

namespace lacuna
{
struct DiscontinuityLimits
{
  double MaximumAngle = 65;       ///< degrees
  double MaximumAngleChange = 20; ///< degrees

  void Describe(Properties& properties) const; ///< with the ranges

  /// Throws std::invalid_argument that names the angle that is out of range or not a number.
  void Check() const;
};

/// From one point of a depth map to a neighbour. Its angle against the plane perpendicular to the ray
/// is -90..90 degrees; in a parallel map Across is the distance of the pixels.
struct DepthStep
{
  double Along = 0;  ///< mm along the ray, positive away from the viewer; NaN: a point is missing
  double Across = 0; ///< mm perpendicular to the ray, >= 0

  bool IsDefined() const { return !std::isnan(this->Along); }

  static DepthStep Missing() { return { std::numeric_limits<double>::quiet_NaN(), 0 }; }
};

/// The cases in the order in which they are tried; the first that holds counts. "Backward" is the
/// step from the pixel before to this one, "forward" that from this one to the next. A discontinuity
/// lies in both steps of a spike, in the forward one of TornForward, in the backward one of
/// TornBackward, and nowhere in the other cases.
enum class SlopeCase
{
  Alone = 1,        ///< neither neighbour has a depth: slope 0
  ForwardOnly = 2,  ///< only the next has one: forward slope
  BackwardOnly = 3, ///< only the one before has one: backward slope (figure 3.8 misprints it)
  Smooth = 4,       ///< the angles differ by less than MaximumAngleChange: central slope
  Spike = 5,        ///< both steeper than MaximumAngle, opposite signs: slope 0
  Steep = 6,        ///< both steeper than MaximumAngle, same sign: central slope
  TornForward = 7,  ///< only the forward one is steeper: backward slope
  TornBackward = 8, ///< only the backward one is steeper: forward slope
  Crease = 9        ///< neither is steeper: central slope
};

inline bool IsTornForward(SlopeCase c)
{
  return c == SlopeCase::Spike || c == SlopeCase::TornForward;
}

inline bool IsTornBackward(SlopeCase c)
{
  return c == SlopeCase::Spike || c == SlopeCase::TornBackward;
}

/// Which of the steps make the slope at a pixel: both or none is the central one or slope 0.
inline bool UsesBackward(SlopeCase c)
{
  return c != SlopeCase::Alone && c != SlopeCase::Spike && c != SlopeCase::ForwardOnly &&
    c != SlopeCase::TornBackward;
}

inline bool UsesForward(SlopeCase c)
{
  return c != SlopeCase::Alone && c != SlopeCase::Spike && c != SlopeCase::BackwardOnly &&
    c != SlopeCase::TornForward;
}

/// Finds the case of a pixel from the components of its steps, without computing an angle.
class SlopeRule
{
public:
  /// Throws what limits.Check throws.
  explicit SlopeRule(const DiscontinuityLimits& limits);

  /// Whether a step that is defined is steeper than MaximumAngle.
  bool IsSteep(const DepthStep& step) const
  {
    return std::abs(step.Along) * this->CosineOfAngle > step.Across * this->SineOfAngle;
  }

  SlopeCase Classify(const DepthStep& backward, const DepthStep& forward) const
  {
    if (!backward.IsDefined())
    {
      return forward.IsDefined() ? SlopeCase::ForwardOnly : SlopeCase::Alone;
    }
    if (!forward.IsDefined())
    {
      return SlopeCase::BackwardOnly;
    }
    // of the angle between both steps, times their lengths
    const double sine = std::abs(backward.Along * forward.Across - forward.Along * backward.Across);
    const double cosine = backward.Along * forward.Along + backward.Across * forward.Across;
    if (sine * this->CosineOfChange < cosine * this->SineOfChange)
    {
      return SlopeCase::Smooth;
    }
    const bool steepBackward = this->IsSteep(backward);
    const bool steepForward = this->IsSteep(forward);
    if (steepBackward && steepForward)
    {
      return (backward.Along < 0) != (forward.Along < 0) ? SlopeCase::Spike : SlopeCase::Steep;
    }
    return steepForward ? SlopeCase::TornForward
      : steepBackward   ? SlopeCase::TornBackward
                        : SlopeCase::Crease;
  }

  /// The slope along a line of pixels of a parallel map, mm of depth per mm: of the pixel between two
  /// others spacing mm away. NaN is a neighbour without a depth; here is a number.
  double SlopeAt(double before, double here, double after, double spacing) const
  {
    const DepthStep backward{ here - before, spacing };
    const DepthStep forward{ after - here, spacing };
    const SlopeCase c = this->Classify(backward, forward);
    const bool usesBackward = UsesBackward(c);
    const bool usesForward = UsesForward(c);
    return ((usesBackward ? backward.Along : 0) + (usesForward ? forward.Along : 0)) /
      (usesBackward && usesForward ? 2 * spacing : spacing);
  }

private:
  double SineOfAngle;
  double CosineOfAngle;
  double SineOfChange;
  double CosineOfChange;
};
}
#endif
