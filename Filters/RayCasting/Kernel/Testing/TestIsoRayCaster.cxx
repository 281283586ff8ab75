// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaIsoRayCaster.h"
#include "lacunaSplineFilter.h"
#include "lacunaTestField.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>

namespace
{
using namespace lacuna;

constexpr FieldInterpolation AllInterpolations[] = { FieldInterpolation::BSpline,
  FieldInterpolation::InterpolatingBSpline, FieldInterpolation::Trilinear };

IsoRayCaster MakeCaster(const TestField& field,
  FieldInterpolation interpolation = FieldInterpolation::BSpline, SolidSide side = SolidSide::Above)
{
  ThreadExecution execution(1);
  return IsoRayCaster(field.View(), interpolation, side, execution);
}

double DistanceToIndexBox(const Vec3& index, const std::array<int, 3>& size)
{
  double margin = 1e9;
  for (int a = 0; a < 3; ++a)
  {
    margin = std::min({ margin, index[a], size[a] - 1 - index[a] });
  }
  return margin;
}
}

TEST(IsoRayCaster, LinearFieldsAreExactPlanes)
{
  std::mt19937 random(10);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 60; ++trial)
  {
    const Matrix4 frame = RandomFrame(random, { 0.8, 1.1, 2.3 }, trial % 2 != 0);
    const std::array<int, 3> size{ 14, 11, 8 };
    const Vec3 centre = frame.Point({ 6.5, 5, 3.5 });
    const Vec3 normal = RandomUnit(random); // out of the solid
    const double offset = 2 * uniform(random);
    const TestField field(
      size, frame, [&](const Vec3& p) { return offset - Dot(p - centre, normal); });
    const bool above = trial % 3 != 0;
    const Vec3 outwards = above ? normal : -1 * normal;
    for (const auto interpolation : AllInterpolations)
    {
      const IsoRayCaster caster =
        MakeCaster(field, interpolation, above ? SolidSide::Above : SolidSide::Below);
      for (int ray = 0; ray < 20; ++ray)
      {
        const Vec3 direction = RandomUnit(random);
        const Vec3 origin = centre +
          Vec3{ 3 * uniform(random), 3 * uniform(random), 3 * uniform(random) } - 40 * direction;
        const double rate = Dot(direction, normal);
        const double expected = (offset - Dot(origin - centre, normal)) / rate;
        const Vec3 index = frame.Inverse().Point(origin + expected * direction);
        const double margin = DistanceToIndexBox(index, size);
        if (std::abs(margin) < 1e-3 || std::abs(rate) < 1e-3)
        {
          continue;
        }
        RayHit hit;
        const bool found = caster.CastRay(origin, direction, 0, hit);
        ASSERT_EQ(found, margin > 0 && Dot(direction, outwards) < 0);
        if (found)
        {
          const double tolerance =
            interpolation == FieldInterpolation::InterpolatingBSpline ? 2e-5 : 1e-9;
          ASSERT_NEAR(hit.Distance, expected, tolerance / std::abs(rate));
          ASSERT_NEAR(Norm(hit.Normal - outwards), 0, 100 * tolerance);
        }
      }
    }
  }
}

TEST(IsoRayCaster, MissesBesideASphere)
{
  const Vec3 centre{ 10, 10, 10 };
  const TestField field(
    { 21, 21, 21 }, Matrix4(), [&](const Vec3& p) { return Dot(p - centre, p - centre); });
  const IsoRayCaster caster = MakeCaster(field, FieldInterpolation::BSpline, SolidSide::Below);
  std::mt19937 random(12);
  for (int ray = 0; ray < 500; ++ray)
  {
    const Vec3 direction = RandomUnit(random);
    const Vec3 aside = Normalized(Cross(direction, RandomUnit(random)));
    for (const double gap : { 1e-3, 1e-7, 1e-11 })
    {
      RayHit hit;
      EXPECT_FALSE(caster.CastRay(centre + (5 + gap) * aside - 30 * direction, direction, 26, hit));
      ASSERT_TRUE(caster.CastRay(centre + (5 - gap) * aside - 30 * direction, direction, 26, hit));
      EXPECT_NEAR(hit.Distance, 30 - std::sqrt(25 - (5 - gap) * (5 - gap)), 1e-13 / gap + 1e-9);
    }
  }
}

