// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where the model of a defect lies in its depth map.
#ifndef lacunaDefectModelPlan_h
#define lacunaDefectModelPlan_h

#include "lacunaDefectModelOptions.h"
#include "lacunaPlanarCurves.h"
#include "lacunaSurfaceFit.h"

#include <vector>

namespace lacuna
{
/// A depth map and the part of it on which there is a fit. Coordinates: x and y in mm from the first
/// pixel of the part, z the depth away from the viewer.
struct DefectScene
{
  GridSize MapSize;
  std::vector<double> MapDepths; ///< measured, NaN where there is no bone
  std::int64_t Column = 0;       ///< of the part's first pixel in the map
  std::int64_t Row = 0;
  GridSize Size; ///< of the part
  Vec2 Spacing{};
  std::vector<double> Fitted;      ///< of the part
  std::vector<unsigned char> Mask; ///< of the part, 1 in the defect
};

/// The rectangle of a model, and the defects in it.
struct DefectModelPlan
{
  std::vector<Loop> Contours; ///< of all defects and islands, as FindDefectContours
  std::int64_t Defects = 0;
  std::int64_t Column = 0; ///< of the rectangle's first pixel in the map
  std::int64_t Row = 0;
  GridSize Size;
  bool Cut = false; ///< by the border of the map
};

/// The rectangle of whole pixels around all defects and Margin (at least two pixels), as far as the
/// map goes. Throws std::invalid_argument when an option is out of range, std::runtime_error when a
/// defect reaches the border of the fit, all are too small, or the rectangle is too large.
DefectModelPlan PlanDefectModel(const DefectScene& scene, const DefectModelOptions& options);
}
#endif
