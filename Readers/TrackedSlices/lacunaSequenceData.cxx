// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSequenceData.h"

#include "lacunaArrayScalarType.h"
#include "lacunaFieldData.h"
#include "lacunaParameterText.h"
#include "lacunaPatientIdentity.h"
#include "lacunaPixelSpacing.h"
#include "lacunaPoseFields.h"
#include "lacunaProvenance.h"
#include "lacunaSequenceFormat.h"
#include "lacunaSequenceNames.h"
#include "lacunaSequenceText.h"
#include "lacunaTrackedSlices.h"
#include "lacunaTransformGraph.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkLacunaSliceStream.h"
#include "vtkPointData.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <set>
#include <stdexcept>
#include <vector>

namespace
{
// The slices of a stream one by one, as the writer takes them: reads some at a time and keeps them
// until others are asked for. Copies share them.
class StreamedPixels
{
public:
  // Both must outlive this object.
  StreamedPixels(vtkLacunaSliceStream* stream, lacuna::Execution& execution);

  // Pixels of a slice, counted from 0; valid until the next call.
  const void* operator()(std::int64_t slice) const;

private:
  struct Part
  {
    std::vector<unsigned char> Pixels;
    std::int64_t First = 0;
    std::int64_t Count = 0;
  };
  vtkLacunaSliceStream* Stream;
  lacuna::Execution* Execution;
  std::shared_ptr<Part> Loaded;
};

//------------------------------------------------------------------------------
StreamedPixels::StreamedPixels(vtkLacunaSliceStream* stream, lacuna::Execution& execution)
  : Stream(stream)
  , Execution(&execution)
  , Loaded(std::make_shared<Part>())
{
}

//------------------------------------------------------------------------------
const void* StreamedPixels::operator()(std::int64_t slice) const
{
  Part& part = *this->Loaded;
  const auto sliceSize = static_cast<std::size_t>(this->Stream->GetSliceSize());
  if (slice < part.First || slice >= part.First + part.Count)
  {
    const int* extent = this->Stream->GetExtent();
    const std::int64_t all = extent[5] - extent[4] + 1;
    part.First = slice;
    part.Count = std::min<std::int64_t>(this->Stream->GetSlicesAtATime(), all - slice);
    part.Pixels.resize(static_cast<std::size_t>(part.Count) * sliceSize);
    // reading does not move the progress of writing
    const double progress = static_cast<double>(slice) / static_cast<double>(all);
    this->Execution->SetStage(progress, progress);
    const int first = extent[4] + static_cast<int>(slice);
    this->Stream->Read(
      first, first + static_cast<int>(part.Count) - 1, part.Pixels.data(), *this->Execution);
    this->Execution->SetStage(0, 1);
  }
  return part.Pixels.data() + static_cast<std::size_t>(slice - part.First) * sliceSize;
}

//------------------------------------------------------------------------------
constexpr const char* TransformSuffix = "Transform";
constexpr const char* StatusSuffix = "TransformStatus";
constexpr const char* ImageStatus = "ImageStatus";
constexpr double MostPixels = 1e9;

// Arrays that are written in a way of their own.
const std::set<std::string> OwnNames = { lacuna::TrackedSlices::ImageToReferenceName,
  lacuna::TrackedSlices::ImageToProbeName, lacuna::TrackedSlices::TimestampName,
  lacuna::TrackedSlices::SliceStatusName, lacuna::TrackedSlices::FrameNumberName,
  lacuna::TrackedSlices::PreviewName, lacuna::TrackedSlices::GrowingName,
  lacuna::Provenance::ArrayName, lacuna::SequenceNames::Frames, lacuna::SequenceNames::ImageType,
  lacuna::SequenceNames::Orientation, ImageStatus };

// Arrays that give the size of the pixels.
const std::set<std::string> PixelSpacingNames = { lacuna::PixelSpacingField, "PixelSpacingMm" };

std::string GetString(vtkImageData* stack, const char* name, vtkIdType i)
{
  auto* array = vtkStringArray::SafeDownCast(stack->GetFieldData()->GetAbstractArray(name));
  return array && i < array->GetNumberOfValues() ? std::string(array->GetValue(i)) : std::string();
}

std::string FormatTuple(vtkDataArray* array, vtkIdType i)
{
  std::string text;
  for (int c = 0; c < array->GetNumberOfComponents(); ++c)
  {
    text += (c > 0 ? " " : "") + lacuna::FormatNumber(array->GetComponent(i, c));
  }
  return text;
}

// The factor of the third column when pixels become spacing times as large. The column places no pixel, but
// readers compare it with the others: where it was as long as their mean it must stay so.
double GetDepthScale(vtkImageData* stack, vtkIdType count, const double* spacing)
{
  vtkDataArray* poses =
    lacuna::FieldData::Find(stack, lacuna::TrackedSlices::ImageToReferenceName, 16, count);
  const bool isSampled = spacing[0] != 1 || spacing[1] != 1;
  for (vtkIdType slice = 0; poses && isSampled && slice < count; ++slice)
  {
    const lacuna::Matrix4 matrix = lacuna::FieldData::GetMatrix(poses, slice);
    if (matrix.IsFinite())
    {
      const double x = lacuna::Norm(matrix.Column(0));
      const double y = lacuna::Norm(matrix.Column(1));
      const double z = lacuna::Norm(matrix.Column(2));
      const bool isMean = std::abs(z - (x + y) / 2) <= 1e-3 * z;
      const bool isGeometric = std::abs(z - std::sqrt(x * y)) <= 1e-3 * z;
      return isMean ? (spacing[0] * x + spacing[1] * y) / (2 * z)
                    : (isGeometric ? std::sqrt(spacing[0] * spacing[1]) : 1);
    }
  }
  return 1;
}
}