TEST(IsoRayCaster, InterpolatingSplineGoesThroughTheVoxels)
{
  std::mt19937 random(13);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const std::array<int, 3> sizes[] = { { 9, 10, 21 }, { 2, 3, 40 }, { 4, 2, 2 } };
  for (const auto& size : sizes)
  {
    const TestField field(size, Matrix4(), [&](const Vec3&) { return uniform(random); });
    ThreadExecution execution(2);
    const SplineCoefficients coefficients = FilterToCoefficients(field.View(), true, execution);
    std::size_t i = 0;
    const TestField spline(size, Matrix4(), [&](const Vec3&) { return coefficients.Values[i++]; });
    for (int n = 0; n < size[0] * size[1] * size[2]; ++n)
    {
      const int x = n % size[0];
      const int y = n / size[0] % size[1];
      const int z = n / size[0] / size[1];
      ASSERT_NEAR(spline.BSpline({ 1.0 * x, 1.0 * y, 1.0 * z }), field.Voxels[n], 2e-6);
    }
  }
}

TEST(IsoRayCaster, DegenerateRaysSeeWhatTheirNeighboursSee)
{
  // along faces, edges and diagonals through corners, with the grid at integer coordinates
  const std::array<int, 3> size{ 20, 20, 20 };
  const Vec3 centre{ 9.5, 9, 10 };
  const TestField field(
    size, Matrix4(), [&](const Vec3& p) { return Dot(p - centre, p - centre); });
  const IsoRayCaster caster = MakeCaster(field, FieldInterpolation::BSpline, SolidSide::Below);
  const double radius = 6;
  for (int dx = -1; dx <= 1; ++dx)
  {
    for (int dy = -1; dy <= 1; ++dy)
    {
      for (int dz = -1; dz <= 1; ++dz)
      {
        if (dx == 0 && dy == 0 && dz == 0)
        {
          continue;
        }
        const Vec3 direction = Normalized({ 1.0 * dx, 1.0 * dy, 1.0 * dz });
        for (int x = 7; x <= 12; ++x)
        {
          for (int half = 0; half <= 1; ++half)
          {
            const Vec3 through{ x + 0.5 * half, 9, 10 };
            const Vec3 origin = through - 64 * direction;
            const Vec3 local = origin - centre;
            const double along = Dot(local, direction);
            const double square = along * along - Dot(local, local) + radius * radius;
            RayHit hit;
            ASSERT_TRUE(caster.CastRay(origin, direction, radius * radius + 1, hit));
            ASSERT_NEAR(hit.Distance, -along - std::sqrt(square), 1e-11);
          }
        }
      }
    }
  }
}

TEST(IsoRayCaster, RaysInTheOutermostFacesAreCast)
{
  // a field along x only; rays in all faces and edges of the volume, also off by rounding
  const std::array<int, 3> size{ 12, 6, 7 };
  const TestField field(size, Matrix4(), [](const Vec3& p) { return p[0]; });
  const IsoRayCaster caster = MakeCaster(field);
  for (const double y : { 0.0, 2.5, 5.0, -1e-13, 5 + 1e-13 })
  {
    for (const double z : { 0.0, 3.0, 6.0, -1e-13, 6 + 1e-13 })
    {
      RayHit hit;
      ASSERT_TRUE(caster.CastRay({ -5, y, z }, { 1, 0, 0 }, 4.25, hit)) << y << " " << z;
      EXPECT_NEAR(hit.Distance, 9.25, 1e-10);
      EXPECT_NEAR(hit.Normal[0], -1, 1e-12);
    }
  }
  RayHit hit;
  EXPECT_FALSE(caster.CastRay({ -5, -1e-3, 3 }, { 1, 0, 0 }, 4.25, hit));
  EXPECT_FALSE(caster.CastRay({ -5, 5.001, 3 }, { 1, 0, 0 }, 4.25, hit));
}

