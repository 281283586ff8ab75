// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaFailure.h"

#include "vtkAlgorithm.h"
#include "vtkCommand.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationDoubleKey.h"
#include "vtkInformationDoubleVectorKey.h"
#include "vtkInformationIntegerKey.h"
#include "vtkInformationKeyLookup.h"
#include "vtkInformationStringKey.h"
#include "vtkInformationVector.h"
#include "vtkLacunaRequest.h"
#include "vtkNew.h"
#include "vtkOutputWindow.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <vector>

namespace
{
using SDDP = vtkStreamingDemandDrivenPipeline;

constexpr double Moment = 5; // seconds

// All of them in what an algorithm knows of itself.
vtkInformationStringKey* Announced()
{
  static vtkInformationStringKey* const key =
    vtkInformationStringKey::MakeKey("ANNOUNCED_ERROR", "vtkLacunaFailure");
  return key;
}
vtkInformationIntegerKey* AnnouncedOfMemory()
{
  static vtkInformationIntegerKey* const key =
    vtkInformationIntegerKey::MakeKey("ANNOUNCED_ERROR_OF_MEMORY", "vtkLacunaFailure");
  return key;
}
vtkInformationIntegerKey* OfFiles()
{
  static vtkInformationIntegerKey* const key =
    vtkInformationIntegerKey::MakeKey("DEPENDS_ON_FILES", "vtkLacunaFailure");
  return key;
}
vtkInformationStringKey* Told()
{
  static vtkInformationStringKey* const key =
    vtkInformationStringKey::MakeKey("TOLD_ERROR", "vtkLacunaFailure");
  return key;
}
// Whether nobody listened, so that it was shown.
vtkInformationIntegerKey* ToldOnScreen()
{
  static vtkInformationIntegerKey* const key =
    vtkInformationIntegerKey::MakeKey("TOLD_ERROR_ON_SCREEN", "vtkLacunaFailure");
  return key;
}
vtkInformationDoubleKey* ToldAt()
{
  static vtkInformationDoubleKey* const key =
    vtkInformationDoubleKey::MakeKey("TOLD_ERROR_AT", "vtkLacunaFailure");
  return key;
}
vtkInformationDoubleVectorKey* ToldOf()
{
  static vtkInformationDoubleVectorKey* const key =
    vtkInformationDoubleVectorKey::MakeKey("TOLD_ERROR_OF", "vtkLacunaFailure");
  return key;
}

vtkInformationStringKey* Agreed()
{
  static vtkInformationStringKey* const key =
    vtkInformationStringKey::MakeKey("AGREED_ERROR", "vtkLacunaFailure");
  return key;
}
vtkInformationDoubleVectorKey* AgreedOf()
{
  static vtkInformationDoubleVectorKey* const key =
    vtkInformationDoubleVectorKey::MakeKey("AGREED_ERROR_OF", "vtkLacunaFailure");
  return key;
}

// What changes on all ranks at once, so that VTK executes on all of them; and the time asked for.
std::array<double, 2> GetSharedState(vtkAlgorithm* algorithm, vtkInformationVector* outputs)
{
  vtkInformation* info = outputs->GetInformationObject(0);
  return { static_cast<double>(vtkLacunaRequest::GetNewestTime(algorithm)),
    info->Has(SDDP::UPDATE_TIME_STEP()) ? info->Get(SDDP::UPDATE_TIME_STEP()) : 0 };
}

bool HasTimes(vtkInformation* info)
{
  return info->Has(SDDP::TIME_RANGE()) || info->Has(SDDP::TIME_STEPS());
}

// Whether an input changes with time, or what a source gives.
bool HasTimes(vtkAlgorithm* algorithm)
{
  for (int port = 0; port < algorithm->GetNumberOfOutputPorts(); ++port)
  {
    if (HasTimes(algorithm->GetOutputInformation(port)))
    {
      return true;
    }
  }
  for (int port = 0; port < algorithm->GetNumberOfInputPorts(); ++port)
  {
    for (int i = 0; i < algorithm->GetNumberOfInputConnections(port); ++i)
    {
      if (HasTimes(algorithm->GetInputInformation(port, i)))
      {
        return true;
      }
    }
  }
  return false;
}

double GetSeconds()
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Of the algorithm itself and what lies upstream, first; then all else on which the outcome depends: the inputs
// (blocks come one by one), and what is asked for.
std::vector<double> GetState(vtkAlgorithm* algorithm, vtkInformationVector* outputs)
{
  std::vector<double> state{ static_cast<double>(algorithm->GetMTime()),
    static_cast<double>(vtkLacunaRequest::GetNewestTime(algorithm)) };
  for (int port = 0; port < algorithm->GetNumberOfInputPorts(); ++port)
  {
    for (int i = 0; i < algorithm->GetNumberOfInputConnections(port); ++i)
    {
      vtkDataObject* data = algorithm->GetInputDataObject(port, i);
      state.push_back(data ? static_cast<double>(data->GetMTime()) : 0);
    }
  }
  for (int i = 0; i < outputs->GetNumberOfInformationObjects(); ++i)
  {
    vtkInformation* info = outputs->GetInformationObject(i);
    state.push_back(info->Get(SDDP::UPDATE_PIECE_NUMBER()));
    state.push_back(info->Get(SDDP::UPDATE_NUMBER_OF_PIECES()));
    state.push_back(info->Has(SDDP::UPDATE_TIME_STEP()) ? info->Get(SDDP::UPDATE_TIME_STEP()) : 0);
    if (const int* extent = info->Get(SDDP::UPDATE_EXTENT()))
    {
      state.insert(state.end(), extent, extent + 6);
    }
  }
  return state;
}

// The state in which an error was told a moment ago; empty: none was.
std::vector<double> GetToldState(vtkAlgorithm* algorithm)
{
  vtkInformation* own = algorithm->GetInformation();
  if (!own->Has(ToldAt()) || GetSeconds() - own->Get(ToldAt()) > Moment)
  {
    return {};
  }
  const double* state = own->Get(ToldOf());
  return { state, state + own->Length(ToldOf()) };
}
}

