// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which wire of a calibration phantom is seen in which slices of a sweep.
#ifndef lacunaWireRanges_h
#define lacunaWireRanges_h

#include "lacunaProbeCalibration.h"

#include <cstdint>
#include <string>
#include <vector>

namespace lacuna
{
struct WireRange
{
  CalibrationTarget Wire;
  std::int64_t First, Last; ///< slices, both belong to it
};

/// Of a text such as "X 0-49, Y 50-99, Z 100-149": a wire's name and its first and last slice; a
/// single slice is "X 7". Commas, semicolons and blanks part them; a wire may have several. Throws
/// std::invalid_argument, naming the place, for what is no such text, a slice that is not below count, a range
/// that ends before it begins, and a slice that is in two ranges.
std::vector<WireRange> ReadWireRanges(const std::string& text, std::int64_t count);

/// The wire of a slice; null when it is in no range.
const CalibrationTarget* FindWire(const std::vector<WireRange>& ranges, std::int64_t slice);
}
#endif
