// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDepthNormals.h"
#include "lacunaDepthShader.h"
#include "lacunaTestField.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{
using namespace lacuna;

constexpr double None = std::numeric_limits<double>::quiet_NaN();
constexpr double Pi = 3.14159265358979323846;

int Byte(double intensity)
{
  return static_cast<int>(std::floor(255 * std::min(std::max(intensity, 0.0), 1.0) + 0.5));
}

/// Seen from the top: right = x, down = -y, view = -z, the plane at z = 40.
struct Map
{
  int Width;
  int Height;
  std::vector<double> Depth;
  std::vector<float> Normals;
  DepthGrid Grid;

  Map(int width, int height, double spacing = 1)
    : Width(width)
    , Height(height)
    , Depth(static_cast<std::size_t>(width) * height, None)
    , Normals(3 * this->Depth.size(), 0)
  {
    this->Grid.Depth = this->Depth.data();
    this->Grid.Extent = { 0, width - 1, 0, height - 1 };
    this->Grid.ImageToWorld =
      Matrix4::FromColumns({ spacing, 0, 0 }, { 0, -spacing, 0 }, { 0, 0, -1 }, { 0, 0, 40 });
  }
  Map(const Map&) = delete;

  void Set(std::size_t i, double depth, const Vec3& normal)
  {
    this->Depth[i] = depth;
    for (int a = 0; a < 3; ++a)
    {
      this->Normals[3 * i + a] = static_cast<float>(normal[a]);
    }
  }

  /// A ball around a point of the world, nearer than what is there.
  void AddBall(const Vec3& centre, double radius)
  {
    for (std::size_t i = 0; i < this->Depth.size(); ++i)
    {
      const Vec3 pixel = this->Grid.ImageToWorld.Point(
        { static_cast<double>(i % this->Width), static_cast<double>(i / this->Width), 0 });
      const Vec3 d = pixel - centre;
      const double rest = radius * radius - d[0] * d[0] - d[1] * d[1];
      if (rest > 0)
      {
        const double depth = d[2] - std::sqrt(rest);
        const Vec3 point = pixel + Vec3{ 0, 0, -depth };
        this->Set(i, depth, (1 / radius) * (point - centre));
      }
    }
  }

  std::vector<unsigned char> Shade(
    const ShadingSettings& settings, const ShadowCaster& shadows = {}, int threads = 2) const
  {
    std::vector<unsigned char> colors(3 * this->Depth.size(), 77);
    ThreadExecution execution(threads);
    ShadeDepths(this->Grid, this->Normals.data(), settings, shadows, this->Grid.Extent,
      colors.data(), execution);
    return colors;
  }
};

/// A plane z = 4 and a ball above it, both exact where the spline's support meets only one of them:
/// samples of r^2 give r^2 + 1.
struct BallOnPlane
{
  static constexpr double Ground = 4;
  static constexpr double Radius = 8;
  Vec3 Centre{ 14, 22, 18 };
  TestField Field{ { 66, 46, 32 }, Matrix4(),
    [this](const Vec3& p)
    {
      const Vec3 d = p - this->Centre;
      return std::max(Ground - p[2], 0.05 * (Radius * Radius + 1 - Dot(d, d)));
    } };
  ThreadExecution Execution{ 2 };
  VoxelVolume Volume = Field.View();
  IsoRayCaster Caster{ Volume, FieldInterpolation::BSpline, SolidSide::Above, Execution };
  ImagePlane Plane;
  std::vector<double> Depth;
  std::vector<float> Normals;
  DepthGrid Grid;

