// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The data contract of depth maps, in one place for writers and readers.
///
/// One vtkImageData of W x H x 1 points. Its direction matrix has the columns x = the viewer's
/// right, y = the viewer's down, z = the view direction (right-handed; pixel (0,0) is top left). A
/// pixel's surface point is its position + Depth * the unit ray, which in a parallel map is z.
///
/// Point data: Depth (double, mm, NaN where there is none), vtkValidPointMask (char, 1 where Depth
/// is a number), Normals (float x 3, unit, world, towards the viewer), for further iso-values
/// Depth_1, ... Shaded maps add Color (unsigned char x 3, the active scalars), the normals used
/// (Normals for Depth, Normals_1 for Depth_1, ..., FittedNormals for Fitted) and NormalDifference
/// (float, degrees).
/// Field data: ImageToWorld (16, (column, row, mm along z, 1) to world mm), IsoValues, and for
/// perspective maps EyePosition (3) and ViewAngle (degrees).
///
/// Filled maps have Depth = measured outside of the defect, fitted inside; vtkValidPointMask and Normals
/// (of the gradient of the fit) likewise. They add the point data
/// | array       | type       | meaning                                                            |
/// |-------------|------------|--------------------------------------------------------------------|
/// | Fitted      | double, mm | the fit over the rectangle, in map axes, around defect and support,|
/// |             |            | grown by a margin; NaN elsewhere                                   |
/// | FilledMask  | char       | 1 in the defect                                                    |
/// | Deviation   | double, mm | Fitted - measured, positive where the fit is farther from the      |
/// |             |            | viewer; on the support, and in the defect where a measured depth   |
/// |             |            | was replaced; NaN elsewhere                                        |
/// | SupportMask | char       | lacuna::SupportUse: what became of the surface around the defect   |
/// and the field data
/// | array             | components | meaning                                                     |
/// |-------------------|------------|-------------------------------------------------------------|
/// | RBFPlane          | 3          | c0 c1 c2 of the polynomial part c0 + c1 x + c2 y, mm; x, y  |
/// |                   |            | are mm along the map's axes from index (0,0); with a prior  |
/// |                   |            | or trend, its best plane over defect and support is added   |
/// | PlaneNormal       | 3          | (c1, c2, -1)/length, map axes, towards the viewer           |
/// | NodeCount         | 1          |                                                             |
/// | Residual          | 1          | mm, largest at a node, of the solved equations              |
/// | ConditionEstimate | 1          | of the scaled equations, 1-norm; 0: fast solution           |
/// | Iterations        | 1          | of a fast solution, else 0                                  |
/// | BendingEnergy     | 1          | thin plate only: integral of s_xx^2 + 2 s_xy^2 + s_yy^2 of  |
/// |                   |            | what was fitted                                             |
/// | DefectArea        | 1          | mm^2 on the filled surface                                  |
/// | FitTime           | 1          | s, for the equations; not the same twice                    |
#ifndef lacunaDepthMap_h
#define lacunaDepthMap_h

#include "lacunaImagePlane.h"
#include "lacunaMatrix4.h"
#include "vtkLacunaFiltersCommonModule.h" // for export macro
#include "vtkType.h"

#include <algorithm>
#include <string>

class vtkDataArray;
class vtkImageData;
class vtkInformation;

namespace lacuna
{
/// A depth map that keeps the contract, which is that of the file lacunaDepthMap.h, and the contract's names.
class VTKLACUNAFILTERSCOMMON_EXPORT DepthMap
{
public:
  static constexpr const char* DepthName = "Depth";
  static constexpr const char* MaskName = "vtkValidPointMask";
  static constexpr const char* NormalsName = "Normals";
  static constexpr const char* FittedName = "Fitted";
  static constexpr const char* FilledMaskName = "FilledMask";
  static constexpr const char* DeviationName = "Deviation";
  static constexpr const char* SupportMaskName = "SupportMask";
  static constexpr const char* PixelIdName = "PixelId"; ///< of surfaces made of a map
  static constexpr const char* ColorName = "Color";
  static constexpr const char* NormalDifferenceName = "NormalDifference";
  static constexpr const char* ImageToWorldName = "ImageToWorld";
  static constexpr const char* EyePositionName = "EyePosition";
  static constexpr const char* ViewAngleName = "ViewAngle";
  static constexpr const char* IsoValuesName = "IsoValues";

  /// Where a map lies. Right, Down and View are orthonormal and right-handed.
  struct Geometry
  {
    Vec3 Origin; ///< pixel (0,0), world mm
    Vec3 Right;
    Vec3 Down;
    Vec3 View;
    Vec2 PixelSpacing; ///< mm along Right and Down
  };

  /// Checks map against the contract; throws std::runtime_error that says what is wrong, among
  /// others when ImageToWorld disagrees with the image's own origin, spacing and direction (some
  /// filters reset the direction). Keeps no reference: map must outlive this object.
  explicit DepthMap(vtkImageData* map);

  /// (column, row, mm along the view direction, 1) to world mm; column and row are extent indices.
  const Matrix4& GetImageToWorld() const { return this->ImageToWorld; }
  bool IsPerspective() const { return this->Perspective; }
  /// Where the rays of a perspective map start, world mm.
  const Vec3& GetEye() const { return this->Eye; }
  /// The point at depth mm along the ray of pixel (column, row); these may be fractions.
  Vec3 GetPoint(double column, double row, double depth) const;
  /// Unit direction of the ray of pixel (column, row), world.
  Vec3 GetRay(double column, double row) const;
  /// mm between columns and between rows.
  Vec2 GetPixelSpacing() const;
  vtkDataArray* GetDepth() const { return this->Depth; }

  /// The name of the normals that belong to an array of depths: Normals for Depth, Normals_1 for
  /// Depth_1, otherwise the array's name with Normals behind it.
  static std::string GetNormalsName(const std::string& depthArray);

  /// Sets origin, spacing, direction matrix and ImageToWorld of a map whose extent starts anywhere.
  static void SetGeometry(vtkImageData* map, const Geometry& geometry);
  static void SetGeometry(vtkImageData* map, const ImagePlane& plane);

  /// What Announce says of a map on plane: whole extent, geometry, type of the scalars.
  static void SetInformation(vtkInformation* info, const ImagePlane& plane);

  /// True unless point is left open: its coordinates are VTK_DOUBLE_MAX, the default of points in
  /// filters that make maps. Throws when some are and others are not.
  static bool IsGiven(const double point[3]);

  /// How a filter that makes maps looks at its data, by its properties ViewDirection, ViewUp,
  /// FocalPoint, PlaneOrigin, PixelSpacing and ImageSize. Throws as IsGiven.
  template <typename Filter>
  static ViewSettings GetView(Filter* filter)
  {
    ViewSettings view;
    std::copy_n(filter->GetViewDirection(), 3, view.Direction.data());
    std::copy_n(filter->GetViewUp(), 3, view.Up.data());
    std::copy_n(filter->GetFocalPoint(), 3, view.FocalPoint.data());
    view.HasFocalPoint = IsGiven(view.FocalPoint.data());
    std::copy_n(filter->GetPlaneOrigin(), 3, view.PlaneOrigin.data());
    view.HasPlaneOrigin = IsGiven(view.PlaneOrigin.data());
    view.PixelSpacing = filter->GetPixelSpacing();
    std::copy_n(filter->GetImageSize(), 2, view.Size.data());
    return view;
  }

private:
  Matrix4 ImageToWorld;
  bool Perspective = false;
  Vec3 Eye{};
  vtkDataArray* Depth = nullptr;
};
}
#endif
