// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The voxels of a CT volume, made of the pixels of its images.
#ifndef lacunaCTVolume_h
#define lacunaCTVolume_h

#include "lacunaCTGeometry.h"
#include "lacunaExecution.h"
#include "lacunaScalarType.h"

#include <array>
#include <functional>
#include <vector>

namespace lacuna
{
/// The decoded pixels of one frame, row by row, and how they are stored. Its memory serves for one
/// frame after the other.
struct CTPixels
{
  const unsigned char* Data = nullptr; ///< the pixels, in Bytes or in Room
  CTPixelFormat Format;
  std::vector<unsigned char> Bytes;
  std::vector<unsigned char> Stream; ///< from which they were decoded
  /// Where pixels that need no decoding may go instead of Bytes, which saves a copy; null: nowhere.
  unsigned char* Room = nullptr;
};

/// Reads the pixels of a frame; is called by several threads at a time, each with pixels of its own.
/// Throws std::runtime_error naming the file.
using CTPixelReader = std::function<void(const CTFrame&, CTPixels& pixels)>;

/// Fills scalars with the Hounsfield units of the voxels of extent (first and last column, row,
/// plane). type: of GetHounsfieldType for these frames. Only the images that the extent needs are
/// read. Pixels are moved within a tilted image by cubic convolution (Keys 1981), planes between
/// slices are interpolated linearly; results of either are rounded once. What lies outside of a
/// tilted image is air.
void ReadCTVolume(const CTGeometry& geometry, const std::array<int, 6>& extent, ScalarType type,
  double air, const CTPixelReader& read, void* scalars, Execution& execution);
}
#endif
