// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaWriter.h"

#include "lacunaErrors.h"
#include "lacunaExecution.h"
#include "lacunaInputCheck.h"
#include "lacunaOutputFile.h"
#include "lacunaPrintableText.h"
#include "lacunaRequest.h"
#include "vtkErrorCode.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <new>
#include <stdexcept>

//------------------------------------------------------------------------------
int vtkLacunaWriter::ProcessRequest(
  vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkInformation* info = inputs[0]->GetInformationObject(0);
  if (!info || !request->Has(vtkStreamingDemandDrivenPipeline::REQUEST_UPDATE_EXTENT()))
  {
    return this->Superclass::ProcessRequest(request, inputs, outputs);
  }
  this->Refused = this->Ask(info);
  return 1;
}

std::string vtkLacunaWriter::Ask(vtkInformation* input)
{
  return lacuna::AskForAll(input);
}

void vtkLacunaWriter::ClearResults()
{
  this->FileSize = 0;
}

//------------------------------------------------------------------------------
int vtkLacunaWriter::Write()
{
  this->ClearResults();
  this->Superclass::Write();
  if (this->FileSize == 0 && this->Piece == 0 && this->GetErrorCode() == vtkErrorCode::NoError)
  {
    vtkErrorMacro("nothing was written: there is no input, or a filter before this one failed");
    this->SetErrorCode(vtkErrorCode::UnknownError);
  }
  return this->GetErrorCode() == vtkErrorCode::NoError ? 1 : 0;
}

//------------------------------------------------------------------------------
void vtkLacunaWriter::RequireInput()
{
  const std::string failed = lacuna::Errors::GetUpstream(this);
  if (!failed.empty())
  {
    throw std::runtime_error(
      "nothing was written, because a filter before this one failed: " + failed);
  }
  if (!this->Refused.empty())
  {
    throw std::runtime_error(this->Refused);
  }
  vtkDataObject* data = this->GetInputDataObject(0, 0);
  lacuna::InputCheck::Check(data, "input 0");
  lacuna::InputCheck::CheckPart(data, this->GetInputInformation(), "input 0");
}

//------------------------------------------------------------------------------
void vtkLacunaWriter::WriteData()
{
  this->ClearResults();
  if (this->Piece > 0)
  {
    return; // the first one writes
  }
  unsigned long code = vtkErrorCode::UnknownError;
  std::string error;
  try
  {
    if (!this->FileName || !*this->FileName)
    {
      code = vtkErrorCode::NoFileNameError;
      throw std::runtime_error("no FileName is given");
    }
    this->RequireInput();
    this->CheckProperties();
    this->WriteFile();
    code = vtkErrorCode::NoError;
  }
  catch (const lacuna::FileError& e)
  {
    code = e.GetKind() == lacuna::FileError::Kind::NoSpace ? vtkErrorCode::OutOfDiskSpaceError
                                                           : vtkErrorCode::CannotOpenFileError;
    error = e.what();
  }
  catch (const lacuna::Aborted&)
  {
    code = vtkErrorCode::UserError; // no file, but no error message either
  }
  catch (const std::bad_alloc&)
  {
    error = "out of memory";
  }
  catch (const std::exception& e)
  {
    error = e.what();
  }
  if (!error.empty())
  {
    vtkErrorMacro(<< lacuna::ToPrintable(error));
  }
  this->SetErrorCode(code);
}

//------------------------------------------------------------------------------
void vtkLacunaWriter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
  this->PrintProperties(os, indent);
  os << indent << "Piece: " << this->Piece << " of " << this->NumberOfPieces << "\n";
  os << indent << "FileSize: " << this->FileSize << "\n";
}
