// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// From voxels to the control points of the cubic B-spline that goes through them.
#ifndef lacunaSplineFilter_h
#define lacunaSplineFilter_h

#include "lacunaExecution.h"
#include "lacunaVoxelVolume.h"

#include <cstdint>
#include <vector>

namespace lacuna
{
struct SplineCoefficients
{
  std::vector<float> Values; ///< one per voxel, x fastest
  double Minimum;            ///< over the finite voxels; Minimum > Maximum when there is none
  double Maximum;
  std::int64_t NumberOfNonFinite;
};

/// Solves c[i-1] + 4 c[i] + c[i+1] = 6 f[i] along each axis. The control points beyond the ends
/// continue linearly (c[-1] = 2 c[0] - c[1]), hence c = f at the ends: the natural spline. Voxels
/// that are not finite take the least finite value if emptyIsLow, otherwise the greatest. Rounding
/// to float moves a surface by some 1e-7 of the grey-level range over its slope.
SplineCoefficients FilterToCoefficients(
  const VoxelVolume& volume, bool emptyIsLow, Execution& execution);
}
#endif
