// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Outputs with an extent that changes with time.
///
/// VTK asks a filter once more what it will make when the time is known
/// (REQUEST_TIME_DEPENDENT_INFORMATION), but does not tell those downstream: they go on to ask for, and to
/// show, the extent that they were told before, and cut the rest off without a word.
#ifndef vtkLacunaAnnouncement_h
#define vtkLacunaAnnouncement_h

#include "vtkLacunaFiltersCommonModule.h" // for export macro

#include <functional>
#include <string>

class vtkAlgorithm;
class vtkInformation;
class vtkInformationVector;

namespace vtkLacunaAnnouncement
{
/// For ProcessRequest of filters whose output's extent depends on data that may change with time: answers
/// such a request by inform, which is RequestInformation. Another extent than downstream knows of is an
/// error then when the filter executes (vtkLacunaExecution::Run), unless it is empty.
VTKLACUNAFILTERSCOMMON_EXPORT int Renew(
  vtkAlgorithm* filter, vtkInformationVector* outputs, const std::function<int()>& inform);

/// For ComputePipelineMTime of these filters, at the beginning of the next update: filter is modified when
/// downstream did not know of its extent, so that VTK tells them.
VTKLACUNAFILTERSCOMMON_EXPORT void Publish(vtkAlgorithm* filter, vtkInformationVector* outputs);

/// Keeps the outputs' extents as those that downstream knows of (vtkLacunaExecution::RunInformation does).
VTKLACUNAFILTERSCOMMON_EXPORT void Remember(vtkInformationVector* outputs);

/// An error's text when downstream does not know of an output's extent, which is not empty; else empty.
VTKLACUNAFILTERSCOMMON_EXPORT std::string GetNews(vtkInformationVector* outputs);
}
#endif
