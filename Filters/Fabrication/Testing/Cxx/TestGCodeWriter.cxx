// SPDX-License-Identifier: BSD-3-Clause
#include "TestBadPlaces.h"
#include "TestMillingMould.h"
#include "lacunaCheck.h"
#include "lacunaGCodeParser.h"
#include "vtkErrorCode.h"
#include "vtkLacunaGCodeWriter.h"
#include "vtkPointData.h"

#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

using namespace millingMould;

namespace
{
//------------------------------------------------------------------------------
// What Milling Tool Path warns of is written only when asked for, and what was there stays.
void TestWarnings(const std::string& file)
{
  vtkNew<vtkLacunaMillingToolPath> filter;
  filter->SetInputData(Mould());
  const auto warned = lacunaCheck::Watch(filter);
  vtkNew<vtkLacunaGCodeWriter> writer;
  writer->SetInputConnection(filter->GetOutputPort());
  writer->SetFileName(file.c_str());
  vtksys::SystemTools::RemoveFile(file);
  const auto asked = lacunaCheck::Watch(writer);
  LACUNA_CHECK(writer->Write() == 0);
  LACUNA_CHECK(!vtksys::SystemTools::FileExists(file));
  LACUNA_CHECK(warned->HasWarning("up to 0.83 mm stay at the surface's border"));
  LACUNA_CHECK_CONTAINS(asked->Errors, "up to 0.83 mm stay at the surface's border");
  LACUNA_CHECK_CONTAINS(asked->Errors, "Turn on AcceptWarnings");
  writer->AcceptWarningsOn();
  LACUNA_CHECK(writer->Write() == 1);
  LACUNA_CHECK(GCodeParser(Read(file)).Steps.size() > 10);
  // one axis limited, the others free
  writer->SetEnvelope(1, -1, 1, -1, -1000, -999);
  LACUNA_CHECK(writer->Write() == 0);
  LACUNA_CHECK_CONTAINS(asked->Errors, "leaves the envelope (Z -1000 to -999 mm)");
  writer->SetEnvelope(1, -1, 1, -1, -1000, 1000);
  LACUNA_CHECK(writer->Write() == 1);
}

//------------------------------------------------------------------------------
void TestProgram(const std::string& file)
{
  vtkNew<vtkLacunaMillingToolPath> filter;
  filter->SetInputData(Mould());
  filter->SetRoughingStep(2);
  filter->SetOverrun(4);
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
    lacuna::FieldData::Set(changed, name, { std::numeric_limits<double>::infinity() }, 1);
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

int TestGCodeWriter(int argc, char* argv[])
{
  TestProgram(Folder(argc, argv) + "/TestGCodeWriter.nc");
  TestWarnings(Folder(argc, argv) + "/TestGCodeWarnings.nc");
  return lacunaCheck::Result();
}
