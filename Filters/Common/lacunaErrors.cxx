// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaErrors.h"

#include "vtkAlgorithm.h"
#include "vtkCommand.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationIntegerKey.h"
#include "vtkInformationKeyLookup.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkOutputWindow.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"

using SDDP = vtkStreamingDemandDrivenPipeline;

//------------------------------------------------------------------------------
void lacuna::Errors::Empty(vtkInformationVector* outputs)
{
  // else VTK takes what was made of an earlier time, and is no more, for up to date
  vtkInformationKey* const time =
    vtkInformationKeyLookup::Find("PREVIOUS_UPDATE_TIME_STEP", "vtkStreamingDemandDrivenPipeline");
  for (int i = 0; i < outputs->GetNumberOfInformationObjects(); ++i)
  {
    if (vtkDataObject* output = vtkDataObject::GetData(outputs, i))
    {
      output->ReleaseData(); // empty, and VTK asks again for it
    }
    // VTK forgets the combined request only after success: the next one would be united with it,
    // though the whole extent may have become smaller.
    outputs->GetInformationObject(i)->Remove(SDDP::COMBINED_UPDATE_EXTENT());
    if (time)
    {
      outputs->GetInformationObject(i)->Remove(time);
    }
  }
}

//------------------------------------------------------------------------------
void lacuna::Errors::Leave(vtkInformationVector* outputs, const std::string& error)
{
  for (int i = 0; i < outputs->GetNumberOfInformationObjects(); ++i)
  {
    outputs->GetInformationObject(i)->Set(vtkDemandDrivenPipeline::DATA_NOT_GENERATED(), 1);
    if (vtkDataObject* output = vtkDataObject::GetData(outputs, i))
    {
      vtkNew<vtkStringArray> array;
      array->SetName(lacuna::Errors::FieldName);
      array->InsertNextValue(error);
      output->GetFieldData()->AddArray(array);
    }
  }
}

//------------------------------------------------------------------------------
void lacuna::Errors::Repeat(vtkAlgorithm* algorithm, const std::string& error)
{
  vtkObject* listener = algorithm->HasObserver(vtkCommand::ErrorEvent)
    ? static_cast<vtkObject*>(algorithm)
    : vtkOutputWindow::GetInstance();
  std::string copy = error;
  listener->InvokeEvent(vtkCommand::ErrorEvent, copy.data());
}

//------------------------------------------------------------------------------
std::string lacuna::Errors::GetOf(vtkDataObject* data)
{
  if (auto* blocks = vtkCompositeDataSet::SafeDownCast(data))
  {
    const auto block = vtkSmartPointer<vtkCompositeDataIterator>::Take(blocks->NewIterator());
    for (block->InitTraversal(); !block->IsDoneWithTraversal(); block->GoToNextItem())
    {
      std::string error = GetOf(block->GetCurrentDataObject());
      if (!error.empty())
      {
        return error;
      }
    }
  }
  auto* error = data ? vtkStringArray::SafeDownCast(
                         data->GetFieldData()->GetAbstractArray(lacuna::Errors::FieldName))
                     : nullptr;
  return error && error->GetNumberOfValues() > 0 ? error->GetValue(0) : std::string();
}

//------------------------------------------------------------------------------
std::string lacuna::Errors::GetUpstream(vtkAlgorithm* algorithm)
{
  for (int port = 0; port < algorithm->GetNumberOfInputPorts(); ++port)
  {
    for (int i = 0; i < algorithm->GetNumberOfInputConnections(port); ++i)
    {
      std::string error = GetOf(algorithm->GetInputDataObject(port, i));
      if (!error.empty())
      {
        return error;
      }
    }
  }
  return {};
}