  BallOnPlane()
  {
    ViewSettings view;
    view.PixelSpacing = 0.25;
    this->Plane = MakeImagePlane(Matrix4(), this->Field.Size, view);
    const std::size_t pixels = static_cast<std::size_t>(this->Plane.Size[0]) * this->Plane.Size[1];
    this->Depth.resize(pixels);
    this->Normals.resize(3 * pixels);
    this->Grid.Extent = { 0, this->Plane.Size[0] - 1, 0, this->Plane.Size[1] - 1 };
    this->Caster.Cast(this->Plane, 0,
      { this->Grid.Extent, this->Depth.data(), nullptr, this->Normals.data() }, this->Execution);
    this->Grid.Depth = this->Depth.data();
    this->Grid.ImageToWorld = Matrix4::FromColumns(
      0.25 * this->Plane.Right, 0.25 * this->Plane.Down, this->Plane.View, this->Plane.Origin);
  }
};
}

TEST(DepthShader, DepthIntensityEndsAndLaws)
{
  for (const DepthLaw law : { DepthLaw::InverseSquare, DepthLaw::Inverse })
  {
    EXPECT_EQ(DepthIntensity(0, law), 1);
    EXPECT_EQ(DepthIntensity(1, law), 0);
    EXPECT_EQ(DepthIntensity(-3, law), 1);
    EXPECT_EQ(DepthIntensity(7, law), 0);
    for (double u = 0; u < 1; u += 0.01)
    {
      EXPECT_GT(DepthIntensity(u, law), DepthIntensity(u + 0.01, law));
    }
  }
  EXPECT_NEAR(DepthIntensity(0.5, DepthLaw::InverseSquare), (1 / 2.25 - 0.25) / 0.75, 1e-15);
  EXPECT_NEAR(DepthIntensity(0.5, DepthLaw::Inverse), (1 / 1.5 - 0.5) / 0.5, 1e-15);
}

TEST(DepthShader, DepthOnlyIsNormalisedOverTheSphere)
{
  // the sphere reaches from depth 5 to 25
  Map map(6, 1);
  const double depths[] = { 4, 5, 15, 25, 30, None };
  for (int i = 0; i < 6; ++i)
  {
    map.Depth[i] = depths[i];
  }
  ShadingSettings settings;
  settings.Model = ShadingModel::DepthOnly;
  settings.Data = { { 100, 7, 25 }, 10 };
  settings.SurfaceColor = { 1, 0.5, 0 };
  settings.BackgroundColor = { 0, 0.2, 0.4 };
  std::vector<unsigned char> colors(18);
  ThreadExecution execution(1);
  ShadeDepths(map.Grid, nullptr, settings, {}, map.Grid.Extent, colors.data(), execution);
  const double middle = (1 / 2.25 - 0.25) / 0.75;
  const double expected[] = { 1, 1, middle, 0, 0 };
  for (int i = 0; i < 5; ++i)
  {
    EXPECT_EQ(colors[3 * i], Byte(expected[i])) << i;
    EXPECT_EQ(colors[3 * i + 1], Byte(0.5 * expected[i])) << i;
    EXPECT_EQ(colors[3 * i + 2], 0) << i;
  }
  EXPECT_EQ(colors[15], 0);
  EXPECT_EQ(colors[16], 51);
  EXPECT_EQ(colors[17], 102);
  settings.Law = DepthLaw::Inverse;
  EXPECT_EQ(map.Shade(settings)[6], Byte(1.0 / 3));

  // in perspective it is the distance from the eye that counts: here 50 to the centre of a sphere of
  // 10, on a ray that is not the middle one
  map.Grid.Perspective = true;
  map.Grid.Eye = { 2, 0, 45 };
  settings.Data = { map.Grid.Eye + 50.0 * map.Grid.RayOf(5, 0), 10 };
  const double plane = Norm(map.Grid.ImageToWorld.Point({ 5, 0, 0 }) - map.Grid.Eye);
  for (const double u : { 0.0, 0.25, 1.0 })
  {
    map.Depth[5] = 40 + 20 * u - plane;
    EXPECT_EQ(map.Shade(settings)[15], Byte(2 / (1 + u) - 1)) << u;
  }
  // an eye within the sphere sees from distance 0 on
  settings.Data = { map.Grid.Eye, 30 };
  map.Depth[5] = 15 - plane;
  EXPECT_EQ(map.Shade(settings)[15], Byte(1.0 / 3));
}

