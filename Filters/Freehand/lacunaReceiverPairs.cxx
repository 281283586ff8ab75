// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaReceiverPairs.h"

#include "lacunaFieldData.h"
#include "lacunaPoseColumnReader.h"
#include "lacunaTrackedSlices.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkTable.h"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace
{
constexpr double NoTime = std::numeric_limits<double>::quiet_NaN();
const std::string Suffix = "ToTracker";

// The only transform to the tracker besides the first receiver's.
std::string FindOther(vtkImageData* slices, const std::string& first)
{
  std::vector<std::string> others;
  vtkFieldData* fields = slices->GetFieldData();
  for (int i = 0; i < fields->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = fields->GetAbstractArray(i);
    const std::string name = array->GetName() ? array->GetName() : "";
    if (array->GetNumberOfComponents() == 16 && name != first && name.size() > Suffix.size() &&
      name.compare(name.size() - Suffix.size(), Suffix.size(), Suffix) == 0)
    {
      others.push_back(name);
    }
  }
  if (others.size() != 1)
  {
    std::string text = others.empty()
      ? "the slices have no second transform to the tracker besides '" + first +
        "': record the second receiver, too, and name its field data array in SecondReceiver"
      : "the slices have several transforms to the tracker: name the second receiver's in "
        "SecondReceiver; there are";
    for (const std::string& name : others)
    {
      text += " '" + name + "'";
    }
    throw std::runtime_error(text);
  }
  return others.front();
}

}

//------------------------------------------------------------------------------
lacuna::ReceiverPairs::ReceiverPairs(vtkDataObject* data, const lacuna::ReceiverRequest& request)
{
  if (request.FirstReceiver.empty())
  {
    throw std::runtime_error("FirstReceiver is empty; name the first receiver's transform");
  }
  if (auto* slices = vtkImageData::SafeDownCast(data))
  {
    this->ReadSlices(slices, request);
  }
  else
  {
    this->ReadTable(vtkTable::SafeDownCast(data), request);
  }
}

//------------------------------------------------------------------------------
void lacuna::ReceiverPairs::ReadSlices(vtkImageData* slices, const lacuna::ReceiverRequest& request)
{
  vtkDataArray* status =
    lacuna::FieldData::Get(slices, lacuna::TrackedSlices::SliceStatusName, 1, -1);
  const vtkIdType count = status->GetNumberOfTuples();
  vtkDataArray* first = lacuna::FieldData::Get(slices, request.FirstReceiver, 16, count);
  const std::string otherName = request.SecondReceiver.empty()
    ? FindOther(slices, request.FirstReceiver)
    : request.SecondReceiver;
  vtkDataArray* second = lacuna::FieldData::Get(slices, otherName, 16, count);
  if (first == second)
  {
    throw std::runtime_error("FirstReceiver and SecondReceiver are the same transform");
  }
  vtkDataArray* times =
    lacuna::FieldData::Find(slices, lacuna::TrackedSlices::TimestampName, 1, count);
  for (vtkIdType i = 0; i < count; ++i)
  {
    const lacuna::Matrix4 poses[2] = { lacuna::FieldData::GetMatrix(first, i),
      lacuna::FieldData::GetMatrix(second, i) };
    // readers write NaN where there is no pose
    if (!(static_cast<int>(status->GetTuple1(i)) & lacuna::TrackedSlices::PoseInvalid) &&
      poses[0].IsFinite() && poses[1].IsFinite())
    {
      this->Pairs.push_back(
        { poses[0], poses[1], times ? times->GetTuple1(i) : NoTime, static_cast<std::size_t>(i) });
    }
  }
}

//------------------------------------------------------------------------------
void lacuna::ReceiverPairs::ReadTable(vtkTable* table, const lacuna::ReceiverRequest& request)
{
  const lacuna::PoseColumnReader columns(table);
  const std::vector<std::string>& names = columns.GetNames();
  const std::size_t rows = columns.GetNumberOfRows();
  if (rows == 0)
  {
    throw std::runtime_error("the table has no rows");
  }
  lacuna::PoseTableOptions options;
  options.Format = request.Format;
  options.Unit = request.Unit;
  options.SkipInvalid = true;
  const auto read = [&](const std::vector<std::string>& wanted, const std::vector<char>& refused)
  {
    const std::vector<int> found =
      lacuna::FindPoseColumns(names, request.Format, request.Unit, wanted,
        "rename them, or, of a table with both poses in each row, give in FirstReceiver and "
        "SecondReceiver the texts with which their names begin");
    lacuna::PoseTable poses =
      lacuna::ReadPoseTable(columns.GetNumbers(found), found.size(), refused, options);
    this->Warnings.insert(this->Warnings.end(), poses.Warnings.begin(), poses.Warnings.end());
    return poses;
  };
  const int timeColumn = lacuna::FindColumn(names, "", { "timestamp", "time" }, "");
  std::vector<double> times(rows, NoTime);
  if (timeColumn >= 0)
  {
    lacuna::CheckSeconds(names[timeColumn]);
    times = columns.GetNumbers(timeColumn);
  }
  const int stationColumn = lacuna::FindColumn(names, "", { "station", "receiver", "sensor" }, "");
  if (stationColumn < 0)
  {
    if (request.SecondReceiver.empty())
    {
      throw std::runtime_error("the table has no column Station: name in FirstReceiver and "
                               "SecondReceiver the texts with which the names of their columns "
                               "begin");
    }
    const lacuna::PoseTable first = read({ request.FirstReceiver }, {});
    const lacuna::PoseTable second = read({ request.SecondReceiver }, {});
    for (std::size_t row = 0; row < rows; ++row)
    {
      if (first.Usable[row] && second.Usable[row])
      {
        this->Pairs.push_back({ first.ToReference[row], second.ToReference[row], times[row], row });
      }
    }
    return;
  }

  // Records as the tracker sends them: one receiver after the other.
  const std::vector<double> stations = columns.GetNumbers(stationColumn);
  std::vector<char> refused;
  for (const double station : stations)
  {
    refused.push_back(station != request.Stations[0] && station != request.Stations[1]);
  }
  const lacuna::PoseTable poses = read({}, refused);
  std::size_t counts[2] = { 0, 0 };
  for (std::size_t row = 0; row < rows; ++row)
  {
    counts[0] += stations[row] == request.Stations[0];
    counts[1] += stations[row] == request.Stations[1];
    if (row > 0 && stations[row - 1] == request.Stations[0] &&
      stations[row] == request.Stations[1] && poses.Usable[row - 1] && poses.Usable[row])
    {
      this->Pairs.push_back(
        { poses.ToReference[row - 1], poses.ToReference[row], times[row], row - 1 });
    }
  }
  for (int i = 0; i < 2; ++i)
  {
    if (counts[i] == 0)
    {
      throw std::runtime_error("no row of the table is of station " +
        std::to_string(request.Stations[i]) + ": see column '" + names[stationColumn] +
        "' and the property Stations");
    }
  }
  if (2 * this->Pairs.size() < counts[0])
  {
    this->Warnings.push_back("of " + std::to_string(counts[0]) + " rows of station " +
      std::to_string(request.Stations[0]) + " only " + std::to_string(this->Pairs.size()) +
      " are followed by one of station " + std::to_string(request.Stations[1]) +
      "; the others are left out");
  }
}
