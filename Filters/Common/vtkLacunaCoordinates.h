// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The mark that says in which coordinates data are, as far as it is known. Whoever knows it sets it
/// (sources of patients' data, makers of moulds); every filter that records provenance passes it on
/// from its first input. Data without it may be anything.
#ifndef vtkLacunaCoordinates_h
#define vtkLacunaCoordinates_h

#include "vtkLacunaFiltersCommonModule.h" // for export macro

class vtkDataObject;

namespace vtkLacunaCoordinates
{
/// Field data: one string, one of the names below.
constexpr const char* ArrayName = "Coordinates";
constexpr const char* Patient = "Patient"; ///< DICOM LPS, mm
constexpr const char* Press = "Press";     ///< of a press or mill; z towards the mill, mm

VTKLACUNAFILTERSCOMMON_EXPORT void Mark(vtkDataObject* data, const char* coordinates);
/// Takes the mark away, for results that need not be where their input is.
VTKLACUNAFILTERSCOMMON_EXPORT void Clear(vtkDataObject* data);
/// Gives output the mark of input unless it has its own.
VTKLACUNAFILTERSCOMMON_EXPORT void Pass(vtkDataObject* input, vtkDataObject* output);
}
#endif
