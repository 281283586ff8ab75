// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A short number that tells whether pixels are the same as before.
#ifndef lacunaPixelHash_h
#define lacunaPixelHash_h

#include "lacunaSliceImage.h"

#include <cstdint>

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
}
#endif
