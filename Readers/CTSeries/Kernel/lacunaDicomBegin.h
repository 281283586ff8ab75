// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Whether a file is DICOM, and where its first element is.
#ifndef lacunaDicomBegin_h
#define lacunaDicomBegin_h

#include "lacunaFileBytes.h"

#include <cstdint>

namespace lacuna
{
enum class DicomBegin
{
  None,     ///< not DICOM
  Preamble, ///< a preamble, DICM, then the file meta information (PS3.10, 7.1)
  Meta,     ///< the file meta information without preamble
  Implicit, ///< a bare data set, implicit VR little endian
  Explicit  ///< a bare data set, explicit VR little endian
};

/// A bare data set, as old scanners and networks leave it, counts as DICOM only when it begins with
/// elements of group 0008 in ascending order, among them a SOP class or a modality as DICOM has it.
DicomBegin FindDicomBegin(FileBytes& bytes);

/// Whether two letters are a value representation of DICOM.
bool IsDicomVr(const char* letters);
/// Whether a value of it has a length of four bytes in explicit syntaxes.
bool HasLongLength(const char* vr);
}
#endif
