// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaTrackerSelfTest.h"

#include "lacunaArrays.h"
#include "lacunaFieldData.h"
#include "lacunaParameterText.h"
#include "lacunaReceiverPairs.h"
#include "lacunaTrackerSelfTest.h"
#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
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
#include <stdexcept>
#include <vector>

namespace
{
using Test = lacuna::TrackerSelfTest;

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
  lacuna::ReceiverRequest request;
  request.FirstReceiver = this->FirstReceiver;
  request.SecondReceiver = this->SecondReceiver;
  request.Format = static_cast<lacuna::PoseFormat>(this->PoseFormat);
  request.Unit = static_cast<lacuna::LengthUnit>(this->LengthUnit);
  request.Stations[0] = this->Stations[0];
  request.Stations[1] = this->Stations[1];
  const lacuna::ReceiverPairs pairs(input, request);
  for (const std::string& warning : pairs.Warnings)
  {
    vtkWarningMacro(<< warning);
  }
  lacuna::TrackerSelfTestOptions options;
  options.SpeedLimit = this->SpeedLimit;
  options.RevisitDistance = this->RevisitDistance;
  options.RevisitAngle = this->RevisitAngle;
  options.Accuracy = { this->TranslationAccuracy, this->AngularAccuracy };
  options.RangeLimit = this->RangeLimit;
  const Test found = Test::Solve(pairs.Pairs, options);

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
std::string vtkLacunaTrackerSelfTest::Parameters(int) const
{
  return lacuna::ParameterText()
    .Add("FirstReceiver", this->FirstReceiver)
    .Add("SecondReceiver", this->SecondReceiver)
    .Add("PoseFormat", this->PoseFormat)
    .Add("LengthUnit", this->LengthUnit)
    .Add("Stations", this->Stations)
    .Add("SpeedLimit", this->SpeedLimit)
    .Add("RevisitDistance", this->RevisitDistance)
    .Add("RevisitAngle", this->RevisitAngle)
    .Add("TranslationAccuracy", this->TranslationAccuracy)
    .Add("AngularAccuracy", this->AngularAccuracy)
    .Add("RangeLimit", this->RangeLimit)
    .Get();
}

//------------------------------------------------------------------------------
void vtkLacunaTrackerSelfTest::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << this->Parameters(0) << "\n";
}
