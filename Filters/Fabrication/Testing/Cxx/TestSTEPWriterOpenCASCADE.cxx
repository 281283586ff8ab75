// SPDX-License-Identifier: BSD-3-Clause
// OpenCASCADE reads the files back, in another program than the one that wrote them.
#include "lacunaCheck.h"
#include "lacunaCoordinates.h"
#include "lacunaMeshShapes.h"
#include "vtkCellArray.h"
#include "vtkErrorCode.h"
#include "vtkLacunaSTEPWriter.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <BRepBndLib.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>

#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace
{
using lacuna::ClosedMesh;
using lacuna::Vec3;

vtkSmartPointer<vtkPolyData> MakeSurface(const ClosedMesh& mesh)
{
  auto surface = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const Vec3& p : mesh.Points)
  {
    points->InsertNextPoint(p.data());
  }
  vtkNew<vtkCellArray> cells;
  for (const ClosedMesh::Triangle& ids : mesh.Triangles)
  {
    const vtkIdType corners[3] = { ids[0], ids[1], ids[2] };
    cells->InsertNextCell(3, corners);
  }
  surface->SetPoints(points);
  surface->SetPolys(cells);
  return surface;
}

std::string ReadText(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::size_t Count(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind)
{
  std::size_t count = 0;
  for (TopExp_Explorer each(shape, kind); each.More(); each.Next())
  {
    ++count;
  }
  return count;
}

// Reads a file, and compares what is in it with a mesh: valid, closed solids, volume, centre, box.
TopoDS_Shape CheckFile(const std::string& path, const ClosedMesh& mesh, std::size_t solids,
  std::size_t shells, double tolerance)
{
  STEPControl_Reader reader;
  LACUNA_CHECK_THAT(reader.ReadFile(path.c_str()) == IFSelect_RetDone, "OpenCASCADE reads " + path);
  reader.TransferRoots();
  const TopoDS_Shape shape = reader.OneShape();
  LACUNA_CHECK_THAT(BRepCheck_Analyzer(shape).IsValid(), path + " is valid");
  LACUNA_CHECK(Count(shape, TopAbs_SOLID) == solids);
  LACUNA_CHECK(Count(shape, TopAbs_SHELL) == shells);
  for (TopExp_Explorer each(shape, TopAbs_SHELL); each.More(); each.Next())
  {
    LACUNA_CHECK_THAT(BRep_Tool::IsClosed(each.Current()), "a closed shell");
  }
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties);
  const double volume = mesh.GetVolume();
  LACUNA_CHECK_NEAR(properties.Mass(), volume, 1e-3 * volume);
  // the centre of the volume, which no mirror image of these shapes has
  Vec3 centre{ 0, 0, 0 };
  Vec3 low = mesh.Points.front();
  Vec3 high = low;
  for (const ClosedMesh::Triangle& ids : mesh.Triangles)
  {
    const Vec3& a = mesh.Points[ids[0]];
    const Vec3& b = mesh.Points[ids[1]];
    const Vec3& c = mesh.Points[ids[2]];
    centre = centre + Dot(a, Cross(b, c)) / 24 / volume * (a + b + c);
    for (const Vec3& p : { a, b, c })
    {
      for (int k = 0; k < 3; ++k)
      {
        low[k] = std::min(low[k], p[k]);
        high[k] = std::max(high[k], p[k]);
      }
    }
  }
  const gp_Pnt found = properties.CentreOfMass();
  Bnd_Box box;
  BRepBndLib::AddOptimal(shape, box, false, false);
  for (int k = 0; k < 3; ++k)
  {
    LACUNA_CHECK_NEAR(found.Coord(k + 1), centre[k], tolerance + 1e-6);
    LACUNA_CHECK_NEAR(box.CornerMin().Coord(k + 1), low[k], tolerance + 1e-6);
    LACUNA_CHECK_NEAR(box.CornerMax().Coord(k + 1), high[k], tolerance + 1e-6);
  }
  return shape;
}

bool Write(vtkLacunaSTEPWriter* writer, const ClosedMesh& mesh, const std::string& path)
{
  writer->SetInputData(MakeSurface(mesh));
  writer->SetFileName(path.c_str());
  return writer->Write() == 1;
}

// A box with a hole through: its corners are in the file to the last digit that STEP has.
void CheckBox(const std::string& folder)
{
  const ClosedMesh mesh = lacunaMeshShapes::BoxWithHole(3);
  const std::string path = folder + "/STEPWriterBox.step";
  vtkNew<vtkLacunaSTEPWriter> writer;
  writer->SetNote("Coordinates: patient, DICOM LPS (mm)");
  LACUNA_CHECK(Write(writer, mesh, path));
  LACUNA_CHECK(writer->GetNumberOfFaces() == 10 && writer->GetNumberOfSolids() == 1);
  const TopoDS_Shape shape = CheckFile(path, mesh, 1, 1, 0);
  LACUNA_CHECK(Count(shape, TopAbs_FACE) == 10);
  std::size_t corners = 0;
  for (TopExp_Explorer each(shape, TopAbs_VERTEX); each.More(); each.Next(), ++corners)
  {
    const gp_Pnt at = BRep_Tool::Pnt(TopoDS::Vertex(each.Current()));
    LACUNA_CHECK(std::any_of(mesh.Points.begin(), mesh.Points.end(),
      [&](const Vec3& p) {
        return Norm(p - Vec3{ at.X(), at.Y(), at.Z() }) < 1e-6;
      }));
  }
  LACUNA_CHECK(corners > 0);
  const std::string text = ReadText(path);
  LACUNA_CHECK(static_cast<vtkTypeInt64>(text.size()) == writer->GetFileSize());
  for (const char* words : { "AUTOMOTIVE_DESIGN", ".MILLI.,.METRE.", "Unit mm",
         "patient, DICOM LPS", "10 flat faces", "Made by: ", "Tolerance=0.02", "STEPWriterBox" })
  {
    LACUNA_CHECK_THAT(text.find(words) != std::string::npos, words);
  }
}

