// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Exact Euclidean distance transform of a rectangular grid.
#ifndef lacunaDistanceTransform_h
#define lacunaDistanceTransform_h

#include "lacunaVector.h"

#include <vector>

namespace lacuna
{
class Execution;

/// For each pixel the squared distance in mm^2 from its centre to the centre of the nearest pixel
/// whose feature is not 0; infinite when there is none. Row after row, width x height pixels,
/// spacing in mm. Exact up to rounding, in linear time, by the lower envelope of parabolas
/// (Felzenszwalb and Huttenlocher, Theory of Computing 8, 2012), after a 1-D pass along columns.
std::vector<double> SquaredDistanceTransform(Execution& execution, int width, int height,
  const Vec2& spacing, const std::vector<unsigned char>& feature);
}
#endif
