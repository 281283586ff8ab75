// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaAlgorithmExecution.h"

#include "lacunaVersionCompat.h"
#include "vtkAlgorithm.h"
#include "vtkSMPTools.h"

#include <cstdlib>
#include <string>

namespace
{
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
void lacuna::AlgorithmExecution::Launch(std::int64_t count, std::int64_t grain, const Body& body)
{
  Parallel([&] { vtkSMPTools::For(0, count, grain, body); });
}

//------------------------------------------------------------------------------
int lacuna::AlgorithmExecution::GetNumberOfThreads() const
{
  int threads = 1;
  Parallel([&] { threads = vtkSMPTools::GetEstimatedNumberOfThreads(); });
  return threads;
}

//------------------------------------------------------------------------------
bool lacuna::AlgorithmExecution::OnProgress(double fraction)
{
  this->Algorithm->UpdateProgress(fraction);
  return !lacuna::CheckAbort(this->Algorithm);
}
