// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Box mean, Gaussian and Laplacian of Gaussian.
///
/// Sums are exact for integers; integer results are rounded once, halves upwards. NaN samples are
/// left out of the means and Gaussians of their neighbours (the weights of the others are scaled
/// up) and stay NaN themselves; a Laplacian is NaN wherever NaN is in reach. Borders: the nearest
/// sample is repeated. No step depends on where a block begins: results are the same for any
/// division.
#ifndef lacunaLinearFilters_h
#define lacunaLinearFilters_h

#include "lacunaExecution.h"
#include "lacunaImageView.h"
#include "lacunaSeparable.h"
#include "lacunaVectorUnit.h"
#include "lacunaWindow.h"

#include <array>
#include <type_traits>
#include <vector>

namespace lacuna
{
/// What Gaussians of T are computed in: float holds 8 and 16 bit integers exactly.
template <class T>
using LinearType = std::conditional_t<(sizeof(T) <= 2 || std::is_same_v<T, float>), float, double>;

/// The type of a Laplacian of T: it has fractions and both signs.
template <class T>
using LaplacianType = std::conditional_t<std::is_same_v<T, double>, double, float>;

/// Mean of a box window: floor(sum / n + 1/2) for integers; floating samples are added in double.
template <class T>
void FilterMean(const ImageView<const T>& input, const ImageView<T>& output, const Window& window,
  VectorUnit set, Execution& execution);

/// Standard deviations in samples along x, y, z; 0 leaves an axis alone.
using Deviations = std::array<double, 3>;

constexpr int MaximumGaussianRadius = 1000;

/// How far a Gaussian of these deviations reaches: 4 of them, rounded to samples (as in
/// scipy.ndimage.gaussian_filter). Throws std::invalid_argument when a deviation is negative, not
/// finite or reaches beyond MaximumGaussianRadius.
Reach GaussianReach(const Deviations& deviations);
/// The same of a Laplacian of Gaussian: 6 deviations, at least 2 samples.
Reach LaplacianReach(const Deviations& deviations);

/// exp(-i^2 / (2 deviation^2)), i = -radius ... radius, normalised to the sum 1.
std::vector<double> GaussianWeights(double deviation, int radius);
/// (i^2 / deviation^4 - 1 / deviation^2) times the Gaussian weights, with a multiple of these taken
/// away and scaled so that the sum is 0 and the second moment 2: constants and slopes give exactly
/// 0, i^2 gives 2. From a deviation of 1 on the change is below 1e-5.
std::vector<double> SecondDerivativeWeights(double deviation, int radius);

/// Gaussian-weighted mean, the product of GaussianWeights along the axes.
template <class T>
void FilterGaussian(const ImageView<const T>& input, const ImageView<T>& output,
  const Deviations& deviations, VectorUnit set, Execution& execution);

/// Sum over the axes with a deviation of the second derivative of the Gaussian-filtered image, in
/// grey levels per mm^2 (spacing: mm between samples).
template <class T>
void FilterLaplacianOfGaussian(const ImageView<const T>& input,
  const ImageView<LaplacianType<T>>& output, const Deviations& deviations,
  const std::array<double, 3>& spacing, VectorUnit set, Execution& execution);
}
#endif
