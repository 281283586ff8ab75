// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The grey level of a surface that a panel proposes, from the data.
#ifndef lacunaProposedLevel_h
#define lacunaProposedLevel_h

#include "vtkLacunaFiltersCommonModule.h" // for export macro

#include <array>
#include <string>

class vtkAlgorithm;

namespace lacuna
{
/// Domains take it as the range of one value that an information property reports.
namespace ProposedLevel
{
/// Twice the level for the point array (empty: the active scalars) of what is connected to port 0, as it is
/// now: 500 in Hounsfield units, which are known by the array's name or by a range from air to bone (-200 to
/// 500), else the middle of the range. Without data, or when all of it is equal, twice otherwise.
VTKLACUNAFILTERSCOMMON_EXPORT std::array<double, 2> Get(
  vtkAlgorithm* filter, const std::string& array, double otherwise);
}
}
#endif
