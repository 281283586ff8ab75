// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaPressOrientation
 * @brief the surface of a mould for pressing a plate, lying flat, from a filled depth map or an implant
 *
 * Input: a parallel depth map (lacuna::DepthMap) with Fitted and FilledMask, the output of
 * vtkLacunaRBFHoleFiller. Output: vtkStructuredGrid of n x m x 1 points in press coordinates (mm,
 * double, right-handed): x (fastest) and y in the press plane, regular, 0 in the middle of the block;
 * z towards the mill, which looks along -z; the press plane is z = 0. A female mould is a cavity, z <=
 * 0, a male one a boss, z >= 0. The way from there to the patient is a rotation and a translation,
 * never a mirror.
 *
 * The plane of the fit (field data PlaneNormal of the hole filler; without it or with PlaneMethod
 * LeastSquares the plane nearest to Fitted over the defect) comes to lie parallel to the press plane;
 * a warning says when the two differ by more than 10 degrees. Carr 1996, eq. 6.14: with
 * c1, c2 its slopes along the map's columns and rows, a rotation by Psi = atan(c1) about the map's y
 * axis, then one by Theta = atan(-c2 / sqrt(1 + c1^2)) about its x axis. Where the mill looks from the
 * viewer's side (a male mould of a surface that bulges to the viewer, or a female one of a surface
 * that bulges away), half a turn about x follows.
 *
 * The surface is the bicubic spline through Fitted, offset along its true normals by PlateThickness
 * where the plate's face on the mould is not the fitted surface: a female mould of a surface that
 * bulges to the viewer touches the plate's outer face, a male one the inner; the plate's inner face
 * (Onlay) or outer face (Inlay) is the fitted surface. Every node is solved for its foot point. Within
 * PlateMargin of the defect the mould is this surface; beyond, it is levelled out (its
 * slopes go over to those of the plane, from the border of Fitted on), and over FlangeWidth mm it goes
 * over into the press plane, all with continuous second derivatives. The press plane lies
 * FlangeWidth / 8 above (male: below) plate and margin.
 *
 * Or input: vtkPolyData, triangles with the cell array ImplantFace or PlateFace, the output of
 * vtkLacunaSkullImplant or vtkLacunaImplantPlate. Its outer face (0), seen along the direction in which its
 * steepest place is least steep, takes the place of Fitted, and the plane across that direction that of
 * the plane of the fit. Holes are closed; beyond the rim the surface goes on with its curvature.
 *
 * Point data:
 * | array         | type          | meaning                                                        |
 * |---------------|---------------|----------------------------------------------------------------|
 * | PressRegion   | unsigned char | 0 press plane, 1 flange, 2 plate (the true surface)            |
 * | DefectMask    | char          | 1 where the filled defect is                                   |
 * | WallAngle     | double        | degrees between the mould's surface and the press plane        |
 * | PressPosition | double x 4    | x, y, z where the node was made, and 1: by it                  |
 * |               |               | vtkLacunaMillingToolPath and vtkLacunaIGESWriter see that it   |
 * |               |               | has been moved since                                           |
 *
 * Field data (doubles unless stated):
 * | array                  | components | meaning                                               |
 * |------------------------|------------|-------------------------------------------------------|
 * | PressToPatient         | 16         | row-major; press mm to world (patient) mm, det +1     |
 * | Angles                 | 2          | Theta, Psi, degrees, see above                        |
 * | DraftAngle             | 1          | largest WallAngle of the nodes, degrees; 0 flat, 90   |
 * |                        |            | upright                                               |
 * | Depth                  | 1          | mm, from the press plane to the deepest/highest node  |
 * | SingleValued           | 1          | 1, or 0 when the mill does not see all of the surface |
 * | SuggestedViewDirection | 3          | when not, and another view helps: view for the ray    |
 * |                        |            | caster, world, unit                                   |
 * | BlockSize              | 3          | mm along x, y, z                                      |
 * | SurfaceOffset          | 1          | mm, of the mould's surface from Fitted, positive      |
 * |                        |            | towards the viewer                                    |
 * | Outward                | 1          | 1 when the surface bulges to the viewer, else 0       |
 * | PlaneSource            | string     | where the plane comes from                            |
 * | FaceDeviation          | 1          | of a solid: mm, largest distance of its outer face's  |
 * |                        |            | points from the surface before the offset             |
 *
 * When the surface is not single valued there are no points but the field data, and a warning that
 * names the place and what to do: PlaneMethod LeastSquares if that gives a mould; otherwise, if the
 * view is between 5 and 60 degrees off the one that faces defect and margin squarely, to cast rays
 * again along that (SuggestedViewDirection; lacuna::FindFacingView) with PlaneMethod LeastSquares.
 *
 * Further warnings: walls steeper than 60 degrees, with the place and what is left of the sheet; a
 * FaceDeviation above 0.05 mm.
 *
 * Errors: a perspective map, no Fitted or FilledMask, holes in them, properties out of range, a
 * surface that bends with a radius below PlateThickness on the side of the offset, Fitted that
 * hardly reaches beyond PlateMargin, a block that is too small; a solid without these arrays, that is
 * a mirror image, or whose outer face no direction of pressing sees as a whole.
 *
 * Source: Carr 1996, section 6.4.1; offset, flange and male moulds are beyond it.
 * @sa lacuna::PlanPress lacuna::MakePressSurface vtkLacunaRBFHoleFiller vtkLacunaIGESWriter
 */
