// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The defect and the fit of a filled depth map, for what is made of them.
#ifndef vtkLacunaFittedPart_h
#define vtkLacunaFittedPart_h

#include "lacunaMatrix4.h"
#include "lacunaSurfaceFit.h"

#include <cstdint>
#include <vector>

class vtkImageData;

/// The rectangle of a parallel map on which there is a fit.
struct vtkLacunaFittedPart
{
  std::int64_t Column = 0; ///< of its first pixel, from the first of the map
  std::int64_t Row = 0;
  lacuna::GridSize Size;
  lacuna::Vec2 Spacing{};          ///< mm between columns and rows
  std::vector<double> Depths;      ///< Fitted, mm, all finite
  std::vector<unsigned char> Mask; ///< 1 in the defect
  /// (mm along columns from the first pixel of the part, mm along rows, depth) to world. Proper.
  lacuna::Matrix4 ToWorld;

  /// Throws std::runtime_error when the map is a perspective one, lacks Fitted or FilledMask, has
  /// no defect, has a defect without a fit, a hole in the fit, or a geometry that mirrors.
  explicit vtkLacunaFittedPart(vtkImageData* map);
};
#endif
