// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What algorithms and writers ask VTK's pipeline for.
#ifndef lacunaRequest_h
#define lacunaRequest_h

#include "vtkLacunaFiltersCommonModule.h" // for export macro

#include <array>
#include <string>

class vtkInformation;

namespace lacuna
{
VTKLACUNAFILTERSCOMMON_EXPORT bool IsEmpty(const int* extent);

/// Whether it is of an image or another grid.
VTKLACUNAFILTERSCOMMON_EXPORT bool IsGrid(vtkInformation* info);

/// The whole extent of a grid; null of other data, which may have the extent of what they were made of.
VTKLACUNAFILTERSCOMMON_EXPORT const int* GetWhole(vtkInformation* info);

/// Asks for an extent of an image, or for all of an input. What does not fit into the memory is not asked for, but one
/// point of it; returns why, else an empty text.
VTKLACUNAFILTERSCOMMON_EXPORT std::string AskForExtent(
  vtkInformation* input, const std::array<int, 6>& extent);
VTKLACUNAFILTERSCOMMON_EXPORT std::string AskForAll(vtkInformation* input);
}
#endif
