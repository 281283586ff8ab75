// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaTrackerSelfTest.h"

#include "lacunaArrays.h"
#include "lacunaFieldData.h"
#include "lacunaPoseColumnReader.h"
#include "lacunaPoseTable.h"
#include "lacunaTrackedSlices.h"
#include "lacunaTrackerSelfTest.h"
#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

#include <functional>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{
using Test = lacuna::TrackerSelfTest;

constexpr double NoTime = std::numeric_limits<double>::quiet_NaN();
const std::string Suffix = "ToTracker";

// Where the two receivers are looked for, as the properties say.
struct ReceiverRequest
{
  std::string FirstReceiver, SecondReceiver;
  lacuna::PoseFormat Format;
  lacuna::LengthUnit Unit;
  int Stations[2];
};

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

// The poses of two receivers, from slices or from a table. Throws std::runtime_error with a text for the
// user when they are not there.
class ReceiverPairs
{
public:
  ReceiverPairs(vtkDataObject* data, const ReceiverRequest& request)
    : Request(request)
  {
    if (this->Request.FirstReceiver.empty())
    {
      throw std::runtime_error("FirstReceiver is empty; name the first receiver's transform");
    }
    if (auto* slices = vtkImageData::SafeDownCast(data))
    {
      this->ReadSlices(slices);
    }
    else
    {
      this->ReadTable(vtkTable::SafeDownCast(data));
    }
  }

  std::vector<lacuna::ReceiverPair> Pairs; // mm
  std::vector<std::string> Warnings;

private:
  void ReadSlices(vtkImageData* slices)
  {
    vtkDataArray* status =
      lacuna::FieldData::Get(slices, lacuna::TrackedSlices::SliceStatusName, 1, -1);
    const vtkIdType count = status->GetNumberOfTuples();
    vtkDataArray* first = lacuna::FieldData::Get(slices, this->Request.FirstReceiver, 16, count);
    const std::string otherName = this->Request.SecondReceiver.empty()
      ? FindOther(slices, this->Request.FirstReceiver)
      : this->Request.SecondReceiver;
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
        this->Pairs.push_back({ poses[0], poses[1], times ? times->GetTuple1(i) : NoTime,
          static_cast<std::size_t>(i) });
      }
    }
  }

  void ReadTable(vtkTable* table)
  {
    const lacuna::PoseColumnReader columns(table);
    const std::vector<std::string>& names = columns.GetNames();
    const std::size_t rows = columns.GetNumberOfRows();
    if (rows == 0)
    {
      throw std::runtime_error("the table has no rows");
    }
    const int timeColumn = lacuna::FindColumn(names, "", { "timestamp", "time" }, "");
    std::vector<double> times(rows, NoTime);
    if (timeColumn >= 0)
    {
      lacuna::CheckSeconds(names[timeColumn]);
      times = columns.GetNumbers(timeColumn);
    }
    const int stationColumn =
      lacuna::FindColumn(names, "", { "station", "receiver", "sensor" }, "");
    if (stationColumn < 0)
    {
      this->ReadPairedRows(columns, times);
    }
    else
    {
      this->ReadStations(columns, stationColumn, times);
    }
  }

  lacuna::PoseTable ReadPoses(const lacuna::PoseColumnReader& columns,
    const std::vector<std::string>& wanted, const std::vector<char>& refused)
  {
    lacuna::PoseTableOptions options;
    options.Format = this->Request.Format;
    options.Unit = this->Request.Unit;
    options.SkipInvalid = true;
    const std::vector<int> found =
      lacuna::FindPoseColumns(columns.GetNames(), this->Request.Format, this->Request.Unit, wanted,
        "rename them, or, of a table with both poses in each row, give in FirstReceiver and "
        "SecondReceiver the texts with which their names begin");
    lacuna::PoseTable poses =
      lacuna::ReadPoseTable(columns.GetNumbers(found), found.size(), refused, options);
    this->Warnings.insert(this->Warnings.end(), poses.Warnings.begin(), poses.Warnings.end());
    return poses;
  }

  // Both poses in each row.
  void ReadPairedRows(const lacuna::PoseColumnReader& columns, const std::vector<double>& times)
  {
    if (this->Request.SecondReceiver.empty())
    {
      throw std::runtime_error("the table has no column Station: name in FirstReceiver and "
                               "SecondReceiver the texts with which the names of their columns "
                               "begin");
    }
    const lacuna::PoseTable first = this->ReadPoses(columns, { this->Request.FirstReceiver }, {});
    const lacuna::PoseTable second = this->ReadPoses(columns, { this->Request.SecondReceiver }, {});
    for (std::size_t row = 0; row < times.size(); ++row)
    {
      if (first.Usable[row] && second.Usable[row])
      {
        this->Pairs.push_back({ first.ToReference[row], second.ToReference[row], times[row], row });
      }
    }
  }

  // Records as the tracker sends them: one receiver after the other.
  void ReadStations(
    const lacuna::PoseColumnReader& columns, int column, const std::vector<double>& times)
  {
    const std::vector<double> stations = columns.GetNumbers(column);
    std::vector<char> refused;
    for (const double station : stations)
    {
      refused.push_back(
        station != this->Request.Stations[0] && station != this->Request.Stations[1]);
    }
    const lacuna::PoseTable poses = this->ReadPoses(columns, {}, refused);
    std::size_t counts[2] = { 0, 0 };
    for (std::size_t row = 0; row < stations.size(); ++row)
    {
      counts[0] += stations[row] == this->Request.Stations[0];
      counts[1] += stations[row] == this->Request.Stations[1];
      if (row > 0 && stations[row - 1] == this->Request.Stations[0] &&
        stations[row] == this->Request.Stations[1] && poses.Usable[row - 1] && poses.Usable[row])
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
          std::to_string(this->Request.Stations[i]) + ": see column '" +
          columns.GetNames()[column] + "' and the property Stations");
      }
    }
    if (2 * this->Pairs.size() < counts[0])
    {
      this->Warnings.push_back("of " + std::to_string(counts[0]) + " rows of station " +
        std::to_string(this->Request.Stations[0]) + " only " + std::to_string(this->Pairs.size()) +
        " are followed by one of station " + std::to_string(this->Request.Stations[1]) +
        "; the others are left out");
    }
  }

  const ReceiverRequest& Request;
};