//------------------------------------------------------------------------------
lacuna::SequenceData::SequenceData(vtkImageData* stack, const lacuna::SequenceKind& kind,
  vtkLacunaSliceStream* stream, bool keepPatientIdentity, lacuna::Execution& execution)
  : Stack(stack)
  , Whole(stream ? Place{ stream->GetExtent(), stream->GetOrigin(), stream->GetSpacing() }
                 : Place{ stack->GetExtent(), stack->GetOrigin(), stack->GetSpacing() })
  , Fields(kind, this->Content, this->Warnings)
  , KeepPatientIdentity(keepPatientIdentity)
{
  this->FindSlices();
  this->FindPixels();
  const std::string preview = GetString(stack, lacuna::TrackedSlices::PreviewName, 0);
  if (stream)
  {
    this->Content.GetPixels = StreamedPixels(stream, execution);
  }
  else if (!preview.empty())
  {
    this->Warnings.push_back("the input is made of " + preview);
  }
  this->AddArrays();
  this->AddStates();
  this->AddPoses();
  this->AddProvenance();
  this->Fields.CheckLines();
}

//------------------------------------------------------------------------------
void lacuna::SequenceData::FindSlices()
{
  vtkDataArray* status =
    lacuna::FieldData::Find(this->Stack, lacuna::TrackedSlices::SliceStatusName, 1, -1);
  if (!status)
  {
    throw std::runtime_error("the input is not a stack of tracked slices: it has no field data "
                             "array 'SliceStatus'; write other images with ParaView's own writers");
  }
  this->Count = status->GetNumberOfTuples();
  const auto [extent, origin, spacing] = this->Whole;
  for (int k = extent[4]; k <= extent[5]; ++k)
  {
    this->Slices.push_back(
      lacuna::TrackedSlices::GetSliceNumber(origin[2] + spacing[2] * k, this->Count));
    this->Status.push_back(static_cast<unsigned char>(status->GetTuple1(this->Slices.back())));
  }
  this->Content.Frames.resize(this->Slices.size());

  this->PixelToImage = lacuna::Matrix4::Translation({ origin[0] + spacing[0] * extent[0],
                         origin[1] + spacing[1] * extent[2], 0 }) *
    lacuna::Matrix4::Scaling(
      { spacing[0], spacing[1], GetDepthScale(this->Stack, this->Count, spacing) });
  this->Cropped = !lacuna::IsNear(this->PixelToImage, lacuna::Matrix4());
  const std::string image = GetString(this->Stack, lacuna::SequenceNames::Frames, 0);
  const std::string reference = GetString(this->Stack, lacuna::SequenceNames::Frames, 1);
  this->ImageFrame = image.empty() ? this->ImageFrame : image;
  this->ReferenceFrame = reference.empty() ? this->ReferenceFrame : reference;
  if (this->ImageFrame == lacuna::CroppedImageFrame)
  {
    const std::string name =
      std::string(lacuna::WholeImageFrame) + "To" + lacuna::CroppedImageFrame;
    this->Crops = lacuna::FieldData::Find(this->Stack, name, 16, this->Count);
  }
  this->SayWindow();
}

