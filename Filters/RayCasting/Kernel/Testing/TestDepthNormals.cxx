// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDepthNormals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{
using namespace lacuna;

constexpr double None = std::numeric_limits<double>::quiet_NaN();
constexpr double Degree = 3.14159265358979323846 / 180;
constexpr DepthNormalMethod Methods[] = { DepthNormalMethod::CentralDifference,
  DepthNormalMethod::Gordon, DepthNormalMethod::Predicate };

/// A map in a frame that is no one's axes, with pixels that are not square.
struct Map
{
  std::vector<double> Depth;
  DepthGrid Grid;

  Map(int width, int height, const std::function<double(int, int)>& depth,
    const Vec2& spacing = { 0.5, 0.8 })
  {
    for (int row = 0; row < height; ++row)
    {
      for (int column = 0; column < width; ++column)
      {
        this->Depth.push_back(depth(column, row));
      }
    }
    const Matrix4 frame = Matrix4::Translation({ 3, -40, 7 }) * Matrix4::Rotation({ 1, 2, -3 }, 1);
    this->Grid.Depth = this->Depth.data();
    this->Grid.Extent = { 0, width - 1, 0, height - 1 };
    this->Grid.ImageToWorld = frame * Matrix4::Scaling({ spacing[0], spacing[1], 1 });
  }

  std::vector<float> Normals(
    DepthNormalMethod method, const DiscontinuityLimits& limits = {}, int threads = 2) const
  {
    ThreadExecution execution(threads);
    std::vector<float> normals(3 * this->Depth.size());
    EstimateNormals(this->Grid, method, limits, this->Grid.Extent, normals.data(), execution);
    return normals;
  }

  /// The normal of a pixel in the map's own axes: right, down, along the view.
  Vec3 Local(const std::vector<float>& normals, int column, int row) const
  {
    const std::int64_t i = 3 * this->Grid.PixelOf(column, row);
    const Vec3 n{ normals[i], normals[i + 1], normals[i + 2] };
    const Matrix4& m = this->Grid.ImageToWorld;
    return { Dot(n, Normalized(m.Column(0))), Dot(n, Normalized(m.Column(1))),
      Dot(n, Normalized(m.Column(2))) };
  }

  /// The slopes (mm per mm) of the normal of a pixel of a parallel map.
  Vec2 Slopes(const std::vector<float>& normals, int column, int row) const
  {
    const Vec3 n = this->Local(normals, column, row);
    EXPECT_LT(n[2], 0) << "towards the viewer";
    EXPECT_NEAR(Norm(n), 1, 1e-6);
    return { -n[0] / n[2], -n[1] / n[2] };
  }
};

/// The slope of the middle of three pixels in a row or in a column of a map.
double SlopeOfThree(DepthNormalMethod method, double before, double after, bool alongRow,
  double spacing = 1, const DiscontinuityLimits& limits = {})
{
  const double depths[3] = { before, 20, after };
  const Map map(3, 3,
    [&](int column, int row)
    {
      const bool onLine = alongRow ? row == 1 : column == 1;
      return onLine ? depths[alongRow ? column : row] : None;
    },
    { spacing, spacing });
  const Vec2 slopes = map.Slopes(map.Normals(method, limits), 1, 1);
  EXPECT_NEAR(slopes[alongRow ? 1 : 0], 0, 1e-6) << "no neighbours that way";
  return slopes[alongRow ? 0 : 1];
}
}

TEST(DepthNormals, TheNineCasesOneByOne)
{
  // depths before and after a pixel of depth 20, 1 mm apart; the slope that figure 3.8 returns
  const double steep = std::tan(80 * Degree);
  const double steeper = std::tan(86 * Degree);
  const double nearlyVertical = std::tan(60 * Degree);
  struct
  {
    int Case;
    double Before;
    double After;
    double Slope;
  } const rows[] = {
    { 1, None, None, 0 },
    { 2, None, 21.5, 1.5 },
    { 3, 18.75, None, 1.25 },
    { 4, 20 - steep, 20 + steeper, 0.5 * (steep + steeper) },
    { 4, 20 - 0.2, 20 + 0.3, 0.25 },
    { 5, 20 + steep, 20 + steeper, 0 },
    { 5, 20 - steep, 20 - steeper, 0 },
    { 6, 20 - std::tan(66 * Degree), 20 + std::tan(88 * Degree),
      0.5 * (std::tan(66 * Degree) + std::tan(88 * Degree)) },
    { 7, 20 - 0.5, 20 + steeper, 0.5 },
    { 7, 20 - 0.5, 20 - steeper, 0.5 },
    { 8, 20 - steeper, 20 + 0.25, 0.25 },
    { 8, 20 + steeper, 20 + 0.25, 0.25 },
    { 9, 20 + nearlyVertical, 20 + nearlyVertical - 0.5, -0.25 },
  };
  int seen = 0;
  for (const auto& row : rows)
  {
    const SlopeCase found =
      SlopeRule(DiscontinuityLimits()).Classify({ 20 - row.Before, 1 }, { row.After - 20, 1 });
    EXPECT_EQ(static_cast<int>(found), row.Case) << "the test itself";
    seen |= 1 << row.Case;
    for (const bool alongRow : { true, false })
    {
      EXPECT_NEAR(SlopeOfThree(DepthNormalMethod::Predicate, row.Before, row.After, alongRow),
        row.Slope, 2e-5)
        << "case " << row.Case;
    }
  }
  EXPECT_EQ(seen, 0x3fe);
}

