// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What holds for each output, and how two are compared.
#ifndef lacunaVerdict_h
#define lacunaVerdict_h

#include <cstdint>
#include <map>
#include <set>
#include <string>

class vtkAlgorithm;
class vtkDataObject;

namespace lacunaProperties
{
/// A hash of each part of data (geometry, points, cells, each array), so that a difference has a name.
using Fingerprint = std::map<std::string, std::uint64_t>;
Fingerprint TakeFingerprint(vtkDataObject* data);

/// The names of what differs; empty when nothing does.
std::string Compare(const Fingerprint& first, const Fingerprint& second);

/// Neither points, cells nor rows.
bool IsEmpty(vtkDataObject* data);

/// What is wrong with the output of a port: arrays of another length than there are points or cells,
/// cells with points that do not exist, points or (with isInputFinite) values that are not finite
/// and not in an array that may have NaN), no provenance, or other extent, geometry or scalars than
/// RequestInformation promised. Empty when nothing is.
std::string FindFault(
  vtkAlgorithm* algorithm, int port, bool isInputFinite, const std::set<std::string>& mayBeNaN);
}
#endif
