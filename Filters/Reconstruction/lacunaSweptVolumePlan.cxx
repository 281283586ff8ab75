// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSweptVolumePlan.h"

#include "lacunaActivityMap.h"
#include "lacunaArrayScalarType.h"
#include "lacunaExecution.h"
#include "lacunaPrincipalFrame.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaSliceStream.h"
#include "vtkLacunaSweptVolume.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace
{
// Looks at the same slices, whether they are in memory or not.
lacuna::SliceFan DetectFan(const lacuna::SliceImages& sweep, vtkAlgorithm* filter)
{
  lacuna::AlgorithmExecution execution(filter);
  execution.SetStage(0, 0);
  std::vector<unsigned char> storage;
  return lacuna::SliceFan::Detect(
    sweep.Load(lacuna::ActivityMap::ChooseSlices(sweep.Slices.size()), storage, execution),
    sweep.Window);
}
}

//------------------------------------------------------------------------------
lacuna::SweptVolumePlan::SweptVolumePlan(
  vtkLacunaSweptVolume* filter, const lacuna::Ports& ports, lacuna::SweptVolumeFans& fans)
  : ScalarType(VTK_FLOAT)
{
  this->ReadSweeps(filter, ports);
  if (!this->IsEmpty())
  {
    this->PlacedSlices = this->GetAllSlices();
    this->ApplyFans(filter, fans);
    // A replay does not know yet what fan it will show: its grid must not depend on it.
    if (!this->IsReplay || filter->GetFanMask() != vtkLacunaSweptVolume::Automatic)
    {
      this->PlacedSlices = this->GetAllSlices();
    }
    this->ChooseOptions(filter);
    this->ChooseFrame(filter);
    this->ChooseGrid(filter);
  }
}

//------------------------------------------------------------------------------
bool lacuna::SweptVolumePlan::HasStreams() const
{
  return std::any_of(this->Sweeps.begin(), this->Sweeps.end(),
    [](const lacuna::SliceImages& sweep) { return sweep.Stream != nullptr; });
}

//------------------------------------------------------------------------------
void lacuna::SweptVolumePlan::ReadSweeps(vtkLacunaSweptVolume* filter, const lacuna::Ports& ports)
{
  const int count = filter->GetNumberOfInputConnections(0);
  const int needed = filter->GetInterpolation() == vtkLacunaSweptVolume::NearestVoxel ? 1 : 2;
  for (int i = 0; i < count; ++i)
  {
    auto* stack = ports.GetInput<vtkImageData>(0, i);
    if (!stack || stack->GetNumberOfPoints() == 0)
    {
      continue;
    }
    lacuna::SliceSelection selection =
      lacuna::SliceSelection::Make(filter, ports.GetInputInformation(0, i));
    this->IsReplay |= selection.IsReplay;
    selection.HasSweepEnds = filter->GetGapMethod() == vtkLacunaSweptVolume::AutomaticGap;
    selection.Suffix = count > 1 ? " of input " + std::to_string(i) : "";
    this->Sweeps.emplace_back(stack, selection, vtkLacunaSliceStream::Find(filter, 0, i));
    const lacuna::SliceImages& sweep = this->Sweeps.back();
    this->LeftOut.insert(this->LeftOut.end(), sweep.LeftOut.begin(), sweep.LeftOut.end());
    this->IsMoreToCome |= sweep.IsMoreToCome;
    if (static_cast<int>(sweep.Slices.size()) >= needed)
    {
      continue;
    }
    if (sweep.IsMoreToCome && sweep.Others.empty()) // of a sweep that has just begun
    {
      this->Sweeps.pop_back();
    }
    else if (!sweep.IsMoreToCome)
    {
      std::ostringstream message;
      message << "the slices" << selection.Suffix << " are too few: " << sweep.Slices.size()
              << " of " << sweep.GetNumberOfLayers() << " can be used, at least " << needed
              << " are needed";
      if (sweep.GetNumberOfLayers() < needed)
      {
        message << ", since a volume is made of what lies between slices; give more slices, or set "
                   "Interpolation to NearestVoxel, which takes one";
      }
      else
      {
        message << " (" << sweep.DescribeFlags();
        if (!sweep.LeftOut.empty())
        {
          message << "; " << sweep.LeftOut.size() << " have bad poses";
        }
        message << "); " << sweep.DescribeRemedy();
      }
      throw std::runtime_error(message.str());
    }
  }
}