TEST(DepthNormals, TheAnglesAreThePropertiesAngles)
{
  // a jump of 60 degrees beside a slope of 10: seen when the limit is 50, not at 65
  const double jump = std::tan(60 * Degree);
  const double slope = std::tan(10 * Degree);
  const auto found = [&](double angle, double change)
  {
    return SlopeOfThree(
      DepthNormalMethod::Predicate, 20 - slope, 20 + jump, true, 1, { angle, change });
  };
  EXPECT_NEAR(found(65, 20), 0.5 * (slope + jump), 1e-6);
  EXPECT_NEAR(found(50, 20), slope, 1e-6);
  EXPECT_NEAR(found(50, 51), 0.5 * (slope + jump), 1e-6) << "the change is 50";
  EXPECT_NEAR(found(50, 49), slope, 1e-6);
}

TEST(DepthNormals, GordonsWeights)
{
  EXPECT_EQ(GordonWeight(0), 1);
  EXPECT_EQ(GordonWeight(2), 1);
  EXPECT_EQ(GordonWeight(-2), 1);
  EXPECT_EQ(GordonWeight(5), 1e-5);
  EXPECT_EQ(GordonWeight(-7), 1e-5);
  EXPECT_EQ(GordonWeight(std::numeric_limits<double>::infinity()), 1e-5);
  EXPECT_NEAR(GordonWeight(3.5), (1 + 1e-5) / 2, 1e-15);
  EXPECT_NEAR(GordonWeight(-3.5), (1 + 1e-5) / 2, 1e-15);
  EXPECT_NEAR(GordonWeight(2.75), (1 + 1e-5) / 2 + (1 - 1e-5) / 2 * std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(GordonWeight(2 + 1e-9), 1, 1e-15);
  EXPECT_NEAR(GordonWeight(5 - 1e-9), 1e-5, 1e-15);
  double last = 2;
  for (double slope = 0; slope < 6; slope += 0.01)
  {
    EXPECT_LE(GordonWeight(slope), last);
    last = GordonWeight(slope);
  }
}

TEST(DepthNormals, CentralDifferenceAndGordonOfThree)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<double> depth(10, 30);
  for (int i = 0; i < 50; ++i)
  {
    const double before = depth(random);
    const double after = depth(random);
    const double spacing = 0.1 * depth(random);
    const double back = (20 - before) / spacing;
    const double forward = (after - 20) / spacing;
    const double wb = GordonWeight(back);
    const double wf = GordonWeight(forward);
    for (const bool alongRow : { true, false })
    {
      const auto found = [&](DepthNormalMethod method, double b, double f)
      { return SlopeOfThree(method, b, f, alongRow, spacing); };
      EXPECT_NEAR(found(DepthNormalMethod::CentralDifference, before, after),
        (after - before) / (2 * spacing), 1e-4);
      EXPECT_NEAR(found(DepthNormalMethod::Gordon, before, after),
        (wb * back + wf * forward) / (wb + wf), 1e-4);
      for (const DepthNormalMethod method :
        { DepthNormalMethod::CentralDifference, DepthNormalMethod::Gordon })
      {
        EXPECT_NEAR(found(method, None, after), forward, 2e-4);
        EXPECT_NEAR(found(method, before, None), back, 2e-4);
        EXPECT_NEAR(found(method, None, None), 0, 1e-6);
      }
    }
  }
}

