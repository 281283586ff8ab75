// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaGrowingStack.h"

#include "lacunaFieldData.h"
#include "lacunaGeometryGate.h"
#include "lacunaPixelSpacing.h"
#include "lacunaTrackedSlices.h"
#include "vtkAbstractArray.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkPointData.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <map>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

namespace
{
// VTK's arrays tell no more than an address when they are done with memory that is not theirs.
class Lenders
{
public:
  static Lenders& Get()
  {
    static auto* lenders = new Lenders; // arrays may be destroyed after statics are
    return *lenders;
  }
  void Lend(const std::shared_ptr<char>& memory)
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    this->Lent[memory.get()].push_back(memory);
  }
  void Return(void* address)
  {
    std::shared_ptr<char> last; // freed without the lock
    const std::lock_guard<std::mutex> lock(this->Mutex);
    const auto found = this->Lent.find(address);
    last = std::move(found->second.back());
    found->second.pop_back();
    if (found->second.empty())
    {
      this->Lent.erase(found);
    }
  }

private:
  std::mutex Mutex;
  std::map<void*, std::vector<std::shared_ptr<char>>> Lent;
};

void Return(void* address)
{
  Lenders::Get().Return(address);
}
}

//------------------------------------------------------------------------------
lacuna::GrowingArray::GrowingArray(const char* name, int type, int components)
  : Name(name)
  , Type(type)
  , Components(components)
  , TupleSize(
      static_cast<std::size_t>(vtkAbstractArray::GetDataTypeSize(type)) * std::size_t(components))
{
}

//------------------------------------------------------------------------------
lacuna::GrowingArray::~GrowingArray() = default;

//------------------------------------------------------------------------------
void lacuna::GrowingArray::Reserve(vtkIdType tuples)
{
  if (tuples <= this->Room)
  {
    return;
  }
  auto* memory =
    static_cast<char*>(std::malloc(static_cast<std::size_t>(tuples) * this->TupleSize));
  if (!memory)
  {
    throw std::bad_alloc();
  }
  std::shared_ptr<char> larger(memory, std::free);
  if (this->Tuples > 0)
  {
    std::memcpy(
      memory, this->Memory.get(), static_cast<std::size_t>(this->Tuples) * this->TupleSize);
  }
  this->Memory = std::move(larger);
  this->Room = tuples;
}

//------------------------------------------------------------------------------
void lacuna::GrowingArray::MakeRoom(vtkIdType tuples)
{
  if (this->Tuples + tuples > this->Room)
  {
    this->Reserve(std::max(this->Tuples + tuples, this->Room + this->Room / 2));
  }
}

//------------------------------------------------------------------------------
void lacuna::GrowingArray::Append(const void* values, vtkIdType tuples)
{
  this->MakeRoom(tuples);
  std::memcpy(this->Memory.get() + static_cast<std::size_t>(this->Tuples) * this->TupleSize, values,
    static_cast<std::size_t>(tuples) * this->TupleSize);
  this->Tuples += tuples;
}

//------------------------------------------------------------------------------
const void* lacuna::GrowingArray::GetTuple(vtkIdType i) const
{
  return this->Memory.get() + static_cast<std::size_t>(i) * this->TupleSize;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkDataArray> lacuna::GrowingArray::MakeView() const
{
  auto view = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(this->Type));
  view->SetName(this->Name.c_str());
  view->SetNumberOfComponents(this->Components);
  if (this->Tuples > 0)
  {
    Lenders::Get().Lend(this->Memory);
    view->SetVoidArray(this->Memory.get(), this->Tuples * this->Components, 0,
      vtkAbstractArray::VTK_DATA_ARRAY_USER_DEFINED);
    view->SetArrayFreeFunction(Return);
  }
  return view;
}

