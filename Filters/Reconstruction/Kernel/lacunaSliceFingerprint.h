// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Tells whether slices that come again are the same, without keeping their pixels.
#ifndef lacunaSliceFingerprint_h
#define lacunaSliceFingerprint_h

#include "lacunaExecution.h"
#include "lacunaSliceImage.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lacuna
{
/// 128 bits. Pixels that differ have different hashes, but for a chance of less than 1 in 10^18:
/// changes of up to 8 bytes always change it. Made for speed (several bytes per clock cycle) and
/// not against an adversary.
struct PixelHash
{
  std::uint64_t First = 0;
  std::uint64_t Second = 0;

  bool operator==(const PixelHash& other) const
  {
    return this->First == other.First && this->Second == other.Second;
  }
};

/// Of the pixels of a slice's window, and of nothing else.
PixelHash HashPixels(const SliceImage& slice);

/// All that matters of a slice, the grey levels as a hash: equal slices have equal fingerprints,
/// and different ones as good as never (PixelHash).
struct SliceFingerprint
{
  /// Reads the pixels only when withPixels; Pixels is not set otherwise.
  explicit SliceFingerprint(const SliceImage& slice, bool withPixels = true);
  SliceFingerprint() = default;

  ScalarType Type = ScalarType::UInt8;
  std::array<int, 2> Size{};
  std::array<double, 16> Pose{};
  bool BeginsSweep = false;
  bool HasFan = false;
  std::array<double, 8> Fan{}; ///< origin, angles, radii, pixel spacing
  PixelHash Pixels;

  /// Equal but for Pixels.
  bool HasGeometryOf(const SliceFingerprint& other) const;
  bool operator==(const SliceFingerprint& other) const
  {
    return this->HasGeometryOf(other) && this->Pixels == other.Pixels;
  }
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