//------------------------------------------------------------------------------
// Whole pixels of the scanner's picture: the header says where they begin, so that a calibration of
// the picture holds.
void lacuna::SequenceData::SayWindow()
{
  const lacuna::Vec3 first = this->PixelToImage.Column(3);
  const bool whole = first[0] == std::floor(first[0]) && first[1] == std::floor(first[1]) &&
    std::abs(first[0]) < MostPixels && std::abs(first[1]) < MostPixels;
  this->Windowed = this->Cropped && whole && this->ImageFrame == "Image" &&
    lacuna::IsNear(this->PixelToImage, lacuna::Matrix4::Translation(first));
  if (this->Windowed)
  {
    this->Fields.AddToHeader(
      lacuna::FirstColumnField, std::to_string(static_cast<std::int64_t>(first[0])));
    this->Fields.AddToHeader(
      lacuna::FirstRowField, std::to_string(static_cast<std::int64_t>(first[1])));
  }
}

//------------------------------------------------------------------------------
void lacuna::SequenceData::FindPixels()
{
  vtkDataArray* scalars = this->Stack->GetPointData()->GetScalars();
  if (!scalars || scalars->GetNumberOfComponents() != 1 ||
    scalars->GetNumberOfTuples() != this->Stack->GetNumberOfPoints())
  {
    throw std::runtime_error("tracked slices must have active point scalars: one grey level for "
                             "each pixel");
  }
  const int* size = this->Stack->GetDimensions();
  lacuna::SequenceDescription& description = this->Content.Description;
  description.Columns = size[0];
  description.Rows = size[1];
  description.Type = lacuna::ArrayScalarType::Get(scalars);
  const std::string type = GetString(this->Stack, lacuna::SequenceNames::ImageType, 0);
  description.ImageType = type.empty() ? description.ImageType : type;
  description.ScanLines = GetString(this->Stack, lacuna::SequenceNames::Orientation, 0) == "FM";
  const auto* pixels = static_cast<const unsigned char*>(scalars->GetVoidPointer(0));
  const std::size_t sliceSize = static_cast<std::size_t>(description.Columns * description.Rows) *
    lacuna::GetScalarSize(description.Type);
  this->Content.GetPixels = [pixels, sliceSize](std::int64_t frame)
  { return pixels + static_cast<std::size_t>(frame) * sliceSize; };
  this->PosesOnly = size[0] == 1 && size[1] == 1 &&
    !this->Stack->GetFieldData()->GetAbstractArray(ImageStatus) &&
    std::all_of(this->Status.begin(), this->Status.end(),
      [](unsigned char status) { return status & lacuna::TrackedSlices::ImageInvalid; });
}

//------------------------------------------------------------------------------
void lacuna::SequenceData::AddArrays()
{
  vtkFieldData* fields = this->Stack->GetFieldData();
  for (int i = 0; i < fields->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = fields->GetAbstractArray(i);
    if (array && array->GetName() && OwnNames.count(array->GetName()) == 0)
    {
      this->AddArray(array);
    }
  }
  vtkDataArray* imageToProbe =
    lacuna::FieldData::Find(this->Stack, lacuna::TrackedSlices::ImageToProbeName, 16, 1);
  const std::string frame = this->Crops ? lacuna::WholeImageFrame : this->ImageFrame;
  if (imageToProbe && !this->Fields.Find(0, frame + "ToProbeTransform"))
  {
    this->AddTransform(imageToProbe);
  }
}

