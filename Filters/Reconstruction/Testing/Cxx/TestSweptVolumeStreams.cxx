// SPDX-License-Identifier: BSD-3-Clause
// Slices that are too many for the memory: vtkLacunaSweptVolume takes all of them from the stream
// beside a preview, and makes the same volume, bit by bit.
#include "lacunaTestStacks.h"
#include "vtkFieldData.h"
#include "vtkImageAlgorithm.h"
#include "vtkInformation.h"
#include "vtkInformationObjectBaseKey.h"
#include "vtkInformationVector.h"
#include "vtkLacunaGateSlices.h"
#include "vtkLacunaSliceRayCaster.h"
#include "vtkLacunaSliceStream.h"
#include "vtkObjectFactory.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"

#include <cstring>
#include <set>

using lacuna::Matrix4;
using namespace lacunaTestStacks;

namespace
{
constexpr int PreviewStride = 5;

// All slices of a stack in memory; counts what is read of it.
class StackStream : public vtkLacunaSliceStream
{
public:
  static StackStream* New();
  vtkTypeMacro(StackStream, vtkLacunaSliceStream);

  void SetStack(vtkImageData* stack)
  {
    this->Stack = stack;
    stack->GetExtent(this->Extent);
    stack->GetOrigin(this->Origin);
    stack->GetSpacing(this->Spacing);
  }
  std::int64_t GetSliceSize() const override
  {
    const int* size = this->Stack->GetDimensions();
    return std::int64_t{ size[0] } * size[1] * this->Stack->GetScalarSize();
  }
  void Read(int first, int last, void* pixels, lacuna::Execution&) override
  {
    LACUNA_CHECK(this->Extent[4] <= first && first <= last && last <= this->Extent[5]);
    std::memcpy(pixels, this->Stack->GetScalarPointer(this->Extent[0], this->Extent[2], first),
      static_cast<std::size_t>(last - first + 1) * static_cast<std::size_t>(this->GetSliceSize()));
    for (int k = first; k <= last; ++k)
    {
      this->SlicesRead.insert(k);
    }
  }

  std::multiset<int> SlicesRead;

private:
  vtkSmartPointer<vtkImageData> Stack;
};
vtkStandardNewMacro(StackStream);

// Puts out a preview of a stack, with the stream beside it.
class PreviewSource : public vtkImageAlgorithm
{
public:
  static PreviewSource* New();
  vtkTypeMacro(PreviewSource, vtkImageAlgorithm);

  void SetStack(vtkImageData* stack)
  {
    this->Stack = stack;
    this->Stream->SetStack(stack);
  }

  vtkNew<StackStream> Stream;
  int LayersAsked = 0;

protected:
  PreviewSource() { this->SetNumberOfInputPorts(0); }

  int RequestInformation(
    vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    int extent[6];
    this->Stack->GetExtent(extent);
    extent[5] = extent[4] + (extent[5] - extent[4]) / PreviewStride;
    vtkInformation* info = outputs->GetInformationObject(0);
    info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
    info->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1);
    info->Set(vtkLacunaSliceStream::STREAM(), this->Stream);
    return 1;
  }

  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    const int* extent =
      outputs->GetInformationObject(0)->Get(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT());
    vtkImageData* output = vtkImageData::GetData(outputs);
    output->SetExtent(const_cast<int*>(extent));
    output->SetOrigin(this->Stack->GetOrigin());
    output->SetSpacing(1, 1, PreviewStride);
    output->AllocateScalars(this->Stack->GetScalarType(), 1);
    output->GetFieldData()->ShallowCopy(this->Stack->GetFieldData());
    vtkNew<vtkStringArray> preview;
    preview->SetName(lacuna::TrackedSlices::PreviewName);
    preview->InsertNextValue("a preview of every 5th slice");
    output->GetFieldData()->AddArray(preview);
    for (int k = extent[4]; k <= extent[5]; ++k)
    {
      std::memcpy(output->GetScalarPointer(extent[0], extent[2], k),
        this->Stack->GetScalarPointer(extent[0], extent[2], PreviewStride * k),
        static_cast<std::size_t>(this->Stream->GetSliceSize()));
    }
    this->LayersAsked = extent[5] - extent[4] + 1;
    return 1;
  }

private:
  vtkSmartPointer<vtkImageData> Stack;
};
vtkStandardNewMacro(PreviewSource);