void FillPoints(const Test& found, vtkPolyData* output)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> vertices;
  vtkNew<vtkDoubleArray> position, separation, angle, deviation, distance;
  vtkNew<vtkIdTypeArray> place, record;
  position->SetName("PositionError");
  separation->SetName("SeparationError");
  angle->SetName("AngleError");
  deviation->SetName("Deviation");
  deviation->SetNumberOfComponents(3);
  distance->SetName("Distance");
  place->SetName("Place");
  record->SetName("Record");
  const auto count = static_cast<vtkIdType>(found.Samples.size());
  lacuna::Arrays::Reserve(points, count);
  lacuna::Arrays::Reserve(vertices, count, count);
  for (vtkDataArray* array : std::initializer_list<vtkDataArray*>{
         position, separation, angle, deviation, distance, place, record })
  {
    lacuna::Arrays::Reserve(array, count);
  }
  for (const Test::Sample& sample : found.Samples)
  {
    const vtkIdType id = points->InsertNextPoint(sample.Middle.data());
    vertices->InsertNextCell(1, &id);
    position->InsertNextValue(lacuna::Norm(sample.Deviation));
    separation->InsertNextValue(sample.SeparationError);
    angle->InsertNextValue(sample.AngleError);
    deviation->InsertNextTuple(sample.Deviation.data());
    distance->InsertNextValue(sample.Distance);
    place->InsertNextValue(static_cast<vtkIdType>(sample.Place));
    record->InsertNextValue(static_cast<vtkIdType>(sample.Record));
  }
  output->SetPoints(points);
  output->SetVerts(vertices);
  output->GetPointData()->SetScalars(position);
  for (vtkDataArray* array :
    std::initializer_list<vtkDataArray*>{ separation, angle, deviation, distance, place, record })
  {
    output->GetPointData()->AddArray(array);
  }
}

// A column for each name, with what value gives for each row.
template <class Row>
void FillTable(const std::vector<Row>& rows,
  const std::vector<std::pair<const char*, std::function<double(const Row&)>>>& columns,
  vtkTable* table)
{
  for (const auto& [name, value] : columns)
  {
    vtkNew<vtkDoubleArray> column;
    column->SetName(name);
    for (const Row& row : rows)
    {
      column->InsertNextValue(value(row));
    }
    table->AddColumn(column);
  }
}

void AddErrors(vtkDataObject* output, const std::string& suffix, const Test::Errors& errors)
{
  lacuna::FieldData::Set(output, "Position" + suffix, { errors.Position }, 1);
  lacuna::FieldData::Set(output, "Separation" + suffix, { errors.Separation }, 1);
  lacuna::FieldData::Set(output, "Angle" + suffix, { errors.Angle }, 1);
}

void AddFigures(vtkDataObject* output, const Test& found, vtkStringArray* advice)
{
  AddErrors(output, "Rms", found.Rms);
  AddErrors(output, "Maximum", found.Largest);
  AddErrors(output, "Expected", found.Expected);
  const std::pair<const char*, double> figures[] = { { "Separation", found.Separation },
    { "SeparationRange", found.SeparationRange }, { "Noise", found.Noise },
    { "Repeatability", found.Repeatability }, { "Warp", found.Warp },
    { "Places", static_cast<double>(found.Places) },
    { "RevisitedPlaces", static_cast<double>(found.Revisited) },
    { "TooFast", static_cast<double>(found.TooFast) },
    { "OtherHemisphere", static_cast<double>(found.OtherHemisphere) } };
  for (const auto& [name, value] : figures)
  {
    lacuna::FieldData::Set(output, name, { value }, 1);
  }
  lacuna::FieldData::SetMatrices(output, "SecondToFirst", { found.SecondToFirst });
  output->GetFieldData()->AddArray(advice);
}
}

