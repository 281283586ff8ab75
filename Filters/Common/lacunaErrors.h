// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Errors in the data: an algorithm that failed leaves its error in its outputs, and those behind it pass it on.
#ifndef lacunaErrors_h
#define lacunaErrors_h

#include <string>

class vtkAlgorithm;
class vtkDataObject;
class vtkInformationVector;

namespace lacuna::Errors
{
/// The array of an output's field data (vtkStringArray, one value) that holds the error.
constexpr char FieldName[] = "LacunaError";

/// Empties outputs, so that VTK asks for them again and remembers nothing of the request that failed.
void Empty(vtkInformationVector* outputs);

/// Leaves error in outputs that are empty, and marks them as not generated.
void Leave(vtkInformationVector* outputs, const std::string& error);

/// An error that is on the screen already: reaches only those who listen.
void Repeat(vtkAlgorithm* algorithm, const std::string& error);

/// The error that data or one of its blocks holds; empty: none.
std::string GetOf(vtkDataObject* data);

/// The error that an input of algorithm holds; empty: none.
std::string GetUpstream(vtkAlgorithm* algorithm);
}
#endif
