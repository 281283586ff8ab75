// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaExecution.h"

#include "vtkAlgorithm.h"
#include "vtkCallbackCommand.h"
#include "vtkCommand.h"
#include "vtkDataObject.h"
#include "vtkExecutive.h"
#include "vtkInformation.h"
#include "vtkInformationDoubleVectorKey.h"
#include "vtkInformationIntegerKey.h"
#include "vtkInformationKeyLookup.h"
#include "vtkInformationStringKey.h"
#include "vtkInformationVector.h"
#include "vtkLacunaInputs.h"
#include "vtkLacunaRequest.h"
#include "vtkLacunaVersionCompat.h"
#include "vtkNew.h"
#include "vtkOutputWindow.h"
#include "vtkSMPTools.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <chrono>
#include <cstdlib>
#include <new>
#include <string>

namespace
{
using SDDP = vtkStreamingDemandDrivenPipeline;

constexpr double SecondsShown = 5; // in which the same error is not shown again

// In what an algorithm knows of itself: the error of its RequestInformation.
vtkInformationStringKey* Announced()
{
  static vtkInformationStringKey* const key =
    vtkInformationStringKey::MakeKey("ANNOUNCED_ERROR", "vtkLacunaExecution");
  return key;
}

// The error that was shown last, and when: by the clock, and by the time of the algorithm.
vtkInformationStringKey* Shown()
{
  static vtkInformationStringKey* const key =
    vtkInformationStringKey::MakeKey("SHOWN_ERROR", "vtkLacunaExecution");
  return key;
}
vtkInformationDoubleVectorKey* ShownAt()
{
  static vtkInformationDoubleVectorKey* const key =
    vtkInformationDoubleVectorKey::MakeKey("SHOWN_ERROR_AT", "vtkLacunaExecution", 2);
  return key;
}

// Whether an error is on the screen already; from now on it is.
bool IsShown(vtkAlgorithm* algorithm, const std::string& error)
{
  const double now =
    std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  const auto changed = static_cast<double>(algorithm->GetMTime());
  vtkInformation* info = algorithm->GetInformation();
  const double* at = info->Get(ShownAt());
  if (at && now - at[0] < SecondsShown && at[1] == changed && error == info->Get(Shown()))
  {
    return true;
  }
  info->Set(Shown(), error);
  const double place[2] = { now, changed };
  info->Set(ShownAt(), place, 2);
  return false;
}

// An error that is on the screen already: tells only who listens.
void Repeat(vtkAlgorithm* algorithm, const std::string& error)
{
  vtkObject* listener = algorithm->HasObserver(vtkCommand::ErrorEvent)
    ? static_cast<vtkObject*>(algorithm)
    : vtkOutputWindow::GetInstance();
  std::string copy = error;
  listener->InvokeEvent(vtkCommand::ErrorEvent, copy.data());
  // The executive adds that the algorithm has failed, unless it has an observer: one for once.
  vtkNew<vtkCallbackCommand> once;
  once->SetClientData(once);
  once->SetCallback([](vtkObject* caller, unsigned long, void* self, void*)
    { caller->RemoveObserver(static_cast<vtkCommand*>(self)); });
  algorithm->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, once);
}

// Of empty data VTK takes for up to date nobody would hear any more, and writers would put nothing in the
// place of good files: so the algorithm executes, and fails, for each who asks. ParaView asks several times
// for one command.
void Fail(vtkAlgorithm* algorithm, vtkInformationVector* outputs, const std::string& error)
{
  for (int i = 0; i < outputs->GetNumberOfInformationObjects(); ++i)
  {
    outputs->GetInformationObject(i)->Set(vtkDemandDrivenPipeline::DATA_NOT_GENERATED(), 1);
  }
  if (IsShown(algorithm, error))
  {
    Repeat(algorithm, error);
  }
  else
  {
    vtkErrorWithObjectMacro(algorithm, << error);
  }
}

void EmptyOutputs(vtkInformationVector* outputs)
{
  // else VTK takes what was made of an earlier time, and is no more, for up to date
  vtkInformationKey* const time =
    vtkInformationKeyLookup::Find("PREVIOUS_UPDATE_TIME_STEP", "vtkStreamingDemandDrivenPipeline");
  for (int i = 0; i < outputs->GetNumberOfInformationObjects(); ++i)
  {
    if (vtkDataObject* output = vtkDataObject::GetData(outputs, i))
    {
      output->Initialize();
    }
    // VTK forgets the combined request only after success: the next one would be united with it,
    // though the whole extent may have become smaller.
    outputs->GetInformationObject(i)->Remove(SDDP::COMBINED_UPDATE_EXTENT());
    if (time)
    {
      outputs->GetInformationObject(i)->Remove(time);
    }
  }
  vtkLacunaRequest::Limit(outputs);
}

