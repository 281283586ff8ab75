// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPoseRecords.h"

#include "lacunaItemList.h"
#include "lacunaPoseColumnReader.h"
#include "lacunaPoseMatching.h"
#include "lacunaTrackedSlices.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace
{
constexpr double NoNumber = std::numeric_limits<double>::quiet_NaN();

using Matches = std::vector<lacuna::PoseMatch>;

// A column's numbers for the slices, NaN where they have no row.
std::vector<double> Gather(const std::vector<double>& column, const Matches& matches)
{
  std::vector<double> gathered;
  for (const lacuna::PoseMatch& match : matches)
  {
    const std::ptrdiff_t row = match.GetNearest();
    gathered.push_back(row == lacuna::PoseMatch::None ? NoNumber : column[row]);
  }
  return gathered;
}

int NeedColumn(int column, const char* matching, const char* property)
{
  if (column < 0)
  {
    throw std::runtime_error(std::string("MatchBy is ") + matching +
      ", but no column of the table is known to have it; name it in " + property);
  }
  return column;
}

// Columns that are there if they are.
struct OtherColumns
{
  OtherColumns(const lacuna::PoseColumnReader& columns, const lacuna::PoseRequest& request)
    : Frame(lacuna::FindColumn(columns.GetNames(), request.FrameColumn,
        { "framenumber", "frame", "frameid", "frameno", "slicenumber", "slice" }, "FrameColumn"))
    , Time(lacuna::FindColumn(
        columns.GetNames(), request.TimestampColumn, { "timestamp", "time" }, "TimestampColumn"))
    , Status(lacuna::FindColumn(columns.GetNames(), request.StatusColumn,
        { "slicestatus", "status", "posestatus", "transformstatus", "valid", "isvalid" },
        "StatusColumn"))
    , Gate(lacuna::FindColumn(columns.GetNames(), request.GateColumn, { "gate" }, "GateColumn"))
  {
  }

  int Frame, Time, Status, Gate;
};

Matches Match(const lacuna::PoseColumnReader& columns, const OtherColumns& others,
  const lacuna::PoseTable& table, std::size_t slices, std::vector<double> times,
  const lacuna::PoseRequest& request)
{
  switch (request.MatchBy)
  {
    case lacuna::PoseRequest::FrameNumber:
      return lacuna::MatchByFrameNumber(slices,
        columns.GetNumbers(NeedColumn(others.Frame, "FrameNumber", "FrameColumn")),
        request.FirstFrameNumber);
    case lacuna::PoseRequest::Time:
    {
      const int column = NeedColumn(others.Time, "Time", "TimestampColumn");
      if (times.empty())
      {
        throw std::runtime_error(
          "MatchBy is Time, but the times of the slices are not known: they have neither a field "
          "data array 'Timestamp' nor time steps; set FrameRate");
      }
      for (double& time : times)
      {
        time += request.TimeOffset;
      }
      return lacuna::MatchByTime(
        times, columns.GetNumbers(column), table.Usable, request.MaximumTimeGap);
    }
    default:
      return lacuna::MatchByOrder(slices, columns.GetNumberOfRows());
  }
}
}

