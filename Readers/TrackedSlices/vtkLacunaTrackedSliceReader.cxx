// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaTrackedSliceReader.h"

#include "lacunaArrayScalarType.h"
#include "lacunaArrays.h"
#include "lacunaFieldData.h"
#include "lacunaMemory.h"
#include "lacunaPrintableText.h"
#include "lacunaProvenance.h"
#include "lacunaReading.h"
#include "lacunaSequenceFile.h"
#include "lacunaSequenceFormat.h"
#include "lacunaSequenceNames.h"
#include "lacunaSequenceText.h"
#include "lacunaSweep.h"
#include "lacunaSweepReplay.h"
#include "lacunaSweepTransforms.h"
#include "lacunaTrackedSlices.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkLacunaSliceStream.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"
#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string>

namespace
{
constexpr const char* IntensityName = "Intensity";

std::string Text(const char* s)
{
  return s ? s : "";
}

std::string BaseName(const char* path)
{
  return vtksys::SystemTools::GetFilenameName(Text(path));
}

void AddStrings(vtkDataObject* data, const std::string& name, const std::vector<std::string>& texts)
{
  vtkNew<vtkStringArray> array;
  array->SetName(name.c_str());
  array->SetNumberOfValues(static_cast<vtkIdType>(texts.size()));
  for (std::size_t i = 0; i < texts.size(); ++i)
  {
    array->SetValue(static_cast<vtkIdType>(i), texts[i]);
  }
  data->GetFieldData()->AddArray(array);
}
}

struct vtkLacunaTrackedSliceReader::Sequence
{
  std::shared_ptr<lacuna::SequenceFile> File;
  std::unique_ptr<lacuna::SweepReplay> Replay; // null unless asked for
  vtkSmartPointer<vtkImageData> Fields;        // its field data are those of every output
  std::string Chain;                           // of transforms, for the provenance
  // What was read for the time before this one.
  vtkSmartPointer<vtkDataArray> Scalars;
  int Extent[6] = { 0, -1, 0, -1, 0, -1 };
  int Shown = 0; // slices of the stack that had been taken
};

vtkStandardNewMacro(vtkLacunaTrackedSliceReader);

//------------------------------------------------------------------------------
vtkLacunaTrackedSliceReader::vtkLacunaTrackedSliceReader()
{
  this->Sharing = lacuna::Share::Parts;
  this->SetNumberOfInputPorts(0);
  this->SetImageFrame("Image");
  this->SetReferenceFrame("Reference");
}

//------------------------------------------------------------------------------
vtkLacunaTrackedSliceReader::~vtkLacunaTrackedSliceReader()
{
  this->SetFileName(nullptr);
  this->SetCalibrationFileName(nullptr);
  this->SetImageFrame(nullptr);
  this->SetReferenceFrame(nullptr);
}

//------------------------------------------------------------------------------
int vtkLacunaTrackedSliceReader::CanReadFile(const char* fileName)
{
  return fileName && lacuna::IsTrackedSequence(fileName) ? 1 : 0;
}

//------------------------------------------------------------------------------
double vtkLacunaTrackedSliceReader::GetMostBytes() const
{
  constexpr double mebibyte = 1048576;
  if (this->MemoryLimit > 0)
  {
    return this->MemoryLimit * mebibyte;
  }
  // ranks show the same slices, whatever memory their computers have
  return lacuna::ControllerRanks().GetNumber() > 1 ? 4096 * mebibyte
                                                   : lacuna::GetPhysicalMemory() / 4;
}

//------------------------------------------------------------------------------
void vtkLacunaTrackedSliceReader::OpenSequence(Sequence& sequence)
{
  this->CheckProperties();
  sequence.File = std::make_shared<lacuna::SequenceFile>(
    this->FileName, this->FrameRange, this->FrameStride, this->GetMostBytes());
  if (this->ReplayInTime)
  {
    const lacuna::SequenceFile::Choice& stack = sequence.File->GetStack();
    sequence.Replay = std::make_unique<lacuna::SweepReplay>(
      lacuna::ReadTimestamps(sequence.File->Header), stack.First, stack.Stride, stack.Slices);
  }
}

