// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How writers ask for their input, and report what went wrong.
#ifndef vtkLacunaWriting_h
#define vtkLacunaWriting_h

#include "vtkLacunaFiltersCommonModule.h" // for export macro

#include <functional>

class vtkAlgorithm;
class vtkInformation;
class vtkInformationVector;

namespace vtkLacunaWriting
{
/// For ProcessRequest of writers whose first process writes all: when the request is for the update
/// extent, asks for the whole input of writer, which is that of a piece, and returns true. For the
/// processes that write nothing see vtkLacunaRequest::Whole.
VTKLACUNAFILTERSCOMMON_EXPORT bool AskForWhole(
  vtkAlgorithm* writer, int piece, vtkInformation* request, vtkInformationVector** inputs);

/// Runs the body of writer's WriteData and returns its error code (vtkErrorCode::NoError when all
/// went well). An exception becomes writer's error message and the code for no file name, disk full,
/// file cannot be opened, or unknown; a stop by the user only a code.
VTKLACUNAFILTERSCOMMON_EXPORT unsigned long Run(
  vtkAlgorithm* writer, const char* fileName, const std::function<void()>& body);

/// The error code after Write of a superclass. Not written without an error is an error, too, and
/// said: VTK does not come to WriteData when a filter upstream fails or has nothing.
VTKLACUNAFILTERSCOMMON_EXPORT unsigned long Check(vtkAlgorithm* writer, bool written);
}
#endif
