// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaSkullImplant
 * @brief the missing part of a skull as a closed solid, with its predicted error
 *
 * Input 0: a head CT (vtkImageData, active point scalars of one component, any type and direction, world mm),
 * of which bone alone is at or above Level: the output of vtkLacunaSkullBone. Input 1, optional: a closed
 * curve on the skull (vtkPolyData, its first polyline, else its points in order) around what is to be replaced;
 * bone within it does not count as sound. Input 2, optional: a template, which is another skull in mm: a volume
 * in which only bone is at or above TemplateLevel, or a mesh of its surface, with or without inner table. It may lie and be
 * turned anyhow, and is scaled, but never mirrored.
 *
 * Without a curve the holes of the vault are found from within, and one is chosen. The outer table and
 * the thickness of the missing part are predicted from all sound bone and from the other side of
 * the plane of best symmetry (lacuna::SkullShape), with a standard error that is calibrated on sound bone. A
 * template counts as far as the sound bone is like it.
 *
 * Output 0: vtkPolyData, a watertight, outward oriented triangle mesh in world mm, double precision, never
 * mirrored (lacuna::MakeSkullImplant). Point arrays (double, mm along the ray from the middle of the
 * skull): PredictedError (standard error of the outer surface; active scalars), Thickness, ThicknessError. Cell arrays
 * ImplantFace (unsigned char): 0 outer, 1 inner, 2 edge and walls of holes, 3 text; Part (int, from 1): each is closed.
 * Field data (double):
 * | array                      | components | meaning                                                  |
 * |----------------------------|------------|----------------------------------------------------------|
 * | Volume                     | 1          | mm^3                                                     |
 * | Mass                       | 1          | g, Volume times Density                                  |
 * | OuterArea                  | 1          | mm^2                                                     |
 * | DefectArea                 | 1          | mm^2, OuterArea without clearance                        |
 * | ThicknessMinimum, ThicknessMean, ThicknessMaximum | 1 | mm                                         |
 * | PredictedErrorRMS          | 1          | mm, root of the mean squared PredictedError over the area|
 * | PredictedErrorMaximum      | 1          | mm                                                       |
 * | PredictedErrorMaximumPoint | 3          | where that is, world mm                                  |
 * | MinimumThickness           | 1          | mm, least distance of an outer point from the inner face |
 * | MinimumThicknessPoint      | 3          | where that is, world mm                                  |
 * | InsertionDirection         | 3          | unit, the way in which the implant is put in             |
 * | LeastTaper                 | 1          | degrees, least angle between it and the implant's walls  |
 * | InsertionClearance         | 1          | mm, least distance of the implant from bone on           |
 * |                            |            | the way in, at most 3, or 2.5 more than EdgeClearance    |
 * | NumberOfHoles              | 1          | through the implant                                      |
 * | UndercutVolume             | 1          | mm^3, free space beside the edge that cannot be filled   |
 * | UndercutWidth, UndercutPoint | 1, 3     | mm, its largest width, and where, world mm               |
 * | SymmetryPlaneOrigin, SymmetryPlaneNormal | 3 | a point of the refined plane, world mm; its normal  |
 * | TemplateFitRMS             | 1          | with a template: mm, distance of its outer table from sound bone |
 * | TemplateScale              | 1          | mm of the skull for one of the template                  |
 * | TemplateFactor, TemplateThicknessFactor | 1 | how far its shape and thickness count: 0 not at all, about 1 wholly |
 * | Warnings                   | texts      | the warnings below                                       |
 *
 * Output 1: vtkPolyData, triangles on the ellipsoid that fits the skull for each hole that was found; cell array
 * Defect (int, 1 = the largest; 0: within the curve). Field data: DefectAreas (mm^2), DefectCenters (3, world mm).
 *
 * Output 2: vtkPolyData, a line for each plate from its hole in the implant to its screw in the bone; cell arrays
 * BoneThickness (double, mm, the least within 3 mm of the screw) and IsThickEnough (unsigned char: at least ScrewLength).
 *
 * Warnings: 1.96 PredictedError above 1 mm, with the area and the worst place; bone that divides the hole;
 * undercuts wider than 1 mm; places thinner than 1.5 mm; a template that is not used; no place
 * for text, plates or parts of the hole; data of which Level is the end of the range.
 * Errors: a template that does not fit; no hole; properties out of range; Point farther than 30 mm from every hole; too little bone.
 *
 * @sa lacuna::SkullShape lacuna::MakeSkullImplant vtkLacunaSkullBone
 */