void CheckSpheres(const std::string& folder)
{
  // a cavity off the middle, and a solid beside
  ClosedMesh mesh = lacunaMeshShapes::Sphere({ 1, 2, 3 }, 10, 30);
  lacunaMeshShapes::Append(mesh, lacunaMeshShapes::Sphere({ 3, 3, 5 }, 4, 16), true);
  lacunaMeshShapes::Append(mesh, lacunaMeshShapes::Sphere({ 20, -5, 9 }, 3, 16));
  const std::string path = folder + "/STEPWriterSpheres.stp";
  vtkNew<vtkLacunaSTEPWriter> writer;
  LACUNA_CHECK(Write(writer, mesh, path));
  CheckFile(path, mesh, 2, 3, 0.02);
  LACUNA_CHECK(writer->GetNumberOfSolids() == 2);
  LACUNA_CHECK(writer->GetMaximumDeviation() > 0 && writer->GetMaximumDeviation() <= 0.02);
  const int faces = writer->GetNumberOfFaces();
  LACUNA_CHECK(faces < static_cast<int>(mesh.Triangles.size()));
  writer->SetTolerance(0.1);
  LACUNA_CHECK(Write(writer, mesh, path));
  LACUNA_CHECK(writer->GetNumberOfFaces() < faces);
  CheckFile(path, mesh, 2, 3, 0.1);
}

// Turned and rounded to single precision, as an STL is, planes are not quite planes.
void CheckSinglePrecision(const std::string& folder)
{
  ClosedMesh mesh = lacunaMeshShapes::BoxWithHole(3);
  for (Vec3& p : mesh.Points)
  {
    const Vec3 turned{ 0.6 * p[0] - 0.8 * p[1], 0.48 * p[0] + 0.36 * p[1] - 0.8 * p[2],
      0.64 * p[0] + 0.48 * p[1] + 0.6 * p[2] };
    for (int k = 0; k < 3; ++k)
    {
      p[k] = static_cast<float>(turned[k] + 150);
    }
  }
  const std::string path = folder + "/STEPWriterSingle.step";
  vtkNew<vtkLacunaSTEPWriter> writer;
  LACUNA_CHECK(Write(writer, mesh, path));
  LACUNA_CHECK(writer->GetNumberOfFaces() == 10);
  CheckFile(path, mesh, 1, 1, 1e-4);
}

void CheckRefused(vtkPolyData* surface, const std::string& path, const std::string& words)
{
  vtkNew<vtkLacunaSTEPWriter> writer;
  vtkNew<lacunaCheck::Messages> messages;
  messages->Watch(writer);
  writer->SetInputData(surface);
  writer->SetFileName(path.c_str());
  LACUNA_CHECK(writer->Write() == 0);
  LACUNA_CHECK(writer->GetErrorCode() != vtkErrorCode::NoError);
  LACUNA_CHECK_THAT(messages->HasError(words), "an error with '" + words + "'");
  LACUNA_CHECK(writer->GetFileSize() == 0 && writer->GetNumberOfFaces() == 0);
}

void CheckRefusals(const std::string& folder)
{
  const std::string path = folder + "/STEPWriterRefused.step";
  vtksys::SystemTools::RemoveFile(path);
  const ClosedMesh box = lacunaMeshShapes::Box({ 0, 0, 0 }, { 1, 2, 3 });
  std::ofstream(path) << "mine";
  ClosedMesh open = box;
  open.Triangles.pop_back();
  CheckRefused(MakeSurface(open), path, "open: 3 edges");
  const auto mirrored = MakeSurface(box);
  lacuna::Coordinates::MarkMirrored(mirrored, { 0, 0, 0 }, { 1, 0, 0 });
  CheckRefused(mirrored, path, "mirror image of the patient");
  const auto lines = MakeSurface(box);
  vtkNew<vtkCellArray> line;
  const vtkIdType ids[2] = { 0, 1 };
  line->InsertNextCell(2, ids);
  lines->SetLines(line);
  CheckRefused(lines, path, "triangles only");
  LACUNA_CHECK_THAT(ReadText(path) == "mine", "what was there stays");
  CheckRefused(MakeSurface(box), folder + "/no/such/folder/x.step", "no/such/folder");

  vtkNew<vtkLacunaSTEPWriter> allowed;
  vtkNew<lacunaCheck::Messages> warnings;
  warnings->Watch(allowed);
  allowed->SetInputData(mirrored);
  allowed->SetFileName(path.c_str());
  allowed->AllowMirroredOn();
  LACUNA_CHECK(allowed->Write() == 1);
  LACUNA_CHECK(ReadText(path).find("MIRROR IMAGE") != std::string::npos);
}
}

int TestSTEPWriterOpenCASCADE(int argc, char* argv[])
{
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream));
  std::string folder = ".";
  for (int i = 1; i + 1 < argc; ++i)
  {
    folder = std::string(argv[i]) == "-T" ? argv[i + 1] : folder;
  }
  CheckBox(folder);
  CheckSpheres(folder);
  CheckSinglePrecision(folder);
  CheckRefusals(folder);
  return lacunaCheck::Result();
}
