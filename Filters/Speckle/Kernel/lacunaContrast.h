// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How well a region stands out against speckle (Carr 1996, section 4.5.7).
#ifndef lacunaContrast_h
#define lacunaContrast_h

#include "lacunaExecution.h"
#include "lacunaImageView.h"
#include "lacunaMatrix4.h"
#include "lacunaScalarType.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lacuna
{
/// Which region a sample belongs to.
enum Region : std::uint8_t
{
  InsideRegion = 0,
  OutsideRegion = 1,
  NoRegion = 2
};

/// Values at the samples of an image, x fastest.
struct RegionMask
{
  ScalarType Type;
  const void* Values;
};

/// A region holds the samples at which all of its masks are numbers other than 0, and which lie in
/// Bounds unless that is empty.
struct RegionRule
{
  std::vector<RegionMask> Masks;
  /// xmin xmax ymin ymax zmin zmax in mm, borders included (give or take 1e-6 of the distance
  /// between samples); a minimum above its maximum means no bounds.
  std::array<double, 6> Bounds{ 1, -1, 1, -1, 1, -1 };

  bool HasBounds() const;
};

/// Sets to region those of the samples of box that rule holds and that are in NoRegion so far.
/// regions: one for each sample of box, x fastest. indexToWorld: from coordinates in box to mm.
void MarkRegion(const Extent& box, const Matrix4& indexToWorld, const RegionRule& rule,
  Region region, std::uint8_t* regions, Execution& execution);

struct RegionStatistics
{
  std::int64_t Count = 0;
  double Mean = 0;
  double Variance = 0; ///< of the population: divided by Count

  /// Mean / standard deviation; infinite for a constant region (NaN where it is 0). 1.91 for the envelope of fully
  /// developed speckle (Burckhardt 1978).
  double SignalToNoise() const;
};

/// Statistics of the samples inside and outside; NaN is passed over. regions has a Region for each
/// sample of the view, x fastest.
template <class T>
std::array<RegionStatistics, 2> MeasureRegions(
  const ImageView<const T>& view, const std::uint8_t* regions, Execution& execution);

/// |inside mean - outside mean| / sqrt(inside variance + outside variance): the contrast to speckle
/// ratio, equation 4.2. Infinite when both regions are constant and differ, 0 when they do not.
double ContrastToSpeckle(const RegionStatistics& inside, const RegionStatistics& outside);

/// The number of separate regions of samples at or above isoValue, neighbours being those that
/// share a face (4 in an image of one slice, 6 in a volume). 64-bit integers are compared exactly.
/// Throws std::invalid_argument when isoValue is NaN.
template <class T>
std::int64_t CountThresholdedRegions(
  const ImageView<const T>& view, double isoValue, Execution& execution);
}
#endif
