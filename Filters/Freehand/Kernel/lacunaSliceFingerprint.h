// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Tells whether slices that come again are the same, without keeping their pixels.
#ifndef lacunaSliceFingerprint_h
#define lacunaSliceFingerprint_h

#include "lacunaExecution.h"
#include "lacunaPixelHash.h"
#include "lacunaSliceImage.h"

#include <array>
#include <vector>

namespace lacuna
{
/// All that matters of a slice, the grey levels as a hash: equal slices have equal fingerprints,
/// and different ones as good as never (lacunaPixelHash.h).
struct SliceFingerprint
{
  ScalarType Type;
  std::array<int, 2> Size;
  std::array<double, 16> Pose;
  /// Origin, angles, radii, pixel spacing; all 0 without one.
  std::array<double, 8> Fan;
  PixelHash Pixels;

  bool operator==(const SliceFingerprint& other) const;
  bool operator!=(const SliceFingerprint& other) const { return !(*this == other); }
};

/// Of each slice. Reads all pixels, at about the speed of memory.
std::vector<SliceFingerprint> GetFingerprints(
  const std::vector<SliceImage>& slices, Execution& execution);

/// True when the later slices begin with the earlier ones.
bool IsContinued(
  const std::vector<SliceFingerprint>& earlier, const std::vector<SliceFingerprint>& later);
}
#endif
