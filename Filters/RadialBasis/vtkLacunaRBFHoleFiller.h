// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaRBFHoleFiller
 * @brief fills a hole in a depth map with a radial basis function fitted to the surface around it
 *
 * Input: a parallel depth map (vtkLacunaDepthMap). Perspective maps are refused: their rays are not
 * parallel, so depth is not a height over the map. The hole is found in one of these ways:
 *  - DefectRegion and/or DefectArray mark it (a pixel that either marks is defect). A pixel is in
 *    the region when its surface point is, or when the region lies in front of that point: when one
 *    of RegionSamples points of its ray, evenly spaced over the range of depths of the map, is in
 *    the region and not behind the surface. So a sphere put over a hole also takes what is seen
 *    through the hole; pixels without depth are in the region when any of these points is. Inside
 *    is where the implicit function is <= 0;
 *  - SupportArray alone: the painted pixels are the sound bone, and pixels that they enclose are
 *    the defect;
 *  - nothing: the holes of the map, that is what its main surface encloses, grown by 2 mm because
 *    the rim of a hole in CT is rounded by the partial volume effect. The main surface is the
 *    largest piece of the map without depth steps (of more than 79 degrees between neighbours), so
 * a hole may show nothing or the far side. Eye sockets are holes, too: mark the defect when the map
 *    has other openings.
 *
 * Nodes are valid pixels within SupportMargin of the defect (map plane, centre to centre) or, with
 * a SupportArray, its painted ones, thinned to NodeSpacing; the rules are in lacunaHoleSupport.h.
 * What lies beyond a depth step steeper than 79 degrees from the larger part is not used, with a
 * warning. A defect at the border of the map is filled by extrapolation, with a warning.
 *
 * Output: the map with Depth = measured outside of the defect, fitted inside (double);
 * vtkValidPointMask (char) and Normals (float x 3, when the input has them; from the gradient of
 * the fit inside) likewise; Fitted (double, mm: the fit over the rectangle, in map axes, around
 * defect and support, grown by OutputMargin, up to the border of the map; NaN elsewhere);
 * FilledMask (char, 1 in the defect); Deviation (double, mm, Fitted - measured: positive where the
 * fit is farther from the viewer; on the support, and in the defect where a measured depth was
 * replaced; NaN elsewhere). Other arrays are passed on. Field data: that of the map, and
 * | array             | components | meaning                                                     |
 * |-------------------|------------|-------------------------------------------------------------|
 * | RBFPlane          | 3          | c0 c1 c2 of the polynomial part c0 + c1 x + c2 y, mm; x, y  |
 * |                   |            | are mm along the map's axes from index (0,0)                |
 * | PlaneNormal       | 3          | (c1, c2, -1)/length, map axes, towards the viewer           |
 * | NodeCount         | 1          |                                                             |
 * | Residual          | 1          | mm, largest at a node, of the solved equations              |
 * | ConditionEstimate | 1          | of the scaled equations, 1-norm                             |
 * | BendingEnergy     | 1          | thin plate only: integral of s_xx^2 + 2 s_xy^2 + s_yy^2     |
 * | DefectArea        | 1          | mm^2 on the filled surface                                  |
 *
 * An empty defect is no error: the output is the input with empty arrays, with a warning.
 *
 * Source: Carr 1996, sections 6.3 and 6.4. @sa lacuna::FillHole
 */
#ifndef vtkLacunaRBFHoleFiller_h
#define vtkLacunaRBFHoleFiller_h

#include "vtkImageAlgorithm.h"
#include "vtkLacunaFiltersRadialBasisModule.h" // for export macro
#include "vtkSmartPointer.h"                   // for ivar

#include <string> // for ivars

class vtkImplicitFunction;

