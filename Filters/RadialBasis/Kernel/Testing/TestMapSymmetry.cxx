// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaMirroredMap.h"

#include "lacunaMirrorTest.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <iostream>
#include <limits>
#include <random>
#include <string>
#include <vector>

using lacuna::MirrorPlane;
using lacuna::Vec3;
using namespace lacunaMirrorTest;

namespace
{
constexpr double NaN = std::numeric_limits<double>::quiet_NaN();

/// A map of W x H pixels whose extent starts anywhere, in an oblique view.
struct Map
{
  Map(int width, int height, double spacing, unsigned seed)
    : Depth(static_cast<std::size_t>(width) * height, NaN)
  {
    std::mt19937 random(seed);
    const lacuna::Matrix4 pose = lacuna::Matrix4::Translation({ 12, -40, 90 }) * Small(random, 3);
    this->Grid.Extent = { 5, 5 + width - 1, -3, -3 + height - 1 };
    this->Grid.ImageToWorld = pose * lacuna::Matrix4::Scaling({ spacing, spacing, 1 });
    this->Grid.Depth = this->Depth.data();
  }
  /// depth: of x and y, mm in the map from its first pixel.
  template <class F>
  void Fill(const F& depth)
  {
    const double spacing = Norm(this->Grid.ImageToWorld.Column(0));
    std::size_t p = 0;
    for (int row = 0; row <= this->Grid.Extent[3] - this->Grid.Extent[2]; ++row)
    {
      for (int column = 0; column <= this->Grid.Extent[1] - this->Grid.Extent[0]; ++column)
      {
        this->Depth[p++] = depth(column * spacing, row * spacing);
      }
    }
  }
  /// mm in the map (from its first pixel) and depth to the world.
  Vec3 World(const Vec3& p) const
  {
    const double spacing = Norm(this->Grid.ImageToWorld.Column(0));
    return this->Grid.ImageToWorld.Point(
      { this->Grid.Extent[0] + p[0] / spacing, this->Grid.Extent[2] + p[1] / spacing, p[2] });
  }
  MirrorPlane Plane(const Vec3& point, const Vec3& normal) const
  {
    MirrorPlane plane;
    plane.Normal = Normalized(this->World(point + Normalized(normal)) - this->World(point));
    plane.Offset = Dot(plane.Normal, this->World(point));
    return plane;
  }

  std::vector<double> Depth;
  lacuna::DepthGrid Grid;
};

/// Where a ray along z from (x, y) meets a face: an ellipsoid with nose, eye sockets and cheeks, in a
/// frame of its own whose x is perpendicular to its plane of symmetry. Distance by marching.
double CastFace(const lacuna::Matrix4& toFace, double x, double y, bool defect)
{
  const auto inside = [&](double z)
  {
    const Vec3 p = toFace.Point({ x, y, z });
    const double a = std::abs(p[0]);
    const double head = 1 - std::hypot(p[0] / 60, p[1] / 80, p[2] / 70);
    const double nose =
      0.3 * std::exp(-(a * a / 80 + (p[1] - 10) * (p[1] - 10) / 300)) * (p[2] < 0 ? 1 : 0);
    const double eye = -0.15 * std::exp(-((a - 25) * (a - 25) + (p[1] + 15) * (p[1] + 15)) / 150);
    const double dent = defect ? -0.15 * Step(15 - std::hypot(p[0] - 30, p[1] - 30)) : 0;
    return head + nose + eye + dent;
  };
  double low = -130;
  for (double z = low; z < 90; z += 1)
  {
    if (inside(z) > 0)
    {
      double high = z;
      low = z - 1;
      for (int i = 0; i < 40; ++i)
      {
        const double middle = 0.5 * (low + high);
        (inside(middle) > 0 ? high : low) = middle;
      }
      return 0.5 * (low + high) + 130;
    }
  }
  return NaN;
}

/// The true plane of the face.
MirrorPlane FillFace(Map& map, double turn, bool defect, double noise)
{
  const lacuna::Matrix4 face = lacuna::Matrix4::Translation({ 78, 97, 0 }) *
    lacuna::Matrix4::Rotation({ 0, 0, 1 }, 0.15) * lacuna::Matrix4::Rotation({ 0, 1, 0 }, turn) *
    lacuna::Matrix4::Rotation({ 1, 0, 0 }, 0.1);
  const lacuna::Matrix4 toFace = face.Inverse();
  std::mt19937 random(8);
  std::normal_distribution<double> normal(0, 1);
  map.Fill(
    [&](double x, double y) { return CastFace(toFace, x, y, defect) + noise * normal(random); });
  const Vec3 middle = face.Column(3);
  return map.Plane({ middle[0], middle[1], middle[2] + 130 }, face.Column(0));
}

PlaneError Compare(const MirrorPlane& found, const MirrorPlane& plane, const Map& map)
{
  return { std::asin(std::min(1.0, Norm(Cross(found.Normal, plane.Normal)))) * 180 / 3.14159265,
    std::abs(std::abs(found.Distance(map.World({ 78, 97, 130 }))) -
      std::abs(plane.Distance(map.World({ 78, 97, 130 })))) };
}
}

