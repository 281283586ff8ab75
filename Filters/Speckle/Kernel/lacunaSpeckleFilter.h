// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The speckle filters of Carr 1996, section 4.5, behind one call.
#ifndef lacunaSpeckleFilter_h
#define lacunaSpeckleFilter_h

#include "lacunaExecution.h"
#include "lacunaImageView.h"
#include "lacunaLinearFilters.h"
#include "lacunaProperties.h"
#include "lacunaRankFilter.h"
#include "lacunaVectorUnit.h"
#include "lacunaWindow.h"

#include <array>

namespace lacuna
{
// The adaptive weighted median (Loupas, McDicken & Allan 1989; Evans & Nixon 1993; Carr 1996,
// section 4.5.4).
//
// In a window of mean m and variance v (of its population) the sample at distance d from the
// centre, in samples, has the weight w = max(0, 99 - Strength d v / |m|), rounded to a whole
// number. The result is the least sample such that it and those not above it weigh more than half
// of all (rounded down). Where v / |m| is small, in fully developed speckle, this is the median;
// at an edge only samples near the centre count. With m = 0 and v > 0 the sample stays
// (unless Strength is 0: that is the plain median).
//
// NaN samples are left out and stay NaN. Borders: the nearest sample is repeated. The cost grows
// with the number of samples in the window.

/// As FilterRank. Throws std::invalid_argument when strength is negative or not finite.
template <class T>
void FilterAdaptiveMedian(const ImageView<const T>& input, const ImageView<T>& output,
  const Window& window, double strength, Execution& execution);

// Least and greatest sample of a window: grey erosion and dilation.
//
// Exact for all types. NaN samples are left out of the windows of their neighbours and stay NaN
// themselves. Borders: the nearest sample is repeated. Boxes cost the same whatever their size
// (each doubling of the window is one more minimum of whole vectors); ellipsoids one minimum of
// whole rows for each row of the window.

enum class Extreme
{
  Least,
  Greatest
};

/// Filters the samples of output.Box from those of input, whose box contains it; input must reach
/// window.Grow(output.Box) except where the image ends. T: the fixed-width integers, float, double.
template <class T>
void FilterExtreme(const ImageView<const T>& input, const ImageView<T>& output,
  const Window& window, Extreme extreme, VectorUnit set, Execution& execution);

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
  LaplacianOfGaussian,
  TopHat ///< the sample minus its opening; what an integer type cannot hold becomes its maximum
};
inline constexpr std::array<const char*, 14> SpeckleOperationNames{ "Median", "Rank", "Minimum",
  "Maximum", "Opening", "Closing", "OpenClose", "CloseOpen", "Mode", "AdaptiveMedian", "Mean",
  "Gaussian", "LaplacianOfGaussian", "TopHat" };

struct SpeckleParameters
{
  SpeckleOperation Operation = SpeckleOperation::Median;
  std::array<int, 3> KernelSize{ 5, 5, 1 };
  WindowShape Shape = WindowShape::Box; ///< not for Mean, Gaussian, LaplacianOfGaussian
  double Percentile = 50;               ///< of Rank
  double AdaptiveStrength = 10;         ///< of AdaptiveMedian
  /// Of Gaussian and LaplacianOfGaussian, in mm, along the axes whose KernelSize exceeds 1.
  double StandardDeviation = 1.4142135623730951;
  std::array<double, 3> Spacing{ 1, 1, 1 }; ///< mm between samples
  VectorUnit Set = BestVectorUnit();

  void Describe(Properties& properties) const; ///< with the ranges
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
