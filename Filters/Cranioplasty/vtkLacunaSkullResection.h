// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaSkullResection
 * @brief a planned cut through a skull: the bone without it, what is cut out, and a guide for the saw
 *
 * Input 0: a head CT (vtkImageData, active point scalars of one component, any type and direction, world mm), of which bone
 * alone is at or above Level: the output of vtkLacunaSkullBone. Input 1, optional: a closed curve on the skull
 * (vtkPolyData, its first polyline, else its points in order). Input 2, optional: a tumour in the same coordinates, a
 * mask (vtkImageData, above 0.5) or a surface (vtkPolyData). One of both is needed; the curve goes first.
 *
 * The cut goes along one direction: square to the plane that is nearest to the curve, from outside. The curve lies on the
 * outer table along that direction; from there the wall leans by Bevel, so that what is cut out, and an implant, come out
 * outwards. Around a tumour the curve is Margin away from it as seen from outside.
 *
 * Output 0: vtkImageData, the input's grid, arrays and field data; the active scalars without the bone that is cut out. The
 * wall is where they cross Level. vtkLacunaSkullImplant makes the implant for it, with output 1 as outline.
 * Output 1: vtkPolyData, the curve on the outer table, a closed polyline.
 * Output 2: vtkPolyData, the surface of what is cut out, closed, outward oriented, world mm.
 * Output 3: vtkPolyData, the guide: a ring of GuideWidth on the outer table, GuideClearance above its highest places, whose
 * inner wall goes on with the cut's; it is put on along the direction of the cut. Closed, cell array ImplantFace: 0 upper,
 * 1 on the bone, 2 walls. Empty for GuideWidth 0.
 *
 * Field data of output 2 (double): Volume (mm^3), CutDirection (3, unit, inwards); of output 3: Volume.
 *
 * Warning: the guide lies on bone for less than 80 % of its area. Errors: properties out of range; neither a curve nor a
 * tumour; a curve that crosses itself as seen along the direction, or without bone below it; no bone below a
 * part of the guide.
 * @sa lacuna::SkullResection vtkLacunaSkullImplant
 */
#ifndef vtkLacunaSkullResection_h
#define vtkLacunaSkullResection_h

#include "vtkImageAlgorithm.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersCranioplastyModule.h" // for export macro

class vtkDataArray;

namespace lacuna
{
class Execution;
class SkullResection;
struct ResectionOptions;
struct VoxelVolume;
}

class VTKLACUNAFILTERSCRANIOPLASTY_EXPORT vtkLacunaSkullResection
  : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  static vtkLacunaSkullResection* New();
  vtkTypeMacro(vtkLacunaSkullResection, vtkImageAlgorithm);

  ///@{
  /** Grey level of bone, in the units of the scalars. Default 300 (Hounsfield units). */
  vtkSetMacro(Level, double);
  vtkGetMacro(Level, double);
  ///@}
  ///@{
  /** mm around the tumour, 1..50. Default 10. */
  vtkSetMacro(Margin, double);
  vtkGetMacro(Margin, double);
  ///@}
  ///@{
  /** Degrees by which the cut opens outwards, 0..45. Default 10. */
  vtkSetMacro(Bevel, double);
  vtkGetMacro(Bevel, double);
  ///@}
  ///@{
  /** mm, 3..40; 0: no guide. Default 10. */
  vtkSetMacro(GuideWidth, double);
  vtkGetMacro(GuideWidth, double);
  ///@}
  ///@{
  /** mm, 2..20. Default 5. */
  vtkSetMacro(GuideHeight, double);
  vtkGetMacro(GuideHeight, double);
  ///@}
  ///@{
  /** mm between guide and bone, 0..1. Default 0.2. */
  vtkSetMacro(GuideClearance, double);
  vtkGetMacro(GuideClearance, double);
  ///@}
  ///@{
  /** mm, diameter of the guide's four holes for screws, 0.5..5; 0: none. Default 1.5. */
  vtkSetMacro(GuideHole, double);
  vtkGetMacro(GuideHole, double);
  ///@}

  /** Takes the second input away (ParaView needs a method of its own for that). */
  void RemoveOutline() { this->SetInputConnection(1, nullptr); }
  /** Takes the third input away. */
  void RemoveTumour() { this->SetInputConnection(2, nullptr); }

protected:
  vtkLacunaSkullResection();
  ~vtkLacunaSkullResection() override = default;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;
  std::vector<vtkDataObject*> GetOrigins(const lacuna::Ports& ports) const override;

private:
  vtkLacunaSkullResection(const vtkLacunaSkullResection&) = delete;
  void operator=(const vtkLacunaSkullResection&) = delete;
  lacuna::ResectionOptions GetOptions() const;
  void MakeMeshes(const lacuna::VoxelVolume& volume, vtkDataArray* alone,
    const lacuna::SkullResection& cut, const lacuna::Ports& ports, lacuna::Execution& execution);

  double Level = 300;
  double Margin = 10;
  double Bevel = 10;
  double GuideWidth = 10;
  double GuideHeight = 5;
  double GuideClearance = 0.2;
  double GuideHole = 1.5;
};
#endif
