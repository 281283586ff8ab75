// SPDX-License-Identifier: BSD-3-Clause
#include "TestSurfaces.h"
#include "lacunaCheck.h"
#include "lacunaIGESParser.h"
#include "lacunaProvenance.h"
#include "vtkCallbackCommand.h"
#include "vtkErrorCode.h"
#include "vtkFloatArray.h"
#include "vtkLacunaIGESWriter.h"
#include "vtkLogger.h"
#include "vtkTestErrorObserver.h"

#include <vtksys/SystemTools.hxx>

#include <cstdlib>
#include <fstream>
#include <functional>
#include <sstream>

namespace
{
std::string Read(const std::string& path)
{
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

// Writes input and expects failure with the given error code and words in the message.
void Refuses(vtkDataObject* input, const std::string& path, const std::string& words,
  unsigned long code, double tolerance = 0.001)
{
  vtkNew<vtkLacunaIGESWriter> writer;
  vtkNew<vtkTest::ErrorObserver> observer;
  writer->AddObserver(vtkCommand::ErrorEvent, observer);
  writer->SetFileName(path.c_str());
  writer->SetTolerance(tolerance);
  writer->SetInputData(input);
  LACUNA_CHECK_THAT(writer->Write() == 0, "Write() returns 0: " + words);
  LACUNA_CHECK_THAT(observer->GetErrorMessage().find(words) != std::string::npos,
    "message says '" + words + "': " + observer->GetErrorMessage());
  LACUNA_CHECK_THAT(writer->GetErrorCode() == code, "error code: " + words);
  LACUNA_CHECK_THAT(writer->GetFileSize() == 0 && writer->GetNumberOfControlPoints()[0] == 0,
    "no results after failure: " + words);
}

void TestMaps(const std::string& path)
{
  using namespace TestSurfaces;
  for (const bool fitted : { true, false })
  {
    auto map = Map(Geometry({ 0, 0, -1 }, 0), fitted);
    vtkNew<vtkLacunaIGESWriter> maker; // any algorithm's name will do for the provenance
    lacuna::Provenance::Record(map, maker, {}, "NodeSpacing=1");
    vtkNew<vtkLacunaIGESWriter> writer;
    writer->SetInputData(map);
    writer->SetFileName(path.c_str());
    for (const double tolerance : { 0.0, 0.001, 0.05 })
    {
      writer->SetTolerance(tolerance);
      LACUNA_CHECK_THAT(writer->Write() == 1, "writes a map");
      LACUNA_CHECK_THAT(writer->GetErrorCode() == vtkErrorCode::NoError, "no error code");
      LACUNA_CHECK_THAT(
        writer->GetMaximumDeviation() <= std::max(tolerance, 1e-11), "keeps the tolerance");
      const std::string text = Read(path);
      LACUNA_CHECK_THAT(
        writer->GetFileSize() == static_cast<vtkTypeInt64>(text.size()), "size of the file");
      const IGESParser file(text);
      const IGESSurface surface(file.Entities.at(5));
      const int* size = writer->GetNumberOfControlPoints();
      LACUNA_CHECK_THAT(
        surface.Upper[0] + 1 == size[0] && surface.Upper[1] + 1 == size[1], "control points");
      LACUNA_CHECK_THAT(
        tolerance > 0 || size[0] == (fitted ? 60 : 90), "all samples when interpolating");
      LACUNA_CHECK_THAT(tolerance == 0 || size[0] * size[1] < 500, "few when approximating");
      LACUNA_CHECK_THAT(
        surface.Limits[1] == (fitted ? 59 : 89) && surface.Limits[3] == (fitted ? 39 : 69),
        "parameters are pixels");
      // The corners are exact enough to tell every mirror image and exchange of axes.
      const std::vector<lacuna::Vec3> points = Points(map, fitted);
      const int last = size[0] * size[1] - 1;
      const std::pair<int, std::size_t> corners[] = { { 0, 0 }, { size[0] - 1, fitted ? 59u : 89u },
        { last - size[0] + 1, points.size() - (fitted ? 60 : 90) }, { last, points.size() - 1 } };
      for (const auto& [control, sample] : corners)
      {
        for (int c = 0; c < 3; ++c)
        {
          LACUNA_CHECK_THAT(std::abs(surface.Points[3 * control + c] - points[sample][c]) <=
              std::max(tolerance, 1e-10),
            "corner");
        }
      }
      LACUNA_CHECK_THAT(
        IGESParser::String(file.Entities.at(surface.Properties.at(0)).Parameters.at(1)) ==
          (fitted ? "Fitted surface" : "Depth map surface"),
        "name");
      LACUNA_CHECK_THAT(text.find("NodeSpacing=1") != std::string::npos, "provenance");
      LACUNA_CHECK_THAT(
        IGESParser::String(file.Global[3]) == vtksys::SystemTools::GetFilenameName(path),
        "file name without folder");
      LACUNA_CHECK_THAT(file.Global[17].size() == 18, "date");
      // who sends it: a program with its version, and nobody
      const auto global = [&](int number) { return IGESParser::String(file.Global[number - 1]); };
      const std::string version = std::string("Lacuna ") + lacuna::Provenance::GetVersion();
      LACUNA_CHECK(global(3) == "Lacuna" && global(12) == "Lacuna");
      LACUNA_CHECK(global(5) == version && global(6) == version + " IGES Writer");
      LACUNA_CHECK(global(21) == "Lacuna" && global(22) == "Lacuna");
    }
    std::ostringstream text;
    writer->Print(text);
    LACUNA_CHECK_THAT(text.str().find("MaximumDeviation") != std::string::npos, "PrintSelf");
  }
}

void TestBadMaps(const std::string& path)
{
  using namespace TestSurfaces;
  constexpr unsigned long input = vtkErrorCode::UnknownError;
  const auto changed = [&](bool fitted, const std::function<void(vtkImageData*)>& change)
  {
    auto map = Map(Geometry({ 0, 0, -1 }, 0), fitted);
    change(map);
    return map;
  };
  const auto array = [](vtkImageData* map, const char* name)
  { return map->GetPointData()->GetArray(name); };
  Refuses(changed(false,
            [&](vtkImageData* map)
            {
              array(map, "Depth")->SetComponent(3000, 0, NaN);
              array(map, "Depth")->SetComponent(3001, 0, -std::numeric_limits<double>::infinity());
            }),
    path,
    "2 of the 6300 pixels of columns 0 to 89, rows 0 to 69 have no Depth. Run RBF Hole Filler",
    input);
  Refuses(
    changed(true, [&](vtkImageData* map) { array(map, "Fitted")->SetComponent(3000, 0, NaN); }),
    path, "1 of the 2400 pixels", input);
  Refuses(changed(true, [&](vtkImageData* map) { array(map, "Fitted")->Fill(NaN); }), path,
    "no surface to write", input);
  Refuses(changed(true,
            [&](vtkImageData* map)
            {
              array(map, "Fitted")->Fill(NaN);
              for (int k = 0; k < 9; ++k)
              {
                array(map, "Fitted")->SetComponent(20 + k % 3 + 90 * (30 + k / 3), 0, 1);
              }
            }),
    path, "at least 4 x 4 samples, these are 3 x 3", input);
  Refuses(changed(false, [&](vtkImageData* map) { map->GetPointData()->RemoveArray("Depth"); }),
    path, "'Depth', which is missing", input);
  Refuses(
    changed(false, [&](vtkImageData* map) { map->SetDirectionMatrix(1, 0, 0, 0, 1, 0, 0, 0, 1); }),
    path, "disagrees", input);
  Refuses(changed(true,
            [&](vtkImageData* map)
            {
              vtkNew<vtkFloatArray> three;
              three->SetName("Fitted");
              three->SetNumberOfComponents(3);
              three->SetNumberOfTuples(map->GetNumberOfPoints());
              three->Fill(1);
              map->GetPointData()->AddArray(three);
            }),
    path, "components", input);
  Refuses(Map(Geometry({ 0, 0, -1 }, 0), true), path, "Tolerance is -1 mm; it must be 0 mm or more",
    input, -1);
  Refuses(Map(Geometry({ 0, 0, -1 }, 0), true), path, "Tolerance is nan mm", input, NaN);
  vtkNew<vtkImageData> empty;
  Refuses(empty, path, "a depth map", input);
}

void TestBadGrids(const std::string& path)
{
  constexpr unsigned long input = vtkErrorCode::UnknownError;
  std::vector<lacuna::Vec3> points;
  auto grid = TestSurfaces::Grid(2, points);
  grid->GetPoints()->SetPoint(100, grid->GetPoint(101));
  Refuses(grid, path, "coincides with a neighbour at column 20, row 2", input);
  grid = TestSurfaces::Grid(2, points);
  grid->GetPoints()->SetPoint(100, 0, TestSurfaces::NaN, 0);
  Refuses(grid, path, "column 20, row 2", input);
  grid = TestSurfaces::Grid(2, points);
  for (int j = 0; j < 25; ++j)
  {
    for (int i = 0; i < 40; ++i)
    {
      grid->GetPoints()->SetPoint(i + vtkIdType{ 40 } * j, i < 20 ? i : 39.5 - i, j, 0);
    }
  }
  Refuses(grid, path, "folds back", input);
  grid = TestSurfaces::Grid(2, points);
  grid->BlankPoint(500);
  Refuses(grid, path, "blanked", input);
  grid = TestSurfaces::Grid(2, points);
  grid->SetDimensions(20, 10, 5);
  Refuses(grid, path, "20 x 10 x 5", input);
  grid->SetDimensions(1000, 1, 1);
  Refuses(grid, path, "exactly one dimension of 1", input);
  vtkNew<vtkStructuredGrid> empty;
  Refuses(empty, path, "exactly one dimension of 1", input);
}

void TestBadFiles(const std::string& folder)
{
  auto map = TestSurfaces::Map(TestSurfaces::Geometry({ 0, 0, -1 }, 0), true);
  Refuses(map, "", "FileName", vtkErrorCode::NoFileNameError);
  Refuses(map, folder + "/no/such/folder/a.igs", "no/such/folder/a.igs",
    vtkErrorCode::CannotOpenFileError);
  Refuses(map, folder, folder, vtkErrorCode::CannotOpenFileError);
  if (vtksys::SystemTools::FileExists("/dev/full"))
  {
    Refuses(map, "/dev/full", "/dev/full", vtkErrorCode::OutOfDiskSpaceError);
  }
}

// What was there stays when writing fails or is stopped.
void TestNothingIsLost(const std::string& path)
{
  std::ofstream(path) << "old";
  auto map = TestSurfaces::Map(TestSurfaces::Geometry({ 0, 0, -1 }, 0), true);
  map->GetPointData()->GetArray("Fitted")->SetComponent(3000, 0, TestSurfaces::NaN);
  Refuses(map, path, "1 of the 2400", vtkErrorCode::UnknownError);
  LACUNA_CHECK_THAT(Read(path) == "old", "an earlier file stays after an error");

  map = TestSurfaces::Map(TestSurfaces::Geometry({ 0, 0, -1 }, 0), true);
  vtkNew<vtkLacunaIGESWriter> writer;
  vtkNew<vtkTest::ErrorObserver> errors;
  writer->AddObserver(vtkCommand::ErrorEvent, errors);
  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback([](vtkObject* caller, unsigned long, void*, void*)
    { vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1); });
  writer->AddObserver(vtkCommand::ProgressEvent, stop);
  writer->SetInputData(map);
  writer->SetFileName(path.c_str());
  LACUNA_CHECK_THAT(writer->Write() == 0, "a stopped writer returns 0");
  LACUNA_CHECK_THAT(!errors->GetError(), "being stopped is no error message");
  LACUNA_CHECK_THAT(Read(path) == "old", "an earlier file stays when stopped");
}
}

int TestIGESWriter(int argc, char* argv[])
{
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_WARNING);
  std::string folder = ".";
  for (int i = 1; i + 1 < argc; ++i)
  {
    folder = std::string(argv[i]) == "-T" ? argv[i + 1] : folder;
  }
  folder = vtksys::SystemTools::CollapseFullPath(folder);
  const std::string path = folder + "/TestIGESWriter.igs";
  try
  {
    TestMaps(path);
    TestBadMaps(path);
    TestBadGrids(path);
    TestBadFiles(folder);
    TestNothingIsLost(path);
  }
  catch (const std::exception& e)
  {
    LACUNA_CHECK_THAT(false, e.what());
  }
  return lacunaCheck::Result();
}
