// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The plane of best symmetry of a parallel depth map.
#ifndef lacunaMapSymmetry_h
#define lacunaMapSymmetry_h

#include "lacunaDepthGrid.h"
#include "lacunaExecution.h"
#include "lacunaSymmetrySearch.h"

namespace lacuna
{
/// The plane, world mm, in which the surface of a parallel depth map agrees best with its mirror
/// image, as far as both are seen in this view; its normal is more than 45 degrees off the view
/// direction. The rating is a mean over the points whose images fall on the map and face the viewer
/// (but no fewer than half of all): (1 - (r / t)^2) (2 cos a - 1), each factor at least 0, with r the
/// distance of an image from the surface, t 3 % of half the diagonal of the surface's box, and a the
/// angle between their normals. The last steps minimise Tukey's biweight of r. Throws
/// std::runtime_error when there are fewer than 100 points, and when no mirrored side is seen.
SymmetryResult FindSymmetryPlane(const DepthGrid& map, Execution& execution);
}
#endif
