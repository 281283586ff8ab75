// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaRBFInterpolator
 * @brief makes an image of values that are known at scattered points
 *
 * Input: any data set with points and a numeric point array. For each component of the array a
 * radial basis function with a linear polynomial (quadratic for the triharmonic) is fitted: through
 * the values, or near them when Smoothing is above 0. Points that have the same coordinate along
 * one axis, up to 1e-9 of their extent, are interpolated in two dimensions and give an image of one
 * layer. Points at the same place are merged when their values agree; else, and when points or
 * values are not finite, the error names them.
 *
 * Output: an image along the axes with the array's name, double, as many components. Its grid is
 * OutputBounds (by default those of the points) in steps of OutputSpacing; both ends are within the
 * bounds, the first point is their lower corner. Field data:
 * | array             | components | meaning                                                      |
 * |-------------------|------------|--------------------------------------------------------------|
 * | NodeCount         | 1          | points at different places                                   |
 * | CenterCount       | 1          | points that the function passes through (or near); less than |
 * |                   |            | NodeCount with CenterTolerance above 0                       |
 * | Residual          | 1          | largest |value - fit| at a point, less what smoothing        |
 * |                   |            | allows; with CenterTolerance above 0 nothing is taken away   |
 * | ConditionEstimate | 1          | of the scaled equations, 1-norm; 0 when they were solved by  |
 * |                   |            | iteration                                                    |
 * | Iterations        | 1          | 0 when the equations were solved directly                    |
 *
 * Time and memory grow in proportion to the number of points (times its logarithm) and of voxels:
 * see Solver and lacuna::RadialBasis. The result has the same bits for any number of threads and
 * pieces.
 *
 * Source: Carr 1996, section 6.3; Beatson, Light & Billings 2000; Fong & Darve 2009.
 */
#ifndef vtkLacunaRBFInterpolator_h
#define vtkLacunaRBFInterpolator_h

#include "lacunaRadialKernel.h"
#include "vtkImageAlgorithm.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersRadialBasisModule.h" // for export macro

#include <string> // for ivars
#include <vector> // for errors

class vtkDataSet;

namespace lacuna
{
struct RadialBasisOptions;
}

class VTKLACUNAFILTERSRADIALBASIS_EXPORT vtkLacunaRBFInterpolator
  : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  static vtkLacunaRBFInterpolator* New();
  vtkTypeMacro(vtkLacunaRBFInterpolator, vtkImageAlgorithm);

  enum SolverType
  {
    Auto = 0,   ///< Direct up to 1500 points, else Fast
    Direct = 1, ///< LAPACK, at most about 23 000 points
    Fast = 2    ///< iteration with fast sums
  };

  ///@{
  /** Point array to interpolate. Default "" (or "None"): the active scalars. */
  void SetScalarArray(const char* name);
  const char* GetScalarArray() const { return this->ScalarArray.c_str(); }
  ///@}

  ///@{
  /** Radial function, the number of a lacuna::RadialKernel; the filter when printed says which there are. Default
   * ThinPlate. */
  vtkSetMacro(Kernel, int);
  void SetKernel(lacuna::RadialKernel kernel) { this->SetKernel(static_cast<int>(kernel)); }
  vtkGetMacro(Kernel, int);
  ///@}

  ///@{
  /**
   * Length of kernels that have one, in the unit of the points, >= 0. Default 0: 1.25 times the mean distance of
   * neighbours, of Wendland 5 times.
   */
  vtkSetMacro(KernelLength, double);
  vtkGetMacro(KernelLength, double);
  ///@}

  ///@{
  /**
   * mu >= 0. Above 0 the fit minimises the sum of squares of its distances from the values (each
   * divided by its error, see ErrorArray) plus mu times its energy; see
   * lacuna::RadialBasisOptions. Default 0.
   */
  vtkSetMacro(Smoothing, double);
  vtkGetMacro(Smoothing, double);
  ///@}

  ///@{
  /**
   * Point array with one component, > 0: how much each value may be wrong, relative to the others.
   * Counts with Smoothing only. Default "" (or "None"): all the same.
   */
  void SetErrorArray(const char* name);
  const char* GetErrorArray() const { return this->ErrorArray.c_str(); }
  ///@}

  ///@{
  /**
   * Relative to the range of the values, 0 to less than 1: a Fast fit misses no value by more, and
   * the image is wrong by no more than that besides. 0: all is exact up to round-off and solved
   * directly, in time that grows with the third power of the number of points. Default 1e-4.
   */
  vtkSetMacro(Accuracy, double);
  vtkGetMacro(Accuracy, double);
  ///@}

  ///@{
  /** How the equations are solved. Default Auto. */
  vtkSetMacro(Solver, int);
  vtkGetMacro(Solver, int);
  ///@}

  ///@{
  /** Steps along x, y, z, >= 0. 0: a hundredth of the longest edge of the grid. Default 0 0 0. */
  vtkSetVector3Macro(OutputSpacing, double);
  vtkGetVector3Macro(OutputSpacing, double);
  ///@}

  ///@{
  /** xmin xmax ymin ymax zmin zmax. An axis with min > max is that of the points. Default all. */
  vtkSetVector6Macro(OutputBounds, double);
  vtkGetVector6Macro(OutputBounds, double);
  ///@}

  ///@{
  /**
   * In the unit of the values, >= 0. Above 0 the function passes through a few of the points only,
   * chosen greedily so that the values of all points are missed by no more than this; see
   * lacuna::ReduceCenters. Not together with ErrorArray. Default 0: through all points.
   */
  vtkSetMacro(CenterTolerance, double);
  vtkGetMacro(CenterTolerance, double);
  ///@}

protected:
  vtkLacunaRBFInterpolator() = default;
  ~vtkLacunaRBFInterpolator() override = default;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  void Announce(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

private:
  vtkLacunaRBFInterpolator(const vtkLacunaRBFInterpolator&) = delete;
  void operator=(const vtkLacunaRBFInterpolator&) = delete;

  lacuna::RadialBasisOptions GetOptions() const;
  std::vector<double> GetErrors(vtkDataSet* points) const;

  std::string ScalarArray;
  std::string ErrorArray;
  int Kernel = 0; // ThinPlate
  double KernelLength = 0;
  double Smoothing = 0;
  double Accuracy = 1e-4;
  int Solver = Auto;
  double CenterTolerance = 0;
  double OutputSpacing[3] = { 0, 0, 0 };
  double OutputBounds[6] = { 1, -1, 1, -1, 1, -1 };
};
#endif
