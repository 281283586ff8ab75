// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The edge profile of all phantoms.
#ifndef lacunaSmoothStep_h
#define lacunaSmoothStep_h

namespace lacuna
{
/// Rises from exactly 0 at -width/2 to exactly 1 at +width/2 as the quintic 6 s^5 - 15 s^4 + 10 s^3
/// does on 0..1: twice continuously differentiable, 1/2 at 0, antisymmetric about it. The 10 % and
/// 90 % points are 0.506 width apart, the steepest slope is 1.875 / width. It is the convolution of
/// a step with a bell (the Beta(3,3) density) of variance width^2 / 28.
inline double SmoothStep(double distance, double width)
{
  const double s = distance / width + 0.5;
  if (!(s > 0))
  {
    return 0;
  }
  if (s >= 1)
  {
    return 1;
  }
  return s * s * s * (s * (s * 6 - 15) + 10);
}
}
#endif