TEST(IsoRayCaster, BorderIsExtrapolatedLinearly)
{
  // in one dimension the natural rule makes the field meet the outermost voxel's value
  const std::array<int, 3> size{ 8, 5, 5 };
  const TestField field(size, Matrix4(), [](const Vec3& p) { return p[0] * p[0]; });
  const IsoRayCaster caster = MakeCaster(field);
  RayHit hit;
  // cell 0..1: control points -1, 0, 1, 4 (extrapolated, then samples): f = x + x^3 / 3
  const double x = 0.5;
  ASSERT_TRUE(caster.CastRay({ -3, 2, 2 }, { 1, 0, 0 }, x + x * x * x / 3, hit));
  EXPECT_NEAR(hit.Distance, 3.5, 1e-12);
  // interior: x^2 + 1/3
  ASSERT_TRUE(caster.CastRay({ -3, 2, 2 }, { 1, 0, 0 }, 3.7 * 3.7 + 1 / 3.0, hit));
  EXPECT_NEAR(hit.Distance, 6.7, 1e-12);
  ASSERT_TRUE(caster.CastRay({ -3, 2, 2 }, { 1, 0, 0 }, 49 - 1e-9, hit));
  EXPECT_NEAR(hit.Distance, 10, 1e-8);
}

TEST(IsoRayCaster, EnteringInsideIsNoSurface)
{
  // solid for x < 3 and for 8 < x < 12: the first is cut by the volume, the second is seen
  const auto ripple = [](const Vec3& p) { return p[0] < 5.5 ? 3 - p[0] : 2 - std::abs(p[0] - 10); };
  const TestField field({ 21, 6, 6 }, Matrix4(), ripple);
  for (const auto interpolation : AllInterpolations)
  {
    const IsoRayCaster caster = MakeCaster(field, interpolation);
    RayHit hit;
    ASSERT_TRUE(caster.CastRay({ -10, 2, 2 }, { 1, 0, 0 }, 0, hit));
    EXPECT_NEAR(hit.Distance, 18, 0.1);
    ASSERT_TRUE(caster.CastRay({ 30, 2, 2 }, { -1, 0, 0 }, 0, hit));
    EXPECT_NEAR(hit.Distance, 18, 0.1);
  }
  // leaving and entering again within one cell
  const TestField dip(
    { 6, 4, 4 }, Matrix4(), [](const Vec3& p) { return (p[0] - 2.5) * (p[0] - 2.5); });
  const IsoRayCaster caster = MakeCaster(dip);
  RayHit hit;
  ASSERT_TRUE(caster.CastRay({ -1, 1.5, 1.5 }, { 1, 0, 0 }, 0.04 + 1 / 3.0, hit));
  EXPECT_NEAR(hit.Distance, 3.5 + 0.2, 1e-10);
  // solid everywhere
  EXPECT_FALSE(caster.CastRay({ -1, 1.5, 1.5 }, { 1, 0, 0 }, -5, hit));
}

TEST(IsoRayCaster, CrossingsInTheFacesBetweenCells)
{
  // the crossing is in two cells at once, or by rounding in neither
  std::mt19937 random(15);
  std::uniform_real_distribution<double> uniform(1, 8);
  std::uniform_real_distribution<double> noise(-0.1, 0.1);
  for (int volume = 0; volume < 20; ++volume)
  {
    const Matrix4 frame = RandomFrame(random, { 0.7, 0.7, 0.7 }, volume % 2 != 0);
    const Matrix4 toIndex = frame.Inverse();
    const TestField rising(
      { 10, 10, 10 }, frame, [&](const Vec3& p) { return toIndex.Point(p)[0] + noise(random); });
    TestField falling = rising;
    for (double& v : falling.Voxels)
    {
      v = -v;
    }
    const IsoRayCaster entering = MakeCaster(rising);
    const IsoRayCaster leaving = MakeCaster(falling);
    for (int ray = 0; ray < 1000; ++ray)
    {
      const Vec3 index{ 1.0 + ray % 8, uniform(random), uniform(random) };
      const Vec3 direction = Normalized(frame.Vector({ 1, 3 * noise(random), 3 * noise(random) }));
      const Vec3 origin = frame.Point(index) - 30 * direction;
      const double isoValue = rising.BSpline(index);
      RayHit hit;
      ASSERT_TRUE(entering.CastRay(origin, direction, isoValue, hit));
      ASSERT_NEAR(hit.Distance, 30, 1e-11);
      ASSERT_FALSE(leaving.CastRay(origin, direction, -isoValue, hit)) << "an exit is no entry";
    }
  }
}

