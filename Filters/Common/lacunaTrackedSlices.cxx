// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaTrackedSlices.h"

#include "lacunaFieldData.h"
#include "lacunaVolumeDirection.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkUnsignedCharArray.h"

#include <cmath>
#include <sstream>
#include <stdexcept>

//------------------------------------------------------------------------------
void lacuna::TrackedSlices::Refuse(vtkImageData* image)
{
  if (image->GetFieldData()->HasArray(SliceStatusName))
  {
    throw std::runtime_error("these are tracked slices, not a volume: their pixels are not in "
                             "millimetres. Put Swept Volume before this filter");
  }
}

//------------------------------------------------------------------------------
lacuna::TrackedSlices::TrackedSlices(vtkImageData* stack)
  : Stack(stack)
  , GreyLevels(stack->GetPointData()->GetScalars())
{
  if (!this->GreyLevels)
  {
    throw std::runtime_error("tracked slices have no active point scalars (grey levels)");
  }
  if (this->GreyLevels->GetNumberOfComponents() != 1)
  {
    throw std::runtime_error("tracked slices must have one grey level per pixel, not " +
      std::to_string(this->GreyLevels->GetNumberOfComponents()) + " components");
  }
  if (this->GreyLevels->GetNumberOfTuples() != stack->GetNumberOfPoints())
  {
    std::ostringstream message;
    message << "tracked slices have " << this->GreyLevels->GetNumberOfTuples()
            << " grey levels for " << stack->GetNumberOfPoints() << " pixels";
    throw std::runtime_error(message.str());
  }
  vtkDataArray* poses = lacuna::FieldData::Find(stack, ImageToReferenceName, 16, -1);
  if (!poses)
  {
    throw std::runtime_error(std::string("field data array '") + ImageToReferenceName +
      "' is missing: the probe is not calibrated (give the reader a CalibrationFileName), or a "
      "filter in between dropped the field data");
  }
  const vtkIdType n = poses->GetNumberOfTuples();
  vtkDataArray* status = lacuna::FieldData::Get(stack, SliceStatusName, 1, n);
  vtkDataArray* times = lacuna::FieldData::Find(stack, TimestampName, 1, n);
  for (vtkIdType i = 0; i < n; ++i)
  {
    this->Poses.push_back(lacuna::FieldData::GetMatrix(poses, i));
    const double flags = status->GetTuple1(i);
    if (!(flags >= 0 && flags <= 255 && flags == std::floor(flags)))
    {
      std::ostringstream message;
      message << "field data array '" << SliceStatusName << "' is " << flags << " for slice " << i
              << "; flags are whole numbers from 0 to 255";
      throw std::runtime_error(message.str());
    }
    this->StatusFlags.push_back(static_cast<unsigned char>(flags));
    this->Times.push_back(times ? times->GetTuple1(i) : static_cast<double>(i));
  }
}

//------------------------------------------------------------------------------
vtkIdType lacuna::TrackedSlices::GetSliceNumber(int k) const
{
  return GetSliceNumber(this->Stack, k, this->GetNumberOfSlices());
}

//------------------------------------------------------------------------------
vtkIdType lacuna::TrackedSlices::GetSliceNumber(vtkImageData* stack, int k, vtkIdType slices)
{
  return GetSliceNumber(stack->GetOrigin()[2] + stack->GetSpacing()[2] * k, slices);
}

//------------------------------------------------------------------------------
vtkIdType lacuna::TrackedSlices::GetSliceNumber(double z, vtkIdType slices)
{
  if (!(std::abs(z - std::round(z)) < 1e-3))
  {
    std::ostringstream message;
    message << "the stack holds a slice at z = " << z
            << ", between two slices of the sweep: a filter in between has resampled it along z "
               "(the z coordinate of tracked slices is the slice number)";
    throw std::runtime_error(message.str());
  }
  const auto slice = static_cast<vtkIdType>(std::llround(z));
  if (slice < 0 || slice >= slices)
  {
    std::ostringstream message;
    message << "the stack holds a slice at z = " << z << ", but the field data are those of "
            << slices << " slices (the z coordinate of tracked slices is the slice number)";
    throw std::runtime_error(message.str());
  }
  return slice;
}

//------------------------------------------------------------------------------
// Field data, since ParaView's server copies a source's output without its information.
void lacuna::TrackedSlices::MarkAsGrowing(vtkImageData* stack)
{
  vtkNew<vtkIntArray> growing;
  growing->SetName(GrowingName);
  growing->InsertNextValue(1);
  stack->GetFieldData()->AddArray(growing);
}

//------------------------------------------------------------------------------
bool lacuna::TrackedSlices::IsGrowing(vtkImageData* stack)
{
  return stack->GetFieldData()->HasArray(GrowingName) != 0;
}

//------------------------------------------------------------------------------
void lacuna::TrackedSlices::Write(vtkImageData* stack, const std::vector<lacuna::Matrix4>& poses,
  const std::vector<double>& timestamps, const std::vector<unsigned char>& status,
  const std::vector<int>& frameNumbers)
{
  if (!poses.empty())
  {
    lacuna::FieldData::SetMatrices(stack, ImageToReferenceName, poses);
  }
  if (!timestamps.empty())
  {
    lacuna::FieldData::Set(stack, TimestampName, timestamps, 1);
  }
  vtkNew<vtkUnsignedCharArray> statusArray;
  statusArray->SetName(SliceStatusName);
  for (const unsigned char s : status)
  {
    statusArray->InsertNextValue(s);
  }
  stack->GetFieldData()->AddArray(statusArray);
  vtkNew<vtkIntArray> frameArray;
  frameArray->SetName(FrameNumberName);
  for (const int f : frameNumbers)
  {
    frameArray->InsertNextValue(f);
  }
  stack->GetFieldData()->AddArray(frameArray);
  lacuna::VolumeDirection::Remove(stack);
}
