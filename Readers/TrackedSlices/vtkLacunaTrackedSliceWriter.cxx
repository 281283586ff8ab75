// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaTrackedSliceWriter.h"

#include "lacunaAlgorithmExecution.h"
#include "lacunaOutputFile.h"
#include "lacunaPrintableText.h"
#include "lacunaRequest.h"
#include "lacunaSequenceData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLacunaSliceStream.h"
#include "vtkLogger.h"
#include "vtkObjectFactory.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <filesystem>
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
std::string vtkLacunaTrackedSliceWriter::Ask(vtkInformation* input)
{
  return vtkLacunaSliceStream::Find(this)
    ? lacuna::AskForExtent(input, vtkLacunaSliceStream::GetFirstSlice(input))
    : lacuna::AskForAll(input);
}

//------------------------------------------------------------------------------
void vtkLacunaTrackedSliceWriter::WriteFile()
{
  auto* stack = vtkImageData::SafeDownCast(this->GetInput());
  if (!stack || stack->GetNumberOfPoints() == 0)
  {
    throw std::runtime_error("the input has no slices");
  }
  this->WriteStack(stack);
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
  lacuna::AlgorithmExecution execution(this);
  const lacuna::SequenceKind kind(this->FileName, this->CompressionLevel > 0);
  const lacuna::SequenceData content(
    stack, kind, vtkLacunaSliceStream::Find(this), this->KeepPatientIdentity, execution);
  const std::string neighbour = this->DescribeNeighbour(kind);
  this->FileSize =
    lacuna::WriteSequence(this->FileName, content.Get(), this->CompressionLevel, execution);
  for (const std::string& warning : content.GetWarnings())
  {
    vtkWarningMacro(<< lacuna::ToPrintable(this->FileName + (": " + warning)));
  }
  if (!neighbour.empty())
  {
    vtkWarningMacro(<< lacuna::ToPrintable(this->FileName + (": " + neighbour)));
  }
  vtkLog(INFO, << "Tracked Slice Writer: " << this->FileName << ", " << this->FileSize << " bytes, "
               << content.Get().Frames.size() << " slices");
}

//------------------------------------------------------------------------------
void vtkLacunaTrackedSliceWriter::Describe(lacuna::Properties& properties) const
{
  properties.Add("CompressionLevel", this->CompressionLevel, lacuna::ValueRange::Between(0, 9))
    .Add("KeepPatientIdentity", this->KeepPatientIdentity);
}
