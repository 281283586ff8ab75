// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaExecution.h"

#include "vtkAlgorithm.h"
#include "vtkDataObject.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLacunaVersionCompat.h"
#include "vtkSMPTools.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <cstdlib>
#include <new>
#include <string>

namespace
{
void EmptyOutputs(vtkInformationVector* outputs)
{
  for (int i = 0; i < outputs->GetNumberOfInformationObjects(); ++i)
  {
    if (vtkDataObject* output = vtkDataObject::GetData(outputs, i))
    {
      output->Initialize();
    }
    // VTK forgets the combined request only after success: the next one would be united with it,
    // though the whole extent may have become smaller.
    outputs->GetInformationObject(i)->Remove(
      vtkStreamingDemandDrivenPipeline::COMBINED_UPDATE_EXTENT());
  }
}
}

//------------------------------------------------------------------------------
int vtkLacunaExecution::Run(vtkAlgorithm* algorithm, vtkInformationVector* outputs,
  const std::function<void(vtkLacunaExecution&)>& body)
{
  std::string error;
  try
  {
    vtkLacunaExecution execution(algorithm);
    body(execution);
    return 1;
  }
  catch (const lacuna::Aborted&)
  {
    EmptyOutputs(outputs);
    return 1; // not an error: the user asked for it
  }
  catch (const std::bad_alloc&)
  {
    error = "out of memory";
  }
  catch (const std::exception& e)
  {
    error = e.what();
  }
  EmptyOutputs(outputs);
  vtkErrorWithObjectMacro(algorithm, << error);
  return 0;
}

//------------------------------------------------------------------------------
void vtkLacunaExecution::Launch(std::int64_t count, std::int64_t grain, const Body& body)
{
  const auto loop = [&] { vtkSMPTools::For(0, count, grain, body); };
  const bool sequential = std::string(vtkSMPTools::GetBackend()) == "Sequential";
  if (sequential && !std::getenv("VTK_SMP_BACKEND_IN_USE"))
  {
    vtkSMPTools::LocalScope(vtkSMPTools::Config{ std::string("STDThread") }, loop);
  }
  else
  {
    loop();
  }
}

//------------------------------------------------------------------------------
bool vtkLacunaExecution::OnProgress(double fraction)
{
  this->Algorithm->UpdateProgress(fraction);
  return !vtkLacunaCheckAbort(this->Algorithm);
}
