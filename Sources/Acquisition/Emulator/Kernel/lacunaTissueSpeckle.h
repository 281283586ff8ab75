// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The grain of ultrasound images.
#ifndef lacunaTissueSpeckle_h
#define lacunaTissueSpeckle_h

#include "lacunaVector.h"

#include <cstdint>
#include <vector>

namespace lacuna
{
/// Speckle that belongs to the tissue: the same place has the same grain in every picture of it, so
/// a probe at rest has pictures at rest. It is the magnitude of complex Gaussian noise that is
/// correlated over a resolution cell of some 0.7 mm (fully developed speckle: Rayleigh distributed),
/// on a grid that repeats after 38.4 mm along each axis, and linear between its points.
class TissueSpeckle
{
public:
  explicit TissueSpeckle(std::uint64_t seed);

  /// Multiplies levels by 1 + strength g, never below 0, at start + i step (mm) for
  /// 0 <= i < count; g has mean 0 and standard deviation 1 over the whole tissue.
  void Apply(const Vec3& start, const Vec3& step, int count, double strength, double* levels) const;
  /// g at a point.
  double At(const Vec3& point) const;

private:
  float Find(std::uint32_t x, std::uint32_t y, std::uint32_t z) const;

  std::vector<std::int8_t> Grain;
  double Mean = 0; ///< of Grain between its points
  double Unit = 1; ///< of g in Grain
};
}
#endif
