// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaImplantPlate.h"

#include "lacunaPlateMeasures.h"
#include "lacunaPlateScene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>

using namespace lacuna;

namespace
{
constexpr double Pi = 3.14159265358979323846;

ImplantPlateOptions Plain()
{
  ImplantPlateOptions options;
  options.EdgeClearance = 0;
  options.Edge = PlateEdge::Square;
  return options;
}

// Closed, every edge used once each way, no point unused. Returns the Euler characteristic.
long CheckManifold(const ImplantPlate& plate)
{
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  std::vector<std::vector<std::pair<std::int32_t, std::int32_t>>> fans(plate.Points.size());
  for (const Triangle& t : plate.Triangles)
  {
    for (int k = 0; k < 3; ++k)
    {
      EXPECT_EQ(++edges[std::make_pair(t[k], t[(k + 1) % 3])], 1);
      fans[t[k]].emplace_back(t[(k + 1) % 3], t[(k + 2) % 3]);
    }
  }
  for (const auto& edge : edges)
  {
    EXPECT_TRUE(edges.count({ edge.first.second, edge.first.first }));
  }
  for (const auto& fan : fans)
  {
    // one ring of triangles about each point
    std::map<std::int32_t, std::int32_t> next(fan.begin(), fan.end());
    EXPECT_FALSE(fan.empty());
    std::size_t steps = 0;
    const std::int32_t start = fan.empty() ? 0 : fan[0].first;
    std::int32_t at = start;
    do
    {
      at = next[at];
      ++steps;
    } while (at != start && steps <= fan.size());
    EXPECT_EQ(steps, fan.size());
  }
  return static_cast<long>(plate.Points.size()) - static_cast<long>(edges.size() / 2) +
    static_cast<long>(plate.Triangles.size());
}

// The points of a face.
std::vector<std::int32_t> GetFace(const ImplantPlate& plate, PlateFace face)
{
  std::vector<std::int32_t> points;
  for (std::size_t k = 0; k < plate.Triangles.size(); ++k)
  {
    if (plate.Faces[k] == face)
    {
      points.insert(points.end(), plate.Triangles[k].begin(), plate.Triangles[k].end());
    }
  }
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

// What MakeImplantPlate says is wrong.
std::string GetError(PlateScene& scene, const ImplantPlateOptions& options)
{
  try
  {
    scene.Make(options);
  }
  catch (const std::exception& error)
  {
    return error.what();
  }
  return "";
}
}

// Both faces of a cap of a ball lie on balls, to rounding and the spline.
TEST(ImplantPlate, CapOfABall)
{
  PlateScene scene(PlateScene::Ball, PlateScene::Disc);
  const Vec3 centre{ 40, 40, 60 };
  for (const PlateSide side : { PlateSide::Inward, PlateSide::Outward })
  {
    ImplantPlateOptions options = Plain();
    options.Side = side;
    const ImplantPlate plate = scene.Make(options);
    EXPECT_EQ(CheckManifold(plate), 2);
    const double high = side == PlateSide::Outward ? 63 : 60;
    for (const auto& [face, radius] :
      { std::make_pair(PlateFace::Outer, high), std::make_pair(PlateFace::Inner, high - 3) })
    {
      for (const std::int32_t p : GetFace(plate, face))
      {
        EXPECT_NEAR(Norm(plate.Points[p] - centre), radius, 2e-5);
      }
    }
    // the solid angle of the disc as it is in pixels, within half of one at its edge
    const double cap = 2 * Pi * (1 - std::sqrt(1 - 0.25));
    const double low = high - 3;
    EXPECT_NEAR(plate.Volume / (cap * (high * high * high - low * low * low) / 3), 1, 0.004);
    EXPECT_NEAR(plate.OuterArea / (cap * high * high), 1, 0.004);
    EXPECT_NEAR(plate.Volume / (plate.OuterArea * 3) /
        ((high * high + high * low + low * low) / (3 * high * high)),
      1, 1e-3); // exact for any outline
    EXPECT_NEAR(plate.MinimumThickness, 3, 0.003);
    EXPECT_LE(plate.MinimumThickness, 3.00001);
    EXPECT_NEAR(plate.MinimumRadius, 60, 0.01);
    EXPECT_NEAR(plate.Outline.Length, 60 * Pi, 0.3);
  }
}

// Clearance is measured in space, on the surface.
TEST(ImplantPlate, ClearanceOnASlope)
{
  // a plane at 60 degrees: 1 mm along x is 2 mm on it
  PlateScene scene([](double x, double) { return std::sqrt(3) * x; },
    [](double x, double y) { return std::abs(x) < 20.25 && std::abs(y) < 20.25; });
  for (const double clearance : { 2.0, -3.0 })
  {
    ImplantPlateOptions options = Plain();
    options.EdgeClearance = clearance;
    const ImplantPlate plate = scene.Make(options);
    double most[2] = { 0, 0 };
    for (const Vec2& p : plate.Outline.Points)
    {
      const double off[2] = { p[0] - 40, p[1] - 40 };
      const double edge[2] = { 20.25 - clearance / 2, 20.25 - clearance };
      for (int i = 0; i < 2; ++i)
      {
        if (std::abs(off[1 - i]) < 10)
        {
          EXPECT_NEAR(std::abs(off[i]), edge[i], 0.01);
        }
        most[i] = std::max(most[i], std::abs(off[i]) - edge[i]);
      }
    }
    EXPECT_LT(std::max(most[0], most[1]), 0.06); // near the corners
    EXPECT_NEAR(plate.MinimumThickness, 3, 1e-9);
    EXPECT_GT(plate.MinimumRadius, 1e6);
  }
}

// An outline of no symmetry stays where the mask is; the plate is a solid of the thickness asked for.
TEST(ImplantPlate, AsymmetricOutline)
{
  PlateScene scene(PlateScene::Skull, PlateScene::Kidney);
  ImplantPlateOptions options = Plain();
  options.Thickness = 2;
  const ImplantPlate plate = scene.Make(options);
  EXPECT_EQ(CheckManifold(plate), 2);
  int wrong = 0;
  for (int j = 0; j < PlateScene::Count; ++j)
  {
    const auto crossings = FindCrossings({ plate.Outline.Points }, j * 0.5 + 1e-7);
    for (int i = 0; i < PlateScene::Count; ++i)
    {
      const auto passed = std::upper_bound(crossings.begin(), crossings.end(), i * 0.5);
      wrong += ((passed - crossings.begin()) % 2 != 0) != (scene.Mask[i + 161 * j] != 0);
    }
  }
  // pixels at the border, about 280 of them, and at the five corners
  EXPECT_LT(wrong, 70);
  EXPECT_NEAR(plate.MinimumThickness, 2, 0.02);
  EXPECT_GT(plate.Volume, 0);

  // against all triangles of the other face
  std::vector<Triangle> inner;
  for (std::size_t k = 0; k < plate.Triangles.size(); ++k)
  {
    if (plate.Faces[k] == PlateFace::Inner)
    {
      inner.push_back(plate.Triangles[k]);
    }
  }
  const auto outer = GetFace(plate, PlateFace::Outer);
  double least = 1e9;
  double most = 0;
  for (std::size_t k = 0; k < outer.size(); k += 37)
  {
    const Vec3& p = plate.Points[outer[k]];
    double best = 1e9;
    for (const Triangle& t : inner)
    {
      best = std::min(best,
        SquaredDistanceToTriangle(p, plate.Points[t[0]], plate.Points[t[1]], plate.Points[t[2]]));
    }
    least = std::min(least, std::sqrt(best));
    most = std::max(most, std::sqrt(best));
  }
  EXPECT_NEAR(least, 2, 0.02);
  EXPECT_NEAR(most, 2, 0.02);
}

// The removed ring of a bevel and of a rounding on a flat round plate, by Pappus.
TEST(ImplantPlate, EdgesOnAFlatDisc)
{
  PlateScene scene([](double, double) { return 0.0; }, PlateScene::Disc);
  ImplantPlateOptions options = Plain();
  const double square = scene.Make(options).Volume;
  const double radius = std::sqrt(square / 3 / Pi);
  EXPECT_NEAR(radius, 30, 0.06);
  options.EdgeSize = 1;
  const double expected[2] = { 0.5 * 2 * Pi * (radius - 1.0 / 3),
    (1 - Pi / 4) * 2 * Pi * (radius - 0.2234) };
  for (const bool both : { false, true })
  {
    options.BothFaces = both;
    int i = 0;
    for (const PlateEdge edge : { PlateEdge::Bevel, PlateEdge::Round })
    {
      options.Edge = edge;
      const ImplantPlate plate = scene.Make(options);
      EXPECT_EQ(CheckManifold(plate), 2);
      // the rim of the outer face lies inwards, straight across the edge
      for (std::size_t k = 0; k < plate.Outline.Points.size(); ++k)
      {
        const Vec2& p = plate.Outline.Points[k];
        const Vec2 q = plate.Outline.GetInset(k, 1);
        EXPECT_NEAR(std::hypot(q[0] - p[0], q[1] - p[1]), 1, 1e-6);
        EXPECT_NEAR(std::hypot(p[0] - 40, p[1] - 40) - std::hypot(q[0] - 40, q[1] - 40), 1, 0.01);
      }
      // the polygon of the rounding leaves 1.3 % more
      EXPECT_NEAR((square - plate.Volume) / (both ? 2 : 1) / expected[i], 1, 0.03);
      ++i;
    }
  }
  // as much as there is: a knife's edge, and a full half circle
  options.EdgeSize = 1.5;
  EXPECT_EQ(CheckManifold(scene.Make(options)), 2);
  options.BothFaces = false;
  options.EdgeSize = 3;
  options.Edge = PlateEdge::Bevel;
  EXPECT_EQ(CheckManifold(scene.Make(options)), 2);
}

TEST(ImplantPlate, ScrewHoles)
{
  PlateScene scene(PlateScene::Ball, PlateScene::Disc);
  ImplantPlateOptions options = Plain();
  const double solid = scene.Make(options).Volume;
  // two picked points, one above the surface
  options.HolePoints = { { 52, 40, PlateScene::Ball(12, 0) }, { 30, 55, 0 } };
  options.Hole.Diameter = 2;
  ImplantPlate plate = scene.Make(options);
  EXPECT_EQ(CheckManifold(plate), 2 - 2 * 2);
  ASSERT_EQ(plate.Holes.size(), 2u);
  EXPECT_NEAR(solid - plate.Volume, 2 * Pi * 3, 0.1);
  options.Hole.CountersinkDiameter = 4;
  options.Hole.CountersinkAngle = 90;
  plate = scene.Make(options);
  EXPECT_EQ(CheckManifold(plate), 2 - 2 * 2);
  // a cone's frustum 1 mm deep instead of a cylinder
  // less what the domes of the faces lack, pi rho^4 / (4 R)
  const double frustum = 3 + (1 + 2 + 4) / 3.0 - 1 - (16 - 1) / 240.0;
  EXPECT_NEAR(solid - plate.Volume, 2 * Pi * frustum, 0.1);

  const Vec3 centre{ 40, 40, 60 };
  for (const PlateHole& hole : plate.Holes)
  {
    EXPECT_NEAR(Norm(hole.Centre - centre), 60, 1e-5);
    EXPECT_NEAR(Dot(hole.Axis, Normalized(hole.Centre - centre)), 1, 1e-9);
    EXPECT_NEAR(hole.Land, 2, 0.02);
    ASSERT_EQ(hole.Rings.size(), 3u);
    for (std::size_t ring = 0; ring < 3; ++ring)
    {
      for (const Vec3& p : hole.Rings[ring])
      {
        const Vec3 w = p - hole.Centre;
        const double along = Dot(w, hole.Axis);
        const double rho = Norm(w - along * hole.Axis);
        EXPECT_NEAR(rho, ring == 0 ? 2 + along : 1, 1e-9); // exactly round
        EXPECT_NEAR(Norm(p - centre), ring == 0 ? 60 : ring == 2 ? 57 : Norm(p - centre), 1e-5);
      }
    }
  }
  EXPECT_NEAR(plate.Holes[0].Centre[0], 52, 1e-5); // it was picked on the surface
  const Vec3 picked{ 30, 55, 0 };
  EXPECT_NEAR(Norm(Cross(picked - centre, plate.Holes[1].Axis)), 0, 1e-5);
}

TEST(ImplantPlate, DrainageKeepsClear)
{
  PlateScene scene(PlateScene::Skull, PlateScene::Kidney);
  ImplantPlateOptions options = Plain();
  options.Edge = PlateEdge::Round;
  options.EdgeSize = 0.5;
  options.HolePoints = { { 42, 40, 0 } };
  options.DrainageSpacing = 6;
  const ImplantPlate plate = scene.Make(options);
  EXPECT_GT(plate.DrainageHoles, 15);
  EXPECT_EQ(CheckManifold(plate), 2 - 2 * (plate.DrainageHoles + 1));
  EXPECT_NEAR(plate.MinimumThickness, 3, 0.03);
}

TEST(ImplantPlate, SameForAnyNumberOfThreads)
{
  ImplantPlateOptions options;
  options.HolePoints = { { 42, 40, 0 } };
  options.DrainageSpacing = 8;
  PlateScene one(PlateScene::Skull, PlateScene::Kidney, 1);
  const ImplantPlate first = one.Make(options);
  for (const int threads : { 2, 5 })
  {
    PlateScene scene(PlateScene::Skull, PlateScene::Kidney, threads);
    const ImplantPlate plate = scene.Make(options);
    ASSERT_EQ(plate.Points.size(), first.Points.size());
    EXPECT_EQ(
      std::memcmp(plate.Points.data(), first.Points.data(), first.Points.size() * sizeof(Vec3)), 0);
    EXPECT_EQ(plate.Triangles, first.Triangles);
    EXPECT_EQ(plate.MinimumThickness, first.MinimumThickness);
  }
}

TEST(ImplantPlate, SeveralDefectsAndIslands)
{
  PlateScene scene(PlateScene::Ball,
    [](double x, double y) {
      return (std::hypot(x, y) < 20 && std::hypot(x - 5, y) > 3) || std::hypot(x - 28, y - 20) < 5;
    });
  const ImplantPlate plate = scene.Make(Plain());
  ASSERT_EQ(plate.Outline.Warnings.size(), 2u);
  EXPECT_NE(plate.Outline.Warnings[0].find("2 separate defects"), std::string::npos);
  EXPECT_NE(plate.Outline.Warnings[1].find("island"), std::string::npos);
  EXPECT_EQ(CheckManifold(plate), 2);
  EXPECT_NEAR(plate.Outline.Length, 40 * Pi, 1);
}

TEST(ImplantPlate, NamesWhatCannotBeMade)
{
  PlateScene ball(PlateScene::Ball, PlateScene::Disc);
  const auto says = [&](const char* words, const std::function<void(ImplantPlateOptions&)>& change)
  {
    ImplantPlateOptions options = Plain();
    change(options);
    const std::string error = GetError(ball, options);
    EXPECT_NE(error.find(words), std::string::npos) << "'" << error << "' lacks: " << words;
  };
  using O = ImplantPlateOptions;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  says("Thickness is 0", [](O& o) { o.Thickness = 0; });
  says("Thickness is", [&](O& o) { o.Thickness = nan; });
  says("EdgeClearance is", [&](O& o) { o.EdgeClearance = nan; });
  says("TriangleSize is", [](O& o) { o.TriangleSize = -1; });
  says("no plate is left", [](O& o) { o.EdgeClearance = 31; });
  says("beyond the fitted surface", [](O& o) { o.EdgeClearance = -13; });
  says("TriangleSize", [](O& o) { o.TriangleSize = 1e-4; });
  says("plus TriangleSize", [](O& o) { o.TriangleSize = 50; });
  says("radius of 60", [](O& o) { o.Thickness = 61; });
  says("Bevel is 4",
    [](O& o)
    {
      o.Edge = PlateEdge::Round;
      o.EdgeSize = 4;
    });
  says("half of Thickness",
    [](O& o)
    {
      o.Edge = PlateEdge::Round;
      o.EdgeSize = 2;
      o.BothFaces = true;
    });
  says("screw hole 1", [](O& o) { o.HolePoints = { { 40, 40, 90 } }; });
  says("outside of the plate", [](O& o) { o.HolePoints = { { 40, 72, 10 } }; });
  says("from the plate's edge", [](O& o) { o.HolePoints = { { 40, 69.5, 8 } }; });
  says("screw hole 2", [](O& o) { o.HolePoints = { { 40, 40, 0 }, { 41, 40, 0 } }; });
  says("screw hole 1", [&](O& o) { o.HolePoints = { { 40, nan, 0 } }; });
  says("CountersinkDiameter is 1",
    [](O& o)
    {
      o.HolePoints = { { 40, 40, 0 } };
      o.Hole.CountersinkDiameter = 1;
    });
  says("countersink that leaves",
    [](O& o)
    {
      o.HolePoints = { { 40, 40, 0 } };
      o.Hole.CountersinkDiameter = 7.9;
    });
  says("DrainageSpacing is 2", [](O& o) { o.DrainageSpacing = 2; });
  says("HoleDiameter is 0 mm; it must be above 0 mm", [](O& o) { o.Hole.Diameter = 0; });
  says("TriangleSize is 0 mm; it must be above 0 mm", [](O& o) { o.TriangleSize = 0; });

  // bends away from the viewer with a radius of 5 mm at (0, 0): no way outwards
  PlateScene pit([](double x, double y)
    { return -0.1 * (x * x + y * y) / (1 + 0.05 * (x * x + y * y)); },
    PlateScene::Disc);
  ImplantPlateOptions options = Plain();
  options.Thickness = 6;
  options.Side = PlateSide::Outward;
  const std::string error = GetError(pit, options);
  EXPECT_NE(error.find("bends with a radius of"), std::string::npos) << error;
  options.Thickness = 0.7;
  EXPECT_EQ(GetError(pit, options), "");

  PlateScene edge(PlateScene::Ball, [](double x, double) { return x < 0; });
  EXPECT_NE(GetError(edge, Plain()).find("reaches the border"), std::string::npos);
  PlateScene speck(PlateScene::Ball, [](double x, double y) { return std::hypot(x, y) < 0.3; });
  EXPECT_NE(GetError(speck, Plain()).find("too small"), std::string::npos);
}

TEST(ImplantPlate, CanBeStopped)
{
  PlateScene scene(PlateScene::Ball, PlateScene::Disc);
  ThreadExecution stopped(2, [](double fraction) { return fraction < 0.3; });
  const ReliefSurface surface(scene.Execution, scene.Size, scene.Depths, scene.Spacing);
  EXPECT_THROW(
    MakeImplantPlate(stopped, surface, scene.Size, scene.Spacing, scene.Mask, Plain()), Aborted);
}
