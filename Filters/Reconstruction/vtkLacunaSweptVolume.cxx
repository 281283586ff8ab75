// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaSweptVolume.h"

#include "lacunaArrays.h"
#include "lacunaFieldData.h"
#include "lacunaMemory.h"
#include "lacunaSweptVolume.h"
#include "lacunaSweptVolumePlan.h"
#include "vtkCharArray.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnsignedIntArray.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>

namespace
{
constexpr std::array<const char*, 2> OutputFrameNames{ "Reference", "Principal" };
constexpr std::array<const char*, 3> FanMaskNames{ "Given", "Automatic", "None" };
constexpr std::array<const char*, 2> OutputScalarTypeNames{ "Input", "Float" };

bool HasPoints(const int extent[6])
{
  return extent[0] <= extent[1] && extent[2] <= extent[3] && extent[4] <= extent[5];
}

void WriteFans(vtkImageData* output, const lacuna::SweptVolumeFans& fans)
{
  if (fans.Found.empty())
  {
    return;
  }
  std::vector<double> origins, angles, radii;
  vtkNew<vtkIntArray> clips;
  clips->SetName("ClipRectangle");
  clips->SetNumberOfComponents(4);
  for (const std::optional<lacuna::SliceFan>& found : fans.Found)
  {
    const lacuna::SliceFan fan = found.value_or(lacuna::SliceFan());
    origins.insert(origins.end(), fan.Sector.Origin.begin(), fan.Sector.Origin.end());
    angles.insert(angles.end(), fan.Sector.Angles.begin(), fan.Sector.Angles.end());
    radii.insert(radii.end(), fan.Sector.Radii.begin(), fan.Sector.Radii.end());
    clips->InsertNextTypedTuple(fan.Clip.data());
  }
  lacuna::FieldData::Set(output, "FanOrigin", origins, 2);
  lacuna::FieldData::Set(output, "FanAngles", angles, 2);
  lacuna::FieldData::Set(output, "FanRadii", radii, 2);
  output->GetFieldData()->AddArray(clips);
}

// The volume changes whenever one of the inputs does; VTK by itself passes on the times of the
// first input only.
void AnnounceTimes(const lacuna::Ports& ports, int count)
{
  using SDDP = vtkStreamingDemandDrivenPipeline;
  std::set<double> times;
  vtkInformation* output = ports.GetOutputInformation();
  for (int i = 0; i < count; ++i)
  {
    vtkInformation* info = ports.GetInputInformation(0, i);
    const double* steps = info->Get(SDDP::TIME_STEPS());
    times.insert(steps, steps + info->Length(SDDP::TIME_STEPS()));
  }
  if (times.empty())
  {
    output->Remove(SDDP::TIME_STEPS());
    output->Remove(SDDP::TIME_RANGE());
    return;
  }
  const std::vector<double> steps(times.begin(), times.end());
  const double range[2] = { steps.front(), steps.back() };
  output->Set(SDDP::TIME_STEPS(), steps.data(), static_cast<int>(steps.size()));
  output->Set(SDDP::TIME_RANGE(), range, 2);
}

// Says what is odd about a volume; throws when nothing could be filled.
std::map<std::string, std::string> CheckVolume(
  const lacuna::SweptVolume& volume, const lacuna::SweptVolumePlan& plan)
{
  const lacuna::SweptVolume::PairCounts& pairs = volume.GetPairCounts();
  if (pairs.All > 0 && pairs.All == pairs.Coincident && !plan.IsMoreToCome)
  {
    throw std::runtime_error("all slices lie in the same plane: there is nothing between them");
  }
  std::map<std::string, std::string> warnings;
  if (!plan.Grid.Miss.empty()) // not an error: a sweep that is taken now may get there
  {
    warnings["miss"] = "the volume is empty: " + plan.Grid.Miss;
  }
  for (const lacuna::SliceImages& sweep : plan.Sweeps)
  {
    const std::string preview = sweep.DescribePreview();
    if (!preview.empty())
    {
      warnings["preview"] = preview;
    }
  }
  if (pairs.Turned > 0)
  {
    warnings["turned"] = std::to_string(pairs.Turned) + " of " + std::to_string(pairs.All) +
      " pairs of consecutive slices are turned by 90 degrees or more against each other; nothing "
      "was filled between them. The order of the slices or their poses may be wrong.";
  }
  if (plan.Grid.Dimensions == std::array<int, 3>{ 1, 1, 1 })
  {
    warnings["one voxel"] =
      "the volume has only one voxel: OutputSpacing is larger than all that the "
      "slices cover (or OutputBounds); it is meant in mm";
  }
  return warnings;
}

// Fills a volume from slices of which some are not in memory.
std::unique_ptr<lacuna::SweptVolume> FillFromStreams(const lacuna::SweptVolumePlan& plan,
  const std::array<int, 6>& extent, lacuna::Execution& execution, double end)
{
  auto volume = std::make_unique<lacuna::SweptVolume>(plan.Grid, extent, plan.Options);
  double all = 0;
  for (const lacuna::SliceImages& sweep : plan.Sweeps)
  {
    all += static_cast<double>(sweep.Slices.size());
  }
  double done = 0;
  for (const lacuna::SliceImages& sweep : plan.Sweeps)
  {
    const double begin = end * done / all;
    done += static_cast<double>(sweep.Slices.size());
    const double length = end * done / all - begin;
    volume->BeginSweep();
    sweep.ForEachPart(execution, begin, begin + length,
      [&](const std::vector<lacuna::SliceImage>& slices, double first, double last)
      { volume->AddSlices(slices, execution, begin + length * first, begin + length * last); });
  }
  return volume;
}

// What a volume was made of, for its provenance: pixels that were read in parts have no hash.
std::vector<vtkSmartPointer<vtkDataObject>> FindOrigins(const lacuna::SweptVolumePlan& plan)
{
  std::vector<vtkSmartPointer<vtkDataObject>> origins;
  for (const lacuna::SliceImages& sweep : plan.Sweeps)
  {
    origins.emplace_back(sweep.Stack);
    if (sweep.Stream)
    {
      origins.back() = vtkSmartPointer<vtkImageData>::New();
      origins.back()->GetFieldData()->ShallowCopy(sweep.Stack->GetFieldData());
    }
  }
  return origins;
}

void CheckAnnounced(const lacuna::SweptVolumePlan& plan, vtkInformation* info)
{
  const lacuna::Vec3 origin = plan.GetOrigin();
  const std::array<double, 9> direction = plan.GetDirection();
  int whole[6];
  info->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole);
  for (int a = 0; a < 3; ++a)
  {
    if (whole[2 * a + 1] != plan.Grid.Dimensions[a] - 1 ||
      info->Get(vtkDataObject::ORIGIN())[a] != origin[a] ||
      info->Get(vtkDataObject::SPACING())[a] != plan.Grid.Spacing[a] ||
      !std::equal(direction.begin(), direction.end(), info->Get(vtkDataObject::DIRECTION())))
    {
      throw std::runtime_error("the slices have changed since the volume was announced (a "
                               "source that changes with time?); set OutputBounds and "
                               "OutputSpacing, so that they do not depend on the slices");
    }
  }
}
}

