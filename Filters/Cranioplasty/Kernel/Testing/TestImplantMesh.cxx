// SPDX-License-Identifier: BSD-3-Clause
// Holes, plates, parts, offsets and text of implants for a shell that is known exactly.
#include "lacunaImplantMesh.h"
#include "lacunaSkullImplant.h"

#include "lacunaShellTest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

using namespace lacunaShellTest;
using lacunaSkullTest::Pi;

namespace
{
SkullImplantOptions Coarse()
{
  SkullImplantOptions options;
  options.TriangleSize = 1.5;
  return options;
}

struct Round
{
  Vec3 Middle; // on the sphere
  double Radius;
  double Off; // largest difference of a point from it
};

// The holes of a shell are along rays.
std::vector<Round> FindRoundHoles(const SkullImplant& implant)
{
  std::vector<Round> holes;
  const std::vector<std::vector<int>> walls = FindWalls(implant);
  for (std::size_t w = 1; w < walls.size(); ++w)
  {
    Vec3 sum{ 0, 0, 0 };
    for (const int k : walls[w])
    {
      sum = sum + implant.Points[k];
    }
    const Vec3 axis = lacuna::Normalized(sum);
    const auto distance = [&](int k)
    {
      const Vec3& x = implant.Points[k];
      return Norm(x - Dot(x, axis) * axis);
    };
    double mean = 0;
    for (const int k : walls[w])
    {
      mean += distance(k) / static_cast<double>(walls[w].size());
    }
    double off = 0;
    for (const int k : walls[w])
    {
      off = std::max(off, std::abs(distance(k) - mean));
    }
    holes.push_back({ Outer * axis, mean, off });
  }
  return holes;
}

int CountHandles(const SkullImplant& implant)
{
  std::set<std::pair<int, int>> edges;
  for (const auto& t : implant.Triangles)
  {
    for (int c = 0; c < 3; ++c)
    {
      edges.insert(std::minmax({ t[c], t[(c + 1) % 3] }));
    }
  }
  const auto euler = static_cast<int>(implant.Points.size()) - static_cast<int>(edges.size()) +
    static_cast<int>(implant.Triangles.size());
  return (2 - euler) / 2; // of one piece
}

// mm along the sphere from the rim of the cone
double ToRim(const Shell& shell, const Vec3& onSphere)
{
  return -shell.GetWall(onSphere) - 0.5;
}
}

TEST(ImplantMesh, HasDrainageHoles)
{
  const Shell shell;
  const SkullImplant whole = Make(shell, Coarse());
  SkullImplantOptions options = Coarse();
  options.DrainageSpacing = 9;
  options.DrainageDiameter = 3;
  options.RimDistance = 4;
  const SkullImplant implant = Make(shell, options);
  EXPECT_TRUE(IsClosed(implant));
  const std::vector<Round> holes = FindRoundHoles(implant);
  ASSERT_GT(holes.size(), 8u);
  EXPECT_EQ(static_cast<int>(holes.size()), implant.Holes);
  EXPECT_EQ(CountHandles(implant), implant.Holes);
  for (std::size_t k = 0; k < holes.size(); ++k)
  {
    EXPECT_NEAR(holes[k].Radius, 1.5, 1e-3);
    EXPECT_LT(holes[k].Off, 0.03); // its axis is the normal of a sampled sphere, to half a degree
    EXPECT_GT(ToRim(shell, holes[k].Middle), 4 + 1.5 - 0.3);
    double nearest = 100;
    for (std::size_t m = 0; m < holes.size(); ++m)
    {
      nearest = m == k ? nearest : std::min(nearest, Norm(holes[k].Middle - holes[m].Middle));
    }
    EXPECT_NEAR(nearest, 9, 0.3);
  }
  // a polygon of 16 sides, between two spheres
  const double polygon = 0.5 * 16 * std::sin(2 * Pi / 16) * 1.5 * 1.5;
  const double taken = whole.Volume - implant.Volume;
  EXPECT_NEAR(
    taken, implant.Holes * polygon * Thickness, 0.02 * implant.Holes * polygon * Thickness);
  EXPECT_NEAR(implant.HoleArea, whole.HoleArea, 0.003 * whole.HoleArea);
}

