// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The equally spaced planes that a row of slices lies on, and where they do not.
#ifndef lacunaSliceSpacing_h
#define lacunaSliceSpacing_h

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lacuna
{
/// Planes at First + k * Spacing, 0 <= k < Planes, in mm along the normal.
struct SliceSpacing
{
  double First = 0;
  double Spacing = 1;
  double Usual = 1; ///< distance from slice to slice; Spacing is this, unless gaps are unequal
  std::int64_t Planes = 1;
  double Tolerance = 0;              ///< how far from its plane a slice may lie
  double Deviation = 0;              ///< how far the slices on planes do lie from them, at most
  std::vector<std::int64_t> Missing; ///< planes without a slice, between slices that lie on planes
  /// Gap i is that between slices i and i + 1. These are no multiples of Usual.
  std::vector<std::size_t> UnequalGaps;

  double GetPosition(std::int64_t plane) const
  {
    return this->First + static_cast<double>(plane) * this->Spacing;
  }
};

/// positions: of at least two slices, ascending, no two within tolerance (mm). The usual distance is
/// the smallest distance from slice to slice that is frequent (a tenth of all, at least three), else
/// the median. Planes are at that distance where all slices lie on them within tolerance (at most a
/// quarter of the spacing). Else they are at the largest of its parts (a half to a fifth) of which
/// that is true. In both cases First and Spacing are the best fit. Where there is none, the first
/// and the last plane are the first and the last slice, at nearly the usual distance. Throws
/// std::runtime_error when there were more than a million planes.
SliceSpacing FindSliceSpacing(const std::vector<double>& positions, double tolerance);
}
#endif
