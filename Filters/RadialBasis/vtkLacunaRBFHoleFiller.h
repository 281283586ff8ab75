// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaRBFHoleFiller
 * @brief fills a hole in a depth map with a radial basis function fitted to the surface around it
 *
 * Inputs: a parallel depth map (lacuna::DepthMap; the rays of perspective maps are not parallel, so
 * depth is not a height over the map, and they are refused), and what InputPort names.
 *
 * The defect is the union of what these mark:
 *  - DefectRegion: a pixel is in it when its surface point is, or when the region lies in front of
 *    that point: when one of 64 points of its ray, evenly spaced over the range of depths of the
 *    map, is in the region and not behind the surface. So a sphere put over a hole also takes what
 *    is seen through it; pixels without depth are in the region when any of these points is.
 *    Of a loop (vtkLacunaSplineLoop, or any vtkImplicitSelectionLoop with automatic normal): what it
 *    encloses in the view of the map, at whatever depth;
 *  - DefectArray;
 *  - the selection: the pixels of the selected points of the surface (or all its points when
 *    there is no selection), and those that they enclose, over edges between pixels: a patch, or a
 *    ring around the hole;
 *  - if there is nothing of these: with SupportArray what the painted pixels enclose; else the
 *    holes of the map, that is what its main surface encloses, grown by 2 mm because the rim of a
 *    hole in CT is rounded by the partial volume effect. The main surface is the largest piece of
 *    the map without depth steps (of more than 79 degrees between neighbours), so a hole may show
 *    nothing or the far side. Eye sockets are holes, too.
 *
 * Nodes are valid pixels within SupportMargin of the defect (map plane, centre to centre) or, with
 * a SupportArray, its painted ones, thinned to NodeSpacing (lacunaHoleSupport.h). What lies
 * beyond a depth step steeper than 79 degrees from the larger part is not used, with a warning.
 *
 * Control points (world) are met exactly whatever the smoothing; nodes within NodeSpacing of one are
 * left out. While only they change, the equations stay solved: each point that moved costs O(n^2), or
 * a fast solution; results do not depend on what was kept. With a prior surface the fit is of
 * the difference to it, as it is seen in this map (its own grid and view may be others): its shape
 * stays, its height and inclination do not count. Holes and steps of the prior are bridged, with a
 * warning; with smoothing the prior is smoothed, too.
 *
 * Output: a filled map (see lacunaDepthMap.h for its arrays and field data), as large as the map
 * or, with an OutputMargin, larger. The rectangle of Fitted bounds defect, support and control
 * points. Other arrays and field data of the map are passed on.
 * An empty defect is no error: the output is the input with empty arrays, and a warning.
 *
 * Source: Carr 1996, sections 6.3 and 6.4. @sa lacuna::HoleFiller
 */
#ifndef vtkLacunaRBFHoleFiller_h
#define vtkLacunaRBFHoleFiller_h

#include "lacunaRadialKernel.h"
#include "vtkImageAlgorithm.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersRadialBasisModule.h" // for export macro
#include "vtkSmartPointer.h"                   // for ivar

#include <memory> // for ivar
#include <string> // for ivars

class vtkImplicitFunction;
namespace lacuna
{
class AlgorithmExecution;
}
namespace lacuna
{
class HoleFiller;
struct HoleFillOptions;
class ParameterText;
struct MarkedMap;
}