// The arrays of the output.
struct vtkLacunaSweptVolume::Voxels
{
  Voxels(vtkIdType size, int scalarType)
  {
    this->Intensity.TakeReference(vtkDataArray::CreateDataArray(scalarType));
    this->Intensity->SetName("Intensity");
    lacuna::Arrays::SetNumberOfTuples(this->Intensity, size);
    this->Contributions->SetName("Contributions");
    lacuna::Arrays::SetNumberOfTuples(this->Contributions, size);
    this->Mask->SetName("vtkValidPointMask");
    lacuna::Arrays::SetNumberOfTuples(this->Mask, size);
  }

  // Of volume; returns how many voxels stay empty since they are not finite.
  std::int64_t Fill(const lacuna::SweptVolume& volume, lacuna::Execution& execution)
  {
    std::int64_t faults = 0;
    switch (this->Intensity->GetDataType())
    {
      vtkTemplateMacro(
        faults = volume.Write(static_cast<VTK_TT*>(this->Intensity->GetVoidPointer(0)),
          this->Contributions->GetPointer(0), this->Mask->GetPointer(0), execution));
    }
    return faults;
  }

  bool IsEmpty() const
  {
    const char* const filled = this->Mask->GetPointer(0);
    return !std::count(filled, filled + this->Mask->GetNumberOfTuples(), 1);
  }

