// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What another library says of solids. Its headers are compiled once, in the source of this one.
#ifndef lacunaCGALSolid_h
#define lacunaCGALSolid_h

#include "lacunaDefectModel.h"
#include "lacunaImplantPlate.h"

/// Expects a solid that is closed, manifold, outward, without self-intersection, and of the volume
/// that it says.
void CheckSolid(const lacuna::ImplantPlate& plate);
void CheckSolid(const lacuna::DefectModel& model);

/// Whether the surfaces of both touch.
bool Intersect(const lacuna::ImplantPlate& plate, const lacuna::DefectModel& model);
#endif
