// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Implicit functions as text, for provenance: enough to make the same region again.
#ifndef lacunaFunctionText_h
#define lacunaFunctionText_h

#include "vtkLacunaFiltersCommonModule.h" // for export macro

#include <string>

class vtkImplicitFunction;

namespace lacuna::FunctionText
{
/// The class and, as parameters, the shape (mm) and Transform, the 16 numbers row by row of the
/// matrix from the world to the shape, when there is one; of ParaView's cylinder, which has a
/// transform to turn it, the axis in the world instead. Of functions that are not planes, boxes,
/// spheres, cylinders, selection loops or booleans of these what they print of themselves, without
/// addresses and times. "None" for null.
VTKLACUNAFILTERSCOMMON_EXPORT std::string Describe(vtkImplicitFunction* function);
}
#endif