//------------------------------------------------------------------------------
void vtkLacunaTrackedSliceReader::Announce(const lacuna::Ports& ports)
{
  this->Opened.reset();
  this->Preview.clear();
  vtkInformation* info = ports.GetOutputInformation();
  info->Remove(vtkStreamingDemandDrivenPipeline::TIME_STEPS());
  info->Remove(vtkStreamingDemandDrivenPipeline::TIME_RANGE());
  info->Remove(vtkLacunaSliceStream::STREAM());
  lacuna::Reading::Run(
    this->FileName, "a tracked sequence file (.mha, .mhd, .nrrd, .nhdr)",
    [this](unsigned long code) { this->SetErrorCode(code); },
    [&]
    {
      auto sequence = std::make_unique<Sequence>();
      this->OpenSequence(*sequence);
      const lacuna::SequenceFile& file = *sequence->File;
      int extent[6];
      double origin[3];
      double spacing[3];
      file.GetPlace(file.GetStack(), extent, origin, spacing);
      info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
      info->Set(vtkDataObject::ORIGIN(), origin, 3);
      info->Set(vtkDataObject::SPACING(), spacing, 3);
      vtkDataObject::SetPointDataActiveScalarInfo(
        info, lacuna::ArrayScalarType::ToVTK(file.Pixels->GetScalarType()), 1);
      if (sequence->Replay)
      {
        const std::vector<double>& times = sequence->Replay->GetTimes();
        const double range[2] = { times.front(), times.back() };
        info->Set(vtkStreamingDemandDrivenPipeline::TIME_STEPS(), times.data(),
          static_cast<int>(times.size()));
        info->Set(vtkStreamingDemandDrivenPipeline::TIME_RANGE(), range, 2);
      }
      else
      {
        info->Set(vtkLacunaSliceStream::STREAM(), sequence->File->MakeStream());
      }
      this->Preview = file.DescribePreview();
      this->Opened = std::move(sequence);
    });
}

//------------------------------------------------------------------------------
void vtkLacunaTrackedSliceReader::Describe(lacuna::Properties& properties) const
{
  using lacuna::ValueRange;
  properties.Add("ImageFrame", this->ImageFrame)
    .Add("ReferenceFrame", this->ReferenceFrame)
    .Add("FrameRange", this->FrameRange)
    .Add("FrameStride", this->FrameStride, ValueRange::AtLeast(1))
    .Add("DropInvalidSlices", this->DropInvalidSlices)
    .Add("KeepPatientIdentity", this->KeepPatientIdentity)
    .Add("ReplayInTime", this->ReplayInTime)
    .Add("MemoryLimit", this->MemoryLimit, ValueRange::AtLeast(0, "MiB"));
}

//------------------------------------------------------------------------------
std::string vtkLacunaTrackedSliceReader::Parameters(int) const
{
  const std::string& chain = this->Opened->Chain;
  lacuna::Properties properties;
  properties.Add("FileName", BaseName(this->FileName))
    .Add("FileSize", vtksys::SystemTools::FileLength(this->Opened->File->Header.DataFileName))
    .Add("CalibrationFileName", BaseName(this->CalibrationFileName));
  this->Describe(properties);
  if (!chain.empty())
  {
    properties.Add("Chain", chain);
  }
  return properties.GetText();
}

//------------------------------------------------------------------------------
void vtkLacunaTrackedSliceReader::MakeFieldData()
{
  const lacuna::SequenceHeader& header = this->Opened->File->Header;
  lacuna::SweepOptions options;
  options.CalibrationFileName = Text(this->CalibrationFileName);
  options.ImageFrame = Text(this->ImageFrame);
  options.ReferenceFrame = Text(this->ReferenceFrame);
  options.DropInvalid = this->DropInvalidSlices;
  options.FramesWithPixels = this->Opened->File->Pixels->GetNumberOfWholeFrames();
  const lacuna::Sweep sweep = lacuna::BuildSweep(header, options);
  auto fields = vtkSmartPointer<vtkImageData>::New();
  // The arrays of the contract come last: no field of the file takes their place.
  const std::vector<std::string> steps = this->AddTexts(sweep, fields);
  this->AddContract(sweep, fields);
  if (!steps.empty()) // the base goes on with them
  {
    AddStrings(fields, lacuna::Provenance::ArrayName, steps);
  }
  this->Opened->Chain = sweep.Chain;
  this->WarnOf(sweep);
  this->Opened->Fields = fields;
}

