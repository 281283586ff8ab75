// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaMirror
 * @brief mirrors a volume or depth map in a plane, on request the one of best symmetry
 *
 * The output shows the MIRROR IMAGE of the patient: left is right. It is the only mirrored thing in
 * Lacuna and is marked so that it cannot be taken for the patient: field data Mirrored = 1 (with the
 * plane), which filters pass on; volumes get another array name; Implant Plate and Press Orientation
 * refuse it, IGES Writer and G-Code Writer unless told otherwise. Its use: the sound side as a pattern
 * for the side with the defect.
 *
 * Input: a volume or slice (active point scalars of one component, any real type and direction;
 * vtkValidPointMask is respected) or a parallel depth map (lacuna::DepthMap), known by its Depth and
 * ImageToWorld. How the plane is found is in lacunaVolumeSymmetry.h and lacunaMirroredMap.h.
 *
 * Output 0 on the grid of the input, of a volume: Mirrored<name> (type of the input, active scalars;
 * the lowest value of the input where the mirror image is not known), vtkValidPointMask (char),
 * Asymmetry (float, given minus mirrored, NaN where there are not both). Of a map: Depth (double, mm),
 * vtkValidPointMask, Normals (float x 3, if the map has them) of the mirrored surface seen in the same
 * view, Asymmetry (double, mm along the ray, given minus mirrored: positive where the given surface is
 * farther from the viewer). Other point arrays are not passed on. Field data: that of the input, and
 * | array             | components | meaning                                                      |
 * |-------------------|------------|--------------------------------------------------------------|
 * | Mirrored          | 1          | 1                                                            |
 * | MirrorPlaneOrigin | 3          | point of the plane nearest to the middle of the data, mm     |
 * | MirrorPlaneNormal | 3          | unit; its largest component is positive                      |
 * | SymmetryScore     | 1          | concordance correlation of given and mirrored values where   |
 * |                   |            | there are both (lacuna::Concordance): 1 = equal, 0 = unlike  |
 * | SymmetryOverlap   | 1          | part of the valid voxels or pixels where there are both, 0..1|
 * | SymmetryAmbiguity | 1          | BestSymmetry only, 0..1: asymmetry in the plane found, over  |
 * |                   |            | that in the next best plane; 1 = both are as good            |
 * | AsymmetryRMS      | 1          | of Asymmetry                                                 |
 * | AsymmetryMedian   | 1          | maps only: median of its absolute value, mm                  |
 *
 * Output 1: the plane as a square as large as the data (polydata), with SymmetryScore.
 */
#ifndef vtkLacunaMirror_h
#define vtkLacunaMirror_h

#include "vtkImageAlgorithm.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersRadialBasisModule.h" // for export macro

#include <memory>

namespace lacuna
{
class AlgorithmExecution;
}

class VTKLACUNAFILTERSRADIALBASIS_EXPORT vtkLacunaMirror
  : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  static vtkLacunaMirror* New();
  vtkTypeMacro(vtkLacunaMirror, vtkImageAlgorithm);

  enum PlaneMethodType
  {
    BestSymmetry = 0, ///< the plane in which the data agree best with their mirror image
    Given = 1         ///< Origin and Normal
  };
  enum InterpolationType
  {
    BSpline = 0, ///< the cubic B-spline through all voxels
    Linear = 1,
    Nearest = 2 ///< for labels
  };

  /// A warning says so where the score is lower, or the ambiguity higher.
  static constexpr double PoorScore = 0.8;
  static constexpr double HighAmbiguity = 0.6;

  ///@{
  /** Where the plane comes from. Default BestSymmetry. */
  vtkSetMacro(PlaneMethod, int);
  vtkGetMacro(PlaneMethod, int);
  ///@}

  ///@{
  /** A point of the given plane, world mm. Default 0 0 0. */
  vtkSetVector3Macro(Origin, double);
  vtkGetVector3Macro(Origin, double);
  ///@}

  ///@{
  /** The given plane's normal, world, any length but 0. Default 1 0 0. */
  vtkSetVector3Macro(Normal, double);
  vtkGetVector3Macro(Normal, double);
  ///@}

  ///@{
  /** How grey levels between voxels are found (volumes). Default BSpline. */
  vtkSetMacro(Interpolation, int);
  vtkGetMacro(Interpolation, int);
  ///@}

protected:
  vtkLacunaMirror();
  ~vtkLacunaMirror() override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  void Announce(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;
  std::string Parameters(int port) const override;

private:
  vtkLacunaMirror(const vtkLacunaMirror&) = delete;
  void operator=(const vtkLacunaMirror&) = delete;

  class Internals;

  int PlaneMethod = BestSymmetry;
  double Origin[3] = { 0, 0, 0 };
  double Normal[3] = { 1, 0, 0 };
  int Interpolation = BSpline;
  std::shared_ptr<const Internals> Kept; // what several ranks have found of a volume
  std::string Made;                      // parameters of the last result
};
#endif
