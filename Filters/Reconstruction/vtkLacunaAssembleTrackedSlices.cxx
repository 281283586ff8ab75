// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaAssembleTrackedSlices.h"

#include "lacunaFieldData.h"
#include "lacunaPoseRecords.h"
#include "lacunaPrintableText.h"
#include "lacunaStackPixels.h"
#include "lacunaTrackedSlices.h"
#include "lacunaVolumeDirection.h"
#include "vtkAlgorithmOutput.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkTable.h"

#include <algorithm>
#include <array>
#include <stdexcept>

using SDDP = vtkStreamingDemandDrivenPipeline;

namespace
{
constexpr const char* IntensityName = "Intensity";
constexpr const char* ProbeToReferenceName = "ProbeToReference";
constexpr const char* GateName = "Gate";
constexpr std::array<const char*, 3> RowOrderNames{ "Automatic", "TopRowFirst", "BottomRowFirst" };

std::array<int, 6> GetExtent(vtkInformation* info, vtkInformationIntegerVectorKey* key)
{
  std::array<int, 6> extent;
  info->Get(key, extent.data());
  return extent;
}
}

vtkStandardNewMacro(vtkLacunaAssembleTrackedSlices);

//------------------------------------------------------------------------------
vtkLacunaAssembleTrackedSlices::vtkLacunaAssembleTrackedSlices()
{
  this->Sharing = lacuna::Share::Parts;
  this->TakesEmpty = true;  // an error
  this->KeepsPlace = false; // columns, rows and slices, whatever the pictures' are
  this->SetNumberOfInputPorts(2);
}

//------------------------------------------------------------------------------
void vtkLacunaAssembleTrackedSlices::SetPixelSpacing(double columns, double rows)
{
  this->SetPixelSpacingAt(0, columns);
  this->SetPixelSpacingAt(1, rows);
}

//------------------------------------------------------------------------------
void vtkLacunaAssembleTrackedSlices::SetNumberOfPixelSpacings(int) {}

//------------------------------------------------------------------------------
void vtkLacunaAssembleTrackedSlices::SetPixelSpacingAt(int i, double spacing)
{
  // The first number alone stands for both.
  for (int axis = i; axis < 2; ++axis)
  {
    if (axis >= 0 && this->PixelSpacing[axis] != spacing)
    {
      this->PixelSpacing[axis] = spacing;
      this->Modified();
    }
  }
}

