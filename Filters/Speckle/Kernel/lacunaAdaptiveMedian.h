// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The adaptive weighted median (Loupas, McDicken & Allan 1989; Evans & Nixon 1993; Carr 1996,
/// section 4.5.4).
///
/// In a window of mean m and variance v (of its population) the sample at distance d from the
/// centre, in samples, has the weight w = max(0, 99 - Strength d v / |m|), rounded to a whole
/// number. The result is the least sample such that it and those not above it weigh more than half
/// of all (rounded down). Where v / |m| is small, in fully developed speckle, this is the median;
/// at an edge only samples near the centre count. With m = 0 and v > 0 the sample stays
/// (unless Strength is 0: that is the plain median).
///
/// NaN samples are left out and stay NaN. Borders: the nearest sample is repeated. The cost grows
/// with the number of samples in the window.
#ifndef lacunaAdaptiveMedian_h
#define lacunaAdaptiveMedian_h

#include "lacunaExecution.h"
#include "lacunaImageView.h"
#include "lacunaWindow.h"

namespace lacuna
{
/// As FilterRank. Throws std::invalid_argument when strength is negative or not finite.
template <class T>
void FilterAdaptiveMedian(const ImageView<const T>& input, const ImageView<T>& output,
  const Window& window, double strength, Execution& execution);
}
#endif
