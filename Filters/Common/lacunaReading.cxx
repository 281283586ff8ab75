// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaReading.h"

#include "lacunaExecution.h"
#include "vtkErrorCode.h"

#include <filesystem>
#include <stdexcept>
#include <system_error>

//------------------------------------------------------------------------------
void lacuna::Reading::Run(const char* fileName, const std::string& kind,
  const std::function<void(unsigned long)>& setErrorCode, const std::function<void()>& body)
{
  if (!fileName || !*fileName)
  {
    setErrorCode(vtkErrorCode::NoFileNameError);
    throw std::runtime_error("FileName is not set; it must be " + kind);
  }
  try
  {
    body();
    setErrorCode(vtkErrorCode::NoError);
  }
  catch (const lacuna::Aborted&)
  {
    throw;
  }
  catch (const std::exception&)
  {
    std::error_code ignored;
    setErrorCode(std::filesystem::exists(fileName, ignored) ? vtkErrorCode::FileFormatError
                                                            : vtkErrorCode::FileNotFoundError);
    throw;
  }
}