  void Set(vtkImageData* output)
  {
    output->GetPointData()->SetScalars(this->Intensity);
    output->GetPointData()->AddArray(this->Contributions);
    output->GetPointData()->AddArray(this->Mask);
  }

  vtkSmartPointer<vtkDataArray> Intensity;
  vtkNew<vtkUnsignedIntArray> Contributions;
  vtkNew<vtkCharArray> Mask;
};

vtkStandardNewMacro(vtkLacunaSweptVolume);

//------------------------------------------------------------------------------
vtkLacunaSweptVolume::vtkLacunaSweptVolume()
  : Fans(new lacuna::SweptVolumeFans)
  , Growing(new lacuna::GrowingVolume)
{
}

//------------------------------------------------------------------------------
vtkLacunaSweptVolume::~vtkLacunaSweptVolume() = default;

//------------------------------------------------------------------------------
vtkIdType vtkLacunaSweptVolume::GetNumberOfSlicesAdded() const
{
  return static_cast<vtkIdType>(this->Growing->GetNumberOfSlicesAdded());
}

//------------------------------------------------------------------------------
const char* vtkLacunaSweptVolume::GetFanDescription()
{
  this->FanDescription.clear();
  for (const std::optional<lacuna::SliceFan>& fan : this->Fans->Found)
  {
    this->FanDescription +=
      (this->FanDescription.empty() ? "" : "\n") + (fan ? fan->Describe() : "not seen yet");
  }
  return this->FanDescription.c_str();
}

//------------------------------------------------------------------------------
int vtkLacunaSweptVolume::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  info->Set(vtkAlgorithm::INPUT_IS_REPEATABLE(), 1);
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaSweptVolume::Announce(const lacuna::Ports& ports)
{
  this->CheckProperties();
  this->UpdateInput(ports);
  vtkInformation* info = ports.GetOutputInformation();
  int extent[6] = { 0, -1, 0, -1, 0, -1 };
  const lacuna::SweptVolumePlan plan(this, ports, *this->Fans);
  info->Remove(vtkDataObject::DIRECTION());
  if (!plan.IsEmpty())
  {
    const lacuna::Vec3 origin = plan.GetOrigin();
    for (int a = 0; a < 3; ++a)
    {
      extent[2 * a + 1] = plan.Grid.Dimensions[a] - 1;
    }
    info->Set(vtkDataObject::ORIGIN(), origin.data(), 3);
    info->Set(vtkDataObject::DIRECTION(), plan.GetDirection().data(), 9);
    info->Set(vtkDataObject::SPACING(), plan.Grid.Spacing.data(), 3);
    vtkDataObject::SetPointDataActiveScalarInfo(info, plan.ScalarType, 1);
  }
  info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
  info->Set(vtkStreamingDemandDrivenPipeline::TIME_DEPENDENT_INFORMATION(), 1);
  AnnounceTimes(ports, this->GetNumberOfInputConnections(0));
}

//------------------------------------------------------------------------------
void vtkLacunaSweptVolume::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  vtkInformation* info = ports.GetOutputInformation();
  auto* output = ports.GetOutput<vtkImageData>();
  output->GetFieldData()->Initialize(); // VTK passes the slices' own
  const lacuna::SweptVolumePlan plan(this, ports, *this->Fans);
  this->Origins = FindOrigins(plan);
  if (plan.IsEmpty())
  {
    output->Initialize();
    return;
  }
  CheckAnnounced(plan, info);
  int updateExtent[6];
  info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), updateExtent);
  output->SetExtent(updateExtent);
  output->SetOrigin(plan.GetOrigin().data());
  output->SetDirectionMatrix(plan.GetDirection().data());
  output->SetSpacing(plan.Grid.Spacing.data());
  const vtkIdType size = output->GetNumberOfPoints();
  lacuna::RequireMemory("this part of the volume", static_cast<double>(size) * plan.BytesPerVoxel,
    this->Growing->GetBytes());
  Voxels voxels(size, plan.ScalarType);
  std::map<std::string, std::string> warnings;
  if (HasPoints(updateExtent))
  {
    std::array<int, 6> extent;
    std::copy(updateExtent, updateExtent + 6, extent.begin());
    warnings = this->Fill(plan, extent, execution, voxels);
    int whole[6];
    info->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole);
    if (plan.Options.MaximumSliceGap > 0 && !plan.IsMoreToCome &&
      plan.Options.Interpolation == lacuna::SweptVolume::Method::BetweenSlices &&
      std::equal(whole, whole + 6, updateExtent) && voxels.IsEmpty())
    {
      warnings["gap"] = "the volume is empty: all slices are further apart than "
                        "MaximumSliceGap, which is in mm; 0 is no limit";
    }
  }
  std::vector<const lacuna::SliceImages*> swept;
  for (const lacuna::SliceImages& sweep : plan.Sweeps)
  {
    swept.push_back(&sweep);
  }
  this->RecordSweeps(swept, this->MaximumSliceGap, output, warnings);
  this->WarnOfNews(warnings, plan.LeftOut);
  voxels.Set(output);
  WriteFans(output, *this->Fans);
}

