// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The points of a structured grid that is a surface, for the filters of this module.
#ifndef lacunaGridLayer_h
#define lacunaGridLayer_h

#include "lacunaSurfaceFit.h"

#include <vector>

class vtkStructuredGrid;

namespace lacuna
{
/// A structured grid with exactly one dimension of 1.
struct GridLayer
{
  GridSize Size;            ///< the other two dimensions in their order
  std::vector<Vec3> Points; ///< column fastest

  /// Throws std::runtime_error, in words for the user, when grid has more or fewer dimensions of 1,
  /// or blanked points or cells, or is the plane of a depth map's pixels (what Transform makes of one)
  /// instead of its surface.
  explicit GridLayer(vtkStructuredGrid* grid);
};
}
#endif
