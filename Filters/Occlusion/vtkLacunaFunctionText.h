// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// VTK's functions as text, for the record of how an output was made.
#ifndef vtkLacunaFunctionText_h
#define vtkLacunaFunctionText_h

class vtkImplicitFunction;
class vtkPiecewiseFunction;
namespace lacuna
{
class ParameterText;
}

namespace vtkLacunaFunctionText
{
/// Grey level, opacity, midpoint and sharpness of each node.
void Add(lacuna::ParameterText& text, const char* name, vtkPiecewiseFunction* function);

/// The class and, of the functions that ParaView offers, their numbers.
void Add(lacuna::ParameterText& text, const char* name, vtkImplicitFunction* function);
}
#endif