TEST(MapSymmetry, FindsThePlaneOfAFace)
{
  for (const double turn : { 0.0, 0.2, -0.4 }) // 0, 11 and 23 degrees off the frontal view
  {
    for (const bool defect : { false, true })
    {
      Map map(160, 200, 1, 3);
      const MirrorPlane plane = FillFace(map, turn, defect, 0.2);
      lacuna::ThreadExecution execution(2);
      const auto result = FindSymmetryPlane(map.Grid, execution);
      const PlaneError error = Compare(result.Plane, plane, map);
      const double bound = defect ? 0.1 : 0.05;
      EXPECT_LT(error.Degrees, bound) << turn;
      EXPECT_LT(error.Distance, bound) << turn;
      EXPECT_LT(result.Ambiguity, defect ? 0.8 : 0.5);
      std::cout << "turn " << turn << " defect " << defect << ": " << error.Degrees << " deg "
                << error.Distance << " mm rating " << result.Rating << " ambiguity "
                << result.Ambiguity << "\n";
    }
  }
}

// A plane along the view between two columns turns the map round: exact.
TEST(MapSymmetry, MirrorsColumnsOntoColumns)
{
  Map map(30, 20, 0.8, 5);
  map.Fill([](double x, double y) { return 20 + 0.3 * x + 0.1 * y + 0.02 * x * y; });
  map.Depth[7 * 30 + 4] = NaN;
  std::vector<float> normals(3 * map.Depth.size());
  std::mt19937 random(2);
  for (std::size_t p = 0; p < map.Depth.size(); ++p)
  {
    const Vec3 n = lacuna::Normalized({ std::sin(1.0 * p), std::cos(2.0 * p), -2 });
    for (int a = 0; a < 3; ++a)
    {
      normals[3 * p + a] = static_cast<float>(n[a]);
    }
  }
  const MirrorPlane plane = map.Plane({ 14.5 * 0.8, 0, 0 }, { 1, 0, 0 });
  lacuna::ThreadExecution execution(2);
  const auto result = MirrorMap(map.Grid, normals.data(), plane, {}, execution);
  for (int row = 0; row < 20; ++row)
  {
    for (int column = 0; column < 30; ++column)
    {
      const std::size_t p = row * 30 + column;
      const std::size_t q = row * 30 + 29 - column;
      ASSERT_EQ(std::isnan(result.Depth[p]), std::isnan(map.Depth[q])) << column << " " << row;
      if (!std::isnan(map.Depth[q]))
      {
        ASSERT_NEAR(result.Depth[p], map.Depth[q], 1e-9);
        const Vec3 expected =
          plane.ReflectDirection({ normals[3 * q], normals[3 * q + 1], normals[3 * q + 2] });
        for (int a = 0; a < 3; ++a)
        {
          ASSERT_NEAR(result.Normals[3 * p + a], expected[a], 1e-6);
        }
      }
    }
  }
}

// In an oblique plane: an inclined plane's mirror image is the plane that geometry says.
TEST(MapSymmetry, CastsAnInclinedPlane)
{
  Map map(60, 50, 1, 6);
  map.Fill([](double x, double y) { return 30 + 0.2 * x - 0.1 * y; });
  const Vec3 point{ 31.3, 20, 40 };
  const Vec3 normal = lacuna::Normalized({ 1, 0.1, 0.15 });
  const MirrorPlane plane = map.Plane(point, normal);
  lacuna::ThreadExecution execution(2);
  const auto result = MirrorMap(map.Grid, nullptr, plane, {}, execution);
  EXPECT_TRUE(result.Normals.empty());
  // in the map's frame: p' = p - 2 (n . (p - point)) n is on the plane z = 30 + 0.2 x - 0.1 y
  int seen = 0;
  for (int row = 0; row < 50; ++row)
  {
    for (int column = 0; column < 60; ++column)
    {
      const double z = result.Depth[row * 60 + column];
      if (!std::isnan(z))
      {
        const Vec3 p{ 1.0 * column, 1.0 * row, z };
        const Vec3 q = p - (2 * Dot(normal, p - point)) * normal;
        ASSERT_NEAR(q[2], 30 + 0.2 * q[0] - 0.1 * q[1], 1e-9);
        ++seen;
      }
    }
  }
  EXPECT_GT(seen, 1500);
  EXPECT_NEAR(result.Overlap, seen / 3000.0, 1e-12);
}

