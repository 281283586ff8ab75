// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a grid of samples must be for a spline surface.
#ifndef lacunaGridChecks_h
#define lacunaGridChecks_h

#include "lacunaSurfaceFit.h"
#include "lacunaVector.h"

#include <cstddef>
#include <string>
#include <vector>

namespace lacuna
{
/// Throws std::invalid_argument when there are fewer than 4 x 4 samples, or not columns x rows.
void CheckSize(GridSize size, std::size_t samples);

/// Throws std::invalid_argument that says what, and the column and row of a sample.
[[noreturn]] void ThrowAt(GridSize size, std::size_t index, const std::string& what);

/// Throws std::invalid_argument, naming the place, when neighbouring points coincide or the facets
/// at a point turn by more than 120 degrees: no surface a tool could follow goes through them.
void CheckRegular(GridSize size, const std::vector<Vec3>& points);
}
#endif