//------------------------------------------------------------------------------
std::map<std::string, std::string> vtkLacunaSweptVolume::Fill(const lacuna::SweptVolumePlan& plan,
  const std::array<int, 6>& extent, lacuna::AlgorithmExecution& execution, Voxels& voxels)
{
  lacuna::GrowingVolume::Sweeps sweeps;
  for (const lacuna::SliceImages& sweep : plan.Sweeps)
  {
    sweeps.push_back(&sweep.Slices);
  }
  std::unique_ptr<lacuna::SweptVolume> streamed;
  if (plan.HasStreams())
  {
    this->Growing = std::make_unique<lacuna::GrowingVolume>(); // without what was kept
    streamed = FillFromStreams(plan, extent, execution, 0.9);
  }
  const lacuna::SweptVolume& volume = streamed ? *streamed
                                               : this->Growing->Update(sweeps, plan.Grid, extent,
                                                   plan.Options, plan.IsReplay, execution, 0, 0.9);
  std::map<std::string, std::string> warnings = CheckVolume(volume, plan);
  execution.SetStage(0.9, 1);
  const std::int64_t faults = voxels.Fill(volume, execution);
  if (faults > 0)
  {
    warnings["not finite"] = std::to_string(faults) +
      " voxels stay empty, since their grey levels would not be finite numbers: some pixels "
      "are not (NaN or infinite), or are too large for the output";
  }
  this->Growing->Finish();
  return warnings;
}

//------------------------------------------------------------------------------
std::vector<vtkDataObject*> vtkLacunaSweptVolume::GetOrigins(const lacuna::Ports&) const
{
  return { this->Origins.begin(), this->Origins.end() };
}

//------------------------------------------------------------------------------
void vtkLacunaSweptVolume::Describe(lacuna::Properties& properties) const
{
  using lacuna::ValueRange;
  properties.Add("OutputSpacing", this->OutputSpacing, lacuna::VolumeGridRequest::SpacingRange)
    .Add("OutputFrame", this->OutputFrame, OutputFrameNames)
    .Add("OutputBounds", this->OutputBounds, ValueRange::Any("mm"))
    .Add("PixelSampling", this->PixelSampling, lacuna::PixelSamplingNames)
    .Add("FootprintScale", this->FootprintScale, lacuna::SweptVolume::FootprintScaleRange)
    .Add("FootprintAcrossSlices", this->FootprintAcrossSlices)
    .Add("Interpolation", this->Interpolation, lacuna::SweptVolume::MethodNames)
    .Add("Compounding", this->Compounding, lacuna::CompoundingNames);
  this->DescribeGapMethod(properties);
  properties.Add(
    "MaximumSliceGap", this->MaximumSliceGap, ValueRange::Above(0, "mm").OrZero("no limit"));
  this->DescribeClip(properties);
  properties.Add("FanMask", this->FanMask, FanMaskNames);
  this->DescribeSlices(properties);
  properties.Add("OutputScalarType", this->OutputScalarType, OutputScalarTypeNames)
    .Add("MemoryLimit", this->MemoryLimit, ValueRange::AtLeast(1, "MiB").OrZero("no limit"));
}
