// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How readers announce what a file has, and report what went wrong.
#ifndef vtkLacunaReading_h
#define vtkLacunaReading_h

#include "vtkLacunaFiltersCommonModule.h" // for export macro

#include <functional>
#include <string>

class vtkAlgorithm;
class vtkInformationVector;

namespace vtkLacunaReading
{
/// Runs the body of reader's RequestInformation as vtkLacunaExecution::RunInformation does, and returns its
/// error code (vtkErrorCode::NoError when all went well). What body throws becomes reader's error when data
/// are asked for, and its code at once: that of no file name (kind says what it must be), of no such file,
/// or of a format that is not understood.
VTKLACUNAFILTERSCOMMON_EXPORT unsigned long RunInformation(vtkAlgorithm* reader,
  vtkInformationVector* outputs, const char* fileName, const std::string& kind,
  const std::function<void()>& body);
}
#endif
