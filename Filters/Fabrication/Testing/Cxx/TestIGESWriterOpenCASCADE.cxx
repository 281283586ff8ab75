// SPDX-License-Identifier: BSD-3-Clause
// OpenCASCADE, a CAD kernel that shares no code with the writer, reads the files back.
#include "TestSurfaces.h"
#include "lacunaCheck.h"
#include "vtkCellArray.h"
#include "vtkLacunaIGESWriter.h"
#include "vtkLogger.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkPolyData.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepClass_FaceClassifier.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GCPnts_AbscissaPoint.hxx>
#include <GProp_GProps.hxx>
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
#include <TopoDS_Edge.hxx>
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

std::vector<TopoDS_Shape> Parts(
  const TopoDS_Shape& shape, TopAbs_ShapeEnum kind, TopAbs_ShapeEnum notIn = TopAbs_SHAPE)
{
  std::vector<TopoDS_Shape> parts;
  for (TopExp_Explorer each(shape, kind, notIn); each.More(); each.Next())
  {
    parts.push_back(each.Current());
  }
  return parts;
}

// Reads and transfers all of a file without an error or warning.
TopoDS_Shape ReadShape(const std::string& path, IGESControl_Reader& reader)
{
  LACUNA_CHECK_THAT(
    reader.ReadFile(path.c_str()) == IFSelect_RetDone, "OpenCASCADE reads the file");
  CheckClean(reader.WS()->ModelCheckList(), "load");
  reader.TransferRoots();
  CheckClean(reader.WS()->TransferReader()->LastCheckList(), "transfer");
  const TopoDS_Shape shape = reader.OneShape();
  LACUNA_CHECK_THAT(BRepCheck_Analyzer(shape).IsValid(), "a valid shape");
  return shape;
}

