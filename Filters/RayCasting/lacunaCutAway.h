// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Implicit functions as regions that kernels cut away.
#ifndef lacunaCutAway_h
#define lacunaCutAway_h

#include "lacunaCutRegion.h"

#include <memory>
#include <vector>

class vtkImplicitFunction;

namespace lacuna::CutAway
{
/// The region where function is negative: inside a box, sphere, cylinder or planes, behind a plane.
/// These are cut exactly, with their transform; any other function is sampled each step mm. points:
/// where the two are compared, since subclasses may mean something else. Throws for values that
/// are no numbers. function must outlive the result.
std::unique_ptr<CutRegion> MakeRegion(
  vtkImplicitFunction* function, double step, const std::vector<Vec3>& points);
}
#endif
