// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The grey levels of one slice.
#ifndef lacunaGreyImage_h
#define lacunaGreyImage_h

#include "lacunaScalarType.h"

#include <cstdint>
#include <vector>

namespace lacuna
{
/// A slice's grey levels; does not own them.
struct GreyImage
{
  ScalarType Type = ScalarType::UInt8;
  const void* Pixels = nullptr;
  std::int64_t RowStride = 0; ///< pixels from one row to the next
  int Width = 0;
  int Height = 0;
};

/// All levels, row by row without gaps; 0 for what is not finite, and at most 1e30
/// either way.
std::vector<float> GetLevels(const GreyImage& image);
}
#endif