// The text of what body throws; empty when it ran to its end. Aborted passes through.
std::string ErrorOf(const std::function<void()>& body)
{
  try
  {
    body();
    return {};
  }
  catch (const lacuna::Aborted&)
  {
    throw;
  }
  catch (const std::bad_alloc&)
  {
    return "out of memory";
  }
  catch (const std::exception& e)
  {
    return e.what();
  }
}

// Calls body where VTK's loops run on all cores.
template <typename Callable>
void Parallel(const Callable& body)
{
  const bool sequential = std::string(vtkSMPTools::GetBackend()) == "Sequential";
  if (sequential && !std::getenv("VTK_SMP_BACKEND_IN_USE"))
  {
    vtkSMPTools::LocalScope(vtkSMPTools::Config{ std::string("STDThread") }, body);
  }
  else
  {
    body();
  }
}
}

//------------------------------------------------------------------------------
int vtkLacunaExecution::Run(vtkAlgorithm* algorithm, vtkInformationVector* outputs,
  const std::function<void(vtkLacunaExecution&)>& body)
{
  return vtkLacunaExecution::RunTogether(algorithm, outputs,
    [&](vtkLacunaExecution& execution)
    {
      if (vtkLacunaCheckAbort(algorithm))
      {
        throw lacuna::Aborted();
      }
      vtkLacunaInputs::Check(algorithm);
      body(execution);
    });
}

//------------------------------------------------------------------------------
int vtkLacunaExecution::RunTogether(vtkAlgorithm* algorithm, vtkInformationVector* outputs,
  const std::function<void(vtkLacunaExecution&)>& body)
{
  if (!vtkLacunaInputs::AreSingle(algorithm))
  {
    EmptyOutputs(outputs);
    return 0;
  }
  int result = 0;
  try
  {
    const std::string error = ErrorOf(
      [&]
      {
        try
        {
          if (const char* announced = algorithm->GetInformation()->Get(Announced()))
          {
            throw std::runtime_error(announced);
          }
          vtkLacunaRequest::Limit(outputs);
          vtkLacunaExecution execution(algorithm);
          body(execution);
        }
        catch (const vtkLacunaGridChanged&)
        {
          result = 1;
          throw;
        }
      });
    if (error.empty())
    {
      return 1;
    }
    EmptyOutputs(outputs);
    if (result == 1)
    {
      vtkErrorWithObjectMacro(algorithm, << error);
    }
    else
    {
      Fail(algorithm, outputs, error);
    }
    return result;
  }
  catch (const lacuna::Aborted&)
  {
    EmptyOutputs(outputs);
    return 1; // not an error: the user asked for it
  }
}

//------------------------------------------------------------------------------
int vtkLacunaExecution::RunInformation(
  vtkAlgorithm* algorithm, vtkInformationVector* outputs, const std::function<void()>& body)
{
  std::string error;
  vtkLacunaForgetAbort(algorithm);
  algorithm->GetInformation()->Remove(Announced());
  try
  {
    if (!vtkLacunaInputs::AreSingle(algorithm))
    {
      return 0;
    }
    error = ErrorOf(body);
    if (error.empty())
    {
      return 1;
    }
    algorithm->GetInformation()->Set(Announced(), error);
  }
  catch (const lacuna::Aborted&)
  {
    // not an error, see RunTogether: there is nothing, as it was before
  }
  EmptyOutputs(outputs);
  for (int i = 0; i < outputs->GetNumberOfInformationObjects(); ++i)
  {
    // Otherwise VTK keeps the input's whole extent as this algorithm's, and asks for it later.
    vtkInformation* info = outputs->GetInformationObject(i);
    const int nothing[6] = { 0, -1, 0, -1, 0, -1 };
    info->Set(SDDP::WHOLE_EXTENT(), nothing, 6);
    info->Set(SDDP::UPDATE_EXTENT(), nothing, 6);
    info->Set(SDDP::UPDATE_EXTENT_INITIALIZED(), 0);
  }
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaExecution::Launch(std::int64_t count, std::int64_t grain, const Body& body)
{
  Parallel([&] { vtkSMPTools::For(0, count, grain, body); });
}

//------------------------------------------------------------------------------
int vtkLacunaExecution::GetNumberOfThreads() const
{
  int threads = 1;
  Parallel([&] { threads = vtkSMPTools::GetEstimatedNumberOfThreads(); });
  return threads;
}

//------------------------------------------------------------------------------
bool vtkLacunaExecution::OnProgress(double fraction)
{
  this->Algorithm->UpdateProgress(fraction);
  return !vtkLacunaCheckAbort(this->Algorithm);
}
