// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaIsoRayCaster.h"
#include "lacunaTestField.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

namespace
{
using namespace lacuna;

struct Map
{
  ImagePlane Plane;
  std::vector<double> Depth;
  std::vector<char> Valid;
  std::vector<float> Normals;
  std::vector<double> Thickness;

  Map(const ImagePlane& plane, const IsoRayCaster& caster, double isoValue, RayRequest request)
    : Plane(plane)
  {
    const std::size_t n = static_cast<std::size_t>(plane.Size[0]) * plane.Size[1];
    this->Depth.resize(n);
    this->Valid.resize(n);
    this->Normals.resize(3 * n);
    this->Thickness.resize(n);
    request.Thickness = this->Thickness.data();
    ThreadExecution execution(2);
    caster.Cast(plane, isoValue,
      { { 0, plane.Size[0] - 1, 0, plane.Size[1] - 1 }, this->Depth.data(), this->Valid.data(),
        this->Normals.data() },
      request, execution);
  }

  Vec3 Position(std::size_t i) const
  {
    const int w = this->Plane.Size[0];
    return this->Plane.PixelPosition(static_cast<int>(i) % w, static_cast<int>(i) / w);
  }
  std::size_t Middle() const
  {
    const std::size_t w = this->Plane.Size[0];
    return this->Plane.Size[1] / 2 * w + w / 2;
  }
  Vec3 Normal(std::size_t i) const
  {
    return { this->Normals[3 * i], this->Normals[3 * i + 1], this->Normals[3 * i + 2] };
  }
};

/// A ball: where the field is at most radius^2 + 1 the sampled quadratic is an exact sphere.
const Vec3 Centre{ 11, 12, 13 };
constexpr double Radius = 7.3;

TestField Ball()
{
  return { { 24, 26, 28 }, Matrix4(), [](const Vec3& p) { return Dot(p - Centre, p - Centre); } };
}

IsoRayCaster BallCaster(const TestField& field)
{
  ThreadExecution execution(2);
  return { field.View(), FieldInterpolation::BSpline, SolidSide::Below, execution };
}

constexpr double BallValue = Radius * Radius + 1;

/// Where a unit ray meets the sphere: entry and exit; false when it misses.
bool MeetSphere(const Vec3& origin, const Vec3& direction, double& entry, double& exit)
{
  const double middle = Dot(Centre - origin, direction);
  const Vec3 aside = origin + middle * direction - Centre;
  const double square = Radius * Radius - Dot(aside, aside);
  entry = middle - std::sqrt(std::max(square, 0.0));
  exit = middle + std::sqrt(std::max(square, 0.0));
  return square > 1e-9;
}

ImagePlane PlaneFor(const TestField& field, const Vec3& direction, double spacing)
{
  ViewSettings view;
  view.Direction = direction;
  view.Up = { 0.1, 1, 0.3 };
  view.PixelSpacing = spacing;
  return MakeImagePlane(field.IndexToWorld, field.Size, view);
}

/// Along z: solid between 4 and 8 and between 14 and 20, as seen through the cubic field.
TestField Layers()
{
  return { { 9, 8, 26 }, Matrix4(), [](const Vec3& p) {
            return (p[2] > 3.5 && p[2] < 8.5) || (p[2] > 13.5 && p[2] < 20.5) ? 1.0 : 0.0;
          } };
}
}

TEST(RayRequest, PerspectiveSphereIsExact)
{
  const TestField field = Ball();
  const IsoRayCaster caster = BallCaster(field);
  std::mt19937 random(2);
  for (int trial = 0; trial < 12; ++trial)
  {
    const Vec3 away = RandomUnit(random);
    const double distance = trial % 3 == 0 ? 9 : 60; // within the volume, or far from it
    const Vec3 eye = Centre + distance * away;
    ViewSettings view;
    view.Direction = -1 * away;
    view.Up = RandomUnit(random);
    view.Size = { 33, 41 };
    const ImagePlane plane = MakePerspectivePlane(
      CornersOf(field.IndexToWorld, field.Size), 1, view, eye, distance < 10 ? 100 : 20);
    RayRequest request;
    request.Eye = &eye;
    const Map map(plane, caster, BallValue, request);
    int hits = 0;
    for (std::size_t i = 0; i < map.Depth.size(); ++i)
    {
      const Vec3 pixel = map.Position(i);
      const Vec3 ray = Normalized(pixel - eye);
      double entry;
      double exit;
      const bool meets = MeetSphere(eye, ray, entry, exit);
      ASSERT_EQ(map.Valid[i] != 0, meets) << trial << " " << i;
      if (meets)
      {
        ++hits;
        const double depth = entry - Norm(pixel - eye);
        ASSERT_NEAR(map.Depth[i], depth, 1e-9);
        ASSERT_NEAR(map.Thickness[i], exit - entry, 1e-8);
        const Vec3 normal = (1 / Radius) * (eye + entry * ray - Centre);
        ASSERT_LT(Norm(map.Normal(i) - normal), 2e-7);
      }
    }
    EXPECT_GT(hits, 100);
  }
}