//------------------------------------------------------------------------------
namespace
{
constexpr const char* TrackerToReferenceName = "TrackerToReference";

std::unique_ptr<lacuna::GrowingArray> MakeMatrices(const char* name)
{
  return std::make_unique<lacuna::GrowingArray>(name, VTK_DOUBLE, 16);
}

// Puts a range where an array keeps one that it has computed.
void SetRange(vtkDataArray* array, double lowest, double highest)
{
  const double range[2] = { lowest, highest };
  for (vtkInformationInformationVectorKey* key :
    { vtkAbstractArray::PER_COMPONENT(), vtkAbstractArray::PER_FINITE_COMPONENT() })
  {
    vtkNew<vtkInformationVector> components;
    components->SetNumberOfInformationObjects(1);
    components->GetInformationObject(0)->Set(vtkDataArray::COMPONENT_RANGE(), range, 2);
    array->GetInformation()->Set(key, components);
  }
}
}

//------------------------------------------------------------------------------
lacuna::GrowingStack::GrowingStack()
  : lacuna::GrowingStack(lacuna::SweepFrame(), 0)
{
}

//------------------------------------------------------------------------------
lacuna::GrowingStack::GrowingStack(const lacuna::SweepFrame& frame, std::int64_t bytes)
  : Frame(frame)
  , Pixels(std::make_unique<lacuna::GrowingArray>("Intensity", VTK_UNSIGNED_CHAR, 1))
  , ProbeToTracker("ProbeToTracker", VTK_DOUBLE, 16)
  , Timestamps(lacuna::TrackedSlices::TimestampName, VTK_DOUBLE, 1)
  , GivenStatus("", VTK_UNSIGNED_CHAR, 1)
  , PixelSpacings(lacuna::PixelSpacingField, VTK_DOUBLE, 2)
  , FrameNumbers(lacuna::TrackedSlices::FrameNumberName, VTK_INT, 1)
  , Residuals("Residual", VTK_DOUBLE, 1)
  , Speeds("Speed", VTK_DOUBLE, 1)
{
  this->Pixels->Reserve(bytes);
  this->Calibrate(frame);
}

//------------------------------------------------------------------------------
std::unique_ptr<lacuna::GrowingStack> lacuna::GrowingStack::MakeBlank()
{
  constexpr int columns = 768;
  constexpr int rows = 576;
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  lacuna::SweepFrame frame;
  frame.Window = { 0, 0, columns, rows };
  lacuna::AcquiredSlice slice;
  auto pixels = std::make_shared<std::vector<std::uint8_t>>(std::size_t{ columns } * rows);
  for (int i = 0; i < 16 * columns; ++i)
  {
    pixels->rbegin()[i] = static_cast<std::uint8_t>(255 - i % columns * 256 / columns);
  }
  slice.Pixels = std::move(pixels);
  slice.ProbeToTracker = lacuna::NoPose();
  slice.Status = lacuna::TrackedSlices::PoseInvalid | lacuna::TrackedSlices::ImageInvalid;
  slice.Residual = slice.Speed = none;
  auto stack = std::make_unique<lacuna::GrowingStack>(frame, 0);
  stack->Append(slice);
  return stack;
}

//------------------------------------------------------------------------------
void lacuna::GrowingStack::Append(const lacuna::AcquiredSlice& slice)
{
  const int number = static_cast<int>(slice.FrameNumber);
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const lacuna::Vec2 spacing = slice.PixelSpacing.value_or(lacuna::Vec2{ none, none });
  const auto pixels = static_cast<vtkIdType>(slice.Pixels->size());
  this->Pixels->MakeRoom(pixels);
  for (lacuna::GrowingArray* array : { this->ImageToReference.get(), this->TrackerToReference.get(),
         &this->ProbeToTracker, &this->Timestamps, &this->GivenStatus, &this->PixelSpacings,
         this->Status.get(), &this->FrameNumbers, &this->Residuals, &this->Speeds })
  {
    if (array)
    {
      array->MakeRoom(1);
    }
  }
  this->Pixels->Append(slice.Pixels->data(), pixels);
  for (const std::uint8_t pixel : *slice.Pixels)
  {
    this->Darkest = std::min(this->Darkest, pixel);
    this->Brightest = std::max(this->Brightest, pixel);
  }
  this->ProbeToTracker.Append(slice.ProbeToTracker.Data());
  this->GivenStatus.Append(&slice.Status);
  this->PixelSpacings.Append(spacing.data());
  this->HasPixelSpacings = this->HasPixelSpacings || slice.PixelSpacing.has_value();
  this->AppendPose();
  this->Timestamps.Append(&slice.Timestamp);
  this->FrameNumbers.Append(&number);
  this->Residuals.Append(&slice.Residual);
  this->Speeds.Append(&slice.Speed);
}

