// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Images of a scene: slices of a sweep and regular grids.
#ifndef lacunaPhantomSweep_h
#define lacunaPhantomSweep_h

#include "lacunaExecution.h"
#include "lacunaMatrix4.h"
#include "lacunaPhantomScene.h"
#include "lacunaProperties.h"

#include <array>
#include <cstdint>
#include <functional>

namespace lacuna
{
/// Extent of a part of a stack: first and last column, row and slice, as in VTK.
using Extent = std::array<int, 6>;

/// Number of points of an extent; a double, so that it cannot overflow.
double CountPoints(const Extent& extent);

constexpr ValueRange SpeckleLevels = ValueRange::Between(0, 10);

/// How slices are imaged.
struct SliceImaging
{
  std::int64_t Columns = 0; ///< of the whole image
  std::int64_t Rows = 0;    ///< of the whole image
  /// Relative standard deviation of the speckle: a level v becomes v (1 + SpeckleLevel g), with g
  /// standard normal and independent for each pixel of each slice (fully developed speckle would be
  /// Rayleigh distributed, with a level of 0.52, and correlated over a resolution cell).
  double SpeckleLevel = 0;
  std::uint64_t Seed = 0;
  /// True pose of a slice: (column, row, 0, 1) to mm.
  std::function<Matrix4(std::int64_t slice)> ImageToReference;
};

/// Samples the scene at the pixel centres of the extent; pixels: its points, columns fastest. T is
/// unsigned char (rounded once, half up, limited to 0..255; NaN becomes 0) or float. A pixel
/// depends neither on the extent nor on the threads.
template <class T>
void SampleSlices(Execution& execution, const PhantomScene& scene, const SliceImaging& imaging,
  const Extent& extent, T* pixels);

/// Samples the scene at the points of a grid; values: dimensions[0] x dimensions[1] x
/// dimensions[2], x fastest. indexToReference: (i, j, k) from 0 to mm.
void SampleGrid(Execution& execution, const PhantomScene& scene,
  const std::array<int, 3>& dimensions, const Matrix4& indexToReference, float* values);

extern template void SampleSlices(
  Execution&, const PhantomScene&, const SliceImaging&, const Extent&, unsigned char*);
extern template void SampleSlices(
  Execution&, const PhantomScene&, const SliceImaging&, const Extent&, float*);
}
#endif
