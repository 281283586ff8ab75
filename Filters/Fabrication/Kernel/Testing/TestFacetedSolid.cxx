// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFacetedSolid.h"
#include "lacunaMeshShapes.h"
#include "lacunaMeshSimplifier.h"
#include "lacunaStepProgram.h"
#include "lacunaTriangleTree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

using namespace lacuna;

namespace
{
FacetedSolid Make(const ClosedMesh& mesh, double tolerance)
{
  ThreadExecution execution(2);
  return MakeFacetedSolid(mesh, tolerance, execution);
}

std::string GetError(const ClosedMesh& mesh, double tolerance = 0)
{
  try
  {
    Make(mesh, tolerance);
  }
  catch (const std::exception& error)
  {
    return error.what();
  }
  return "no error";
}

// Of the whole solid, by the divergence theorem over its faces: an oracle that knows no triangles.
double IntegrateVolume(const FacetedSolid& solid)
{
  double volume = 0;
  for (const FacetedSolid::Body& body : solid.Bodies)
  {
    for (const std::vector<FacetedSolid::Face>& shell : body.Shells)
    {
      for (const FacetedSolid::Face& face : shell)
      {
        for (const std::vector<std::int32_t>& loop : face.Loops)
        {
          Vec3 area{ 0, 0, 0 };
          for (std::size_t k = 0; k < loop.size(); ++k)
          {
            area =
              area + 0.5 * Cross(solid.Points[loop[k]], solid.Points[loop[(k + 1) % loop.size()]]);
          }
          volume += Dot(face.Normal, area) * Dot(face.Normal, face.Origin) / 3;
        }
      }
    }
  }
  return volume;
}
}

TEST(FacetedSolid, BoxWithAHoleThroughIsTenFacesWhateverItsTriangles)
{
  for (const double tolerance : { 0.0, 0.02 })
  {
    const FacetedSolid solid = Make(lacunaMeshShapes::BoxWithHole(3), tolerance);
    EXPECT_EQ(solid.GetNumberOfFaces(), 10u) << tolerance;
    ASSERT_EQ(solid.Bodies.size(), 1u);
    EXPECT_NEAR(solid.Volume, lacunaMeshShapes::BoxWithHoleVolume, 1e-9);
    EXPECT_NEAR(IntegrateVolume(solid), lacunaMeshShapes::BoxWithHoleVolume, 1e-9);
    EXPECT_LT(solid.Deviation, 1e-9);
    const std::vector<FacetedSolid::Face>& faces = solid.Bodies[0].Shells[0];
    EXPECT_EQ(std::count_if(faces.begin(), faces.end(),
                [](const FacetedSolid::Face& face) { return face.Loops.size() == 2; }),
      2);
  }
  // points on its edges go, its corners stay exactly
  const FacetedSolid solid = Make(lacunaMeshShapes::BoxWithHole(3), 0.02);
  std::size_t corners = 0;
  for (const FacetedSolid::Face& face : solid.Bodies[0].Shells[0])
  {
    for (const std::vector<std::int32_t>& loop : face.Loops)
    {
      corners += loop.size();
    }
  }
  EXPECT_EQ(corners, 48u);
}

TEST(FacetedSolid, SphereHasFewerFacesThatAreWithinTheTolerance)
{
  const ClosedMesh sphere = lacunaMeshShapes::Sphere({ 1, 2, 3 }, 10, 40);
  const FacetedSolid solid = Make(sphere, 0.05);
  EXPECT_LT(solid.GetNumberOfFaces(), sphere.Triangles.size() / 3);
  EXPECT_LE(solid.Deviation, 0.05);
  EXPECT_NEAR(IntegrateVolume(solid), sphere.GetVolume(), 5e-4 * sphere.GetVolume());
  // all points of the mesh, beside a search of all faces
  ClosedMesh faces{ solid.Points, {} };
  for (const FacetedSolid::Face& face : solid.Bodies[0].Shells[0])
  {
    for (std::size_t k = 2; k < face.Loops[0].size(); ++k)
    {
      faces.Triangles.push_back({ face.Loops[0][0], face.Loops[0][k - 1], face.Loops[0][k] });
    }
  }
  double largest = 0;
  for (const Vec3& x : sphere.Points)
  {
    double least = 1e9;
    for (const ClosedMesh::Triangle& ids : faces.Triangles)
    {
      least = std::min(least,
        GetSquaredDistance(x, faces.Points[ids[0]], faces.Points[ids[1]], faces.Points[ids[2]]));
    }
    largest = std::max(largest, std::sqrt(least));
  }
  EXPECT_LE(largest, solid.Deviation + 1e-12);
  EXPECT_GT(largest, 0.01);
}

