// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Sources of slices that change with time: a replay, as by the reader, in which slices that are still
/// to come are blank and flagged, and any stack as a function of time.
#ifndef lacunaTestReplay_h
#define lacunaTestReplay_h

#include "lacunaTestStacks.h"
#include "vtkFieldData.h"
#include "vtkImageAlgorithm.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <functional>

namespace lacunaTestStacks
{
/// At time t, from 0 to the number of slices - 1, t + 1 slices have been taken.
class Replay : public vtkImageAlgorithm
{
public:
  static Replay* New() { VTK_STANDARD_NEW_BODY(Replay); }
  vtkTypeMacro(Replay, vtkImageAlgorithm);

  /// The stack after so many slices.
  std::function<vtkSmartPointer<vtkImageData>(int shown)> Show;

protected:
  Replay() { this->SetNumberOfInputPorts(0); }
  int RequestInformation(
    vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    vtkInformation* info = outputs->GetInformationObject(0);
    const auto stack = this->Show(1);
    info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), stack->GetExtent(), 6);
    this->Slices = stack->GetDimensions()[2];
    std::vector<double> steps;
    for (int k = 0; k < this->Slices; ++k)
    {
      steps.push_back(k);
    }
    const double range[2] = { steps.front(), steps.back() };
    info->Set(vtkStreamingDemandDrivenPipeline::TIME_STEPS(), steps.data(), this->Slices);
    info->Set(vtkStreamingDemandDrivenPipeline::TIME_RANGE(), range, 2);
    return 1;
  }
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    vtkInformation* info = outputs->GetInformationObject(0);
    const double time = info->Has(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP())
      ? info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP())
      : this->Slices;
    vtkImageData::GetData(outputs)->ShallowCopy(
      this->Show(static_cast<int>(std::min<double>(this->Slices, time + 1))));
    return 1;
  }

private:
  int Slices = 0;
};

/// The stack of a function of time (0 as long as HasTime is not set), with a count of executions.
class SliceSource : public vtkImageAlgorithm
{
public:
  static SliceSource* New() { VTK_STANDARD_NEW_BODY(SliceSource); }
  vtkTypeMacro(SliceSource, vtkImageAlgorithm);
  std::function<vtkSmartPointer<vtkImageData>(double time)> Show;
  int Executions = 0;
  bool HasTime = false;

protected:
  SliceSource() { this->SetNumberOfInputPorts(0); }
  int RequestInformation(
    vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    vtkInformation* info = outputs->GetInformationObject(0);
    info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), this->Show(0)->GetExtent(), 6);
    if (this->HasTime)
    {
      const double steps[2] = { 0, 100 };
      info->Set(vtkStreamingDemandDrivenPipeline::TIME_STEPS(), steps, 2);
      info->Set(vtkStreamingDemandDrivenPipeline::TIME_RANGE(), steps, 2);
    }
    return 1;
  }
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    ++this->Executions;
    vtkInformation* info = outputs->GetInformationObject(0);
    const double time = info->Has(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP())
      ? info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP())
      : 0;
    vtkImageData* output = vtkImageData::GetData(outputs);
    output->ShallowCopy(this->Show(time));
    if (this->HasTime)
    {
      output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), time);
    }
    return 1;
  }
};
}
#endif
