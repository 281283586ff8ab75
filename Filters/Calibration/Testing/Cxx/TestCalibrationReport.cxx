// SPDX-License-Identifier: BSD-3-Clause
/// vtkLacunaProbeCalibration: what it says of a result and when it writes none, flagged slices, the tip
/// of a stylus.
#include "lacunaTestCalibrations.h"
#include "vtkCallbackCommand.h"
#include "vtkInformation.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <cstdio>
#include <fstream>

using namespace lacunaTestCalibrations;

namespace
{
// Of hopeless results no file is made; what is there is kept.
void TestHopelessFile()
{
  const Scan scan = ScanWires(18);
  const std::string name = "TestLacunaProbeCalibrationHopeless.xml";
  std::remove(name.c_str());
  const auto calibrate = [&](vtkImageData* slices, vtkTable* picks, const Settings& configure)
  {
    vtkNew<vtkLacunaProbeCalibration> filter;
    filter->SetInputData(slices);
    filter->SetInputDataObject(1, picks);
    filter->SetPixelSpacing(ColumnSpacing);
    filter->SetRowSpacing(RowSpacing);
    filter->SetOutputFileName(name.c_str());
    configure(filter);
    const auto messages = lacunaCheck::Watch(filter);
    filter->Update();
    // the outputs tell what is wrong
    LACUNA_CHECK(vtkTable::SafeDownCast(filter->GetOutputDataObject(1))->GetNumberOfRows() > 0);
    return messages->Errors;
  };
  LACUNA_CHECK(calibrate(scan.Slices, scan.Picks, [](auto*) {}).empty());
  const std::string good = ReadFile(name);
  LACUNA_CHECK_CONTAINS(good, "ExpectedError 0.000 mm, RMS 0.000 mm of 36 equations, 18 views");
  LACUNA_CHECK_CONTAINS(good, "Error=\"0.0000\"");
  LACUNA_CHECK_CONTAINS(good, "Advice: none\n  Hash: fnv1a:");
  // a wrong spacing, for a moment
  LACUNA_CHECK_CONTAINS(calibrate(scan.Slices, scan.Picks, [](auto* f) { f->SetRowSpacing(1.5); }),
    "another position of the image fits nearly as well");
  LACUNA_CHECK(ReadFile(name) == good);
  // many picks, all bad: their mean may be good, but nobody should trust it
  const Scan many = ScanWires(150);
  const auto bad = Spoilt(many.Picks.Get(),
    [](vtkTable* t)
    {
      for (int i = 0; i < 150; ++i)
      {
        t->SetValueByName(
          i, "Column", t->GetValueByName(i, "Column").ToDouble() + 14 * Wave(7 * i, 20));
        t->SetValueByName(i, "Row", t->GetValueByName(i, "Row").ToDouble() + 12 * Wave(5 * i, 21));
      }
    });
  LACUNA_CHECK_CONTAINS(calibrate(many.Slices, bad, [](auto*) {}), "the RMS error is");
  LACUNA_CHECK(ReadFile(name) == good);
  // positions in inches: the scale that is found fits perfectly
  const auto inches = Spoilt(scan.Slices.Get(),
    [](vtkImageData* s)
    {
      vtkDataArray* poses = s->GetFieldData()->GetArray("ProbeToTracker");
      for (int i = 0; i < 18; ++i)
      {
        for (const int c : { 3, 7, 11 })
        {
          poses->SetComponent(i, c, poses->GetComponent(i, c) / 25.4);
        }
      }
    });
  LACUNA_CHECK_CONTAINS(
    calibrate(inches, scan.Picks, [](auto* f) { f->EstimateScaleOn(); }), "than any probe's");
  LACUNA_CHECK(ReadFile(name) == good);
  // hardly turned, with errors that are not small: an expected error of many mm
  const auto rough = Spoilt(scan.Picks.Get(),
    [](vtkTable* t)
    {
      for (int i = 0; i < 18; ++i)
      {
        t->SetValueByName(i, "Column", t->GetValueByName(i, "Column").ToDouble() + 5 * Wave(i, 20));
        t->SetValueByName(i, "Row", t->GetValueByName(i, "Row").ToDouble() + 5 * Wave(i, 21));
      }
      t->SetNumberOfRows(9);
    });
  LACUNA_CHECK_CONTAINS(
    calibrate(scan.Slices, rough, [](auto* f) { f->SetOutlierLimit(0); }), "is not written");
  LACUNA_CHECK(ReadFile(name) == good);
  // all right by its own account, but of so few views that another position may be
  const auto few = Spoilt(scan.Picks.Get(), [](vtkTable* t) { t->SetNumberOfRows(9); });
  LACUNA_CHECK_CONTAINS(
    calibrate(scan.Slices, few, [](auto*) {}), "9 views are too few, there must be 10");
  LACUNA_CHECK_CONTAINS(
    Calibrate(scan.Slices, few, [](auto*) {}).Warnings, "not to be used: 9 views are too few");
  LACUNA_CHECK(ReadFile(name) == good);
  // the calibration of something else, more than this calibration, of someone else, or none at all
  const auto replaced = [](std::string text, const std::string& from, const std::string& to)
  { return text.replace(text.find(from), from.size(), to); };
  for (const std::string& other : { replaced(good, "From=\"Image\"", "From=\"StylusTip\""),
         replaced(good, "<CoordinateD", "<DataCollection/><CoordinateD"),
         replaced(good, "</Coord", "<Transform From=\"Tracker\" To=\"Reference\"/></Coord"),
         replaced(good, "Advice:", "Dr. Who's probe. Advice:"),
         replaced(good, "To=\"Probe\"", "To=\"ProbeB\""), good + "<!-- mine -->",
         replaced(good, "<!-- Lacuna", "<!-- fCal"), std::string("ObjectType = Image\n") })
  {
    std::ofstream(name) << other;
    LACUNA_CHECK_CONTAINS(
      calibrate(scan.Slices, scan.Picks, [](auto*) {}), "something else, or more");
    LACUNA_CHECK_THAT(ReadFile(name) == other, other);
  }
  std::ofstream(name).close(); // just made
  LACUNA_CHECK(calibrate(scan.Slices, scan.Picks, [](auto*) {}).empty());
  LACUNA_CHECK(ReadFile(name) == good);
  // usable, with advice: both are in the file, which is good XML
  const auto fair = Spoilt(scan.Picks.Get(),
    [](vtkTable* t)
    {
      for (int i = 0; i < 18; ++i)
      {
        t->SetValueByName(i, "Row", t->GetValueByName(i, "Row").ToDouble() + 0.3 * Wave(i, 21));
      }
      t->SetValueByName(4, "Column", 200);
      t->SetValueByName(9, "Column", -100);
      t->SetValueByName(14, "Row", 170);
    });
  LACUNA_CHECK(calibrate(scan.Slices, fair, [](auto*) {}).empty());
  const std::string text = ReadFile(name);
  LACUNA_CHECK_CONTAINS(
    text, "Advice:\n  - 3 of 18 picks do not agree with the others: check which");
  LACUNA_CHECK(text.find("Error=\"0.0000\"") == std::string::npos);
  LACUNA_CHECK(text.find("--", 4) == text.find("-->"));
  std::remove(name.c_str());
}

// Where both spacings are sought, sizes that no probe has and ratios that pixels have not are told.
void TestScaleAdvice()
{
  const Scan scan = ScanWires(30);
  const auto advise = [&](double length, double rows, const Settings& more)
  {
    const auto slices = Spoilt(scan.Slices.Get(),
      [=](vtkImageData* s)
      {
        vtkDataArray* poses = s->GetFieldData()->GetArray("ProbeToTracker");
        for (int i = 0; i < 30; ++i)
        {
          for (const int c : { 3, 7, 11 })
          {
            poses->SetComponent(i, c, poses->GetComponent(i, c) * length);
          }
        }
      });
    const auto picks = Spoilt(scan.Picks.Get(),
      [=](vtkTable* t)
      {
        for (int i = 0; i < 30; ++i)
        {
          t->SetValueByName(i, "Row", t->GetValueByName(i, "Row").ToDouble() * rows);
        }
      });
    const Calibrated found = Calibrate(slices, picks,
      [&](auto* f)
      {
        f->EstimateScaleOn();
        more(f);
      });
    LACUNA_CHECK_THAT(found.Errors.empty(), found.Errors);
    return found.Warnings;
  };
  const auto asIs = [](auto*) {};
  LACUNA_CHECK_THAT(advise(1, 1, asIs).empty(), advise(1, 1, asIs));
  LACUNA_CHECK_CONTAINS(advise(1 / 25.4, 1, asIs), "are the tracker's positions in mm?");
  LACUNA_CHECK_CONTAINS(advise(1000, 1, asIs), "are the tracker's positions in mm?");
  // cold water: echoes come late, and lie 4 % deeper in the image than they are
  LACUNA_CHECK_CONTAINS(advise(1, 1540.0 / 1482, asIs), "sound at 1482 m/s instead of 1540");
  LACUNA_CHECK_THAT(advise(1, 1.01, asIs).empty(), "1 %");
  // what is given says which ratio is right, as long as both are
  LACUNA_CHECK_CONTAINS(
    advise(1, 1, [](auto* f) { f->SetRowSpacing(ColumnSpacing); }), "1.2 times as high");
  LACUNA_CHECK_CONTAINS(advise(1, 1, [](auto* f) { f->SetRowSpacing(0); }), "1 is to be expected");
}

// Slices that are flagged are not looked at, and given picks in them are told.
void TestFlags()
{
  const auto slices = ScanFloor(40);
  const auto wall = [](auto* f) { f->SetMethodToSingleWall(); };
  const Calibrated all = Calibrate(slices, nullptr, wall);
  const auto flagged = Spoilt(slices.Get(),
    [](vtkImageData* s)
    {
      vtkDataArray* status = s->GetFieldData()->GetArray("SliceStatus");
      vtkDataArray* poses = s->GetFieldData()->GetArray("ProbeToTracker");
      const int flags[] = { 1, 2, 4, 8, 12 };
      for (int i = 0; i < 5; ++i)
      {
        status->SetTuple1(3 + i, flags[i]);
        poses->SetComponent(3 + i, 3, poses->GetComponent(3 + i, 3) + 4); // wrong, as when too fast
      }
    });
  const Calibrated part = Calibrate(flagged, nullptr, wall);
  LACUNA_CHECK_THAT(part.Errors.empty(), part.Errors);
  for (vtkIdType i = 0; i < part.Residuals->GetNumberOfRows(); ++i)
  {
    const int slice = part.Residuals->GetValueByName(i, "Slice").ToInt();
    LACUNA_CHECK(slice < 3 || slice > 7);
  }
  LACUNA_CHECK_CONTAINS(part.Warnings,
    "left out are 5 of 40 slices, by their SliceStatus: 1 pose invalid (1), 1 image invalid (2), "
    "2 too fast (4), 2 gated out (8)");
  LACUNA_CHECK(all.Warnings.find("left out") == std::string::npos);
  const auto none = Spoilt(
    slices.Get(), [](vtkImageData* s) { s->GetFieldData()->GetArray("SliceStatus")->Fill(4); });
  LACUNA_CHECK_CONTAINS(Calibrate(none, nullptr, wall).Errors,
    "left out are 40 of 40 slices, by their SliceStatus: 40 too fast (4)");
  // too few are left: the error says where the others are
  const auto most = Spoilt(slices.Get(),
    [](vtkImageData* s)
    {
      vtkDataArray* status = s->GetFieldData()->GetArray("SliceStatus");
      status->Fill(4);
      for (int i = 0; i < 3; ++i)
      {
        status->SetTuple1(11 * i, 0);
      }
    });
  const std::string errors = Calibrate(most, nullptr, wall).Errors;
  LACUNA_CHECK_CONTAINS(errors, "picks give");
  LACUNA_CHECK_CONTAINS(errors, "left out are 37 of 40 slices");
  // given picks count
  const Scan wires = ScanWires(18);
  const auto fast = Spoilt(wires.Slices.Get(),
    [](vtkImageData* s) { s->GetFieldData()->GetArray("SliceStatus")->SetTuple1(2, 4); });
  const Calibrated given = Calibrate(fast, wires.Picks);
  LACUNA_CHECK(given.Residuals->GetNumberOfRows() == 18);
  LACUNA_CHECK_CONTAINS(given.Warnings, "picks were given, and count, in 1 of 18 slices");
}

// Each method says of its own outliers what they may be.
void TestOutlierAdvice()
{
  const auto slices = ScanFloor(40);
  const auto wall = [](auto* f) { f->SetMethodToSingleWall(); };
  const Calibrated found = Calibrate(slices, nullptr, wall);
  const auto wrong = Spoilt(found.Residuals.Get(),
    [](vtkTable* t)
    {
      for (vtkIdType i = 0; i < t->GetNumberOfRows(); i += 5)
      {
        t->SetValueByName(i, "Row", t->GetValueByName(i, "Row").ToDouble() + 25);
      }
    });
  const Calibrated given = Calibrate(slices, wrong, wall);
  LACUNA_CHECK_THAT(given.Errors.empty(), given.Errors);
  LACUNA_CHECK_CONTAINS(given.Warnings, "is their line the floor");
  LACUNA_CHECK(given.Warnings.find("wire") == std::string::npos);
}

// One calculation, whichever output is asked for and however often.
void TestOnce()
{
  vtkNew<vtkLacunaProbeCalibration> filter;
  filter->SetInputData(ScanFloor(40));
  filter->SetMethodToSingleWall();
  filter->SetPixelSpacing(ColumnSpacing);
  filter->SetRowSpacing(RowSpacing);
  int runs = 0;
  vtkNew<vtkCallbackCommand> count;
  count->SetClientData(&runs);
  count->SetCallback(
    [](vtkObject*, unsigned long, void* data, void*) { ++*static_cast<int*>(data); });
  filter->AddObserver(vtkCommand::EndEvent, count);
  for (int round = 0; round < 2; ++round)
  {
    for (const int port : { 0, 3, 1, 2, 4, 3 })
    {
      filter->Update(port);
    }
  }
  LACUNA_CHECK_THAT(runs == 1, std::to_string(runs) + " calculations");
  auto* map = vtkImageData::SafeDownCast(filter->GetOutputDataObject(3));
  int whole[6];
  filter->GetOutputInformation(3)->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), whole);
  for (int i = 0; i < 6; ++i)
  {
    LACUNA_CHECK(whole[i] == map->GetExtent()[i]);
  }
}

