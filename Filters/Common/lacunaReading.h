// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The error codes of readers.
#ifndef lacunaReading_h
#define lacunaReading_h

#include "vtkLacunaFiltersCommonModule.h" // for export macro

#include <functional>
#include <string>

namespace lacuna::Reading
{
/// Runs body, which reads from a file, and sets the error code of a reader: that of no file name (kind says what it
/// must be), of no such file, or of a format that is not understood. Throws what body throws; a stop has no code.
VTKLACUNAFILTERSCOMMON_EXPORT void Run(const char* fileName, const std::string& kind,
  const std::function<void(unsigned long)>& setErrorCode, const std::function<void()>& body);
}
#endif