// The nearest surface wins, and a sheet seen from behind shows nothing.
TEST(MapSymmetry, HidesWhatIsNotSeen)
{
  Map map(60, 40, 1, 6);
  map.Fill([](double x, double) { return x < 20 ? 10.0 : 40.0; });
  lacuna::ThreadExecution execution(1);
  const auto turned =
    MirrorMap(map.Grid, nullptr, map.Plane({ 29.5, 0, 0 }, { 1, 0, 0 }), {}, execution);
  EXPECT_NEAR(turned.Depth[45], 10, 1e-9);
  EXPECT_NEAR(turned.Depth[10], 40, 1e-9);
  EXPECT_NEAR(turned.Depth[39], 40, 1e-9);
  EXPECT_NEAR(turned.Depth[40], 10, 1e-9);
  // between columns there is no skin over the step
  const auto between =
    MirrorMap(map.Grid, nullptr, map.Plane({ 29.3, 0, 0 }, { 1, 0, 0 }), {}, execution);
  EXPECT_NEAR(between.Depth[38], 40, 1e-9);
  EXPECT_TRUE(std::isnan(between.Depth[39]));
  EXPECT_NEAR(between.Depth[40], 10, 1e-9);
  // mirrored in the image plane itself the surfaces turn their backs to the viewer
  const auto back =
    MirrorMap(map.Grid, nullptr, map.Plane({ 0, 0, 30 }, { 0, 0, 1 }), {}, execution);
  for (const double d : back.Depth)
  {
    ASSERT_TRUE(std::isnan(d));
  }
  EXPECT_EQ(back.Overlap, 0);
}

// A plane so far away that mirrored points are beyond all numbers shows nothing.
TEST(MapSymmetry, PlaneBeyondAllNumbers)
{
  Map map(60, 40, 1, 6);
  map.Fill([](double x, double y) { return 10 + 0.1 * x + 0.2 * y; });
  lacuna::ThreadExecution execution(2);
  for (const double away : { 1e150, 1e200, 1e308, -1e308 })
  {
    const lacuna::MirrorPlane plane{ lacuna::Normalized({ 1, 0.02, 0 }), away };
    const auto result = MirrorMap(map.Grid, nullptr, plane, {}, execution);
    EXPECT_EQ(result.Overlap, 0) << away;
    for (const double d : result.Depth)
    {
      ASSERT_TRUE(std::isnan(d)) << away;
    }
  }
}

TEST(MapSymmetry, SameForAnyNumberOfThreads)
{
  Map map(80, 100, 2, 3);
  FillFace(map, 0.2, true, 0.2);
  std::vector<lacuna::MirroredMap> maps;
  std::vector<lacuna::SymmetryResult> results;
  for (const int threads : { 1, 2, 5 })
  {
    lacuna::ThreadExecution execution(threads);
    results.push_back(FindSymmetryPlane(map.Grid, execution));
    maps.push_back(MirrorMap(map.Grid, nullptr, results.back().Plane, {}, execution));
    EXPECT_EQ(results.back().Plane.Normal, results[0].Plane.Normal);
    EXPECT_EQ(results.back().Plane.Offset, results[0].Plane.Offset);
    EXPECT_EQ(
      std::memcmp(maps.back().Depth.data(), maps[0].Depth.data(), 8 * maps[0].Depth.size()), 0);
    EXPECT_EQ(maps.back().Score, maps[0].Score);
  }
}

TEST(MapSymmetry, NamesWhatIsWrong)
{
  const auto error = [](Map& map)
  {
    lacuna::ThreadExecution execution(1);
    try
    {
      FindSymmetryPlane(map.Grid, execution);
    }
    catch (const std::exception& e)
    {
      return std::string(e.what());
    }
    return std::string("none");
  };
  Map map(40, 40, 1, 1);
  EXPECT_NE(error(map).find("too few"), std::string::npos);
  // half a ball seen from the side is symmetric, the inclined side of a roof is not known to be
  map.Fill([](double, double) { return 5.0; });
  EXPECT_EQ(error(map), "none");
  Map line(1, 400, 1, 1);
  line.Fill([](double, double y) { return y; });
  EXPECT_NE(error(line).find("no plane"), std::string::npos);
}
