// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Evenly spread directions for occluded angles.
#ifndef lacunaDirections_h
#define lacunaDirections_h

#include "lacunaVector.h"

#include <vector>

namespace lacuna
{
/// Unit vectors along count lines in the xy plane at equal angles, (i + 1/2) pi / count from the
/// x axis. With their opposites they are 2 count directions at equal angles.
std::vector<Vec3> EqualAngleLines(int count);

/// Unit vectors along count lines in space, each standing for the same solid angle: a Fibonacci
/// spiral of low discrepancy on the upper half sphere. With their opposites they are 2 count
/// directions. Deterministic. (Carr 1996, section 5.8 uses random directions.)
std::vector<Vec3> EqualAreaLines(int count);
}
#endif
