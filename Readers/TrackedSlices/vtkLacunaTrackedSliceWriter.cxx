// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaTrackedSliceWriter.h"

#include "lacunaOutputFile.h"
#include "vtkErrorCode.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLacunaExecution.h"
#include "vtkLacunaRequest.h"
#include "vtkLacunaSequenceContent.h"
#include "vtkLogger.h"
#include "vtkObjectFactory.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>

vtkStandardNewMacro(vtkLacunaTrackedSliceWriter);

//------------------------------------------------------------------------------
vtkLacunaTrackedSliceWriter::~vtkLacunaTrackedSliceWriter()
{
  this->SetFileName(nullptr);
}

//------------------------------------------------------------------------------
int vtkLacunaTrackedSliceWriter::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaTrackedSliceWriter::ProcessRequest(
  vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkInformation* info = inputs[0]->GetInformationObject(0);
  if (request->Has(vtkStreamingDemandDrivenPipeline::REQUEST_UPDATE_EXTENT()) && info &&
    info->Has(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT()))
  {
    // Also of the pieces that write nothing: filters before this one may need all processes.
    vtkLacunaRequest::Whole(info);
    return 1;
  }
  return this->Superclass::ProcessRequest(request, inputs, outputs);
}

//------------------------------------------------------------------------------
int vtkLacunaTrackedSliceWriter::Write()
{
  this->FileSize = 0;
  this->Superclass::Write();
  if (this->Piece == 0 && this->FileSize == 0 && this->GetErrorCode() == vtkErrorCode::NoError)
  {
    // VTK does not come to WriteData when a filter upstream fails or has nothing
    this->SetErrorCode(vtkErrorCode::UnknownError);
    vtkErrorMacro("nothing was written: there is no input, or a filter before this one failed");
  }
  return this->GetErrorCode() == vtkErrorCode::NoError ? 1 : 0;
}

//------------------------------------------------------------------------------
void vtkLacunaTrackedSliceWriter::WriteData()
{
  this->FileSize = 0;
  if (this->Piece > 0)
  {
    return; // another process writes
  }
  unsigned long code = vtkErrorCode::UnknownError;
  std::string error;
  try
  {
    auto* stack = vtkImageData::SafeDownCast(this->GetInput());
    if (!this->FileName || !*this->FileName)
    {
      code = vtkErrorCode::NoFileNameError;
      throw std::runtime_error("no FileName is given");
    }
    if (!stack || stack->GetNumberOfPoints() == 0)
    {
      throw std::runtime_error("the input has no slices");
    }
    this->WriteStack(stack);
    return;
  }
  catch (const lacuna::FileError& e)
  {
    code = e.GetKind() == lacuna::FileError::Kind::NoSpace ? vtkErrorCode::OutOfDiskSpaceError
                                                           : vtkErrorCode::CannotOpenFileError;
    error = e.what();
  }
  catch (const lacuna::Aborted&)
  {
    this->SetErrorCode(vtkErrorCode::UserError); // no file, but no error message either
    return;
  }
  catch (const std::bad_alloc&)
  {
    error = "out of memory";
  }
  catch (const std::exception& e)
  {
    error = e.what();
  }
  this->SetErrorCode(code);
  vtkErrorMacro(<< error);
}

//------------------------------------------------------------------------------
// A header beside this one may name the pixels that are written over, and pixels from before may
// lie where no one needs them. Empty when all is well.
std::string vtkLacunaTrackedSliceWriter::DescribeNeighbour(const lacuna::SequenceKind& kind) const
{
  namespace fs = std::filesystem;
  if (!kind.IsDetached())
  {
    return {};
  }
  const lacuna::SequenceKind other(this->FileName, !kind.IsCompressed());
  if (fs::exists(other.GetDataFileName()))
  {
    return "'" + other.GetDataFileName() +
      "' was there before; this header does not name it, and " +
      "unless another one does it can be removed";
  }
  fs::path header = this->FileName;
  header.replace_extension(kind.IsNrrd() ? ".mhd" : ".nhdr");
  if (!kind.IsCompressed() && fs::exists(header) && fs::exists(kind.GetDataFileName()))
  {
    return "the pixels in '" + kind.GetDataFileName() + "' have been written over; if '" +
      header.string() + "' names them, too, it has those of this sweep now";
  }
  return {};
}

//------------------------------------------------------------------------------
void vtkLacunaTrackedSliceWriter::WriteStack(vtkImageData* stack)
{
  vtkLacunaExecution execution(this);
  const lacuna::SequenceKind kind(this->FileName, this->CompressionLevel > 0);
  const vtkLacunaSequenceContent content(stack, kind);
  const std::string neighbour = this->DescribeNeighbour(kind);
  this->FileSize =
    lacuna::WriteSequence(this->FileName, content.Get(), this->CompressionLevel, execution);
  for (const std::string& warning : content.GetWarnings())
  {
    vtkWarningMacro(<< this->FileName << ": " << warning);
  }
  if (!neighbour.empty())
  {
    vtkWarningMacro(<< this->FileName << ": " << neighbour);
  }
  vtkLog(INFO, << "Tracked Slice Writer: " << this->FileName << ", " << this->FileSize << " bytes, "
               << content.Get().Frames.size() << " slices");
}

//------------------------------------------------------------------------------
void vtkLacunaTrackedSliceWriter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "") << "\n";
  os << indent << "CompressionLevel: " << this->CompressionLevel << "\n";
  os << indent << "Piece: " << this->Piece << " of " << this->NumberOfPieces << "\n";
  os << indent << "FileSize: " << this->FileSize << "\n";
}