TEST(DepthNormals, PlanesAreExactByEveryMethod)
{
  for (const Vec2& slope : { Vec2{ 0.3, -0.7 }, Vec2{ -1.5, 0.2 }, Vec2{ 6, -4 } })
  {
    const Map map(9, 7, [&](int c, int r) { return 20 + 0.5 * slope[0] * c + 0.8 * slope[1] * r; });
    for (const DepthNormalMethod method : Methods)
    {
      const std::vector<float> normals = map.Normals(method);
      for (int row = 0; row < 7; ++row)
      {
        for (int column = 0; column < 9; ++column)
        {
          const Vec2 found = map.Slopes(normals, column, row);
          EXPECT_NEAR(found[0], slope[0], 3e-5);
          EXPECT_NEAR(found[1], slope[1], 3e-5);
        }
      }
    }
  }
}

TEST(DepthNormals, PlanesAreExactInPerspectiveToo)
{
  // a wide view: rays up to 60 degrees off the axis
  Map map(21, 15, [](int, int) { return 0; });
  map.Grid.Perspective = true;
  map.Grid.Eye = map.Grid.ImageToWorld.Point({ 10, 7, -3 });
  for (const Vec3& local : { Vec3{ 0, 0, -1 }, Vec3{ 0.3, -0.2, -0.9 }, Vec3{ -0.35, 0.15, -1 } })
  {
    const Matrix4& m = map.Grid.ImageToWorld;
    const Vec3 normal = Normalized(local[0] * Normalized(m.Column(0)) +
      local[1] * Normalized(m.Column(1)) + local[2] * Normalized(m.Column(2)));
    const Vec3 onPlane = map.Grid.ImageToWorld.Point({ 10, 7, 40 });
    for (int row = 0; row < 15; ++row)
    {
      for (int column = 0; column < 21; ++column)
      {
        const Vec3 pixel = map.Grid.ImageToWorld.Point({ 1.0 * column, 1.0 * row, 0 });
        const double depth =
          Dot(onPlane - pixel, normal) / Dot(map.Grid.RayOf(column, row), normal);
        ASSERT_GT(depth, 0);
        map.Depth[map.Grid.PixelOf(column, row)] = depth;
      }
    }
    for (const DepthNormalMethod method : Methods)
    {
      const std::vector<float> normals = map.Normals(method);
      for (std::size_t i = 0; i < map.Depth.size(); ++i)
      {
        const Vec3 found{ normals[3 * i], normals[3 * i + 1], normals[3 * i + 2] };
        ASSERT_LT(Norm(found - normal), 2e-7) << i;
      }
    }
  }
}

TEST(DepthNormals, SphereAgainstTheFormulas)
{
  const double radius = 30;
  const double h = 0.5;
  const auto sphere = [&](int c, int r)
  {
    const double x = h * (c - 70);
    const double y = h * (r - 66);
    const double rest = radius * radius - x * x - y * y;
    return rest > 0 ? 50 - std::sqrt(rest) : None;
  };
  const Map map(141, 133, sphere, { h, h });
  const std::vector<float> central = map.Normals(DepthNormalMethod::CentralDifference);
  const std::vector<float> gordon = map.Normals(DepthNormalMethod::Gordon);
  const std::vector<float> predicate = map.Normals(DepthNormalMethod::Predicate);
  const SlopeRule cases{ DiscontinuityLimits() };
  double worst = 0;
  for (int r = 1; r < 132; ++r)
  {
    for (int c = 1; c < 140; ++c)
    {
      const double z = sphere(c, r);
      const double neighbours[4] = { sphere(c - 1, r), sphere(c + 1, r), sphere(c, r - 1),
        sphere(c, r + 1) };
      if (std::isnan(z + neighbours[0] + neighbours[1] + neighbours[2] + neighbours[3]))
      {
        continue;
      }
      for (int axis = 0; axis < 2; ++axis)
      {
        const double back = (z - neighbours[2 * axis]) / h;
        const double forward = (neighbours[2 * axis + 1] - z) / h;
        const double both = 0.5 * (back + forward);
        const double scale = 1e-4 * (1 + both * both);
        EXPECT_NEAR(map.Slopes(central, c, r)[axis], both, scale);
        const double wb = GordonWeight(back);
        const double wf = GordonWeight(forward);
        EXPECT_NEAR(map.Slopes(gordon, c, r)[axis], (wb * back + wf * forward) / (wb + wf), scale);
        const double expected = cases.SlopeAt(neighbours[2 * axis], z, neighbours[2 * axis + 1], h);
        EXPECT_NEAR(map.Slopes(predicate, c, r)[axis], expected, scale);
      }
      const Vec3 truth{ h * (c - 70) / radius, h * (r - 66) / radius, (z - 50) / radius };
      if (truth[2] < -0.5) // up to 60 degrees
      {
        worst = std::max(worst, Norm(map.Local(predicate, c, r) - truth));
      }
    }
  }
  EXPECT_LT(worst, 0.002) << "second order of the pixel spacing";
}

