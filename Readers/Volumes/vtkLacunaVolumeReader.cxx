// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaVolumeReader.h"

#include "lacunaArrayScalarType.h"
#include "lacunaArrays.h"
#include "lacunaCoordinates.h"
#include "lacunaMemory.h"
#include "lacunaNiftiVolume.h"
#include "lacunaParameterText.h"
#include "lacunaPixelSource.h"
#include "lacunaPrintableText.h"
#include "lacunaReading.h"
#include "lacunaSequenceText.h"
#include "lacunaVolumeBox.h"
#include "lacunaVolumeDirection.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkExtentTranslator.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationIntegerRequestKey.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <array>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace
{
constexpr const char* ScalarsName = "Intensity";

bool IsNamedNifti(const std::string& fileName)
{
  return lacuna::EndsWithIgnoringCase(fileName, ".nii") ||
    lacuna::EndsWithIgnoringCase(fileName, ".nii.gz");
}
}

struct vtkLacunaVolumeReader::Content
{
  lacuna::VolumeFile File;
  lacuna::VolumeBox Grid;
  std::unique_ptr<lacuna::PixelSource> Pixels; // refers to File
  lacuna::ScalarType Type = lacuna::ScalarType::UInt8;
  bool Warned = false;
};

vtkStandardNewMacro(vtkLacunaVolumeReader);

//------------------------------------------------------------------------------
vtkLacunaVolumeReader::vtkLacunaVolumeReader()
{
  this->Sharing = lacuna::Share::Parts;
  this->SetNumberOfInputPorts(0);
}

//------------------------------------------------------------------------------
vtkLacunaVolumeReader::~vtkLacunaVolumeReader()
{
  this->SetFileName(nullptr);
}

//------------------------------------------------------------------------------
int vtkLacunaVolumeReader::CanReadFile(const char* fileName)
{
  if (!fileName || !*fileName)
  {
    return 0;
  }
  if (IsNamedNifti(fileName))
  {
    try
    {
      lacuna::ReadNiftiHeader(fileName);
      return 1;
    }
    catch (const std::exception&)
    {
      return 0; // whatever it is
    }
  }
  return lacuna::GetImageFileKind(fileName) == lacuna::ImageFileKind::Volume ? 1 : 0;
}

//------------------------------------------------------------------------------
void vtkLacunaVolumeReader::OpenVolume(Content& content)
{
  content.File = IsNamedNifti(this->FileName)
    ? lacuna::MakeNiftiVolume(this->FileName, lacuna::ReadNiftiHeader(this->FileName),
        static_cast<lacuna::NiftiTransform>(this->NIfTITransform))
    : lacuna::ReadVolumeFile(this->FileName);
  const lacuna::SequenceHeader& slices = content.File.Slices;
  try
  {
    content.Grid = lacuna::FindVolumeBox(
      content.File.IndexToPatient, { slices.Columns, slices.Rows, slices.Frames });
  }
  catch (const std::invalid_argument& e)
  {
    throw std::runtime_error(std::string(this->FileName) + ": " + e.what());
  }
  content.Pixels = lacuna::PixelSource::Open(slices);
  if (content.Pixels->GetNumberOfWholeFrames() < slices.Frames)
  {
    throw std::runtime_error(slices.DataFileName + ": " + content.Pixels->GetWarning() +
      ". Copy or convert the file again");
  }
  if (!content.Pixels->GetWarning().empty())
  {
    content.File.Warnings.push_back(content.Pixels->GetWarning());
  }
  content.Type = lacuna::GetVolumeType(
    content.Pixels->GetScalarType(), content.File.Slope, content.File.Intercept);
}

//------------------------------------------------------------------------------
void vtkLacunaVolumeReader::Announce(const lacuna::Ports& ports)
{
  this->Opened.reset();
  lacuna::Reading::Run(
    this->FileName, "a volume in a file (.mha, .mhd, .nrrd, .nhdr, .nii, .nii.gz)",
    [this](unsigned long code) { this->SetErrorCode(code); },
    [&]
    {
      this->CheckProperties();
      auto content = std::make_unique<Content>();
      this->OpenVolume(*content);
      this->Opened = std::move(content);
      this->AnnounceGrid(ports.GetOutputInformation());
    });
}

