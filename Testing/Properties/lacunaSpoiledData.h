// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Breaks sound data as files, other filters and mistakes do.
#ifndef lacunaSpoiledData_h
#define lacunaSpoiledData_h

#include "lacunaDice.h"

#include <string>

class vtkDataObject;

namespace lacunaProperties
{
/// Changes one thing about data: takes an array away, renames it, gives it another type, other
/// components or another length, or all of a group another length, puts NaN, infinities or huge
/// numbers in, moves or distorts the grid, or takes everything away. Says what it did.
std::string Spoil(vtkDataObject* data, Dice& dice);

/// Whether all numbers of data are finite.
bool IsFinite(vtkDataObject* data);
}
#endif