TEST(DepthShader, CueFadesToItsEndValue)
{
  Map map(3, 1);
  for (int i = 0; i < 3; ++i)
  {
    map.Set(i, 5 + 10 * i, { 0, 0, 1 });
  }
  ShadingSettings settings;
  settings.Ambient = 0.2;
  settings.Diffuse = 0.6;
  settings.Specular = 0;
  settings.Data = { { 0, 0, 25 }, 10 };
  const double middle = (1 / 2.25 - 0.25) / 0.75;
  for (const double cue : { 0.0, 0.5, 1.0 })
  {
    settings.DepthCue = cue;
    const std::vector<unsigned char> colors = map.Shade(settings);
    EXPECT_EQ(colors[0], Byte(0.8));
    EXPECT_EQ(colors[3], Byte(0.8 * (1 - cue * (1 - middle))));
    EXPECT_EQ(colors[6], Byte(0.8 * (1 - cue)));
  }
  settings.Data = Sphere();
  EXPECT_EQ(map.Shade(settings)[6], Byte(0.8)) << "no range: nothing is far";
}

TEST(DepthShader, CircumscribedSphereOfTheMap)
{
  Map map(5, 4, 2);
  ThreadExecution execution(2);
  EXPECT_EQ(CircumscribedSphere(map.Grid, execution).Radius, 0);
  map.Depth[1 + 5 * 1] = 10; // 2 -2 30
  map.Depth[4 + 5 * 3] = 30; // 8 -6 10
  map.Depth[2 + 5 * 2] = 20;
  const Sphere sphere = CircumscribedSphere(map.Grid, execution);
  EXPECT_NEAR(Norm(sphere.Centre - Vec3{ 5, -4, 20 }), 0, 1e-12);
  EXPECT_NEAR(sphere.Radius, std::sqrt(9 + 4 + 100.0), 1e-12);
}

TEST(DepthShader, PhongAgainstTheFormula)
{
  Map map(41, 41);
  map.AddBall({ 20, -20, 20 }, 15);
  ShadingSettings settings;
  settings.Ambient = 0.15;
  settings.Diffuse = 0.5;
  settings.Specular = 0.3;
  settings.SpecularPower = 12;
  settings.SurfaceColor = { 0.9, 0.6, 0.3 };
  const auto check = [&](const std::vector<unsigned char>& colors)
  {
    for (std::size_t i = 0; i < map.Depth.size(); ++i)
    {
      if (std::isnan(map.Depth[i]))
      {
        EXPECT_EQ(colors[3 * i], 0);
        continue;
      }
      const Vec3 n{ map.Normals[3 * i], map.Normals[3 * i + 1], map.Normals[3 * i + 2] };
      const Vec3 point =
        map.Grid.PointOf(static_cast<int>(i % map.Width), static_cast<int>(i / map.Width));
      const Vec3 viewer{ 0, 0, 1 };
      std::vector<ShaderLight> lights = settings.Lights;
      if (lights.empty())
      {
        lights.push_back({ viewer, false, 1 });
      }
      double diffuse = 0;
      double specular = 0;
      for (const ShaderLight& light : lights)
      {
        const Vec3 l = Normalized(light.IsPosition ? light.Place - point : light.Place);
        const double cosine = Dot(n, l);
        if (cosine > 0)
        {
          diffuse += light.Intensity * cosine;
          // angle between the mirrored light and the viewer
          const Vec3 mirrored = 2 * cosine * n - l;
          specular += light.Intensity * std::pow(std::max(0.0, Dot(mirrored, viewer)), 12);
        }
      }
      for (int a = 0; a < 3; ++a)
      {
        const double intensity = settings.SurfaceColor[a] * (0.15 + 0.5 * diffuse) + 0.3 * specular;
        ASSERT_NEAR(colors[3 * i + a], 255 * std::min(1.0, intensity), 0.5001) << i;
      }
    }
  };
  const std::vector<unsigned char> front = map.Shade(settings);
  check(front);
  EXPECT_EQ(front[3 * (20 + 41 * 20)], Byte(0.9 * 0.65 + 0.3)) << "facing the viewer";
  settings.Lights = { { { 5, 0, 0 }, false, 0.7 }, { { 10, 30, 60 }, true, 0.9 } };
  check(map.Shade(settings));
}