TEST(RayRequest, PerspectivePlanes)
{
  const TestField field = Ball();
  const auto corners = CornersOf(field.IndexToWorld, field.Size);
  ViewSettings view;
  view.Direction = { 0, 0, 2 };
  const Vec3 eye{ 11, 12, -100 };
  ImagePlane plane = MakePerspectivePlane(corners, 0.5, view, eye, 30);
  EXPECT_NEAR(plane.Origin[2], 0, 1e-9) << "through the nearest corner";
  const double height = 200 * std::tan(15 * 3.14159265358979 / 180);
  EXPECT_EQ(plane.Size[1], std::round(height / 0.5));
  EXPECT_EQ(plane.Size[0], plane.Size[1]);
  EXPECT_NEAR(ViewAngleOf(plane, eye), 30, 0.3);
  view.Size = { 100, 50 };
  plane = MakePerspectivePlane(corners, 0.5, view, eye, 30);
  EXPECT_NEAR(plane.PixelSpacing, height / 50, 1e-12);
  EXPECT_NEAR(ViewAngleOf(plane, eye), 30, 1e-9);
  const Vec3 middle = 0.5 * (plane.PixelPosition(0, 0) + plane.PixelPosition(99, 49));
  EXPECT_LT(Norm(middle - Vec3{ 11, 12, 0 }), 1e-9);
  plane = MakePerspectivePlane(corners, 0.5, view, Centre, 30);
  EXPECT_GT(plane.Origin[2], Centre[2]) << "an eye among the data looks forwards";

  EXPECT_THROW(
    MakePerspectivePlane(corners, 0.5, view, { 11, 12, 100 }, 30), std::invalid_argument);
  EXPECT_THROW(MakePerspectivePlane(corners, 0.5, view, eye, 0), std::invalid_argument);
  EXPECT_THROW(MakePerspectivePlane(corners, 0.5, view, eye, 180), std::invalid_argument);
  EXPECT_THROW(
    MakePerspectivePlane(corners, 0.5, view, { 0, 0, std::nan("") }, 30), std::invalid_argument);
  view.HasFocalPoint = true;
  view.FocalPoint = { 11, 12, -101 };
  EXPECT_THROW(MakePerspectivePlane(corners, 0.5, view, eye, 30), std::invalid_argument);
  view.HasFocalPoint = false;
  view.Size = { 0, 0 };
  view.PixelSpacing = 1e-12;
  EXPECT_THROW(MakePerspectivePlane(corners, 0.5, view, eye, 30), std::invalid_argument);
}

TEST(RayRequest, NextLayerExitSideAndThickness)
{
  const TestField field = Layers();
  ThreadExecution execution(2);
  for (const FieldInterpolation interpolation :
    { FieldInterpolation::BSpline, FieldInterpolation::Trilinear })
  {
    const IsoRayCaster caster(field.View(), interpolation, SolidSide::Above, execution);
    const IsoRayCaster reversed(field.View(), interpolation, SolidSide::Below, execution);
    for (const Vec3& direction : { Vec3{ 0, 0, 1 }, Normalized(Vec3{ 0.05, -0.08, 1 }) })
    {
      const ImagePlane plane = PlaneFor(field, direction, 0.61);
      const Map first(plane, caster, 0.5, {});
      RayRequest request;
      request.StartDepth = first.Depth.data();
      const Map second(plane, caster, 0.5, request);
      const Map far(plane, reversed, 0.5, request);
      request.StartDepth = second.Depth.data();
      const Map third(plane, caster, 0.5, request);
      int checked = 0;
      for (std::size_t i = 0; i < first.Depth.size(); ++i)
      {
        const auto z = [&](double depth) { return (first.Position(i) + depth * direction)[2]; };
        if (!second.Valid[i])
        {
          continue; // beside the volume
        }
        ++checked;
        ASSERT_NEAR(z(first.Depth[i]), 3.5, 1e-9);
        ASSERT_NEAR(z(second.Depth[i]), 13.5, 1e-9);
        if (far.Valid[i])
        {
          ASSERT_NEAR(z(far.Depth[i]), 8.5, 1e-9);
          ASSERT_NEAR(first.Thickness[i], 5 / direction[2], 2e-9);
          ASSERT_NEAR(far.Depth[i], first.Depth[i] + first.Thickness[i], 2e-9);
        }
        ASSERT_FALSE(third.Valid[i]);
      }
      EXPECT_GT(checked, 50);
    }
  }
}

