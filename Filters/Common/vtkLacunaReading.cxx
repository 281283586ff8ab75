// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaReading.h"

#include "vtkErrorCode.h"
#include "vtkLacunaExecution.h"
#include "vtkLacunaFailure.h"

#include <filesystem>
#include <stdexcept>
#include <system_error>

//------------------------------------------------------------------------------
unsigned long vtkLacunaReading::RunInformation(vtkAlgorithm* reader, vtkInformationVector* outputs,
  const char* fileName, const std::string& kind, const std::function<void()>& body)
{
  vtkLacunaFailure::DependsOnFiles(reader);
  unsigned long code = vtkErrorCode::NoFileNameError;
  vtkLacunaExecution::RunInformation(reader, outputs,
    [&]
    {
      if (!fileName || !*fileName)
      {
        throw std::runtime_error("FileName is not set; it must be " + kind);
      }
      std::error_code ignored;
      code = std::filesystem::exists(fileName, ignored) ? vtkErrorCode::FileFormatError
                                                        : vtkErrorCode::FileNotFoundError;
      body();
      code = vtkErrorCode::NoError;
    });
  return code;
}
