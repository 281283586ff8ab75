// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaDefectModel
 * @brief the bone around a defect as a solid block with the defect open, to fit a plate by hand
 *
 * Input: a parallel depth map (lacuna::DepthMap) with Fitted and FilledMask, the output of
 * vtkLacunaRBFHoleFiller. The bone is Depth as measured, outside of FilledMask.
 *
 * Output 0: vtkPolyData, a watertight, manifold, outward oriented triangle mesh in world (patient)
 * coordinates, double precision, never mirrored. The block is a rectangle of the map; the viewer sees
 * its upper side. The bone passes through every measured pixel; walls of the defects (all of them;
 * islands of bone stand) run along the view, on the outlines that vtkLacunaImplantPlate uses before
 * EdgeClearance. Pixels without bone are as low as the base, 0.1 mm above it.
 * Cell data: ModelFace (unsigned char): 0 bone, 1 floor of a defect, 2 its wall, 3 side, 4 bottom.
 *
 * Output 1: vtkStructuredGrid of n x m x 1 points, one per pixel, the upper side for a mill, in the
 * press coordinates of vtkLacunaPressOrientation: mm, right-handed, x (fastest) and y in the plane, 0
 * in the middle of the block, z towards the mill, which looks along -z; z = 0 is the highest point of
 * the bone. Single-valued. Point data: ModelFace (0 bone, 1 floor),
 * PressPosition (as of vtkLacunaPressOrientation).
 *
 * Field data of both (doubles):
 * | array          | components | meaning                                                       |
 * |----------------|------------|---------------------------------------------------------------|
 * | PressToPatient | 16         | row-major; coordinates of output 1 to world mm, det +1        |
 * | BlockSize      | 3          | mm along x, y, z of output 1, with the base                   |
 * | FloorHeight    | 1          | z of the base's upper side in output 1, mm (below 0)          |
 * | Volume         | 1          | mm^3                                                          |
 * | DefectCount    | 1          |                                                               |
 *
 * Warnings: pixels without bone, bone cut off by MaximumHeight, a map that ends within Margin.
 * Errors: as vtkLacunaImplantPlate for the map; a defect at the border of the fit, a parallel floor
 * that would cut itself, a floor below MaximumHeight, properties out of range.
 *
 * Source: Carr 1996, section 6.5, fig. 6.10(b).
 * @sa lacuna::MakeDefectModel vtkLacunaImplantPlate vtkLacunaPressOrientation
 */
#ifndef vtkLacunaDefectModel_h
#define vtkLacunaDefectModel_h

#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersFabricationModule.h" // for export macro
#include "vtkPolyDataAlgorithm.h"

namespace lacuna
{
struct DefectModelOptions;
}

class VTKLACUNAFILTERSFABRICATION_EXPORT vtkLacunaDefectModel
  : public vtkLacunaAlgorithmOf(vtkPolyDataAlgorithm)
{
public:
  static vtkLacunaDefectModel* New();
  vtkTypeMacro(vtkLacunaDefectModel, vtkPolyDataAlgorithm);

  static constexpr const char* ModelFaceName = "ModelFace";

  enum FloorShapeType
  {
    Flat = 0, ///< one plane, everywhere at least DefectDepth below the fit
    Parallel =
      1 ///< the true normal offset of the fit by DefectDepth: a plate's inner face rests on it
  };

  ///@{
  /** mm of bone around the defect as the viewer sees it, >= 0 (at least two pixels). Default 15. */
  vtkSetMacro(Margin, double);
  vtkGetMacro(Margin, double);
  ///@}
  ///@{
  /** Default Flat. */
  vtkSetMacro(FloorShape, int);
  vtkGetMacro(FloorShape, int);
  ///@}
  ///@{
  /** mm from the fit to the floor of the defect, above 0 to 1000. Default 10. */
  vtkSetMacro(DefectDepth, double);
  vtkGetMacro(DefectDepth, double);
  ///@}
  ///@{
  /** mm of base below floor and bone, above 0 to 1000. Default 5. */
  vtkSetMacro(BaseThickness, double);
  vtkGetMacro(BaseThickness, double);
  ///@}
  ///@{
  /** mm from the highest bone to the base; deeper bone is cut off. 0: as high as it needs. Default 0. */
  vtkSetMacro(MaximumHeight, double);
  vtkGetMacro(MaximumHeight, double);
  ///@}

protected:
  vtkLacunaDefectModel();
  ~vtkLacunaDefectModel() override = default;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  void Announce(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

private:
  vtkLacunaDefectModel(const vtkLacunaDefectModel&) = delete;
  void operator=(const vtkLacunaDefectModel&) = delete;

  lacuna::DefectModelOptions GetOptions() const;

  double Margin = 15;
  int FloorShape = Flat;
  double DefectDepth = 10;
  double BaseThickness = 5;
  double MaximumHeight = 0;
};
#endif
