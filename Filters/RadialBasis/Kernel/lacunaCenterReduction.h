// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Fewer nodes for the same function (Carr et al. 2001, section 4).
#ifndef lacunaCenterReduction_h
#define lacunaCenterReduction_h

#include "lacunaRadialBasis.h"

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace lacuna
{
template <int Dimension>
struct ReducedCenters
{
  std::vector<std::size_t> Indices; ///< of the nodes that are kept, ascending
  std::size_t NodeCount = 0;        ///< nodes at different places, kept or not
  /// Bound of |value - function| at all nodes, in the unit of the values; at most the tolerance.
  double Residual = 0;
  std::shared_ptr<const RadialBasis<Dimension>> Function; ///< through the nodes that are kept
};

/// Chooses nodes greedily so that the radial basis function through them misses none of the values,
/// values[component][node], by more than tolerance (> 0, in the unit of the values): starts from a few
/// that are spread evenly and adds those with the largest errors, no two neighbours at once, until
/// all values are met. Takes some ten fits of which the last is as large as what is kept, and as
/// many evaluations at all nodes (fast sums where that pays).
///
/// options are those of the fits, without Errors; their Accuracy, if above 0, is raised where the
/// tolerance needs it. With Smoothing the tolerance may be out of reach. Throws what RadialBasis
/// throws, and std::runtime_error when values are missed by more with no node left that would help.
template <int Dimension>
ReducedCenters<Dimension> ReduceCenters(Execution& execution,
  const std::vector<std::array<double, Dimension>>& nodes,
  const std::vector<std::vector<double>>& values, const RadialBasisOptions& options,
  double tolerance);
}
#endif
