// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A slice as it comes: grey levels lying in space.
#ifndef lacunaSliceImage_h
#define lacunaSliceImage_h

#include "lacunaFan.h"
#include "lacunaMatrix4.h"
#include "lacunaScalarType.h"

#include <array>
#include <cstdint>
#include <memory>
#include <string>

namespace lacuna
{
/// A rectangular window of a slice; does not own the pixels. What lies outside of the window (a
/// ruler, the machine's texts) does not exist for the reconstruction.
struct SliceImage
{
  ScalarType Type = ScalarType::UInt8;
  const void* Pixels = nullptr; ///< the window's pixel (0, 0)
  std::int64_t RowStride = 0;   ///< pixels from one row to the next
  int Width = 0;                ///< pixels, at least 2
  int Height = 0;
  /// (column, row, 0, 1) in the window to mm; the third column is not used. Pixel centres lie at
  /// whole numbers.
  Matrix4 PixelToReference;
  /// When set, only what lies in the fan exists; made for the window's size and pixel spacing.
  std::shared_ptr<const FanMask> Fan;
  bool BeginsSweep = false; ///< there is nothing between it and the slice before it
  std::string Label;        ///< what errors call it, for example "slice 17"
};

/// Throws std::invalid_argument, saying which slice, what is wrong and what to do, unless the
/// window is at least 2 x 2 pixels, its pose is finite, affine and spans a plane, and its fan, if
/// it has one, was made for a window of its size.
void CheckSlice(const SliceImage& slice);

/// Cuts the window to columns and rows of it. The pose and the fan are still those of the old one.
void CutSlice(SliceImage& slice, int column, int row, int width, int height);

/// Centres of the four corner pixels, mm.
std::array<Vec3, 4> GetCorners(const SliceImage& slice);
}
#endif