//------------------------------------------------------------------------------
void vtkLacunaFailure::DependsOnFiles(vtkAlgorithm* algorithm)
{
  algorithm->GetInformation()->Set(OfFiles(), 1);
}

//------------------------------------------------------------------------------
void vtkLacunaFailure::Announce(vtkAlgorithm* algorithm, const std::string& error, bool isOfMemory)
{
  algorithm->GetInformation()->Set(Announced(), error);
  algorithm->GetInformation()->Set(AnnouncedOfMemory(), isOfMemory ? 1 : 0);
}

//------------------------------------------------------------------------------
bool vtkLacunaFailure::MayBeOfOneRank(vtkAlgorithm* algorithm)
{
  vtkInformation* own = algorithm->GetInformation();
  return own->Get(OfFiles()) != 0 || own->Get(AnnouncedOfMemory()) != 0;
}

//------------------------------------------------------------------------------
std::string vtkLacunaFailure::GetAnnounced(vtkAlgorithm* algorithm)
{
  const char* error = algorithm->GetInformation()->Get(Announced());
  return error ? error : "";
}

//------------------------------------------------------------------------------
std::string vtkLacunaFailure::GetRecent(vtkAlgorithm* algorithm, vtkInformationVector* outputs)
{
  vtkInformation* own = algorithm->GetInformation();
  const std::vector<double> told = GetToldState(algorithm);
  return !own->Has(OfFiles()) && !told.empty() && told == GetState(algorithm, outputs)
    ? own->Get(Told())
    : "";
}