class VTKLACUNAFILTERSRADIALBASIS_EXPORT vtkLacunaRBFHoleFiller
  : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  static vtkLacunaRBFHoleFiller* New();
  vtkTypeMacro(vtkLacunaRBFHoleFiller, vtkImageAlgorithm);

  /// Input ports; all but the first are optional.
  enum InputPort
  {
    MapPort = 0,
    SurfacePort = 1,       ///< Depth Map Surface of the map, or points extracted from it
    SelectionPort = 2,     ///< vtkSelection on the surface, or on the map when there is none
    ControlPointsPort = 3, ///< any data set: its points
    PriorSurfacePort = 4   ///< a depth map
  };

  ///@{
  /** Take the input of an optional port away. */
  void RemoveSurface() { this->RemoveAllInputConnections(SurfacePort); }
  void RemoveSelection() { this->RemoveAllInputConnections(SelectionPort); }
  void RemoveControlPoints() { this->RemoveAllInputConnections(ControlPointsPort); }
  void RemovePriorSurface() { this->RemoveAllInputConnections(PriorSurfacePort); }
  ///@}

  enum SolverType
  {
    Auto = 0,
    Direct = 1,
    Fast = 2
  };
  enum TrendType
  {
    NoTrend = 0,
    Ellipsoid = 1
  };

  ///@{
  /** Radial function, the number of a lacuna::RadialKernel; the filter when printed says which there are. Default
   * ThinPlate. */
  vtkSetMacro(Kernel, int);
  void SetKernel(lacuna::RadialKernel kernel) { this->SetKernel(static_cast<int>(kernel)); }
  vtkGetMacro(Kernel, int);
  ///@}

  ///@{
  /** Of kernels that have one, mm, >= 0; 0: 1.25 times the distance of nodes, of Wendland 5 times. Default 0. */
  vtkSetMacro(KernelLength, double);
  vtkGetMacro(KernelLength, double);
  ///@}

  ///@{
  /**
   * Ellipsoid: the fit is of the difference to the ellipsoid (one axis along the view) that fits the
   * bone around the defect best, see lacuna::EllipsoidTrend; not with a prior surface. Default
   * NoTrend.
   */
  vtkSetMacro(Trend, int);
  vtkGetMacro(Trend, int);
  ///@}

  ///@{
  /** What it contains, or covers, is defect. World coordinates. Default none. */
  void SetDefectRegion(vtkImplicitFunction* region);
  vtkImplicitFunction* GetDefectRegion();
  ///@}

  ///@{
  /** Point array of the map, one component: neither 0 nor NaN is defect. Default "" (or "None"). */
  void SetDefectArray(const char* name);
  const char* GetDefectArray() const { return this->DefectArray.c_str(); }
  ///@}

  ///@{
  /**
   * Point array of the map with one component: neither 0 nor NaN is sound surface that the fit
   * may use; all else is not. SupportMargin does not count then. Default "" (or "None"): none.
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
   * Surface within this distance of a depth step (above 65 degrees between neighbours) or of a pixel
   * without depth is not used, in mm in the map's plane, >= 0: beside burr holes, saw cuts and the
   * rim of the hole the partial volume effect rounds the bone, and kernels that carry its
   * curvature into the hole (Cubic) carry that, too; in a view that does not quite face the hole
   * the cut wall on its far side is no bone to follow, either. Default 2; 0: off.
   */
  vtkSetMacro(SupportStepMargin, double);
  vtkGetMacro(SupportStepMargin, double);
  ///@}

  ///@{
  /**
   * Nodes are the pixels nearest to a lattice of this spacing, mm, > 0. Smooth bone needs about 1
   * (Carr 1996, section 6.1.5). Default 1.
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
   * Cut-off wavelength of the fit, mm, >= 0. Above 0 it determines the smoothing, for any
   * NodeSpacing and every kernel but Gaussian and Multiquadric: of waves of this length the fit
   * follows half the amplitude, of shorter ones less (the spline filter of ISO 16610-22). Smoothing
   * must be 0 then. Default 0.
   */
  vtkSetMacro(CutoffWavelength, double);
  vtkGetMacro(CutoffWavelength, double);
  ///@}

  ///@{
  /**
   * Point array of the control points with their depths, mm along the view from the map's plane;
   * positions then only say where in the map they are. Default "" (or "None"): the surface passes
   * through the positions.
   */
  void SetControlDepthArray(const char* name);
  const char* GetControlDepthArray() const { return this->ControlDepthArray.c_str(); }
  ///@}

  ///@{
  /**
   * Fitted goes so far beyond defect and support, mm, >= 0. The output is larger than the map by as
   * much on each side, so that a defect near its border has its margin, too; pixel (0, 0) stays where
   * it was, so the extent then begins below 0. Default 0.
   */
  vtkSetMacro(OutputMargin, double);
  vtkGetMacro(OutputMargin, double);
  ///@}

  ///@{
  /**
   * Pixels of the output along the map's right and down, mm; 0 (each): those of the map. The fit
   * is evaluated there; outside of the defect depths of the filled map are interpolated linearly,
   * but not across steps, other arrays come from the nearest pixel. The third number is for the one
   * layer of the map and has no effect. Default 0 0 0.
   */
  vtkSetVector3Macro(OutputSpacing, double);
  vtkGetVector3Macro(OutputSpacing, double);
  ///@}

  ///@{
  /**
   * Relative to the range of depths at the nodes: so much may the fit be wrong; 0 <= Accuracy < 1.
   * 0: exact up to round-off. Default 1e-4.
   */
  vtkSetMacro(Accuracy, double);
  vtkGetMacro(Accuracy, double);
  ///@}

  ///@{
  /**
   * Direct: LAPACK; time grows with the third power of the number of nodes, memory (8 bytes) with
   * the second; above 4 GiB, about 23 000 nodes, the filter stops with an error. Fast: iteration in
   * linear memory, within Accuracy. Auto: Direct up to 1500 nodes. Default Auto.
   */
  vtkSetMacro(Solver, int);
  vtkGetMacro(Solver, int);
  ///@}

  vtkMTimeType GetMTime() override;

protected:
  vtkLacunaRBFHoleFiller();
  ~vtkLacunaRBFHoleFiller() override;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  void Announce(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;
  std::string Parameters(int port) const override;
  std::vector<vtkDataObject*> GetOrigins(const lacuna::Ports& ports) const override;

private:
  vtkLacunaRBFHoleFiller(const vtkLacunaRBFHoleFiller&) = delete;
  void operator=(const vtkLacunaRBFHoleFiller&) = delete;

  void SetArrayName(std::string& member, const char* name);
  lacuna::HoleFillOptions GetOptions() const;
  /// Adds to where what says which pixels are marked, and how.
  void MarkDefect(lacuna::AlgorithmExecution& execution, vtkImageData* map,
    const lacuna::Ports& ports, lacuna::MarkedMap& marked, lacuna::ParameterText& where);

  int Kernel = 0; // ThinPlate
  double KernelLength = 0;
  int Trend = NoTrend;
  vtkSmartPointer<vtkImplicitFunction> DefectRegion;
  std::string DefectArray;
  std::string SupportArray;
  double SupportMargin = 12;
  double SupportStepMargin = 2;
  double NodeSpacing = 1;
  double Smoothing = 0;
  double CutoffWavelength = 0;
  std::string ControlDepthArray;
  double OutputMargin = 0;
  double OutputSpacing[3] = { 0, 0, 0 };
  double Accuracy = 1e-4;
  int Solver = Auto;
  std::unique_ptr<lacuna::HoleFiller> Filler; // keeps equations while control points move
  std::string Made;                           ///< which pixels of the last map were marked
};
#endif
