// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A hexagonal lattice within closed curves.
#ifndef lacunaPlanarLattice_h
#define lacunaPlanarLattice_h

#include "lacunaPlanarCurves.h"

namespace lacuna
{
class Execution;

/// The nodes of a lattice of equilateral triangles, with edges of spacing along x, that an odd number
/// of the loops encloses and that are at least clearance away from them; row by row. The lattice
/// stands still: a node is at (0, 0).
Loop FillWithLattice(
  Execution& execution, const std::vector<Loop>& loops, double spacing, double clearance);
}
#endif
