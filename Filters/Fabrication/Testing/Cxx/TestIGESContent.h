// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Writes IGES files for tests and finds things in them.
#ifndef TestIGESContent_h
#define TestIGESContent_h

#include "TestSurfaces.h"
#include "lacunaCheck.h"
#include "lacunaIGESCurves.h"
#include "vtkCellArray.h"
#include "vtkCompositeDataSet.h"
#include "vtkInformation.h"
#include "vtkLacunaIGESWriter.h"
#include "vtkLogger.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkPolyData.h"
#include "vtkTestErrorObserver.h"

#include <vtksys/SystemTools.hxx>

#include <array>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace TestIGESContent
{
using Entity = IGESParser::Entity;
using Setting = std::function<void(vtkLacunaIGESWriter*)>;
inline std::string FilePath; ///< where Write writes

struct Outcome
{
  std::string Text;
  std::string Error;
  std::string Warning;
  int Surfaces;
  int Curves;
  int Points;
};

// Writes; Text is empty when nothing was written.
inline Outcome Write(vtkDataObject* input, const Setting& set = {})
{
  vtksys::SystemTools::RemoveFile(FilePath);
  vtkNew<vtkLacunaIGESWriter> writer;
  vtkNew<vtkTest::ErrorObserver> observer;
  writer->AddObserver(vtkCommand::ErrorEvent, observer);
  writer->AddObserver(vtkCommand::WarningEvent, observer);
  writer->SetFileName(FilePath.c_str());
  writer->SetInputData(input);
  if (set)
  {
    set(writer);
  }
  const int written = writer->Write();
  std::ostringstream text;
  text << std::ifstream(FilePath, std::ios::binary).rdbuf();
  LACUNA_CHECK_THAT((written == 1) == !text.str().empty(), "a file when Write() says so");
  return { text.str(), observer->GetErrorMessage(), observer->GetWarningMessage(),
    writer->GetNumberOfSurfaces(), writer->GetNumberOfCurves(), writer->GetNumberOfPoints() };
}

inline void Refuses(vtkDataObject* input, const std::string& words, const Setting& set = {})
{
  const Outcome outcome = Write(input, set);
  LACUNA_CHECK_THAT(outcome.Text.empty(), "no file: " + words);
  LACUNA_CHECK_THAT(
    outcome.Error.find(words) != std::string::npos, "says '" + words + "': " + outcome.Error);
}

inline std::vector<const Entity*> OfType(
  const IGESParser& file, long type, const std::string& status = "")
{
  std::vector<const Entity*> found;
  for (const auto& each : file.Entities)
  {
    if (each.second.Type == type && (status.empty() || each.second.Status == status))
    {
      found.push_back(&each.second);
    }
  }
  return found;
}

inline std::string NameOf(const IGESParser& file, const std::vector<long>& properties)
{
  return IGESParser::String(file.Entities.at(properties.at(0)).Parameters.at(1));
}

// The last parameter of an entity points to its name.
inline std::string NameOf(const IGESParser& file, const Entity& entity)
{
  return NameOf(file, std::vector<long>{ IGESParser::Integer(entity.Parameters.back()) });
}

inline lacuna::Vec3 Vec(const std::array<double, 3>& p)
{
  return { p[0], p[1], p[2] };
}

inline lacuna::Vec3 Coordinates(const Entity& entity, std::size_t first = 0)
{
  return { IGESParser::Real(entity.Parameters.at(first)),
    IGESParser::Real(entity.Parameters.at(first + 1)),
    IGESParser::Real(entity.Parameters.at(first + 2)) };
}

inline vtkSmartPointer<vtkImageData> DefectMap(bool perspective = false)
{
  auto map = TestSurfaces::Map(TestSurfaces::Geometry({ 0.2, -1, 0.1 }, 0.4), true, perspective);
  TestSurfaces::Fill(map, TestSurfaces::Defect);
  return map;
}

inline vtkSmartPointer<vtkPolyData> Lines(const std::vector<lacuna::Vec3>& points,
  const std::vector<std::vector<vtkIdType>>& lines, const std::vector<vtkIdType>& vertices = {})
{
  auto data = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> array;
  array->SetDataTypeToDouble();
  for (const lacuna::Vec3& p : points)
  {
    array->InsertNextPoint(p.data());
  }
  data->SetPoints(array);
  vtkNew<vtkCellArray> cells;
  for (const auto& line : lines)
  {
    cells->InsertNextCell(static_cast<vtkIdType>(line.size()), line.data());
  }
  data->SetLines(cells);
  vtkNew<vtkCellArray> verts;
  for (const vtkIdType id : vertices)
  {
    verts->InsertNextCell(1, &id);
  }
  data->SetVerts(verts);
  return data;
}

inline const std::vector<lacuna::Vec3> Corners{ { 0, 0, 0 }, { 10, 0, 0 }, { 10, 5, 1 },
  { -3, 7.25, 2 } };

inline vtkSmartPointer<vtkMultiBlockDataSet> Group(
  const std::vector<std::pair<std::string, vtkDataObject*>>& blocks)
{
  auto group = vtkSmartPointer<vtkMultiBlockDataSet>::New();
  unsigned int k = 0;
  for (const auto& [name, block] : blocks)
  {
    group->SetBlock(k, block);
    if (!name.empty())
    {
      group->GetMetaData(k)->Set(vtkCompositeDataSet::NAME(), name.c_str());
    }
    ++k;
  }
  return group;
}

/// Runs the parts of a test, which write to a file in the folder that the test driver names.
inline int Run(int argc, char* argv[], const std::string& file,
  const std::function<void(const std::string& folder)>& body)
{
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  std::string folder = ".";
  for (int i = 1; i + 1 < argc; ++i)
  {
    folder = std::string(argv[i]) == "-T" ? argv[i + 1] : folder;
  }
  folder = vtksys::SystemTools::CollapseFullPath(folder);
  FilePath = folder + "/" + file;
  try
  {
    body(folder);
  }
  catch (const std::exception& e)
  {
    LACUNA_CHECK_THAT(false, e.what());
  }
  return lacunaCheck::Result();
}
}
#endif
