// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaExecution.h"

#include "lacunaMemory.h"
#include "lacunaPrintableText.h"
#include "vtkAlgorithm.h"
#include "vtkDataObject.h"
#include "vtkExecutive.h"
#include "vtkInformation.h"
#include "vtkInformationIntegerKey.h"
#include "vtkInformationVector.h"
#include "vtkLacunaFailure.h"
#include "vtkLacunaInputs.h"
#include "vtkLacunaRanks.h"
#include "vtkLacunaRequest.h"
#include "vtkLacunaVersionCompat.h"
#include "vtkSMPTools.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <cstdlib>
#include <new>
#include <string>

namespace
{
using SDDP = vtkStreamingDemandDrivenPipeline;

// The text of what body throws; empty when it ran to its end. Stops and changes of the grid pass through.
std::string ErrorOf(const std::function<void()>& body, bool* isOfMemory = nullptr)
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
  catch (const vtkLacunaGridChanged&)
  {
    throw;
  }
  catch (const std::bad_alloc&)
  {
    if (isOfMemory)
    {
      *isOfMemory = true;
    }
    return "out of memory";
  }
  catch (const lacuna::MemoryExceeded& e)
  {
    if (isOfMemory)
    {
      *isOfMemory = true;
    }
    return lacuna::ToPrintable(e.what());
  }
  catch (const std::exception& e)
  {
    return lacuna::ToPrintable(e.what());
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

// The body of RequestData, if the algorithm is not to stop and its inputs are sound.
std::function<void(vtkLacunaExecution&)> WithSoundInputs(
  vtkAlgorithm* algorithm, const std::function<void(vtkLacunaExecution&)>& body)
{
  return [algorithm, &body](vtkLacunaExecution& execution)
  {
    if (vtkLacunaCheckAbort(algorithm))
    {
      throw lacuna::Aborted();
    }
    vtkLacunaInputs::Check(algorithm);
    body(execution);
  };
}

// Whether an input has blocks, which is then the error of the outputs. The ranks do not meet: they know all blocks, but
// a rank without data in them is not executed.
bool TellOfBlocks(vtkAlgorithm* algorithm, vtkInformationVector* outputs)
{
  try
  {
    vtkLacunaInputs::CheckSingle(algorithm);
    return false;
  }
  catch (const std::runtime_error& blocks)
  {
    vtkLacunaFailure::Empty(outputs);
    const std::string upstream = vtkLacunaFailure::GetUpstream(algorithm);
    if (upstream.empty())
    {
      vtkLacunaFailure::Tell(algorithm, outputs, blocks.what());
    }
    else
    {
      vtkLacunaFailure::PassOn(algorithm, outputs, upstream);
    }
    return true;
  }
}

// Runs body. error: its error, which was told, or that of an input; empty: none. areToldAll: other ranks learn of
// it, and fail, too.
void RunAndTell(vtkAlgorithm* algorithm, vtkInformationVector* outputs,
  const std::function<void(vtkLacunaExecution&)>& body, std::string& error, bool areToldAll)
{
  const bool isAlone = vtkLacunaRanks().GetNumber() == 1;
  error = isAlone ? vtkLacunaFailure::GetUpstream(algorithm) : std::string();
  if (!error.empty()) // of several ranks each still meets the others in body
  {
    vtkLacunaFailure::Empty(outputs);
    vtkLacunaFailure::PassOn(algorithm, outputs, error);
    return;
  }
  const std::string announced = vtkLacunaFailure::GetAnnounced(algorithm);
  try
  {
    // Of several ranks one alone may have failed: what they make together is not left out by one of them.
    error =
      announced.empty() && isAlone ? vtkLacunaFailure::GetRecent(algorithm, outputs) : announced;
    if (error.empty())
    {
      error = ErrorOf(
        [&]
        {
          vtkLacunaExecution execution(algorithm);
          body(execution);
        });
    }
    if (error.empty())
    {
      return;
    }
    vtkLacunaFailure::Empty(outputs);
    if (!areToldAll && !announced.empty() && !isAlone &&
      vtkLacunaFailure::MayBeOfOneRank(algorithm))
    {
      // What comes behind would not do its work on this rank, and others would wait there.
      vtkErrorWithObjectMacro(algorithm, << error);
      error.clear();
      return;
    }
    vtkLacunaFailure::Tell(algorithm, outputs, error);
  }
  catch (const vtkLacunaGridChanged& changed)
  {
    vtkLacunaFailure::Empty(outputs);
    vtkErrorWithObjectMacro(algorithm, << changed.what());
  }
  catch (const lacuna::Aborted&)
  {
    vtkLacunaFailure::Empty(outputs); // not an error: the user asked for it
  }
}
}

//------------------------------------------------------------------------------
int vtkLacunaExecution::Run(vtkAlgorithm* algorithm, vtkInformationVector* outputs,
  const std::function<void(vtkLacunaExecution&)>& body)
{
  return vtkLacunaExecution::RunTogether(algorithm, outputs, WithSoundInputs(algorithm, body));
}

//------------------------------------------------------------------------------
int vtkLacunaExecution::RunTogether(vtkAlgorithm* algorithm, vtkInformationVector* outputs,
  const std::function<void(vtkLacunaExecution&)>& body)
{
  std::string error;
  if (!TellOfBlocks(algorithm, outputs))
  {
    RunAndTell(algorithm, outputs, body, error, false);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaExecution::RunAgreed(vtkAlgorithm* algorithm, vtkInformationVector* outputs,
  bool isWanted, const std::function<void(vtkLacunaExecution&)>& body)
{
  const vtkLacunaRanks ranks;
  const bool isOfParaView = algorithm->GetExecutive()->IsA("vtkPVCompositeDataPipeline");
  if (ranks.GetNumber() == 1 || !isOfParaView)
  {
    return isWanted ? Run(algorithm, outputs, body) : 1;
  }
  if (TellOfBlocks(algorithm, outputs))
  {
    return 1;
  }
  std::string agreed;
  const bool haveMet = vtkLacunaFailure::GetAgreed(algorithm, outputs, agreed);
  std::string own;
  if (agreed.empty() && isWanted)
  {
    RunAndTell(algorithm, outputs, WithSoundInputs(algorithm, body), own, true);
  }
  if (!haveMet)
  {
    agreed = ranks.GetFirstText(own);
    vtkLacunaFailure::SetAgreed(algorithm, outputs, agreed);
  }
  if (own.empty() && agreed.empty())
  {
    vtkLacunaRequest::ForgetNothing(algorithm);
  }
  else if (own.empty())
  {
    vtkLacunaFailure::Empty(outputs);
    vtkLacunaFailure::Tell(algorithm, outputs, haveMet ? vtkLacunaFailure::Again(agreed) : agreed);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaExecution::RunInformation(
  vtkAlgorithm* algorithm, vtkInformationVector* outputs, const std::function<void()>& body)
{
  std::string error;
  vtkLacunaForgetAbort(algorithm);
  vtkLacunaFailure::Announce(algorithm, {});
  for (int i = 0; i < outputs->GetNumberOfInformationObjects(); ++i)
  {
    outputs->GetInformationObject(i)->Remove(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT());
  }
  try
  {
    bool isOfMemory = false; // of which one rank may have less
    error = ErrorOf(
      [&]
      {
        vtkLacunaInputs::CheckSingle(algorithm);
        body();
      },
      &isOfMemory);
    if (error.empty())
    {
      return 1;
    }
    vtkLacunaFailure::Announce(algorithm, error, isOfMemory);
  }
  catch (const lacuna::Aborted&)
  {
    // not an error, see RunTogether: there is nothing, as it was before
  }
  vtkLacunaFailure::Empty(outputs);
  for (int i = 0; i < outputs->GetNumberOfInformationObjects(); ++i)
  {
    // Otherwise VTK keeps the input's whole extent as this algorithm's, and asks for it later.
    vtkInformation* info = outputs->GetInformationObject(i);
    const int nothing[6] = { 0, -1, 0, -1, 0, -1 };
    info->Set(SDDP::WHOLE_EXTENT(), nothing, 6);
    info->Set(SDDP::UPDATE_EXTENT(), nothing, 6);
    info->Set(SDDP::UPDATE_EXTENT_INITIALIZED(), 0);
    // Otherwise VTK executes it, to tell the error, where the first piece is asked for, on one rank alone.
    info->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1);
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
