// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaProbeMotion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>

using lacuna::Matrix4;
using lacuna::ProbeMotion;
using lacuna::Vec3;

namespace
{
constexpr double Degrees = 180 / 3.14159265358979323846;

void ExpectNear(const Vec3& a, const Vec3& b, double tolerance)
{
  for (int i = 0; i < 3; ++i)
  {
    EXPECT_NEAR(a[i], b[i], tolerance) << i;
  }
}

ProbeMotion::Parameters Base(ProbeMotion::Kind kind)
{
  ProbeMotion::Parameters p;
  p.Motion = kind;
  p.NumberOfSlices = 11;
  p.Center = { 1, 2, 3 };
  return p;
}
}

TEST(ProbeMotion, PosesAreRigidAndRightHanded)
{
  for (int kind = 0; kind < 4; ++kind)
  {
    ProbeMotion::Parameters p = Base(static_cast<ProbeMotion::Kind>(kind));
    p.NumberOfSweeps = 3;
    p.PositionNoise = 0.5;
    p.AngleNoise = 2;
    const ProbeMotion motion(p);
    for (int i = 0; i < 11; ++i)
    {
      for (const Matrix4& m :
        { motion.TrueProbeToReference(i), motion.RecordedProbeToReference(i) })
      {
        EXPECT_NEAR(m.Determinant3(), 1, 1e-12);
        for (int c = 0; c < 3; ++c)
        {
          EXPECT_NEAR(Norm(m.Column(c)), 1, 1e-12);
        }
        EXPECT_TRUE(m.IsAffine());
      }
    }
  }
}

TEST(ProbeMotion, SweepMovesTheImageAlongZ)
{
  const ProbeMotion motion(Base(ProbeMotion::Kind::Sweep));
  for (int i = 0; i < 11; ++i)
  {
    const Matrix4 m = motion.TrueProbeToReference(i);
    ExpectNear(m.Point({ 0, 24, 0 }), { 1, 2, 3 - 25 + 5.0 * i }, 1e-12);
    ExpectNear(m.Column(0), { 1, 0, 0 }, 1e-15);
    ExpectNear(m.Column(1), { 0, 1, 0 }, 1e-15);
  }
}

TEST(ProbeMotion, FanTurnsAboutTheFaceAndTwistAboutTheDepthAxis)
{
  const ProbeMotion fan(Base(ProbeMotion::Kind::Fan));
  const ProbeMotion twist(Base(ProbeMotion::Kind::Twist));
  for (int i = 0; i < 11; ++i)
  {
    const double angle = -30 + 6 * i;
    const Matrix4 f = fan.TrueProbeToReference(i);
    ExpectNear(f.Point({ 5, 0, 0 }), { 6, 2 - 24, 3 }, 1e-12);
    EXPECT_NEAR(std::atan2(f.Column(1)[2], f.Column(1)[1]) * Degrees, angle, 1e-10);
    const Matrix4 t = twist.TrueProbeToReference(i);
    ExpectNear(t.Point({ 0, 17, 0 }), { 1, 2 - 24 + 17, 3 }, 1e-12);
    EXPECT_NEAR(std::atan2(-t.Column(0)[2], t.Column(0)[0]) * Degrees, angle, 1e-10);
  }
}

// The benchmark of the freehand filters: planes that twist and tilt by the stated amplitudes.
TEST(ProbeMotion, ArbitraryReachesItsAmplitudesAndCrossesPlanes)
{
  ProbeMotion::Parameters p = Base(ProbeMotion::Kind::Arbitrary);
  p.NumberOfSlices = 200;
  p.Travel = 60;
  const ProbeMotion motion(p);
  double twist = 0;
  double fan = 0;
  double sway = 0;
  int crossing = 0;
  for (int i = 0; i < 200; ++i)
  {
    const Matrix4 m = motion.TrueProbeToReference(i);
    twist = std::max(twist, std::abs(std::atan2(m.Column(2)[0], m.Column(2)[2]) * Degrees));
    fan = std::max(fan, std::abs(std::asin(-m.Column(2)[1]) * Degrees));
    sway = std::max(sway, std::abs(m.Column(3)[0] - 1));
    if (i > 0)
    {
      // On which side of the last plane do the corners of this image lie?
      const Matrix4 last = motion.TrueProbeToReference(i - 1).Inverse();
      int front = 0;
      for (const double x : { -32.0, 32.0 })
      {
        for (const double y : { 0.0, 48.0 })
        {
          front += last.Point(m.Point({ x, y, 0 }))[2] > 0;
        }
      }
      crossing += front != 0 && front != 4;
    }
  }
  EXPECT_NEAR(twist, 12, 0.01);
  EXPECT_NEAR(fan, 8, 0.01);
  EXPECT_NEAR(sway, 2, 0.01);
  EXPECT_GT(crossing, 10);
  EXPECT_NEAR(
    motion.TrueProbeToReference(199).Column(3)[2] - motion.TrueProbeToReference(0).Column(3)[2], 60,
    1e-12);
}

