// SPDX-License-Identifier: BSD-3-Clause
/// Which row goes with which slice, states and errors of vtkLacunaAssembleTrackedSlices.
#include "lacunaTestPoses.h"
#include "vtkStringArray.h"

#include <limits>

using lacuna::Matrix4;

namespace
{
constexpr double NaN = std::numeric_limits<double>::quiet_NaN();

void TestMatching()
{
  const auto stack = MakeStack(4);
  LACUNA_CHECK_CONTAINS(GetError(stack, MakePoses(5)), "4 slices but 5 rows");
  LACUNA_CHECK_CONTAINS(GetError(stack, MakePoses(0)), "no rows");

  auto table = MakePoses(3);
  AddColumn(table, "frame", { 4, 3, 1 });
  auto filter = MakeFilter(stack, table,
    [](auto* f)
    {
      f->SetMatchBy(vtkLacunaAssembleTrackedSlices::FrameNumber);
      f->SetFirstFrameNumber(1);
    });
  auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK(messages->HasWarning("no pose for slice 1;"));
  vtkImageData* slices = filter->GetOutput();
  CheckPose(slices, 0, GetPose(2) * Matrix4::Scaling({ 0.5, 0.5, 0.5 }));
  CheckPose(slices, 3, Matrix4::Scaling({ 0.5, 0.5, 0.5 }));
  LACUNA_CHECK(GetStatus(slices, 1) == 1 && GetStatus(slices, 2) == 0);
  LACUNA_CHECK(slices->GetFieldData()->GetArray("FrameNumber")->GetTuple1(1) == 2);

  LACUNA_CHECK_CONTAINS(
    GetError(stack, MakePoses(4),
      [](auto* f) { f->SetMatchBy(vtkLacunaAssembleTrackedSlices::FrameNumber); }),
    "FrameColumn");
  table = MakePoses(4);
  AddColumn(table, "time", { 0, 1, 2, 3 });
  const auto byTime = [](auto* f) { f->SetMatchBy(vtkLacunaAssembleTrackedSlices::Time); };
  LACUNA_CHECK_CONTAINS(GetError(stack, MakePoses(4), byTime), "TimestampColumn");
  LACUNA_CHECK_CONTAINS(GetError(stack, table, byTime), "set FrameRate");
  LACUNA_CHECK_CONTAINS(GetError(stack, table,
                          [](auto* f)
                          {
                            f->SetMatchBy(vtkLacunaAssembleTrackedSlices::Time);
                            f->SetFrameRate(-1);
                          }),
    "FrameRate is -1");
  // 2 slices per second; the stack's own times win only without a rate
  vtkNew<vtkDoubleArray> times;
  times->SetName("Timestamp");
  for (const double time : { 3.0, 2.5, 0.5, 0.0 })
  {
    times->InsertNextValue(time);
  }
  stack->GetFieldData()->AddArray(times);
  filter = MakeFilter(stack, table,
    [](auto* f)
    {
      f->SetMatchBy(vtkLacunaAssembleTrackedSlices::Time);
      f->SetMaximumTimeGap(0);
    });
  filter->Update();
  CheckPose(filter->GetOutput(), 1, GetPose(2.5) * Matrix4::Scaling({ 0.5, 0.5, 0.5 }));
  filter->SetFrameRate(2);
  filter->Update();
  CheckPose(filter->GetOutput(), 3, GetPose(1.5) * Matrix4::Scaling({ 0.5, 0.5, 0.5 }));

  // a cell of the time that was empty
  table = MakePoses(4);
  AddColumn(table, "time", { 0, 1, 0, 3 });
  filter = MakeFilter(stack, table, byTime);
  messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK(messages->HasWarning("column 'time' is 0 in row 2 and grows"));
}

void TestStates()
{
  const auto stack = MakeStack(4);
  auto table = MakePoses(4);
  AddColumn(table, "SliceStatus", { 0, 1, 4, 2 });
  auto filter = MakeFilter(stack, table);
  auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK(messages->HasWarning("row 1 is not valid"));
  const double expected[4] = { 0, 1, 4, 2 };
  for (int i = 0; i < 4; ++i)
  {
    LACUNA_CHECK(GetStatus(filter->GetOutput(), i) == expected[i]);
  }
  LACUNA_CHECK(std::isnan(
    filter->GetOutput()->GetFieldData()->GetArray("ImageToReference")->GetComponent(1, 0)));

  table = MakePoses(4);
  vtkNew<vtkStringArray> texts;
  texts->SetName("Status");
  for (const char* text : { "OK", "ok", "MISSING", "" })
  {
    texts->InsertNextValue(text);
  }
  table->AddColumn(texts);
  filter = MakeFilter(stack, table);
  messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK(GetStatus(filter->GetOutput(), 1) == 0 && GetStatus(filter->GetOutput(), 2) == 1 &&
    GetStatus(filter->GetOutput(), 3) == 1);

  table = MakePoses(4);
  AddColumn(table, "is_valid", { 1, 0, 1, NaN });
  filter = MakeFilter(stack, table);
  messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK(messages->HasWarning("rows 1, 3 is not valid") || messages->HasWarning("rows 1, 3"));
  LACUNA_CHECK(GetStatus(filter->GetOutput(), 0) == 0 && GetStatus(filter->GetOutput(), 3) == 1);

  table = MakePoses(4);
  AddColumn(table, "status", { 0, 0, -3, 0 });
  LACUNA_CHECK_CONTAINS(GetError(stack, table), "is -3 in row 2");

  // numbers that are missing
  table = MakePoses(4);
  table->GetColumnByName("y")->SetVariantValue(2, vtkVariant(NaN));
  filter = MakeFilter(stack, table);
  messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK(messages->HasWarning("no pose in row 2"));
  LACUNA_CHECK(GetStatus(filter->GetOutput(), 2) == 1);
  LACUNA_CHECK(messages->Errors.empty());
}

void TestErrors()
{
  const auto stack = MakeStack(2);
  vtkNew<vtkTable> foreign;
  AddColumn(foreign, "alpha", { 1, 2 });
  LACUNA_CHECK_CONTAINS(GetError(stack, foreign), "'alpha'");
  LACUNA_CHECK_CONTAINS(
    GetError(stack, MakePoses(2),
      [](auto* f) { f->SetPoseFormat(vtkLacunaAssembleTrackedSlices::Matrix); }),
    "which fit PoseFormat Euler");
  LACUNA_CHECK_CONTAINS(
    GetError(stack, MakePoses(2), [](auto* f) { f->SetPixelSpacing(-1); }), "PixelSpacing is -1");
  LACUNA_CHECK_CONTAINS(
    GetError(stack, MakePoses(2), [](auto* f) { f->SetGateRange(0, 1); }), "GateColumn");
  LACUNA_CHECK_CONTAINS(
    GetError(stack, MakePoses(2), [](auto* f) { f->SetTimestampColumn("t"); }), "column 't'");
  auto table = MakePoses(2);
  AddColumn(table, "time_ms", { 1, 2 });
  LACUNA_CHECK_CONTAINS(GetError(stack, table), "not seconds");

  // columns by name, a column of several components, a pose that is none
  table = MakePoses(2);
  vtkNew<vtkDoubleArray> matrices;
  matrices->SetName("Pose");
  matrices->SetNumberOfComponents(16);
  matrices->InsertNextTuple(GetPose(3).Data());
  matrices->InsertNextTuple(Matrix4::Scaling({ 1, 1, -1 }).Data());
  table->AddColumn(matrices);
  const auto matrix = [](auto* f) { f->SetPoseFormat(vtkLacunaAssembleTrackedSlices::Matrix); };
  LACUNA_CHECK_CONTAINS(GetError(stack, table, matrix), "row 1 is none: it mirrors");
  const auto filter = MakeFilter(stack, table, matrix);
  filter->SkipInvalidPosesOn();
  const auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK(messages->HasWarning("mirrors"));
  CheckPose(filter->GetOutput(), 0, GetPose(3) * Matrix4::Scaling({ 0.5, 0.5, 0.5 }));
  LACUNA_CHECK(GetStatus(filter->GetOutput(), 1) == 1);
  filter->SetPoseFormat(vtkLacunaAssembleTrackedSlices::Euler);
  const char* names[6] = { "z", "y", "x", "azimuth", "roll", "elevation" };
  for (int i = 0; i < 6; ++i)
  {
    filter->SetPoseColumn(i, names[i]);
  }
  LACUNA_CHECK(filter->GetNumberOfPoseColumns() == 6);
  filter->Update();
  LACUNA_CHECK_NEAR(
    filter->GetOutput()->GetFieldData()->GetArray("ImageToReference")->GetComponent(1, 3), 3,
    1e-12);
}
}

int TestAssembleTrackedSlicesRows(int, char*[])
{
  TestMatching();
  TestStates();
  TestErrors();
  return lacunaCheck::Result();
}
