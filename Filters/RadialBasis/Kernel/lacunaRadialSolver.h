// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Solves the equations of large radial basis functions in O(n) memory.
#ifndef lacunaRadialSolver_h
#define lacunaRadialSolver_h

#include "lacunaRadialSystem.h"

#include <memory>

namespace lacuna
{
/// By flexible GMRES on the complement of the polynomials with fast sums and a
/// SchwarzPreconditioner. The residual of a solution is computed anew, from sums whose error bound is
/// a tenth of the tolerance and counted in.
template <int Dimension>
std::unique_ptr<RadialEquations<Dimension>> PrepareIteratively(
  Execution& execution, const RadialSystem<Dimension>& system);
}
#endif
