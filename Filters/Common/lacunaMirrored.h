// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The mark of data that show a patient's mirror image. vtkLacunaMirror alone sets it; every filter
/// that records provenance passes it on from its first input. Whoever makes something of data for
/// the patient asks for it.
#ifndef lacunaMirrored_h
#define lacunaMirrored_h

#include "lacunaVector.h"
#include "vtkLacunaFiltersCommonModule.h" // for export macro

class vtkDataObject;

namespace lacuna::Mirrored
{
/// Field data: 1 where the data are mirrored; a point of the plane (world mm) and its unit normal.
constexpr const char* ArrayName = "Mirrored";
constexpr const char* OriginName = "MirrorPlaneOrigin";
constexpr const char* NormalName = "MirrorPlaneNormal";

VTKLACUNAFILTERSCOMMON_EXPORT void Mark(
  vtkDataObject* data, const Vec3& origin, const Vec3& normal);
VTKLACUNAFILTERSCOMMON_EXPORT bool IsMarked(vtkDataObject* data);
/// Marks output when input is marked.
VTKLACUNAFILTERSCOMMON_EXPORT void Pass(vtkDataObject* input, vtkDataObject* output);
}
#endif