//------------------------------------------------------------------------------
void lacuna::SequenceData::AddArray(vtkAbstractArray* array)
{
  const std::string name = array->GetName();
  const vtkIdType tuples = array->GetNumberOfTuples();
  auto* numbers = vtkDataArray::SafeDownCast(array);
  auto* strings = vtkStringArray::SafeDownCast(array);
  const bool transform = numbers && array->GetNumberOfComponents() == 16; // of the patient's frame?
  std::vector<std::string> texts;
  for (vtkIdType i = 0; strings && i < strings->GetNumberOfValues(); ++i)
  {
    texts.push_back(strings->GetValue(i));
  }
  const bool identifies =
    strings ? lacuna::IdentifiesPatient(name, texts) : lacuna::IdentifiesPatient(name);
  if (!this->KeepPatientIdentity && !transform && identifies)
  {
    this->Warnings.push_back("field data array '" + name +
      "' is not written: it may identify the patient. Set KeepPatientIdentity to write it");
    return;
  }
  if ((tuples != this->Count && tuples != 1) || (!numbers && !strings) ||
    (strings && array->GetNumberOfComponents() != 1))
  {
    this->Warnings.push_back("field data array '" + name + "' is not written: it has " +
      std::to_string(tuples) +
      " tuples; a sequence has fields for the whole (1) or for each of the " +
      std::to_string(this->Count) + " slices");
  }
  else if (strings)
  {
    this->AddStrings(strings);
  }
  else if (array->GetNumberOfComponents() == 16)
  {
    this->AddTransform(numbers);
  }
  else
  {
    this->AddNumbers(numbers);
  }
}

//------------------------------------------------------------------------------
void lacuna::SequenceData::AddStrings(vtkStringArray* array)
{
  const std::string name = array->GetName();
  if (array->GetNumberOfValues() != this->Count)
  {
    this->Fields.AddToHeader(name, array->GetValue(0));
    return;
  }
  if (lacuna::EndsWithIgnoringCase(name, StatusSuffix))
  {
    const std::string transform = name.substr(0, name.size() - std::string(StatusSuffix).size());
    vtkDataArray* matrices = this->Stack->GetFieldData()->GetArray(transform.c_str());
    if (matrices && matrices->GetNumberOfComponents() == 16 &&
      matrices->GetNumberOfTuples() == this->Count && OwnNames.count(transform) == 0)
    {
      return; // comes with its transform
    }
  }
  std::vector<std::string> texts = this->GetTexts(name);
  if (this->Cropped && lacuna::EndsWithIgnoringCase(name, TransformSuffix))
  {
    const std::string transform = name.substr(0, name.size() - std::string(TransformSuffix).size());
    for (std::string& text : texts)
    {
      lacuna::Matrix4 matrix;
      if (lacuna::ParseMatrix(text, matrix).empty())
      {
        text = lacuna::FormatMatrix(this->ToPixels(transform, matrix));
      }
    }
  }
  if (PixelSpacingNames.count(name) > 0)
  {
    std::transform(texts.begin(), texts.end(), texts.begin(),
      [&](const std::string& text) { return this->ToPixelSpacing(text); });
  }
  this->Fields.AddToFrames(name, texts);
}

//------------------------------------------------------------------------------
// Of the pixels as they are now: of a stack of every second column they are twice as wide.
std::string lacuna::SequenceData::ToPixelSpacing(const std::string& text) const
{
  const lacuna::Vec2 said = lacuna::ReadPixelSpacing(text);
  const lacuna::Vec2 scale = lacuna::GetPixelSpacing(this->PixelToImage);
  if (!lacuna::IsPixelSpacing(said))
  {
    return std::isnan(said[0]) && std::isnan(said[1]) ? std::string() : text;
  }
  return !lacuna::SaysPixelSpacing(said) || !lacuna::SaysPixelSpacing(scale)
    ? text
    : lacuna::FormatNumber(said[0] * scale[0]) + " " + lacuna::FormatNumber(said[1] * scale[1]);
}

