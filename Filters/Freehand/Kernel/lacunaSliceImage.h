// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A slice as it comes: grey levels lying in space.
#ifndef lacunaSliceImage_h
#define lacunaSliceImage_h

#include "lacunaMatrix4.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace lacuna
{
/// Types of grey levels.
enum class PixelType
{
  Int8,
  UInt8,
  Int16,
  UInt16,
  Int32,
  UInt32,
  Int64,
  UInt64,
  Float32,
  Float64
};

/// Bytes of one pixel.
std::size_t GetPixelSize(PixelType type);

/// A rectangular window of a slice; does not own the pixels. What lies outside of the window (a
/// ruler, the machine's texts) does not exist for the reconstruction.
struct SliceImage
{
  PixelType Type = PixelType::UInt8;
  const void* Pixels = nullptr; ///< the window's pixel (0, 0)
  std::int64_t RowStride = 0;   ///< pixels from one row to the next
  int Width = 0;                ///< pixels, at least 2
  int Height = 0;
  /// (column, row, 0, 1) in the window to mm; the third column is not used. Pixel centres lie at
  /// whole numbers.
  Matrix4 PixelToReference;
  std::string Label; ///< what errors call it, for example "slice 17"
};

/// Throws std::invalid_argument, saying which slice, what is wrong and what to do, unless the
/// window is at least 2 x 2 pixels and its pose is finite, affine and spans a plane.
void CheckSlice(const SliceImage& slice);

/// Centres of the four corner pixels, mm.
std::array<Vec3, 4> GetCorners(const SliceImage& slice);

/// Calls f(const T* pixels) with the type of the slice's pixels.
template <class F>
void VisitPixels(const SliceImage& slice, F&& f)
{
  switch (slice.Type)
  {
    case PixelType::Int8:
      return f(static_cast<const std::int8_t*>(slice.Pixels));
    case PixelType::UInt8:
      return f(static_cast<const std::uint8_t*>(slice.Pixels));
    case PixelType::Int16:
      return f(static_cast<const std::int16_t*>(slice.Pixels));
    case PixelType::UInt16:
      return f(static_cast<const std::uint16_t*>(slice.Pixels));
    case PixelType::Int32:
      return f(static_cast<const std::int32_t*>(slice.Pixels));
    case PixelType::UInt32:
      return f(static_cast<const std::uint32_t*>(slice.Pixels));
    case PixelType::Int64:
      return f(static_cast<const std::int64_t*>(slice.Pixels));
    case PixelType::UInt64:
      return f(static_cast<const std::uint64_t*>(slice.Pixels));
    case PixelType::Float32:
      return f(static_cast<const float*>(slice.Pixels));
    case PixelType::Float64:
      return f(static_cast<const double*>(slice.Pixels));
  }
  throw std::invalid_argument(slice.Label + ": unknown pixel type");
}
}
#endif
