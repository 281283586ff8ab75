// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaSpeckleFilter
 * @brief speckle reduction of images, volumes and tracked slices
 *
 * Replaces each sample by something that its neighbourhood says about it: a rank (median, any
 * percentile, least, greatest, estimated mode), morphological openings and closings, an adaptive
 * weighted median, a mean or a Gaussian. LaplacianOfGaussian marks edges instead.
 *
 * Input: vtkImageData of any extent with a point array of numbers (ScalarArray; each component is
 * filtered by itself). Output: the same image with that array filtered and of the
 * same type, except LaplacianOfGaussian: float (double for double). All other point arrays and all
 * field data are carried along. With KernelSize z = 1 (default) each slice is filtered by itself:
 * right for tracked slices, whose stack has a spacing of 1 along all axes, so that lengths there
 * are in pixels instead of mm.
 *
 * Windows cover the offsets -n/2 ... n - 1 - n/2 for a size of n samples (n/2 rounded down).
 * Outside of the image the nearest sample is repeated (scipy.ndimage's mode 'nearest'). NaN samples
 * are left out of their neighbours' windows and stay NaN (a Laplacian is NaN wherever NaN is in
 * reach). Mean and Gaussian of integers are rounded once, halves upwards. Results are the same bit
 * for bit for any number of threads and pieces and on any x86-64 processor.
 *
 * J. C. Carr, Surface Reconstruction in 3D Medical Imaging, 1996, sections 4.4 and 4.5.
 */
#ifndef vtkLacunaSpeckleFilter_h
#define vtkLacunaSpeckleFilter_h

#include "vtkImageAlgorithm.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersSpeckleModule.h" // for export macro

#include <string> // for the array's name

namespace lacuna
{
struct SpeckleParameters;
}

class VTKLACUNAFILTERSSPECKLE_EXPORT vtkLacunaSpeckleFilter
  : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  static vtkLacunaSpeckleFilter* New();
  vtkTypeMacro(vtkLacunaSpeckleFilter, vtkImageAlgorithm);

  ///@{
  /// The point array of numbers; empty: the active scalars. Default: empty.
  vtkSetMacro(ScalarArray, std::string);
  vtkGetMacro(ScalarArray, std::string);
  ///@}

  enum OperationType
  {
    Median,
    AnyRank,
    Minimum,
    Maximum,
    Opening,        ///< minimum, then maximum: removes bright details
    Closing,        ///< maximum, then minimum: fills dark details
    OpenClose,      ///< opening, then closing
    CloseOpen,      ///< closing, then opening
    Mode,           ///< truncated median (Davies 1988; Evans & Nixon 1993)
    AdaptiveMedian, ///< weighted median (Loupas 1989; Evans & Nixon 1993)
    Mean,
    Gaussian,
    LaplacianOfGaussian,
    TopHat ///< the sample minus its opening: bright details alone
  };
  ///@{
  /// What to do. Default: Median.
  vtkSetMacro(Operation, int);
  vtkGetMacro(Operation, int);
  ///@}

  ///@{
  /// Samples of the window along x, y, z, 1 to 255 each; at most 2^20 in all for ranks. Gaussian
  /// and LaplacianOfGaussian work along the axes where this exceeds 1. Default: 5 5 1.
  vtkSetVector3Macro(KernelSize, int);
  vtkGetVector3Macro(KernelSize, int);
  ///@}

  enum KernelShapeType
  {
    Box,
    Ellipsoid ///< with the kernel size as diameters: no blocks in large openings and closings
  };
  ///@{
  /// Shape of the window of ranks and morphology; Mean always takes the box. Default: Box.
  vtkSetMacro(KernelShape, int);
  vtkGetMacro(KernelShape, int);
  ///@}

  ///@{
  /// Percentile that AnyRank takes, 0 (the least) to 100 (the greatest). Default: 50, the median.
  vtkSetMacro(Rank, double);
  vtkGetMacro(Rank, double);
  ///@}

  ///@{
  /// How fast the weights of AdaptiveMedian fall with distance (in samples) times variance / mean
  /// of the window; 0 or more, 0 is the plain median. Default: 10, for grey levels 0 ... 255.
  vtkSetMacro(AdaptiveStrength, double);
  vtkGetMacro(AdaptiveStrength, double);
  ///@}

  ///@{
  /// Of Gaussian and LaplacianOfGaussian, in mm (pixels in tracked slices), above 0.
  /// Default: 1.4142135623730951, which smooths as much as a mean of 5 samples at spacing 1.
  vtkSetMacro(StandardDeviation, double);
  vtkGetMacro(StandardDeviation, double);
  ///@}

protected:
  vtkLacunaSpeckleFilter();
  ~vtkLacunaSpeckleFilter() override = default;

  void Announce(const lacuna::Ports& ports) override;
  void Ask(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

private:
  vtkLacunaSpeckleFilter(const vtkLacunaSpeckleFilter&) = delete;
  void operator=(const vtkLacunaSpeckleFilter&) = delete;

  lacuna::SpeckleParameters GetOptions(const double spacing[3]) const;

  std::string ScalarArray;
  int Operation = Median;
  int KernelSize[3] = { 5, 5, 1 };
  int KernelShape = Box;
  double Rank = 50;
  double AdaptiveStrength = 10;
  double StandardDeviation = 1.4142135623730951;
};
#endif
