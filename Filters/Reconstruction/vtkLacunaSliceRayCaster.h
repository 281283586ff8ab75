// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkLacunaSliceRayCaster
 * @brief   Depth map of a surface straight from freehand ultrasound slices, without a volume
 *
 * Looks at tracked slices (see lacunaTrackedSlices.h) from one direction. The parallel ray of
 * each pixel meets each slice at most once; the surface lies where these samples, from the viewer
 * on, first turn solid: the crossing of the iso-value is interpolated linearly between the nearest
 * solid sample and the sample of the same sweep just in front of it. If the two are further apart than
 * MaximumGap, or nothing lies in front, the depth is that of the solid sample (Carr 1996, 4.3). It is
 * the quick look: a volume (vtkLacunaSweptVolume) gives better surfaces, and can be measured.
 *
 * The map depends on the slices of each sweep (GapMethod) only, not on their order, on threads or pieces,
 * bit by bit.
 * When the input comes again with more slices at its end and the view is the same, only the new
 * ones are cast. The map of a replay (an input with time steps) shows the whole sweep from the
 * beginning, since its poses are known; for a live source keep the map from following the bounds of
 * the slices by FocalPoint, PlaneOrigin, PixelSpacing and ImageSize.
 *
 * Input: tracked slices. Slices whose SliceStatus is not 0 are left out, but for flags taken by
 * choice. Grey levels between pixels are bilinear; samples that are not finite do not exist. Slices
 * seen edge-on, at less than 1 degree from the rays, are left out and counted in a warning.
 *
 * Output: a depth map, see lacunaDepthMap.h: vtkImageData of W x H x 1, x = the viewer's right,
 * y = down (ViewUp reversed and made orthogonal), z = ViewDirection. Point data: Depth (double, mm
 * along the ray, NaN where there is none; active scalars), vtkValidPointMask (char), Normals (float
 * x 3, unit, reference frame, towards the viewer; from the slopes of the depth by the rule in
 * lacunaDepthDiscontinuity.h). Field data: ImageToWorld, IsoValues, Sweeps and SweepGap (see
 * vtkLacunaSliceAlgorithm.h), RayGap (double, mm: the limit along the rays that was taken; 0 = none),
 * Provenance. Requested extents are honoured.
 *
 * The map depends on the poses, which are known when the input has been executed: so the input is
 * brought up to date already when information about the output is asked for.
 *
 * Errors: an array of the input is missing, no slice is left, a pose cannot be true (see BadPoses),
 * a property is out of range, the view is impossible (a zero
 * ViewDirection or ViewUp, the two parallel, over 2^28 pixels).
 *
 * @sa lacunaSliceRayCaster.h, vtkLacunaBSplineIsoRayCaster, vtkLacunaDepthMapSurface
 */
#ifndef vtkLacunaSliceRayCaster_h
#define vtkLacunaSliceRayCaster_h

#include "vtkLacunaFiltersReconstructionModule.h" // for export macro
#include "vtkLacunaSliceAlgorithm.h"

#include <array>  // for std::array
#include <memory> // for std::unique_ptr
#include <string> // for std::string

class VTKLACUNAFILTERSRECONSTRUCTION_EXPORT vtkLacunaSliceRayCaster : public vtkLacunaSliceAlgorithm
{
public:
  static vtkLacunaSliceRayCaster* New();
  vtkTypeMacro(vtkLacunaSliceRayCaster, vtkLacunaSliceAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum SolidSideType
  {
    Above = 0, ///< solid where the grey level is at or above the iso-value
    Below
  };

  ///@{
  /// Grey level of the surface. Default: 128, the middle of 8 bits.
  vtkSetMacro(IsoValue, double);
  vtkGetMacro(IsoValue, double);
  ///@}

  /**
   * The level that a panel proposes for what is connected now, twice (the range of one value): the
   * middle of the range.
   */
  double* GetProposedIsoRange() VTK_SIZEHINT(2);

  ///@{
  /// Which side of the iso-value is solid. Default: Above; Below for vessels filled with fluid.
  vtkSetMacro(SolidSide, int);
  vtkGetMacro(SolidSide, int);
  ///@}

  ///@{
  /// mm along the ray: where the solid sample and the one in front of it are further apart, the
  /// depth of the solid sample is taken. 0 = no limit. With GapMethod Automatic samples of different
  /// sweeps are not interpolated, and this limit is at most the widest step along the rays within a
  /// sweep (lacunaSliceRayCaster.h); Unlimited has none.
  /// Default: 0.
  vtkSetMacro(MaximumGap, double);
  vtkGetMacro(MaximumGap, double);
  ///@}

  ///@{
  /// The way the viewer looks, reference frame, any length. Default: 0 0 -1.
  vtkSetVector3Macro(ViewDirection, double);
  vtkGetVector3Macro(ViewDirection, double);
  ///@}

  ///@{
  /// What is shown upwards, reference frame; need not be perpendicular to ViewDirection. Default:
  /// 0 1 0.
  vtkSetVector3Macro(ViewUp, double);
  vtkGetVector3Macro(ViewUp, double);
  ///@}

  ///@{
  /// What is shown in the middle of the map, mm. While a coordinate is VTK_DOUBLE_MAX (the
  /// default), the middle of the slices.
  vtkSetVector3Macro(FocalPoint, double);
  vtkGetVector3Macro(FocalPoint, double);
  ///@}

  ///@{
  /// A point of the image plane, mm: where depth is 0. While a coordinate is VTK_DOUBLE_MAX (the
  /// default) the plane goes through the corner of the slices nearest the viewer, so that no depth
  /// is negative. The plane does not cut: a surface before it has a negative depth.
  vtkSetVector3Macro(PlaneOrigin, double);
  vtkGetVector3Macro(PlaneOrigin, double);
  ///@}

  ///@{
  /// mm between the map's pixels. Default: 0, the smallest pixel spacing of the slices.
  vtkSetMacro(PixelSpacing, double);
  vtkGetMacro(PixelSpacing, double);
  ///@}

  ///@{
  /// Columns and rows of the map. 0 (default): as many as show all slices, the first pixels on
  /// their edge (with a FocalPoint, the middle one on it). Otherwise the map is centred on the
  /// slices or the FocalPoint.
  vtkSetVector2Macro(ImageSize, int);
  vtkGetVector2Macro(ImageSize, int);
  ///@}

  /// Slices that the last update cast; fewer than there are when it went on from an earlier one.
  vtkGetMacro(NumberOfCastSlices, vtkIdType);

protected:
  vtkLacunaSliceRayCaster();
  ~vtkLacunaSliceRayCaster() override;

  void Announce(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

private:
  vtkLacunaSliceRayCaster(const vtkLacunaSliceRayCaster&) = delete;
  void operator=(const vtkLacunaSliceRayCaster&) = delete;

  class Plan;
  class State;
  void WarnAbout(const Plan& plan, bool hasSurface, vtkImageData* output);

  double IsoValue = 128;
  std::array<double, 2> ProposedIsoRange{ 128, 128 };
  int SolidSide = Above;
  double MaximumGap = 0;
  double ViewDirection[3] = { 0, 0, -1 };
  double ViewUp[3] = { 0, 1, 0 };
  double FocalPoint[3];
  double PlaneOrigin[3];
  double PixelSpacing = 0;
  int ImageSize[2] = { 0, 0 };
  vtkIdType NumberOfCastSlices = 0;

  std::unique_ptr<State> Kept;
};
#endif
