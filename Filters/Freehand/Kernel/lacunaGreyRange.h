// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The grey levels that slices have.
#ifndef lacunaGreyRange_h
#define lacunaGreyRange_h

#include "lacunaSliceImage.h"

#include <cstddef>
#include <limits>
#include <vector>

namespace lacuna
{
/// Smallest and largest finite grey level in the windows of slices, which may become more: each
/// slice is looked at once.
class GreyRange
{
public:
  /// slices: those of the last time, whose pixels are not looked at, and some more.
  void Update(const std::vector<SliceImage>& slices);

  /// False as long as no pixel is finite.
  bool HasLevels() const { return this->Low <= this->High; }
  bool Contains(double level) const { return level >= this->Low && level <= this->High; }
  double GetLow() const { return this->Low; }
  double GetHigh() const { return this->High; }

private:
  std::size_t Seen = 0; ///< slices
  double Low = std::numeric_limits<double>::infinity();
  double High = -std::numeric_limits<double>::infinity();
};
}
#endif
