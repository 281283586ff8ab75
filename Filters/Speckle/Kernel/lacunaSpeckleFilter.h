// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The speckle filters of Carr 1996, section 4.5, behind one call.
#ifndef lacunaSpeckleFilter_h
#define lacunaSpeckleFilter_h

#include "lacunaLinearFilters.h"
#include "lacunaMorphology.h"
#include "lacunaRankFilter.h"

namespace lacuna
{
enum class SpeckleOperation
{
  Median,
  Rank,
  Minimum,
  Maximum,
  Opening,
  Closing,
  OpenClose,
  CloseOpen,
  Mode,
  AdaptiveMedian,
  Mean,
  Gaussian,
  LaplacianOfGaussian
};

struct SpeckleParameters
{
  SpeckleOperation Operation = SpeckleOperation::Median;
  std::array<int, 3> KernelSize{ 5, 5, 1 };
  WindowShape Shape = WindowShape::Box; ///< not for Mean, Gaussian, LaplacianOfGaussian
  double Percentile = 50;               ///< of Rank, 0 to 100
  double AdaptiveStrength = 10;         ///< of AdaptiveMedian
  /// Of Gaussian and LaplacianOfGaussian, in mm, along the axes whose KernelSize exceeds 1.
  double StandardDeviation = 1.4142135623730951;
  std::array<double, 3> Spacing{ 1, 1, 1 }; ///< mm between samples
  VectorUnit Set = BestVectorUnit();
};

/// The box of all samples that the results in box depend on. Throws std::invalid_argument when
/// parameters make no sense.
Extent GetSpeckleInput(const SpeckleParameters& parameters, const Extent& box);

/// Filters the samples of output.Box from those of input, whose box contains it; input must reach
/// GetSpeckleInput(parameters, output.Box) except where the image ends. Every operation but
/// LaplacianOfGaussian. T: the fixed-width integers, float, double.
template <class T>
void FilterSpeckle(const ImageView<const T>& input, const ImageView<T>& output,
  const SpeckleParameters& parameters, Execution& execution);

/// The same for LaplacianOfGaussian.
template <class T>
void FilterSpeckleLaplacian(const ImageView<const T>& input,
  const ImageView<LaplacianType<T>>& output, const SpeckleParameters& parameters,
  Execution& execution);
}
#endif
