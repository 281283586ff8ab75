// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A volume in a file: how its voxels are stored, and where they lie in the patient.
///
/// Sources: NRRD format definition (teem.sourceforge.net/nrrd/format.html, sections 3 to 5);
/// MetaImage documentation (itk.org, MetaIO), read as ITK and 3D Slicer read it.
#ifndef lacunaVolumeFile_h
#define lacunaVolumeFile_h

#include "lacunaMatrix4.h"
#include "lacunaSequenceHeader.h"

#include <string>
#include <vector>

namespace lacuna
{
struct VolumeFile
{
  /// The voxels as they are stored: frames are slices.
  SequenceHeader Slices;
  /// (column, row, slice), as stored and counted from 0, to the centre of the voxel in mm: patient
  /// coordinates (DICOM LPS), if the file's axes are the patient's. Not yet checked: see
  /// FindVolumeBox.
  Matrix4 IndexToPatient;
  /// Whether the file says that its axes are the patient's.
  bool IsPatient = false;
  /// A voxel's value is Slope * stored + Intercept.
  double Slope = 1;
  double Intercept = 0;
  /// What a person should know, one sentence each.
  std::vector<std::string> Warnings;
};

/// Reads the header of a MetaImage (.mha, .mhd) or NRRD (.nrrd, .nhdr) file; its content tells
/// which. Throws std::runtime_error with the file's name, the field, what is wrong and what would be
/// right: also where the file gives no spacing, contradicts itself or uses an unknown space or unit.
VolumeFile ReadVolumeFile(const std::string& fileName);
}
#endif
