// SPDX-License-Identifier: BSD-3-Clause
/// vtkLacunaTrackerSelfTest: slices and tables in, deviations and advice out, and what cannot be.
#include "lacunaFieldData.h"
#include "lacunaProvenance.h"
#include "lacunaTestScans.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkLacunaTrackerSelfTest.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

#include <cmath>
#include <limits>
#include <sstream>

using lacuna::Matrix4;
using lacuna::Vec3;

namespace
{
const double Degree = std::acos(-1.0) / 180;
const double NoNumber = std::numeric_limits<double>::quiet_NaN();
const Matrix4 SecondToFirst =
  Matrix4::Translation({ 200, -150, 120 }) * Matrix4::Rotation({ 1, 2, -1 }, 50 * Degree);

// Azimuth, elevation and roll of each, in degrees.
struct EulerPose
{
  Vec3 Place, Angles;
  Matrix4 Get() const
  {
    return Matrix4::Translation(this->Place) *
      Matrix4::Rotation({ 0, 0, 1 }, this->Angles[0] * Degree) *
      Matrix4::Rotation({ 0, 1, 0 }, this->Angles[1] * Degree) *
      Matrix4::Rotation({ 1, 0, 0 }, this->Angles[2] * Degree);
  }
};

EulerPose ToEuler(const Matrix4& m)
{
  return { m.Column(3),
    { std::atan2(m(1, 0), m(0, 0)) / Degree, -std::asin(m(2, 0)) / Degree,
      std::atan2(m(2, 1), m(2, 2)) / Degree } };
}

// The second receiver is pushed by 7 mm along y when it is high up.
bool IsPushed(const Matrix4& second)
{
  return second(2, 3) > 130;
}

std::vector<Matrix4> FirstPoses(int count)
{
  std::vector<Matrix4> poses;
  for (int i = 0; i < count; ++i)
  {
    poses.push_back(EulerPose{
      { 300.0 + 150 * std::sin(2.1 * i), 130 * std::sin(1.3 * i + 1), 60 * std::sin(0.7 * i + 2) },
      { 40 * std::sin(0.9 * i), 30 * std::sin(1.7 * i), 25 * std::sin(0.4 * i) } }
                      .Get());
  }
  return poses;
}

Matrix4 Second(const Matrix4& first)
{
  const Matrix4 second = first * SecondToFirst;
  return IsPushed(second) ? Matrix4::Translation({ 0, 7, 0 }) * second : second;
}

vtkSmartPointer<vtkImageData> MakeSlices(int count)
{
  const std::vector<Matrix4> first = FirstPoses(count);
  std::vector<Matrix4> second;
  for (const Matrix4& pose : first)
  {
    second.push_back(Second(pose));
  }
  auto slices = lacunaTestScans::MakeScan(first);
  lacuna::FieldData::SetMatrices(slices, "StylusToTracker", second);
  return slices;
}

// Rows of a FASTRAK, in inches; station 3 in between.
vtkSmartPointer<vtkTable> MakeRecords(int count)
{
  std::vector<double> columns[7];
  for (const Matrix4& first : FirstPoses(count))
  {
    const Matrix4 poses[3] = { Matrix4(), first, Second(first) };
    for (int station : { 3, 1, 2 })
    {
      const EulerPose euler = ToEuler(poses[station % 3]);
      columns[0].push_back(station);
      for (int axis = 0; axis < 3; ++axis)
      {
        columns[1 + axis].push_back(euler.Place[axis] / 25.4);
        columns[4 + axis].push_back(euler.Angles[axis]);
      }
    }
  }
  auto table = vtkSmartPointer<vtkTable>::New();
  const char* const names[7] = { "Station", "x", "y", "z", "azimuth", "elevation", "roll" };
  for (int c = 0; c < 7; ++c)
  {
    AddColumn(table, names[c], columns[c]);
  }
  return table;
}

using Settings = std::function<void(vtkLacunaTrackerSelfTest*)>;

struct Tested
{
  vtkSmartPointer<vtkPolyData> Points;
  vtkSmartPointer<vtkTable> Tables[2];
  std::string Errors, Warnings;
  double GetFigure(const char* name) const
  {
    return lacuna::FieldData::Get(this->Points, name, 1, 1)->GetTuple1(0);
  }
};

Tested Run(vtkDataObject* input, const Settings& configure = {})
{
  vtkNew<vtkLacunaTrackerSelfTest> filter;
  filter->SetInputDataObject(input);
  if (configure)
  {
    configure(filter);
  }
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  Tested tested;
  tested.Points = filter->GetOutput();
  for (int t = 0; t < 2; ++t)
  {
    tested.Tables[t] = vtkTable::SafeDownCast(filter->GetOutputDataObject(t + 1));
  }
  tested.Errors = messages->Errors;
  tested.Warnings = messages->Warnings;
  LACUNA_CHECK_THAT(tested.Errors.empty() || tested.Points->GetNumberOfPoints() == 0,
    "no half result after: " + tested.Errors);
  return tested;
}

void CheckTruth(const Tested& tested, int count)
{
  LACUNA_CHECK_THAT(tested.Errors.empty(), tested.Errors);
  LACUNA_CHECK(tested.Points->GetNumberOfPoints() == count);
  LACUNA_CHECK(tested.Points->GetNumberOfVerts() == count);
  LACUNA_CHECK_NEAR(tested.GetFigure("Separation"), lacuna::Norm(SecondToFirst.Column(3)), 1e-4);
  const Matrix4 found =
    lacuna::FieldData::GetMatrix(lacuna::FieldData::Get(tested.Points, "SecondToFirst", 16, 1), 0);
  for (int i = 0; i < 16; ++i)
  {
    LACUNA_CHECK_NEAR(found.Data()[i], SecondToFirst.Data()[i], 1e-4);
  }
  vtkPointData* data = tested.Points->GetPointData();
  const std::vector<Matrix4> poses = FirstPoses(count);
  for (int i = 0; i < count; ++i)
  {
    const Matrix4& first = poses[static_cast<std::size_t>(i)];
    const Matrix4 second = Second(first);
    const bool pushed = IsPushed(first * SecondToFirst);
    double deviation[3], place[3];
    data->GetArray("Deviation")->GetTuple(i, deviation);
    tested.Points->GetPoint(i, place);
    for (int axis = 0; axis < 3; ++axis)
    {
      LACUNA_CHECK_NEAR(deviation[axis], pushed && axis == 1 ? 7 : 0, 1e-3);
      LACUNA_CHECK_NEAR(place[axis], 0.5 * (first(axis, 3) + second(axis, 3)), 1e-3);
    }
    LACUNA_CHECK_NEAR(data->GetArray("PositionError")->GetTuple1(i), pushed ? 7 : 0, 1e-3);
    LACUNA_CHECK_NEAR(data->GetArray("SeparationError")->GetTuple1(i),
      lacuna::Norm(second.Column(3) - first.Column(3)) - lacuna::Norm(SecondToFirst.Column(3)),
      1e-3);
    LACUNA_CHECK_NEAR(data->GetArray("Distance")->GetTuple1(i),
      std::max(lacuna::Norm(first.Column(3)), lacuna::Norm(second.Column(3))), 1e-3);
    LACUNA_CHECK_NEAR(data->GetArray("AngleError")->GetTuple1(i), 0, 1e-4);
  }
}

void TestSlices()
{
  const auto slices = MakeSlices(60);
  const Tested tested = Run(slices);
  CheckTruth(tested, 60);
  LACUNA_CHECK_THAT(
    tested.Points->GetPointData()->GetArray("Record")->GetTuple1(9) == 9, "slice numbers");
  LACUNA_CHECK_CONTAINS(lacuna::Provenance::Get(tested.Points).back(), "SpeedLimit=50");
  LACUNA_CHECK_CONTAINS(tested.Warnings, "no place was visited twice");
  LACUNA_CHECK(std::isnan(tested.GetFigure("Repeatability")));
  LACUNA_CHECK_NEAR(tested.GetFigure("PositionMaximum"), 7, 1e-3);
  LACUNA_CHECK_NEAR(tested.GetFigure("SeparationExpected"), 1.127, 1e-3);
  // tables: all pairs, and their RMS
  double pairs = 0;
  vtkTable* table = tested.Tables[0];
  for (vtkIdType row = 0; row < table->GetNumberOfRows(); ++row)
  {
    pairs += table->GetValueByName(row, "Pairs").ToDouble();
    LACUNA_CHECK_NEAR(
      table->GetValueByName(row, "To").ToDouble() - table->GetValueByName(row, "From").ToDouble(),
      100, 1e-9);
  }
  LACUNA_CHECK(pairs == 60);
  double pairsOfPlaces = 0;
  for (vtkIdType row = 0; row < tested.Tables[1]->GetNumberOfRows(); ++row)
  {
    pairsOfPlaces += tested.Tables[1]->GetValueByName(row, "PairsOfPlaces").ToDouble();
  }
  const double places = tested.GetFigure("Places");
  LACUNA_CHECK(pairsOfPlaces == places * (places - 1) / 2);
  for (vtkDataObject* output : { static_cast<vtkDataObject*>(tested.Tables[0]),
         static_cast<vtkDataObject*>(tested.Tables[1]) })
  {
    LACUNA_CHECK(output->GetFieldData()->GetAbstractArray("Advice")->GetNumberOfValues() > 1);
  }

  // slices without a pose, by flag or by number, are left out; other transforms are no receivers
  slices->GetFieldData()->GetArray("SliceStatus")->SetTuple1(3, 1);
  slices->GetFieldData()->GetArray("StylusToTracker")->SetComponent(5, 3, NoNumber);
  lacuna::FieldData::SetMatrices(slices, "TrackerToReference", FirstPoses(60));
  LACUNA_CHECK(Run(slices).Points->GetNumberOfPoints() == 58);
  // exchanged, the other way round
  const Tested other = Run(slices,
    [](auto* f)
    {
      f->SetFirstReceiver("StylusToTracker");
      f->SetSecondReceiver("ProbeToTracker");
    });
  const Matrix4 back = SecondToFirst.Inverse();
  const Matrix4 found =
    lacuna::FieldData::GetMatrix(lacuna::FieldData::Get(other.Points, "SecondToFirst", 16, 1), 0);
  LACUNA_CHECK_NEAR(found(0, 3), back(0, 3), 1e-4);
}

void TestTables()
{
  const auto inches = [](auto* f) { f->SetLengthUnit(vtkLacunaTrackerSelfTest::Inch); };
  const auto records = MakeRecords(60);
  const Tested tested = Run(records, inches);
  CheckTruth(tested, 60);
  LACUNA_CHECK(tested.Points->GetPointData()->GetArray("Record")->GetTuple1(1) == 4);
  LACUNA_CHECK_CONTAINS(Run(records).Warnings, "check the unit of length");

  // a lost record loses its pair only
  vtkNew<vtkTable> lossy;
  lossy->DeepCopy(records);
  lossy->RemoveRow(7); // the first receiver's of the third record
  LACUNA_CHECK(Run(lossy, inches).Points->GetNumberOfPoints() == 59);
  LACUNA_CHECK_CONTAINS(Run(records, [](auto* f) { f->SetStations(1, 4); }).Errors,
    "no row of the table is of station 4");

  // both poses in each row, matrices as arrays of 16
  const auto slices = MakeSlices(60);
  vtkNew<vtkTable> wide;
  wide->AddColumn(slices->GetFieldData()->GetArray("ProbeToTracker"));
  wide->AddColumn(slices->GetFieldData()->GetArray("StylusToTracker"));
  const auto both = [](auto* f)
  {
    f->SetPoseFormat(vtkLacunaTrackerSelfTest::Matrix);
    f->SetSecondReceiver("StylusToTracker");
  };
  CheckTruth(Run(wide, both), 60);
  // faster than a limit
  std::vector<double> times;
  for (int i = 0; i < 60; ++i)
  {
    times.push_back(20 * i);
  }
  AddColumn(wide, "Time [s]", times);
  const Tested slow = Run(wide,
    [&](auto* f)
    {
      both(f);
      f->SetSpeedLimit(12);
    });
  LACUNA_CHECK(slow.GetFigure("TooFast") > 5);
  LACUNA_CHECK(slow.GetFigure("TooFast") + slow.Points->GetNumberOfPoints() == 60);
}

void TestErrors()
{
  const auto slices = MakeSlices(20);
  const auto spoilt = [&](const std::function<void(vtkFieldData*)>& spoil)
  {
    vtkNew<vtkImageData> copy;
    copy->DeepCopy(slices);
    spoil(copy->GetFieldData());
    return Run(copy).Errors;
  };
  LACUNA_CHECK_CONTAINS(
    spoilt([](auto* f) { f->RemoveArray("ProbeToTracker"); }), "'ProbeToTracker' is missing");
  LACUNA_CHECK_CONTAINS(
    spoilt([](auto* f) { f->RemoveArray("StylusToTracker"); }), "have no second transform");
  LACUNA_CHECK_CONTAINS(
    spoilt([](auto* f) { f->RemoveArray("SliceStatus"); }), "'SliceStatus' is missing");
  LACUNA_CHECK_CONTAINS(
    spoilt([](auto* f) { f->GetArray("StylusToTracker")->SetNumberOfTuples(19); }),
    "'StylusToTracker'");
  LACUNA_CHECK_CONTAINS(spoilt(
                          [](auto* f)
                          {
                            vtkNew<vtkDoubleArray> third;
                            third->SetName("PenToTracker");
                            third->SetNumberOfComponents(16);
                            third->SetNumberOfTuples(20);
                            f->AddArray(third);
                          }),
    "'StylusToTracker' 'PenToTracker'");
  LACUNA_CHECK_CONTAINS(spoilt(
                          [](auto* f)
                          {
                            auto* poses = f->GetArray("StylusToTracker");
                            for (int c = 0; c < 4; ++c)
                            {
                              poses->SetComponent(4, c, -poses->GetComponent(4, c));
                            }
                          }),
    "record 4: the pose of the second receiver mirrors");
  LACUNA_CHECK_CONTAINS(
    spoilt([](auto* f) { f->GetArray("SliceStatus")->Fill(1); }), "only 0 of 0");
  LACUNA_CHECK_CONTAINS(
    Run(slices, [](auto* f) { f->SetSecondReceiver("ProbeToTracker"); }).Errors, "the same");
  LACUNA_CHECK_CONTAINS(
    Run(slices, [](auto* f) { f->SetFirstReceiver(nullptr); }).Errors, "FirstReceiver is empty");
  LACUNA_CHECK_CONTAINS(
    Run(slices, [](auto* f) { f->SetRevisitDistance(-1); }).Errors, "RevisitDistance");
  vtkNew<vtkTable> empty;
  LACUNA_CHECK_CONTAINS(Run(empty).Errors, "no rows");
  vtkNew<vtkTable> other;
  AddColumn(other, "ECG", { 1, 2, 3 });
  LACUNA_CHECK_CONTAINS(Run(other).Errors, "no column Station");
  AddColumn(other, "Station", { 1, 2, 1 });
  LACUNA_CHECK_CONTAINS(Run(other).Errors, "the table has no columns for PoseFormat Euler");
  // the same pose all the time is no error, but advice
  const auto still = MakeSlices(20);
  for (const char* name : { "ProbeToTracker", "StylusToTracker" })
  {
    vtkDataArray* array = still->GetFieldData()->GetArray(name);
    for (int i = 1; i < 20; ++i)
    {
      array->SetTuple(i, 0, array);
    }
  }
  const Tested same = Run(still);
  LACUNA_CHECK_THAT(same.Errors.empty(), same.Errors);
  LACUNA_CHECK_CONTAINS(same.Warnings, "moved within 0 mm only");
  LACUNA_CHECK(same.GetFigure("PositionMaximum") < 1e-6);
}
}

int TestLacunaTrackerSelfTest(int, char*[])
{
  TestSlices();
  TestTables();
  TestErrors();
  vtkNew<vtkLacunaTrackerSelfTest> filter;
  std::ostringstream text;
  filter->Print(text);
  LACUNA_CHECK_CONTAINS(text.str(), "RangeLimit: 760 (above 0 mm)");
  return lacunaCheck::Result();
}
