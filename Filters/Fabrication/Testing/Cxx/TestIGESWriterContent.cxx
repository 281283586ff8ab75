// SPDX-License-Identifier: BSD-3-Clause
// What the IGES Writer makes of outlines, curves, points, groups and frames, and what it refuses.
#include "TestSurfaces.h"
#include "lacunaCheck.h"
#include "lacunaIGESCurves.h"
#include "lacunaMatrix4.h"
#include "vtkCellArray.h"
#include "vtkCompositeDataSet.h"
#include "vtkErrorCode.h"
#include "vtkInformation.h"
#include "vtkLacunaIGESWriter.h"
#include "vtkLacunaProvenance.h"
#include "vtkLogger.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkTestErrorObserver.h"
#include "vtkUnstructuredGrid.h"

#include <vtksys/Directory.hxx>
#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <functional>
#include <sstream>

#include <sys/resource.h>
#include <unistd.h>

namespace
{
using Entity = IGESParser::Entity;
using Setting = std::function<void(vtkLacunaIGESWriter*)>;
std::string FilePath;

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
Outcome Write(vtkDataObject* input, const Setting& set = {})
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

void Refuses(vtkDataObject* input, const std::string& words, const Setting& set = {})
{
  const Outcome outcome = Write(input, set);
  LACUNA_CHECK_THAT(outcome.Text.empty(), "no file: " + words);
  LACUNA_CHECK_THAT(
    outcome.Error.find(words) != std::string::npos, "says '" + words + "': " + outcome.Error);
}

std::vector<const Entity*> OfType(const IGESParser& file, long type, const std::string& status = "")
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

std::string NameOf(const IGESParser& file, const std::vector<long>& properties)
{
  return IGESParser::String(file.Entities.at(properties.at(0)).Parameters.at(1));
}

// The last parameter of an entity points to its name.
std::string NameOf(const IGESParser& file, const Entity& entity)
{
  return NameOf(file, std::vector<long>{ IGESParser::Integer(entity.Parameters.back()) });
}

lacuna::Vec3 Vec(const std::array<double, 3>& p)
{
  return { p[0], p[1], p[2] };
}

lacuna::Vec3 Coordinates(const Entity& entity, std::size_t first = 0)
{
  return { IGESParser::Real(entity.Parameters.at(first)),
    IGESParser::Real(entity.Parameters.at(first + 1)),
    IGESParser::Real(entity.Parameters.at(first + 2)) };
}

vtkSmartPointer<vtkImageData> DefectMap(bool perspective = false)
{
  auto map = TestSurfaces::Map(TestSurfaces::Geometry({ 0.2, -1, 0.1 }, 0.4), true, perspective);
  TestSurfaces::Fill(map, TestSurfaces::Defect);
  return map;
}

vtkSmartPointer<vtkPolyData> Lines(const std::vector<lacuna::Vec3>& points,
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

const std::vector<lacuna::Vec3> Corners{ { 0, 0, 0 }, { 10, 0, 0 }, { 10, 5, 1 }, { -3, 7.25, 2 } };

//------------------------------------------------------------------------------
// The outline is where the mask says: within half a pixel's diagonal of the ellipse or the island.
void CheckOutline(const IGESCurve& curve, vtkImageData* map, double tolerance)
{
  const vtkLacunaDepthMap contract(map);
  const lacuna::Matrix4 toPixel = contract.GetImageToWorld().Inverse();
  double worst = 0;
  double offSurface = 0;
  for (int k = 0; k <= 500; ++k)
  {
    const lacuna::Vec3 p = toPixel.Point(Vec(curve.At(k * 0.002 * curve.Limits[1])));
    const double x = 0.5 * (p[0] - 50);
    const double y = 0.75 * (p[1] - 30);
    const double toEllipse = (std::sqrt(x * x / 144 + y * y / 81) - 1) * 10;
    const double toIsland = std::hypot(x - 4, y + 2) - 4;
    worst = std::max(worst, std::min(std::abs(toEllipse), std::abs(toIsland)));
    offSurface = std::max(
      offSurface, std::abs(p[2] - TestSurfaces::Depth(0.5 * (p[0] - 49), 0.75 * (p[1] - 30))));
  }
  LACUNA_CHECK_THAT(worst < 0.45, "outline " + std::to_string(worst) + " mm off");
  LACUNA_CHECK_THAT(
    offSurface <= 2 * tolerance + 1e-4, "curve off the surface: " + std::to_string(offSurface));
  LACUNA_CHECK_THAT(curve.Closed, "closed");
}

void TestOutlines()
{
  auto map = DefectMap();
  const Outcome curves = Write(map);
  LACUNA_CHECK_THAT(curves.Surfaces == 1 && curves.Curves == 2 && curves.Points == 0, "counts");
  const IGESParser file(curves.Text);
  LACUNA_CHECK_THAT(OfType(file, 144).empty(), "not trimmed by default");
  for (const Entity* entity : OfType(file, 126))
  {
    CheckOutline(IGESCurve(*entity), map, 0.001);
    LACUNA_CHECK_THAT(entity->Level == 2, "level of curves");
    LACUNA_CHECK_THAT(NameOf(file, IGESCurve(*entity).Properties) == "Defect outline", "name");
    LACUNA_CHECK_THAT(entity->Colour != OfType(file, 128).at(0)->Colour, "colour of its own");
  }
  LACUNA_CHECK_THAT(OfType(file, 128).at(0)->Level == 1, "level of surfaces");

  const Outcome none = Write(map, [](vtkLacunaIGESWriter* w) { w->SetDefectOutline(0); });
  LACUNA_CHECK_THAT(none.Surfaces == 1 && none.Curves == 0, "no outline");

  for (const bool perspective : { false, true })
  {
    for (const double tolerance : { 0.0, 0.001, 0.05 })
    {
      map = DefectMap(perspective);
      const Outcome outcome = Write(map,
        [&](vtkLacunaIGESWriter* w)
        {
          w->SetDefectOutline(vtkLacunaIGESWriter::Trim);
          w->SetTolerance(tolerance);
        });
      const IGESParser trimmed(outcome.Text);
      LACUNA_CHECK_THAT(OfType(trimmed, 144).size() == 1, "one piece");
      const IGESTrimmedSurface read(trimmed, *OfType(trimmed, 144).at(0));
      LACUNA_CHECK_THAT(read.Boundaries.size() == 2, "with an island");
      LACUNA_CHECK_THAT(NameOf(trimmed, read.Properties) == "Fitted surface", "name");
      double off = 0;
      double area[2] = { 0, 0 };
      for (int b = 0; b < 2; ++b)
      {
        const IGESTrimmedSurface::Boundary& boundary = read.Boundaries[b];
        std::array<double, 3> before = boundary.Parameters.At(0);
        for (int k = 1; k <= 2000; ++k)
        {
          const double t = k / 2000.0 * boundary.Parameters.Limits[1];
          const std::array<double, 3> uv = boundary.Parameters.At(t);
          area[b] += 0.5 * (before[0] * uv[1] - uv[0] * before[1]) * 0.5 * 0.75;
          before = uv;
          off = std::max(off,
            lacuna::Norm(Vec(IGESPoint(read.Surface, uv[0], uv[1])) - Vec(boundary.Space.At(t))));
        }
        if (!perspective)
        {
          CheckOutline(boundary.Space, map, tolerance);
        }
      }
      LACUNA_CHECK_THAT(off <= (tolerance > 0 ? tolerance : 1e-4),
        "the curve lies on the surface: " + std::to_string(off));
      const double pi = std::acos(-1.0);
      LACUNA_CHECK_THAT(std::abs(area[0] / (pi * 12 * 9) - 1) < 0.03,
        "counterclockwise, the area of the ellipse: " + std::to_string(area[0]));
      LACUNA_CHECK_THAT(std::abs(area[1] / (-pi * 16) - 1) < 0.1,
        "clockwise, the area of the island: " + std::to_string(area[1]));
    }
  }
}

// Pieces in islands of pieces, and outlines that cannot be.
void TestPieces()
{
  const Setting trim = [](vtkLacunaIGESWriter* w) { w->SetDefectOutline(2); };
  auto map = DefectMap();
  TestSurfaces::Fill(map,
    [](int i, int j)
    {
      const double r = std::hypot(i - 50, 1.5 * (j - 30));
      const bool rings = r < 4 || (r >= 8 && r < 12) || (r >= 16 && r < 22);
      return rings || std::hypot(i - 28, 1.5 * (j - 18)) < 5;
    });
  const IGESParser file(Write(map, trim).Text);
  std::vector<std::size_t> holes;
  for (const Entity* entity : OfType(file, 144))
  {
    holes.push_back(IGESTrimmedSurface(file, *entity).Boundaries.size() - 1);
  }
  std::sort(holes.begin(), holes.end());
  LACUNA_CHECK_THAT((holes == std::vector<std::size_t>{ 0, 0, 1, 1 }), "a hole in each ring");

  map = TestSurfaces::Map(TestSurfaces::Geometry({ 0, 0, -1 }, 0), true);
  Refuses(map, "no point array 'FilledMask'", trim);
  TestSurfaces::Fill(map, [](int, int) { return false; });
  Refuses(map, "marks no defect", trim);
  LACUNA_CHECK_THAT(Write(map).Curves == 0, "no outline where nothing is marked");
  TestSurfaces::Fill(map, [](int i, int j) { return i < 40; });
  Refuses(map, "reaches the border", trim);
  const Outcome warned = Write(map);
  LACUNA_CHECK_THAT(!warned.Text.empty() && warned.Curves == 0 &&
      warned.Warning.find("reaches the border") != std::string::npos,
    "a warning instead of the outline");
  Refuses(map, "DefectOutline is 3", [](vtkLacunaIGESWriter* w) { w->SetDefectOutline(3); });
  Refuses(map, "Coordinates is -1", [](vtkLacunaIGESWriter* w) { w->SetCoordinates(-1); });
}

//------------------------------------------------------------------------------
void TestPolyData()
{
  // A polygon, a straight line, a closed chain of segments in any order, and two vertices.
  const Outcome outcome = Write(Lines(Corners, { { 0, 1, 2, 3 }, { 0, 3 } }, { 2, 0 }));
  LACUNA_CHECK_THAT(outcome.Curves == 2 && outcome.Points == 2 && outcome.Surfaces == 0, "counts");
  const IGESParser file(outcome.Text);
  const Entity& entity = *OfType(file, 102).at(0);
  const IGESPolygon polygon(file, entity);
  LACUNA_CHECK_THAT(polygon.Corners.size() == 4 && entity.Level == 2, "a polygon");
  LACUNA_CHECK_THAT(NameOf(file, polygon.Properties) == "Poly line", "its name");
  for (std::size_t k = 0; k < 4; ++k)
  {
    LACUNA_CHECK_THAT(Vec(polygon.Corners.at(k)) == Corners[k], "corner");
  }
  const Entity& line = *OfType(file, 110, "00000000").at(0);
  LACUNA_CHECK_THAT(Coordinates(line) == Corners[0] && Coordinates(line, 3) == Corners[3], "line");
  LACUNA_CHECK_THAT(line.Level == 2, "level");
  const auto points = OfType(file, 116);
  LACUNA_CHECK_THAT(points.size() == 2 && Coordinates(*points[0]) == Corners[2] &&
      Coordinates(*points[1]) == Corners[0] && points[0]->Level == 3,
    "points");

  const IGESParser ring(Write(Lines(Corners, { { 2, 1 }, { 3, 2 }, { 0, 1 }, { 0, 3 } })).Text);
  LACUNA_CHECK_THAT(
    OfType(ring, 102).size() == 1 && OfType(ring, 110, "00000000").empty(), "one ring");
  const IGESPolygon closed(ring, *OfType(ring, 102).at(0));
  LACUNA_CHECK_THAT(
    closed.Corners.size() == 5 && closed.Corners[0] == closed.Corners[4], "which is closed");
  // three segments that meet stay apart; a chain of two is one curve
  const IGESParser fork(Write(Lines(Corners, { { 0, 1 }, { 1, 2 }, { 1, 3 } })).Text);
  LACUNA_CHECK_THAT(OfType(fork, 110).size() == 3, "a fork");
  const IGESParser chain(Write(Lines(Corners, { { 1, 0 }, { 1, 2 }, { 3, 3 } })).Text);
  LACUNA_CHECK_THAT(OfType(chain, 102).size() == 1 && OfType(chain, 110, "00000000").empty(),
    "a chain; no line of no length");

  // coordinates are as fine as those of surfaces
  std::vector<lacuna::Vec3> third{ { 1.0 / 3, 0, 0 }, { 2, 0, 0 } };
  LACUNA_CHECK_THAT(
    Coordinates(*OfType(IGESParser(Write(Lines(third, { { 0, 1 } })).Text), 110).at(0))[0] ==
      0.3333,
    "rounded");
  const Outcome exact =
    Write(Lines(third, { { 0, 1 } }), [](vtkLacunaIGESWriter* w) { w->SetTolerance(0); });
  LACUNA_CHECK_THAT(
    Coordinates(*OfType(IGESParser(exact.Text), 110).at(0))[0] == 1.0 / 3, "not rounded");

  third[1][2] = TestSurfaces::NaN;
  Refuses(Lines(third, { { 0, 1 } }), "point 1 is not finite");
  Refuses(Lines(Corners, {}), "no line of any length and no vertex");
  Refuses(Lines({}, {}), "no line of any length and no vertex");
}

// The screw holes of a plate, whose triangles have no place here.
void TestScrews()
{
  auto plate = Lines(Corners, {});
  vtkNew<vtkCellArray> triangles;
  triangles->InsertNextCell({ 0, 1, 2 });
  plate->SetPolys(triangles);
  Refuses(plate, "has 1 polygons");
  vtkLacunaFieldData::Set(plate, "HoleCenters", { 1, 2, 3, 4, 5, 6.5 }, 3);
  vtkLacunaFieldData::Set(plate, "HoleAxes", { 0, 0, 1, 0, -1, 0 }, 3);
  Refuses(plate, "write them as STL");
  const Setting skip = [](vtkLacunaIGESWriter* w) { w->SkipUnsupportedOn(); };
  const Outcome outcome = Write(plate, skip);
  LACUNA_CHECK_THAT(outcome.Warning.find("left out") != std::string::npos, "a warning");
  const IGESParser file(outcome.Text);
  const auto points = OfType(file, 116);
  const auto axes = OfType(file, 110);
  LACUNA_CHECK_THAT(points.size() == 2 && axes.size() == 2, "two screws");
  LACUNA_CHECK_THAT(Coordinates(*points[1]) == (lacuna::Vec3{ 4, 5, 6.5 }), "centre");
  LACUNA_CHECK_THAT(NameOf(file, *points[1]) == "Screw hole 2", "name");
  LACUNA_CHECK_THAT(Coordinates(*axes[1], 3) == (lacuna::Vec3{ 4, -5, 6.5 }), "axis");
  LACUNA_CHECK_THAT(axes[1]->Level == 3 && NameOf(file, *axes[1]) == "Screw axis 2", "its name");
  vtkLacunaFieldData::Set(plate, "HoleAxes", { 0, 0, 1, 0, -2, 0 }, 3);
  Refuses(plate, "screw hole 2", skip);
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkMultiBlockDataSet> Group(
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

void TestGroups()
{
  std::vector<lacuna::Vec3> points;
  auto grid = TestSurfaces::Grid(1, points);
  auto map = DefectMap();
  vtkNew<vtkLacunaIGESWriter> maker; // any algorithm's name will do for the provenance
  vtkLacunaProvenance::Record(map, maker, {}, "Of=map");
  vtkLacunaProvenance::Record(grid, maker, {}, "Of=grid");
  vtkNew<vtkPolyData> nothing;
  auto inner = Group({ { "Bar", grid }, { "", nothing }, { "", Lines(Corners, { { 0, 1, 2 } }) } });
  const Outcome outcome =
    Write(Group({ { "Implant", map }, { "Rest", inner }, { "Empty", nullptr } }));
  LACUNA_CHECK_THAT(
    outcome.Surfaces == 2 && outcome.Curves == 3 && outcome.Points == 0, "all blocks");
  const IGESParser file(outcome.Text);
  std::vector<std::string> names;
  for (const Entity* entity : OfType(file, 128))
  {
    names.push_back(NameOf(file, IGESSurface(*entity).Properties));
  }
  LACUNA_CHECK_THAT((names == std::vector<std::string>{ "Implant", "Bar" }), "names of blocks");
  LACUNA_CHECK_THAT(NameOf(file, *OfType(file, 102).back()) == "Rest/Block 2", "without name");
  for (const char* words : { "Of=map", "Of=grid", "DefectOutline=1", "Levels: 1 surfaces" })
  {
    LACUNA_CHECK_THAT(outcome.Text.find(words) != std::string::npos, words);
  }

  vtkNew<vtkPartitionedDataSetCollection> sets;
  sets->SetPartition(0, 0, grid);
  sets->SetPartition(1, 0, Lines(Corners, { { 0, 1 } }));
  sets->GetMetaData(0u)->Set(vtkCompositeDataSet::NAME(), "Mould");
  const Outcome collection = Write(sets);
  LACUNA_CHECK_THAT(collection.Surfaces == 1 && collection.Curves == 1, "a collection");
  const IGESParser read(collection.Text);
  LACUNA_CHECK_THAT(NameOf(read, IGESSurface(*OfType(read, 128).at(0)).Properties) == "Mould",
    "name of a partitioned data set");

  vtkNew<vtkUnstructuredGrid> mesh;
  mesh->SetPoints(grid->GetPoints());
  auto group = Group({ { "Implant", map }, { "Mesh", mesh } });
  Refuses(group, "'Mesh' is a vtkUnstructuredGrid");
  const Outcome skipped = Write(group, [](vtkLacunaIGESWriter* w) { w->SkipUnsupportedOn(); });
  LACUNA_CHECK_THAT(skipped.Surfaces == 1 &&
      skipped.Warning.find("'Mesh' is a vtkUnstructuredGrid") != std::string::npos,
    "left out");
  Refuses(Group({ { "Mesh", mesh } }), "nothing to write",
    [](vtkLacunaIGESWriter* w) { w->SkipUnsupportedOn(); });
  Refuses(Group({}), "nothing to write");
  map->GetPointData()->GetArray("Fitted")->SetComponent(3000, 0, TestSurfaces::NaN);
  Refuses(group, "block 'Implant': the surface has holes");
}

//------------------------------------------------------------------------------
void SetPress(vtkDataObject* data, const lacuna::Matrix4& matrix)
{
  vtkLacunaFieldData::SetMatrices(data, "PressToPatient", { matrix });
}

void TestFrames()
{
  const lacuna::Matrix4 matrix =
    lacuna::Matrix4::Translation({ 10, -20, 30 }) * lacuna::Matrix4::Rotation({ 1, 2, 3 }, 0.7);
  std::vector<lacuna::Vec3> points;
  auto mould = TestSurfaces::Grid(2, points);
  SetPress(mould, matrix);
  auto outline = Lines(Corners, { { 0, 1, 2, 3 } });
  auto group = Group({ { "Mould", mould }, { "Outline", outline } });
  Refuses(group, "block 'Mould' is in the coordinates of the press");
  const auto frame = [](int which)
  { return [which](vtkLacunaIGESWriter* w) { w->SetCoordinates(which); }; };
  for (const int which : { 1, 2 })
  {
    const Outcome outcome = Write(group, frame(which));
    const IGESParser file(outcome.Text);
    const IGESSurface surface(*OfType(file, 128).at(0));
    const lacuna::Vec3 first{ surface.Points[0], surface.Points[1], surface.Points[2] };
    const IGESPolygon curve(file, *OfType(file, 102).at(0));
    const bool press = which == 2;
    const lacuna::Vec3 corner = press ? points[0] : matrix.Point(points[0]);
    LACUNA_CHECK_THAT(lacuna::Norm(first - corner) < 0.001, "the mould's corner");
    const lacuna::Vec3 end = press ? matrix.Inverse().Point(Corners[3]) : Corners[3];
    LACUNA_CHECK_THAT(lacuna::Norm(Vec(curve.Corners.at(3)) - end) < 0.0002, "the curve's end");
    LACUNA_CHECK_THAT(
      (outcome.Text.find("Coordinates of the press") != std::string::npos) == press, "says so");
  }
  const Outcome alone = Write(mould);
  LACUNA_CHECK_THAT(
    alone.Text.find("Coordinates of the press") != std::string::npos, "the mould alone");
  Refuses(outline, "no input says where the press is", frame(2));

  auto other = TestSurfaces::Grid(2, points);
  SetPress(other, lacuna::Matrix4());
  auto two = Group({ { "Mould", mould }, { "Other", other } });
  Refuses(two, "different presses");
  LACUNA_CHECK_THAT(Write(two, frame(1)).Surfaces == 2, "both to the patient");
  SetPress(other, lacuna::Matrix4::Scaling({ 1, 1, -1 }));
  Refuses(other, "mirrors");
  SetPress(other, lacuna::Matrix4::Scaling({ 1, TestSurfaces::NaN, 1 }));
  Refuses(other, "PressToPatient");
}

void TestMirrored()
{
  auto map = DefectMap();
  vtkLacunaFieldData::Set(map, "Mirrored", { 1 }, 1);
  auto group = Group({ { "Other side", map } });
  Refuses(map, "mirror image");
  Refuses(group, "block 'Other side' is a mirror image");
  LACUNA_CHECK_THAT(
    Write(group, [](vtkLacunaIGESWriter* w) { w->AllowMirroredOn(); }).Surfaces == 1, "allowed");
  vtkLacunaFieldData::Set(map, "Mirrored", { 0 }, 1);
  LACUNA_CHECK_THAT(Write(map).Surfaces == 1, "not mirrored");
}

// Nothing about a patient, nothing but ASCII.
void TestPrivacy()
{
  auto map = DefectMap();
  for (const char* name : { "PatientName", "PatientID" })
  {
    vtkNew<vtkStringArray> array;
    array->SetName(name);
    array->InsertNextValue("M\xc3\xbcller^Eva");
    map->GetFieldData()->AddArray(array);
  }
  const std::string text = Write(
    Group({ { "Sch\xc3\xa4"
              "del",
      map } })).Text;
  LACUNA_CHECK_THAT(text.find("ller") == std::string::npos, "no patient");
  LACUNA_CHECK_THAT(text.find("Sch__del") != std::string::npos, "ASCII names");
  const IGESParser file(text); // sees that all is ASCII
}

// A disk that fills up in the middle and a read-only folder leave what was there, and no rest of the
// new file.
void TestBadPlaces(const std::string& folder)
{
  const std::string place = folder + "/TestIGESWriterContent";
  vtksys::SystemTools::RemoveADirectory(place);
  vtksys::SystemTools::MakeDirectory(place);
  const std::string path = place + "/a.igs";
  std::ofstream(path) << "old";
  struct rlimit before;
  getrlimit(RLIMIT_FSIZE, &before);
  struct rlimit small = before;
  small.rlim_cur = 5000;
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  vtkNew<vtkLacunaIGESWriter> writer;
  vtkNew<vtkTest::ErrorObserver> observer;
  writer->AddObserver(vtkCommand::ErrorEvent, observer);
  writer->SetInputData(DefectMap());
  writer->SetFileName(path.c_str());
  setrlimit(RLIMIT_FSIZE, &small);
  const int written = writer->Write();
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  LACUNA_CHECK_THAT(written == 0 && observer->GetError(), "an error");
  observer->Clear();
  vtksys::SystemTools::SetPermissions(place, 0555);
  const bool changed = geteuid() == 0 && seteuid(65534) == 0; // root may write everywhere
  LACUNA_CHECK_THAT(writer->Write() == 0 && observer->GetError(), "a read-only folder");
  LACUNA_CHECK_THAT(writer->GetErrorCode() == vtkErrorCode::CannotOpenFileError, "error code");
  LACUNA_CHECK_THAT(!changed || seteuid(0) == 0, "root again");
  vtksys::SystemTools::SetPermissions(place, 0755);
  LACUNA_CHECK_THAT(vtksys::SystemTools::FileLength(path) == 3, "the old file stays");
  LACUNA_CHECK_THAT(
    vtksys::Directory::GetNumberOfFilesInDirectory(place) == 3, "nothing else (., .., a.igs)");
}
}

int TestIGESWriterContent(int argc, char* argv[])
{
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  std::string folder = ".";
  for (int i = 1; i + 1 < argc; ++i)
  {
    folder = std::string(argv[i]) == "-T" ? argv[i + 1] : folder;
  }
  folder = vtksys::SystemTools::CollapseFullPath(folder);
  FilePath = folder + "/TestIGESWriterContent.igs";
  try
  {
    TestOutlines();
    TestPieces();
    TestPolyData();
    TestScrews();
    TestGroups();
    TestFrames();
    TestMirrored();
    TestPrivacy();
    TestBadPlaces(folder);
  }
  catch (const std::exception& e)
  {
    LACUNA_CHECK_THAT(false, e.what());
  }
  return lacunaCheck::Result();
}
