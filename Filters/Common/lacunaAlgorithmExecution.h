// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Runs kernels inside a VTK algorithm: threads, progress, stops.
#ifndef lacunaAlgorithmExecution_h
#define lacunaAlgorithmExecution_h

#include "lacunaExecution.h"
#include "vtkLacunaFiltersCommonModule.h" // for export macro

class vtkAlgorithm;

namespace lacuna
{
/// Kernel execution on vtkSMPTools. All cores by default: where VTK's back end is the sequential
/// one (Debian's ParaView) and the user did not choose it through VTK_SMP_BACKEND_IN_USE, the
/// std::thread back end is used. VTK_SMP_MAX_THREADS is respected.
class VTKLACUNAFILTERSCOMMON_EXPORT AlgorithmExecution : public Execution
{
public:
  /// Reports the progress of algorithm and asks it whether to stop. Not owned.
  explicit AlgorithmExecution(vtkAlgorithm* algorithm)
    : Algorithm(algorithm)
  {
  }

  int GetNumberOfThreads() const override;

protected:
  void Launch(std::int64_t count, std::int64_t grain, const Body& body) override;
  bool OnProgress(double fraction) override;

private:
  vtkAlgorithm* Algorithm;
};
}
#endif
