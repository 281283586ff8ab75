// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Refuses data that are not sound in themselves, whatever a filter wants of them: VTK does not look
/// whether arrays are as long as there are points, and filters would read beyond their ends.
#ifndef lacunaInputCheck_h
#define lacunaInputCheck_h

#include "vtkLacunaFiltersCommonModule.h" // for export macro

#include <array>
#include <cstdint>
#include <string>

class vtkDataObject;
class vtkInformation;

namespace lacuna::InputCheck
{
/// Throws std::runtime_error that begins with name when a point or cell array has another number of
/// tuples than there are points or cells, columns of a table differ in length, origin, spacing or
/// direction of an image are not finite, or an index of its extent is beyond 2^30. Blocks of composite data are looked at one by one; data
/// without points, cells and rows are sound.
VTKLACUNAFILTERSCOMMON_EXPORT void Check(vtkDataObject* data, const std::string& name);

/// Throws when data is an image of which less arrived than info asks for, as behind filters that give each rank a part.
VTKLACUNAFILTERSCOMMON_EXPORT void CheckPart(
  vtkDataObject* data, vtkInformation* info, const std::string& name);

/// Three numbers of its size, and a hash of where it is: data with the same are taken for the same.
using Fingerprint = std::array<std::uint64_t, 4>;
VTKLACUNAFILTERSCOMMON_EXPORT Fingerprint GetFingerprint(vtkDataObject* data);

/// The array that Extract Selection adds to its output; null: it is none.
VTKLACUNAFILTERSCOMMON_EXPORT const char* GetExtractedName(vtkDataObject* data);
}
#endif
