// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The bone around a defect as a solid block, to fit a plate by hand.
#ifndef lacunaDefectModel_h
#define lacunaDefectModel_h

#include "lacunaDefectModelPlan.h"
#include "lacunaMatrix4.h"
#include "lacunaPlanarTriangulation.h"

#include <string>
#include <vector>

namespace lacuna
{
class Execution;
class ReliefSurface;

/// What a triangle of the model belongs to.
enum class ModelFace : unsigned char
{
  Bone,  ///< as measured; where nothing was measured, the base
  Floor, ///< of the defect
  Wall,  ///< around the defect, along z
  Side,
  Bottom
};

/// A closed, oriented triangle mesh, and its upper side as heights of pixels.
struct DefectModel
{
  std::vector<Vec3> Points;
  std::vector<Triangle> Triangles; ///< counterclockwise from outside
  std::vector<ModelFace> Faces;    ///< one per triangle
  double Volume = 0;               ///< mm^3
  double Highest = 0;              ///< the least depth of bone
  double Base = 0;                 ///< depth of the upper side of the base
  double Bottom = 0;
  std::int64_t Defects = 0;
  /// The upper side at the pixels from (Column, Row) of the map.
  std::int64_t Column = 0;
  std::int64_t Row = 0;
  GridSize TopSize;
  std::vector<double> Top;
  std::vector<ModelFace> TopFaces;
  std::vector<std::string> Warnings;
};

/// The block is that of PlanDefectModel. Its upper side passes
/// through the measured pixels as they are; the defects' outlines are those of an ImplantPlate before
/// clearance, with walls along z, islands in them stand. Pixels without bone lie on the base. The
/// upper side is single-valued in z and at least 0.1 mm above the base, so the solid cannot cut
/// itself. Throws std::invalid_argument when an option is out of range and std::runtime_error when
/// there is no model: a defect at the border of the fit, a fit that bends more sharply than a parallel
/// floor allows, a height that is too small. toWorld only serves to name places in messages.
DefectModel MakeDefectModel(Execution& execution, const DefectScene& scene,
  const ReliefSurface& surface, const DefectModelOptions& options, const Matrix4& toWorld = {});
}
#endif
