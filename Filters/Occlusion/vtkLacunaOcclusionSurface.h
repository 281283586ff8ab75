// SPDX-License-Identifier: BSD-3-Clause
/// @class vtkLacunaOcclusionSurface
/// @brief a closed, smooth surface through incomplete data, finer than their voxels
///
/// Occluded angles tell inside from outside everywhere, so their gradient orients the data without
/// any estimate of normals. A smoothing radial basis function (r^3 in 3-D, twice continuously
/// differentiable) is fitted to the oriented data; its zeros are the surface. Data that are not on
/// the surface of the largest object, because they are seen from everywhere or hidden from
/// everywhere, do not count. See lacunaOcclusionSurface.h for the method.
///
/// Input 0: the output of vtkLacunaOccludedAngle (point arrays `OccludedAngle` and `Object`), 3-D.
/// Input 1: the image that it was made from; voxels whose scalars (ScalarArray) are at least half
/// opaque by the scale from the lowest to the highest level are the data.
///
/// Output: vtkPolyData, triangles of about the size of voxels, their points moved onto the surface
/// by three Newton steps; point array `Normals` (float x 3, unit, outwards: the function's
/// gradient). The largest closed surface only. Field data, one tuple each: `SurfaceVolume` (ml),
/// `SurfaceArea` (mm^2), `DataVoxels` and `Outliers` (voxels that were used and not), `Residual`
/// (root mean square distance of the data used, mm). No compensation of half a voxel is needed: the
/// surface runs through the voxels' centres.
///
/// The output is one piece, whole, the same for any number of threads; further pieces are empty.
///
/// Errors: arrays missing, images of different geometry, flat images, no object, too few data on
/// its surface, properties out of range.
#ifndef vtkLacunaOcclusionSurface_h
#define vtkLacunaOcclusionSurface_h

#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersOcclusionModule.h" // for export macro
#include "vtkPolyDataAlgorithm.h"

#include <string> // for the array's name

class vtkImageData;

namespace lacuna
{
struct OcclusionSurfaceOptions;
struct OcclusionSurfaceReport;
}

class VTKLACUNAFILTERSOCCLUSION_EXPORT vtkLacunaOcclusionSurface
  : public vtkLacunaAlgorithmOf(vtkPolyDataAlgorithm)
{
public:
  static vtkLacunaOcclusionSurface* New();
  vtkTypeMacro(vtkLacunaOcclusionSurface, vtkPolyDataAlgorithm);

  ///@{
  /// The point array of input 1 with the data. Default empty: the active scalars.
  vtkSetMacro(ScalarArray, std::string);
  vtkGetMacro(ScalarArray, std::string);
  ///@}

  ///@{
  /// How stiff the surface is, above 0, without unit: lengths count in voxel edges. Default 1.
  vtkSetMacro(Smoothing, double);
  vtkGetMacro(Smoothing, double);
  ///@}

  ///@{
  /// How much the fitted function may miss its equations, voxel edges, 0.001...0.5. Default 0.05.
  vtkSetMacro(Tolerance, double);
  vtkGetMacro(Tolerance, double);
  ///@}

  /// Input 1.
  void SetDataConnection(vtkAlgorithmOutput* output);

protected:
  vtkLacunaOcclusionSurface();
  ~vtkLacunaOcclusionSurface() override = default;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

  std::string ScalarArray;
  double Smoothing = 1;
  double Tolerance = 0.05;

private:
  vtkLacunaOcclusionSurface(const vtkLacunaOcclusionSurface&) = delete;
  void operator=(const vtkLacunaOcclusionSurface&) = delete;

  lacuna::OcclusionSurfaceOptions GetOptions() const;
  void WarnOfFit(
    const lacuna::OcclusionSurfaceReport& report, double edge); ///< edge: of a voxel, mm
  void WarnOfCavity(const lacuna::OcclusionSurfaceReport& report, vtkImageData* angle);
};
#endif
