// SPDX-License-Identifier: BSD-3-Clause
#include "TestBadPlaces.h"
#include "lacunaCheck.h"
#include "lacunaGCodeParser.h"
#include "vtkCellArray.h"
#include "vtkCellArrayIterator.h"
#include "vtkDoubleArray.h"
#include "vtkErrorCode.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkLacunaCoordinates.h"
#include "vtkLacunaFieldData.h"
#include "vtkLacunaGCodeWriter.h"
#include "vtkLacunaMillingToolPath.h"
#include "vtkLacunaMirrored.h"
#include "vtkLacunaProvenance.h"
#include "vtkLogger.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStructuredGrid.h"

#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>
#include <vector>

namespace
{
constexpr double NaN = std::numeric_limits<double>::quiet_NaN();

double Height(double x, double y)
{
  return 0.01 * (x - 12) * (x - 12) - 0.02 * (y - 7) * (y - 7) + 0.05 * x * std::sin(0.2 * y) - 6;
}

// 31 x 21 points of 1 mm; the plane is across the axis of size 1.
vtkSmartPointer<vtkStructuredGrid> Mould(
  const std::function<double(double, double)>& height = Height, int flatAxis = 2)
{
  auto grid = vtkSmartPointer<vtkStructuredGrid>::New();
  const int sizes[3][3] = { { 1, 31, 21 }, { 31, 1, 21 }, { 31, 21, 1 } };
  grid->SetDimensions(sizes[flatAxis]);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (int j = 0; j < 21; ++j)
  {
    for (int i = 0; i < 31; ++i)
    {
      points->InsertNextPoint(i, j, height(i, j));
    }
  }
  grid->SetPoints(points);
  lacuna::Matrix4 press = lacuna::Matrix4::Rotation({ 1, 2, 3 }, 0.7);
  vtkLacunaFieldData::SetMatrices(grid, "PressToPatient", { press });
  return grid;
}

double Field(vtkDataObject* data, const char* name, int component = 0)
{
  vtkDataArray* array = data->GetFieldData()->GetArray(name);
  return array ? array->GetComponent(0, component) : NaN;
}

vtkPolyData* Map(vtkLacunaMillingToolPath* filter)
{
  return vtkPolyData::SafeDownCast(filter->GetOutputDataObject(1));
}

std::string Read(const std::string& path)
{
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

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
    const auto steps = vtkLacunaProvenance::Get(output);
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
  auto wrong = Mould();
  vtkLacunaFieldData::Set(wrong, "PressToPatient", { 1, 2, 3 }, 3);
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

//------------------------------------------------------------------------------
// The mark of mirrored data goes through the path, and stops at the file.
void TestMirrored(const std::string& file)
{
  const auto mould = Mould();
  vtkLacunaMirrored::Mark(mould, { 1, 2, 3 }, { 1, 0, 0 });
  vtkNew<vtkLacunaMillingToolPath> filter;
  filter->SetInputData(mould);
  auto messages = lacunaCheck::Watch(filter);
  filter->Update();
  LACUNA_CHECK_CONTAINS(messages->Warnings, "mirror image");
  LACUNA_CHECK(vtkLacunaMirrored::IsMarked(filter->GetOutput()));
  LACUNA_CHECK(vtkLacunaMirrored::IsMarked(filter->GetOutputDataObject(1)));
  vtkNew<vtkLacunaGCodeWriter> writer;
  writer->SetInputConnection(filter->GetOutputPort());
  writer->SetFileName(file.c_str());
  vtksys::SystemTools::RemoveFile(file);
  auto refused = lacunaCheck::Watch(writer);
  LACUNA_CHECK(writer->Write() == 0 && !vtksys::SystemTools::FileExists(file));
  LACUNA_CHECK_CONTAINS(refused->Errors, "mirror image");
  writer->AllowMirroredOn();
  auto allowed = lacunaCheck::Watch(writer);
  LACUNA_CHECK(writer->Write() == 1);
  LACUNA_CHECK_CONTAINS(allowed->Warnings, "mirror image");
  LACUNA_CHECK_CONTAINS(Read(file), "(MIRROR IMAGE, LEFT IS RIGHT)");
}

//------------------------------------------------------------------------------
// What ParaView's Transform does to a path is seen by the writer.
void TestMoved(const std::string& file)
{
  vtkNew<vtkLacunaMillingToolPath> filter;
  filter->SetInputData(Mould());
  filter->SetRoughingStep(2);
  filter->Update();
  const auto write =
    [&](const lacuna::Matrix4& move, bool single, const std::string& words, bool written)
  {
    vtkNew<vtkPolyData> path;
    path->DeepCopy(filter->GetOutput());
    vtkNew<vtkPoints> points;
    points->SetDataType(single ? VTK_FLOAT : VTK_DOUBLE);
    for (vtkIdType k = 0; k < path->GetNumberOfPoints(); ++k)
    {
      lacuna::Vec3 p;
      path->GetPoint(k, p.data());
      points->InsertNextPoint(move.Point(p).data());
    }
    path->SetPoints(points);
    vtkNew<vtkLacunaGCodeWriter> writer;
    writer->SetInputData(path);
    writer->SetFileName(file.c_str());
    vtksys::SystemTools::RemoveFile(file);
    const auto messages = lacunaCheck::Watch(writer);
    LACUNA_CHECK(writer->Write() == (written ? 1 : 0));
    LACUNA_CHECK(vtksys::SystemTools::FileExists(file) == written);
    LACUNA_CHECK_CONTAINS((written ? messages->Warnings : messages->Errors), words);
    LACUNA_CHECK((written ? messages->Errors : messages->Warnings).empty());
    if (written)
    {
      const bool moved = Read(file).find("THE PATH WAS MOVED SINCE") != std::string::npos;
      LACUNA_CHECK(moved != (Read(file).find("PRESS COORDINATES, TOOL TIP") != std::string::npos));
      LACUNA_CHECK_THAT(moved == !words.empty(), "the file says so, too");
    }
    return messages->Warnings.empty();
  };
  using lacuna::Matrix4;
  LACUNA_CHECK(write({}, false, "", true));
  LACUNA_CHECK(write({}, true, "", true));
  write(Matrix4::Scaling({ -1, 1, 1 }), false, "it is mirrored", false);
  // about the middle of the part, where its bounds stay
  write(Matrix4::Translation({ 0, 20, 0 }) * Matrix4::Scaling({ 1, -1, 1 }), true, "it is mirrored",
    false);
  write(Matrix4::Scaling({ 1 / 25.4, 1 / 25.4, 1 / 25.4 }), false, "distances in it", false);
  write(Matrix4::Scaling({ 1, 1, 1.01 }), true, "distances in it", false);
  write(Matrix4::Rotation({ 1, 0, 0 }, 0.001), false, "it is tilted by 0.057 degrees", false);
  write(
    Matrix4::Translation({ 5, 0, 0 }), true, "it lies up to 5 mm elsewhere. The program's", true);
  write(Matrix4::Translation({ 3, 0, 4 }), false, "up to 5 mm elsewhere. All of it is 4 mm higher",
    true);
  write(Matrix4::Translation({ 0, 0, -0.01 }), true, "it lies 0.01 mm lower", false);
  write(Matrix4::Translation({ 20, 0, -20 }), false, "it lies 20 mm lower", false);
  write(Matrix4::Rotation({ 0, 0, 1 }, 0.001), false, "PressToPatient does not lead", true);

  // one position deeper than the filter made it
  vtkNew<vtkPolyData> path;
  path->DeepCopy(filter->GetOutput());
  double p[3];
  path->GetPoint(500, p);
  path->GetPoints()->SetPoint(500, p[0], p[1], p[2] - 0.01);
  vtkNew<vtkLacunaGCodeWriter> writer;
  writer->SetInputData(path);
  writer->SetFileName(file.c_str());
  const auto messages = lacunaCheck::Watch(writer);
  LACUNA_CHECK(writer->Write() == 0);
  LACUNA_CHECK_CONTAINS(messages->Errors, "distances in it are other ones by up to 0.01 mm");
}

//------------------------------------------------------------------------------
// What it does to a mould is seen by the filter.
void TestMovedMould(const std::string& file)
{
  using lacuna::Matrix4;
  const auto mill = [&file](const std::function<double(double, double)>& height,
                      const Matrix4& move, double weight, const std::string& error,
                      const std::string& warning)
  {
    const auto mould = Mould(height);
    vtkNew<vtkImageData> patient;
    vtkLacunaCoordinates::Mark(patient, vtkLacunaCoordinates::Patient);
    vtkLacunaCoordinates::MarkPress(patient, mould);
    vtkNew<vtkDoubleArray> made;
    made->SetName("PressPosition");
    made->SetNumberOfComponents(4);
    vtkNew<vtkPoints> points; // single precision
    for (vtkIdType k = 0; k < mould->GetNumberOfPoints(); ++k)
    {
      lacuna::Vec3 p;
      mould->GetPoint(k, p.data());
      // some are filled in by filters
      k % 7 == 1 ? made->InsertNextTuple4(0, 0, 0, 0)
                 : made->InsertNextTuple4(p[0], p[1], p[2], weight);
      points->InsertNextPoint(move.Point(p).data());
    }
    mould->SetPoints(points);
    mould->GetPointData()->AddArray(made);
    vtkNew<vtkLacunaMillingToolPath> filter;
    filter->SetInputData(mould);
    filter->SetRoughingStep(2);
    const auto messages = lacunaCheck::Watch(filter);
    filter->Update();
    LACUNA_CHECK_CONTAINS(messages->Errors, error);
    LACUNA_CHECK(messages->Errors.empty() == error.empty());
    LACUNA_CHECK_CONTAINS(messages->Warnings, warning);
    LACUNA_CHECK((messages->Warnings.find("since it was made") == std::string::npos) ==
      (warning.empty() || !error.empty()));
    LACUNA_CHECK((filter->GetOutput()->GetNumberOfPoints() == 0) == !error.empty());
    if (!error.empty())
    {
      return;
    }
    // where it leads is not passed on, but told
    const bool moved = !warning.empty();
    for (vtkDataObject* output : { filter->GetOutputDataObject(0), filter->GetOutputDataObject(1) })
    {
      LACUNA_CHECK(output->GetFieldData()->HasArray("PressToPatient") == !moved);
      LACUNA_CHECK(vtkLacunaCoordinates::Get(output) == vtkLacunaCoordinates::Press);
      LACUNA_CHECK(vtkLacunaCoordinates::GetBeforePress(output) == (moved ? "" : "Patient"));
      LACUNA_CHECK((Field(output, "MovedSincePress") > 0.4) == moved);
    }
    vtkNew<vtkLacunaGCodeWriter> writer;
    writer->SetInputData(filter->GetOutput());
    writer->SetFileName(file.c_str());
    LACUNA_CHECK(writer->Write() == 1);
    LACUNA_CHECK(
      (Read(file).find("MM, PRESS COORDINATES, TOOL TIP") == std::string::npos) == moved);
    LACUNA_CHECK((Read(file).find("THE MOULD WAS MOVED") != std::string::npos) == moved);
  };
  const auto flat = [](double, double) { return -1.0; };
  mill(Height, {}, 1, "", "");
  mill(flat, {}, 1, "", "");
  mill(Height, Matrix4::Scaling({ -1, 1, 1 }), 1, "it is mirrored", "");
  mill(Height, Matrix4::Scaling({ -1, 1, 1 }), 0, "", ""); // no telling
  mill(
    Height, Matrix4::Scaling({ 1, 1.01, 1 }), 1, "distances in it are other ones by up to 0.", "");
  mill(flat, Matrix4::Scaling({ 1.01, 1, 1 }), 1, "distances in it", "");
  mill(Height, Matrix4::Translation({ 3, 4, 0 }), 1, "", "lies up to 5 mm elsewhere, and Press");
  mill(flat, Matrix4::Translation({ 0, 0, -0.5 }), 1, "", "lies up to 0.5 mm elsewhere");
  mill(Height, Matrix4::Rotation({ 1, 0, 0 }, 0.1), 1, "", "tilted by 5.73 degrees");
}

//------------------------------------------------------------------------------
void TestProgram(const std::string& file)
{
  vtkNew<vtkLacunaMillingToolPath> filter;
  filter->SetInputData(Mould());
  filter->SetRoughingStep(2);
  vtkNew<vtkLacunaGCodeWriter> writer;
  writer->SetInputConnection(filter->GetOutputPort());
  writer->SetFileName(file.c_str());
  writer->SetToolNumber(7);
  LACUNA_CHECK(writer->Write() == 1);
  const std::string text = Read(file);
  LACUNA_CHECK(writer->GetFileSize() == static_cast<vtkTypeInt64>(text.size()));
  const GCodeParser parser(text);
  LACUNA_CHECK(parser.Blocks == writer->GetNumberOfBlocks());
  LACUNA_CHECK(parser.Tool == 7 && parser.Speed == 6000);
  LACUNA_CHECK_CONTAINS(text, "BALL END, DIAMETER 8 MM");
  LACUNA_CHECK_CONTAINS(text, "VTKLACUNAMILLINGTOOLPATH");
  // the path, point for point, but for repeated ones
  vtkPolyData* path = filter->GetOutput();
  std::vector<std::array<double, 4>> expected;
  for (vtkIdType k = 0; k < path->GetNumberOfPoints(); ++k)
  {
    std::array<double, 4> p{};
    path->GetPoint(k, p.data());
    p[3] = path->GetPointData()->GetArray("Motion")->GetComponent(k, 0) == 0;
    if (expected.empty() || !std::equal(p.begin(), p.begin() + 3, expected.back().begin()))
    {
      expected.push_back(p);
    }
  }
  expected.front()[3] = 1; // to where the path starts
  std::vector<std::array<double, 4>> found;
  for (const GCodeParser::Step& step : parser.Steps)
  {
    const std::array<double, 4> p{ step.To[0], step.To[1], step.To[2], step.Rapid ? 1.0 : 0.0 };
    if (found.empty() || !std::equal(p.begin(), p.begin() + 3, found.back().begin()))
    {
      found.push_back(p);
    }
  }
  LACUNA_CHECK(found.size() == expected.size());
  for (std::size_t k = 0; k < std::min(found.size(), expected.size()); ++k)
  {
    for (int c = 0; c < 4; ++c)
    {
      // coordinates of the path are whole micrometres already
      LACUNA_CHECK_NEAR(found[k][c], expected[k][c], 1e-9);
    }
  }

  // refused: what was there stays
  const auto refuses = [&](
                         const std::string& words, unsigned long code = vtkErrorCode::UnknownError)
  {
    auto messages = lacunaCheck::Watch(writer);
    LACUNA_CHECK(writer->Write() == 0);
    LACUNA_CHECK_CONTAINS(messages->Errors, words);
    LACUNA_CHECK(writer->GetErrorCode() == code);
    LACUNA_CHECK(writer->GetFileSize() == 0 && writer->GetNumberOfBlocks() == 0);
    LACUNA_CHECK(Read(file) == text);
  };
  writer->SetEnvelope(-10, 40, -10, 30, -5, 40);
  refuses("leaves the envelope (Z -5 to 40 mm)");
  writer->SetEnvelope(1, -1, 1, -1, 1, -1);
  writer->SetHeader("G00 X5");
  refuses("decimal point");
  writer->SetHeader("");
  writer->SetSpindleSpeed(-1);
  refuses("SpindleSpeed");
  writer->SetSpindleSpeed(0);
  vtkNew<vtkPolyData> changed;
  changed->DeepCopy(path);
  writer->SetInputData(changed);
  changed->GetPoints()->SetPoint(50, 0, NaN, 0);
  refuses("not a number");
  changed->DeepCopy(path);
  changed->GetPointData()->RemoveArray("Motion");
  changed->Modified();
  refuses("no point array 'Motion'");
  vtkNew<vtkPolyData> none;
  writer->SetInputData(none);
  refuses("no poly lines");
  writer->SetInputData(path);
  writer->SetFileName(nullptr);
  refuses("FileName", vtkErrorCode::NoFileNameError);
  writer->SetFileName((file + ".missing/a.nc").c_str());
  refuses(".missing", vtkErrorCode::CannotOpenFileError);
  if (vtksys::SystemTools::FileExists("/dev/full"))
  {
    writer->SetFileName("/dev/full");
    refuses("No space", vtkErrorCode::OutOfDiskSpaceError);
  }
  for (const char* name : { "ToolRadius", "MachiningTime" })
  {
    changed->DeepCopy(path);
    vtkLacunaFieldData::Set(changed, name, { std::numeric_limits<double>::infinity() }, 1);
    writer->SetInputData(changed);
    writer->SetFileName(file.c_str());
    refuses(std::string(name) + " of the path is inf");
  }
  writer->SetInputData(path);
  TestBadPlaces(writer.Get(), file + ".places");
  writer->SetFileName(file.c_str());
  LACUNA_CHECK(writer->Write() == 1);
  // arcs only if asked for
  LACUNA_CHECK(GCodeParser(Read(file)).Arcs == 0);
  writer->SetArcTolerance(0.01);
  LACUNA_CHECK(writer->Write() == 1);
  const GCodeParser arcs(Read(file));
  LACUNA_CHECK(arcs.Arcs > 20 && arcs.Blocks < parser.Blocks);
  LACUNA_CHECK(arcs.Blocks == writer->GetNumberOfBlocks());
  LACUNA_CHECK_CONTAINS(Read(file), "(MOTIONS JOINED TO ARCS, AT MOST 0.01 MM ABOVE THE PATH)");
  writer->SetArcTolerance(0);
  LACUNA_CHECK(writer->Write() == 1);
  std::ostringstream print;
  writer->Print(print);
  LACUNA_CHECK_CONTAINS(print.str(), "WorkOffset: 54");

  // a filter that fails before the writer
  filter->SetToolRadius(-1);
  writer->SetInputConnection(filter->GetOutputPort());
  auto quiet = lacunaCheck::Watch(filter);
  auto messages = lacunaCheck::Watch(writer);
  LACUNA_CHECK(writer->Write() == 0);
  LACUNA_CHECK(writer->GetErrorCode() != vtkErrorCode::NoError && !quiet->Errors.empty());
}
}

int TestMillingToolPath(int argc, char* argv[])
{
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_WARNING);
  std::string folder = ".";
  for (int k = 1; k + 1 < argc; ++k)
  {
    folder = std::string(argv[k]) == "-T" ? argv[k + 1] : folder;
  }
  TestPath();
  TestAxes();
  TestWarnsAndRefuses();
  TestProgram(folder + "/TestMillingToolPath.nc");
  TestMirrored(folder + "/TestMillingToolPathMirrored.nc");
  TestMovedMould(folder + "/TestMillingToolPathMovedMould.nc");
  TestMoved(folder + "/TestMillingToolPathMoved.nc");
  return lacunaCheck::Result();
}
