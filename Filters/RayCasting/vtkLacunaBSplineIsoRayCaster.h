// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaBSplineIsoRayCaster
 * @brief depth map of an iso-surface of a volume, seen from one direction
 *
 * Casts one ray per pixel of an image plane into a volume and reports where it first passes into
 * the solid, and the surface normal there. Between the voxels the field is a tensor product of
 * uniform cubic B-splines or trilinear. The first hit is certified: no wall is missed however thin,
 * and there is no step size. Hits lie on the field's surface to 1e-9 of a voxel
 * (InterpolatingBSpline, whose coefficients are floats: to 2e-5).
 *
 * Input: vtkImageData, at least two voxels along each axis, point scalars of one component and any
 * real type; any origin, spacing, direction matrix and extent.
 *
 * Output: a depth map, see lacunaDepthMap.h: vtkImageData of W x H x 1, x = the viewer's right,
 * y = down (ViewUp reversed and made orthogonal), z = ViewDirection. Point data: Depth (double, mm
 * along the ray, NaN where there is none; active scalars), vtkValidPointMask (char), Normals (float
 * x 3, unit, world, towards the viewer), Depth_1 and Normals_1, ... for the second iso-value and so
 * on.
 * With ComputeThickness: Thickness (double, mm along the ray from the first hit to where it leaves
 * the solid; NaN without a hit and where the volume ends before). Field data: ImageToWorld,
 * IsoValues, Provenance, of perspective maps EyePosition and ViewAngle. Requested extents are
 * honoured.
 *
 * Optional second input: a depth map of the same view, behind whose Depth the rays go on (from 1e-6
 * voxel behind it, and not at all where it is NaN): to a higher iso-value, to the next layer, or
 * with the other SolidSide to the far side of the wall.
 *
 * Rules: a field equal to the iso-value is solid; a ray that starts in the solid leaves it first
 * (unless capped); voxels that are not finite are empty, a warning gives their number; an iso-value
 * outside the volume's values gives a warning and, mostly, an empty map. All of them, and what to do
 * about messages: Documentation/UserGuide/b-spline-iso-ray-caster.md.
 *
 * Errors: no scalars or several components, fewer than two voxels along an axis, a zero
 * ViewDirection or ViewUp, ViewUp parallel to ViewDirection, voxels without size, a start depth map
 * of another view, a negative or not finite PixelSpacing, more than 2^28 pixels, no memory.
 *
 * Source: Carr 1996, 3.2 and 3.3.3.
 *
 * @sa vtkLacunaDepthMapSurface
 */
#ifndef vtkLacunaBSplineIsoRayCaster_h
#define vtkLacunaBSplineIsoRayCaster_h

#include "vtkImageAlgorithm.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersRayCastingModule.h" // for export macro

#include "vtkSmartPointer.h" // for CutAway

#include <array>  // for std::array
#include <memory> // for std::unique_ptr
#include <string> // for std::string
#include <vector> // for std::vector

class vtkImplicitFunction;

