// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The marks that say whose coordinates data are in, as far as it is known. Whoever knows it sets them
/// (sources of patients' data, makers of moulds, vtkLacunaMirror); every filter that records provenance
/// passes them on from its first input. Data without them may be anything.
#ifndef lacunaCoordinates_h
#define lacunaCoordinates_h

#include "lacunaVector.h"
#include "vtkLacunaFiltersCommonModule.h" // for export macro

#include <string>

class vtkDataObject;

namespace lacuna::Coordinates
{
/// Field data: one string, one of the names below.
constexpr const char* ArrayName = "Coordinates";
constexpr const char* Patient = "Patient"; ///< DICOM LPS, mm
constexpr const char* Press = "Press";     ///< of a press or mill; z towards the mill, mm
/// Field data of what is in press coordinates: a rigid transform, 16 numbers row by row, to the
/// coordinates of what was laid into the press.
constexpr const char* PressToPatientName = "PressToPatient";
/// Likewise: one string, the mark of what was laid into the press, so where PressToPatient leads.
/// Missing when that had none.
constexpr const char* BeforePressName = "CoordinatesBeforePress";

VTKLACUNAFILTERSCOMMON_EXPORT void Mark(vtkDataObject* data, const char* coordinates);
/// Marks output as Press, made of input.
VTKLACUNAFILTERSCOMMON_EXPORT void MarkPress(vtkDataObject* input, vtkDataObject* output);
/// The mark, or that before the press; empty without one.
VTKLACUNAFILTERSCOMMON_EXPORT std::string Get(vtkDataObject* data);
VTKLACUNAFILTERSCOMMON_EXPORT std::string GetBeforePress(vtkDataObject* data);
/// Takes the mark away, for results that need not be where their input is.
VTKLACUNAFILTERSCOMMON_EXPORT void Clear(vtkDataObject* data);

/// Field data of a patient's mirror image: 1; a point of the plane (world mm) and its unit normal.
constexpr const char* MirroredName = "Mirrored";
constexpr const char* MirrorOriginName = "MirrorPlaneOrigin";
constexpr const char* MirrorNormalName = "MirrorPlaneNormal";

/// vtkLacunaMirror alone does it.
VTKLACUNAFILTERSCOMMON_EXPORT void MarkMirrored(
  vtkDataObject* data, const Vec3& origin, const Vec3& normal);
/// Whoever makes something of data for the patient asks for it.
VTKLACUNAFILTERSCOMMON_EXPORT bool IsMirrored(vtkDataObject* data);

/// Gives output the mark of input unless it has its own, and those of a mirror image.
VTKLACUNAFILTERSCOMMON_EXPORT void Pass(vtkDataObject* input, vtkDataObject* output);
}
#endif
