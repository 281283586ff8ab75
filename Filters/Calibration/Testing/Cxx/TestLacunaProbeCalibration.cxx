// SPDX-License-Identifier: BSD-3-Clause
/// vtkLacunaProbeCalibration: what it makes of slices and picks, the file, and what cannot be.
#include "lacunaProvenance.h"
#include "lacunaTestCalibrations.h"
#include "vtkSMPTools.h"

#include <cstdio>
#include <functional>
#include <limits>
#include <sstream>

using namespace lacunaTestCalibrations;

namespace
{
const double NoNumber = std::numeric_limits<double>::quiet_NaN();

void TestWires()
{
  const Scan scan = ScanWires(18);
  const Calibrated found = Calibrate(scan.Slices, scan.Picks);
  LACUNA_CHECK_THAT(found.Errors.empty(), found.Errors);
  LACUNA_CHECK(LargestDifference(found.GetImageToProbe(), ImageToProbe()) < 1e-6);
  vtkDataArray* poses = scan.Slices->GetFieldData()->GetArray("ProbeToTracker");
  vtkDataArray* reference =
    lacuna::FieldData::Get(found.Slices, "ImageToReference", 16, poses->GetNumberOfTuples());
  for (int i = 0; i < 18; ++i)
  {
    LACUNA_CHECK(LargestDifference(lacuna::FieldData::GetMatrix(reference, i),
                   lacuna::FieldData::GetMatrix(poses, i) * found.GetImageToProbe()) < 1e-12);
  }
  // the input is not touched, its pixels are shared
  LACUNA_CHECK(!scan.Slices->GetFieldData()->HasArray("ImageToReference"));
  LACUNA_CHECK(
    found.Slices->GetPointData()->GetScalars() == scan.Slices->GetPointData()->GetScalars());
  // one row for each pick, in their order
  LACUNA_CHECK(found.Residuals->GetNumberOfRows() == 18);
  for (vtkIdType i = 0; i < 18; ++i)
  {
    LACUNA_CHECK(found.Residuals->GetValueByName(i, "Slice").ToInt() == i);
    LACUNA_CHECK(
      found.Residuals->GetValueByName(i, "Target").ToString() == std::string(1, "XYZ"[i % 3]));
    LACUNA_CHECK(found.Residuals->GetValueByName(i, "Error").ToDouble() < 1e-6);
    LACUNA_CHECK(found.Residuals->GetValueByName(i, "Used").ToInt() == 1);
    LACUNA_CHECK(found.Residuals->GetValueByName(i, "Column").ToDouble() ==
      scan.Picks->GetValueByName(i, "Column").ToDouble());
    const std::string axis = std::string("Phantom") + "XYZ"[i % 3];
    LACUNA_CHECK(std::abs(std::abs(found.Residuals->GetValueByName(i, axis.c_str()).ToDouble()) -
                   std::abs(45 * Wave(static_cast<int>(i), 7))) < 1e-5);
  }
  LACUNA_CHECK(found.Picture->GetNumberOfVerts() == 18 && found.Picture->GetNumberOfLines() == 3);
  LACUNA_CHECK(found.GetFigure("CalibrationRms") < 1e-7);
  LACUNA_CHECK(found.GetFigure("ExpectedError") < 1e-5);
  LACUNA_CHECK(found.Residuals->GetFieldData()->HasArray("Advice"));
  LACUNA_CHECK_CONTAINS(lacuna::Provenance::Get(found.Picture).back(), "vtkLacunaProbeCalibration");
  LACUNA_CHECK_CONTAINS(lacuna::Provenance::Get(found.Slices).back(), "RowSpacing=0.6");
  // both spacings are found when asked for, the ones given are of no account
  const Calibrated scale = Calibrate(scan.Slices, scan.Picks,
    [](auto* f)
    {
      f->SetPixelSpacing(0);
      f->EstimateScaleOn();
    });
  LACUNA_CHECK(LargestDifference(scale.GetImageToProbe(), ImageToProbe()) < 1e-5);
  vtkDataArray* spacing = lacuna::FieldData::Get(scale.Slices, "PixelSpacing", 2, 1);
  LACUNA_CHECK_NEAR(spacing->GetComponent(0, 0), ColumnSpacing, 1e-6);
  LACUNA_CHECK_NEAR(spacing->GetComponent(0, 1), RowSpacing, 1e-6);
}

void TestPoint()
{
  std::vector<Matrix4> poses;
  std::vector<double> slices, columns, rows;
  for (int i = 0; i < 12; ++i)
  {
    const Matrix4 turn = LookingDown(i, 60);
    columns.push_back(0.5 * Width * (1 + 0.9 * Wave(i, 8)));
    rows.push_back(0.5 * Height * (1 + 0.9 * Wave(i, 9)));
    slices.push_back(i);
    const Vec3 arm = turn.Vector({ ColumnSpacing * columns.back(), RowSpacing * rows.back(), 0 });
    poses.push_back(ProbeToTracker(Matrix4::Translation(-1.0 * arm) * turn));
  }
  const Calibrated found = Calibrate(MakeScan(poses), MakeTable(slices, columns, rows, ""),
    [](auto* f) { f->SetMethodToPointTarget(); });
  LACUNA_CHECK_THAT(found.Errors.empty(), found.Errors);
  LACUNA_CHECK(LargestDifference(found.GetImageToProbe(), ImageToProbe()) < 1e-6);
  LACUNA_CHECK(found.Picture->GetNumberOfLines() == 0);
}

// Found by itself, the same for any number of threads.
void TestFloor()
{
  const auto slices = ScanFloor(40);
  const auto wall = [](auto* f) { f->SetMethodToSingleWall(); };
  const Calibrated found = Calibrate(slices, nullptr, wall);
  LACUNA_CHECK_THAT(found.Errors.empty(), found.Errors);
  const Matrix4 matrix = found.GetImageToProbe();
  double worst = 0;
  for (const Vec3& corner :
    { Vec3{ 0, 0, 0 }, Vec3{ Width, 0, 0 }, Vec3{ 0, Height, 0 }, Vec3{ Width, Height, 0 } })
  {
    worst = std::max(worst, lacuna::Norm(matrix.Point(corner) - ImageToProbe().Point(corner)));
  }
  LACUNA_CHECK_THAT(worst < 0.3, "error at the corners " + std::to_string(worst));
  LACUNA_CHECK(worst < 3 * found.GetFigure("ExpectedError"));
  LACUNA_CHECK(found.Residuals->GetNumberOfRows() > 60);
  LACUNA_CHECK(found.Picture->GetNumberOfLines() == 1);
  for (const int threads : { 1, 2, 5 })
  {
    Calibrated other;
    vtkSMPTools::LocalScope(vtkSMPTools::Config{ threads, std::string("STDThread"), false },
      [&] { other = Calibrate(slices, nullptr, wall); });
    LACUNA_CHECK(LargestDifference(other.GetImageToProbe(), matrix) == 0);
  }
  // the map's largest error is the one reported, at a corner of the picture
  double range[2];
  found.Map->GetPointData()->GetArray("ExpectedError")->GetRange(range);
  LACUNA_CHECK_NEAR(range[1], found.GetFigure("ExpectedError"), 1e-12);
  LACUNA_CHECK(range[0] > 0 && range[0] < 0.95 * range[1]);
  LACUNA_CHECK_NEAR(found.Map->GetBounds()[1], Width - 1, 1e-9);
  LACUNA_CHECK_NEAR(found.Map->GetBounds()[3], Height - 1, 1e-9);
  // slices without a pose are left out
  const auto part = Spoilt(slices.Get(),
    [](vtkImageData* s)
    {
      s->GetFieldData()->GetArray("SliceStatus")->SetTuple1(4, 1);
      s->GetFieldData()->GetArray("ProbeToTracker")->SetComponent(4, 3, NoNumber);
    });
  const Calibrated rest = Calibrate(part, nullptr, wall);
  LACUNA_CHECK_THAT(rest.Errors.empty(), rest.Errors);
  LACUNA_CHECK(rest.Residuals->GetNumberOfRows() == found.Residuals->GetNumberOfRows() - 2);
  // not tilted at all: it says which motion is missing
  const Calibrated flat = Calibrate(ScanFloor(40, 0), nullptr, wall);
  LACUNA_CHECK_CONTAINS(flat.Errors, "the picks leave open");
  LACUNA_CHECK_CONTAINS(flat.Errors, "turn the probe");
}

void TestFile()
{
  const Scan scan = ScanWires(18);
  const std::string name = "TestLacunaProbeCalibration.xml";
  std::remove(name.c_str());
  const auto write = [&](auto* f) { f->SetOutputFileName(name.c_str()); };
  LACUNA_CHECK_THAT(Calibrate(scan.Slices, scan.Picks, write).Errors.empty(), "written");
  const std::string text = ReadFile(name);
  LACUNA_CHECK_CONTAINS(text, "<Transform From=\"Image\" To=\"Probe\"");
  // A calibration that fails leaves the former file as it is.
  vtkNew<vtkTable> few;
  few->DeepCopy(scan.Picks);
  few->SetNumberOfRows(3);
  LACUNA_CHECK(!Calibrate(scan.Slices, few, write).Errors.empty());
  LACUNA_CHECK(ReadFile(name) == text);
  std::remove(name.c_str());
  // A file that cannot be written is an error, and the outputs are there.
  vtkNew<vtkLacunaProbeCalibration> filter;
  filter->SetInputData(scan.Slices);
  filter->SetInputDataObject(1, scan.Picks);
  filter->SetPixelSpacing(ColumnSpacing);
  filter->SetRowSpacing(RowSpacing);
  filter->SetOutputFileName("no-such-folder/calibration.xml");
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK_CONTAINS(messages->Errors, "no-such-folder");
  LACUNA_CHECK(
    LargestDifference(lacuna::FieldData::GetMatrix(
                        lacuna::FieldData::Get(filter->GetOutput(), "ImageToProbe", 16, 1), 0),
      ImageToProbe()) < 1e-6);
}

void TestBadSlices()
{
  const Scan scan = ScanWires(18);
  const auto error = [&](const std::function<void(vtkImageData*)>& spoil)
  { return Calibrate(Spoilt(scan.Slices.Get(), spoil), scan.Picks).Errors; };
  using Image = vtkImageData;
  LACUNA_CHECK_CONTAINS(error([](Image* s) { s->GetFieldData()->RemoveArray("ProbeToTracker"); }),
    "no field data array 'ProbeToTracker'");
  LACUNA_CHECK_CONTAINS(
    error([](Image* s) { s->SetSpacing(1, 1e300, 1); }), "the error to expect is no number");
  LACUNA_CHECK_CONTAINS(error([](Image* s) { s->GetFieldData()->RemoveArray("SliceStatus"); }),
    "'SliceStatus' is missing");
  LACUNA_CHECK_CONTAINS(error([](Image* s) { Shorten(s, "ProbeToTracker"); }), "'ProbeToTracker'");
  LACUNA_CHECK_CONTAINS(error([](Image* s) { Shorten(s, "SliceStatus"); }), "'ProbeToTracker'");
  LACUNA_CHECK_CONTAINS(error(
                          [](Image* s)
                          {
                            vtkNew<vtkDoubleArray> nine;
                            nine->SetName("ProbeToTracker");
                            nine->SetNumberOfComponents(9);
                            nine->SetNumberOfTuples(18);
                            nine->Fill(0);
                            s->GetFieldData()->AddArray(nine);
                          }),
    "'ProbeToTracker'");
  LACUNA_CHECK_CONTAINS(error(
                          [](Image* s)
                          {
                            vtkNew<vtkStringArray> words;
                            words->SetName("ProbeToTracker");
                            words->SetNumberOfComponents(16);
                            words->SetNumberOfTuples(18);
                            s->GetFieldData()->AddArray(words);
                          }),
    "ProbeToTracker");
  for (const double number : { NoNumber, std::numeric_limits<double>::infinity() })
  {
    LACUNA_CHECK_CONTAINS(
      error([&](Image* s)
        { s->GetFieldData()->GetArray("ProbeToTracker")->SetComponent(5, 7, number); }),
      "pick 5: ProbeToTracker has numbers that are not finite");
  }
  LACUNA_CHECK_CONTAINS(
    error([](Image* s) { s->GetFieldData()->GetArray("ProbeToTracker")->SetComponent(5, 0, 3); }),
    "pick 5: ProbeToTracker is not rigid");
  LACUNA_CHECK_CONTAINS(
    error([](Image* s) { s->GetFieldData()->GetArray("SliceStatus")->SetTuple1(2, 1); }),
    "slice 2, which has no pose");
  LACUNA_CHECK_CONTAINS(error([](Image* s) { s->Initialize(); }), "the stack of slices is empty");
  // the same pose all the time
  const std::string same = error(
    [](Image* s)
    {
      vtkDataArray* poses = s->GetFieldData()->GetArray("ProbeToTracker");
      for (int i = 1; i < 18; ++i)
      {
        poses->SetTuple(i, 0, poses);
      }
    });
  LACUNA_CHECK_THAT(!same.empty(), "the same pose all the time");
  // a kilometre and far beyond: an error or a warning, never numbers that are none
  for (const double far : { 1e6, 1e200, 1e308 })
  {
    const Calibrated huge = Calibrate(Spoilt(scan.Slices.Get(),
                                        [&](Image* s)
                                        {
                                          vtkDataArray* poses =
                                            s->GetFieldData()->GetArray("ProbeToTracker");
                                          for (int i = 0; i < 18; i += 2)
                                          {
                                            poses->SetComponent(i, 3, far);
                                          }
                                        }),
      scan.Picks);
    LACUNA_CHECK_THAT(!huge.Errors.empty() || !huge.Warnings.empty(), std::to_string(far));
    LACUNA_CHECK(!huge.Errors.empty() || huge.GetImageToProbe().IsFinite());
  }
  // one slice
  const Scan one = ScanWires(1);
  LACUNA_CHECK_CONTAINS(Calibrate(one.Slices, one.Picks).Errors, "1 picks give 2 equations");
  LACUNA_CHECK(
    !Calibrate(ScanFloor(1), nullptr, [](auto* f) { f->SetMethodToSingleWall(); }).Errors.empty());
}

void TestBadPicks()
{
  const Scan scan = ScanWires(18);
  const auto error = [&](const std::function<void(vtkTable*)>& spoil)
  { return Calibrate(scan.Slices, Spoilt(scan.Picks.Get(), spoil)).Errors; };
  using Table = vtkTable;
  const auto set = [](const char* column, double value)
  { return [=](Table* t) { t->SetValueByName(4, column, value); }; };
  for (const char* column : { "Slice", "Column", "Row" })
  {
    LACUNA_CHECK_CONTAINS(error([&](Table* t) { t->RemoveColumnByName(column); }),
      std::string("no column '") + column + "'");
  }
  LACUNA_CHECK_CONTAINS(error([](Table* t) { t->RemoveColumnByName("Wire"); }),
    "row 0 of the table of picks is of no wire: give a table with the column 'Wire'");
  LACUNA_CHECK_CONTAINS(error(set("Column", NoNumber)), "row 4 of the table of picks has 'nan'");
  LACUNA_CHECK_CONTAINS(
    error(set("Row", std::numeric_limits<double>::infinity())), "as Row; a number is needed");
  LACUNA_CHECK_CONTAINS(error(set("Slice", 18)), "row 4 of the table of picks is of slice 18");
  LACUNA_CHECK_CONTAINS(error(set("Slice", -1)), "slice -1; the sweep has slices 0 to 17");
  LACUNA_CHECK_CONTAINS(error(set("Slice", 4.5)), "slice 4.5");
  LACUNA_CHECK_CONTAINS(error(set("Slice", 1e300)), "is of slice 1e");
  LACUNA_CHECK_CONTAINS(
    error([](Table* t) { t->SetValueByName(4, "Wire", "W"); }), "it must be X, Y or Z");
  LACUNA_CHECK_CONTAINS(error([](Table* t) { t->SetNumberOfRows(0); }), "0 equations");
  LACUNA_CHECK_CONTAINS(error([](Table* t) { t->SetNumberOfRows(7); }), "14 equations");
  // a pick beside the picture is an outlier, one far off a slip
  const Calibrated off = Calibrate(scan.Slices, Spoilt(scan.Picks.Get(), set("Column", 200)));
  LACUNA_CHECK_THAT(off.Errors.empty(), off.Errors);
  LACUNA_CHECK(off.Residuals->GetValueByName(4, "Used").ToInt() == 0);
  LACUNA_CHECK(off.Residuals->GetValueByName(4, "Error").ToDouble() > 10);
  LACUNA_CHECK(LargestDifference(off.GetImageToProbe(), ImageToProbe()) < 1e-6);
  for (const double far : { -130.0, 500.0, 1e6, 1e300 })
  {
    LACUNA_CHECK_CONTAINS(error(set("Column", far)), "as Column; the slices have 0 to 119");
  }
  LACUNA_CHECK_CONTAINS(error(set("Row", 200)), "row 4 of the table of picks has 200 as Row");
}

void TestBadSettings()
{
  const Scan scan = ScanWires(18);
  const auto error = [&](vtkTable* picks, const Settings& configure)
  { return Calibrate(scan.Slices, picks, configure).Errors; };
  LACUNA_CHECK_CONTAINS(error(nullptr, {}), "neither picks (second input) nor WireRanges");
  LACUNA_CHECK_CONTAINS(
    error(scan.Picks, [](auto* f) { f->SetPixelSpacing(0); }), "PixelSpacing is 0");
  for (const double wrong : { -1.0, NoNumber, std::numeric_limits<double>::infinity() })
  {
    LACUNA_CHECK_CONTAINS(error(scan.Picks, [=](auto* f) { f->SetPixelSpacing(wrong); }),
      "mm; it must be 0 mm or more");
  }
  for (const double wrong : { -1.0, 1.0, NoNumber })
  {
    LACUNA_CHECK_CONTAINS(
      error(scan.Picks, [=](auto* f) { f->SetOutlierLimit(wrong); }), "OutlierLimit");
  }
  const auto wall = [](auto* f) { f->SetMethodToSingleWall(); };
  LACUNA_CHECK_CONTAINS(error(nullptr, wall), "no slice shows a flat wall");
  const auto coloured = Spoilt(scan.Slices.Get(),
    [](vtkImageData* s)
    {
      s->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
      s->GetPointData()->GetScalars()->Fill(7);
    });
  LACUNA_CHECK_CONTAINS(Calibrate(coloured, nullptr, wall).Errors, "have colours");
}
}

int TestLacunaProbeCalibration(int, char*[])
{
  TestWires();
  TestPoint();
  TestFloor();
  TestFile();
  TestBadSlices();
  TestBadPicks();
  TestBadSettings();
  vtkNew<vtkLacunaProbeCalibration> filter;
  std::ostringstream text;
  filter->Print(text);
  LACUNA_CHECK_CONTAINS(text.str(), "OutlierLimit: 4 (0 (none is left out) or 2 or more)");
  return lacunaCheck::Result();
}
