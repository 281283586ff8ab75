// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Refuses data that are not sound in themselves, whatever a filter wants of them: VTK does not look
/// whether arrays are as long as there are points, and filters would read beyond their ends.
#ifndef vtkLacunaInputs_h
#define vtkLacunaInputs_h

#include "vtkLacunaFiltersCommonModule.h" // for export macro

#include <string>

class vtkAlgorithm;
class vtkDataObject;
class vtkInformation;

namespace vtkLacunaInputs
{
/// Throws std::runtime_error that begins with name when a point or cell array has another number of
/// tuples than there are points or cells, columns of a table differ in length, origin, spacing or
/// direction of an image are not finite, or an index of its extent is beyond 2^30. Blocks of composite data are looked at one by one; data
/// without points, cells and rows are sound.
VTKLACUNAFILTERSCOMMON_EXPORT void Check(vtkDataObject* data, const std::string& name);

/// Throws when data is an image of which less arrived than info asks for, as behind filters that give each rank a part.
VTKLACUNAFILTERSCOMMON_EXPORT void CheckPart(
  vtkDataObject* data, vtkInformation* info, const std::string& name);

/// All inputs that algorithm has, by the numbers of their ports. Throws, too, when an input holds the error of an
/// algorithm upstream (vtkLacunaFailure), when an image was refused
/// (vtkLacunaRequest::Whole), or less of it arrived than algorithm asked for, as behind ParaView's
/// Resample To Image on several ranks, or when it is known of a filter upstream that it gives ranks
/// different points or rows, whatever they ask for, as Redistribute Data Set does.
VTKLACUNAFILTERSCOMMON_EXPORT void Check(vtkAlgorithm* algorithm);

/// Those of one port.
VTKLACUNAFILTERSCOMMON_EXPORT void Check(vtkAlgorithm* algorithm, int port);

/// Throws std::runtime_error when an input has blocks and algorithm does not take them: VTK would execute it
/// block by block, with what was announced for all of them. Also throws for each of these blocks.
VTKLACUNAFILTERSCOMMON_EXPORT void CheckSingle(vtkAlgorithm* algorithm);
}
#endif