TEST(ImplantMesh, HasHolesForSuturesAlongTheRim)
{
  const Shell shell;
  SkullImplantOptions options = Coarse();
  options.SutureSpacing = 10;
  options.SutureDiameter = 1.2;
  options.RimDistance = 3;
  const SkullImplant implant = Make(shell, options);
  EXPECT_TRUE(IsClosed(implant));
  const std::vector<Round> holes = FindRoundHoles(implant);
  // the rim's circle, from the axis as seen from the point of the cone
  const double sine = std::sin(HoleAngle) * 12 / Outer;
  const double length = 2 * Pi * Outer * std::sin(HoleAngle + std::asin(sine));
  EXPECT_NEAR(static_cast<double>(holes.size()), length / 10, 1.01);
  for (const Round& hole : holes)
  {
    EXPECT_NEAR(hole.Radius, 0.6, 1e-3);
    EXPECT_NEAR(ToRim(shell, hole.Middle), 3, 0.25);
  }
}

// Bone of one side is only 2 mm thick: screws of 4 mm go where it is thicker, as far as their share of the rim allows.
TEST(ImplantMesh, PutsPlatesWhereBoneIsThick)
{
  const Shell shell;
  const Vec3 beside = lacuna::Normalized(Cross(shell.Axis, { 1, 0, 0 }));
  SkullImplantOptions options = Coarse();
  options.Plates = 4;
  options.RimDistance = 6;
  const auto thin = [&](SkullRays& rays)
  {
    for (std::size_t i = 0; i < rays.Directions.size(); ++i)
    {
      const Vec3& d = rays.Directions[i];
      const Vec3 across = lacuna::Normalized(d - Dot(d, shell.Axis) * shell.Axis);
      if (std::abs(Dot(across, beside)) < 0.3)
      {
        rays.Inner[i] = rays.Outer[i] - 2;
      }
    }
  };
  const SkullImplant implant = Make(shell, options, 2, {}, thin);
  ASSERT_EQ(implant.Plates.size(), 4u);
  EXPECT_EQ(implant.Holes, 4);
  EXPECT_EQ(FindRoundHoles(implant).size(), 4u);
  for (const lacuna::ImplantPlateScrews& plate : implant.Plates)
  {
    EXPECT_NEAR(Norm(plate.OnImplant), Outer, 0.05);
    EXPECT_NEAR(Norm(plate.OnBone), Outer, 0.05);
    EXPECT_NEAR(ToRim(shell, plate.OnImplant), 6, 0.3);
    EXPECT_NEAR(-ToRim(shell, plate.OnBone) - 0.5, 6, 0.5);
    EXPECT_GT(shell.GetDepth(0.98 * plate.OnBone), 1); // in bone
    // across the gap, the shortest way
    EXPECT_NEAR(Norm(plate.OnImplant - plate.OnBone), 6 + 0.5 + 6, 0.3);
    EXPECT_NEAR(plate.BoneThickness, Thickness, 0.1);
  }
  EXPECT_TRUE(implant.Warnings.empty());
  options.ScrewLength = 8;
  const SkullImplant warned = Make(shell, options, 2, {}, thin);
  ASSERT_EQ(warned.Warnings.size(), 1u);
  EXPECT_NE(warned.Warnings[0].find("4 of the plates' screws are in bone thinner than 8 mm"),
    std::string::npos);
}

