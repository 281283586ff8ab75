// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaBoneEcho.h"

#include "lacunaActivityMap.h"
#include "lacunaArrays.h"
#include "lacunaBoneEcho.h"
#include "lacunaFieldData.h"
#include "lacunaSliceImages.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{
constexpr std::array<const char*, 3> FanMaskNames{ "Given", "Automatic", "None" };

// Cuts slices to what the probe sees.
void ApplyFan(vtkLacunaBoneEcho* self, lacuna::SliceImages& images, lacuna::Execution& execution)
{
  if (self->GetFanMask() == vtkLacunaBoneEcho::Automatic)
  {
    std::vector<unsigned char> storage;
    try
    {
      images.ApplyFan(lacuna::SliceFan::Detect(
        images.Load(lacuna::ActivityMap::ChooseSlices(images.Slices.size()), storage, execution),
        images.Window));
    }
    catch (const lacuna::Aborted&)
    {
      throw;
    }
    catch (const std::runtime_error& error)
    {
      throw std::runtime_error(error.what() +
        std::string(". Give FanOrigin, FanAngles and FanRadii, or a ClipRectangle (Scan Region may "
                    "propose them), and set FanMask to Given"));
    }
  }
  else if (self->GetFanMask() == vtkLacunaBoneEcho::Given)
  {
    const lacuna::SliceFan fan = lacuna::SliceFan::Make(self);
    if (fan.HasSector())
    {
      images.ApplyFan(fan);
    }
  }
}
}

vtkStandardNewMacro(vtkLacunaBoneEcho);

//------------------------------------------------------------------------------
void vtkLacunaBoneEcho::Announce(const lacuna::Ports& ports)
{
  vtkDataObject::SetPointDataActiveScalarInfo(ports.GetOutputInformation(), VTK_FLOAT, 1);
}

//------------------------------------------------------------------------------
void vtkLacunaBoneEcho::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution)
{
  auto* stack = ports.GetInput<vtkImageData>();
  auto* output = ports.GetOutput<vtkImageData>();
  output->ShallowCopy(stack);
  if (!stack || stack->GetNumberOfPoints() == 0)
  {
    return;
  }
  lacuna::SliceImages images(
    stack, lacuna::SliceSelection::Make(this, ports.GetInputInformation()));
  vtkNew<vtkFloatArray> echo;
  echo->SetName("BoneEcho");
  lacuna::Arrays::SetNumberOfTuples(echo, stack->GetNumberOfPoints());
  std::fill_n(echo->GetPointer(0), echo->GetNumberOfTuples(), 0.0f);
  std::map<std::string, std::string> warnings;
  const std::string preview = images.DescribePreview();
  if (!preview.empty())
  {
    warnings["preview"] = preview;
  }
  double area = 0;
  if (!images.Slices.empty())
  {
    execution.SetStage(0, 0.1);
    ApplyFan(this, images, execution);
    const std::vector<int>& layers = images.GetLayers();
    execution.SetStage(0.1, 0.8);
    const lacuna::BoneEcho bone(images.Slices, this->GetOptions(), execution);
    const int* extent = stack->GetExtent();
    const std::int64_t width = extent[1] - extent[0] + 1;
    const std::int64_t height = extent[3] - extent[2] + 1;
    const auto index = [](double value, double origin, double step, int first)
    { return static_cast<std::int64_t>(std::llround((value - origin) / step)) - first; };
    const double* origin = stack->GetOrigin();
    const double* spacing = stack->GetSpacing();
    const std::int64_t first =
      index(images.Window.Origin[1], origin[1], spacing[1], extent[2]) * width +
      index(images.Window.Origin[0], origin[0], spacing[0], extent[0]);
    execution.SetStage(0.8, 1);
    execution.For(static_cast<std::int64_t>(images.Slices.size()), 1,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t i = begin; i < end; ++i)
        {
          bone.Write(static_cast<std::size_t>(i),
            echo->GetPointer((layers[i] - extent[4]) * width * height + first), width);
        }
      });
    area = bone.GetArea();
    if (bone.GetNumberOfBeams() == 0 && !images.IsMoreToCome)
    {
      warnings["none"] =
        "no bone was found: no echo has a shadow behind it. Lower MinimumConfidence or "
        "MinimumArea, and look whether FanMask or ClipRectangle leave what the probe sees";
    }
  }
  else if (!images.IsMoreToCome)
  {
    throw std::runtime_error(
      "no slice is left to look at: " + images.DescribeFlags() + "; " + images.DescribeRemedy());
  }
  this->WarnOfNews(warnings, images.LeftOut);
  output->GetPointData()->AddArray(echo);
  output->GetPointData()->SetActiveScalars(echo->GetName());
  lacuna::FieldData::Set(output, "BoneArea", { area }, 1);
}

//------------------------------------------------------------------------------
lacuna::BoneEchoOptions vtkLacunaBoneEcho::GetOptions() const
{
  lacuna::BoneEchoOptions options;
  options.ShadowLength = this->ShadowLength;
  options.MinimumConfidence = this->MinimumConfidence;
  options.MaximumGap = this->MaximumGap;
  options.MinimumArea = this->MinimumArea;
  options.Thickness = this->Thickness;
  return options;
}

//------------------------------------------------------------------------------
void vtkLacunaBoneEcho::Describe(lacuna::Properties& properties) const
{
  this->GetOptions().Describe(properties);
  this->DescribeClip(properties);
  properties.Add("FanMask", this->FanMask, FanMaskNames);
  this->DescribeSlices(properties);
}