// Slices that lean, with a bright spot that wanders, some of them marked; of a megabyte each, so
// that they come in several parts.
vtkSmartPointer<vtkImageData> MakeLargeStack(int count, int columns, int rows)
{
  auto stack = vtkSmartPointer<vtkImageData>::New();
  stack->SetDimensions(columns, rows, count);
  stack->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  std::vector<Matrix4> poses;
  std::vector<unsigned char> status;
  std::vector<double> times;
  std::vector<int> frames;
  for (int k = 0; k < count; ++k)
  {
    auto* pixel = static_cast<unsigned char*>(stack->GetScalarPointer(0, 0, k));
    for (int j = 0; j < rows; ++j)
    {
      for (int i = 0; i < columns; ++i, ++pixel)
      {
        // what changes is a rectangle
        const bool inside = i > columns / 8 && i < columns - columns / 6 && j > rows / 5;
        *pixel = static_cast<unsigned char>(
          inside ? 20 + (i * 7 + j * 3 + k * k * 31 + (i * j) % 13) % 200 : 0);
      }
    }
    poses.push_back(Matrix4::Translation({ 10, 20, 0.7 * k }) *
      Matrix4::Rotation({ 0.3, 1, 0 }, 0.01 * (k % 5)) * Matrix4::Scaling({ 0.05, 0.05, 1 }));
    status.push_back(k % 11 == 3 ? 1 : k % 13 == 5 ? 8 : 0);
    times.push_back(0.1 * k);
    frames.push_back(k);
  }
  lacuna::TrackedSlices::Write(stack, poses, times, status, frames);
  return stack;
}

void CheckEqual(vtkImageData* a, vtkImageData* b, const std::string& what)
{
  LACUNA_CHECK_THAT(a->GetNumberOfPoints() > 0, "a volume: " + what);
  LACUNA_CHECK_THAT(a->GetNumberOfPoints() == b->GetNumberOfPoints(), "same size: " + what);
  for (const char* name : { "Intensity", "Contributions", "vtkValidPointMask" })
  {
    vtkDataArray* x = a->GetPointData()->GetArray(name);
    vtkDataArray* y = b->GetPointData()->GetArray(name);
    LACUNA_CHECK_THAT(x && y && x->GetNumberOfValues() == y->GetNumberOfValues() &&
        !std::memcmp(x->GetVoidPointer(0), y->GetVoidPointer(0),
          static_cast<std::size_t>(x->GetNumberOfValues() * x->GetDataTypeSize())),
      "same " + std::string(name) + ": " + what);
  }
}

// The same volume with a preview as with all slices.
void TestSameVolume()
{
  const auto stack = MakeLargeStack(90, 1024, 700);
  struct Case
  {
    std::string Name;
    Configure Set;
  };
  const std::vector<Case> cases = {
    { "as it is", {} },
    { "clipped", [](auto f) { f->SetClipRectangle(100, 50, 700, 300); } },
    { "fan",
      [](auto f)
      {
        f->SetFanOrigin(500, -100);
        f->SetFanRadii(8, 30);
      } },
    { "fan found", [](auto f) { f->SetFanMaskToAutomatic(); } },
    { "pixels", [](auto f) { f->SetInterpolationToNearestVoxel(); } },
    { "own axes", [](auto f) { f->SetOutputFrameToPrincipal(); } },
    { "gated", [](auto f) { f->UseGatedOutOn(); } },
    { "across", [](auto f) { f->FootprintAcrossSlicesOn(); } },
  };
  for (const Case& c : cases)
  {
    vtkNew<PreviewSource> source;
    source->SetStack(stack);
    vtkNew<vtkLacunaSweptVolume> whole;
    vtkNew<vtkLacunaSweptVolume> streamed;
    whole->SetInputData(stack);
    streamed->SetInputConnection(source->GetOutputPort());
    for (vtkLacunaSweptVolume* filter : { whole.Get(), streamed.Get() })
    {
      filter->SetOutputSpacing(0.8, 0.8, 0.8);
      if (c.Set)
      {
        c.Set(filter);
      }
      filter->Update();
    }
    CheckEqual(whole->GetOutput(), streamed->GetOutput(), c.Name);
    LACUNA_CHECK_THAT(
      std::string(whole->GetFanDescription()) == streamed->GetFanDescription(), c.Name);
    LACUNA_CHECK_THAT(source->LayersAsked == 1, "no more of the preview than is needed");
    const bool takesGated = streamed->GetUseGatedOut();
    for (int k = 0; k < 90 && streamed->GetFanMask() != vtkLacunaSweptVolume::Automatic; ++k)
    {
      const bool isUsed = k % 11 != 3 && (takesGated || k % 13 != 5);
      LACUNA_CHECK_THAT(source->Stream->SlicesRead.count(k) == (isUsed ? 1u : 0u),
        "what is used is read once: " + c.Name + " " + std::to_string(k));
    }
  }
}