// A plate that is told of has its hole: beside the cuts of parts, and not where another one has it already.
TEST(ImplantMesh, HasAHoleForEachPlate)
{
  const Shell shell;
  const auto check = [](const SkullImplant& implant)
  {
    const std::vector<std::vector<int>> walls = FindWalls(implant);
    for (const lacuna::ImplantPlateScrews& plate : implant.Plates)
    {
      const bool hasHole = std::any_of(walls.begin(), walls.end(),
        [&](const std::vector<int>& wall)
        {
          double farthest = 0;
          for (const int k : wall)
          {
            const Vec3 axis = lacuna::Normalized(plate.OnImplant);
            const Vec3& x = implant.Points[k];
            farthest = std::max(farthest, Norm(x - Dot(x, axis) * axis));
          }
          return farthest < 5.2;
        });
      EXPECT_TRUE(hasHole);
    }
    EXPECT_EQ(static_cast<int>(implant.Plates.size()), implant.Holes);
    EXPECT_TRUE(IsClosed(implant));
  };
  SkullImplantOptions options = Coarse();
  options.Plates = 6;
  options.Parts = 2;
  const SkullImplant inParts = Make(shell, options);
  check(inParts);
  EXPECT_EQ(inParts.Plates.size(), 6u);
  EXPECT_TRUE(inParts.Warnings.empty());
  options = Coarse();
  options.Plates = 12;
  options.ScrewDiameter = 10;
  options.RimDistance = 7;
  const SkullImplant crowded = Make(shell, options);
  check(crowded);
  EXPECT_LT(crowded.Plates.size(), 12u);
  ASSERT_EQ(crowded.Warnings.size(), 1u);
  EXPECT_NE(crowded.Warnings[0].find(
              "only " + std::to_string(crowded.Plates.size()) + " of 12 plates have a place"),
    std::string::npos);
}

// Holes come closer to each other inwards.
TEST(ImplantMesh, LeavesMaterialBetweenHoles)
{
  const Shell shell;
  SkullImplantOptions options = Coarse();
  options.Thickness = 20;
  options.DrainageSpacing = 8.5;
  options.DrainageDiameter = 6;
  options.RimDistance = 2;
  const SkullImplant implant = Make(shell, options);
  EXPECT_TRUE(IsClosed(implant));
  const std::vector<std::vector<int>> walls = FindWalls(implant);
  ASSERT_GT(walls.size(), 3u);
  for (std::size_t a = 0; a < walls.size(); ++a) // the rim, too
  {
    for (std::size_t b = 0; b < a; ++b)
    {
      double least = 100;
      for (const int k : walls[a])
      {
        for (const int m : walls[b])
        {
          least = std::min(least, Norm(implant.Points[k] - implant.Points[m]));
        }
      }
      EXPECT_GT(least, 1.9) << a << " " << b;
    }
  }
}

// Three parts that can be put in one after the other, half a mm apart.
TEST(ImplantMesh, IsDividedAlongTheWayIn)
{
  const Shell shell;
  const SkullImplant whole = Make(shell, Coarse());
  SkullImplantOptions options = Coarse();
  options.Parts = 3;
  const SkullImplant implant = Make(shell, options);
  EXPECT_TRUE(IsClosed(implant));
  ASSERT_EQ(implant.Parts.size(), implant.Triangles.size());
  EXPECT_LT(Norm(implant.InsertionDirection - whole.InsertionDirection), 1e-12);
  EXPECT_NEAR(implant.LeastTaper, whole.LeastTaper, 1e-9);
  EXPECT_NEAR(implant.HoleArea, whole.HoleArea, 0.02 * whole.HoleArea);
  std::vector<std::vector<Vec3>> points(3);
  std::vector<double> volumes(3, 0);
  for (std::size_t t = 0; t < implant.Triangles.size(); ++t)
  {
    const int part = implant.Parts[t] - 1;
    ASSERT_TRUE(part >= 0 && part < 3);
    const auto& c = implant.Triangles[t];
    for (const int corner : c)
    {
      points[part].push_back(implant.Points[corner]);
    }
    volumes[part] +=
      Dot(implant.Points[c[0]], Cross(implant.Points[c[1]], implant.Points[c[2]])) / 6;
  }
  // As seen along the way in neighbours are EdgeClearance apart, at each depth: the cuts are planes along it.
  const Vec3 in = implant.InsertionDirection;
  double cutLength = 0;
  for (int part = 0; part < 2; ++part)
  {
    double least = 100;
    for (const Vec3& a : points[part])
    {
      for (const Vec3& b : points[part + 1])
      {
        const Vec3 way = a - b;
        least = std::min(least, Norm(way - Dot(way, in) * in));
      }
    }
    EXPECT_NEAR(least, 0.5, 0.03);
    cutLength += 2 * Outer * std::sin(HoleAngle);
  }
  EXPECT_GT(implant.InsertionClearance, 0.47); // from bone
  EXPECT_NEAR(volumes[0] + volumes[1] + volumes[2], implant.Volume, 1e-6 * implant.Volume);
  for (const double volume : volumes)
  {
    EXPECT_NEAR(volume, implant.Volume / 3, 0.1 * implant.Volume);
  }
  // what the cuts and the rounded corners take
  const double taken = whole.Volume - implant.Volume;
  EXPECT_GT(taken, 0.7 * 0.5 * Thickness * cutLength);
  EXPECT_LT(taken, 1.5 * 0.5 * Thickness * cutLength);
  EXPECT_TRUE(implant.Warnings.empty());
}