TEST(DepthShader, LightFromASideShowsOnThatSide)
{
  // world x is the viewer's right and world y up; the small ball sits at the upper left
  Map map(61, 41);
  map.AddBall({ 40, -25, 15 }, 12);
  map.AddBall({ 10, -8, 20 }, 5);
  const auto at = [&](const std::vector<unsigned char>& colors, double x, double y)
  { return static_cast<int>(colors[3 * (static_cast<int>(x) + 61 * static_cast<int>(-y))]); };
  ShadingSettings settings;
  settings.Specular = 0;
  settings.Lights = { { { 1, 0, 0.2 }, false, 1 } };
  std::vector<unsigned char> colors = map.Shade(settings);
  EXPECT_GT(at(colors, 48, -25), at(colors, 32, -25) + 50) << "light from the right";
  EXPECT_GT(at(colors, 13, -8), at(colors, 7, -8) + 50);
  EXPECT_EQ(at(colors, 40, -17), at(colors, 40, -33));
  settings.Lights = { { { 0, 1, 0.2 }, false, 1 } };
  colors = map.Shade(settings);
  EXPECT_GT(at(colors, 40, -17), at(colors, 40, -33) + 50) << "light from above";
  EXPECT_EQ(at(colors, 48, -25), at(colors, 32, -25));
  // a lamp between the balls lights the facing sides of both
  settings.Lights = { { { 24, -15, 35 }, true, 1 } };
  colors = map.Shade(settings);
  EXPECT_GT(at(colors, 32, -25), at(colors, 48, -25) + 50);
  EXPECT_GT(at(colors, 13, -8), at(colors, 7, -8) + 50);
}