//------------------------------------------------------------------------------
void lacuna::SequenceData::AddNumbers(vtkDataArray* array)
{
  if (array->GetNumberOfTuples() != this->Count)
  {
    this->Fields.AddToHeader(array->GetName(), FormatTuple(array, 0));
    return;
  }
  std::vector<std::string> texts;
  for (const vtkIdType slice : this->Slices)
  {
    const std::string text = FormatTuple(array, slice);
    texts.push_back(
      PixelSpacingNames.count(array->GetName()) > 0 ? this->ToPixelSpacing(text) : text);
  }
  this->Fields.AddToFrames(array->GetName(), texts);
}

//------------------------------------------------------------------------------
// Every transform has a status; one that is not OK may have no matrix.
void lacuna::SequenceData::AddTransform(vtkDataArray* array)
{
  const bool imageToProbe =
    std::string(array->GetName()) == lacuna::TrackedSlices::ImageToProbeName;
  // of the whole image, so that another calibration can take its place
  const bool ofWhole = imageToProbe && this->Crops;
  const std::string name = !imageToProbe ? std::string(array->GetName())
    : ofWhole                            ? std::string(lacuna::WholeImageFrame) + "ToProbe"
                                         : this->ImageFrame + "ToProbe";
  const bool constant = array->GetNumberOfTuples() != this->Count;
  const bool stated = !constant &&
    this->Stack->GetFieldData()->GetAbstractArray((name + StatusSuffix).c_str()) != nullptr;
  std::vector<std::string> states = this->GetTexts(name + StatusSuffix);
  std::vector<std::string> matrices;
  for (std::size_t i = 0; i < this->Slices.size(); ++i)
  {
    lacuna::Matrix4 matrix =
      this->ToPixels(name, lacuna::FieldData::GetMatrix(array, constant ? 0 : this->Slices[i]));
    if (ofWhole)
    {
      matrix = matrix * lacuna::FieldData::GetMatrix(this->Crops, this->Slices[i]);
    }
    const bool finite = matrix.IsFinite();
    matrices.push_back(finite ? lacuna::FormatMatrix(matrix) : std::string());
    if (!stated || states[i].empty())
    {
      states[i] = finite ? (stated ? "INVALID" : "OK") : (stated ? "" : "INVALID");
    }
    else if (!finite && states[i] == "OK")
    {
      states[i] = "INVALID";
    }
  }
  this->Fields.AddToFrames(name + TransformSuffix, matrices);
  this->Fields.AddToFrames(name + StatusSuffix, states);
}

//------------------------------------------------------------------------------
// Times, numbers and flags.
void lacuna::SequenceData::AddStates()
{
  vtkDataArray* times =
    lacuna::FieldData::Find(this->Stack, lacuna::TrackedSlices::TimestampName, 1, this->Count);
  vtkDataArray* numbers =
    lacuna::FieldData::Find(this->Stack, lacuna::TrackedSlices::FrameNumberName, 1, this->Count);
  vtkDataArray* poses = lacuna::FieldData::Find(
    this->Stack, lacuna::TrackedSlices::ImageToReferenceName, 16, this->Count);
  bool ownNumbers = false;
  std::vector<std::string> timeTexts(this->Slices.size());
  std::vector<std::string> numberTexts(this->Slices.size());
  std::vector<std::string> flagTexts(this->Slices.size());
  std::vector<std::string> imageTexts = this->GetTexts(ImageStatus);
  for (std::size_t i = 0; i < this->Slices.size(); ++i)
  {
    const vtkIdType slice = this->Slices[i];
    if (times && std::isfinite(times->GetTuple1(slice)))
    {
      timeTexts[i] = lacuna::FormatNumber(times->GetTuple1(slice));
    }
    if (numbers)
    {
      numberTexts[i] = lacuna::FormatNumber(numbers->GetTuple1(slice));
      ownNumbers = ownNumbers || numbers->GetTuple1(slice) != static_cast<double>(i);
    }
    // an invalid pose is told by its transforms, unless it has numbers nevertheless
    const bool toldElsewhere = !poses || !lacuna::FieldData::GetMatrix(poses, slice).IsFinite();
    const int own = ~(lacuna::TrackedSlices::ImageInvalid |
      (toldElsewhere ? lacuna::TrackedSlices::PoseInvalid : 0));
    if (this->Status[i] & own)
    {
      flagTexts[i] = std::to_string(this->Status[i]);
    }
    const bool invalid = (this->Status[i] & lacuna::TrackedSlices::ImageInvalid) != 0;
    if (imageTexts[i].empty() || (invalid && imageTexts[i] == "OK"))
    {
      imageTexts[i] = invalid ? "INVALID" : "OK";
    }
  }
  this->Fields.AddToFrames(lacuna::TrackedSlices::TimestampName, timeTexts);
  if (ownNumbers) // a frame without one is numbered by its place
  {
    this->Fields.AddToFrames(lacuna::TrackedSlices::FrameNumberName, numberTexts);
  }
  this->Fields.AddToFrames(lacuna::TrackedSlices::SliceStatusName, flagTexts);
  if (!this->PosesOnly)
  {
    this->Fields.AddToFrames(ImageStatus, imageTexts);
  }
}