// Sweeps of either kind together, and pieces.
void TestInputsAndPieces()
{
  const auto stack = MakeLargeStack(60, 1024, 700);
  const auto second = MakeLargeStack(20, 300, 200);
  vtkNew<PreviewSource> source;
  source->SetStack(stack);
  vtkNew<vtkLacunaSweptVolume> whole;
  whole->AddInputDataObject(0, stack);
  whole->AddInputDataObject(0, second);
  vtkNew<vtkLacunaSweptVolume> streamed;
  streamed->AddInputConnection(0, source->GetOutputPort());
  streamed->AddInputDataObject(0, second);
  for (vtkLacunaSweptVolume* filter : { whole.Get(), streamed.Get() })
  {
    filter->SetOutputSpacing(0.7, 0.7, 0.7);
  }
  whole->Update();
  streamed->Update();
  CheckEqual(whole->GetOutput(), streamed->GetOutput(), "two inputs");
  const int half[6] = { 3, 20, 0, 30, 5, 25 };
  whole->UpdateExtent(half);
  streamed->UpdateExtent(half);
  vtkNew<vtkImageData> part;
  part->ShallowCopy(whole->GetOutput());
  part->Crop(half);
  vtkNew<vtkImageData> other;
  other->ShallowCopy(streamed->GetOutput());
  other->Crop(half);
  CheckEqual(part, other, "a piece");
  LACUNA_CHECK_CONTAINS(std::string(vtkStringArray::SafeDownCast(
                          streamed->GetOutput()->GetFieldData()->GetAbstractArray("Provenance"))
                                      ->GetValue(0)),
    "input:- input:");
}

// A filter that changes marks only passes the stream on; what others make of a preview says so.
void TestChains()
{
  const auto stack = MakeLargeStack(60, 400, 300);
  vtkNew<PreviewSource> source;
  source->SetStack(stack);
  vtkNew<vtkLacunaGateSlices> gates[2];
  gates[0]->SetInputDataObject(stack);
  gates[1]->SetInputConnection(source->GetOutputPort());
  vtkNew<vtkLacunaSweptVolume> volumes[2];
  for (int n = 0; n < 2; ++n)
  {
    gates[n]->SetGateColumn("none");
    gates[n]->SetSpeedLimit(13);
    volumes[n]->SetInputConnection(gates[n]->GetOutputPort());
    volumes[n]->SetOutputSpacing(0.5, 0.5, 0.5);
    volumes[n]->Update();
  }
  CheckEqual(volumes[0]->GetOutput(), volumes[1]->GetOutput(), "gated by speed");
  LACUNA_CHECK(source->Stream->SlicesRead.size() < 45); // some are too fast

  vtkNew<vtkLacunaSliceRayCaster> caster;
  const auto messages = lacunaCheck::Watch(caster);
  caster->SetInputConnection(source->GetOutputPort());
  caster->SetIsoValue(100);
  caster->Update();
  LACUNA_CHECK(source->LayersAsked == 12);
  LACUNA_CHECK_CONTAINS(messages->Warnings, "the input is made of a preview of every 5th slice");

  vtkNew<vtkImageData> copy; // as behind a filter that knows nothing of streams
  copy->ShallowCopy(source->GetOutput());
  vtkNew<vtkLacunaSweptVolume> volume;
  const auto warnings = lacunaCheck::Watch(volume);
  volume->SetInputData(copy);
  volume->SetOutputSpacing(0.5, 0.5, 0.5);
  volume->Update();
  LACUNA_CHECK(volume->GetNumberOfSlicesAdded() < 12);
  LACUNA_CHECK_CONTAINS(warnings->Warnings, "the input is made of a preview of every 5th slice");
}

// Pixels that cannot be read are an error, and leave nothing behind.
void TestReadError()
{
  class Failing : public StackStream
  {
  public:
    static Failing* New() { VTK_STANDARD_NEW_BODY(Failing); }
    void Read(int, int, void*, lacuna::Execution&) override
    {
      throw std::runtime_error("the pixels of frame 7 cannot be read");
    }
  };
  const auto stack = MakeLargeStack(20, 40, 30);
  vtkNew<PreviewSource> source;
  source->SetStack(stack);
  vtkNew<Failing> failing;
  failing->SetStack(stack);
  vtkNew<vtkLacunaSweptVolume> volume;
  volume->SetInputConnection(source->GetOutputPort());
  source->UpdateInformation();
  source->GetOutputInformation(0)->Set(vtkLacunaSliceStream::STREAM(), failing);
  const auto messages = lacunaCheck::Watch(volume);
  volume->Update();
  LACUNA_CHECK_CONTAINS(messages->Errors, "frame 7 cannot be read");
  LACUNA_CHECK(volume->GetOutput()->GetNumberOfPoints() == 0);
}
}

int TestSweptVolumeStreams(int, char*[])
{
  TestSameVolume();
  TestInputsAndPieces();
  TestChains();
  TestReadError();
  return lacunaCheck::Result();
}
