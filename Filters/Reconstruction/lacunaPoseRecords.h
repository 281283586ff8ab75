// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a table of poses says of each slice.
#ifndef lacunaPoseRecords_h
#define lacunaPoseRecords_h

#include "lacunaPoseMatching.h"

#include <array>
#include <string>
#include <vector>

namespace lacuna
{
class PoseColumnReader;
}
class vtkTable;

namespace lacuna
{
/// What is looked for in the table; the names are those of the filter's properties.
struct PoseRequest
{
  enum Matching
  {
    Order = 0,
    FrameNumber = 1,
    Time = 2
  };
  static constexpr std::array<const char*, 3> MatchingNames{ "Order", "FrameNumber", "Time" };

  PoseTableOptions Poses;
  std::vector<std::string> PoseColumns;
  std::string FrameColumn, TimestampColumn, StatusColumn, GateColumn;
  int MatchBy = Order;
  double GateRange[2] = { 1, -1 };
  int FirstFrameNumber = 0;
  double TimeOffset = 0;
  double MaximumTimeGap = 0.1;
};

/// One element for each slice. Not a part of the module's interface.
struct PoseRecords
{
  /// times: s, one for each slice, or empty when they are not known. Throws std::runtime_error with
  /// a text for the user when the table is not what the request says, or does not fit the slices.
  PoseRecords(vtkTable* table, std::size_t slices, const std::vector<double>& times,
    const PoseRequest& request);

  std::vector<Matrix4> ToReference; ///< mm; all NaN where there is no pose
  std::vector<unsigned char> Status;
  std::vector<double> Times; ///< empty: not known
  std::vector<int> FrameNumbers;
  std::vector<double> Gate; ///< empty: no such column
  std::vector<std::string> Warnings;

private:
  /// states: of the rows
  void SetStatus(const std::vector<PoseMatch>& matches, const std::vector<unsigned char>& states);
  void ReadFrameNumbers(const PoseColumnReader& columns, int column,
    const std::vector<PoseMatch>& matches, const PoseRequest& request);
  void ReadGate(const PoseColumnReader& columns, int column, const std::vector<PoseMatch>& matches,
    const PoseRequest& request);
};
}
#endif
