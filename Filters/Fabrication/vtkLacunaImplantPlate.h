// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaImplantPlate
 * @brief a plate of given thickness for the defect of a filled depth map, as a closed surface
 *
 * Input: a parallel depth map (lacuna::DepthMap) with Fitted and FilledMask, the output of
 * vtkLacunaRBFHoleFiller. Second input, optional: vtkPointSet, points marked with the mouse for screw
 * holes besides HolePoints; those not farther apart than the larger diameter of a hole are one hole
 * in their middle. Output: vtkPolyData, a watertight, manifold, outward oriented triangle
 * mesh in world (patient) coordinates, double precision, never mirrored.
 *
 * The surface is the bicubic spline through Fitted. Its true normal offset by Thickness, away from
 * the viewer (Inward) or towards the viewer (Outward), is the other face; walls run along the
 * normals. The outline is the defect's (that of FilledMask, smoothed, see
 * lacuna::FindPlateOutline) moved inwards by EdgeClearance, or outwards over the bone when that is
 * negative; distances are measured in space between points of the surface. The edge is square,
 * bevelled or rounded. Screw holes are round cylinders along the normal at the picked points, with
 * a conical countersink in the outer face, the one towards the viewer.
 *
 * Cell data: PlateFace (unsigned char): 0 outer face, 1 inner face, 2 edge, 3 screw hole, 4 drainage
 * hole. Field data:
 * | array                  | components | meaning                                                |
 * |------------------------|------------|--------------------------------------------------------|
 * | Volume                 | 1          | mm^3                                                   |
 * | Mass                   | 1          | g, Volume times Density                                |
 * | OuterArea              | 1          | mm^2                                                   |
 * | OutlineLength          | 1          | mm, on the surface                                     |
 * | MinimumThickness       | 1          | mm, least distance of the faces, apart from edges; NaN |
 * |                        |            | of a plate that is so small that all of it is edge     |
 * | MinimumCurvatureRadius | 1          | mm, of the surface under the plate, infinite of a flat |
 * |                        |            | one; NaN where MinimumThickness is                     |
 * | TightestPoint          | 3          | where that is, world mm; NaN where it is nowhere       |
 * | HoleCenters            | 3          | world mm, on the outer face, a tuple per screw hole    |
 * | HoleAxes               | 3          | world, unit, towards the viewer                        |
 * | HoleBoneThickness      | 1          | mm, least under the screw; 0 over the defect, NaN when |
 * |                        |            | the map has no array Thickness                         |
 * | HoleLand               | 1          | mm of cylinder left under the countersink              |
 * | DrainageHoleCount      | 1          |                                                        |
 *
 * Warnings: several defects, islands, a screw hole over the defect or over bone thinner than
 * MinimumBoneThickness or not measured (by ComputeThickness of vtkLacunaBSplineIsoRayCaster), an
 * overlap inwards.
 * Errors: no filled defect, a perspective map, a surface that bends with a radius below Thickness on
 * the side of the offset, holes that do not fit, properties out of range.
 *
 * Source: Carr 1996, ch. 6 (the implant); the plate as a solid is beyond it.
 * @sa lacuna::MakeImplantPlate vtkLacunaRBFHoleFiller
 */
#ifndef vtkLacunaImplantPlate_h
#define vtkLacunaImplantPlate_h

#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersFabricationModule.h" // for export macro
#include "vtkPolyDataAlgorithm.h"

#include <array>  // for ivar
#include <vector> // for ivar

class vtkPointSet;

namespace lacuna
{
struct FittedPart;
struct ImplantPlate;
struct ImplantPlateOptions;
struct Vec3;
}