//------------------------------------------------------------------------------
void vtkLacunaAssembleTrackedSlices::SetImageToProbe(const double elements[16])
{
  if (!std::equal(elements, elements + 16, this->ImageToProbe))
  {
    std::copy(elements, elements + 16, this->ImageToProbe);
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkLacunaAssembleTrackedSlices::SetNumberOfPoseColumns(int count)
{
  const auto size = static_cast<std::size_t>(std::max(0, count));
  if (size != this->PoseColumns.size())
  {
    this->PoseColumns.resize(size);
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkLacunaAssembleTrackedSlices::SetPoseColumn(int i, const char* name)
{
  const std::string text = name ? name : "";
  if (i < 0)
  {
    return;
  }
  if (i >= this->GetNumberOfPoseColumns())
  {
    this->SetNumberOfPoseColumns(i + 1);
  }
  if (this->PoseColumns[i] != text)
  {
    this->PoseColumns[i] = text;
    this->Modified();
  }
}

//------------------------------------------------------------------------------
const char* vtkLacunaAssembleTrackedSlices::GetPoseColumn(int i) const
{
  return i >= 0 && i < this->GetNumberOfPoseColumns() ? this->PoseColumns[i].c_str() : nullptr;
}

//------------------------------------------------------------------------------
int vtkLacunaAssembleTrackedSlices::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), port == 0 ? "vtkImageData" : "vtkTable");
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaAssembleTrackedSlices::Announce(const lacuna::Ports& ports)
{
  vtkInformation* in = ports.GetInputInformation();
  vtkInformation* out = ports.GetOutputInformation();
  std::array<int, 6> extent = GetExtent(in, SDDP::WHOLE_EXTENT());
  this->TimeSteps.clear();
  if (extent[4] == extent[5] && in->Has(SDDP::TIME_STEPS()) && in->Length(SDDP::TIME_STEPS()) > 1)
  {
    const double* times = in->Get(SDDP::TIME_STEPS());
    this->TimeSteps.assign(times, times + in->Length(SDDP::TIME_STEPS()));
    extent[4] = 0;
    extent[5] = in->Length(SDDP::TIME_STEPS()) - 1;
    out->Remove(SDDP::TIME_STEPS());
    out->Remove(SDDP::TIME_RANGE());
  }
  out->Set(SDDP::WHOLE_EXTENT(), extent.data(), 6);
  const double rows = this->RowOrder == BottomRowFirst ? -extent[2] : 0;
  out->Set(vtkDataObject::ORIGIN(), 0.0, rows, -static_cast<double>(extent[4]));
  out->Set(vtkDataObject::SPACING(), 1.0, 1.0, 1.0);
  lacuna::VolumeDirection::AnnounceAlongAxes(out);
  vtkImageData* stack = vtkImageData::GetData(in);
  if (stack && stack->GetNumberOfPoints() > 0 && !stack->GetPointData()->GetScalars())
  {
    // VTK announces double where no array is active; the only one is taken, whatever its type
    out->Remove(vtkDataObject::POINT_DATA_VECTOR());
  }
  else if (vtkInformation* scalars = vtkDataObject::GetActiveFieldInformation(
             in, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::SCALARS))
  {
    vtkDataObject::SetPointDataActiveScalarInfo(
      out, scalars->Get(vtkDataObject::FIELD_ARRAY_TYPE()), 1);
  }
}

//------------------------------------------------------------------------------
void vtkLacunaAssembleTrackedSlices::Ask(const lacuna::Ports& ports)
{
  this->AskForWhole(ports.GetInputInformation(1)); // the table
  vtkInformation* in = ports.GetInputInformation();
  const std::array<int, 6> wanted = GetPart(ports.GetOutputInformation());
  // Whole pictures: which rows are wanted is known when the order of rows is.
  std::array<int, 6> extent = GetExtent(in, SDDP::WHOLE_EXTENT());
  if (this->TimeSteps.empty())
  {
    extent[4] = wanted[4];
    extent[5] = wanted[5];
  }
  else
  {
    // the first picture; Make asks for the others
    const auto last = static_cast<int>(this->TimeSteps.size()) - 1;
    in->Set(SDDP::UPDATE_TIME_STEP(), this->TimeSteps[std::max(0, std::min(wanted[4], last))]);
  }
  if (wanted[0] > wanted[1] || wanted[2] > wanted[3] || wanted[4] > wanted[5])
  {
    extent = { 0, -1, 0, -1, 0,
      -1 }; // also no columns and rows, which others would take for wanted
  }
  this->AskFor(in, extent);
}

//------------------------------------------------------------------------------
void vtkLacunaAssembleTrackedSlices::Make(
  const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* stack = ports.GetInput<vtkImageData>();
  auto* output = ports.GetOutput<vtkImageData>();
  vtkInformation* info = ports.GetOutputInformation();
  this->Source = nullptr;
  output->GetFieldData()->Initialize(); // VTK passes the stack's own
  this->CollectPixels(stack, info, output, execution);
  this->Assemble(stack, ports.GetInput<vtkTable>(1), info, output);
}

//------------------------------------------------------------------------------
std::vector<vtkDataObject*> vtkLacunaAssembleTrackedSlices::GetOrigins(
  const lacuna::Ports& ports) const
{
  return { this->Source, ports.GetInput<vtkDataObject>(1) };
}

//------------------------------------------------------------------------------
void vtkLacunaAssembleTrackedSlices::CollectPixels(vtkImageData* stack, vtkInformation* info,
  vtkImageData* output, lacuna::AlgorithmExecution& execution)
{
  std::array<int, 6> wanted = GetExtent(info, SDDP::UPDATE_EXTENT());
  output->SetExtent(wanted.data());
  output->SetOrigin(info->Get(vtkDataObject::ORIGIN()));
  output->SetSpacing(1, 1, 1);
  if (output->GetNumberOfPoints() == 0)
  {
    return;
  }
  vtkDataArray* pixels = lacuna::StackPixels::Find(stack);
  const bool flip = this->RowOrder == BottomRowFirst ||
    (this->RowOrder == Automatic && lacuna::StackPixels::IsBottomRowFirst(pixels));
  const std::array<int, 6> whole = GetExtent(info, SDDP::WHOLE_EXTENT());
  if (flip && this->RowOrder == Automatic && whole[2] != 0)
  {
    throw std::runtime_error("the pictures are a part of larger ones (from row " +
      std::to_string(whole[2]) +
      " on): what is their top row is not known; set RowOrder to BottomRowFirst if it is their "
      "last one");
  }
  vtkSmartPointer<vtkDataArray> grey;
  if (this->TimeSteps.empty() && !flip && pixels->GetNumberOfComponents() == 1 &&
    std::equal(wanted.begin(), wanted.end(), stack->GetExtent()))
  {
    grey.TakeReference(pixels->NewInstance());
    grey->ShallowCopy(pixels);
  }
  else
  {
    grey = lacuna::StackPixels::Allocate(pixels, wanted);
    const int count = this->TimeSteps.empty() ? wanted[5] - wanted[4] + 1 : 1;
    for (int k = wanted[4]; k <= wanted[5]; k += count)
    {
      if (!this->TimeSteps.empty())
      {
        stack = this->UpdatePicture(k);
      }
      lacuna::StackPixels::Copy(stack, this->TimeSteps.empty() ? k : stack->GetExtent()[4], count,
        flip, { whole[2], whole[3] }, grey, wanted, k);
      execution.Report((k - wanted[4]) / (wanted[5] - wanted[4] + 1.0));
    }
  }
  grey->SetName(IntensityName);
  output->GetPointData()->SetScalars(grey);
}

//------------------------------------------------------------------------------
vtkImageData* vtkLacunaAssembleTrackedSlices::UpdatePicture(int step)
{
  // Not by CONTINUE_EXECUTING: with it VTK asks for ever for a picture that cannot be had.
  vtkAlgorithmOutput* connection = this->GetInputConnection(0, 0);
  vtkAlgorithm* producer = connection->GetProducer();
  const int port = connection->GetIndex();
  vtkNew<vtkInformationVector> requests;
  requests->SetNumberOfInformationObjects(producer->GetNumberOfOutputPorts());
  vtkInformation* info = requests->GetInformationObject(port);
  info->Set(SDDP::UPDATE_TIME_STEP(), this->TimeSteps[step]);
  this->AskForWhole(info);
  auto* picture = producer->Update(port, requests)
    ? vtkImageData::SafeDownCast(producer->GetOutputDataObject(port))
    : nullptr;
  if (!picture || picture->GetNumberOfPoints() == 0)
  {
    throw std::runtime_error("there is no picture at time step " + std::to_string(step) +
      " (time " + std::to_string(this->TimeSteps[step]) + ")");
  }
  return picture;
}

//------------------------------------------------------------------------------
void vtkLacunaAssembleTrackedSlices::Assemble(
  vtkImageData* stack, vtkTable* table, vtkInformation* info, vtkImageData* output)
{
  const std::array<int, 6> whole = GetExtent(info, SDDP::WHOLE_EXTENT());
  const auto slices = static_cast<std::size_t>(whole[5] - whole[4]) + 1;
  lacuna::PoseRequest request;
  request.Poses.Format = static_cast<lacuna::PoseFormat>(this->PoseFormat);
  request.Poses.Transform = static_cast<lacuna::PoseTransform>(this->PoseTransform);
  request.Poses.Unit = static_cast<lacuna::LengthUnit>(this->LengthUnit);
  request.Poses.PixelSpacing = { this->PixelSpacing[0], this->PixelSpacing[1] };
  request.Poses.ImageToProbe = lacuna::Matrix4(this->ImageToProbe);
  request.Poses.SkipInvalid = this->SkipInvalidPoses;
  request.PoseColumns = this->PoseColumns;
  request.FrameColumn = this->FrameColumn;
  request.TimestampColumn = this->TimestampColumn;
  request.StatusColumn = this->StatusColumn;
  request.GateColumn = this->GateColumn;
  request.MatchBy = this->MatchBy;
  std::copy(this->GateRange, this->GateRange + 2, request.GateRange);
  request.FirstFrameNumber = this->FirstFrameNumber;
  request.TimeOffset = this->TimeOffset;
  request.MaximumTimeGap = this->MaximumTimeGap;

  const lacuna::PoseChain chain = lacuna::MakePoseChain(request.Poses);
  const lacuna::PoseRecords records(table, slices, this->GetSliceTimes(stack, slices), request);
  if (!chain.Warning.empty())
  {
    vtkWarningMacro(<< lacuna::ToPrintable(chain.Warning));
  }
  for (const std::string& warning : records.Warnings)
  {
    vtkWarningMacro(<< lacuna::ToPrintable(warning));
  }
  std::vector<lacuna::Matrix4> poses;
  for (const lacuna::Matrix4& pose : records.ToReference)
  {
    poses.push_back(pose * chain.PixelToPose);
  }
  if (!chain.Calibrated)
  {
    poses.clear();
    vtkWarningMacro("the probe is not calibrated: PixelSpacing is 0 and ImageToProbe the identity. "
                    "The slices have no ImageToReference; filters that need to know where they lie "
                    "refuse them. Set PixelSpacing, and ImageToProbe");
  }
  if (this->PoseTransform == ProbeToReference || this->PoseTransform == ReferenceToProbe)
  {
    lacuna::FieldData::SetMatrices(output, ProbeToReferenceName, records.ToReference);
  }
  if (chain.HasImageToProbe)
  {
    lacuna::FieldData::SetMatrices(
      output, lacuna::TrackedSlices::ImageToProbeName, { chain.ImageToProbe });
  }
  if (!records.Gate.empty())
  {
    lacuna::FieldData::Set(output, GateName, records.Gate, 1);
  }
  lacuna::TrackedSlices::Write(output, poses, records.Times, records.Status, records.FrameNumbers);
  // The hash is that of all slices, also where they came one by one.
  this->Source = vtkSmartPointer<vtkImageData>::New();
  this->Source->SetExtent(output->GetExtent());
  this->Source->GetPointData()->SetScalars(output->GetPointData()->GetScalars());
  this->Source->SetFieldData(stack->GetFieldData());
}

//------------------------------------------------------------------------------
std::vector<double> vtkLacunaAssembleTrackedSlices::GetSliceTimes(
  vtkImageData* stack, std::size_t slices) const
{
  std::vector<double> times;
  if (this->FrameRate > 0)
  {
    for (std::size_t i = 0; i < slices; ++i)
    {
      times.push_back(static_cast<double>(i) / this->FrameRate);
    }
    return times;
  }
  vtkDataArray* array = stack->GetFieldData()->GetArray(lacuna::TrackedSlices::TimestampName);
  if (array && array->GetNumberOfComponents() == 1 &&
    array->GetNumberOfTuples() == static_cast<vtkIdType>(slices))
  {
    for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i)
    {
      times.push_back(array->GetTuple1(i));
    }
    return times;
  }
  // Time steps of picture series are often mere numbers: they are taken for times only on demand.
  return this->MatchBy == Time ? this->TimeSteps : times;
}

//------------------------------------------------------------------------------
void vtkLacunaAssembleTrackedSlices::Describe(lacuna::Properties& properties) const
{
  using lacuna::ValueRange;
  properties.Add("PoseFormat", this->PoseFormat, lacuna::PoseFormatNames)
    .Add("PoseTransform", this->PoseTransform, lacuna::PoseTransformNames)
    .Add("LengthUnit", this->LengthUnit, lacuna::LengthUnitNames)
    .Add("PixelSpacing", this->PixelSpacing, ValueRange::Above(0, "mm").OrZero("of ImageToProbe"))
    .Add("ImageToProbe", this->ImageToProbe)
    .Add("RowOrder", this->RowOrder, RowOrderNames)
    .Add("MatchBy", this->MatchBy, lacuna::PoseRequest::MatchingNames)
    .Add("PoseColumns", this->PoseColumns)
    .Add("FrameColumn", this->FrameColumn)
    .Add("TimestampColumn", this->TimestampColumn)
    .Add("StatusColumn", this->StatusColumn)
    .Add("GateColumn", this->GateColumn)
    .Add("GateRange", this->GateRange)
    .Add("FirstFrameNumber", this->FirstFrameNumber)
    .Add("FrameRate", this->FrameRate, ValueRange::Above(0, "1/s").OrZero("times of the file"))
    .Add("TimeOffset", this->TimeOffset, ValueRange::Any("s"))
    .Add("MaximumTimeGap", this->MaximumTimeGap, ValueRange::AtLeast(0, "s"))
    .Add("SkipInvalidPoses", this->SkipInvalidPoses);
}
