// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaWriting.h"

#include "lacunaExecution.h"
#include "lacunaOutputFile.h"
#include "lacunaPrintableText.h"
#include "vtkAlgorithm.h"
#include "vtkErrorCode.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLacunaFailure.h"
#include "vtkLacunaInputs.h"
#include "vtkLacunaRequest.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <exception>
#include <new>
#include <stdexcept>
#include <string>

//------------------------------------------------------------------------------
bool vtkLacunaWriting::AskForWhole(
  vtkAlgorithm* writer, int piece, vtkInformation* request, vtkInformationVector** inputs)
{
  vtkInformation* info = inputs[0]->GetInformationObject(0);
  if (!info || !request->Has(vtkStreamingDemandDrivenPipeline::REQUEST_UPDATE_EXTENT()))
  {
    return false;
  }
  if (piece > 0)
  {
    vtkLacunaRequest::Nothing(writer, info); // the first one writes
    return true;
  }
  vtkLacunaRequest::Whole(writer, info, nullptr);
  return true;
}

//------------------------------------------------------------------------------
unsigned long vtkLacunaWriting::Run(
  vtkAlgorithm* writer, const char* fileName, const std::function<void()>& body)
{
  unsigned long code = vtkErrorCode::UnknownError;
  std::string error;
  try
  {
    if (!fileName || !*fileName)
    {
      code = vtkErrorCode::NoFileNameError;
      throw std::runtime_error("no FileName is given");
    }
    const std::string failed = vtkLacunaFailure::GetUpstream(writer);
    if (!failed.empty())
    {
      throw std::runtime_error(
        "nothing was written, because a filter before this one failed: " + failed);
    }
    vtkLacunaInputs::Check(writer);
    body();
    return vtkErrorCode::NoError;
  }
  catch (const lacuna::FileError& e)
  {
    code = e.GetKind() == lacuna::FileError::Kind::NoSpace ? vtkErrorCode::OutOfDiskSpaceError
                                                           : vtkErrorCode::CannotOpenFileError;
    error = e.what();
  }
  catch (const lacuna::Aborted&)
  {
    return vtkErrorCode::UserError; // no file, but no error message either
  }
  catch (const std::bad_alloc&)
  {
    error = "out of memory";
  }
  catch (const std::exception& e)
  {
    error = e.what();
  }
  vtkErrorWithObjectMacro(writer, << lacuna::ToPrintable(error));
  return code;
}

//------------------------------------------------------------------------------
unsigned long vtkLacunaWriting::Check(vtkAlgorithm* writer, bool written)
{
  if (written || writer->GetErrorCode() != vtkErrorCode::NoError)
  {
    return writer->GetErrorCode();
  }
  vtkErrorWithObjectMacro(
    writer, "nothing was written: there is no input, or a filter before this one failed");
  return vtkErrorCode::UnknownError;
}