class VTKLACUNAFILTERSFABRICATION_EXPORT vtkLacunaImplantPlate
  : public vtkLacunaAlgorithmOf(vtkPolyDataAlgorithm)
{
public:
  static vtkLacunaImplantPlate* New();
  vtkTypeMacro(vtkLacunaImplantPlate, vtkPolyDataAlgorithm);

  static constexpr const char* PlateFaceName = "PlateFace";

  enum SideType
  {
    Inward = 0, ///< the fitted surface is the outer face
    Outward = 1 ///< the fitted surface is the inner face
  };
  enum EdgeShapeType
  {
    Square = 0,
    Beveled = 1,
    Rounded = 2
  };

  ///@{
  /** mm, > 0. Default 3. */
  vtkSetMacro(Thickness, double);
  vtkGetMacro(Thickness, double);
  ///@}
  ///@{
  /** Which way the plate grows from the fitted surface. Default Inward. */
  vtkSetMacro(Side, int);
  vtkGetMacro(Side, int);
  ///@}
  ///@{
  /** mm between the defect's outline and the plate; negative: overlap onto the bone. Default 0.5. */
  vtkSetMacro(EdgeClearance, double);
  vtkGetMacro(EdgeClearance, double);
  ///@}
  ///@{
  /** Default Rounded. */
  vtkSetMacro(EdgeShape, int);
  vtkGetMacro(EdgeShape, int);
  ///@}
  ///@{
  /** Width of the bevel, or radius of the rounding, mm, 0..Thickness. Default 0.5. */
  vtkSetMacro(Bevel, double);
  vtkGetMacro(Bevel, double);
  ///@}
  ///@{
  /** Whether the inner edge gets the bevel, too (then up to half of Thickness). Default off. */
  vtkSetMacro(BevelBothFaces, bool);
  vtkGetMacro(BevelBothFaces, bool);
  vtkBooleanMacro(BevelBothFaces, bool);
  ///@}
  ///@{
  /** mm: corners of the outline are rounded to this or to Bevel and a triangle. Default 1. */
  vtkSetMacro(CornerRadius, double);
  vtkGetMacro(CornerRadius, double);
  ///@}
  ///@{
  /**
   * mm, edges of triangles seen by the viewer. 0: as the pixels of the map, at most 0.5, and finer
   * where the bends of the surface would make the plate thinner by over 1 % between flat triangles;
   * otherwise that is warned of. Default 0.
   */
  vtkSetMacro(TriangleSize, double);
  vtkGetMacro(TriangleSize, double);
  ///@}

  ///@{
  /**
   * Points, world mm, on or near the plate, through which screw holes go; the points of the second
   * input come after them. Default none.
   */
  void AddHolePoint(double x, double y, double z);
  void RemoveAllHolePoints();
  int GetNumberOfHolePoints() const { return static_cast<int>(this->HolePoints.size()); }
  ///@}
  /** Takes the second input away (ParaView needs a method of its own for that). */
  void RemoveHoleMarks() { this->SetInputConnection(1, nullptr); }
  ///@{
  /** mm, > 0. Default 2. */
  vtkSetMacro(HoleDiameter, double);
  vtkGetMacro(HoleDiameter, double);
  ///@}
  ///@{
  /** mm on the outer face, larger than HoleDiameter; 0: no countersink. Default 0. */
  vtkSetMacro(CountersinkDiameter, double);
  vtkGetMacro(CountersinkDiameter, double);
  ///@}
  ///@{
  /** Degrees between opposite sides of the cone, 30..150. Default 90. */
  vtkSetMacro(CountersinkAngle, double);
  vtkGetMacro(CountersinkAngle, double);
  ///@}
  ///@{
  /** mm: screw holes over thinner bone, or over bone not measured, are warned of. Default 3. */
  vtkSetMacro(MinimumBoneThickness, double);
  vtkGetMacro(MinimumBoneThickness, double);
  ///@}

  ///@{
  /** mm between the middles of drainage holes as the viewer sees them; 0: none. Default 0. */
  vtkSetMacro(DrainageSpacing, double);
  vtkGetMacro(DrainageSpacing, double);
  ///@}
  ///@{
  /** mm, > 0. Default 2. */
  vtkSetMacro(DrainageDiameter, double);
  vtkGetMacro(DrainageDiameter, double);
  ///@}
  ///@{
  /** g/cm^3, > 0: PEEK 1.3, PMMA 1.18, titanium 4.5. Default 1.3. */
  vtkSetMacro(Density, double);
  vtkGetMacro(Density, double);
  ///@}

protected:
  vtkLacunaImplantPlate();
  ~vtkLacunaImplantPlate() override = default;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  std::string Parameters(int port) const override;
  void Describe(lacuna::Properties& properties) const override;
  std::vector<vtkDataObject*> GetOrigins(const lacuna::Ports& ports) const override;

private:
  vtkLacunaImplantPlate(const vtkLacunaImplantPlate&) = delete;
  void operator=(const vtkLacunaImplantPlate&) = delete;

  lacuna::ImplantPlateOptions GetOptions() const;               // without holes
  std::vector<lacuna::Vec3> GetHoles(vtkPointSet* marks) const; // in world mm
  void DescribeWith(lacuna::Properties& properties, const std::vector<double>& holes) const;
  // With triangles so small that the plate is thick enough, unless their size is given.
  lacuna::ImplantPlate MakePlate(const lacuna::FittedPart& part,
    lacuna::ImplantPlateOptions& options, lacuna::AlgorithmExecution& execution);
  void WarnOfBone(const std::vector<double>& thickness); // under the screw holes

  double Thickness = 3;
  int Side = Inward;
  double EdgeClearance = 0.5;
  int EdgeShape = Rounded;
  double Bevel = 0.5;
  bool BevelBothFaces = false;
  double CornerRadius = 1;
  double TriangleSize = 0;
  std::vector<std::array<double, 3>> HolePoints;
  std::vector<double> Drilled; ///< all holes, for the provenance
  double HoleDiameter = 2;
  double CountersinkDiameter = 0;
  double CountersinkAngle = 90;
  double MinimumBoneThickness = 3;
  double DrainageSpacing = 0;
  double DrainageDiameter = 2;
  double Density = 1.3;
};
#endif
