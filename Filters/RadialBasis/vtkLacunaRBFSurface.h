// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaRBFSurface
 * @brief makes a closed surface of points, outlines, meshes and depth maps
 *
 * Input: one or more data sets, in mm:
 * - points with or without normals (the active ones, or the point array `Normals`; they leave the
 *   solid). Without, they are estimated from neighbours;
 * - triangle meshes, open or closed. Without normals, those of the triangles;
 * - depth maps (lacuna::DepthMap) with `Normals`, several views together;
 * - outlines: closed polylines, each in a plane of its own.
 *
 * Second input, optional (PriorSurface): a surface like the one that is sought, in the same place: a
 * closed mesh, or an image of the signed distance (mm, negative inside). What differs from it is fitted
 * if this predicts points better that are held out. Or PriorFunction, any implicit function.
 *
 * Points that SideArray says lie inside or outside are not on the surface; the surface keeps them on their
 * side.
 *
 * A smooth function, about the signed distance, is fitted to all points and normals at once
 * (lacuna::BlendedSpline); the surface is where it is 0. The error of the points is Smoothing, or it is
 * estimated from points that are held out at first. Where there are no points the surface goes on with
 * as little bending as possible.
 *
 * Output: vtkPolyData, triangles, closed and seen counter-clockwise from outside. Point data:
 * | array    | type       | meaning                                                          |
 * |----------|------------|------------------------------------------------------------------|
 * | Normals  | float x 3  | unit, outwards: the function's gradient                          |
 * | Distance | float, mm  | from the nearest point of the input                              |
 * | Residual | float, mm  | of that point: how far outside the surface it lies (signed)      |
 * | Support  | float      | Distance in units of the points' spacing; far above 1 the        |
 * |          |            | surface is extrapolated                                          |
 * Field data, one tuple each: `SurfaceVolume` (ml), `SurfaceVolumeError` (ml, standard error, with
 * outlines only), `SurfaceArea` (mm^2), `ResidualRMS` and `ResidualMaximum` (mm, of all points),
 * `PriorUsed` (1 or 0, with a prior only), `PointError` (mm, given or estimated), `NormalError`
 * (degrees, each of two directions), `CenterCount`, `FitTime` (s; not the same twice).
 *
 * Second output: vtkImageData with `SignedDistance` (float, mm, negative inside) from the triangles, if
 * DistanceSpacing is above 0; else empty.
 *
 * The output is one piece, whole, the same for any number of threads; further pieces are empty.
 *
 * Errors: too few points, points or normals that are not finite, points on a line or in a plane
 * without normals, outlines that are open or not planar, normals that contradict each other or point
 * inwards, a surface that cannot be closed, properties out of range.
 *
 * Source: Carr et al., SIGGRAPH 2001; Carr et al., GRAPHITE 2003.
 */
#ifndef vtkLacunaRBFSurface_h
#define vtkLacunaRBFSurface_h

#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersRadialBasisModule.h" // for export macro
#include "vtkPolyDataAlgorithm.h"
#include "vtkSmartPointer.h" // for ivars

#include <array>  // for bounds
#include <memory> // for the prior
#include <string> // for ivars
#include <vector> // for warnings

namespace lacuna
{
class Execution;
class SurfacePoints;
class SurfacePrior;
struct BlendedSplineOptions;
struct BlendedSplineReport;
struct FollowedSurface;
struct OrientedPoints;
struct SurfaceFollowerOptions;
struct TriangleSurface;
}

class vtkImageData;
class vtkImplicitFunction;