//------------------------------------------------------------------------------
void vtkLacunaVolumeReader::AnnounceGrid(vtkInformation* info) const
{
  const lacuna::VolumeBox& grid = this->Opened->Grid;
  int extent[6] = { 0, 0, 0, 0, 0, 0 };
  double direction[9];
  for (std::size_t i = 0; i < 3; ++i)
  {
    extent[2 * i + 1] = static_cast<int>(grid.Dimensions[i] - 1);
    for (int row = 0; row < 3; ++row)
    {
      direction[3 * row + static_cast<int>(i)] = grid.Axes[i][row];
    }
  }
  info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
  info->Set(vtkDataObject::ORIGIN(), grid.Origin.data(), 3);
  info->Set(vtkDataObject::SPACING(), grid.Spacing.data(), 3);
  info->Set(vtkDataObject::DIRECTION(), direction, 9);
  // ranks share out whole slices
  info->Set(vtkExtentTranslator::UPDATE_SPLIT_MODE(), vtkExtentTranslator::Z_SLAB_MODE);
  vtkDataObject::SetPointDataActiveScalarInfo(info,
    lacuna::ArrayScalarType::ToVTK(this->Opened->Type),
    static_cast<int>(this->Opened->File.Slices.Channels));
}

//------------------------------------------------------------------------------
void vtkLacunaVolumeReader::AddFieldData(vtkImageData* output)
{
  Content& content = *this->Opened;
  lacuna::VolumeDirection::Record(output);
  if (content.File.IsPatient)
  {
    lacuna::Coordinates::Mark(output, lacuna::Coordinates::Patient);
  }
  if (!content.Warned)
  {
    for (const std::string& warning : content.File.Warnings)
    {
      vtkWarningMacro(<< lacuna::ToPrintable(this->FileName + (": " + warning)));
    }
    content.Warned = true;
  }
}

//------------------------------------------------------------------------------
void vtkLacunaVolumeReader::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  Content& content = *this->Opened;
  vtkInformation* info = ports.GetOutputInformation();
  auto* output = ports.GetOutput<vtkImageData>();
  std::array<int, 6> extent = ports.GetExtent();
  output->SetOrigin(info->Get(vtkDataObject::ORIGIN()));
  output->SetSpacing(info->Get(vtkDataObject::SPACING()));
  output->SetDirectionMatrix(info->Get(vtkDataObject::DIRECTION()));
  output->SetExtent(extent.data());
  this->AddFieldData(output);
  lacuna::Reading::Run(
    this->FileName, "", [this](unsigned long code) { this->SetErrorCode(code); },
    [&]
    {
      const std::int64_t channels = content.File.Slices.Channels;
      lacuna::RequireMemory("The volume",
        static_cast<double>(output->GetNumberOfPoints()) * static_cast<double>(channels) *
            static_cast<double>(lacuna::GetScalarSize(content.Type)) +
          static_cast<double>(content.Pixels->GetFrameSize()));
      vtkSmartPointer<vtkDataArray> scalars;
      scalars.TakeReference(
        vtkDataArray::CreateDataArray(lacuna::ArrayScalarType::ToVTK(content.Type)));
      scalars->SetName(ScalarsName);
      scalars->SetNumberOfComponents(static_cast<int>(channels));
      lacuna::Arrays::SetNumberOfTuples(scalars, output->GetNumberOfPoints());
      lacuna::ReadVolume(
        content.File, content.Grid, *content.Pixels, extent, scalars->GetVoidPointer(0), execution);
      output->GetPointData()->SetScalars(scalars);
    });
}

//------------------------------------------------------------------------------
void vtkLacunaVolumeReader::Describe(lacuna::Properties& properties) const
{
  properties.Add("NIfTITransform", this->NIfTITransform, lacuna::NiftiTransformNames);
}

//------------------------------------------------------------------------------
std::string vtkLacunaVolumeReader::Parameters(int) const
{
  std::error_code ignored;
  lacuna::Properties properties;
  properties
    // tells which file it was to one who has it, and no name of a patient
    .Add("FileName",
      "fnv1a:" + lacuna::HashText(std::filesystem::path(this->FileName).filename().string()))
    .Add("FileSize", std::filesystem::file_size(this->Opened->File.Slices.DataFileName, ignored));
  this->Describe(properties);
  return properties.GetText();
}

//------------------------------------------------------------------------------
void vtkLacunaVolumeReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->vtkLacunaAlgorithm::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "") << "\n";
}
