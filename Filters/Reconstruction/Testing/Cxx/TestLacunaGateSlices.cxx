// SPDX-License-Identifier: BSD-3-Clause
/// vtkLacunaGateSlices: flags, tables, phases, speed, errors, and what consumers make of it.
#include "lacunaFieldData.h"
#include "lacunaProvenance.h"
#include "lacunaTestStacks.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIntArray.h"
#include "vtkLacunaGateSlices.h"
#include "vtkLacunaSlicePlanes.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

#include <cmath>
#include <limits>
#include <sstream>

using lacuna::Matrix4;
using namespace lacunaTestStacks;

namespace
{
// Slices 0.1 s apart.
vtkSmartPointer<vtkTable> MakeTable(const char* keyName, const std::vector<double>& keys,
  const char* gateName, const std::vector<double>& gates)
{
  auto table = vtkSmartPointer<vtkTable>::New();
  const auto add = [&](const char* name, const std::vector<double>& values)
  {
    vtkNew<vtkDoubleArray> column;
    column->SetName(name);
    for (const double value : values)
    {
      column->InsertNextValue(value);
    }
    table->AddColumn(column);
  };
  add(keyName, keys);
  if (gateName)
  {
    add(gateName, gates);
  }
  return table;
}

using Settings = std::function<void(vtkLacunaGateSlices*)>;

struct Gated
{
  std::string Status; ///< a hexadecimal digit for each slice
  std::string Errors, Warnings;
  vtkSmartPointer<vtkImageData> Slices;
};

Gated Gate(vtkImageData* slices, vtkTable* table, const Settings& configure)
{
  vtkNew<vtkLacunaGateSlices> filter;
  filter->SetInputData(slices);
  if (table)
  {
    filter->SetInputDataObject(1, table);
  }
  configure(filter);
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  Gated gated{ "", messages->Errors, messages->Warnings, filter->GetOutput() };
  if (messages->Errors.empty())
  {
    vtkDataArray* status = filter->GetOutput()->GetFieldData()->GetArray("SliceStatus");
    for (vtkIdType i = 0; i < status->GetNumberOfTuples(); ++i)
    {
      gated.Status += "0123456789abcdef"[static_cast<int>(status->GetTuple1(i))];
    }
  }
  return gated;
}

void TestValues()
{
  const auto slices = MakeStack(MakePoses(6));
  const auto table = MakeTable("Time", { 0, 0.2, 0.5 }, "Gate", { 0, 20, 50 });
  Gated gated = Gate(slices, table, [](auto* f) { f->SetGateRange(10, 30.000000001); });
  LACUNA_CHECK_THAT(gated.Status == "800088", gated.Status); // 0 10 20 30 40 50
  vtkDataArray* gate = lacuna::FieldData::Get(gated.Slices, "Gate", 1, 6);
  LACUNA_CHECK_NEAR(gate->GetTuple1(3), 30, 1e-9);
  LACUNA_CHECK_THAT(gated.Warnings.empty(), gated.Warnings);
  LACUNA_CHECK_CONTAINS(lacuna::Provenance::Get(gated.Slices).back(), "vtkLacunaGateSlices");
  LACUNA_CHECK_CONTAINS(lacuna::Provenance::Get(gated.Slices).back(), "GateRange=10,30.000000001 ");
  // all else is as it was
  LACUNA_CHECK_THAT(
    gated.Slices->GetPointData()->GetScalars() == slices->GetPointData()->GetScalars(), "pixels");
  LACUNA_CHECK_THAT(
    slices->GetFieldData()->GetArray("SliceStatus")->GetTuple1(0) == 0, "the input is not touched");
  LACUNA_CHECK_THAT(slices->GetFieldData()->GetArray("Gate") == nullptr, "neither its arrays");
  LACUNA_CHECK_THAT(gated.Slices->GetFieldData()->GetArray("ImageToReference") != nullptr, "poses");
  // flags stay
  gated = Gate(MakeStack(MakePoses(6), VTK_SHORT, { 1, 0, 2, 4, 5, 0 }), table,
    [](auto* f) { f->SetGateRange(10, 30); });
  LACUNA_CHECK_THAT(gated.Status == "9024d8", gated.Status);

  // without a table: an array of the slices themselves
  lacuna::FieldData::Set(slices, "Breath", { 0, 1, 2, 3, 2, 1 }, 1);
  gated = Gate(slices, nullptr,
    [](auto* f)
    {
      f->SetGateColumn("Breath");
      f->SetGateRange(1.5, 2.5);
    });
  LACUNA_CHECK_THAT(gated.Status == "880808", gated.Status);
}

void TestPhases()
{
  const auto slices = MakeStack(MakePoses(11)); // 0 .. 1 s
  // 1.25 beats in a second: the phase wraps at 0.8 s
  const auto table =
    MakeTable("Timestamp", { 0, 0.3, 0.6, 0.9, 1.2 }, "Phase", { 0, 0.375, 0.75, 0.125, 0.5 });
  const auto with = [&](double first, double last)
  {
    return Gate(slices, table,
      [=](auto* f)
      {
        f->SetGateTypeToPhase();
        f->SetGateColumn("Phase");
        f->SetGateRange(first, last);
      })
      .Status;
  };
  // phases 0 .125 .25 .375 .5 .625 .75 .875 0 .125 .25
  LACUNA_CHECK_THAT(with(0.2, 0.6) == "88000888880", with(0.2, 0.6));
  LACUNA_CHECK_THAT(with(0.8, 0.15) == "00888880008", with(0.8, 0.15));
  LACUNA_CHECK_THAT(with(-0.2, 0.15) == "00888880008", with(-0.2, 0.15));
  LACUNA_CHECK_THAT(with(0, 1) == "00000000000", with(0, 1));

  // R waves at 0.05, 0.55 and 0.95 s
  const auto triggers = MakeTable("Time", { 0.05, 0.55, 0.95 }, nullptr, {});
  const Gated gated = Gate(slices, triggers,
    [](auto* f)
    {
      f->SetGateTypeToTrigger();
      f->SetPeriod(100);
      f->SetGateRange(25, 75);
    });
  // none 10 30 50 70 90 12.5 37.5 62.5 87.5 none
  LACUNA_CHECK_THAT(gated.Status == "88000880088", gated.Status);
  LACUNA_CHECK_CONTAINS(gated.Warnings, "2 of 11 slices have no gate value");
  LACUNA_CHECK_THAT(
    std::isnan(gated.Slices->GetFieldData()->GetArray("Gate")->GetTuple1(0)), "no value");
}

void TestMatching()
{
  const auto slices = MakeStack(MakePoses(5));
  for (int i = 0; i < 5; ++i)
  {
    slices->GetFieldData()->GetArray("FrameNumber")->SetTuple1(i, 100 + 2 * i);
  }
  auto table = MakeTable("Frame", { 108, 100, 104, 103 }, "Gate", { 1, 0.5, 7, 0 });
  Gated gated = Gate(slices, table, [](auto* f) { f->SetMatchByToFrameNumber(); });
  LACUNA_CHECK_THAT(gated.Status == "08880", gated.Status); // 102 and 106 have no row
  LACUNA_CHECK_CONTAINS(gated.Warnings, "2 of 5 slices");
  table = MakeTable("n", { 100, 100 }, "Gate", { 1, 0.5 });
  gated = Gate(slices, table,
    [](auto* f)
    {
      f->SetMatchByToFrameNumber();
      f->SetKeyColumn("n");
    });
  LACUNA_CHECK_CONTAINS(gated.Errors, "several rows for frame 100");

  // clocks that differ, gaps
  table = MakeTable("t", { 1000, 1000.1, 1000.4 }, "Gate", { 1, 1, 1 });
  gated = Gate(slices, table,
    [](auto* f)
    {
      f->SetKeyColumn("t");
      f->SetTimeOffset(-1000);
      f->SetMaximumTimeGap(0.2);
    });
  LACUNA_CHECK_THAT(gated.Status.substr(0, 4) == "0088", gated.Status);
  gated = Gate(slices, table, [](auto* f) { f->SetKeyColumn("t"); });
  LACUNA_CHECK_CONTAINS(gated.Errors, "no slice has a gate value");
  LACUNA_CHECK_CONTAINS(gated.Errors, "0 to 0.4 s, the gate table is from 1000 to 1000.4 s");

  // numbers as texts
  vtkNew<vtkTable> texts;
  for (const char* name : { "Time", "Gate" })
  {
    vtkNew<vtkStringArray> column;
    column->SetName(name);
    column->InsertNextValue("0");
    column->InsertNextValue("0.5");
    texts->AddColumn(column);
  }
  gated = Gate(slices, texts, [](auto* f) { f->SetGateRange(0.15, 1); });
  LACUNA_CHECK_THAT(gated.Status == "88000", gated.Status);
}

// ParaView's reader of texts turns empty cells into 0.
void TestEmptyCells()
{
  const auto slices = MakeStack(MakePoses(5)); // 0 .. 0.4 s
  auto table = MakeTable("Time", { 0, 0.1, 0, 0.3, 0.4 }, "Gate", { 1, 1, 1, 1, 1 });
  Gated gated = Gate(slices, table, [](auto*) {});
  LACUNA_CHECK_CONTAINS(gated.Warnings, "the gate table's key is 0 in row 2");
  LACUNA_CHECK_CONTAINS(gated.Warnings, "write nan");
  table = MakeTable("Frame", { 0, 1, 2, 3, 4 }, "Gate", { 1, 1, 1, 1, 1 });
  const auto byFrame = [](auto* f) { f->SetMatchByToFrameNumber(); };
  gated = Gate(slices, table, byFrame);
  LACUNA_CHECK_THAT(gated.Warnings.empty(), gated.Warnings);
  table = MakeTable("Frame", { 1, 2, 0, 4 }, "Gate", { 1, 1, 1, 1 });
  LACUNA_CHECK_CONTAINS(Gate(slices, table, byFrame).Warnings, "key is 0 in row 2");
}

void TestSpeed()
{
  std::vector<Matrix4> poses = MakePoses(6); // 1 mm in 0.1 s
  poses[3] = Matrix4::Translation({ 0, 0, 2 }) * poses[3];
  const auto slices = MakeStack(poses, VTK_SHORT, { 0, 0, 0, 0, 8, 0 });
  Gated gated = Gate(slices, nullptr, [](auto* f) { f->SetSpeedLimit(15); });
  // 10 10 10 30 10 (back by 1 mm) 10 mm/s
  LACUNA_CHECK_THAT(gated.Status == "000480", gated.Status);
  LACUNA_CHECK_THAT(gated.Slices->GetFieldData()->GetArray("Gate") == nullptr, "no gate");
  gated = Gate(slices, nullptr, [](auto* f) { f->SetSpeedLimit(5); });
  LACUNA_CHECK_THAT(gated.Status == "4444c4", gated.Status);
}

// A good slice is not too fast because the pose before it is bad; Slice Planes agrees.
void TestSpeedBesideBadPoses()
{
  std::vector<Matrix4> poses = MakePoses(16); // 1 mm in 0.1 s
  poses[5] = Matrix4::Translation({ 0, 500, 0 }) * poses[5];
  poses[9](0, 3) = 1e60;
  poses[12](1, 1) = 0; // singular
  poses[14] = Matrix4::Translation({ 0, 0, 2 }) * poses[14];
  const auto slices = MakeStack(poses);
  const Gated gated = Gate(slices, nullptr, [](auto* f) { f->SetSpeedLimit(15); });
  LACUNA_CHECK_THAT(gated.Status == "0000000000000040", gated.Status);
  LACUNA_CHECK_CONTAINS(gated.Warnings, "of which there are 3");
  LACUNA_CHECK_CONTAINS(gated.Warnings, "slice 5: its pose is an outlier");
  LACUNA_CHECK_CONTAINS(gated.Warnings, "slice 9: its pose puts a corner");
  LACUNA_CHECK_CONTAINS(gated.Warnings, "slice 12");
  vtkNew<vtkLacunaSlicePlanes> planes;
  planes->SetInputData(slices);
  planes->SetSpeedLimit(15);
  planes->OutlineOnlyOn();
  const auto messages = lacunaCheck::Watch(planes);
  planes->Update();
  LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
  vtkCellData* cells = planes->GetOutput()->GetCellData();
  LACUNA_CHECK(planes->GetOutput()->GetNumberOfCells() == 13);
  for (vtkIdType c = 0; c < planes->GetOutput()->GetNumberOfCells(); ++c)
  {
    const auto slice = static_cast<std::size_t>(cells->GetArray("SliceNumber")->GetTuple1(c));
    LACUNA_CHECK_THAT(
      (cells->GetArray("TooFast")->GetTuple1(c) != 0) == (gated.Status[slice] == '4'),
      "slice " + std::to_string(slice));
  }
}

// Poses without pictures have speeds, too.
void TestSpeedOfPosesAlone()
{
  const auto poses = MakePoses(4);
  vtkNew<vtkImageData> stack;
  stack->SetDimensions(1, 1, 4);
  stack->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  lacuna::TrackedSlices::Write(
    stack, poses, { 0, 0.1, 0.15, 0.25 }, std::vector<unsigned char>(4, 2), { 0, 1, 2, 3 });
  const Gated gated = Gate(stack, nullptr, [](auto* f) { f->SetSpeedLimit(15); });
  LACUNA_CHECK_THAT(gated.Status == "2262", gated.Status + gated.Errors);
  LACUNA_CHECK_THAT(gated.Warnings.empty(), gated.Warnings);
}

// Fields of sequence files come as texts.
void TestTexts()
{
  const auto slices = MakeStack(MakePoses(6));
  const auto setTexts = [&](const std::vector<std::string>& texts)
  {
    vtkNew<vtkStringArray> array;
    array->SetName("Gate");
    for (const std::string& text : texts)
    {
      array->InsertNextValue(text);
    }
    slices->GetFieldData()->AddArray(array);
  };
  setTexts({ "0", "0.5", "1e0", "-3.0", "1.0001", " 0.25 " });
  Gated gated = Gate(slices, nullptr, [](auto*) {});
  LACUNA_CHECK_THAT(gated.Errors.empty(), gated.Errors);
  LACUNA_CHECK_THAT(gated.Status == "000880", gated.Status);
  LACUNA_CHECK(lacuna::FieldData::Get(gated.Slices, "Gate", 1, 6)->GetTuple1(1) == 0.5);
  setTexts({ "0", "", "nan", "one", "1", "0.5 0.5" });
  gated = Gate(slices, nullptr, [](auto*) {});
  LACUNA_CHECK_THAT(gated.Status == "088808", gated.Status);
  LACUNA_CHECK_CONTAINS(gated.Warnings, "4 of 6 slices have no gate value");
  setTexts({ "on", "off", "on", "off", "on", "off" });
  LACUNA_CHECK_CONTAINS(
    Gate(slices, nullptr, [](auto*) {}).Errors, "'Gate' has no number; that of slice 0 is 'on'");
  setTexts({ "1" });
  LACUNA_CHECK_CONTAINS(Gate(slices, nullptr, [](auto*) {}).Errors, "'Gate' has 1 texts");
}

void TestErrors()
{
  const auto slices = MakeStack(MakePoses(4));
  const auto table = MakeTable("Time", { 0, 1 }, "Gate", { 0, 1 });
  const auto error = [&](vtkTable* gates, const Settings& configure)
  {
    const Gated gated = Gate(slices, gates, configure);
    LACUNA_CHECK_THAT(gated.Slices->GetNumberOfPoints() == 0, "no half result: " + gated.Errors);
    return gated.Errors;
  };
  LACUNA_CHECK_CONTAINS(error(nullptr, [](auto*) {}), "nothing to gate by");
  LACUNA_CHECK_CONTAINS(error(nullptr, [](auto*) {}), "field data array 'Gate'");
  LACUNA_CHECK_CONTAINS(error(table, [](auto* f) { f->SetGateColumn("ECG"); }),
    "no column 'ECG'; its columns are 'Time', 'Gate'");
  LACUNA_CHECK_CONTAINS(error(table, [](auto* f) { f->SetKeyColumn("t"); }), "no column 't'");
  LACUNA_CHECK_CONTAINS(
    error(table, [](auto* f) { f->SetMatchByToFrameNumber(); }), "no column 'FrameNumber'");
  LACUNA_CHECK_CONTAINS(error(table, [](auto* f) { f->SetGateRange(1, 0); }), "from 1 to 0");
  LACUNA_CHECK_CONTAINS(error(table,
                          [](auto* f)
                          {
                            f->SetGateTypeToPhase();
                            f->SetPeriod(0);
                          }),
    "Period");
  LACUNA_CHECK_CONTAINS(error(table, [](auto* f) { f->SetMaximumTimeGap(-1); }), "MaximumTimeGap");
  LACUNA_CHECK_CONTAINS(error(table, [](auto* f) { f->SetSpeedLimit(-1); }), "SpeedLimit");
  LACUNA_CHECK_CONTAINS(error(table,
                          [](auto* f)
                          {
                            f->SetGateTypeToTrigger();
                            f->SetMatchByToFrameNumber();
                          }),
    "MatchBy");
  const auto bad =
    MakeTable("Time", { 0, std::numeric_limits<double>::quiet_NaN() }, "Gate", { 0, 1 });
  LACUNA_CHECK_CONTAINS(error(bad, [](auto*) {}), "no finite time in row 1");
  vtkNew<vtkTable> empty;
  LACUNA_CHECK_CONTAINS(error(empty, [](auto*) {}), "no column 'Timestamp'");

  slices->GetFieldData()->RemoveArray("Timestamp");
  LACUNA_CHECK_CONTAINS(error(table, [](auto*) {}), "'Timestamp' is missing");
  lacuna::FieldData::Set(slices, "Gate", { 1, 2, 3 }, 1);
  LACUNA_CHECK_CONTAINS(error(nullptr, [](auto*) {}), "'Gate'");
  slices->GetFieldData()->RemoveArray("SliceStatus");
  LACUNA_CHECK_CONTAINS(error(table, [](auto*) {}), "'SliceStatus' is missing");
}

// Breathing moves the object: only gated slices show it sharply.
void TestConsumer()
{
  const auto slices = MakeStack(MakePoses(7));
  const auto table =
    MakeTable("Time", { 0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6 }, "Gate", { 0, 9, 9, 0, 9, 9, 0 });
  vtkNew<vtkLacunaGateSlices> gate;
  gate->SetInputData(slices);
  gate->SetInputDataObject(1, table);
  vtkNew<vtkLacunaSweptVolume> volume;
  volume->SetInputConnection(gate->GetOutputPort());
  volume->SetOutputSpacing(0.5, 0.5, 0.5);
  volume->Update();
  LACUNA_CHECK_THAT(volume->GetNumberOfSlicesAdded() == 3, "gated slices are left out");
  volume->UseGatedOutOn();
  volume->Update();
  LACUNA_CHECK_THAT(volume->GetNumberOfSlicesAdded() == 7, "or taken by choice");
  std::ostringstream text;
  gate->Print(text);
  LACUNA_CHECK_CONTAINS(text.str(), "GateType: Value (0 (Value), 1 (Phase) or 2 (Trigger))");
}
}

int TestLacunaGateSlices(int, char*[])
{
  TestValues();
  TestPhases();
  TestMatching();
  TestEmptyCells();
  TestSpeed();
  TestSpeedBesideBadPoses();
  TestSpeedOfPosesAlone();
  TestTexts();
  TestErrors();
  TestConsumer();
  return lacunaCheck::Result();
}
