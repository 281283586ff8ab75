// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which rows of a table of poses belong to which slices, and the poses that the slices get.
#ifndef lacunaPoseMatching_h
#define lacunaPoseMatching_h

#include "lacunaPoseTable.h"

#include <cstddef>
#include <string>
#include <vector>

namespace lacuna
{
/// The rows between which a slice's pose lies.
struct PoseMatch
{
  static constexpr std::ptrdiff_t None = -1;

  std::ptrdiff_t First = None;
  std::ptrdiff_t Second = None; ///< the same as First unless the pose is interpolated
  double Weight = 0;            ///< of the second, 0..1

  std::ptrdiff_t GetNearest() const { return this->Weight > 0.5 ? this->Second : this->First; }
};

/// Row i belongs to slice i. Throws std::runtime_error unless there are as many of them.
std::vector<PoseMatch> MatchByOrder(std::size_t slices, std::size_t rows);

/// The row with frame number firstFrame + i belongs to slice i; slices may lack one, and rows for
/// other frames are not used. Throws std::runtime_error when a frame number is not a whole number,
/// when a slice has several rows, when no slice has any, and when the last slice's number would be
/// above INT_MAX.
std::vector<PoseMatch> MatchByFrameNumber(
  std::size_t slices, const std::vector<double>& frames, double firstFrame);

/// A slice taken at a time has the pose between the usable rows before and after it; none when
/// these are more than maximumGap seconds apart (0 = no limit), and none outside of the table's
/// times. Of rows with the same time the first is taken. The rows may have any order. Throws
/// std::runtime_error when a usable row or a slice has no finite time, and when no slice gets a
/// pose, saying from when to when slices and rows are.
std::vector<PoseMatch> MatchByTime(const std::vector<double>& sliceTimes,
  const std::vector<double>& rowTimes, const std::vector<char>& usable, double maximumGap);

/// A warning when some cells of a column of keys (times, frame numbers) were probably empty in their
/// file, which ParaView's reader of texts turns into 0; else an empty text. So are cells of 0 if
/// those of all others grow from row to row, none backwards, and the zeros do not lie between their
/// neighbours. name: what the column is called.
std::string DescribeEmptyKeys(const std::string& name, const std::vector<double>& keys);

/// The pose of every slice, to mm in the reference frame; all NaN where it has no row or no usable
/// one.
std::vector<Matrix4> GatherPoses(const PoseTable& table, const std::vector<PoseMatch>& matches);
}
#endif