TEST(DepthShader, ShadowOfABallIsAnEllipse)
{
  const BallOnPlane scene;
  ShadingSettings settings;
  settings.Ambient = 0.1;
  settings.Diffuse = 0.8;
  settings.Specular = 0;
  // from the left, 60 degrees off the vertical: semi-axes 8 and 16, its middle 14 tan 60 to the right
  const Vec3 towards{ -std::sqrt(0.75), 0, 0.5 };
  // and lamps: outside of the volume, in it beside the ball (which throws a shadow away from it only),
  // and close to the ground under the ball
  const ShaderLight lights[] = { { towards, false, 1 }, { { -6, 10, 60 }, true, 1 },
    { { 34, 25, 15 }, true, 1 }, { { 15, 24, 7 }, true, 1 } };
  for (const ShaderLight& light : lights)
  {
    settings.Lights = { light };
    std::vector<unsigned char> colors(3 * scene.Depth.size());
    ThreadExecution execution(2);
    ShadeDepths(scene.Grid, scene.Normals.data(), settings, { &scene.Caster, 0, 0.1 },
      scene.Grid.Extent, colors.data(), execution);
    int shadowed = 0;
    int onBall = 0;
    for (std::size_t i = 0; i < scene.Depth.size(); ++i)
    {
      ASSERT_FALSE(std::isnan(scene.Depth[i]));
      const Vec3 p = scene.Grid.PointOf(
        static_cast<int>(i % scene.Plane.Size[0]), static_cast<int>(i / scene.Plane.Size[0]));
      const Vec3 d = p - scene.Centre;
      const bool ball = p[2] > BallOnPlane::Ground + 1;
      ASSERT_NEAR(ball ? Norm(d) : p[2], ball ? BallOnPlane::Radius : BallOnPlane::Ground, 1e-8);
      const Vec3 l = Normalized(light.IsPosition ? light.Place - p : light.Place);
      // distance of the ball's centre from the line to the light, which ends there
      const double end =
        light.IsPosition ? Norm(light.Place - p) : std::numeric_limits<double>::infinity();
      const double along = std::min(std::max(-Dot(d, l), 0.0), end);
      const double distance = Norm(d + along * l);
      const Vec3 n = ball ? (1 / BallOnPlane::Radius) * d : Vec3{ 0, 0, 1 };
      const double cosine = Dot(n, l);
      if (ball ? std::abs(cosine) < 1e-6 : std::abs(distance - BallOnPlane::Radius) < 1e-6)
      {
        continue;
      }
      const bool lit = ball ? cosine > 0 : distance > BallOnPlane::Radius;
      ASSERT_NEAR(colors[3 * i], 255 * (0.1 + (lit ? 0.8 * cosine : 0)), 0.5001)
        << p[0] << " " << p[1] << " " << p[2];
      shadowed += !ball && !lit;
      onBall += ball;
    }
    EXPECT_NEAR(onBall / 16.0, Pi * 64, 4);
    if (!light.IsPosition)
    {
      EXPECT_NEAR(shadowed / 16.0, Pi * 8 * 16, 6);
      const double middle = scene.Centre[0] + 14 * std::sqrt(3.0);
      const auto colorAt = [&](double x, double y)
      {
        const int column = static_cast<int>(x * 4);
        const int row = static_cast<int>((45 - y) * 4);
        return static_cast<int>(colors[3 * scene.Grid.PixelOf(column, row)]);
      };
      EXPECT_EQ(colorAt(middle, 22), Byte(0.1));
      EXPECT_EQ(colorAt(middle + 15.5, 22), Byte(0.1));
      EXPECT_EQ(colorAt(middle + 16.5, 22), Byte(0.5));
      EXPECT_EQ(colorAt(middle, 29.5), Byte(0.1));
      EXPECT_EQ(colorAt(middle, 30.5), Byte(0.5));
    }
  }
}

TEST(DepthShader, BiasForgivesThePointsOwnSurface)
{
  // points 0.3 mm below the ground are in its shadow unless the bias forgives it
  BallOnPlane scene;
  for (double& depth : scene.Depth)
  {
    depth += 0.3;
  }
  ShadingSettings settings;
  settings.Lights = { { { 0, 0, 1 }, false, 1 } };
  const auto corner = [&](double bias)
  {
    std::vector<unsigned char> colors(3 * scene.Depth.size());
    ThreadExecution execution(1);
    ShadeDepths(scene.Grid, scene.Normals.data(), settings, { &scene.Caster, 0, bias },
      { 0, 0, 0, 0 }, colors.data(), execution);
    return static_cast<int>(colors[0]);
  };
  EXPECT_EQ(corner(0.29), Byte(0.1));
  EXPECT_EQ(corner(0.31), Byte(1));
}

