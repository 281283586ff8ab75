// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What calibrations are done with.
#ifndef lacunaWaterBath_h
#define lacunaWaterBath_h

#include "lacunaPhantomScene.h"

namespace lacuna
{
/// A water bath: water (6), and from y = FloorDepth on its flat floor, an echo of 230 that fades
/// over some mm. The surface of the floor is at the iso-value.
class WaterBath : public PhantomScene
{
public:
  static constexpr double FloorDepth = 10; ///< mm

  void SampleRow(
    const Vec3& start, const Vec3& step, int first, int count, double* values) const override;
  double IsoValue() const override;
};
}
#endif
