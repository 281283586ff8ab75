// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a calibration shows of its picks. Not a part of the module's interface.
#ifndef lacunaCalibrationOutputs_h
#define lacunaCalibrationOutputs_h

#include "lacunaCalibrationPicks.h"

#include <vector>

class vtkImageData;
class vtkPolyData;
class vtkTable;

namespace lacuna
{
namespace CalibrationOutputs
{
/// A row for each pick; the arrays are those of vtkLacunaProbeCalibration's port 1.
void FillTable(const std::vector<SlicePick>& picks, const ProbeCalibration& found, vtkTable* table);

/// The picks in the phantom, and the phantom as far as they reach: port 2.
void FillPhantom(
  const std::vector<SlicePick>& picks, const ProbeCalibration& found, vtkPolyData* picture);

/// The grid of port 3 over a stack of slices with this extent, origin and spacing.
struct ErrorMapGrid
{
  ErrorMapGrid(const int extent[6], const double origin[3], const double spacing[3]);
  int Extent[6];
  double Origin[3], Spacing[3];
};

/// What to expect all over the slices' picture, in its coordinates: port 3.
void FillErrorMap(vtkImageData* slices, const ProbeCalibration& found, vtkImageData* map);

/// The picks on the slices: port 4.
void FillSlices(
  const std::vector<SlicePick>& picks, const ProbeCalibration& found, vtkPolyData* picture);
}
}
#endif
