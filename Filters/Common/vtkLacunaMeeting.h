// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// When ranks meet, and what each of them then knows.
#ifndef vtkLacunaMeeting_h
#define vtkLacunaMeeting_h

#include "vtkLacunaFiltersCommonModule.h" // for export macro

#include <functional>
#include <string>
#include <vector>

namespace lacuna
{
class Ranks;
}
class vtkAlgorithm;
class vtkInformationVector;

/// For filters that all ranks of an MPI program make together (vtkLacunaRanks). VTK executes them on
/// all ranks when something has changed, and later on those only that are asked for another part, or
/// that have nothing because of an error: if these met again, they would wait for the others for ever.
/// So whether ranks meet may depend on nothing but what is the same on all of them: the times at which
/// something changed (vtkLacunaRequest::GetTimes), neither on what a rank could get nor on an error.
class VTKLACUNAFILTERSCOMMON_EXPORT vtkLacunaMeeting
{
public:
  /// For RequestUpdateExtent: asks for all of each input as vtkLacunaRequest::Whole does. When one
  /// does not fit into the memory of this rank Hold says so on all ranks.
  void AskForWhole(
    vtkAlgorithm* filter, vtkInformationVector** inputs, vtkInformationVector* wanted = nullptr);

  /// For RequestData, on every rank, whatever it has and is asked for: calls body, in which ranks may
  /// meet, and returns true; or returns false when they have met at these times. Throws what body
  /// throws, and std::runtime_error on all ranks when one was refused its input, has one that is not
  /// sound (vtkLacunaInputs; so the filter runs by vtkLacunaExecution::RunTogether), or has data and
  /// another one has none. Several ranks have the same error later at the same times, without body; one rank
  /// alone tries again.
  bool Hold(vtkAlgorithm* filter, const std::vector<double>& times, bool hasData,
    const lacuna::Ranks& ranks, const std::function<void()>& body);

  /// The next Hold calls body.
  void Forget() { this->Times.clear(); }

private:
  std::vector<double> Times;
  std::string Error; ///< at these times; empty: none
};
#endif
