// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Filters that rank the samples of a window: median, any percentile, mode (truncated median).
///
/// The result is one of the samples, exactly. NaN samples are left out of the windows of their
/// neighbours and stay NaN themselves. Borders: the nearest sample is repeated.
#ifndef lacunaRankFilter_h
#define lacunaRankFilter_h

#include "lacunaExecution.h"
#include "lacunaImageView.h"
#include "lacunaVectorUnit.h"
#include "lacunaWindow.h"

namespace lacuna
{
struct RankParameters
{
  /// The sample of rank min(n - 1, n * Percentile / 100), 0-based, of the n in the window, rounded
  /// down: 50 is the median (the upper one of an even number), 0 the least, 100 the greatest.
  double Percentile = 50;
  /// The mode, estimated by a median truncated once (Davies 1988; Evans & Nixon 1993): with least
  /// a, greatest b and median m of the window, when m - a < b - m samples above 2 m - a are left
  /// out, when m - a > b - m those below 2 m - b; the result is the median of the rest.
  bool Mode = false;
  VectorUnit Set = BestVectorUnit();
};

/// Filters the samples of output.Box from those of input, whose box contains it; input must reach
/// window.Grow(output.Box) except where the image ends. T: the fixed-width integers, float, double.
/// Throws std::invalid_argument for a window of more than MaximumRankSamples (lacunaRankBlocks.h).
template <class T>
void FilterRank(const ImageView<const T>& input, const ImageView<T>& output, const Window& window,
  const RankParameters& parameters, Execution& execution);
}
#endif