TEST(IsoRayCaster, PlateausAtTheIsoValueAreSolid)
{
  std::vector<std::uint8_t> voxels(16 * 4 * 4, 0);
  for (std::size_t i = 0; i < voxels.size(); ++i)
  {
    voxels[i] = i % 16 >= 8 ? 255 : 0; // saturated
  }
  VoxelVolume volume;
  volume.Voxels = voxels.data();
  volume.Type = ScalarType::UInt8;
  volume.Size = { 16, 4, 4 };
  ThreadExecution execution(1);
  const IsoRayCaster caster(volume, FieldInterpolation::BSpline, SolidSide::Above, execution);
  RayHit hit;
  ASSERT_TRUE(caster.CastRay({ -1, 1.3, 1.7 }, { 1, 0, 0 }, 255, hit));
  EXPECT_NEAR(hit.Distance, 10, 1e-4) << "the spline reaches 255 at voxel 9";
  EXPECT_NEAR(Norm(hit.Normal), 1, 1e-12);
  EXPECT_FALSE(caster.CastRay({ 20, 1.3, 1.7 }, { -1, 0, 0 }, 255, hit)) << "cut by the volume";
}

TEST(IsoRayCaster, NonFiniteVoxelsAreEmpty)
{
  TestField field({ 12, 12, 12 }, Matrix4(), [](const Vec3& p) { return 100 * p[2]; });
  field.Voxels[5 + 12 * (5 + 12 * 9)] = std::numeric_limits<double>::quiet_NaN();
  field.Voxels[6 + 12 * (5 + 12 * 9)] = std::numeric_limits<double>::infinity();
  TestField filled = field;
  filled.Voxels[5 + 12 * (5 + 12 * 9)] = 0;
  filled.Voxels[6 + 12 * (5 + 12 * 9)] = 0;
  for (const auto interpolation : AllInterpolations)
  {
    const IsoRayCaster caster = MakeCaster(field, interpolation);
    const IsoRayCaster reference = MakeCaster(filled, interpolation);
    EXPECT_EQ(caster.GetNumberOfNonFiniteVoxels(), 2);
    EXPECT_EQ(caster.GetMinimum(), 0);
    EXPECT_EQ(caster.GetMaximum(), 1100);
    for (double x = 3; x < 9; x += 0.3)
    {
      RayHit hit;
      RayHit expected;
      ASSERT_TRUE(caster.CastRay({ x, 5.2, -5 }, { 0, 0, 1 }, 850, hit));
      ASSERT_TRUE(reference.CastRay({ x, 5.2, -5 }, { 0, 0, 1 }, 850, expected));
      EXPECT_EQ(hit.Distance, expected.Distance);
    }
  }
  const TestField nothing({ 4, 4, 4 }, Matrix4(), [](const Vec3&) { return std::nan(""); });
  for (const auto interpolation : AllInterpolations)
  {
    const IsoRayCaster caster = MakeCaster(nothing, interpolation);
    RayHit hit;
    EXPECT_FALSE(caster.CastRay({ 1, 1, -5 }, { 0, 0, 1 }, 0, hit));
    EXPECT_EQ(caster.GetNumberOfNonFiniteVoxels(), 64);
  }
}