TEST(DepthShader, SameForAnyThreadsAndExtents)
{
  const BallOnPlane scene;
  ShadingSettings settings;
  settings.Lights = { { { -1, 0.3, 0.8 }, false, 0.8 }, { { 70, 40, 50 }, true, 0.4 } };
  settings.DepthCue = 0.7;
  settings.Data = { scene.Centre, 40 };
  const auto shade = [&](int threads, const std::array<int, 4>& extent)
  {
    std::vector<unsigned char> colors(
      3 * (extent[1] - extent[0] + 1) * (extent[3] - extent[2] + 1));
    std::vector<float> normals(colors.size());
    ThreadExecution execution(threads);
    EstimateNormals(
      scene.Grid, DepthNormalMethod::Predicate, {}, extent, normals.data(), execution);
    ShadeDepths(scene.Grid, normals.data(), settings, { &scene.Caster, 0, 0.1 }, extent,
      colors.data(), execution);
    return colors;
  };
  const std::vector<unsigned char> whole = shade(1, scene.Grid.Extent);
  EXPECT_EQ(shade(2, scene.Grid.Extent), whole);
  EXPECT_EQ(shade(5, scene.Grid.Extent), whole);
  const std::array<int, 4> part = { 33, 90, 20, 77 };
  const std::vector<unsigned char> some = shade(2, part);
  for (int row = part[2], i = 0; row <= part[3]; ++row)
  {
    for (int column = part[0]; column <= part[1]; ++column, i += 3)
    {
      ASSERT_EQ(some[i], whole[3 * scene.Grid.PixelOf(column, row)]);
    }
  }
}

TEST(DepthShader, HostileMapsAndSettings)
{
  Map nothing(3, 3);
  for (const unsigned char c : nothing.Shade(ShadingSettings()))
  {
    EXPECT_EQ(c, 0);
  }
  Map wild(3, 1);
  wild.Set(0, 1e308, { 0, 0, 1 });
  wild.Set(1, -1e308, { 0, 0, 1 });
  wild.Set(2, 1, { std::numeric_limits<float>::quiet_NaN(), 0, 0 });
  ShadingSettings settings;
  settings.DepthCue = 1;
  settings.Data = { { 0, 0, 1e308 }, 1e308 };
  settings.Lights = { { { 1e308, 0, 1e308 }, true, 1 } };
  EXPECT_EQ(wild.Shade(settings).size(), 9u);

  const auto complaint = [&](const std::function<void(ShadingSettings&)>& spoil) -> std::string
  {
    ShadingSettings bad;
    bad.Lights = { { { 0, 0, 1 }, false, 1 } };
    spoil(bad);
    try
    {
      nothing.Shade(bad);
    }
    catch (const std::invalid_argument& e)
    {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(complaint([](ShadingSettings&) {}), "");
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(complaint([](ShadingSettings& s) { s.Ambient = -0.1; }),
    "Ambient is -0.1; it must be from 0 to 1e+06");
  EXPECT_NE(
    complaint([](ShadingSettings& s) { s.Diffuse = None; }).find("Diffuse"), std::string::npos);
  EXPECT_NE(
    complaint([&](ShadingSettings& s) { s.Specular = inf; }).find("Specular"), std::string::npos);
  EXPECT_NE(complaint([](ShadingSettings& s) { s.SpecularPower = 0; }).find("SpecularPower"),
    std::string::npos);
  EXPECT_NE(
    complaint([](ShadingSettings& s) { s.DepthCue = 1.5; }).find("DepthCue"), std::string::npos);
  EXPECT_NE(complaint([](ShadingSettings& s) { s.SurfaceColor[1] = 255; }).find("SurfaceColor"),
    std::string::npos);
  EXPECT_NE(
    complaint([](ShadingSettings& s) { s.BackgroundColor[2] = None; }).find("BackgroundColor"),
    std::string::npos);
  EXPECT_NE(complaint(
              [](ShadingSettings& s) {
                s.Lights[0].Place = { 0, 0, 0 };
              })
              .find("light 0 has no direction"),
    std::string::npos);
  EXPECT_NE(complaint(
              [](ShadingSettings& s) {
                s.Lights[0].Place = { 1e300, 0, 0 };
              })
              .find("light 0"),
    std::string::npos);
  EXPECT_EQ(complaint([](ShadingSettings& s) { s.Lights[0].Place[0] = None; }),
    "Lights is nan; it must be a finite number");
  EXPECT_NE(
    complaint([](ShadingSettings& s) { s.Lights[0].Intensity = -1; }).find("intensity of light 0"),
    std::string::npos);
}
