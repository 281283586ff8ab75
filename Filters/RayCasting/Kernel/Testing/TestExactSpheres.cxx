// SPDX-License-Identifier: BSD-3-Clause
/// Samples of r^2 give the cubic field r^2 + (a^2 + b^2 + c^2) / 3 for voxels of a x b x c: its
/// surfaces are spheres, which every hit must lie on.
#include "lacunaIsoRayCaster.h"
#include "lacunaTestField.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace
{
using namespace lacuna;

struct Ball
{
  Matrix4 Frame;
  Vec3 Centre;
  double SmallestVoxel;
  double Offset; ///< field - r^2
  TestField Field;

  Ball(std::mt19937& random, const Vec3& spacing, bool mirrored)
    : Frame(RandomFrame(random, spacing, mirrored))
    , Centre(Frame.Point({ 13.3, 12.1, 12.6 }))
    , SmallestVoxel(std::min({ spacing[0], spacing[1], spacing[2] }))
    , Offset(Dot(spacing, spacing) / 3)
    , Field({ 28, 25, 26 }, Frame,
        [this](const Vec3& p) { return Dot(p - this->Centre, p - this->Centre); })
  {
  }

  /// The largest sphere that the volume holds, whole.
  double GreatestRadius(const Vec3& spacing) const
  {
    return std::min({ 13 * spacing[0], 11.5 * spacing[1], 12 * spacing[2] });
  }
};

const Vec3 Spacings[] = { { 1, 1, 1 }, { 0.45, 0.45, 2.3 }, { 1.7, 0.8, 1.1 } };

/// Worst distances from the sphere in voxels, and of normals from the radius.
struct Worst
{
  double Distance = 0;
  double Normal = 0;
  int Hits = 0;

  void Add(const Ball& ball, double radius, const Vec3& p, const Vec3& normal)
  {
    this->Distance =
      std::max(this->Distance, std::abs(Norm(p - ball.Centre) - radius) / ball.SmallestVoxel);
    this->Normal = std::max(this->Normal, Norm(normal - (1 / radius) * (p - ball.Centre)));
    ++this->Hits;
  }
};
}

TEST(ExactSpheres, SingleRays)
{
  std::mt19937 random(11);
  ThreadExecution execution(1);
  for (int trial = 0; trial < 6; ++trial)
  {
    const Vec3& spacing = Spacings[trial % 3];
    const Ball ball(random, spacing, trial >= 3);
    const IsoRayCaster caster(
      ball.Field.View(), FieldInterpolation::BSpline, SolidSide::Below, execution);
    Worst worst;
    for (int ray = 0; ray < 2000; ++ray)
    {
      const double radius = ball.GreatestRadius(spacing) * (0.3 + 0.1 * (ray % 7));
      const Vec3 direction = RandomUnit(random);
      const Vec3 aside = Cross(direction, RandomUnit(random));
      const Vec3 origin = ball.Centre + radius * aside - 60 * direction;
      RayHit hit;
      ASSERT_TRUE(caster.CastRay(origin, direction, radius * radius + ball.Offset, hit));
      const double half = radius * std::sqrt(1 - Dot(aside, aside));
      ASSERT_NEAR(hit.Distance, 60 - half, 1e-10 * radius / half) << "the near side";
      ASSERT_LE(Dot(hit.Normal, direction), 1e-9) << "towards the viewer";
      worst.Add(ball, radius, origin + hit.Distance * direction, hit.Normal);
    }
    EXPECT_LT(worst.Distance, 1e-11);
    EXPECT_LT(worst.Normal, 1e-11);
  }
}

TEST(ExactSpheres, MapsParallelAndPerspective)
{
  std::mt19937 random(12);
  ThreadExecution execution(2);
  for (int trial = 0; trial < 12; ++trial)
  {
    const Vec3& spacing = Spacings[trial % 3];
    const Ball ball(random, spacing, trial % 2 != 0);
    const IsoRayCaster caster(
      ball.Field.View(), FieldInterpolation::BSpline, SolidSide::Below, execution);
    const bool perspective = trial >= 6;
    const double radius = 0.9 * ball.GreatestRadius(spacing);
    ViewSettings view;
    view.Direction =
      trial % 4 == 0 ? Normalized(ball.Frame.Vector({ 0, 1, 0 })) : RandomUnit(random);
    view.Up = RandomUnit(random);
    view.Size = { 90, 80 };
    view.PixelSpacing = perspective ? 0 : 2.2 * radius / 80;
    view.HasFocalPoint = true;
    view.FocalPoint = ball.Centre;
    const Vec3 eye = ball.Centre - 4 * radius * Normalized(view.Direction);
    const ImagePlane plane = perspective
      ? MakePerspectivePlane(
          CornersOf(ball.Frame, ball.Field.Size), ball.SmallestVoxel, view, eye, 32)
      : MakeImagePlane(ball.Frame, ball.Field.Size, view);
    RayRequest request;
    request.Eye = perspective ? &eye : nullptr;
    const std::size_t count = 90 * 80;
    std::vector<double> depth(count);
    std::vector<char> valid(count);
    std::vector<float> normals(3 * count);
    caster.Cast(plane, radius * radius + ball.Offset,
      { { 0, 89, 0, 79 }, depth.data(), valid.data(), normals.data() }, request, execution);
    Worst worst;
    for (std::size_t i = 0; i < count; ++i)
    {
      const Vec3 pixel = plane.PixelPosition(static_cast<int>(i) % 90, static_cast<int>(i) / 90);
      const Vec3 ray = perspective ? Normalized(pixel - eye) : plane.View;
      const double middle = Dot(ball.Centre - pixel, ray);
      const double distance = Norm(pixel + middle * ray - ball.Centre);
      if (std::abs(distance - radius) > 1e-9)
      {
        ASSERT_EQ(valid[i] != 0, distance < radius) << trial << " " << i;
      }
      if (valid[i])
      {
        worst.Add(ball, radius, pixel + depth[i] * ray,
          { normals[3 * i], normals[3 * i + 1], normals[3 * i + 2] });
        ASSERT_LT(depth[i], middle + 1e-9) << "the near side";
      }
    }
    EXPECT_GT(worst.Hits, 3000);
    EXPECT_LT(worst.Distance, 1e-9) << trial;
    EXPECT_LT(worst.Normal, 2e-7) << "float";
  }
}