//------------------------------------------------------------------------------
bool vtkLacunaFailure::GetAgreed(
  vtkAlgorithm* algorithm, vtkInformationVector* outputs, std::string& error)
{
  vtkInformation* own = algorithm->GetInformation();
  const std::array<double, 2> state = GetSharedState(algorithm, outputs);
  const double* met = own->Has(AgreedOf()) ? own->Get(AgreedOf()) : nullptr;
  if (!met || met[0] != state[0])
  {
    return false;
  }
  error = met[1] == state[1] || !HasTimes(algorithm) ? own->Get(Agreed()) : "";
  return true;
}

//------------------------------------------------------------------------------
void vtkLacunaFailure::SetAgreed(
  vtkAlgorithm* algorithm, vtkInformationVector* outputs, const std::string& error)
{
  vtkInformation* own = algorithm->GetInformation();
  own->Set(AgreedOf(), GetSharedState(algorithm, outputs).data(), 2);
  own->Set(Agreed(), error);
}

//------------------------------------------------------------------------------
std::string vtkLacunaFailure::Again(const std::string& error)
{
  return error + " (change a property to try again)";
}

//------------------------------------------------------------------------------
void vtkLacunaFailure::Empty(vtkInformationVector* outputs)
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
void vtkLacunaFailure::Leave(vtkInformationVector* outputs, const std::string& error)
{
  for (int i = 0; i < outputs->GetNumberOfInformationObjects(); ++i)
  {
    outputs->GetInformationObject(i)->Set(vtkDemandDrivenPipeline::DATA_NOT_GENERATED(), 1);
    if (vtkDataObject* output = vtkDataObject::GetData(outputs, i))
    {
      vtkNew<vtkStringArray> array;
      array->SetName(vtkLacunaFailure::FieldName);
      array->InsertNextValue(error);
      output->GetFieldData()->AddArray(array);
    }
  }
}

//------------------------------------------------------------------------------
void vtkLacunaFailure::Repeat(vtkAlgorithm* algorithm, const std::string& error)
{
  vtkObject* listener = algorithm->HasObserver(vtkCommand::ErrorEvent)
    ? static_cast<vtkObject*>(algorithm)
    : vtkOutputWindow::GetInstance();
  std::string copy = error;
  listener->InvokeEvent(vtkCommand::ErrorEvent, copy.data());
}

//------------------------------------------------------------------------------
std::string vtkLacunaFailure::GetOf(vtkDataObject* data)
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
                         data->GetFieldData()->GetAbstractArray(vtkLacunaFailure::FieldName))
                     : nullptr;
  return error && error->GetNumberOfValues() > 0 ? error->GetValue(0) : std::string();
}

//------------------------------------------------------------------------------
std::string vtkLacunaFailure::GetUpstream(vtkAlgorithm* algorithm)
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

//------------------------------------------------------------------------------
void vtkLacunaFailure::Tell(
  vtkAlgorithm* algorithm, vtkInformationVector* outputs, const std::string& error)
{
  Leave(outputs, error);
  if (!vtkObject::GetGlobalWarningDisplay())
  {
    return;
  }
  vtkInformation* own = algorithm->GetInformation();
  const std::vector<double> told = GetToldState(algorithm);
  const std::vector<double> state = GetState(algorithm, outputs);
  const bool isShown = !told.empty() && own->Get(ToldOnScreen()) != 0 && told[0] == state[0] &&
    told[1] == state[1] && error == own->Get(Told());
  own->Set(ToldOf(), state.data(), static_cast<int>(state.size()));
  if (isShown)
  {
    Repeat(algorithm, error);
    return;
  }
  own->Set(Told(), error);
  own->Set(ToldAt(), GetSeconds());
  own->Set(ToldOnScreen(), algorithm->HasObserver(vtkCommand::ErrorEvent) ? 0 : 1);
  vtkErrorWithObjectMacro(algorithm, << error);
}

//------------------------------------------------------------------------------
void vtkLacunaFailure::PassOn(
  vtkAlgorithm* algorithm, vtkInformationVector* outputs, const std::string& error)
{
  Leave(outputs, error);
  if (vtkObject::GetGlobalWarningDisplay())
  {
    Repeat(algorithm, error);
  }
}