//------------------------------------------------------------------------------
lacuna::PoseRecords::PoseRecords(vtkTable* data, std::size_t slices,
  const std::vector<double>& times, const lacuna::PoseRequest& request)
{
  const lacuna::PoseColumnReader columns(data);
  if (columns.GetNumberOfRows() == 0)
  {
    throw std::runtime_error("the table of poses has no rows");
  }
  const OtherColumns others(columns, request);
  if (others.Time >= 0)
  {
    lacuna::CheckSeconds(columns.GetNames()[others.Time]);
  }
  const std::vector<int> poseColumns = lacuna::FindPoseColumns(
    columns.GetNames(), request.Poses.Format, request.Poses.Unit, request.PoseColumns);

  std::vector<unsigned char> states(columns.GetNumberOfRows(), lacuna::TrackedSlices::Valid);
  if (others.Status >= 0)
  {
    states = columns.GetStatus(others.Status);
  }
  std::vector<char> refused(states.size());
  std::transform(states.begin(), states.end(), refused.begin(),
    [](unsigned char state) { return (state & lacuna::TrackedSlices::PoseInvalid) != 0; });
  const lacuna::PoseTable table = lacuna::ReadPoseTable(
    columns.GetNumbers(poseColumns), poseColumns.size(), refused, request.Poses);
  this->Warnings = table.Warnings;
  for (const int column : { others.Time, others.Frame })
  {
    const std::string warning = column < 0
      ? std::string()
      : lacuna::DescribeEmptyKeys(
          "column '" + columns.GetNames()[column] + "'", columns.GetNumbers(column));
    if (!warning.empty())
    {
      this->Warnings.push_back(warning);
    }
  }
  const Matches matches = Match(columns, others, table, slices, times, request);
  this->ToReference = lacuna::GatherPoses(table, matches);
  this->SetStatus(matches, states);
  this->ReadGate(columns, others.Gate, matches, request);
  this->ReadFrameNumbers(columns, others.Frame, matches, request);
  const bool own = request.MatchBy == lacuna::PoseRequest::Time || others.Time < 0;
  this->Times = own ? times : Gather(columns.GetNumbers(others.Time), matches);
}

//------------------------------------------------------------------------------
void lacuna::PoseRecords::SetStatus(
  const std::vector<lacuna::PoseMatch>& matches, const std::vector<unsigned char>& states)
{
  std::vector<std::size_t> alone;
  for (std::size_t i = 0; i < matches.size(); ++i)
  {
    unsigned char status = lacuna::TrackedSlices::Valid;
    const std::ptrdiff_t row = matches[i].GetNearest();
    if (row == lacuna::PoseMatch::None)
    {
      alone.push_back(i);
    }
    else
    {
      status = states[row];
    }
    if (!this->ToReference[i].IsFinite())
    {
      status |= lacuna::TrackedSlices::PoseInvalid;
    }
    this->Status.push_back(status);
  }
  if (!alone.empty())
  {
    this->Warnings.push_back("the table has no pose for " + lacuna::DescribeItems("slice", alone) +
      "; flagged in SliceStatus");
  }
}

//------------------------------------------------------------------------------
void lacuna::PoseRecords::ReadFrameNumbers(const lacuna::PoseColumnReader& columns, int column,
  const std::vector<lacuna::PoseMatch>& matches, const lacuna::PoseRequest& request)
{
  const std::vector<double> frames = column >= 0 ? Gather(columns.GetNumbers(column), matches)
                                                 : std::vector<double>(matches.size(), NoNumber);
  for (std::size_t i = 0; i < matches.size(); ++i)
  {
    const bool number = frames[i] == std::floor(frames[i]) && std::abs(frames[i]) < 2147483648.0;
    this->FrameNumbers.push_back(number ? static_cast<int>(frames[i])
        : request.MatchBy == lacuna::PoseRequest::FrameNumber
        ? request.FirstFrameNumber + static_cast<int>(i)
        : static_cast<int>(i));
  }
}

//------------------------------------------------------------------------------
void lacuna::PoseRecords::ReadGate(const lacuna::PoseColumnReader& columns, int column,
  const std::vector<lacuna::PoseMatch>& matches, const lacuna::PoseRequest& request)
{
  const bool ranged = request.GateRange[0] <= request.GateRange[1];
  if (column < 0)
  {
    if (ranged)
    {
      throw std::runtime_error(
        "GateRange is set, but the table has no column Gate; name it in GateColumn");
    }
    return;
  }
  this->Gate = Gather(columns.GetNumbers(column), matches);
  for (std::size_t i = 0; ranged && i < this->Gate.size(); ++i)
  {
    if (!(this->Gate[i] >= request.GateRange[0] && this->Gate[i] <= request.GateRange[1]))
    {
      this->Status[i] |= lacuna::TrackedSlices::GatedOut;
    }
  }
}
