// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where the points of what is made for the press, surfaces and paths, were made, by which those who
/// use it see that it has been moved since (by ParaView's Transform, say), so that PressToPatient no
/// longer leads from it to the patient.
#ifndef lacunaPressPosition_h
#define lacunaPressPosition_h

#include "lacunaLandmarks.h"

#include <optional>
#include <string>

class vtkDataObject;
class vtkPointSet;

namespace lacuna::PressPosition
{
/// Point data, double x 4: x, y, z in mm, and 1. Not 3, since filters that move points turn vectors,
/// too. Subsets keep it, contours and slices interpolate it, and so it stays true; where a filter fills
/// it with 0 the last number tells.
constexpr const char* ArrayName = "PressPosition";

/// Adds the array to data that lie where they were made.
void Record(vtkPointSet* data);

/// Field data, one number: what data are made of had been moved by so many mm since it was made for
/// the press. They have no PressToPatient.
constexpr const char* MovedName = "MovedSincePress";

/// How data lie to where they were made; Stretch is also what single points were moved against the
/// others. Nothing without a valid array, or when all is on a line.
std::optional<LandmarkMove> FindMove(vtkDataObject* data);

/// Throws std::runtime_error, in words for the user, when data have been mirrored or stretched by more
/// than 2 um since Record; returns what to say when they lie elsewhere. Empty when they are where they
/// were, or without a valid array, since then there is no telling.
std::string Check(vtkDataObject* data);
}
#endif