TEST(FacetedSolid, CavitiesBelongToTheBodyAroundThem)
{
  ClosedMesh mesh = lacunaMeshShapes::Sphere({ 30, 0, 0 }, 4, 12);
  lacunaMeshShapes::Append(mesh, lacunaMeshShapes::Sphere({ 0, 0, 0 }, 5, 12), true);
  lacunaMeshShapes::Append(mesh, lacunaMeshShapes::Sphere({ 0, 0, 0 }, 10, 12));
  lacunaMeshShapes::Append(mesh, lacunaMeshShapes::Sphere({ 0, 0, 0 }, 2, 12));
  const FacetedSolid solid = Make(mesh, 0);
  ASSERT_EQ(solid.Bodies.size(), 3u);
  std::vector<std::size_t> shells;
  for (const FacetedSolid::Body& body : solid.Bodies)
  {
    shells.push_back(body.Shells.size());
    EXPECT_GT(body.Volume, 0);
  }
  EXPECT_EQ(shells, (std::vector<std::size_t>{ 1, 2, 1 }));
  EXPECT_NEAR(IntegrateVolume(solid), mesh.GetVolume(), 1e-9 * mesh.GetVolume());
}

TEST(FacetedSolid, RefusesWhatIsNoSolid)
{
  const ClosedMesh box = lacunaMeshShapes::Box({ 0, 0, 0 }, { 1, 2, 3 });
  EXPECT_EQ(GetError(box), "no error");
  ClosedMesh open = box;
  open.Triangles.pop_back();
  EXPECT_NE(GetError(open).find("open: 3 edges"), std::string::npos) << GetError(open);
  ClosedMesh twice = box;
  twice.Triangles.insert(twice.Triangles.end(), box.Triangles.begin(), box.Triangles.end());
  EXPECT_NE(GetError(twice).find("branches"), std::string::npos);
  ClosedMesh turned = box;
  std::swap(turned.Triangles[0][0], turned.Triangles[0][1]);
  EXPECT_NE(GetError(turned).find("turned over"), std::string::npos);
  ClosedMesh inside;
  lacunaMeshShapes::Append(inside, box, true);
  EXPECT_NE(GetError(inside).find("inside out"), std::string::npos);
  lacunaMeshShapes::Append(inside, lacunaMeshShapes::Box({ 10, 0, 0 }, { 19, 9, 9 }));
  EXPECT_NE(GetError(inside).find("no other piece encloses it"), std::string::npos);
  ClosedMesh far = box;
  far.Points[2][1] = NAN;
  EXPECT_NE(GetError(far).find("point 2"), std::string::npos);
  EXPECT_NE(GetError(box, -1).find("Tolerance"), std::string::npos);
  EXPECT_NE(GetError(box, NAN).find("Tolerance"), std::string::npos);
  EXPECT_NE(GetError({}).find("no triangles"), std::string::npos);
}

TEST(FacetedSolid, TellsWhereTheSurfacePassesThroughItself)
{
  ClosedMesh mesh = lacunaMeshShapes::Box({ 0, 0, 0 }, { 10, 10, 10 });
  EXPECT_FALSE(Make(mesh, 0.02).Crossing);
  lacunaMeshShapes::Append(mesh, lacunaMeshShapes::Box({ 10, 0, 0 }, { 20, 10, 10 })); // touches
  EXPECT_FALSE(Make(mesh, 0.02).Crossing);
  lacunaMeshShapes::Append(mesh, lacunaMeshShapes::Box({ 4, 4, 9 }, { 6, 6, 12 }));
  EXPECT_TRUE(Make(mesh, 0.02).Crossing);
}

TEST(FacetedSolid, ThinSheetDoesNotPassThroughItself)
{
  // two spheres as far apart as the tolerance: each alone may move by as much
  ClosedMesh mesh = lacunaMeshShapes::Sphere({ 0, 0, 0 }, 20, 24);
  lacunaMeshShapes::Append(mesh, lacunaMeshShapes::Sphere({ 0, 0, 0 }, 19.95, 24), true);
  const FacetedSolid solid = Make(mesh, 0.05);
  EXPECT_FALSE(solid.Crossing);
  EXPECT_NEAR(solid.Volume, mesh.GetVolume(), 5e-4 * mesh.GetVolume());
}

TEST(FacetedSolid, WhereTheSheetIsThinItStaysAsItIsAndTheRestIsSimplified)
{
  // 0.01 mm thick on one side, 19.99 mm on the other
  ClosedMesh mesh = lacunaMeshShapes::Sphere({ 0, 0, 0 }, 20, 60);
  lacunaMeshShapes::Append(mesh, lacunaMeshShapes::Sphere({ 9.99, 0, 0 }, 10, 60), true);
  const FacetedSolid solid = Make(mesh, 0.05);
  EXPECT_FALSE(solid.Crossing);
  EXPECT_LE(solid.Deviation, 0.05);
  EXPECT_NEAR(solid.Volume, mesh.GetVolume(), 5e-4 * mesh.GetVolume());
  EXPECT_LT(solid.GetNumberOfFaces(), mesh.Triangles.size() / 6);
}

