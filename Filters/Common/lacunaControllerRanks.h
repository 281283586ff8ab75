// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The processes of VTK's global controller.
#ifndef lacunaControllerRanks_h
#define lacunaControllerRanks_h

#include "lacunaRanks.h"
#include "vtkLacunaFiltersCommonModule.h" // for export macro

#include <string>

class vtkMultiProcessController;

namespace lacuna
{
/// Ranks of a pvserver or pvbatch under MPI; one rank alone in any other program. All
/// ranks must call what exchanges data. VTK executes all of them when something has changed; a later
/// request for another piece may come on some ranks only.
class VTKLACUNAFILTERSCOMMON_EXPORT ControllerRanks : public Ranks
{
public:
  ControllerRanks();
  int GetRank() const override;
  int GetNumber() const override;
  void Sum(std::uint32_t* values, std::int64_t count) const override;
  void Sum(std::uint64_t* values, std::int64_t count) const override;
  bool AllFine(bool fine) const override;

  /// The text of the first rank that has one, on all ranks; empty: none has.
  std::string GetFirstText(const std::string& own) const;

private:
  vtkMultiProcessController* Controller; // not owned
};
}
#endif