class VTKLACUNAFILTERSRADIALBASIS_EXPORT vtkLacunaRBFSurface
  : public vtkLacunaAlgorithmOf(vtkPolyDataAlgorithm)
{
public:
  static vtkLacunaRBFSurface* New();
  vtkTypeMacro(vtkLacunaRBFSurface, vtkPolyDataAlgorithm);

  enum KernelType
  {
    Biharmonic = 0, ///< r: follows detail, less smooth
    Triharmonic = 1 ///< r^3: smooth curvature
  };

  ///@{
  /** Radial function in space. Default Triharmonic. */
  vtkSetMacro(Kernel, int);
  vtkGetMacro(Kernel, int);
  ///@}

  ///@{
  /**
   * Expected error of the points, mm, >= 0. Default 0: estimated from the data. With ErrorArray it
   * multiplies the array's values.
   */
  vtkSetMacro(Smoothing, double);
  vtkGetMacro(Smoothing, double);
  ///@}

  ///@{
  /**
   * mm, above 0. Local functions are added where points are missed by more (RMS), and where that
   * helps. Default 0.01.
   */
  vtkSetMacro(Accuracy, double);
  vtkGetMacro(Accuracy, double);
  ///@}

  ///@{
  /** Largest distance of the triangles' points from the zeros of the function, mm. Default 0.001. */
  vtkSetMacro(Tolerance, double);
  vtkGetMacro(Tolerance, double);
  ///@}

  ///@{
  /** Point array with one component, > 0: expected error of each point. Default "": all the same. */
  void SetErrorArray(const char* name);
  const char* GetErrorArray() const { return this->ErrorArray.c_str(); }
  ///@}

  ///@{
  /**
   * Point array with one component: below 0 for points that lie inside the solid, above 0 for points
   * outside, 0 for points on its surface. Inputs without it lie on the surface. Default "": all do.
   */
  void SetSideArray(const char* name);
  const char* GetSideArray() const { return this->SideArray.c_str(); }
  ///@}

  void RemovePriorSurface(); ///< disconnects the second input

  ///@{
  /**
   * Instead of a second input: negative inside, mm as its unit of length. It is divided by the length of its
   * gradient. Default none.
   */
  void SetPriorFunction(vtkImplicitFunction* function);
  vtkImplicitFunction* GetPriorFunction() const;
  ///@}

  vtkMTimeType GetMTime() override; ///< with that of PriorFunction

  ///@{
  /**
   * Edges of the triangles, mm, >= 0. Default 0: the spacing of the points, at least a 200th and at
   * most a 40th of their extent.
   */
  vtkSetMacro(OutputSpacing, double);
  vtkGetMacro(OutputSpacing, double);
  ///@}

  ///@{
  /**
   * xmin xmax ymin ymax zmin zmax, mm; the surface ends there. An axis with min > max has the bounds of
   * the points and a quarter of their longest extent on both sides. Default all.
   */
  vtkSetVector6Macro(OutputBounds, double);
  vtkGetVector6Macro(OutputBounds, double);
  ///@}

  ///@{
  /** Closes the surface where it reaches the bounds. Default on. */
  vtkSetMacro(CapBoundary, bool);
  vtkGetMacro(CapBoundary, bool);
  vtkBooleanMacro(CapBoundary, bool);
  ///@}

  ///@{
  /**
   * Voxels of the second output, mm, >= 0. They fill OutputBounds, which must then be given on all axes.
   * Default 0: none.
   */
  vtkSetMacro(DistanceSpacing, double);
  vtkGetMacro(DistanceSpacing, double);
  ///@}

protected:
  vtkLacunaRBFSurface();
  ~vtkLacunaRBFSurface() override;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  void Announce(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;
  std::vector<vtkDataObject*> GetOrigins(const lacuna::Ports& ports) const override;

private:
  vtkLacunaRBFSurface(const vtkLacunaRBFSurface&) = delete;
  void operator=(const vtkLacunaRBFSurface&) = delete;

  bool HasOutputBounds() const;
  void CheckDistanceGrid(const std::array<double, 6>& own); ///< own: bounds of the points
  void CheckNormals(
    lacuna::Execution& execution, const lacuna::OrientedPoints& points, double spacing);
  void CheckSides(const lacuna::BlendedSplineReport& report);
  /// Warns, or throws; returns whether it is closed.
  bool CheckSurface(
    const lacuna::FollowedSurface& followed, const std::vector<std::string>& warnings);
  void CheckMisses(double rootMeanSquare, double extent);

  lacuna::SurfacePoints CollectPoints(const lacuna::Ports& ports, lacuna::Execution& execution);
  std::unique_ptr<const lacuna::SurfacePrior> FindPrior(
    const lacuna::Ports& ports, double extent, std::vector<std::string>& warnings);
  lacuna::BlendedSplineOptions GetFitOptions(const lacuna::SurfacePoints& collected) const;
  /// Adds a warning to collected.
  lacuna::SurfaceFollowerOptions GetFollowerOptions(
    lacuna::SurfacePoints& collected, const std::array<double, 6>& own, double spacing) const;
  void SetDistances(
    lacuna::Execution& execution, const lacuna::TriangleSurface& surface, vtkImageData* distances);

  vtkSmartPointer<vtkImplicitFunction> PriorFunction;
  std::string ErrorArray;
  std::string SideArray;
  double DistanceSpacing = 0;
  int Kernel = Triharmonic;
  double Smoothing = 0;
  double Accuracy = 0.01;
  double Tolerance = 0.001;
  double OutputSpacing = 0;
  double OutputBounds[6] = { 1, -1, 1, -1, 1, -1 };
  bool CapBoundary = true;
};
#endif
