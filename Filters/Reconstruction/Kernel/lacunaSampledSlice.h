// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A slice made ready for sampling at voxels.
#ifndef lacunaSampledSlice_h
#define lacunaSampledSlice_h

#include "lacunaAffineFunction.h"
#include "lacunaFan.h"
#include "lacunaSliceImage.h"
#include "lacunaVolumeGrid.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace lacuna
{
// Means of a slice's grey levels over the footprints of voxels.
//
// A slice is usually much finer than the volume: sampled at single pixels it would alias. Instead
// it is reduced once to a raster of local means, from which voxels interpolate bilinearly. Along
// each axis the raster's step s is about half the footprint's width w, and each mean is the exact
// integral of the (linearly interpolated) grey levels over a box of width sqrt(w^2 - 2 s^2). Box
// and interpolation between the means together weigh the pixels with the footprint's centre and
// second moment w^2 / 12. Towards the border the box narrows symmetrically, so that linear grey
// levels are reproduced exactly everywhere. A footprint narrower than sqrt(2) pixels leaves the
// axis as it is.
//
// A voxel whose centre lies outside of the image still covers a part of it, as long as it lies
// less than half its width from the pixels' area. For such voxels the raster goes on by some
// samples along its slope: linear grey levels are exact there too. The slope is that one of the
// last two differences which is smaller, and none where they have opposite signs, so that edges
// and speckle next to the border are not carried on.

/// Reduces one axis of n pixels.
class FootprintAxis
{
public:
  /// width of the footprint in pixels; n >= 2.
  FootprintAxis(int n, double width);

  int GetNumberOfSamples() const { return static_cast<int>(this->Starts.size()); }
  /// Pixels from one sample to the next; sample 0 lies at pixel 0, the last one at pixel n - 1.
  double GetStep() const { return this->Step; }
  /// Pixels that the foot of a voxel may lie outside of the first and the last pixel: half of the
  /// voxel's width (pixels) and half a pixel, but at most eight steps.
  double GetMargin(double voxelWidth) const;
  /// By which the raster must go on for this, on each side.
  int GetNumberOfSamplesOutside(double voxelWidth) const;
  /// Sample i is the sum of GetNumberOfTaps() pixels from GetStart(i), weighted by GetWeights(i).
  int GetNumberOfTaps() const { return this->Taps; }
  int GetStart(int i) const { return this->Starts[i]; }
  const double* GetWeights(int i) const
  {
    return this->Weights.data() + static_cast<std::size_t>(this->Taps) * i;
  }

private:
  double Step = 1;
  int Taps = 1;
  std::vector<int> Starts;
  std::vector<double> Weights;
};

/// Fills means: rows.GetNumberOfSamples() lines of columns.GetNumberOfSamples() values, one line
/// meanStride values after the other. T is any pixel type, Real is double, or float for pixels that
/// a float holds exactly.
template <class T, class Real>
void AverageFootprints(const T* pixels, std::int64_t rowStride, const FootprintAxis& columns,
  const FootprintAxis& rows, Real* means, std::int64_t meanStride);

/// The same for the pixels in a fan alone: sums gets their weighted sums and weights the sums of
/// their weights, which are 1 where a footprint lies in the fan, and 0 where none of it does. The
/// mean between samples is the quotient of the two, interpolated each for itself.
template <class T, class Real>
void AverageFootprintsInFan(const T* pixels, std::int64_t rowStride, const FootprintAxis& columns,
  const FootprintAxis& rows, const FanMask& fan, Real* sums, Real* weights,
  std::int64_t meanStride);

/// Fills the outermost columns and rows, on each side, of a raster of width x height values from
/// those inside of them, at least 2 x 2. weights is null, or laid out like the raster; it goes on
/// without a slope, and the raster then holds sums.
template <class Real>
void ContinueRaster(
  Real* raster, Real* weights, int width, int height, int columnsOutside, int rowsOutside);

/// How the grey level at the foot of a perpendicular is found, and how far outside of the centres
/// of the outermost pixels a foot may lie: as far as what the voxel covers of the slice still
/// overlaps the area of the pixels.
enum class PixelSampling
{
  /// Mean over the voxel's footprint (Footprint). Feet count up to half a footprint and
  /// half a pixel outside; grey levels go on there along their slope.
  Footprint,
  /// Up to half a pixel outside, where the grey level of the border goes on.
  Bilinear,
  Nearest ///< that of the pixel in whose area the foot lies
};
inline constexpr std::array<const char*, 3> PixelSamplingNames{ "Footprint", "Bilinear",
  "Nearest" };

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