//------------------------------------------------------------------------------
// Fields of the file; returns the steps of its provenance.
std::vector<std::string> vtkLacunaTrackedSliceReader::AddTexts(
  const lacuna::Sweep& sweep, vtkImageData* output) const
{
  std::vector<std::string> steps;
  const auto isKept = [&](const std::string& name, const std::vector<std::string>& texts)
  { return this->KeepPatientIdentity || !lacuna::IdentifiesPatient(name, texts); };
  for (const auto& [name, value] : this->Opened->File->Header.CustomFields)
  {
    if (!isKept(name, { value }) ||
      sweep.HeaderTransforms.count(lacuna::SweepTransforms::GetTransformName(name)) > 0)
    {
      continue; // a transform is written for each frame
    }
    if (name.find(lacuna::SequenceNames::ProvenancePrefix) == 0)
    {
      steps.push_back(value);
      continue;
    }
    if (name != lacuna::FirstColumnField && name != lacuna::FirstRowField) // the origin says it
    {
      AddStrings(output, name, { value });
    }
  }
  for (const auto& [name, texts] : sweep.TextFields)
  {
    if (isKept(name, texts))
    {
      AddStrings(output, name, texts);
    }
  }
  return steps;
}

//------------------------------------------------------------------------------
void vtkLacunaTrackedSliceReader::AddContract(
  const lacuna::Sweep& sweep, vtkImageData* output) const
{
  const lacuna::SequenceHeader& header = this->Opened->File->Header;
  for (const auto& [name, matrices] : sweep.Transforms)
  {
    lacuna::FieldData::SetMatrices(output, name, matrices);
  }
  if (!sweep.ImageToProbe.empty())
  {
    lacuna::FieldData::SetMatrices(
      output, lacuna::TrackedSlices::ImageToProbeName, sweep.ImageToProbe);
  }
  if (!header.PosesOnly)
  {
    const bool signal = header.ImageType.find("RF_") == 0; // else grey levels, also of colours
    AddStrings(
      output, lacuna::SequenceNames::ImageType, { signal ? header.ImageType : "BRIGHTNESS" });
    AddStrings(output, lacuna::SequenceNames::Orientation, { header.Flips.Lines ? "FM" : "MFA" });
  }
  AddStrings(
    output, lacuna::SequenceNames::Frames, { sweep.ImageFrame, Text(this->ReferenceFrame) });
  lacuna::TrackedSlices::Write(
    output, sweep.ImageToReference, sweep.Timestamps, sweep.Status, sweep.FrameNumbers);
  if (!this->Preview.empty())
  {
    AddStrings(output, lacuna::TrackedSlices::PreviewName, { this->Preview });
  }
}

//------------------------------------------------------------------------------
void vtkLacunaTrackedSliceReader::WarnOf(const lacuna::Sweep& sweep)
{
  std::vector<std::string> warnings = this->Opened->File->Header.Warnings;
  if (!this->Opened->File->Pixels->GetWarning().empty())
  {
    warnings.push_back(this->Opened->File->Pixels->GetWarning());
  }
  warnings.insert(warnings.end(), sweep.Warnings.begin(), sweep.Warnings.end());
  if (!this->Preview.empty())
  {
    warnings.push_back("this is " + this->Preview);
  }
  if (this->Opened->Replay && !this->Opened->Replay->HasTimestamps())
  {
    warnings.emplace_back(
      "no slice has a Timestamp; ReplayInTime shows one slice per second, by number");
  }
  for (const std::string& warning : warnings)
  {
    vtkWarningMacro(<< lacuna::ToPrintable(this->FileName + (": " + warning)));
  }
}

