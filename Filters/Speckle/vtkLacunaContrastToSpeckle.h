// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaContrastToSpeckle
 * @brief how well a region stands out against speckle
 *
 * Input: vtkImageData with a point array of numbers, one component (ScalarArray).
 * Two regions are compared. A point is inside where InsideArray is not 0 and where it lies in
 * InsideBounds, whichever of the two are given (at least one must be); outside likewise. Without
 * OutsideArray and OutsideBounds everything else is outside. Points inside are not outside; points
 * whose vtkValidPointMask is 0 and NaN samples belong to no region, nor do points where an array is
 * NaN. A selection becomes an array by Extract Selection with Preserve Topology (vtkInsidedness).
 *
 * Output: vtkTable of one row (of no rows but the column names in all pieces after the first: under
 * MPI the row is on rank 0):
 * | column                         | type    | meaning                                            |
 * |--------------------------------|---------|----------------------------------------------------|
 * | CSR                            | double  | abs(difference of means) / sqrt(sum of variances)  |
 * | InsideMean, OutsideMean        | double  | grey levels                                        |
 * | InsideVariance, OutsideVariance| double  | of the population                                  |
 * | InsideSNR, OutsideSNR          | double  | mean / standard deviation (1.91: raw speckle)      |
 * | InsideCount, OutsideCount      | id type | samples                                            |
 * | IsoValue                       | double  | the threshold                                      |
 * | Regions                        | id type | face-connected regions of samples >= IsoValue      |
 *
 * Regions are counted over the whole image: within the slice when it has one (as in the thesis),
 * through the volume otherwise.
 *
 * J. C. Carr, Surface Reconstruction in 3D Medical Imaging, 1996, sections 4.5.6 and 4.5.7.
 */
#ifndef vtkLacunaContrastToSpeckle_h
#define vtkLacunaContrastToSpeckle_h

#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersSpeckleModule.h" // for export macro
#include "vtkTableAlgorithm.h"

#include <string> // for array names

class VTKLACUNAFILTERSSPECKLE_EXPORT vtkLacunaContrastToSpeckle
  : public vtkLacunaAlgorithmOf(vtkTableAlgorithm)
{
public:
  static vtkLacunaContrastToSpeckle* New();
  vtkTypeMacro(vtkLacunaContrastToSpeckle, vtkTableAlgorithm);

  ///@{
  /// The point array of numbers; empty: the active scalars. Default: empty.
  vtkSetMacro(ScalarArray, std::string);
  vtkGetMacro(ScalarArray, std::string);
  ///@}

  ///@{
  /// Point arrays that are not 0 in the region. Default: none.
  vtkSetMacro(InsideArray, std::string);
  vtkGetMacro(InsideArray, std::string);
  vtkSetMacro(OutsideArray, std::string);
  vtkGetMacro(OutsideArray, std::string);
  ///@}

  ///@{
  /// Boxes (xmin xmax ymin ymax zmin zmax) in the image's physical coordinates, borders included
  /// (give or take a millionth of the spacing); a minimum above its maximum means no box. Default:
  /// 1 -1 1 -1 1 -1.
  vtkSetVector6Macro(InsideBounds, double);
  vtkGetVector6Macro(InsideBounds, double);
  vtkSetVector6Macro(OutsideBounds, double);
  vtkGetVector6Macro(OutsideBounds, double);
  ///@}

  ///@{
  /// Threshold whose regions are counted, in grey levels. Default: 128.
  vtkSetMacro(IsoValue, double);
  vtkGetMacro(IsoValue, double);
  ///@}

protected:
  vtkLacunaContrastToSpeckle();
  ~vtkLacunaContrastToSpeckle() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;
  void MakeNothing(const lacuna::Ports& ports) override;

private:
  vtkLacunaContrastToSpeckle(const vtkLacunaContrastToSpeckle&) = delete;
  void operator=(const vtkLacunaContrastToSpeckle&) = delete;

  std::string ScalarArray;
  std::string InsideArray;
  std::string OutsideArray;
  double InsideBounds[6] = { 1, -1, 1, -1, 1, -1 };
  double OutsideBounds[6] = { 1, -1, 1, -1, 1, -1 };
  double IsoValue = 128;
};
#endif