TEST(ImplantMesh, IsMovedInTheMiddleAndFadesToTheRim)
{
  const Shell shell;
  SkullImplantOptions options = Coarse();
  options.OuterOffset = -1.5;
  options.InnerOffset = 2;
  options.OffsetFade = 12;
  options.MinimumThickness = 2;
  const SkullImplant implant = Make(shell, options);
  EXPECT_TRUE(IsClosed(implant));
  for (std::size_t t = 0; t < implant.Triangles.size(); ++t)
  {
    const Vec3& x = implant.Points[implant.Triangles[t][0]];
    const bool isOuter = implant.Faces[t] == SkullImplantFace::Outer;
    if (implant.Faces[t] == SkullImplantFace::Edge)
    {
      EXPECT_NEAR(shell.GetWall(x), -0.5, 0.05);
      continue;
    }
    // of the place on the outer table, from the rim of the hole
    const double u = std::clamp(-shell.GetWall(Outer * lacuna::Normalized(x)) / 12, 0.0, 1.0);
    const double part = u * u * u * (u * (6 * u - 15) + 10);
    const double radius = isOuter ? Outer - 1.5 * part : Outer - Thickness + 2 * part;
    EXPECT_NEAR(Norm(x), radius, 0.1);
  }
  EXPECT_NEAR(implant.MinimumThickness, Thickness - 3.5, 0.1);
  options.InnerOffset = 6; // more than there is: the least thickness stays
  EXPECT_GE(Make(shell, options).MinimumThickness, 2 - 0.05);
}