// The one face of a file.
TopoDS_Face ReadFace(const std::string& path, const std::string& name)
{
  IGESControl_Reader reader;
  const TopoDS_Shape shape = ReadShape(path, reader);
  const Handle(IGESData_IGESModel) model = reader.IGESModel();
  LACUNA_CHECK_THAT(model->GlobalSection().UnitFlag() == 2, "unit flag");
  LACUNA_CHECK_THAT(model->GlobalSection().UnitName()->String() == "MM", "unit name");
  for (int i = 1; i <= model->NbEntities(); ++i)
  {
    const Handle(IGESData_IGESEntity) entity = model->Entity(i);
    if (entity->TypeNumber() == 128)
    {
      LACUNA_CHECK_THAT(entity->HasName() && entity->NameValue()->String() == name.c_str(), "name");
      LACUNA_CHECK_THAT(entity->DefColor() == IGESData_DefReference, "colour");
    }
  }
  const std::vector<TopoDS_Shape> faces = Parts(shape, TopAbs_FACE);
  LACUNA_CHECK_THAT(faces.size() == 1, "one face");
  return TopoDS::Face(faces.at(0));
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
          const lacuna::DepthMap::Geometry g = Geometry(view, turn);
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

// The area of the surface within the defect's outline, by counting fine squares.
double CountArea(const BRepAdaptor_Surface& surface, const TopoDS_Face& face)
{
  BRepClass_FaceClassifier classifier;
  double area = 0;
  constexpr double step = 0.4;
  for (double v = 0.5 * step; v < surface.LastVParameter(); v += step)
  {
    for (double u = 0.5 * step; u < surface.LastUParameter(); u += step)
    {
      classifier.Perform(face, gp_Pnt2d(u, v), 1e-7);
      if (classifier.State() == TopAbs_IN)
      {
        gp_Pnt p;
        gp_Vec du;
        gp_Vec dv;
        surface.D1(u, v, p, du, dv);
        area += step * step * du.Crossed(dv).Magnitude();
      }
    }
  }
  return area;
}

// Trimmed faces are valid, of the right area, and their edges lie on the surface.
void TestTrimmed(const std::string& path)
{
  using namespace TestSurfaces;
  for (const bool perspective : { false, true })
  {
    for (const double tolerance : { 0.0, 0.001, 0.05 })
    {
      auto map = Map(Geometry({ -0.3, 0.5, 0.9 }, 2.2), true, perspective);
      Fill(map, Defect);
      vtkNew<vtkLacunaIGESWriter> writer;
      writer->SetInputData(map);
      writer->SetFileName(path.c_str());
      writer->SetTolerance(tolerance);
      writer->SetDefectOutline(vtkLacunaIGESWriter::Trim);
      LACUNA_CHECK_THAT(writer->Write() == 1, "Write()");
      IGESControl_Reader reader;
      const TopoDS_Shape shape = ReadShape(path, reader);
      const std::vector<TopoDS_Shape> faces = Parts(shape, TopAbs_FACE);
      LACUNA_CHECK_THAT(faces.size() == 1, "one face");
      const TopoDS_Face face = TopoDS::Face(faces.at(0));
      LACUNA_CHECK_THAT(Parts(face, TopAbs_WIRE).size() == 2, "an outline and an island");
      for (const TopoDS_Shape& edge : Parts(face, TopAbs_EDGE))
      {
        LACUNA_CHECK_THAT(
          BRep_Tool::Tolerance(TopoDS::Edge(edge)) <= std::max(1.1 * tolerance, 1.1e-4),
          "edges lie on the surface: " + std::to_string(BRep_Tool::Tolerance(TopoDS::Edge(edge))));
      }
      GProp_GProps properties;
      BRepGProp::SurfaceProperties(face, properties, 1e-6);
      const BRepAdaptor_Surface surface(face, false);
      const double counted = CountArea(surface, face);
      LACUNA_CHECK_THAT(std::abs(properties.Mass() / counted - 1) < 0.003,
        "area " + std::to_string(properties.Mass()) + ", counted " + std::to_string(counted));
      if (!perspective)
      {
        // the surface within the ellipse less the island, and a part of it seen at an angle
        const double pi = std::acos(-1.0);
        const double flat = pi * (12 * 9 - 16);
        LACUNA_CHECK_THAT(
          properties.Mass() > 0.97 * flat && properties.Mass() < 1.1 * flat, "size of the defect");
      }
    }
  }
}

// A group of everything: a surface with its outline, a mould, curves, lines and points.
void TestGroup(const std::string& path)
{
  using namespace TestSurfaces;
  auto map = Map(Geometry({ 0, 1, 0 }, 0.4), true);
  Fill(map, Defect);
  std::vector<lacuna::Vec3> points;
  vtkNew<vtkPolyData> data;
  vtkNew<vtkPoints> corners;
  for (const lacuna::Vec3& p :
    { lacuna::Vec3{ 0, 0, 0 }, { 10, 0, 0 }, { 10, 5, 1 }, { -3, 7, 2 } })
  {
    corners->InsertNextPoint(p.data());
  }
  data->SetPoints(corners);
  vtkNew<vtkCellArray> lines;
  lines->InsertNextCell({ 0, 1, 2, 3, 0 });
  lines->InsertNextCell({ 0, 2 });
  data->SetLines(lines);
  vtkNew<vtkCellArray> vertices;
  vertices->InsertNextCell({ 1, 3 });
  data->SetVerts(vertices);
  vtkNew<vtkMultiBlockDataSet> group;
  group->SetBlock(0, map);
  group->SetBlock(1, Grid(1, points));
  group->SetBlock(2, data);
  vtkNew<vtkLacunaIGESWriter> writer;
  writer->SetInputData(group);
  writer->SetFileName(path.c_str());
  LACUNA_CHECK_THAT(writer->Write() == 1, "Write()");
  IGESControl_Reader reader;
  const TopoDS_Shape shape = ReadShape(path, reader);
  LACUNA_CHECK_THAT(Parts(shape, TopAbs_FACE).size() == 2, "two faces");
  LACUNA_CHECK_THAT(Parts(shape, TopAbs_VERTEX, TopAbs_EDGE).size() == 2, "two points");
  double length = 0;
  double offSurface = 0;
  const TopoDS_Shape face = Parts(shape, TopAbs_FACE).at(0);
  for (const TopoDS_Shape& edge : Parts(shape, TopAbs_EDGE, TopAbs_FACE))
  {
    const BRepAdaptor_Curve curve(TopoDS::Edge(edge));
    if (curve.GetType() == GeomAbs_BSplineCurve && curve.Degree() == 3)
    {
      LACUNA_CHECK_THAT(curve.Continuity() >= GeomAbs_C2, "outlines are C2");
      for (int k = 0; k < 12; ++k)
      {
        const gp_Pnt p = curve.Value(
          curve.FirstParameter() + k / 12.0 * (curve.LastParameter() - curve.FirstParameter()));
        const BRepExtrema_DistShapeShape distance(BRepBuilderAPI_MakeVertex(p).Vertex(), face);
        offSurface = std::max(offSurface, distance.Value());
      }
    }
    else
    {
      length += GCPnts_AbscissaPoint::Length(curve);
    }
  }
  LACUNA_CHECK_THAT(
    offSurface <= 0.001, "outlines lie on the surface " + std::to_string(offSurface));
  const double wanted = 10 + std::sqrt(26) + std::sqrt(174) + std::sqrt(62) + std::sqrt(126);
  LACUNA_CHECK_THAT(std::abs(length - wanted) < 1e-9, "lengths of the lines");
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
  TestTrimmed(path);
  TestGroup(path);
  return lacunaCheck::Result();
}
