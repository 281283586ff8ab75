// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A slice made ready for sampling at voxels.
#ifndef lacunaSampledSlice_h
#define lacunaSampledSlice_h

#include "lacunaAffineFunction.h"
#include "lacunaSliceImage.h"
#include "lacunaVolumeGrid.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace lacuna
{
/// How the grey level at the foot of a perpendicular is found, and how far outside of the centres
/// of the outermost pixels a foot may lie: as far as what the voxel covers of the slice still
/// overlaps the area of the pixels.
enum class PixelSampling
{
  /// Mean over the voxel's footprint (lacunaFootprint.h). Feet count up to half a footprint and
  /// half a pixel outside; grey levels go on there along their slope.
  Footprint,
  /// Up to half a pixel outside, where the grey level of the border goes on.
  Bilinear,
  Nearest ///< that of the pixel in whose area the foot lies
};

/// Where a slice lies seen from the voxels, and its grey levels: the slice's own pixels, or a
/// raster of means over footprints.
struct SampledSlice
{
  std::string Label;
  /// Corners of the area in which feet count, mm.
  std::array<Vec3, 4> Corners;
  /// Columns x rows of the image, unit: turns with the probe.
  Vec3 Normal;
  /// Of a voxel: the foot of its perpendicular on the slice in raster coordinates, and its signed
  /// distance from the slice along Normal in mm.
  AffineFunction Column, Row, Distance;
  /// The footprint's extent along Normal, mm.
  double FootprintHeight;

  /// The raster: UInt8, Int16, UInt16, Float32 or Float64.
  ScalarType Type = ScalarType::UInt8;
  const void* Pixels = nullptr;
  std::int64_t RowStride = 0;
  int Width = 0;
  int Height = 0;
  /// The area in which feet count, first and last, in raster coordinates.
  Vec2 Columns, Rows;
  /// With a fan: how much of each sample's weight lies in it. Pixels holds sums then, not means;
  /// see AverageFootprintsInFan. Laid out like Pixels; null without a fan.
  const void* Weights = nullptr;
  std::shared_ptr<const FanMask> Fan;
  /// Of a voxel: its foot in mm from the fan's origin along columns and along rows.
  AffineFunction FanX{}, FanY{};
  std::unique_ptr<std::byte[]> Storage; ///< holds Pixels when they are the slice's own copy
};

/// Makes slice ready. footprintScale: width and height of footprints, in voxels. All slices with a
/// fan get a raster of their own. Without doublePrecision the raster's values are such as a float
/// holds. The result refers to the slice's pixels when it can. Throws std::invalid_argument when
/// the slice is unusable, see CheckSlice.
SampledSlice SampleSlice(const SliceImage& slice, const VolumeGrid& grid, PixelSampling sampling,
  double footprintScale, bool doublePrecision);

/// Copies the pixels that slice refers to, so that the caller's may go.
void OwnPixels(SampledSlice& slice);

/// True when grey levels of this type need double precision.
bool NeedsDoublePrecision(ScalarType type);
}
#endif