//------------------------------------------------------------------------------
// Of the first slice that has none.
void lacuna::GrowingStack::AppendPose()
{
  const vtkIdType i = this->Status->GetNumberOfTuples();
  const lacuna::Matrix4 probeToTracker(
    static_cast<const double*>(this->ProbeToTracker.GetTuple(i)));
  const auto* said = static_cast<const double*>(this->PixelSpacings.GetTuple(i));
  const lacuna::Vec2 spacing{ said[0], said[1] };
  const bool contradicts = this->Frame.Calibrated && lacuna::IsPixelSpacing(spacing) &&
    lacuna::SaysPixelSpacing(spacing) &&
    !lacuna::IsSameSpacing(spacing, lacuna::GetPixelSpacing(this->Frame.ImageToProbe));
  unsigned char status = *static_cast<const unsigned char*>(this->GivenStatus.GetTuple(i));
  status |= contradicts ? lacuna::TrackedSlices::PoseInvalid : 0;
  this->Status->Append(&status);
  this->TrackerToReference->Append(this->Frame.TrackerToReference.Data());
  if (this->ImageToReference)
  {
    const lacuna::Matrix4 pose = contradicts || std::isnan(probeToTracker(0, 0))
      ? lacuna::NoPose()
      : this->Frame.TrackerToReference * probeToTracker * this->Frame.ImageToProbe;
    this->ImageToReference->Append(pose.Data());
  }
}

//------------------------------------------------------------------------------
void lacuna::GrowingStack::Calibrate(const lacuna::SweepFrame& frame)
{
  // outputs that were made keep the old ones
  auto tracker = MakeMatrices(TrackerToReferenceName);
  auto status = std::make_unique<lacuna::GrowingArray>(
    lacuna::TrackedSlices::SliceStatusName, VTK_UNSIGNED_CHAR, 1);
  auto image =
    frame.Calibrated ? MakeMatrices(lacuna::TrackedSlices::ImageToReferenceName) : nullptr;
  tracker->MakeRoom(this->GetNumberOfSlices());
  status->MakeRoom(this->GetNumberOfSlices());
  if (image)
  {
    image->MakeRoom(this->GetNumberOfSlices());
  }
  const std::array<int, 4> window = this->Frame.Window;
  this->Frame = frame;
  this->Frame.Window = window;
  this->TrackerToReference = std::move(tracker);
  this->Status = std::move(status);
  this->ImageToReference = std::move(image);
  for (vtkIdType i = 0; i < this->GetNumberOfSlices(); ++i)
  {
    this->AppendPose();
  }
}

//------------------------------------------------------------------------------
void lacuna::GrowingStack::Fill(vtkImageData* output) const
{
  const auto [column, row, columns, rows] = this->Frame.Window;
  const int slices = static_cast<int>(this->GetNumberOfSlices());
  output->SetOrigin(column, row, 0);
  output->SetSpacing(1, 1, 1);
  output->SetExtent(0, columns - 1, 0, rows - 1, 0, slices - 1);
  const vtkSmartPointer<vtkDataArray> pixels = this->Pixels->MakeView();
  if (slices > 0)
  {
    SetRange(pixels, this->Darkest, this->Brightest);
  }
  output->GetPointData()->SetScalars(pixels);
  vtkFieldData* fields = output->GetFieldData();
  using Array = const lacuna::GrowingArray*;
  for (const Array array :
    std::initializer_list<Array>{ this->ImageToReference.get(), this->TrackerToReference.get(),
      &this->ProbeToTracker, &this->Timestamps, this->Status.get(), &this->FrameNumbers,
      &this->Residuals, &this->Speeds, this->HasPixelSpacings ? &this->PixelSpacings : nullptr })
  {
    if (array)
    {
      fields->AddArray(array->MakeView());
    }
  }
  if (this->Frame.Calibrated)
  {
    lacuna::FieldData::SetMatrices(
      output, lacuna::TrackedSlices::ImageToProbeName, { this->Frame.ImageToProbe });
  }
}