TEST(ProbeMotion, SweepsCrossAtEqualAnglesAndShareTheSlices)
{
  ProbeMotion::Parameters p = Base(ProbeMotion::Kind::Sweep);
  p.NumberOfSlices = 11;
  p.NumberOfSweeps = 2; // 6 + 5
  const ProbeMotion motion(p);
  ExpectNear(motion.TrueProbeToReference(0).Point({ 0, 24, 0 }), { 1, 2, -22 }, 1e-12);
  ExpectNear(motion.TrueProbeToReference(5).Point({ 0, 24, 0 }), { 1, 2, 28 }, 1e-12);
  ExpectNear(motion.TrueProbeToReference(6).Point({ 0, 24, 0 }), { -24, 2, 3 }, 1e-12);
  ExpectNear(motion.TrueProbeToReference(10).Point({ 0, 24, 0 }), { 26, 2, 3 }, 1e-12);
  ExpectNear(motion.TrueProbeToReference(6).Column(0), { 0, 0, -1 }, 1e-12);
  p.NumberOfSlices = 3;
  p.NumberOfSweeps = 3;
  const ProbeMotion singles(p);
  for (int i = 0; i < 3; ++i)
  {
    ExpectNear(singles.TrueProbeToReference(i).Point({ 0, 24, 0 }), { 1, 2, 3 }, 1e-12);
  }
}

TEST(ProbeMotion, PoseNoiseHasTheStatedDeviations)
{
  ProbeMotion::Parameters p = Base(ProbeMotion::Kind::Sweep);
  p.NumberOfSlices = 20000;
  p.PositionNoise = 0.3;
  p.AngleNoise = 0.2;
  p.Seed = 5;
  const ProbeMotion motion(p);
  double position[3] = {};
  double angle[3] = {};
  for (int i = 0; i < p.NumberOfSlices; ++i)
  {
    const Matrix4 truth = motion.TrueProbeToReference(i);
    const Matrix4 recorded = motion.RecordedProbeToReference(i);
    const Matrix4 turn = truth.Inverse() * recorded;
    for (int a = 0; a < 3; ++a)
    {
      position[a] += std::pow(recorded(a, 3) - truth(a, 3), 2);
      angle[a] += std::pow(turn((a + 2) % 3, (a + 1) % 3) * Degrees, 2);
    }
  }
  for (int a = 0; a < 3; ++a)
  {
    // Five standard errors: 5 / sqrt(2 n) = 2.5 %.
    EXPECT_NEAR(std::sqrt(position[a] / p.NumberOfSlices) / 0.3, 1, 0.025);
    EXPECT_NEAR(std::sqrt(angle[a] / p.NumberOfSlices) / 0.2, 1, 0.025);
  }
}

TEST(ProbeMotion, ImageToProbeIsCentred)
{
  const Matrix4 m = lacuna::MakeImageToProbe(320, 0.2);
  ExpectNear(m.Point({ 0, 0, 0 }), { -31.9, 0, 0 }, 1e-13);
  ExpectNear(m.Point({ 319, 239, 0 }), { 31.9, 47.8, 0 }, 1e-13);
  EXPECT_NEAR(m.Determinant3(), 0.008, 1e-15);
}

TEST(ProbeMotion, RefusesBadParametersByName)
{
  struct Case
  {
    const char* Name;
    std::function<void(ProbeMotion::Parameters&)> Spoil;
  };
  using P = ProbeMotion::Parameters;
  const double nan = std::nan("");
  for (const Case& c : { Case{ "NumberOfSlices", [](P& p) { p.NumberOfSlices = 0; } },
         Case{ "NumberOfSlices", [](P& p) { p.NumberOfSlices = -5; } },
         Case{ "NumberOfSweeps", [](P& p) { p.NumberOfSweeps = 0; } },
         Case{ "NumberOfSweeps", [](P& p) { p.NumberOfSweeps = 12; } },
         Case{ "Motion", [](P& p) { p.Motion = static_cast<ProbeMotion::Kind>(4); } },
         Case{ "Travel", [=](P& p) { p.Travel = nan; } },
         Case{ "Travel", [](P& p) { p.Travel = -1; } },
         Case{ "SweepAngle", [](P& p) { p.SweepAngle = 361; } },
         Case{ "TwistAngle", [](P& p) { p.TwistAngle = -1; } },
         Case{ "FanAngle", [=](P& p) { p.FanAngle = nan; } },
         Case{ "Wander", [](P& p) { p.Wander = -1; } },
         Case{ "PoseNoise", [](P& p) { p.PositionNoise = -1; } },
         Case{ "PoseNoise", [=](P& p) { p.AngleNoise = nan; } },
         Case{ "Center", [](P& p) { p.Center[1] = HUGE_VAL; } } })
  {
    P p = Base(ProbeMotion::Kind::Arbitrary);
    c.Spoil(p);
    try
    {
      ProbeMotion motion(p);
      FAIL() << c.Name;
    }
    catch (const std::invalid_argument& e)
    {
      EXPECT_EQ(std::string(e.what()).find(c.Name), 0u) << e.what();
    }
  }
}