vtkStandardNewMacro(vtkLacunaTrackerSelfTest);

//------------------------------------------------------------------------------
vtkLacunaTrackerSelfTest::vtkLacunaTrackerSelfTest()
{
  this->Sharing = lacuna::Share::FirstRank;
  this->TakesEmpty = true; // an error
  this->TakesBlocks = true;
  this->SetNumberOfOutputPorts(3);
}

//------------------------------------------------------------------------------
void vtkLacunaTrackerSelfTest::SetFirstReceiver(const char* name)
{
  if (this->FirstReceiver != (name ? name : ""))
  {
    this->FirstReceiver = name ? name : "";
    this->Modified();
  }
}

//------------------------------------------------------------------------------
void vtkLacunaTrackerSelfTest::SetSecondReceiver(const char* name)
{
  if (this->SecondReceiver != (name ? name : ""))
  {
    this->SecondReceiver = name ? name : "";
    this->Modified();
  }
}

//------------------------------------------------------------------------------
int vtkLacunaTrackerSelfTest::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkTable");
  return 1;
}

//------------------------------------------------------------------------------
int vtkLacunaTrackerSelfTest::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkPolyData" : "vtkTable");
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaTrackerSelfTest::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution&)
{
  auto* input = ports.GetInput<vtkDataObject>();
  ReceiverRequest request;
  request.FirstReceiver = this->FirstReceiver;
  request.SecondReceiver = this->SecondReceiver;
  request.Format = static_cast<lacuna::PoseFormat>(this->PoseFormat);
  request.Unit = static_cast<lacuna::LengthUnit>(this->LengthUnit);
  request.Stations[0] = this->Stations[0];
  request.Stations[1] = this->Stations[1];
  const ReceiverPairs pairs(input, request);
  for (const std::string& warning : pairs.Warnings)
  {
    vtkWarningMacro(<< warning);
  }
  const Test found = Test::Solve(pairs.Pairs, this->GetOptions());

  auto* points = ports.GetOutput<vtkPolyData>();
  FillPoints(found, points);
  auto* byDistance = ports.GetOutput<vtkTable>(1);
  using DistanceRow = Test::DistanceRow;
  FillTable<DistanceRow>(found.ByDistance,
    { { "From", [](const DistanceRow& row) { return row.From; } },
      { "To", [](const DistanceRow& row) { return row.To; } },
      { "Pairs", [](const DistanceRow& row) { return static_cast<double>(row.Samples); } },
      { "PositionRms", [](const DistanceRow& row) { return row.Rms.Position; } },
      { "SeparationRms", [](const DistanceRow& row) { return row.Rms.Separation; } },
      { "AngleRms", [](const DistanceRow& row) { return row.Rms.Angle; } } },
    byDistance);
  auto* byApart = ports.GetOutput<vtkTable>(2);
  using ApartRow = Test::ApartRow;
  FillTable<ApartRow>(found.ByApart,
    { { "From", [](const ApartRow& row) { return row.From; } },
      { "To", [](const ApartRow& row) { return row.To; } },
      { "PairsOfPlaces", [](const ApartRow& row) { return static_cast<double>(row.Pairs); } },
      { "PositionChange", [](const ApartRow& row) { return row.Position; } } },
    byApart);
  vtkNew<vtkStringArray> advice;
  advice->SetName("Advice");
  for (const std::string& sentence : found.GetAdvice())
  {
    advice->InsertNextValue(sentence);
  }
  for (vtkDataObject* output : std::initializer_list<vtkDataObject*>{ points, byDistance, byApart })
  {
    AddFigures(output, found, advice);
  }
  // A good verdict alone is no warning.
  for (vtkIdType i = 0; i < advice->GetNumberOfValues() && advice->GetNumberOfValues() > 1; ++i)
  {
    vtkWarningMacro(<< advice->GetValue(i));
  }
}

//------------------------------------------------------------------------------
lacuna::TrackerSelfTestOptions vtkLacunaTrackerSelfTest::GetOptions() const
{
  lacuna::TrackerSelfTestOptions options;
  options.SpeedLimit = this->SpeedLimit;
  options.RevisitDistance = this->RevisitDistance;
  options.RevisitAngle = this->RevisitAngle;
  options.Accuracy = { this->TranslationAccuracy, this->AngularAccuracy };
  options.RangeLimit = this->RangeLimit;
  return options;
}

//------------------------------------------------------------------------------
void vtkLacunaTrackerSelfTest::Describe(lacuna::Properties& properties) const
{
  properties.Add("FirstReceiver", this->FirstReceiver)
    .Add("SecondReceiver", this->SecondReceiver)
    .Add("PoseFormat", this->PoseFormat, lacuna::PoseFormatNames)
    .Add("LengthUnit", this->LengthUnit, lacuna::LengthUnitNames)
    .Add("Stations", this->Stations);
  this->GetOptions().Describe(properties);
}
