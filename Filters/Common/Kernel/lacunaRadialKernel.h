// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The radial functions.
#ifndef lacunaRadialKernel_h
#define lacunaRadialKernel_h

#include <array>

namespace lacuna
{
/// Values of the property Kernel of RBF Hole Filler and RBF Interpolator. r is the distance from a node, of those
/// with a length in units of KernelLength.
enum class RadialKernel
{
  ThinPlate = 0,    ///< r^2 log r: bends least in a plane
  Linear = 1,       ///< r: bends least in space; in a plane tents, which may crease at nodes
  Triharmonic = 2,  ///< r^4 log r with a quadratic: smoothest, swings most
  Cubic = 3,        ///< r^3, the triharmonic of space: carries the curvature of a rim into a hole
  Gaussian = 4,     ///< exp(-r^2): falls back to a plane away from nodes
  Multiquadric = 5, ///< sqrt(1 + r^2)
  Wendland = 6      ///< (1 - r)^4 (4 r + 1) up to r = 1, 0 beyond: only near nodes count
};
inline constexpr std::array<const char*, 7> RadialKernelNames{ "ThinPlate", "Linear", "Triharmonic",
  "Cubic", "Gaussian", "Multiquadric", "Wendland" };
}
#endif