TEST(RayRequest, ThicknessOfWhatTheVolumeCutsIsNotKnown)
{
  const TestField field(
    { 6, 6, 12 }, Matrix4(), [](const Vec3& p) { return p[2] > 6.5 ? 1.0 : 0.0; });
  ThreadExecution execution(1);
  const IsoRayCaster caster(field.View(), FieldInterpolation::BSpline, SolidSide::Above, execution);
  const ImagePlane plane = PlaneFor(field, { 0, 0, 1 }, 1.0);
  Map map(plane, caster, 0.5, {});
  EXPECT_NEAR(map.Depth[map.Middle()], 6.5, 1e-9);
  EXPECT_TRUE(std::isnan(map.Thickness[map.Middle()]));
  // where it is cut away it ends
  const ConvexRegion behind(Matrix4(), { { { 0, 0, 9 }, { 0, 0, -1 } } });
  RayRequest request;
  request.CutAway = &behind;
  map = Map(plane, caster, 0.5, request);
  EXPECT_NEAR(map.Depth[map.Middle()], 6.5, 1e-9);
  EXPECT_NEAR(map.Thickness[map.Middle()], 2.5, 1e-9);
}

TEST(RayRequest, CutsAreCapped)
{
  const TestField field = Ball();
  const IsoRayCaster caster = BallCaster(field);
  std::mt19937 random(9);
  const Vec3 direction = Normalized(Vec3{ 0.2, -0.1, 1 });
  const ImagePlane plane = PlaneFor(field, direction, 0.43);
  for (int trial = 0; trial < 8; ++trial)
  {
    Vec3 normal = RandomUnit(random); // out of the cut, into what stays
    if (Dot(normal, direction) < 0)
    {
      normal = -1 * normal;
    }
    const Vec3 origin = Centre + (trial - 4.0) * normal;
    const ConvexRegion exact(Matrix4(), { { origin, normal } });
    const FunctionRegion sampled([&](const Vec3& p) { return Dot(p - origin, normal); }, 0.5);
    RayRequest request;
    request.CutAway = &exact;
    const Map capped(plane, caster, BallValue, request);
    request.CutAway = &sampled;
    const Map same(plane, caster, BallValue, request);
    request.CapCutAway = false;
    const Map open(plane, caster, BallValue, request);
    int caps = 0;
    for (std::size_t i = 0; i < capped.Depth.size(); ++i)
    {
      const Vec3 pixel = capped.Position(i);
      double entry;
      double exit;
      const bool meets = MeetSphere(pixel, direction, entry, exit);
      const double cut = Dot(origin - pixel, normal) / Dot(direction, normal);
      if (!meets || std::abs(cut - exit) < 1e-6 || std::abs(cut - entry) < 1e-6)
      {
        continue;
      }
      ASSERT_EQ(capped.Valid[i] != 0, cut < exit) << trial;
      ASSERT_EQ(open.Valid[i] != 0, cut < entry) << trial;
      if (cut < exit)
      {
        ASSERT_NEAR(capped.Depth[i], std::max(cut, entry), 1e-9);
        ASSERT_NEAR(capped.Thickness[i], exit - std::max(cut, entry), 1e-8);
        ASSERT_NEAR(same.Depth[i], capped.Depth[i], 1e-9);
        if (cut > entry)
        {
          ++caps;
          ASSERT_LT(Norm(capped.Normal(i) + normal), 2e-7) << "towards the viewer";
          ASSERT_LT(Norm(same.Normal(i) + normal), 1e-5);
        }
      }
    }
    EXPECT_GT(caps, trial == 0 ? 0 : 20) << trial;
  }
}