TEST(DepthNormals, CasesGoByThePerspectiveRay)
{
  // two spheres around the eye, seen 60 degrees off the axis where the map changes from one to the
  // other: against its ray each is flat and the step is steep, against the axis neither is steep
  const int last = 34;
  Map map(41, 3, [](int, int) { return 0.0; }, { 0.5, 0.5 });
  DepthGrid& grid = map.Grid;
  grid.Eye = grid.ImageToWorld.Point({ 0, 1, -10 });
  grid.Perspective = true;
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 41; ++column)
    {
      const Vec3 pixel = grid.ImageToWorld.Point({ 1.0 * column, 1.0 * row, 0 });
      map.Depth[grid.PixelOf(column, row)] = (column <= last ? 100 : 105) - Norm(pixel - grid.Eye);
    }
  }
  const std::vector<float> normals = map.Normals(DepthNormalMethod::Predicate);
  for (int column = 1; column < 40; ++column)
  {
    const std::int64_t i = 3 * grid.PixelOf(column, 1);
    const Vec3 normal{ normals[i], normals[i + 1], normals[i + 2] };
    EXPECT_LT(Norm(normal + grid.RayOf(column, 1)), 0.01) << column;
  }
}

TEST(DepthNormals, StepAndCrease)
{
  // two planes of slope 0.25, 10 mm apart in depth
  const Map step(10, 3, [](int c, int) { return 20 + 0.25 * c + (c >= 5 ? 10 : 0); }, { 1, 1 });
  const double jump = 10.25;
  for (const int c : { 4, 5 })
  {
    EXPECT_NEAR(step.Slopes(step.Normals(DepthNormalMethod::CentralDifference), c, 1)[0],
      0.5 * (0.25 + jump), 2e-5);
    EXPECT_NEAR(step.Slopes(step.Normals(DepthNormalMethod::Gordon), c, 1)[0],
      (0.25 + 1e-5 * jump) / (1 + 1e-5), 1e-6);
    EXPECT_NEAR(step.Slopes(step.Normals(DepthNormalMethod::Predicate), c, 1)[0], 0.25, 1e-6);
  }
  // a roof: the ridge is nobody's discontinuity
  const Map roof(9, 3, [](int c, int) { return 20 + 0.6 * std::abs(c - 4); }, { 1, 1 });
  for (const DepthNormalMethod method : Methods)
  {
    EXPECT_NEAR(roof.Slopes(roof.Normals(method), 4, 1)[0], 0, 1e-6);
    EXPECT_NEAR(roof.Slopes(roof.Normals(method), 3, 1)[0], -0.6, 1e-6);
    EXPECT_NEAR(roof.Slopes(roof.Normals(method), 5, 1)[0], 0.6, 1e-6);
  }
  // where a flat turns into a face of 78 degrees, Gordon leans on the flat and the cases do too;
  // within the face both have its slope
  const double face = std::tan(78 * Degree);
  const Map wall(9, 3, [&](int c, int) { return 20 + (c > 4 ? face * (c - 4) : 0); }, { 1, 1 });
  EXPECT_NEAR(wall.Slopes(wall.Normals(DepthNormalMethod::Predicate), 4, 1)[0], 0, 1e-6);
  EXPECT_NEAR(wall.Slopes(wall.Normals(DepthNormalMethod::Gordon), 4, 1)[0],
    GordonWeight(face) * face / (1 + GordonWeight(face)), 1e-6);
  EXPECT_NEAR(wall.Slopes(wall.Normals(DepthNormalMethod::Predicate), 6, 1)[0], face, 1e-4);
}

TEST(DepthNormals, SameForAnyThreadsAndExtents)
{
  const Map map(60, 50,
    [](int x, int y)
    { return std::fmod(x * 7 + y * 13, 11) < 1 ? None : 5 * std::fmod(x * 3 + y * 5, 17); });
  for (const DepthNormalMethod method : Methods)
  {
    const std::vector<float> whole = map.Normals(method, {}, 1);
    EXPECT_EQ(map.Normals(method, {}, 2), whole);
    EXPECT_EQ(map.Normals(method, {}, 5), whole);
    const std::array<int, 4> parts[] = { { 0, 20, 0, 30 }, { 21, 59, 0, 49 }, { 5, 5, 49, 49 } };
    for (const auto& part : parts)
    {
      // the part with one pixel more on each side
      DepthGrid grid = map.Grid;
      grid.Extent = { std::max(0, part[0] - 1), std::min(59, part[1] + 1), std::max(0, part[2] - 1),
        std::min(49, part[3] + 1) };
      std::vector<double> depth;
      for (int row = grid.Extent[2]; row <= grid.Extent[3]; ++row)
      {
        for (int column = grid.Extent[0]; column <= grid.Extent[1]; ++column)
        {
          depth.push_back(map.Depth[map.Grid.PixelOf(column, row)]);
        }
      }
      grid.Depth = depth.data();
      const int columns = part[1] - part[0] + 1;
      std::vector<float> normals(3 * columns * (part[3] - part[2] + 1));
      ThreadExecution execution(2);
      EstimateNormals(grid, method, {}, part, normals.data(), execution);
      for (std::size_t i = 0; i < normals.size(); ++i)
      {
        const int pixel = static_cast<int>(i / 3);
        const std::int64_t j =
          map.Grid.PixelOf(part[0] + pixel % columns, part[2] + pixel / columns);
        ASSERT_EQ(normals[i], whole[3 * j + i % 3]);
      }
    }
  }
}