// An L: seen from within it is an L, its foot to the right of the bar.
TEST(ImplantMesh, IsEngravedSoThatItIsReadFromWithin)
{
  const Shell shell(Matrix4::Translation({ 40, -25, 300 }));
  const Vec3 middle = shell.World.Column(3);
  SkullImplantOptions options = Coarse();
  options.Text = { { { 0, 0 }, { 6, 0 }, { 6, 2 }, { 2, 2 }, { 2, 8 }, { 0, 8 } } };
  options.DrainageSpacing = 8;
  const SkullImplant implant = Make(shell, options);
  EXPECT_TRUE(IsClosed(implant));
  EXPECT_TRUE(implant.Warnings.empty());
  const double floor = Outer - Thickness + lacuna::EngravedDepth;
  std::vector<Vec3> deep;
  double area = 0;
  for (std::size_t t = 0; t < implant.Triangles.size(); ++t)
  {
    if (implant.Faces[t] != SkullImplantFace::Text)
    {
      continue;
    }
    Vec3 c[3];
    bool isDeep = true;
    for (int k = 0; k < 3; ++k)
    {
      c[k] = implant.Points[implant.Triangles[t][k]] - middle;
      isDeep = isDeep && std::abs(Norm(c[k]) - floor) < 0.06;
    }
    if (isDeep)
    {
      deep.insert(deep.end(), { c[0], c[1], c[2] });
      area += 0.5 * Norm(Cross(c[1] - c[0], c[2] - c[0]));
    }
  }
  // the letter is true to size on the inner face; its floor is on a larger sphere
  EXPECT_NEAR(area, (6 * 2 + 6 * 2) * std::pow(floor / (Outer - Thickness), 2), 0.1);
  Vec3 sum{ 0, 0, 0 };
  for (const Vec3& x : deep)
  {
    sum = sum + x;
  }
  const Vec3 look = lacuna::Normalized(sum); // of a viewer in the middle of the skull
  const Vec3 up = lacuna::Normalized(options.Up - Dot(options.Up, look) * look);
  const Vec3 right = Cross(look, up);
  double low[2] = { 100, 100 };
  double high[2] = { -100, -100 };
  for (const Vec3& x : deep)
  {
    const double p[2] = { Dot(x, right), Dot(x, up) };
    for (int a = 0; a < 2; ++a)
    {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
  }
  EXPECT_NEAR(high[0] - low[0], 6, 0.1);
  EXPECT_NEAR(high[1] - low[1], 8, 0.1);
  for (const Vec3& x : deep)
  {
    const double p[2] = { Dot(x, right) - low[0], Dot(x, up) - low[1] };
    EXPECT_TRUE(p[0] < 2.1 || p[1] < 2.1) << p[0] << " " << p[1]; // in the bar or in the foot
  }
  // no drainage hole goes through it
  for (const std::vector<int>& wall : FindWalls(implant))
  {
    for (const int k : wall)
    {
      const Vec3 x = implant.Points[k] - middle;
      const bool isBeside = Dot(x, look) < 0 || Dot(x, right) < low[0] - 1.5 ||
        Dot(x, right) > high[0] + 1.5 || Dot(x, up) < low[1] - 1.5 || Dot(x, up) > high[1] + 1.5;
      EXPECT_TRUE(isBeside);
    }
  }
  options.Text = { { { 0, 0 }, { 60, 0 }, { 60, 8 }, { 0, 8 } } };
  const SkullImplant without = Make(shell, options);
  ASSERT_EQ(without.Warnings.size(), 1u);
  EXPECT_NE(without.Warnings[0].find("there is no place for the text"), std::string::npos);
}

TEST(ImplantMesh, RefusesOptionsOutOfRange)
{
  const auto check = [](const char* name, auto change)
  {
    SkullImplantOptions options;
    change(options);
    try
    {
      lacuna::CheckSkullImplantOptions(options);
      ADD_FAILURE() << name;
    }
    catch (const std::invalid_argument& error)
    {
      EXPECT_EQ(std::string(error.what()).rfind(std::string(name) + " is ", 0), 0u) << error.what();
    }
  };
  check("OuterOffset", [](auto& o) { o.OuterOffset = 11; });
  check("InnerOffset", [](auto& o) { o.InnerOffset = std::nan(""); });
  check("OffsetFade", [](auto& o) { o.OffsetFade = -1; });
  check("Parts", [](auto& o) { o.Parts = 0; });
  check("DrainageSpacing", [](auto& o) { o.DrainageSpacing = 3; });
  check("DrainageDiameter", [](auto& o) { o.DrainageDiameter = 0; });
  check("SutureSpacing", [](auto& o) { o.SutureSpacing = -5; });
  check("SutureDiameter", [](auto& o) { o.SutureDiameter = 11; });
  check("Plates", [](auto& o) { o.Plates = 13; });
  check("ScrewDiameter", [](auto& o) { o.ScrewDiameter = 0.1; });
  check("ScrewLength", [](auto& o) { o.ScrewLength = 0; });
  check("RimDistance", [](auto& o) { o.RimDistance = 1; });
  check("InsertionDirection", [](auto& o) { o.InsertionDirection[1] = std::nan(""); });
  // holes that would cross the rim
  check("RimDistance", [](auto& o) { o.SutureSpacing = 10, o.SutureDiameter = 10; });
  check("RimDistance", [](auto& o) { o.Plates = 4, o.ScrewDiameter = 10; });
  check("RimDistance", [](auto& o) { o.Plates = 4, o.RimDistance = 2; });
  EXPECT_NO_THROW(lacuna::CheckSkullImplantOptions({}));
}
