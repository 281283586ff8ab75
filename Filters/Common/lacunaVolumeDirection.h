// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A second record of a volume's direction matrix. Some filters of VTK (Median, Gradient Magnitude,
/// Image Shrink) reset the direction of an image but keep its field data: the volume would then lie
/// turned in the patient, left in the place of right. Every image of Lacuna that is turned has the record
/// (lacuna::Provenance::Record sees to it), those of sources that know the patient's axes also when it is
/// not; filters that take volumes compare. A volume without it is taken as it is.
#ifndef lacunaVolumeDirection_h
#define lacunaVolumeDirection_h

#include "vtkLacunaFiltersCommonModule.h" // for export macro

class vtkDataObject;
class vtkImageData;
class vtkInformation;

namespace lacuna::VolumeDirection
{
/// Field data: the direction matrix row by row, one tuple of 9.
constexpr const char* ArrayName = "DirectionMatrix";

/// Records the direction matrix that volume has.
VTKLACUNAFILTERSCOMMON_EXPORT void Record(vtkImageData* volume);
/// Throws std::runtime_error when data is a volume with voxels and a record that disagrees with its
/// direction matrix.
VTKLACUNAFILTERSCOMMON_EXPORT void Check(vtkDataObject* data);
/// Makes the record of what Lacuna has made right: an image that is turned, or that has a record from its
/// input, gets that of its own direction; other data lose it.
VTKLACUNAFILTERSCOMMON_EXPORT void Update(vtkDataObject* output);
/// Announces an image along the world's axes. Without this VTK 9.3 and later gives it the direction of its input, also
/// when that is only there while an error is told.
VTKLACUNAFILTERSCOMMON_EXPORT void AnnounceAlongAxes(vtkInformation* output);
/// Removes the record, which VTK passes from an input, from what has a geometry of its own.
VTKLACUNAFILTERSCOMMON_EXPORT void Remove(vtkDataObject* data);
}
#endif