/// A ball taken out of the middle: rays go on behind it, and hit its far wall.
TEST(RayRequest, RaysGoOnBehindAHole)
{
  const TestField field = Ball();
  const IsoRayCaster caster = BallCaster(field);
  const Vec3 direction = Normalized(Vec3{ -0.3, 0.2, -1 });
  const ImagePlane plane = PlaneFor(field, direction, 0.31);
  // cut open from the viewer's side, so that the hole is seen
  const Vec3 centre = Centre - 5 * direction;
  constexpr double radius = 4;
  const RoundRegion hole(Matrix4(), centre, { 0, 0, 0 }, radius);
  // the same by a transform
  const RoundRegion moved(Matrix4::Scaling({ 0.5, 0.5, 0.5 }) * Matrix4::Translation(-1 * centre),
    { 0, 0, 0 }, { 0, 0, 0 }, 0.5 * radius);
  RayRequest request;
  request.CutAway = &hole;
  const Map map(plane, caster, BallValue, request);
  request.CutAway = &moved;
  const Map same(plane, caster, BallValue, request);
  int inHole = 0;
  for (std::size_t i = 0; i < map.Depth.size(); ++i)
  {
    const Vec3 pixel = map.Position(i);
    double entry;
    double exit;
    const double middle = Dot(centre - pixel, direction);
    const Vec3 aside = pixel + middle * direction - centre;
    const double half = std::sqrt(std::max(radius * radius - Dot(aside, aside), 0.0));
    if (!MeetSphere(pixel, direction, entry, exit) || std::abs(entry - middle + half) < 1e-6 ||
      std::abs(entry - middle - half) < 1e-6)
    {
      continue;
    }
    const bool opened = half > 0 && middle - half < entry && entry < middle + half;
    ASSERT_TRUE(map.Valid[i]);
    ASSERT_NEAR(map.Depth[i], opened ? middle + half : entry, 1e-9);
    ASSERT_NEAR(same.Depth[i], map.Depth[i], 1e-9);
    if (opened)
    {
      ++inHole;
      const Vec3 normal = (1 / radius) * (centre - (pixel + map.Depth[i] * direction));
      ASSERT_LT(Norm(map.Normal(i) - normal), 3e-7);
      ASSERT_LT(Norm(same.Normal(i) - normal), 3e-7);
    }
  }
  EXPECT_GT(inHole, 100);
}

TEST(RayRequest, BoundariesAreCappedWhenAsked)
{
  const TestField field(
    { 8, 9, 10 }, Matrix4::Scaling({ 1, 2, 1 }), [](const Vec3& p) { return 4.2 - p[2]; });
  ThreadExecution execution(2);
  const IsoRayCaster caster(field.View(), FieldInterpolation::BSpline, SolidSide::Above, execution);
  RayRequest request;
  request.CapBoundary = true;
  const Map along(PlaneFor(field, { 0, 0, 1 }, 0.9), caster, 0, request);
  for (std::size_t i = 0; i < along.Depth.size(); ++i)
  {
    if (along.Valid[i])
    {
      ASSERT_EQ(along.Depth[i], 0);
      ASSERT_LT(Norm(along.Normal(i) - Vec3{ 0, 0, -1 }), 1e-9);
      ASSERT_NEAR(along.Thickness[i], 4.2, 1e-9);
    }
  }
  EXPECT_TRUE(along.Valid[along.Middle()]);
  const Map without(PlaneFor(field, { 0, 0, 1 }, 0.9), caster, 0, {});
  EXPECT_FALSE(without.Valid[without.Middle()]);
  const Vec3 direction = Normalized(Vec3{ 0.2, 1, -0.1 });
  const Map aside(PlaneFor(field, direction, 0.7), caster, 0, request);
  int capped = 0;
  for (std::size_t i = 0; i < aside.Depth.size(); ++i)
  {
    const Vec3 p = aside.Position(i) + aside.Depth[i] * direction;
    if (aside.Valid[i] && p[2] < 4.19)
    {
      ++capped;
      const bool front = std::abs(p[1]) < 1e-9;
      ASSERT_TRUE(front || std::abs(p[0]) < 1e-9);
      ASSERT_LT(Norm(aside.Normal(i) - (front ? Vec3{ 0, -1, 0 } : Vec3{ -1, 0, 0 })), 1e-9);
    }
  }
  EXPECT_GT(capped, 20);
}

/// Grey-level normals of a sampled quadratic: central differences are exact, and linear.
TEST(RayRequest, GreyLevelNormals)
{
  const TestField field = Ball();
  ThreadExecution execution(2);
  for (const FieldInterpolation interpolation : { FieldInterpolation::BSpline,
         FieldInterpolation::InterpolatingBSpline, FieldInterpolation::Trilinear })
  {
    const IsoRayCaster caster(field.View(), interpolation, SolidSide::Below, execution);
    RayRequest request;
    request.Normals = SurfaceNormal::GreyLevel;
    const Vec3 direction = Normalized(Vec3{ 0.3, 0.1, 1 });
    const Map map(PlaneFor(field, direction, 0.77), caster, BallValue, request);
    int hits = 0;
    for (std::size_t i = 0; i < map.Depth.size(); ++i)
    {
      if (map.Valid[i])
      {
        ++hits;
        const Vec3 expected = Normalized(map.Position(i) + map.Depth[i] * direction - Centre);
        ASSERT_LT(Norm(map.Normal(i) - expected), 2e-7);
      }
    }
    EXPECT_GT(hits, 100);
  }
}
