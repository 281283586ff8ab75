// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The bone around a defect as a solid block, to fit a plate by hand.
#ifndef lacunaDefectModel_h
#define lacunaDefectModel_h

#include "lacunaMatrix4.h"
#include "lacunaPlanarCurves.h"
#include "lacunaPlanarTriangulation.h"
#include "lacunaProperties.h"
#include "lacunaSurfaceFit.h"

#include <array>
#include <string>
#include <vector>

namespace lacuna
{
class Execution;
class ReliefSurface;

/// The floor of the defect.
enum class DefectFloor
{
  Flat,    ///< one plane, everywhere at least DefectDepth below the fit
  Parallel ///< the true normal offset of the fit by DefectDepth
};
inline constexpr std::array<const char*, 2> DefectFloorNames{ "Flat", "Parallel" };

struct DefectModelOptions
{
  double Margin = 15; ///< mm of bone around the defect as seen along z
  DefectFloor Floor = DefectFloor::Flat;
  double DefectDepth = 10;  ///< mm
  double BaseThickness = 5; ///< mm below the floor
  double MaximumHeight = 0; ///< mm from the highest point to the base; 0: as the bone needs

  void Describe(Properties& properties) const; ///< with the ranges
};

/// mm, of DefectDepth and of BaseThickness; the other two are limited by the map and by the bone.
constexpr double LargestBlock = 1000;

/// Throws std::invalid_argument that names the option, its value and what would be right.
void CheckDefectModelOptions(const DefectModelOptions& options);

// Where the model of a defect lies in its depth map.

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
