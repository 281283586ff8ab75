// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The mark that says in which coordinates data are, as far as it is known. Whoever knows it sets it
/// (sources of patients' data, makers of moulds); every filter that records provenance passes it on
/// from its first input. Data without it may be anything.
#ifndef lacunaCoordinates_h
#define lacunaCoordinates_h

#include "vtkLacunaFiltersCommonModule.h" // for export macro

#include <string>

class vtkDataObject;

namespace lacuna::Coordinates
{
/// Field data: one string, one of the names below.
constexpr const char* ArrayName = "Coordinates";
constexpr const char* Patient = "Patient"; ///< DICOM LPS, mm
constexpr const char* Press = "Press";     ///< of a press or mill; z towards the mill, mm
/// Field data of what is in press coordinates: one string, the mark of what was laid into the press,
/// so where PressToPatient leads. Missing when that had none.
constexpr const char* BeforePressName = "CoordinatesBeforePress";

VTKLACUNAFILTERSCOMMON_EXPORT void Mark(vtkDataObject* data, const char* coordinates);
/// Marks output as Press, made of input.
VTKLACUNAFILTERSCOMMON_EXPORT void MarkPress(vtkDataObject* input, vtkDataObject* output);
/// The mark, or that before the press; empty without one.
VTKLACUNAFILTERSCOMMON_EXPORT std::string Get(vtkDataObject* data);
VTKLACUNAFILTERSCOMMON_EXPORT std::string GetBeforePress(vtkDataObject* data);
/// Takes the mark away, for results that need not be where their input is.
VTKLACUNAFILTERSCOMMON_EXPORT void Clear(vtkDataObject* data);
/// Gives output the mark of input unless it has its own.
VTKLACUNAFILTERSCOMMON_EXPORT void Pass(vtkDataObject* input, vtkDataObject* output);
}
#endif