class VTKLACUNAFILTERSRAYCASTING_EXPORT vtkLacunaBSplineIsoRayCaster
  : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  static vtkLacunaBSplineIsoRayCaster* New();
  vtkTypeMacro(vtkLacunaBSplineIsoRayCaster, vtkImageAlgorithm);

  enum InterpolationType
  {
    BSpline = 0,          ///< cubic, the voxels are the control points: smooths
    InterpolatingBSpline, ///< cubic, goes through the voxels; needs one more float per voxel
    Trilinear
  };

  enum SolidSideType
  {
    Above = 0, ///< solid where the field is at or above the iso-value
    Below
  };

  enum ProjectionType
  {
    Parallel = 0,
    Perspective ///< rays start at EyePosition
  };

  enum NormalMethodType
  {
    Analytic = 0, ///< gradient of the field
    GreyLevel     ///< differences of voxels, interpolated trilinearly (Carr 1996, eq. 3.5)
  };

  ///@{
  /** Name of the point array with the grey levels. Default empty: the active scalars. */
  vtkSetMacro(ScalarArray, std::string);
  vtkGetMacro(ScalarArray, std::string);
  ///@}

  ///@{
  /**
   * Grey levels of the surfaces to find, in any order; default one of 500 (bone in Hounsfield
   * units). The first gives Depth, the mask and Normals, the others Depth_1, Normals_1, ...
   */
  void SetNumberOfIsoValues(int number);
  int GetNumberOfIsoValues() const { return static_cast<int>(this->IsoValues.size()); }
  void SetIsoValue(int i, double value);
  double GetIsoValue(int i) const;
  ///@}

  /**
   * The level that a panel proposes for what is connected now, twice (the range of one value): 500 in
   * Hounsfield units, else the middle of the range.
   */
  double* GetProposedIsoRange() VTK_SIZEHINT(2);

  ///@{
  /**
   * The field between the voxels, default BSpline; which side of the iso-value is solid, default
   * Above (Below for vessels filled with fluid); where normals come from, default Analytic.
   */
  vtkSetMacro(Interpolation, int);
  vtkGetMacro(Interpolation, int);
  vtkSetMacro(SolidSide, int);
  vtkGetMacro(SolidSide, int);
  vtkSetMacro(NormalMethod, int);
  vtkGetMacro(NormalMethod, int);
  ///@}

  ///@{
  /**
   * How rays run, default Parallel. Perspective: EyePosition is where the viewer is, world mm, no
   * default; the line from there along ViewDirection meets the map's middle. The image plane is
   * perpendicular to it through PlaneOrigin, else FocalPoint, else the corner of the volume nearest
   * the eye. ViewAngle is the angle that the map's rows span, degrees, default 30; it gives the
   * pixel spacing for a number of rows, or the rows for a spacing; if both are given it follows.
   */
  vtkSetMacro(Projection, int);
  vtkGetMacro(Projection, int);
  vtkSetVector3Macro(EyePosition, double);
  vtkGetVector3Macro(EyePosition, double);
  vtkSetMacro(ViewAngle, double);
  vtkGetMacro(ViewAngle, double);
  ///@}

  ///@{
  /**
   * What is cut away: the volume where this function is negative (inside a box, sphere or cylinder,
   * behind a plane). Default none. Planes, boxes, spheres and cylinders are cut exactly, other
   * functions are sampled twice per smallest voxel edge. The solid shows a surface where it is cut
   * with CapCutAway (default on), where the volume ends with CapBoundary (default off).
   */
  void SetCutAway(vtkImplicitFunction* function);
  vtkImplicitFunction* GetCutAway() const;
  vtkSetMacro(CapCutAway, bool);
  vtkGetMacro(CapCutAway, bool);
  vtkBooleanMacro(CapCutAway, bool);
  vtkSetMacro(CapBoundary, bool);
  vtkGetMacro(CapBoundary, bool);
  vtkBooleanMacro(CapBoundary, bool);
  ///@}

  ///@{
  /** Whether to add the array Thickness for the first iso-value. Default off. */
  vtkSetMacro(ComputeThickness, bool);
  vtkGetMacro(ComputeThickness, bool);
  vtkBooleanMacro(ComputeThickness, bool);
  ///@}

  ///@{
  /** A depth map of the same view (input port 1, optional): rays go on behind its Depth. */
  void SetStartDepthMapConnection(vtkAlgorithmOutput* output)
  {
    this->SetInputConnection(1, output);
  }
  void RemoveStartDepthMap() { this->SetStartDepthMapConnection(nullptr); }
  ///@}

  vtkMTimeType GetMTime() override;

  ///@{
  /**
   * The way the viewer looks, world, any length; default 0 0 -1: from the top. And what is shown
   * upwards, which need not be perpendicular to it; default 0 1 0.
   */
  vtkSetVector3Macro(ViewDirection, double);
  vtkGetVector3Macro(ViewDirection, double);
  vtkSetVector3Macro(ViewUp, double);
  vtkGetVector3Macro(ViewUp, double);
  ///@}

  ///@{
  /**
   * What is shown in the middle of the map, and a point of the image plane, where depth is 0; world
   * mm. While a coordinate is VTK_DOUBLE_MAX (the default): the middle of the volume, and its corner
   * nearest the viewer, so that no depth is negative. The plane does not cut: a surface before it
   * has a negative depth.
   */
  vtkSetVector3Macro(FocalPoint, double);
  vtkGetVector3Macro(FocalPoint, double);
  vtkSetVector3Macro(PlaneOrigin, double);
  vtkGetVector3Macro(PlaneOrigin, double);
  ///@}

  ///@{
  /**
   * mm between pixels, default 0: the smallest voxel edge. And columns and rows of the map, 0
   * (default): as many as show the whole volume, the first pixels on the volume's edge (with a
   * FocalPoint, the middle one on it); otherwise the map is centred on the volume or FocalPoint.
   */
  vtkSetMacro(PixelSpacing, double);
  vtkGetMacro(PixelSpacing, double);
  vtkSetVector2Macro(ImageSize, int);
  vtkGetVector2Macro(ImageSize, int);
  ///@}

protected:
  vtkLacunaBSplineIsoRayCaster();
  ~vtkLacunaBSplineIsoRayCaster() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  void Announce(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;
  std::string Parameters(int port) const override;

  std::string ScalarArray;
  std::vector<double> IsoValues{ 500 };
  std::array<double, 2> ProposedIsoRange{ 500, 500 };
  int Interpolation = BSpline;
  int SolidSide = Above;
  double ViewDirection[3] = { 0, 0, -1 };
  double ViewUp[3] = { 0, 1, 0 };
  double FocalPoint[3];
  double PlaneOrigin[3];
  double PixelSpacing = 0;
  int ImageSize[2] = { 0, 0 };
  int Projection = Parallel;
  double EyePosition[3];
  double ViewAngle = 30;
  int NormalMethod = Analytic;
  vtkSmartPointer<vtkImplicitFunction> CutAway;
  bool CapCutAway = true;
  bool CapBoundary = false;
  bool ComputeThickness = false;

private:
  vtkLacunaBSplineIsoRayCaster(const vtkLacunaBSplineIsoRayCaster&) = delete;
  void operator=(const vtkLacunaBSplineIsoRayCaster&) = delete;

  class Internals;
  std::unique_ptr<Internals> Internal;
};
#endif
