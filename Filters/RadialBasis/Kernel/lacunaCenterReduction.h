// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Fewer nodes for the same function (Carr et al. 2001, section 4).
#ifndef lacunaCenterReduction_h
#define lacunaCenterReduction_h

#include "lacunaRadialBasis.h"

#include <array>
#include <cstddef>
#include <vector>

namespace lacuna
{
/// Chooses nodes greedily so that the radial basis function through them misses no value by more
/// than tolerance (> 0, in the unit of the values): starts from a few that are spread evenly and
/// adds those with the largest errors, no two neighbours at once, until all values are met. Returns
/// their indices, ascending. options are those of the fits (without Errors); with Smoothing the
/// tolerance may be out of reach. Throws what RadialBasis throws, and std::runtime_error when
/// all nodes together miss a value by more.
template <int Dimension>
std::vector<std::size_t> ReduceCenters(Execution& execution,
  const std::vector<std::array<double, Dimension>>& nodes, const std::vector<double>& values,
  const RadialBasisOptions& options, double tolerance);
}
#endif
