// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Poses that cannot be true: a tracker that loses its sensor for a moment may report a place far
/// away, and one such slice would stretch a volume beyond all measure.
///
/// The step between two consecutive slices is the largest distance that a corner moves, divided by
/// the difference of their slice numbers (slices in between may be missing). A jump is a step
/// longer than both the diagonal of an image (the median one of the sweep) and 20 times the median
/// step. Jumps cut the sweep into groups; a slice after a jump may also continue one of the last 8
/// groups, from whose end it is no jump away. A group is an outlier when it has at most 3 slices
/// and at most a quarter as many as the longest group.
///
/// So sweeps of evenly long steps have no outliers, however long the steps are; nor has a sweep
/// during which the probe was lifted and put down elsewhere, nor one with a pause. Errors below the
/// size of an image are not found: they cannot be told from a hand that moves.
#ifndef lacunaPoseOutliers_h
#define lacunaPoseOutliers_h

#include "lacunaSliceImage.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lacuna
{
/// Where a slice lies.
struct SlicePlace
{
  std::int64_t Number; ///< in the sweep; increases from slice to slice
  std::array<Vec3, 4> Corners;
};

/// The largest distance between the same corners of two slices, mm.
double GetStep(const SlicePlace& a, const SlicePlace& b);

struct PoseOutliers
{
  /// Longest step, in mm from slice number to slice number, that is no jump; 0 when there are fewer
  /// than two slices.
  double LongestStep = 0;
  double MedianStep = 0;
  struct Outlier
  {
    std::size_t Index; ///< of the slice among those given
    double Distance;   ///< mm from the nearer one of the slices before and after it that are none
  };
  /// In the order of the slices.
  std::vector<Outlier> Outliers;
};

/// The outliers among the slices of one sweep, whose corners are finite.
PoseOutliers FindPoseOutliers(const std::vector<SlicePlace>& slices);
}
#endif