#ifndef vtkLacunaPressOrientation_h
#define vtkLacunaPressOrientation_h

#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersFabricationModule.h" // for export macro
#include "vtkStructuredGridAlgorithm.h"

namespace lacuna
{
class Matrix4;
struct PressOptions;
struct PressSurface;
}

class VTKLACUNAFILTERSFABRICATION_EXPORT vtkLacunaPressOrientation
  : public vtkLacunaAlgorithmOf(vtkStructuredGridAlgorithm)
{
public:
  static vtkLacunaPressOrientation* New();
  vtkTypeMacro(vtkLacunaPressOrientation, vtkStructuredGridAlgorithm);

  static constexpr const char* PressRegionName = "PressRegion";
  static constexpr const char* DefectMaskName = "DefectMask";
  static constexpr const char* WallAngleName = "WallAngle";
  static constexpr const char* SingleValuedName = "SingleValued";
  static constexpr const char* SuggestedViewDirectionName = "SuggestedViewDirection";

  enum MouldType
  {
    Female = 0, ///< a cavity for the plate's convex face
    Male = 1    ///< a boss for the plate's concave face
  };
  enum SeatingType
  {
    Onlay = 0, ///< the plate lies on the fitted surface
    Inlay = 1  ///< the plate's outer face is the fitted surface
  };
  enum PlaneMethodType
  {
    Fit = 0,         ///< the plane that the hole filler reports of its fit
    LeastSquares = 1 ///< the plane nearest to Fitted over the defect, along the viewing direction
  };
  enum ConvexSideType
  {
    Automatic = 0, ///< measured: the mean curvature over the defect
    Outward = 1,   ///< the surface bulges to the viewer
    Inward = 2
  };

  ///@{
  /** What lies flat in the press. Default Fit. */
  vtkSetMacro(PlaneMethod, int);
  vtkGetMacro(PlaneMethod, int);
  ///@}
  ///@{
  /** Default Female. */
  vtkSetMacro(Mould, int);
  vtkGetMacro(Mould, int);
  ///@}
  ///@{
  /** Default Onlay. */
  vtkSetMacro(Seating, int);
  vtkGetMacro(Seating, int);
  ///@}
  ///@{
  /** mm, > 0. Default 0.7. */
  vtkSetMacro(PlateThickness, double);
  vtkGetMacro(PlateThickness, double);
  ///@}
  ///@{
  /** mm around the defect within which the mould is the true surface, >= 0. Default 5. */
  vtkSetMacro(PlateMargin, double);
  vtkGetMacro(PlateMargin, double);
  ///@}
  ///@{
  /**
   * mm around plate and margin over which the surface goes over into the press plane, > 0. The
   * narrower, the steeper. Default 15.
   */
  vtkSetMacro(FlangeWidth, double);
  vtkGetMacro(FlangeWidth, double);
  ///@}
  ///@{
  /**
   * mm of the block along x, y and z. 0: as small as it takes (with 5 mm of press plane around the
   * flange, 10 mm of material below the mould). Default 0 0 0.
   */
  vtkSetVector3Macro(BlockSize, double);
  vtkGetVector3Macro(BlockSize, double);
  ///@}
  ///@{
  /**
   * mm between points along x and y, 0 to FlangeWidth / 8; a little less where a given BlockSize is
   * no multiple. 0: that of the depth map, at most 1 and FlangeWidth / 8. Default 0.
   */
  vtkSetMacro(OutputSpacing, double);
  vtkGetMacro(OutputSpacing, double);
  ///@}
  ///@{
  /** Which face is convex; decides from which side the mill looks. Default Automatic. */
  vtkSetMacro(ConvexSide, int);
  vtkGetMacro(ConvexSide, int);
  ///@}

protected:
  vtkLacunaPressOrientation() { this->Sharing = lacuna::Share::FirstRank; }
  ~vtkLacunaPressOrientation() override = default;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  void Announce(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

private:
  vtkLacunaPressOrientation(const vtkLacunaPressOrientation&) = delete;
  void operator=(const vtkLacunaPressOrientation&) = delete;

  class Plan;
  lacuna::PressOptions GetOptions() const;
  void WarnOfWalls(const lacuna::PressSurface& surface, const lacuna::Matrix4& toWorld);

  int PlaneMethod = Fit;
  int Mould = Female;
  int Seating = Onlay;
  double PlateThickness = 0.7;
  double PlateMargin = 5;
  double FlangeWidth = 15;
  double BlockSize[3] = { 0, 0, 0 };
  double OutputSpacing = 0;
  int ConvexSide = Automatic;
};
#endif