//------------------------------------------------------------------------------
// The poses themselves are written when nothing else in the file tells them.
void lacuna::SequenceData::AddPoses()
{
  vtkDataArray* array = lacuna::FieldData::Find(
    this->Stack, lacuna::TrackedSlices::ImageToReferenceName, 16, this->Count);
  if (!array)
  {
    return;
  }
  std::vector<lacuna::Matrix4> poses;
  for (const vtkIdType slice : this->Slices)
  {
    poses.push_back(lacuna::FieldData::GetMatrix(array, slice) * this->PixelToImage);
  }
  if (this->Cropped && !this->Windowed && !this->Crops)
  {
    // the poses go in, so that no calibration of the whole picture takes their place
    this->Warnings.emplace_back(
      "the slices are cropped or resampled: column and row in the file are those of the pixels as "
      "they are now. Read the file without a CalibrationFileName, which is for the whole picture");
  }
  else if (lacuna::TellPoses(this->Content.Frames, this->ImageFrame, this->ReferenceFrame, poses))
  {
    return;
  }
  const std::string name = this->ImageFrame + "To" + this->ReferenceFrame;
  std::vector<std::string> matrices;
  std::vector<std::string> states;
  for (const lacuna::Matrix4& pose : poses)
  {
    matrices.push_back(pose.IsFinite() ? lacuna::FormatMatrix(pose) : std::string());
    states.emplace_back(pose.IsFinite() ? "OK" : "INVALID");
  }
  this->Fields.RemoveFromFrames(name + TransformSuffix);
  this->Fields.RemoveFromFrames(name + StatusSuffix);
  this->Fields.AddToFrames(name + TransformSuffix, matrices);
  this->Fields.AddToFrames(name + StatusSuffix, states);
}

//------------------------------------------------------------------------------
void lacuna::SequenceData::AddProvenance()
{
  std::size_t number = 0;
  for (const std::string& step : lacuna::Provenance::Get(this->Stack))
  {
    this->Fields.AddToHeader(
      lacuna::SequenceNames::ProvenancePrefix + std::to_string(number++), step);
  }
}

//------------------------------------------------------------------------------
lacuna::Matrix4 lacuna::SequenceData::ToPixels(
  const std::string& name, const lacuna::Matrix4& matrix) const
{
  const auto readings = lacuna::ReadTransformName(name);
  if (!this->Cropped || readings.size() != 1)
  {
    return matrix;
  }
  if (readings[0].first == this->ImageFrame)
  {
    return matrix * this->PixelToImage;
  }
  return readings[0].second == this->ImageFrame ? this->PixelToImage.Inverse() * matrix : matrix;
}

//------------------------------------------------------------------------------
// Of the slices in the stack; empty texts when there is no such array.
std::vector<std::string> lacuna::SequenceData::GetTexts(const std::string& name) const
{
  std::vector<std::string> texts;
  for (const vtkIdType slice : this->Slices)
  {
    texts.push_back(GetString(this->Stack, name.c_str(), slice));
  }
  return texts;
}
