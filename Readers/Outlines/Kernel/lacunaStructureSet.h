// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Outlines in a DICOM RT structure set (PS3.3, C.8.8.5 and C.8.8.6).
#ifndef lacunaStructureSet_h
#define lacunaStructureSet_h

#include "lacunaOutlineSet.h"

#include <string>

namespace lacuna
{
/// Whether a DICOM file says that it is one (SOP class). Throws as ReadDicomFile does.
bool IsStructureSet(const std::string& path);

/// The contours of type CLOSED_PLANAR, in patient coordinates (LPS, mm), counted from 1 over the file.
/// Warnings name contours of other types and structures without closed contours. Nothing of the
/// patient is kept. Throws std::runtime_error naming path, structure and contour.
OutlineSet ReadStructureSet(const std::string& path);
}
#endif
