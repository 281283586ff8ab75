// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The fitted rectangle of a filled depth map, for the filters of this module.
#ifndef lacunaFittedPart_h
#define lacunaFittedPart_h

#include "lacunaMatrix4.h"
#include "lacunaSurfaceFit.h"

#include <cstdint>
#include <string>
#include <vector>

class vtkImageData;
class vtkPolyData;

namespace lacuna
{
class Execution;
}

namespace lacuna
{
/// The part of a parallel depth map on which Fitted is a number, or the outer face of a solid as such a part.
struct FittedPart
{
  std::int64_t Column = 0; ///< of its first pixel, from the first of the map
  std::int64_t Row = 0;
  GridSize Size;
  Vec2 Spacing{};                  ///< mm
  std::vector<double> Depths;      ///< Fitted, column fastest
  std::vector<unsigned char> Mask; ///< FilledMask: 1 in the defect
  /// mm from its first pixel along the map's axes (x right, y down, z away from the viewer) to world
  /// mm: a rotation and a translation.
  Matrix4 ToWorld;

  /// Throws std::runtime_error, in words for the user, when map is not a parallel depth map with
  /// Fitted and FilledMask, is marked as a mirror image (Mirrored), Fitted is not a complete
  /// rectangle, nothing is filled, or the map's axes are not right-handed and perpendicular. purpose: what needs the map, "a mould".
  FittedPart(vtkImageData* map, const std::string& purpose);

  /// The outer face (0) by the cell array ImplantFace or PlateFace of a solid, seen from where its steepest place is least steep,
  /// with as much around it as a margin in mm. spacing: of the samples, mm. Throws likewise, and when no view sees all of the face.
  FittedPart(Execution& execution, vtkPolyData* solid, double spacing, double margin,
    const std::string& purpose);

  // Of a solid, else 0.
  double Deviation = 0;     ///< mm, largest distance of the face's points from the surface
  double SteepestAngle = 0; ///< degrees, between the view and the face's normal
};
}
#endif