TEST(FacetedSolid, FixedPointsStayWithAllTheirTriangles)
{
  const ClosedMesh mesh = lacunaMeshShapes::Sphere({ 0, 0, 0 }, 20, 24);
  std::vector<char> fixed;
  std::transform(mesh.Points.begin(), mesh.Points.end(), std::back_inserter(fixed),
    [](const Vec3& p) { return p[0] > 5; });
  ThreadExecution execution(2);
  const ClosedMesh simple = SimplifyMesh(mesh, 0.2, execution, fixed);
  const auto countFixed = [](const ClosedMesh& each)
  {
    return std::count_if(each.Triangles.begin(), each.Triangles.end(),
      [&each](const ClosedMesh::Triangle& ids)
      {
        return std::all_of(
          ids.begin(), ids.end(), [&each](std::int32_t id) { return each.Points[id][0] > 5; });
      });
  };
  EXPECT_EQ(countFixed(simple), countFixed(mesh));
  EXPECT_LT(
    simple.Triangles.size() - countFixed(simple), (mesh.Triangles.size() - countFixed(mesh)) / 2);
}

TEST(FacetedSolid, FansThatShareAPointArePartedAndPointsWithoutTrianglesGo)
{
  ClosedMesh mesh = lacunaMeshShapes::Box({ 0, 0, 0 }, { 1, 1, 1 });
  const ClosedMesh other = lacunaMeshShapes::Box({ 1, 1, 1 }, { 2, 2, 2 });
  lacunaMeshShapes::Append(mesh, other);
  const auto corner = static_cast<std::int32_t>(
    std::find(mesh.Points.begin(), mesh.Points.end(), Vec3{ 1, 1, 1 }) - mesh.Points.begin());
  for (ClosedMesh::Triangle& ids : mesh.Triangles)
  {
    for (std::int32_t& id : ids)
    {
      id = mesh.Points[id] == Vec3{ 1, 1, 1 } ? corner : id;
    }
  }
  const FacetedSolid solid = Make(mesh, 0.02);
  EXPECT_EQ(solid.Bodies.size(), 2u);
  EXPECT_EQ(solid.Points.size(), 16u);
  EXPECT_EQ(solid.GetNumberOfFaces(), 12u);
}

TEST(FacetedSolid, ResultIsTheSameForAnyNumberOfThreads)
{
  const ClosedMesh sphere = lacunaMeshShapes::Sphere({ 1, 2, 3 }, 10, 20);
  ThreadExecution one(1);
  ThreadExecution three(3);
  EXPECT_EQ(MakeStepRequest(MakeFacetedSolid(sphere, 0.05, one), {}),
    MakeStepRequest(MakeFacetedSolid(sphere, 0.05, three), {}));
}

TEST(StepProgram, RequestHasShortLinesOfAscii)
{
  const FacetedSolid solid = Make(lacunaMeshShapes::Box({ 0, 0, 0 }, { 1, 2, 3 }), 0);
  std::istringstream in(MakeStepRequest(solid,
    { "\xc3\xbc", "a\nb", "Lacuna",
      { std::string(600, 'x'), "Made by: " + std::string(300, 'y') } }));
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);)
  {
    lines.push_back(line);
  }
  EXPECT_EQ(lines[1], "??");
  EXPECT_EQ(lines[2], "a?b");
  EXPECT_EQ(lines[4], "6");
  for (int k = 5; k < 11; ++k)
  {
    EXPECT_LE(lines[k].size(), 250u);
  }
}

TEST(StepProgram, WithoutItTheErrorSaysWhatToInstall)
{
  ThreadExecution execution(1);
  const FacetedSolid solid = Make(lacunaMeshShapes::Box({ 0, 0, 0 }, { 1, 2, 3 }), 0);
  try
  {
    MakeStep("/nowhere/lacuna-step", solid, {}, execution);
    FAIL();
  }
  catch (const std::runtime_error& error)
  {
    EXPECT_NE(std::string(error.what()).find("libocct-data-exchange-dev"), std::string::npos);
  }
  EXPECT_THROW(MakeStep("/bin/false", solid, {}, execution), std::runtime_error); // says nothing
  EXPECT_THROW(MakeStep("/bin/true", solid, {}, execution), std::runtime_error);
}

TEST(StepProgram, IsEndedWhenTheUserStops)
{
  const FacetedSolid solid = Make(lacunaMeshShapes::Box({ 0, 0, 0 }, { 1, 2, 3 }), 0);
  ThreadExecution execution(1, [](double) { return false; });
  EXPECT_THROW(MakeStep("/usr/bin/yes", solid, {}, execution), Aborted);
}
