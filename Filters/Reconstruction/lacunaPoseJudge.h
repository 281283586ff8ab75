// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which poses of a sweep can be used; the same for all filters that take slices.
#ifndef lacunaPoseJudge_h
#define lacunaPoseJudge_h

#include "lacunaSliceImage.h"
#include "vtkType.h"

#include <array>
#include <string>
#include <vector>

class vtkDataArray;
class vtkImageData;
namespace lacuna
{
class TrackedSlices;
}

namespace lacuna
{
/// Not a part of the module's interface.
namespace PoseJudge
{
/// mm; coordinates are handed on as float.
constexpr double LargestCoordinate = 1e38;

/// Of vtkLacunaSliceAlgorithm::BadPoseRules.
inline constexpr std::array<const char*, 3> BadPoseRuleNames{ "Refuse", "LeaveOut",
  "KeepOutliers" };

struct Slice
{
  vtkIdType Number; ///< in the sweep
  const SliceImage* Image;
  const Matrix4* ImageToReference; ///< of the scanner's pixels
};

/// For each slice of the sweep, in its order, an empty text when its pose can be used, else a
/// sentence that names the slice and says what is wrong: the pose is not finite, not affine or
/// singular, a corner lies beyond LargestCoordinate, or lacunaGeometryGate.h refuses it.
std::vector<std::string> FindUnusable(const std::vector<Slice>& slices);

/// Adds a sentence for each slice without one whose pose is an outlier among those without one (see
/// lacunaPoseOutliers.h).
void AddOutliers(const std::vector<Slice>& slices, std::vector<std::string>& problems);

/// Which poses of all slices of a sweep can be used, whatever part of it a stack has.
struct Sweep
{
  std::vector<char> HasPose; ///< that can be used
  std::vector<std::string>
    Problems; ///< of those whose pose cannot, though SliceStatus has no flag 1
};

/// whole: the extent of the stack's whole slices. Outliers cannot be used unless keepOutliers.
Sweep JudgeSweep(
  vtkImageData* stack, const TrackedSlices& tracked, const int whole[6], bool keepOutliers);

/// What messages call slice number of the stack: "slice 7 (frame 12)", with the frame's number from
/// frames, which may be null, where it is another one. suffix ends it.
std::string MakeLabel(vtkIdType number, vtkDataArray* frames, const std::string& suffix);
}
}
#endif
