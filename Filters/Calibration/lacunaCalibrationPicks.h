// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What is picked, or found, in tracked slices to calibrate the probe. Not a part of the module's interface.
#ifndef lacunaCalibrationPicks_h
#define lacunaCalibrationPicks_h

#include "lacunaProbeCalibration.h"
#include "lacunaWireRanges.h"
#include "vtkType.h"

#include <optional>
#include <string>
#include <vector>

class vtkImageData;
class vtkDataObject;
namespace lacuna
{
class AlgorithmExecution;
}

namespace lacuna
{
/// The poses of the probe, and what SliceStatus says of the slices. Throws std::runtime_error when
/// the slices have no such field data array.
class ProbePoses
{
public:
  static constexpr const char* ArrayName = "ProbeToTracker";
  static constexpr const char* StylusName = "StylusToTracker";

  explicit ProbePoses(vtkImageData* slices, const char* arrayName = ArrayName);
  /// Of the sweep.
  vtkIdType GetCount() const { return static_cast<vtkIdType>(this->Status.size()); }
  /// The slice's flags (lacunaTrackedSlices.h).
  int GetStatus(vtkIdType slice) const { return this->Status[slice]; }
  bool IsValid(vtkIdType slice) const;
  const Matrix4& Get(vtkIdType slice) const { return this->Matrices[slice]; }

private:
  std::vector<int> Status;
  std::vector<Matrix4> Matrices;
};

/// A pick and the slice in which it was made.
struct SlicePick
{
  vtkIdType Slice;
  CalibrationPick Pick;
  double Score = 1; ///< of a spot that was found: lacunaSpotTracking.h
};

namespace CalibrationPicks
{
/// From a vtkTable with columns Slice, Column, Row and Wire (X, Y or Z), or from a vtkPointSet whose
/// points are (column, row, slice). target: of all of them. Without one Wire says it, or else
/// Target, or else the ranges. Throws std::runtime_error that names row and column.
std::vector<SlicePick> Read(vtkDataObject* data, const ProbePoses& poses,
  std::optional<CalibrationTarget> target, const std::vector<WireRange>& ranges);

/// The bright spots of wires, one at most in each slice of a range that has no flag and none of the
/// picks, which lead: lacunaSpotTracking.h. The same for any number of threads.
std::vector<SlicePick> FindSpots(AlgorithmExecution& execution, vtkImageData* slices,
  const ProbePoses& poses, const std::vector<WireRange>& ranges,
  const std::vector<SlicePick>& picks);

/// Where the slices show a flat wall, the same for any number of threads: for each slice of the
/// stack the line's two points (column, row), or nothing. With poses only slices without a flag are
/// looked at.
std::vector<std::optional<std::array<Vec2, 2>>> FindWalls(
  AlgorithmExecution& execution, vtkImageData* slices, const ProbePoses* poses = nullptr);

/// The same as picks, of slices without a flag.
std::vector<SlicePick> FindWallPicks(
  AlgorithmExecution& execution, vtkImageData* slices, const ProbePoses& poses);

/// The tip of a stylus: all poses of the stack's slices. Slices without a picture and such that moved
/// fast count, too, since nothing is seen in them.
std::vector<SlicePick> GetTips(vtkImageData* slices, const ProbePoses& poses);

/// Which of the stack's slices are left out of what is found by itself for their flags; ranges: only
/// in these, if there are any; tip: as GetTips does. Empty: none is.
std::string DescribeLeftOut(vtkImageData* slices, const ProbePoses& poses,
  const std::vector<WireRange>& ranges, bool tip = false);

/// Which of picks that were given are of slices that are flagged. Empty: none is.
std::string DescribeFlagged(const std::vector<SlicePick>& picks, const ProbePoses& poses);
}
}
#endif