#ifndef vtkLacunaSkullImplant_h
#define vtkLacunaSkullImplant_h

#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersCranioplastyModule.h" // for export macro
#include "vtkPolyDataAlgorithm.h"

#include <string>

namespace lacuna
{
struct SkullImplantOptions;
}

class VTKLACUNAFILTERSCRANIOPLASTY_EXPORT vtkLacunaSkullImplant
  : public vtkLacunaAlgorithmOf(vtkPolyDataAlgorithm)
{
public:
  static vtkLacunaSkullImplant* New();
  vtkTypeMacro(vtkLacunaSkullImplant, vtkPolyDataAlgorithm);

  enum DefectChoiceType
  {
    Largest = 0,
    NearestToPoint = 1
  };

  ///@{
  /** Grey level of bone, in the units of the scalars. Default 300 (Hounsfield units). */
  vtkSetMacro(Level, double);
  vtkGetMacro(Level, double);
  ///@}
  ///@{
  /** Which of the holes that were found. Default Largest. */
  vtkSetMacro(DefectChoice, int);
  vtkGetMacro(DefectChoice, int);
  ///@}
  ///@{
  /** For NearestToPoint: a point in or near the hole, world mm. Default 0 0 0. */
  vtkSetVector3Macro(Point, double);
  vtkGetVector3Macro(Point, double);
  ///@}
  ///@{
  /** mm between the implant and the wall of bone, 0..5. Default 0.5. */
  vtkSetMacro(EdgeClearance, double);
  vtkGetMacro(EdgeClearance, double);
  ///@}
  ///@{
  /** mm along the normal of the outer surface, 0.5..20; 0: that of the patient's bone. Default 0. */
  vtkSetMacro(Thickness, double);
  vtkGetMacro(Thickness, double);
  ///@}
  ///@{
  /** mm, 0..10: where it is less, the inner face is moved inwards. Default 1.5. */
  vtkSetMacro(MinimumThickness, double);
  vtkGetMacro(MinimumThickness, double);
  ///@}
  ///@{
  /** The way in which the implant is put in, world; 0 0 0: for which the wall of bone has the most taper. Default 0 0 0. */
  vtkSetVector3Macro(InsertionDirection, double);
  vtkGetVector3Macro(InsertionDirection, double);
  ///@}
  ///@{
  /** mm along the normal of the outer face, positive outwards, -10..10; it fades to 0 at the rim. Default 0. */
  vtkSetMacro(OuterOffset, double);
  vtkGetMacro(OuterOffset, double);
  ///@}
  ///@{
  /** The same for the inner face. MinimumThickness is kept. Default 0. */
  vtkSetMacro(InnerOffset, double);
  vtkGetMacro(InnerOffset, double);
  ///@}
  ///@{
  /** mm from the rim over which both offsets fade, 0..50. Default 15. */
  vtkSetMacro(OffsetFade, double);
  vtkGetMacro(OffsetFade, double);
  ///@}
  ///@{
  /** Parts of the implant, 1..6: cut along the way in, EdgeClearance apart. Default 1. */
  vtkSetMacro(Parts, int);
  vtkGetMacro(Parts, int);
  ///@}
  ///@{
  /** mm between drainage holes, 4..50; 0: none. Default 0. */
  vtkSetMacro(DrainageSpacing, double);
  vtkGetMacro(DrainageSpacing, double);
  ///@}
  ///@{
  /** mm, 0.5..10. Default 2.5. */
  vtkSetMacro(DrainageDiameter, double);
  vtkGetMacro(DrainageDiameter, double);
  ///@}
  ///@{
  /** mm between holes for sutures along the rim, 4..50; 0: none. Default 0. */
  vtkSetMacro(SutureSpacing, double);
  vtkGetMacro(SutureSpacing, double);
  ///@}
  ///@{
  /** mm, 0.5..10. Default 1.5. */
  vtkSetMacro(SutureDiameter, double);
  vtkGetMacro(SutureDiameter, double);
  ///@}
  ///@{
  /** Plates that fasten the implant, 0..12: each has a hole in it and a screw in the bone (output 2). Default 0. */
  vtkSetMacro(Plates, int);
  vtkGetMacro(Plates, int);
  ///@}
  ///@{
  /** mm, 0.5..10: of the plates' holes in the implant. Default 1.5. */
  vtkSetMacro(ScrewDiameter, double);
  vtkGetMacro(ScrewDiameter, double);
  ///@}
  ///@{
  /** mm, 1..20: places are preferred where bone is at least as thick. Default 4. */
  vtkSetMacro(ScrewLength, double);
  vtkGetMacro(ScrewLength, double);
  ///@}
  ///@{
  /** mm from the rim to the middles of holes and of screws in bone, 2..20. Default 5. */
  vtkSetMacro(RimDistance, double);
  vtkGetMacro(RimDistance, double);
  ///@}
  ///@{
  /** Engraved 0.4 mm deep into the inner face, readable from within; printable ASCII. Default empty. */
  void SetEngravedText(const char* text);
  const char* GetEngravedText() const { return this->EngravedText.c_str(); }
  ///@}
  ///@{
  /** mm, of capital letters, 2..20. Default 5. */
  vtkSetMacro(TextHeight, double);
  vtkGetMacro(TextHeight, double);
  ///@}
  ///@{
  /** mm, edges of triangles, 0.2..5; 0: 1 mm. Default 0. */
  vtkSetMacro(TriangleSize, double);
  vtkGetMacro(TriangleSize, double);
  ///@}
  ///@{
  /** g/cm^3, > 0: PEEK 1.3, PMMA 1.18, titanium 4.5. Default 1.3. */
  vtkSetMacro(Density, double);
  vtkGetMacro(Density, double);
  ///@}

  ///@{
  /** Grey level of the template's bone, if it is a volume; 0: Level. Default 0. */
  vtkSetMacro(TemplateLevel, double);
  vtkGetMacro(TemplateLevel, double);
  ///@}

  /** Takes the third input away. */
  void RemoveTemplate() { this->SetInputConnection(2, nullptr); }
  /** Takes the second input away (ParaView needs a method of its own for that). */
  void RemoveOutline() { this->SetInputConnection(1, nullptr); }

protected:
  vtkLacunaSkullImplant();
  ~vtkLacunaSkullImplant() override = default;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

private:
  vtkLacunaSkullImplant(const vtkLacunaSkullImplant&) = delete;
  void operator=(const vtkLacunaSkullImplant&) = delete;
  lacuna::SkullImplantOptions GetOptions() const; // without the text

  double Level = 300;
  int DefectChoice = Largest;
  double Point[3] = { 0, 0, 0 };
  double EdgeClearance = 0.5;
  double Thickness = 0;
  double MinimumThickness = 1.5;
  double InsertionDirection[3] = { 0, 0, 0 };
  double OuterOffset = 0;
  double InnerOffset = 0;
  double OffsetFade = 15;
  int Parts = 1;
  double DrainageSpacing = 0;
  double DrainageDiameter = 2.5;
  double SutureSpacing = 0;
  double SutureDiameter = 1.5;
  int Plates = 0;
  double ScrewDiameter = 1.5;
  double ScrewLength = 4;
  double RimDistance = 5;
  std::string EngravedText;
  double TextHeight = 5;
  double TriangleSize = 0;
  double Density = 1.3;
  double TemplateLevel = 0;
};
#endif
