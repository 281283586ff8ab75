// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The best line through a slice's beams.
#ifndef lacunaBonePath_h
#define lacunaBonePath_h

#include <vector>

namespace lacuna
{
/// What a line costs, in the unit of gains.
struct PathCosts
{
  double Step; ///< from beam to beam, for each sample of difference
  double Jump; ///< at most, of a step
  double End;  ///< where the line ends or begins
};

/// A line meets each beam in one sample or not at all. Returns the one with the largest sum of gains less costs: the
/// sample of each beam, -1 for none (dynamic programming: Foroughi et al., IEEE Ultrasonics Symposium 2007).
/// gains: of all samples, beam after beam. Of equal lines, the result is always the same one.
std::vector<int> FindBestPath(const std::vector<float>& gains, int samples, const PathCosts& costs);
}
#endif
