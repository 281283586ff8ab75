// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What is measured on a finished plate.
#ifndef lacunaPlateMeasures_h
#define lacunaPlateMeasures_h

#include "lacunaImplantPlate.h"

namespace lacuna
{
/// One face of a plate: points of the surface, the plate's points above them, triangles of both.
struct PlateSheet
{
  std::vector<Vec2> Feet; ///< the first BorderSize are on edges
  std::vector<std::int32_t> Points;
  std::vector<Triangle> Triangles;
  std::size_t BorderSize = 0;
};

/// Square of the distance from p to the triangle a, b, c.
double SquaredDistanceToTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

/// Sets Volume, OuterArea and MinimumThickness. The nearest point of the other face is looked for
/// among the triangles near the common foot, where it is as long as the plate does not cut itself.
void MeasurePlate(
  Execution& execution, const PlateSheet& outer, const PlateSheet& inner, ImplantPlate& plate);
}
#endif
