// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaTrackedSliceReader.h"

#include "lacunaPixelSource.h"
#include "lacunaSequenceHeader.h"
#include "lacunaSequenceText.h"
#include "lacunaSliceStack.h"
#include "lacunaSweep.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkErrorCode.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLacunaExecution.h"
#include "vtkLacunaFieldData.h"
#include "vtkLacunaProvenance.h"
#include "vtkLacunaScalarType.h"
#include "vtkLacunaTrackedSlices.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include <vtksys/SystemInformation.hxx>
#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <new>
#include <sstream>
#include <stdexcept>

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
  // Personal data stay in the file.
  if (lacuna::EqualsIgnoringCase(std::string_view(name).substr(0, 7), "Patient"))
  {
    return;
  }
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
  lacuna::SequenceHeader Header;
  std::unique_ptr<lacuna::PixelSource> Pixels;
  int First = 0; // slice at index 0 of the stack
  int Slices = 0;
};

vtkStandardNewMacro(vtkLacunaTrackedSliceReader);

//------------------------------------------------------------------------------
vtkLacunaTrackedSliceReader::vtkLacunaTrackedSliceReader()
{
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
void vtkLacunaTrackedSliceReader::OpenSequence(Sequence& sequence)
{
  sequence.Header = lacuna::ReadSequenceHeader(this->FileName);
  sequence.Pixels = lacuna::PixelSource::Open(sequence.Header);

  const auto frames = static_cast<int>(sequence.Header.Frames);
  const auto whole = static_cast<int>(sequence.Pixels->GetNumberOfWholeFrames());
  const int first = this->FrameRange[0];
  const int last = this->FrameRange[1] == -1 ? frames - 1 : this->FrameRange[1];
  if (first < 0 || last < first || last >= frames || first >= whole)
  {
    std::ostringstream message;
    message << this->FileName << ": FrameRange " << first << " " << this->FrameRange[1]
            << " does not fit; the file has the pixels of slices 0 to " << whole - 1
            << " (a last slice of -1 means the end)";
    throw std::runtime_error(message.str());
  }
  sequence.First = first;
  sequence.Slices = (std::min(last, whole - 1) - first) / this->FrameStride + 1;
}

//------------------------------------------------------------------------------
int vtkLacunaTrackedSliceReader::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  this->Opened.reset();
  this->SetErrorCode(vtkErrorCode::NoError);
  vtkInformation* info = outputs->GetInformationObject(0);
  if (!this->FileName || !this->FileName[0])
  {
    // Not yet an error: ParaView asks as soon as one of several properties is set.
    const int nothing[6] = { 0, -1, 0, -1, 0, -1 };
    info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), nothing, 6);
    return 1;
  }
  const int opened = vtkLacunaExecution::RunInformation(this, outputs,
    [&]
    {
      auto sequence = std::make_unique<Sequence>();
      this->OpenSequence(*sequence);
      const lacuna::SequenceHeader& header = sequence->Header;
      const int extent[6] = { 0, static_cast<int>(header.Columns) - 1, 0,
        static_cast<int>(header.Rows) - 1, 0, sequence->Slices - 1 };
      // z is the number of the slice in the file
      const double origin[3] = { 0, 0, static_cast<double>(sequence->First) };
      const double spacing[3] = { 1, 1, static_cast<double>(this->FrameStride) };
      info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
      info->Set(vtkDataObject::ORIGIN(), origin, 3);
      info->Set(vtkDataObject::SPACING(), spacing, 3);
      info->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1);
      vtkDataObject::SetPointDataActiveScalarInfo(
        info, vtkLacunaScalarType::ToVTK(sequence->Pixels->GetScalarType()), 1);
      this->Opened = std::move(sequence);
    });
  if (!opened)
  {
    this->SetErrorCode(vtksys::SystemTools::FileExists(this->FileName)
        ? vtkErrorCode::FileFormatError
        : vtkErrorCode::FileNotFoundError);
  }
  return opened;
}

//------------------------------------------------------------------------------
void vtkLacunaTrackedSliceReader::CheckMemory(const int extent[6]) const
{
  const double columns = static_cast<double>(extent[1]) - extent[0] + 1;
  const double rows = static_cast<double>(extent[3]) - extent[2] + 1;
  const double slices = static_cast<double>(extent[5]) - extent[4] + 1;
  const double mebibyte = 1024.0 * 1024.0;
  const auto elementSize =
    static_cast<double>(lacuna::GetScalarSize(this->Opened->Pixels->GetScalarType()));
  const double needed = columns * rows * slices * elementSize / mebibyte;
  double limit = this->MemoryLimit;
  if (this->MemoryLimit == 0)
  {
    vtksys::SystemInformation system;
    system.RunMemoryCheck();
    limit = static_cast<double>(system.GetTotalPhysicalMemory()); // MiB
  }
  if (needed > limit)
  {
    std::ostringstream message;
    message << this->FileName << ": " << slices << " slices of " << columns << " x " << rows
            << " pixels take " << static_cast<std::int64_t>(needed) + 1 << " MiB, but "
            << (this->MemoryLimit == 0 ? "the machine has " : "MemoryLimit is ") << limit
            << " MiB; read fewer slices by FrameRange or FrameStride";
    throw std::runtime_error(message.str());
  }
}