TEST(IsoRayCaster, SmallestVolume)
{
  const TestField field({ 2, 2, 2 }, Matrix4(), [](const Vec3& p) { return p[1]; });
  for (const auto interpolation : AllInterpolations)
  {
    const IsoRayCaster caster = MakeCaster(field, interpolation);
    RayHit hit;
    ASSERT_TRUE(caster.CastRay({ 0.3, -2, 0.8 }, { 0, 1, 0 }, 0.75, hit));
    EXPECT_NEAR(hit.Distance, 2.75, 1e-7);
  }
  const TestField flat({ 5, 5, 1 }, Matrix4(), [](const Vec3& p) { return p[1]; });
  EXPECT_THROW(MakeCaster(flat), std::invalid_argument);
  TestField singular = field;
  singular.IndexToWorld = Matrix4::Scaling({ 1, 0, 1 });
  EXPECT_THROW(MakeCaster(singular), std::invalid_argument);
}

TEST(IsoRayCaster, SameBitsForAnyThreadsAndExtent)
{
  std::mt19937 random(14);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const TestField field({ 21, 22, 23 }, RandomFrame(random, { 1, 0.9, 1.3 }, true),
    [&](const Vec3&) { return uniform(random); });
  ViewSettings view;
  view.Direction = { 0.3, 0.4, -0.7 };
  view.PixelSpacing = 0.4;
  const ImagePlane plane = MakeImagePlane(field.IndexToWorld, field.Size, view);
  const int width = plane.Size[0];
  const int height = plane.Size[1];
  const auto cast = [&](const std::array<int, 4>& e, int threads, std::vector<double>& depth,
                      std::vector<char>& valid, std::vector<float>& normals)
  {
    ThreadExecution execution(threads);
    const IsoRayCaster caster(
      field.View(), FieldInterpolation::BSpline, SolidSide::Above, execution);
    const std::size_t n = static_cast<std::size_t>(e[1] - e[0] + 1) * (e[3] - e[2] + 1);
    depth.assign(n, 0);
    valid.assign(n, 0);
    normals.assign(3 * n, 0);
    caster.Cast(plane, 0.2, { e, depth.data(), valid.data(), normals.data() }, execution);
  };
  const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  std::vector<double> depth;
  std::vector<char> valid;
  std::vector<float> normals;
  cast({ 0, width - 1, 0, height - 1 }, 1, depth, valid, normals);
  const auto hits = std::count(valid.begin(), valid.end(), 1);
  EXPECT_GT(hits, width * height / 4);
  for (const int threads : { 2, 5 })
  {
    std::vector<double> d;
    std::vector<char> v;
    std::vector<float> n;
    cast({ 0, width - 1, 0, height - 1 }, threads, d, v, n);
    EXPECT_TRUE(std::equal(d.begin(), d.end(), depth.begin(), same));
    EXPECT_EQ(v, valid);
    EXPECT_EQ(n, normals);
  }
  const std::array<int, 4> part{ 7, width - 9, 5, height / 2 };
  std::vector<double> d;
  std::vector<char> v;
  std::vector<float> n;
  cast(part, 2, d, v, n);
  std::size_t i = 0;
  for (int row = part[2]; row <= part[3]; ++row)
  {
    for (int column = part[0]; column <= part[1]; ++column, ++i)
    {
      const std::size_t whole = column + static_cast<std::size_t>(width) * row;
      ASSERT_TRUE(same(d[i], depth[whole]));
      ASSERT_EQ(v[i], valid[whole]);
      ASSERT_EQ(n[3 * i + 1], normals[3 * whole + 1]);
    }
  }
}

TEST(IsoRayCaster, Aborts)
{
  ThreadExecution execution(2, [](double) { return false; });
  const TestField field({ 4, 4, 4 }, Matrix4(), [](const Vec3& p) { return p[1]; });
  EXPECT_THROW(
    IsoRayCaster(field.View(), FieldInterpolation::BSpline, SolidSide::Above, execution), Aborted);
}
