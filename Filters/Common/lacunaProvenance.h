// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where a result comes from, carried by every output.
#ifndef lacunaProvenance_h
#define lacunaProvenance_h

#include "vtkLacunaFiltersCommonModule.h" // for export macro

#include <string>
#include <vector>

class vtkDataObject;
class vtkObjectBase;

namespace lacuna::Provenance
{
/// Name of the field data string array: one string per processing step, the oldest first.
constexpr const char* ArrayName = "Provenance";

/// Lacuna's version, for example "0.1.0".
VTKLACUNAFILTERSCOMMON_EXPORT const char* GetVersion();

/// Copies the steps of the inputs to output and adds one for this step: version, class, a hash of
/// each input's active point scalars (of a mesh without: its points; of a table: its numbers),
/// parameters ("Name=value Name=value"). Never a patient's name. Of the first input, the one that
/// output is made of, it also passes on the marks that it is mirrored (Mirrored) and in
/// which coordinates it is (Coordinates). An image that is turned gets the record of its
/// direction (VolumeDirection), so its geometry must be set before.
/// Without inputs the steps that output has already come first, such as those in a file.
VTKLACUNAFILTERSCOMMON_EXPORT void Record(vtkDataObject* output, vtkObjectBase* algorithm,
  const std::vector<vtkDataObject*>& inputs, const std::string& parameters);

/// The steps of data, the oldest first; empty when it carries none.
VTKLACUNAFILTERSCOMMON_EXPORT std::vector<std::string> Get(vtkDataObject* data);
}
#endif