TEST(DepthNormals, HostileMaps)
{
  for (const DepthNormalMethod method : Methods)
  {
    const Map nothing(5, 4, [](int, int) { return None; });
    for (const float x : nothing.Normals(method))
    {
      EXPECT_EQ(x, 0);
    }
    const Map one(1, 1, [](int, int) { return 3; });
    EXPECT_NEAR(one.Local(one.Normals(method), 0, 0)[2], -1, 1e-6);
    const Map row(6, 1, [](int c, int) { return c; }, { 1, 1 });
    EXPECT_NEAR(row.Slopes(row.Normals(method), 5, 0)[0], 1, 1e-6);
    const Map column(1, 6, [](int, int r) { return -r; }, { 1, 1 });
    EXPECT_NEAR(column.Slopes(column.Normals(method), 0, 0)[1], -1, 1e-6);
    Map wild(6, 6,
      [](int c, int r)
      {
        const double values[] = { 1e308, -1e308, 0, std::numeric_limits<double>::infinity(), 1e-300,
          -std::numeric_limits<double>::infinity(), None };
        return values[(c * 5 + r * 3) % 7];
      });
    for (const bool perspective : { false, true })
    {
      wild.Grid.Perspective = perspective;
      wild.Grid.Eye = wild.Grid.ImageToWorld.Point({ 2, 2, 0 });
      const std::vector<float> normals = wild.Normals(method);
      for (std::size_t i = 0; i < wild.Depth.size(); ++i)
      {
        const Vec3 n{ normals[3 * i], normals[3 * i + 1], normals[3 * i + 2] };
        const bool atEye = perspective && i == 2 + 6 * 2; // its ray has no direction
        EXPECT_NEAR(Norm(n), std::isfinite(wild.Depth[i]) && !atEye ? 1 : 0, atEye ? 1 : 1e-6);
      }
    }
  }
  const Map map(2, 2, [](int, int) { return 1; });
  EXPECT_THROW(map.Normals(DepthNormalMethod::Predicate, { 91, 20 }), std::invalid_argument);
  EXPECT_THROW(map.Normals(DepthNormalMethod::Predicate, { None, 20 }), std::invalid_argument);
  EXPECT_THROW(map.Normals(DepthNormalMethod::Predicate, { 65, -1 }), std::invalid_argument);
}

TEST(DepthNormals, MissingOnesAndDifferences)
{
  const Map map(4, 1, [](int c, int) { return c == 3 ? None : 10; });
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> normals = { 0, 0, 0, 0, 3, 0, nan, 1, 0, 1, 0, 0 };
  ThreadExecution execution(2);
  EXPECT_EQ(MendNormals(map.Grid, map.Grid.Extent, normals.data(), execution), 2);
  EXPECT_NEAR(map.Local(normals, 0, 0)[2], -1, 1e-6);
  EXPECT_NEAR(map.Local(normals, 2, 0)[2], -1, 1e-6);
  EXPECT_EQ(normals[4], 1) << "made unit";
  EXPECT_EQ(normals[9], 0) << "no depth, no normal";

  const std::vector<float> a = { 1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0 };
  const std::vector<float> b = { 1, 0, 0, 0, 1, 0, -1, 0, 0, 1, 0, 0, 1, 1e-4F, 0 };
  std::vector<float> degrees(5);
  AnglesBetween(a.data(), b.data(), 5, degrees.data(), execution);
  EXPECT_EQ(degrees[0], 0);
  EXPECT_NEAR(degrees[1], 90, 1e-5);
  EXPECT_NEAR(degrees[2], 180, 1e-5);
  EXPECT_TRUE(std::isnan(degrees[3]));
  EXPECT_NEAR(degrees[4], 1e-4 / Degree, 1e-8);
}
