// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A parallel depth map's mirror image, seen in the map's own view.
#ifndef lacunaMirroredMap_h
#define lacunaMirroredMap_h

#include "lacunaDepthGrid.h"
#include "lacunaDepthMapMesher.h"
#include "lacunaExecution.h"
#include "lacunaMirrorPlane.h"
#include "lacunaSymmetrySearch.h"

#include <vector>

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

struct MirroredMap
{
  std::vector<double> Depth;     ///< NaN where the mirrored surface is not seen
  std::vector<float> Normals;    ///< x 3, world, unit; 0 where not seen; empty without given ones
  std::vector<double> Asymmetry; ///< given minus mirrored depth, mm; NaN where there are not both
  double Score = 0;              ///< Concordance of given and mirrored depths; may be NaN
  double RMS = 0;                ///< of Asymmetry
  double Median = 0;             ///< of its absolute value
  double Overlap = 0;            ///< part of the given pixels with a depth where there are both
};

/// The surface of a parallel map, in triangles as DepthMapMesher makes them, mirrored in a plane
/// (world mm) and seen in the map's own view: at each pixel the triangle nearest the viewer, and none
/// where that shows the viewer its back (there the solid's front was not seen in the map).
/// normals: x 3 per pixel, or null.
MirroredMap MirrorMap(const DepthGrid& map, const float* normals, const MirrorPlane& plane,
  const DiscontinuityRule& rule, Execution& execution);
}
#endif