//------------------------------------------------------------------------------
std::string vtkLacunaTrackedSliceReader::DescribeParameters() const
{
  const lacuna::SequenceHeader& header = this->Opened->Header;
  std::ostringstream text;
  text << "FileName=" << BaseName(this->FileName)
       << " FileSize=" << vtksys::SystemTools::FileLength(header.DataFileName)
       << " CalibrationFileName=" << BaseName(this->CalibrationFileName)
       << " ImageFrame=" << Text(this->ImageFrame)
       << " ReferenceFrame=" << Text(this->ReferenceFrame) << " FrameRange=" << this->FrameRange[0]
       << "," << this->FrameRange[1] << " FrameStride=" << this->FrameStride
       << " DropInvalidSlices=" << (this->DropInvalidSlices ? 1 : 0);
  return text.str();
}

//------------------------------------------------------------------------------
void vtkLacunaTrackedSliceReader::WriteFieldData(vtkImageData* output)
{
  const lacuna::SequenceHeader& header = this->Opened->Header;
  lacuna::SweepOptions options;
  options.CalibrationFileName = Text(this->CalibrationFileName);
  options.ImageFrame = Text(this->ImageFrame);
  options.ReferenceFrame = Text(this->ReferenceFrame);
  options.DropInvalid = this->DropInvalidSlices;
  options.FramesWithPixels = this->Opened->Pixels->GetNumberOfWholeFrames();
  const lacuna::Sweep sweep = lacuna::BuildSweep(header, options);

  // The arrays of the contract come last: no field of the file takes their place.
  for (const auto& [name, value] : header.CustomFields)
  {
    AddStrings(output, name, { value });
  }
  for (const auto& [name, texts] : sweep.TextFields)
  {
    AddStrings(output, name, texts);
  }
  for (const auto& [name, matrices] : sweep.Transforms)
  {
    vtkLacunaFieldData::SetMatrices(output, name, matrices);
  }
  if (!sweep.ImageToProbe.empty())
  {
    vtkLacunaFieldData::SetMatrices(
      output, vtkLacunaTrackedSlices::ImageToProbeName, sweep.ImageToProbe);
  }
  vtkLacunaTrackedSlices::Write(
    output, sweep.ImageToReference, sweep.Timestamps, sweep.Status, sweep.FrameNumbers);
  vtkLacunaProvenance::Record(output, this, {},
    this->DescribeParameters() + (sweep.Chain.empty() ? "" : " Chain=" + sweep.Chain));

  std::vector<std::string> warnings = header.Warnings;
  if (!this->Opened->Pixels->GetWarning().empty())
  {
    warnings.push_back(this->Opened->Pixels->GetWarning());
  }
  warnings.insert(warnings.end(), sweep.Warnings.begin(), sweep.Warnings.end());
  for (const std::string& warning : warnings)
  {
    vtkWarningMacro(<< this->FileName << ": " << warning);
  }
}

//------------------------------------------------------------------------------
int vtkLacunaTrackedSliceReader::RequestData(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  if (!this->Opened)
  {
    vtkDataObject::GetData(outputs, 0)->Initialize();
    this->SetErrorCode(vtkErrorCode::NoFileNameError);
    vtkErrorMacro("FileName is not set; it must be a tracked sequence file (.mha, .mhd)");
    return 0;
  }
  return vtkLacunaExecution::Run(this, outputs,
    [&](vtkLacunaExecution& execution)
    {
      vtkInformation* info = outputs->GetInformationObject(0);
      vtkImageData* output = vtkImageData::GetData(outputs, 0);
      int extent[6];
      info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), extent);
      output->SetOrigin(info->Get(vtkDataObject::ORIGIN()));
      output->SetSpacing(info->Get(vtkDataObject::SPACING()));
      output->SetExtent(extent);
      try
      {
        this->WriteFieldData(output);
        if (output->GetNumberOfPoints() == 0)
        {
          return;
        }
        this->CheckMemory(extent);
        output->AllocateScalars(
          vtkLacunaScalarType::ToVTK(this->Opened->Pixels->GetScalarType()), 1);
        output->GetPointData()->GetScalars()->SetName(IntensityName);
        void* pixels = output->GetScalarPointer();
        if (!pixels)
        {
          throw std::bad_alloc();
        }
        lacuna::SliceRegion region;
        region.FirstColumn = extent[0];
        region.Columns = extent[1] - extent[0] + 1;
        region.FirstRow = extent[2];
        region.Rows = extent[3] - extent[2] + 1;
        region.FrameStride = this->FrameStride;
        region.FirstFrame = this->Opened->First + std::int64_t{ extent[4] } * this->FrameStride;
        region.Frames = extent[5] - extent[4] + 1;
        lacuna::ReadSliceStack(
          this->Opened->Header, *this->Opened->Pixels, region, pixels, execution);
      }
      catch (const lacuna::Aborted&)
      {
        throw;
      }
      catch (const std::exception&)
      {
        this->SetErrorCode(vtkErrorCode::FileFormatError);
        throw;
      }
    });
}

//------------------------------------------------------------------------------
void vtkLacunaTrackedSliceReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << Text(this->FileName) << "\n";
  os << indent << "CalibrationFileName: " << Text(this->CalibrationFileName) << "\n";
  os << indent << "ImageFrame: " << Text(this->ImageFrame) << "\n";
  os << indent << "ReferenceFrame: " << Text(this->ReferenceFrame) << "\n";
  os << indent << "FrameRange: " << this->FrameRange[0] << " " << this->FrameRange[1] << "\n";
  os << indent << "FrameStride: " << this->FrameStride << "\n";
  os << indent << "DropInvalidSlices: " << (this->DropInvalidSlices ? "on" : "off") << "\n";
  os << indent << "MemoryLimit: " << this->MemoryLimit << "\n";
}