// The tip of a stylus from poses alone.
void TestStylus()
{
  const Vec3 tip{ 10, -20, 150 }, hole{ 200, 30, -60 };
  std::vector<Matrix4> poses;
  for (int i = 0; i < 30; ++i)
  {
    const Matrix4 turn = LookingDown(i, 40);
    poses.push_back(Matrix4::Translation(hole - turn.Vector(tip) +
                      Vec3{ 0.2 * Wave(i, 6), 0.2 * Wave(i, 7), 0.2 * Wave(i, 8) }) *
      turn);
  }
  const auto scan = Spoilt(MakeScan(poses).Get(),
    [](vtkImageData* s)
    {
      vtkDataArray* status = s->GetFieldData()->GetArray("SliceStatus");
      status->SetTuple1(3, 4); // nothing is seen, so that haste and bad pictures do no harm
      status->SetTuple1(4, 2);
      status->SetTuple1(5, 1);
    });
  const std::string name = "TestLacunaProbeCalibrationStylus.xml";
  const auto pivot = [&](auto* f)
  {
    f->SetMethodToStylusPivot();
    f->SetPixelSpacing(0);
    f->SetOutputFileName(name.c_str());
  };
  const auto check = [&](vtkImageData* slices, const char* frame)
  {
    std::remove(name.c_str());
    const Calibrated found = Calibrate(slices, nullptr, pivot);
    LACUNA_CHECK_THAT(found.Errors.empty(), found.Errors);
    vtkDataArray* place = lacuna::FieldData::Get(found.Slices, "StylusTip", 3, 1);
    const Vec3 error =
      Vec3{ place->GetComponent(0, 0), place->GetComponent(0, 1), place->GetComponent(0, 2) } - tip;
    LACUNA_CHECK(lacuna::Norm(error) < 0.2);
    LACUNA_CHECK(lacuna::Norm(error) < 3 * found.GetFigure("ExpectedError"));
    LACUNA_CHECK(found.GetFigure("ExpectedError") < 0.2);
    LACUNA_CHECK(found.GetFigure("CalibrationRms") < 0.2);
    LACUNA_CHECK(found.Residuals->GetNumberOfRows() == 29);
    LACUNA_CHECK(found.Residuals->GetValueByName(0, "Target").ToString() == "Tip");
    LACUNA_CHECK_CONTAINS(found.Warnings, "1 pose invalid (1)");
    LACUNA_CHECK(!found.Slices->GetFieldData()->HasArray("ImageToReference"));
    LACUNA_CHECK(!found.Slices->GetFieldData()->HasArray("PixelSpacing"));
    LACUNA_CHECK_CONTAINS(
      ReadFile(name), std::string("<Transform From=\"StylusTip\" To=\"") + frame + "\"");
  };
  check(scan, "Probe");
  check(Spoilt(scan.Get(),
          [](vtkImageData* s)
          {
            vtkDataArray* own = s->GetFieldData()->GetArray("ProbeToTracker");
            own->SetName("StylusToTracker");
            vtkNew<vtkDoubleArray> probe; // of another receiver, which is not meant
            probe->DeepCopy(own);
            probe->SetName("ProbeToTracker");
            probe->Fill(0);
            s->GetFieldData()->AddArray(probe);
          }),
    "Stylus");
  // a tip that leaves its hole
  for (int i = 0; i < 30; ++i)
  {
    poses[i] =
      Matrix4::Translation({ 4 * Wave(i, 9), 4 * Wave(i, 10), 4 * Wave(i, 11) }) * poses[i];
  }
  std::remove(name.c_str()); // of another receiver
  const std::string loose = Calibrate(MakeScan(poses), nullptr, pivot).Warnings;
  LACUNA_CHECK_CONTAINS(loose, "Did the tip stay in its hole");
  LACUNA_CHECK(loose.find("sound") == std::string::npos);
  // in two holes
  const Matrix4 elsewhere = Matrix4::Translation({ 80, 0, 0 });
  for (int i = 15; i < 30; ++i)
  {
    poses[i] = elsewhere * poses[i];
  }
  LACUNA_CHECK_CONTAINS(
    Calibrate(MakeScan(poses), nullptr, pivot).Errors, "the tip slipped in its hole");
  std::remove(name.c_str());
  const Calibrated still = Calibrate(MakeScan(std::vector<Matrix4>(30, poses[0])), nullptr, pivot);
  LACUNA_CHECK_CONTAINS(still.Errors, "tilt the stylus more");
  LACUNA_CHECK_CONTAINS(Calibrate(scan, ScanWires(18).Picks, pivot).Errors, "from poses alone");
}
}

int TestCalibrationReport(int, char*[])
{
  TestHopelessFile();
  TestScaleAdvice();
  TestFlags();
  TestOutlierAdvice();
  TestOnce();
  TestStylus();
  return lacunaCheck::Result();
}
