// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Refuses regions that are none: VTK squares the radius of a sphere, so that one below zero counts as
/// its opposite, and a region of numbers that are not finite contains nothing, without a word.
#ifndef lacunaImplicitRegion_h
#define lacunaImplicitRegion_h

#include "vtkLacunaFiltersCommonModule.h" // for export macro

#include <string>

class vtkImplicitFunction;

namespace lacuna::ImplicitRegion
{
/// Throws std::runtime_error that begins with property and names the number at fault when a plane, box,
/// sphere, cylinder, or a boolean that has one, has numbers that are not finite, a radius that is not
/// above 0, a normal without direction, a box its bounds the wrong way round or the transform no
/// inverse. Null, and functions of other classes, are taken as they are.
VTKLACUNAFILTERSCOMMON_EXPORT void Check(vtkImplicitFunction* region, const std::string& property);
}
#endif
