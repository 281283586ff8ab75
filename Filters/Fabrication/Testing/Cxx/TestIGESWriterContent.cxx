// SPDX-License-Identifier: BSD-3-Clause
// What the IGES Writer makes of outlines, curves, points and screw holes, and what it refuses.
#include "TestIGESContent.h"

#include <algorithm>
#include <cmath>

using namespace TestIGESContent;

namespace
{
// The outline is where the mask says: within half a pixel's diagonal of the ellipse or the island.
void CheckOutline(const IGESCurve& curve, vtkImageData* map, double tolerance)
{
  const lacuna::DepthMap contract(map);
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

// What Transform makes of a depth map is a grid of its pixels, without the depths.
void TestTransformedMap()
{
  for (const bool perspective : { false, true })
  {
    const auto map = DefectMap(perspective);
    const auto refuse = [](vtkDataObject* grid) { Refuses(grid, "plane of a depth map's pixels"); };
    const auto make = [&](const lacuna::Matrix4& move, bool depths, double height)
    { return TestSurfaces::PixelGrid(map, move, depths, height); };
    const lacuna::Matrix4 move = lacuna::Matrix4::Translation({ 3, -2000, 9 }) *
      lacuna::Matrix4::Rotation({ 1, 2, 3 }, 0.4) * lacuna::Matrix4::Scaling({ -0.5, 1, 1 });
    refuse(make({}, false, 0));
    refuse(make(move, false, 0));
    // with the depths it is a surface (Warp By Scalar)
    LACUNA_CHECK(Write(make({}, true, 0)).Surfaces == 1);
    LACUNA_CHECK(Write(make(move, true, 0)).Surfaces == 1);
    // depths all the same: a plane at that depth is their surface, and that of the pixels is not
    for (const char* name : { "Fitted", "Depth" })
    {
      map->GetPointData()->GetArray(name)->FillComponent(0, 60);
    }
    refuse(make({}, false, 0));
    LACUNA_CHECK(Write(make({}, false, 60)).Surfaces == 1);
    map->GetPointData()->RemoveArray("Fitted");
    refuse(make({}, false, 0));
    // a plane that is no map's
    const auto plane = make({}, false, 0);
    plane->GetPointData()->RemoveArray("Depth");
    LACUNA_CHECK(Write(plane).Surfaces == 1);
  }
}

// The screw holes of a plate, whose triangles have no place here.
void TestScrews()
{
  std::vector<lacuna::Vec3> rims; // of 8 points, 1 mm about the axes
  const lacuna::Vec3 centers[2] = { { 1, 2, 3 }, { 4, 5, 6.5 } };
  for (int k = 0; k < 16; ++k)
  {
    const double a = std::cos(k * std::acos(-1.0) / 4);
    const double b = std::sin(k * std::acos(-1.0) / 4);
    rims.push_back(
      centers[k / 8] + (k < 8 ? lacuna::Vec3{ a, b, 0.1 * k } : lacuna::Vec3{ a, -0.3, b }));
  }
  auto plate = Lines(rims, {});
  vtkNew<vtkCellArray> triangles;
  triangles->InsertNextCell({ 0, 1, 2 });
  plate->SetPolys(triangles);
  Refuses(plate, "has 1 polygons");
  lacuna::FieldData::Set(plate, "HoleCenters", { 1, 2, 3, 4, 5, 6.5 }, 3);
  lacuna::FieldData::Set(plate, "HoleAxes", { 0, 0, 1, 0, -1, 0 }, 3);
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
  lacuna::FieldData::Set(plate, "HoleAxes", { 0, 0, 1, 0, -2, 0 }, 3);
  Refuses(plate, "screw hole 2 has no finite centre (HoleCenters) or no unit axis", skip);
  lacuna::FieldData::Set(plate, "HoleAxes", { 0, 0, 1, 0.6, -0.8, 0 }, 3);
  Refuses(plate, "screw hole 2 is not where HoleCenters and HoleAxes say", skip);
  lacuna::FieldData::Set(plate, "HoleAxes", { 0, 0, 1, 0, -1, 0 }, 3);

  // field data stay where they were when Transform moves the plate
  using lacuna::Matrix4;
  const auto move = [&](const Matrix4& matrix)
  {
    vtkNew<vtkPoints> points; // single precision
    for (const lacuna::Vec3& p : rims)
    {
      points->InsertNextPoint(matrix.Point(p).data());
    }
    plate->SetPoints(points);
  };
  move({});
  LACUNA_CHECK(Write(plate, skip).Points == 2);
  for (const Matrix4& matrix : { Matrix4::Translation({ 0.05, 0, 0 }),
         Matrix4::Translation({ 0, 300, 0 }), Matrix4::Scaling({ -1, 1, 1 }),
         Matrix4::Scaling({ 1 / 25.4, 1 / 25.4, 1 / 25.4 }), Matrix4::Rotation({ 0, 0, 1 }, 0.1) })
  {
    move(matrix);
    Refuses(plate, "is not where HoleCenters and HoleAxes say", skip);
  }
  vtkNew<vtkCellArray> none; // without a plate there is nothing to compare with
  plate->SetPolys(none);
  LACUNA_CHECK(Write(plate, skip).Points == 2);
}
}

int TestIGESWriterContent(int argc, char* argv[])
{
  return Run(argc, argv, "TestIGESWriterContent.igs",
    [](const std::string&)
    {
      TestOutlines();
      TestPieces();
      TestPolyData();
      TestTransformedMap();
      TestScrews();
    });
}
