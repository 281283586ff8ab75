// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What is picked in tracked slices to calibrate the probe. Not a part of the module's interface.
#ifndef vtkLacunaCalibrationPicks_h
#define vtkLacunaCalibrationPicks_h

#include "lacunaProbeCalibration.h"
#include "vtkType.h"

#include <optional>
#include <vector>

class vtkImageData;
class vtkLacunaExecution;
class vtkTable;

/// The poses of the probe, and which slices have none. Throws std::runtime_error when the slices
/// have no field data array ProbeToTracker.
class vtkLacunaProbePoses
{
public:
  static constexpr const char* ArrayName = "ProbeToTracker";

  explicit vtkLacunaProbePoses(vtkImageData* slices);
  /// Of the sweep.
  vtkIdType GetCount() const { return static_cast<vtkIdType>(this->Valid.size()); }
  bool IsValid(vtkIdType slice) const { return this->Valid[slice]; }
  const lacuna::Matrix4& Get(vtkIdType slice) const { return this->Matrices[slice]; }

private:
  std::vector<char> Valid;
  std::vector<lacuna::Matrix4> Matrices;
};

/// A pick and the slice in which it was made.
struct vtkLacunaCalibrationPick
{
  vtkIdType Slice;
  lacuna::CalibrationPick Pick;
};

namespace vtkLacunaCalibrationPicks
{
/// From a table with columns Slice, Column, Row and, without a target, Wire (X, Y or Z). Throws
/// std::runtime_error that names row and column.
std::vector<vtkLacunaCalibrationPick> Read(vtkTable* table, const vtkLacunaProbePoses& poses,
  std::optional<lacuna::CalibrationTarget> target);

/// Where the slices show a flat wall, the same for any number of threads: for each slice of the
/// stack the line's two points (column, row), or nothing.
std::vector<std::optional<std::array<lacuna::Vec2, 2>>> FindWalls(
  vtkLacunaExecution& execution, vtkImageData* slices);
}
#endif
