// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Solves the equations of large radial basis functions in O(n) memory.
#ifndef lacunaRadialSolver_h
#define lacunaRadialSolver_h

#include "lacunaRadialSystem.h"

namespace lacuna
{
class Execution;

/// Solves by flexible GMRES on the complement of the polynomials with fast sums and a
/// SchwarzPreconditioner, until no value is missed by more than tolerance (> 0, in the unit of the
/// values). The residual of the solution is computed anew, from sums whose error bound is a tenth
/// of the tolerance and counted in. Throws std::runtime_error when the tolerance is not reached.
template <int Dimension>
RadialSolution SolveIteratively(
  Execution& execution, const RadialSystem<Dimension>& system, double tolerance);
}
#endif
