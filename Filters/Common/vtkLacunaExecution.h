// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Runs kernels inside a VTK algorithm: threads, progress, abort, errors.
#ifndef vtkLacunaExecution_h
#define vtkLacunaExecution_h

#include "lacunaExecution.h"
#include "vtkLacunaFiltersCommonModule.h" // for export macro

#include <functional>
#include <stdexcept>

class vtkAlgorithm;
class vtkInformationVector;

/// Thrown by the body of RequestData when the output has another grid than was announced, as of data that
/// change with time: VTK announces grids before the time is known. Those downstream would cut it off.
class VTKLACUNAFILTERSCOMMON_EXPORT vtkLacunaGridChanged : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// Kernel execution on vtkSMPTools. All cores by default: where VTK's back end is the sequential
/// one (Debian's ParaView) and the user did not choose it through VTK_SMP_BACKEND_IN_USE, the
/// std::thread back end is used. VTK_SMP_MAX_THREADS is respected.
class VTKLACUNAFILTERSCOMMON_EXPORT vtkLacunaExecution : public lacuna::Execution
{
public:
  /// Reports the progress of algorithm and asks it whether to stop. Not owned.
  explicit vtkLacunaExecution(vtkAlgorithm* algorithm)
    : Algorithm(algorithm)
  {
  }

  /// Runs the body of algorithm's RequestData if its inputs are sound (vtkLacunaInputs). When body throws or is
  /// stopped, all outputs are emptied, so that no half result looks whole. An exception's text is algorithm's
  /// error each time data are asked for, until something changes (vtkLacunaFailure). After an error of an
  /// algorithm upstream body is not run, and the outputs hold that error, too. Returns 1, also after an error:
  /// VTK goes on, so that views show the empty outputs.
  static int Run(vtkAlgorithm* algorithm, vtkInformationVector* outputs,
    const std::function<void(vtkLacunaExecution&)>& body);

  /// The same without a look at the inputs, for algorithms that all ranks make together: there an
  /// input that is not sound on one rank is an error of all of them (vtkLacunaMeeting).
  static int RunTogether(vtkAlgorithm* algorithm, vtkInformationVector* outputs,
    const std::function<void(vtkLacunaExecution&)>& body);

  /// As Run where isWanted, for algorithms that may fail on some ranks only: of which one rank, or those that
  /// are asked for something, makes all of the output, or which read files. What fails there fails on all
  /// ranks, with the same text, for VTK would leave out what comes behind on the rank that failed alone, and
  /// the others would wait there. So all wait for its outcome once after each change of the algorithm or what
  /// lies upstream, when VTK executes on all ranks. At other times, when another time step or another
  /// part is asked for, perhaps of one rank alone, nobody waits. Ranks agree in ParaView's pipelines only: of
  /// classes in a script one process may be alone with it.
  static int RunAgreed(vtkAlgorithm* algorithm, vtkInformationVector* outputs, bool isWanted,
    const std::function<void(vtkLacunaExecution&)>& body);

  /// Runs the body of algorithm's RequestInformation. Each filter uses it. Returns 1, also after an error:
  /// otherwise VTK would not execute what follows, and views would keep the old picture. After an exception, or
  /// when an input has blocks (vtkLacunaInputs::CheckSingle), the outputs are empty, have an empty whole extent
  /// and no remembered request, so that the next update starts afresh when the cause is mended. The text is an
  /// error only when data are asked for (Run): ParaView asks for information as soon as one of several
  /// properties is set, and never again before the data.
  static int RunInformation(
    vtkAlgorithm* algorithm, vtkInformationVector* outputs, const std::function<void()>& body);

  int GetNumberOfThreads() const override;

protected:
  void Launch(std::int64_t count, std::int64_t grain, const Body& body) override;
  bool OnProgress(double fraction) override;

private:
  vtkAlgorithm* Algorithm;
};
#endif