//------------------------------------------------------------------------------
void lacuna::SweptVolumePlan::ApplyFans(vtkLacunaSweptVolume* filter, lacuna::SweptVolumeFans& fans)
{
  if (filter->GetFanMask() != vtkLacunaSweptVolume::Automatic)
  {
    fans = {};
    const lacuna::SliceFan given = lacuna::SliceFan::Make(filter);
    if (filter->GetFanMask() == vtkLacunaSweptVolume::Given && given.HasSector())
    {
      for (lacuna::SliceImages& sweep : this->Sweeps)
      {
        sweep.ApplyFan(given);
      }
    }
    return;
  }
  std::vector<std::intptr_t> key(filter->GetClipRectangle(), filter->GetClipRectangle() + 4);
  key.insert(key.end(),
    { filter->GetUseImageInvalid(), filter->GetUseTooFast(), filter->GetUseGatedOut(),
      filter->GetBadPoses() });
  for (const lacuna::SliceImages& sweep : this->Sweeps)
  {
    key.push_back(reinterpret_cast<std::intptr_t>(sweep.Stack));
    key.push_back(static_cast<std::intptr_t>(sweep.Stack->GetMTime()));
  }
  if (key != fans.Key)
  {
    fans = {};
    for (const lacuna::SliceImages& sweep : this->Sweeps)
    {
      try
      {
        fans.Found.emplace_back(DetectFan(sweep, filter));
      }
      catch (const lacuna::Aborted&)
      {
        fans = {};
        throw;
      }
      catch (const std::runtime_error& error)
      {
        if (sweep.IsMoreToCome)
        {
          fans.Found.emplace_back(); // it will be seen later
          continue;
        }
        fans = {};
        throw std::runtime_error(error.what() +
          std::string(
            ". Give FanOrigin, FanAngles and FanRadii, or a ClipRectangle (Scan Region may "
            "propose them), and set FanMask to Given"));
      }
    }
    fans.Key = key;
  }
  for (std::size_t s = 0; s < this->Sweeps.size(); ++s)
  {
    if (fans.Found[s])
    {
      this->Sweeps[s].ApplyFan(*fans.Found[s]);
    }
    else
    {
      this->Sweeps[s].HideSlices();
    }
  }
}

//------------------------------------------------------------------------------
void lacuna::SweptVolumePlan::ChooseOptions(vtkLacunaSweptVolume* filter)
{
  this->Options.Interpolation =
    static_cast<lacuna::SweptVolume::Method>(filter->GetInterpolation());
  this->Options.Sampling = static_cast<lacuna::PixelSampling>(filter->GetPixelSampling());
  this->Options.Compound = static_cast<lacuna::Compounding>(filter->GetCompounding());
  this->Options.FootprintScale = filter->GetFootprintScale();
  this->Options.FootprintAcrossSlices = filter->GetFootprintAcrossSlices();
  this->Options.MaximumSliceGap =
    filter->GetGapMethod() == vtkLacunaSweptVolume::UnlimitedGap ? 0 : filter->GetMaximumSliceGap();

  const int first = this->Sweeps.front().GreyLevels->GetDataType();
  const bool ofInput = filter->GetOutputScalarType() == vtkLacunaSweptVolume::Input;
  for (const lacuna::SliceImages& sweep : this->Sweeps)
  {
    this->Options.DoublePrecision |=
      lacuna::NeedsDoublePrecision(lacuna::ArrayScalarType::Get(sweep.GreyLevels));
    if (ofInput && sweep.GreyLevels->GetDataType() != first)
    {
      throw std::runtime_error(std::string("the inputs have grey levels of different types (") +
        this->Sweeps.front().GreyLevels->GetDataTypeAsString() + ", " +
        sweep.GreyLevels->GetDataTypeAsString() + "); set OutputScalarType to Float");
    }
  }
  this->ScalarType = ofInput ? first : VTK_FLOAT;
  this->BytesPerVoxel = lacuna::SweptVolume::GetBytesPerVoxel(this->Options) +
    vtkDataArray::GetDataTypeSize(this->ScalarType) +
    static_cast<std::int64_t>(sizeof(unsigned int) + sizeof(char));
}

//------------------------------------------------------------------------------
std::vector<lacuna::SliceImage> lacuna::SweptVolumePlan::GetAllSlices() const
{
  std::vector<lacuna::SliceImage> all;
  for (const lacuna::SliceImages& sweep : this->Sweeps)
  {
    all.insert(all.end(), sweep.Slices.begin(), sweep.Slices.end());
    all.insert(all.end(), sweep.Others.begin(), sweep.Others.end());
  }
  return all;
}

//------------------------------------------------------------------------------
void lacuna::SweptVolumePlan::ChooseFrame(vtkLacunaSweptVolume* filter)
{
  if (filter->GetOutputFrame() == vtkLacunaSweptVolume::Reference)
  {
    return;
  }
  this->FrameToReference = lacuna::GetPrincipalFrame(this->PlacedSlices);
  const lacuna::Matrix4 referenceToFrame = this->FrameToReference.Inverse();
  const auto turn = [&](std::vector<lacuna::SliceImage>& slices)
  {
    for (lacuna::SliceImage& slice : slices)
    {
      slice.PixelToReference = referenceToFrame * slice.PixelToReference;
    }
  };
  turn(this->PlacedSlices);
  for (lacuna::SliceImages& sweep : this->Sweeps)
  {
    turn(sweep.Slices);
  }
}

//------------------------------------------------------------------------------
std::array<double, 9> lacuna::SweptVolumePlan::GetDirection() const
{
  std::array<double, 9> direction;
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      direction[static_cast<std::size_t>(3 * row + column)] = this->FrameToReference(row, column);
    }
  }
  return direction;
}

//------------------------------------------------------------------------------
void lacuna::SweptVolumePlan::ChooseGrid(vtkLacunaSweptVolume* filter)
{
  lacuna::VolumeGridRequest request;
  std::copy_n(filter->GetOutputSpacing(), 3, request.Spacing.data());
  std::copy_n(filter->GetOutputBounds(), 6, request.Bounds.begin());
  request.BytesPerVoxel = this->BytesPerVoxel;
  request.MemoryLimit = filter->GetMemoryLimit() * 1048576.0;
  this->Grid = lacuna::MakeVolumeGrid(this->PlacedSlices, request);
}