//------------------------------------------------------------------------------
// Slices of the stack from index shown on are blank.
void vtkLacunaTrackedSliceReader::ReadPixels(
  vtkImageData* output, int shown, lacuna::AlgorithmExecution& execution)
{
  Sequence& sequence = *this->Opened;
  int extent[6];
  output->GetExtent(extent);
  const int type = lacuna::ArrayScalarType::ToVTK(sequence.File->Pixels->GetScalarType());
  lacuna::RequireMemory("the pixels of " + std::to_string(extent[5] - extent[4] + 1) + " slices",
    static_cast<double>(output->GetNumberOfPoints()) * vtkDataArray::GetDataTypeSize(type));
  vtkDataArray* scalars = lacuna::Arrays::AddScalars(output, type, IntensityName);
  auto* pixels = static_cast<unsigned char*>(scalars->GetVoidPointer(0));

  // A replay goes on where it was.
  const auto sliceSize = static_cast<std::size_t>(extent[1] - extent[0] + 1) *
    static_cast<std::size_t>(extent[3] - extent[2] + 1) *
    static_cast<std::size_t>(scalars->GetDataTypeSize());
  const auto at = [&](int k) { return static_cast<std::size_t>(k - extent[4]) * sliceSize; };
  int known = extent[4];
  const int end = std::clamp(shown, extent[4], extent[5] + 1);
  if (sequence.Scalars && std::equal(extent, extent + 6, sequence.Extent))
  {
    known = std::clamp(sequence.Shown, extent[4], end);
    std::memcpy(pixels, sequence.Scalars->GetVoidPointer(0), at(known));
  }
  std::memset(pixels + at(end), 0, at(extent[5] + 1) - at(end));
  if (known < end)
  {
    const int part[6] = { extent[0], extent[1], extent[2], extent[3], known, end - 1 };
    sequence.File->Read(sequence.File->GetStack(), part, pixels + at(known), execution);
  }
  if (sequence.Replay)
  {
    sequence.Scalars = scalars;
    std::copy(extent, extent + 6, sequence.Extent);
    sequence.Shown = shown;
  }
}

//------------------------------------------------------------------------------
// Slices that have not been taken yet have no image.
void vtkLacunaTrackedSliceReader::HideSlices(vtkImageData* output, int shown) const
{
  const lacuna::SequenceFile::Choice& stack = this->Opened->File->GetStack();
  const vtkIdType last = stack.First + (shown - 1) * stack.Stride;
  vtkDataArray* all = output->GetFieldData()->GetArray(lacuna::TrackedSlices::SliceStatusName);
  vtkNew<vtkUnsignedCharArray> status;
  lacuna::Arrays::Copy(all, status);
  for (vtkIdType i = last + 1; i < status->GetNumberOfTuples(); ++i)
  {
    status->SetValue(
      i, static_cast<unsigned char>(status->GetValue(i) | lacuna::TrackedSlices::ImageInvalid));
  }
  output->GetFieldData()->AddArray(status);
}

//------------------------------------------------------------------------------
void vtkLacunaTrackedSliceReader::Make(
  const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  vtkInformation* info = ports.GetOutputInformation();
  auto* output = ports.GetOutput<vtkImageData>();
  output->SetOrigin(info->Get(vtkDataObject::ORIGIN()));
  output->SetSpacing(info->Get(vtkDataObject::SPACING()));
  output->SetExtent(ports.GetExtent().data());
  const int all = this->Opened->File->GetStack().Slices;
  int shown = all;
  if (this->Opened->Replay && info->Has(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP()))
  {
    const double time = info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP());
    shown = static_cast<int>(this->Opened->Replay->GetNumberOfSlices(time));
    output->GetInformation()->Set(
      vtkDataObject::DATA_TIME_STEP(), this->Opened->Replay->GetTimeBefore(time));
  }
  lacuna::Reading::Run(
    this->FileName, "", [this](unsigned long code) { this->SetErrorCode(code); },
    [&]
    {
      if (!this->Opened->Fields)
      {
        this->MakeFieldData();
      }
      output->GetFieldData()->ShallowCopy(this->Opened->Fields->GetFieldData());
      if (shown < all)
      {
        this->HideSlices(output, shown);
      }
      this->ReadPixels(output, shown, execution);
    });
}

//------------------------------------------------------------------------------
void vtkLacunaTrackedSliceReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->vtkLacunaAlgorithm::PrintSelf(os, indent);
  os << indent << "FileName: " << Text(this->FileName) << "\n";
  os << indent << "CalibrationFileName: " << Text(this->CalibrationFileName) << "\n";
}
