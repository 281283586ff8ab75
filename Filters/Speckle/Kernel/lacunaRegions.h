// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which samples of an image belong to the regions that are compared.
#ifndef lacunaRegions_h
#define lacunaRegions_h

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
}
#endif
