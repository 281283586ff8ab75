// SPDX-License-Identifier: BSD-3-Clause
#include "TestMillingMould.h"
#include "TestSurfaces.h"
#include "lacunaCheck.h"
#include "lacunaProvenance.h"
#include "lacunaVector.h"
#include "vtkCellArray.h"
#include "vtkCellArrayIterator.h"
#include "vtkPointData.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>
#include <string>

using namespace millingMould;

namespace
{
//------------------------------------------------------------------------------
void TestPath()
{
  vtkNew<vtkLacunaMillingToolPath> filter;
  filter->SetInputData(Mould());
  filter->SetRoughingStep(2);
  filter->SetStockTop(1);
  auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK(messages->Errors.empty());
  vtkPolyData* path = filter->GetOutput();
  vtkPointData* data = path->GetPointData();
  vtkDataArray* motions = data->GetArray("Motion");
  vtkDataArray* times = data->GetArray("Time");
  vtkDataArray* feeds = data->GetArray("FeedRate");
  LACUNA_CHECK(motions && times && feeds && data->GetArray("Pass"));
  // one way through all lines, and the time it takes
  double time = 0;
  double cut = 0;
  vtkIdType next = 0;
  vtkIdType points = 0;
  auto cells = vtk::TakeSmartPointer(path->GetLines()->NewIterator());
  for (cells->GoToFirstCell(); !cells->IsDoneWithTraversal(); cells->GoToNextCell())
  {
    vtkIdType count;
    const vtkIdType* ids;
    cells->GetCurrentCell(count, ids);
    points += count;
    for (vtkIdType k = 0; k < count; ++k)
    {
      LACUNA_CHECK(k == 0 || ids[k] == ids[k - 1] + 1);
      LACUNA_CHECK(motions->GetComponent(ids[k], 0) == motions->GetComponent(ids[0], 0));
      if (k > 0)
      {
        lacuna::Vec3 a{};
        lacuna::Vec3 b{};
        path->GetPoint(ids[k - 1], a.data());
        path->GetPoint(ids[k], b.data());
        time += 60 * lacuna::Norm(b - a) / feeds->GetComponent(ids[k], 0);
        cut += motions->GetComponent(ids[k], 0) > 0 ? lacuna::Norm(b - a) : 0;
      }
      LACUNA_CHECK_NEAR(times->GetComponent(ids[k], 0), time, 1e-6);
    }
    LACUNA_CHECK(ids[0] >= next);
    next = ids[count - 1];
  }
  LACUNA_CHECK(path->GetNumberOfPoints() == points);
  LACUNA_CHECK_NEAR(Field(path, "MachiningTime"), time, 1e-6);
  LACUNA_CHECK_NEAR(Field(path, "PathLength"), cut, 1e-6);
  LACUNA_CHECK(Field(path, "PathLength", 1) > cut);
  LACUNA_CHECK(Field(path, "StockTop") == 1 && Field(path, "SafeZ") == 6);
  LACUNA_CHECK(Field(path, "StepOver") == 1 && Field(path, "StepOver", 1) == 1);
  LACUNA_CHECK(Field(path, "Levels") > 2 && Field(path, "LargestGouge") <= 0.001);
  LACUNA_CHECK(Field(path, "ToolRadius") == 4 && Field(path, "SpindleSpeed") == 6000);
  // the map
  vtkPolyData* map = Map(filter);
  LACUNA_CHECK(map->GetNumberOfPoints() == 121 * 81 && map->GetNumberOfCells() == 2 * 120 * 80);
  vtkDataArray* left = map->GetPointData()->GetArray("LeftOver");
  vtkDataArray* height = map->GetPointData()->GetArray("MachinedHeight");
  vtkDataArray* unreachable = map->GetPointData()->GetArray("Unreachable");
  LACUNA_CHECK(left && height && unreachable);
  for (vtkIdType k = 0; k < map->GetNumberOfPoints(); ++k)
  {
    double p[3];
    map->GetPoint(k, p);
    LACUNA_CHECK(height->GetComponent(k, 0) >= p[2] - 0.002);
    LACUNA_CHECK(
      left->GetComponent(k, 0) <= std::max(0.0, height->GetComponent(k, 0) - p[2]) + 1e-9);
    LACUNA_CHECK(unreachable->GetComponent(k, 0) <= left->GetComponent(k, 0));
  }
  LACUNA_CHECK_NEAR(left->GetRange()[1], Field(map, "LargestLeftOver"), 1e-12);
  // passed on
  for (vtkPolyData* output : { path, map })
  {
    vtkDataArray* matrix = output->GetFieldData()->GetArray("PressToPatient");
    LACUNA_CHECK(matrix && matrix->GetNumberOfComponents() == 16);
    const auto steps = lacuna::Provenance::Get(output);
    LACUNA_CHECK(steps.size() == 1 && steps[0].find("RoughingStep=2") != std::string::npos);
  }
  std::ostringstream text;
  filter->Print(text);
  LACUNA_CHECK_CONTAINS(text.str(), "LeftOverLimit: 0.1");
}

//------------------------------------------------------------------------------
// The same surface however its axes run through the grid, and from the other end.
void TestAxes()
{
  const auto lengths = [](vtkStructuredGrid* grid)
  {
    vtkNew<vtkLacunaMillingToolPath> filter;
    filter->SetInputData(grid);
    filter->Update();
    return Field(filter->GetOutput(), "PathLength");
  };
  const double expected = lengths(Mould());
  LACUNA_CHECK(expected > 600);
  LACUNA_CHECK(lengths(Mould(Height, 0)) == expected);
  LACUNA_CHECK(lengths(Mould(Height, 1)) == expected);
}

//------------------------------------------------------------------------------
void TestWarnsAndRefuses()
{
  const auto refuses = [](vtkStructuredGrid* grid, const std::string& words,
                         const std::function<void(vtkLacunaMillingToolPath*)>& change = {})
  {
    vtkNew<vtkLacunaMillingToolPath> filter;
    filter->SetInputData(grid);
    if (change)
    {
      change(filter);
    }
    auto messages = lacunaCheck::Watch(filter);
    filter->Update();
    LACUNA_CHECK_CONTAINS(messages->Errors, words);
    LACUNA_CHECK(filter->GetOutput()->GetNumberOfPoints() == 0);
    LACUNA_CHECK(Map(filter)->GetNumberOfPoints() == 0);
  };
  refuses(Mould([](double x, double y) { return x == 4 && y == 3 ? NaN : 0; }),
    "hole: the point is not finite, at column 4, row 3");
  refuses(Mould([](double x, double y) { return x == 4 && y == 3 ? -1 / 0.0 : 0; }), "not finite");
  auto blanked = Mould();
  blanked->BlankPoint(40);
  refuses(blanked, "blanked");
  auto folded = Mould();
  folded->GetPoints()->SetPoint(40, 20, 1, 0);
  refuses(folded, "folds back");
  vtkNew<vtkStructuredGrid> volume;
  volume->SetDimensions(2, 2, 2);
  vtkNew<vtkPoints> points;
  points->SetNumberOfPoints(8);
  volume->SetPoints(points);
  refuses(volume, "exactly one dimension of 1");
  const auto map = TestSurfaces::Map(TestSurfaces::Geometry({ 1, -2, 0.5 }, 0.3), true);
  refuses(TestSurfaces::PixelGrid(map, {}, false, 0),
    "plane of a depth map's pixels, not its surface: Transform makes such a grid");
  refuses(TestSurfaces::PixelGrid(map, lacuna::Matrix4::Translation({ 3, 4, 5 }), false, 0),
    "Take Transform out of the pipeline");
  auto wrong = Mould();
  lacuna::FieldData::Set(wrong, "PressToPatient", { 1, 2, 3 }, 3);
  refuses(wrong, "PressToPatient");
  using Filter = vtkLacunaMillingToolPath;
  refuses(Mould(), "ToolShape", [](Filter* f) { f->SetToolShape(2); });
  refuses(Mould(), "Pattern", [](Filter* f) { f->SetPattern(-1); });
  refuses(Mould(), "FeedRate", [](Filter* f) { f->SetFeedRate(0); });
  refuses(Mould(), "PlungeFeedRate", [](Filter* f) { f->SetPlungeFeedRate(NaN); });
  refuses(Mould(), "SpindleSpeed", [](Filter* f) { f->SetSpindleSpeed(-1); });
  refuses(Mould(), "MapSpacing", [](Filter* f) { f->SetMapSpacing(-1); });
  refuses(Mould(), "ToolRadius", [](Filter* f) { f->SetToolRadius(-1); });
  refuses(Mould(), "ball ends",
    [](Filter* f)
    {
      f->SetToolShape(Filter::Flat);
      f->SetScallopHeight(0.01);
    });

  // empty in, empty out
  vtkNew<vtkLacunaMillingToolPath> filter;
  vtkNew<vtkStructuredGrid> empty;
  filter->SetInputData(empty);
  auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK(messages->Errors.empty() && filter->GetOutput()->GetNumberOfPoints() == 0);

  // a map that cannot be as fine as was asked for says how fine it is
  filter->SetInputData(Mould());
  filter->SetMapSpacing(1e-6);
  filter->Update();
  LACUNA_CHECK_CONTAINS(messages->Warnings, "more points than the map may have");
  LACUNA_CHECK(Map(filter)->GetNumberOfPoints() < 4.1e6);
  filter->SetMapSpacing(0);

  // a slot that is too narrow is told with its place
  filter->SetInputData(Mould([](double x, double) { return std::abs(x - 18) < 0.5 ? -3 : 0; }));
  filter->Update();
  LACUNA_CHECK_CONTAINS(messages->Warnings, "too large for");
  LACUNA_CHECK_CONTAINS(messages->Warnings, "most at x 18");
  LACUNA_CHECK(Map(filter)->GetPointData()->GetArray("Unreachable")->GetRange()[1] > 2);

  // so is a tool that is larger than all there is
  filter->SetInputData(
    Mould([](double x, double y) { return 0.02 * ((x - 13) * (x - 13) + (y - 8) * (y - 8)); }));
  filter->SetToolRadius(40);
  messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK(messages->Errors.empty());
  LACUNA_CHECK_CONTAINS(messages->Warnings, "the tool (radius 40 mm) is too large for 9");
  LACUNA_CHECK(Field(filter->GetOutput(), "LargestGouge") <= 0.001);
  filter->SetToolRadius(4);

  // a border that slopes down is told, and Overrun mends it
  const auto slope = [](double x, double) { return -1.5 * x; };
  const auto rim = [&](const std::function<double(double, double)>& height, int shape,
                     double overrun, const std::string& advice)
  {
    filter->SetInputData(Mould(height));
    filter->SetToolShape(shape);
    filter->SetOverrun(overrun);
    messages = lacunaCheck::Watch(filter);
    filter->Update();
    LACUNA_CHECK(messages->Errors.empty());
    LACUNA_CHECK(advice.empty() == (messages->Warnings.find("border") == std::string::npos));
    LACUNA_CHECK_CONTAINS(messages->Warnings, advice);
    return Map(filter)->GetPointData()->GetArray("LeftOver")->GetRange()[1];
  };
  LACUNA_CHECK(rim(slope, Filter::Ball, 0, "Set Overrun to the tool's radius") > 1);
  LACUNA_CHECK(rim(slope, Filter::Ball, 4, "") < 0.05);
  LACUNA_CHECK(rim(slope, Filter::Flat, 0, "Set Overrun") > 3);
  LACUNA_CHECK(rim(slope, Filter::Flat, 4, "") < 1);
  const auto step = [](double x, double) { return x > 29 ? -6.0 : 0.0; };
  LACUNA_CHECK(rim(step, Filter::Ball, 4, "smaller tool, or make the surface larger") > 1);
  LACUNA_CHECK(rim([](double x, double) { return 0.5 * x; }, Filter::Ball, 0, "most at x 0") > 0.1);
}
}

int TestMillingToolPath(int argc, char* argv[])
{
  Folder(argc, argv);
  TestPath();
  TestAxes();
  TestWarnsAndRefuses();
  return lacunaCheck::Result();
}
