// SPDX-License-Identifier: BSD-3-Clause
/// vtkLacunaTemporalCalibration: a video that is late by a known time, and what cannot tell.
#include "lacunaProvenance.h"
#include "lacunaTestScans.h"
#include "vtkLacunaTemporalCalibration.h"
#include "vtkSMPTools.h"

#include <functional>
#include <limits>
#include <sstream>

using namespace lacunaTestScans;

namespace
{
constexpr double Late = 0.083; // s
constexpr int Frames = 120;
const double NoNumber = std::numeric_limits<double>::quiet_NaN();

// To and fro above the floor, the image a little askew.
Matrix4 ScanAt(double time)
{
  const double height = 6 * std::sin(6.1 * time) + 3 * std::sin(3.7 * time + 1);
  return Matrix4::Translation({ 0, 0, 27 + height }) * Matrix4::Rotation({ 0, 1, 0 }, 6 * Degree) *
    Matrix4::Rotation({ 1, 0, 0 }, -90 * Degree);
}

vtkSmartPointer<vtkImageData> Record(int count = Frames)
{
  std::vector<Matrix4> poses;
  std::vector<double> times;
  for (int i = 0; i < count; ++i)
  {
    times.push_back(5 + 0.04 * i);
    poses.push_back(ProbeToTracker(ScanAt(times.back())));
  }
  auto slices = MakeScan(poses, times);
  for (int i = 0; i < count; ++i)
  {
    DrawFloor(slices, i, ScanAt(times[static_cast<std::size_t>(i)] - Late));
  }
  return slices;
}

struct Found
{
  vtkSmartPointer<vtkTable> Table;
  std::string Errors;
  double GetFigure(const char* name) const
  {
    return lacuna::FieldData::Get(this->Table, name, 1, 1)->GetTuple1(0);
  }
};

Found Calibrate(vtkImageData* slices, double maximumLag = 0.3)
{
  vtkNew<vtkLacunaTemporalCalibration> filter;
  filter->SetInputData(slices);
  filter->SetMaximumLag(maximumLag);
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  Found found{ filter->GetOutput(), messages->Errors };
  LACUNA_CHECK_THAT(found.Errors.empty() || found.Table->GetNumberOfRows() == 0,
    "no half result after: " + found.Errors);
  return found;
}

void TestLag(vtkImageData* slices)
{
  const Found found = Calibrate(slices);
  LACUNA_CHECK_THAT(found.Errors.empty(), found.Errors);
  LACUNA_CHECK_NEAR(found.GetFigure("TimeOffset"), -Late, 0.002);
  LACUNA_CHECK(found.GetFigure("LagSpread") < 0.002 && found.GetFigure("LagSpread") > 0);
  LACUNA_CHECK(found.GetFigure("Correlation") > 0.99);
  LACUNA_CHECK(found.GetFigure("Frames") > 0.7 * Frames);
  LACUNA_CHECK_CONTAINS(lacuna::Provenance::Get(found.Table).back(), "MaximumLag=0.3");
  // the table's highest correlation is at the lag; its lags reach from end to end
  vtkIdType best = 0;
  const vtkIdType rows = found.Table->GetNumberOfRows();
  for (vtkIdType row = 0; row < rows; ++row)
  {
    const auto value = [&](vtkIdType r)
    { return found.Table->GetValueByName(r, "Correlation").ToDouble(); };
    best = value(row) > value(best) ? row : best;
  }
  LACUNA_CHECK_NEAR(found.Table->GetValueByName(best, "Lag").ToDouble(), Late, 0.006);
  LACUNA_CHECK_NEAR(found.Table->GetValueByName(0, "Lag").ToDouble(), -0.3, 1e-9);
  LACUNA_CHECK_NEAR(found.Table->GetValueByName(rows - 1, "Lag").ToDouble(), 0.3, 1e-9);
  for (const int threads : { 1, 2, 5 })
  {
    Found other;
    vtkSMPTools::LocalScope(vtkSMPTools::Config{ threads, std::string("STDThread"), false },
      [&] { other = Calibrate(slices); });
    LACUNA_CHECK(other.GetFigure("TimeOffset") == found.GetFigure("TimeOffset"));
  }
  // slices without a pose are left out
  const auto gaps = Spoilt(slices,
    [](vtkImageData* s)
    {
      for (int i = 3; i < Frames; i += 9)
      {
        s->GetFieldData()->GetArray("SliceStatus")->SetTuple1(i, 1);
        s->GetFieldData()->GetArray("ProbeToTracker")->SetComponent(i, 3, NoNumber);
      }
    });
  LACUNA_CHECK_NEAR(Calibrate(gaps).GetFigure("TimeOffset"), -Late, 0.002);
}

void TestErrors(vtkImageData* slices)
{
  using Image = vtkImageData;
  const auto error = [&](const std::function<void(Image*)>& spoil)
  { return Calibrate(Spoilt(slices, spoil)).Errors; };
  const auto field = [](Image* s, const char* name) { return s->GetFieldData()->GetArray(name); };
  LACUNA_CHECK_CONTAINS(error([](Image* s) { s->GetFieldData()->RemoveArray("ProbeToTracker"); }),
    "no field data array 'ProbeToTracker'");
  LACUNA_CHECK_CONTAINS(error([](Image* s) { s->GetFieldData()->RemoveArray("Timestamp"); }),
    "the slices have no times");
  LACUNA_CHECK_CONTAINS(error([](Image* s) { s->GetFieldData()->RemoveArray("SliceStatus"); }),
    "'SliceStatus' is missing");
  for (const char* name : { "ProbeToTracker", "Timestamp" })
  {
    LACUNA_CHECK_CONTAINS(error([&](Image* s) { Shorten(s, name); }), std::string(name));
  }
  LACUNA_CHECK_CONTAINS(error([&](Image* s) { field(s, "Timestamp")->SetTuple1(8, NoNumber); }),
    "the time of slice 8 is not finite");
  LACUNA_CHECK_CONTAINS(error([&](Image* s) { field(s, "Timestamp")->SetTuple1(8, 5); }),
    "the time of slice 8 is not after");
  LACUNA_CHECK_CONTAINS(error([&](Image* s) { field(s, "Timestamp")->Fill(0); }), "is not after");
  LACUNA_CHECK_CONTAINS(
    error([&](Image* s) { field(s, "SliceStatus")->Fill(1); }), "only 0 slices show the floor");
  LACUNA_CHECK_CONTAINS(
    error(
      [&](Image* s)
      {
        for (int i = 1; i < Frames; ++i)
        {
          field(s, "ProbeToTracker")->SetTuple(i, 0, field(s, "ProbeToTracker"));
        }
      }),
    "the probe stands still");
  LACUNA_CHECK_CONTAINS(
    error([](Image* s) { s->GetPointData()->GetScalars()->Fill(0); }), "only 0 slices show");
  LACUNA_CHECK_CONTAINS(error([](Image* s) { s->Initialize(); }), "the stack of slices is empty");
  // a flagged pose may be anything; one that is not flagged must not give numbers that are none
  for (const double wrong : { NoNumber, 1e308 })
  {
    const Found found = Calibrate(
      Spoilt(slices, [&](Image* s) { field(s, "ProbeToTracker")->SetComponent(60, 3, wrong); }));
    LACUNA_CHECK_THAT(!found.Errors.empty(), "taken: " + std::to_string(wrong));
  }
  LACUNA_CHECK_CONTAINS(Calibrate(Record(1)).Errors, "only 0 slices");
  LACUNA_CHECK_CONTAINS(Calibrate(slices, 0.05).Errors, "raise MaximumLag");
  for (const double wrong : { 0.0, -1.0, 2.5, NoNumber })
  {
    LACUNA_CHECK_CONTAINS(Calibrate(slices, wrong).Errors, "it must be above 0 and at most 2 s");
  }
}
}

int TestLacunaTemporalCalibration(int, char*[])
{
  const auto slices = Record();
  TestLag(slices);
  TestErrors(slices);
  vtkNew<vtkLacunaTemporalCalibration> filter;
  std::ostringstream text;
  filter->Print(text);
  LACUNA_CHECK_CONTAINS(text.str(), "MaximumLag: 0.5 (above 0 and at most 2 s)");
  return lacunaCheck::Result();
}