class VTKLACUNAFILTERSRADIALBASIS_EXPORT vtkLacunaRBFHoleFiller : public vtkImageAlgorithm
{
public:
  static vtkLacunaRBFHoleFiller* New();
  vtkTypeMacro(vtkLacunaRBFHoleFiller, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum KernelType
  {
    ThinPlate = 0, ///< r^2 log r: the smoothest surface through the nodes
    Linear = 1,    ///< r: tent-like, may crease at nodes
    Cubic = 3      ///< r^3: smoother than the thin plate at the nodes, swings more between them
  };

  /// Points of a ray that are tried against DefectRegion.
  static constexpr int RegionSamples = 64;

  ///@{
  /** Radial function. Default ThinPlate. */
  vtkSetMacro(Kernel, int);
  vtkGetMacro(Kernel, int);
  ///@}

  ///@{
  /** What it contains, or covers, is defect. World coordinates. Default none. */
  void SetDefectRegion(vtkImplicitFunction* region);
  vtkImplicitFunction* GetDefectRegion();
  ///@}

  ///@{
  /** Point array of the map with one component: not 0 is defect. Default "" (or "None"): none. */
  void SetDefectArray(const char* name);
  const char* GetDefectArray() const { return this->DefectArray.c_str(); }
  ///@}

  ///@{
  /**
   * Point array of the map with one component: not 0 is sound surface that the fit may use; all
   * else is not. SupportMargin does not count then. Default "" (or "None"): none.
   */
  void SetSupportArray(const char* name);
  const char* GetSupportArray() const { return this->SupportArray.c_str(); }
  ///@}

  ///@{
  /** How far from the defect the surface is used, mm, > 0. Default 12. */
  vtkSetMacro(SupportMargin, double);
  vtkGetMacro(SupportMargin, double);
  ///@}

  ///@{
  /**
   * Nodes are the pixels nearest to a lattice of this spacing, mm, > 0. Smooth bone needs about 1
   * (Carr 1996, section 6.1.5). Time grows with the third power of the number of nodes, memory (8
   * bytes) with the second; above 4 GiB, about 23 000 nodes, the filter stops with an error.
   * Default 1.
   */
  vtkSetMacro(NodeSpacing, double);
  vtkGetMacro(NodeSpacing, double);
  ///@}

  ///@{
  /**
   * mu >= 0. Above 0 the fit does not pass through the nodes but minimises the sum of squares of
   * its distances (mm) from them plus mu times its energy. For the thin plate the energy is the
   * bending energy, which has no unit, and mu is in mm^2; see lacuna::RadialBasisOptions for the
   * others. Default 0.
   */
  vtkSetMacro(Smoothing, double);
  vtkGetMacro(Smoothing, double);
  ///@}

  ///@{
  /**
   * Cut-off wavelength of the fit, mm, >= 0. Above 0 it determines the smoothing, for any kernel and
   * NodeSpacing: of waves of this length the fit follows half the amplitude, of shorter ones less
   * (the spline filter of ISO 16610-22). Smoothing must be 0 then. Default 0.
   */
  vtkSetMacro(CutoffWavelength, double);
  vtkGetMacro(CutoffWavelength, double);
  ///@}

  ///@{
  /** Fitted goes so far beyond defect and support, mm, >= 0, up to the map's border. Default 0. */
  vtkSetMacro(OutputMargin, double);
  vtkGetMacro(OutputMargin, double);
  ///@}

  vtkMTimeType GetMTime() override;

protected:
  vtkLacunaRBFHoleFiller();
  ~vtkLacunaRBFHoleFiller() override;
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkLacunaRBFHoleFiller(const vtkLacunaRBFHoleFiller&) = delete;
  void operator=(const vtkLacunaRBFHoleFiller&) = delete;

  void SetArrayName(std::string& member, const char* name);

  int Kernel = ThinPlate;
  vtkSmartPointer<vtkImplicitFunction> DefectRegion;
  std::string DefectArray;
  std::string SupportArray;
  double SupportMargin = 12;
  double NodeSpacing = 1;
  double Smoothing = 0;
  double CutoffWavelength = 0;
  double OutputMargin = 0;
};
#endif
