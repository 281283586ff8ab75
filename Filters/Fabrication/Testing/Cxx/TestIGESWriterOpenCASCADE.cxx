// SPDX-License-Identifier: BSD-3-Clause
// OpenCASCADE, a CAD kernel that shares no code with the writer, reads the files back.
#include "TestSurfaces.h"
#include "lacunaCheck.h"
#include "vtkLacunaIGESWriter.h"
#include "vtkLogger.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <Bnd_Box.hxx>
#include <Geom_BSplineSurface.hxx>
#include <IGESControl_Reader.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_Check.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>

#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <cstdlib>
#include <string>

namespace
{
void CheckClean(const Interface_CheckIterator& checks, const std::string& stage)
{
  for (checks.Start(); checks.More(); checks.Next())
  {
    const Handle(Interface_Check)& check = checks.Value();
    for (int i = 1; i <= check->NbFails(); ++i)
    {
      LACUNA_CHECK_THAT(false, stage + " error: " + check->CFail(i));
    }
    for (int i = 1; i <= check->NbWarnings(); ++i)
    {
      LACUNA_CHECK_THAT(false, stage + " warning: " + check->CWarning(i));
    }
  }
}

// The one face of a file.
TopoDS_Face ReadFace(const std::string& path, const std::string& name)
{
  IGESControl_Reader reader;
  LACUNA_CHECK_THAT(
    reader.ReadFile(path.c_str()) == IFSelect_RetDone, "OpenCASCADE reads the file");
  const Handle(IGESData_IGESModel) model = reader.IGESModel();
  LACUNA_CHECK_THAT(model->GlobalSection().UnitFlag() == 2, "unit flag");
  LACUNA_CHECK_THAT(model->GlobalSection().UnitName()->String() == "MM", "unit name");
  CheckClean(reader.WS()->ModelCheckList(), "load");
  for (int i = 1; i <= model->NbEntities(); ++i)
  {
    const Handle(IGESData_IGESEntity) entity = model->Entity(i);
    if (entity->TypeNumber() == 128)
    {
      LACUNA_CHECK_THAT(entity->HasName() && entity->NameValue()->String() == name.c_str(), "name");
      LACUNA_CHECK_THAT(entity->DefColor() == IGESData_DefReference, "colour");
    }
  }
  reader.TransferRoots();
  CheckClean(reader.WS()->TransferReader()->LastCheckList(), "transfer");
  TopoDS_Face face;
  int faces = 0;
  for (TopExp_Explorer each(reader.OneShape(), TopAbs_FACE); each.More(); each.Next())
  {
    face = TopoDS::Face(each.Current());
    ++faces;
  }
  LACUNA_CHECK_THAT(faces == 1, "one face");
  return face;
}

// points: the samples, columns of them to a row, at whole parameters.
void CheckFace(const TopoDS_Face& face, const std::vector<lacuna::Vec3>& points,
  std::size_t columns, double tolerance)
{
  LACUNA_CHECK_THAT(BRepCheck_Analyzer(face).IsValid(), "a valid face");
  LACUNA_CHECK_THAT(face.Orientation() == TopAbs_FORWARD, "orientation");
  const BRepAdaptor_Surface surface(face);
  LACUNA_CHECK_THAT(surface.GetType() == GeomAbs_BSplineSurface, "a B-spline surface");
  LACUNA_CHECK_THAT(surface.UDegree() == 3 && surface.VDegree() == 3, "bicubic");
  LACUNA_CHECK_THAT(!surface.IsURational() && !surface.IsVRational(), "polynomial");
  LACUNA_CHECK_THAT(
    surface.UContinuity() >= GeomAbs_C2 && surface.VContinuity() >= GeomAbs_C2, "C2");
  const std::size_t rows = points.size() / columns;
  const double lastU = static_cast<double>(columns - 1);
  const double lastV = static_cast<double>(rows - 1);
  LACUNA_CHECK_THAT(
    std::abs(surface.FirstUParameter()) < 1e-12 && std::abs(surface.FirstVParameter()) < 1e-12,
    "first parameters");
  LACUNA_CHECK_THAT(std::abs(surface.LastUParameter() - lastU) < 1e-9 &&
      std::abs(surface.LastVParameter() - lastV) < 1e-9,
    "last parameters");
  Bnd_Box expected;
  double largest = 0;
  for (std::size_t k = 0; k < points.size(); ++k)
  {
    const gp_Pnt sample(points[k][0], points[k][1], points[k][2]);
    expected.Add(sample);
    const std::size_t row = k / columns;
    const gp_Pnt p = surface.Value(static_cast<double>(k % columns), static_cast<double>(row));
    largest = std::max(largest, p.Distance(sample));
  }
  LACUNA_CHECK_THAT(largest <= tolerance + 1e-9, "deviation " + std::to_string(largest));
  Bnd_Box box;
  BRepBndLib::AddOptimal(face, box, false, false);
  const auto corner = [](const Bnd_Box& b) { return std::make_pair(b.CornerMin(), b.CornerMax()); };
  LACUNA_CHECK_THAT(corner(box).first.Distance(corner(expected).first) < 0.05 &&
      corner(box).second.Distance(corner(expected).second) < 0.05,
    "bounding box");
}

void TestMaps(const std::string& path)
{
  using namespace TestSurfaces;
  const std::pair<lacuna::Vec3, double> views[] = { { { 0, 0, -1 }, 0 }, { { 0, 1, 0 }, 0.4 },
    { { -0.3, 0.5, 0.9 }, 2.2 } };
  for (const auto& [view, turn] : views)
  {
    for (const bool fitted : { true, false })
    {
      for (const bool perspective : { false, true })
      {
        auto map = Map(Geometry(view, turn), fitted, perspective);
        const std::vector<lacuna::Vec3> points = Points(map, fitted);
        for (const double tolerance : { 0.0, 0.001, 0.05 })
        {
          vtkNew<vtkLacunaIGESWriter> writer;
          writer->SetInputData(map);
          writer->SetFileName(path.c_str());
          writer->SetTolerance(tolerance);
          LACUNA_CHECK_THAT(writer->Write() == 1, "Write()");
          const TopoDS_Face face = ReadFace(path, fitted ? "Fitted surface" : "Depth map surface");
          CheckFace(face, points, fitted ? 60 : 90, tolerance);
          // dS/du x dS/dv points away from the viewer, along u is the viewer's right.
          gp_Pnt p;
          gp_Vec du;
          gp_Vec dv;
          BRepAdaptor_Surface(face).D1(20, 15, p, du, dv);
          const vtkLacunaDepthMap::Geometry g = Geometry(view, turn);
          const gp_Vec along(g.View[0], g.View[1], g.View[2]);
          const gp_Vec right(g.Right[0], g.Right[1], g.Right[2]);
          const gp_Vec down(g.Down[0], g.Down[1], g.Down[2]);
          LACUNA_CHECK_THAT(
            du.Crossed(dv).Dot(along) > 0 && du.Dot(right) > 0 && dv.Dot(down) > 0, "laterality");
        }
      }
    }
  }
}

void TestGrids(const std::string& path)
{
  for (int flat = 0; flat < 3; ++flat)
  {
    std::vector<lacuna::Vec3> points;
    vtkNew<vtkLacunaIGESWriter> writer;
    writer->SetInputData(TestSurfaces::Grid(flat, points));
    writer->SetFileName(path.c_str());
    LACUNA_CHECK_THAT(writer->Write() == 1, "Write()");
    const TopoDS_Face face = ReadFace(path, "Structured surface");
    CheckFace(face, points, 40, 0.001);
  }
}
}

int TestIGESWriterOpenCASCADE(int argc, char* argv[])
{
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_WARNING);
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream));
  std::string folder = ".";
  for (int i = 1; i + 1 < argc; ++i)
  {
    folder = std::string(argv[i]) == "-T" ? argv[i + 1] : folder;
  }
  const std::string path = folder + "/TestIGESWriterOpenCASCADE.igs";
  TestMaps(path);
  TestGrids(path);
  return lacunaCheck::Result();
}
