// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where one sweep ends and the next one begins, found in the poses and times of the slices.
///
/// A person lifts the probe and puts it down elsewhere, or presses Start twice: nothing was seen on
/// the way. The rule compares each step between consecutive slices with the usual step near it.
///
/// - A step is the largest distance that a corner moves from one slice to the next, mm.
/// - The usual step is the third quartile of the steps near it: of the 32 before and the 32 after
///   it. Slices at rest, within 1 % of the image's diagonal of each other, count as one, so
///   that a probe that waits, and one that moves step by step, have a usual step, too.
/// - Missing slices. A step takes so many usual intervals of slice number and of time (third
///   quartiles of the same steps). It is explained by missing slices when these are at most 10, and
///   when the probe goes on in the direction in which it moved before and moves afterwards.
/// - The limit is 3 usual steps. For a step that goes on in that direction, and takes at most 10
///   intervals, it is 8 usual steps, or 2 usual steps for each interval if that is more.
/// - A longer step ends the sweep, unless the probe moves fast there: it takes at most 10 intervals,
///   and a step beside it has the same direction and at least 0.4 of its speed.
///
/// Whether a step ends a sweep depends on the steps near it alone. So the answer does not change
/// once the probe has moved on by 32 steps, however the slices arrive.
#ifndef lacunaSweepEnds_h
#define lacunaSweepEnds_h

#include "lacunaPoseOutliers.h"

#include <cstddef>
#include <vector>

namespace lacuna
{
struct SweepEnd
{
  std::size_t Next; ///< index of the first slice of the next sweep
  double Distance;  ///< mm from the last slice to this one
  double Limit;     ///< mm; the longest step that would not have ended the sweep here
  double Time;      ///< s from the last slice to this one; NaN when it is not known
};

/// slices: in their order, with finite corners. times: s, one for each slice, NaN where it is not
/// known. The ends come in the order of the slices.
std::vector<SweepEnd> FindSweepEnds(
  const std::vector<SlicePlace>& slices, const std::vector<double>& times);
}
#endif
