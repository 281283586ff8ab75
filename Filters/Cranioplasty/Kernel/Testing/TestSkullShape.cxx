// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSkullShape.h"

#include "lacunaSkullTest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <vector>

using namespace lacunaSkullTest;
using lacuna::Matrix4;
using lacuna::MirrorPlane;
using lacuna::SkullEstimate;
using lacuna::SkullShape;

namespace
{
constexpr std::size_t FewNodes = 300; // of the likelihood

std::vector<SkullEstimate> Fill(const Patient& patient, const MirrorPlane& plane, int threads = 2)
{
  lacuna::ThreadExecution execution(threads);
  const SkullShape shape(patient.Bone, patient.Defect, plane, execution, nullptr, FewNodes);
  return shape.Predict(patient.Defect, execution);
}

// Turned by an angle (radians) and shifted (mm) as a first guess is.
MirrorPlane Disturbed(const MirrorPlane& plane, const Vec3& middle, double angle, double shift)
{
  MirrorPlane other;
  other.Normal = Matrix4::Rotation({ 0.2, 0.5, 1 }, angle).Vector(plane.Normal);
  other.Offset = Dot(other.Normal, middle) - plane.Distance(middle) + shift;
  return other;
}
}

TEST(SkullShape, FillsAHoleOfOneSide)
{
  // 95 mm across, where the other side is whole
  const Patient patient({ -0.75, 0.55, 0.4 }, 0.6);
  const std::vector<SkullEstimate> estimates = Fill(patient, patient.Plane);
  const Score outer = RateOuter(patient, estimates);
  const Score thickness = RateThickness(patient, estimates);
  EXPECT_LT(outer.RMS, 0.5);
  EXPECT_LT(outer.Largest, 1.5);
  EXPECT_LT(thickness.RMS, 0.35);
  // what differs by side has a standard deviation of 0.4 mm: without the other side it is more than that
  Patient half = patient;
  half.Bone = {};
  half.Bone.Center = patient.Bone.Center;
  for (std::size_t i = 0; i < patient.Bone.Outer.size(); ++i)
  {
    if (patient.Bone.Directions[i][0] < 0.15)
    {
      half.Bone.Directions.push_back(patient.Bone.Directions[i]);
      half.Bone.Outer.push_back(patient.Bone.Outer[i]);
      half.Bone.Thickness.push_back(patient.Bone.Thickness[i]);
    }
  }
  const Score alone = RateOuter(half, Fill(half, half.Plane));
  EXPECT_GT(alone.RMS, 1.5 * outer.RMS);
  EXPECT_GT(alone.Predicted, 1.5 * outer.Predicted); // and it is said
  EXPECT_GT(alone.Inside, 0.85);
}

TEST(SkullShape, SaysHowFarItIsOff)
{
  // 55 and 95 mm across, evenly spread over the vault; one of them hides most of the bump
  constexpr int holes = 12;
  double inside = 0;
  double insideThickness = 0;
  double square = 0;
  double predicted = 0;
  for (int i = 0; i < holes; ++i)
  {
    const double z = 0.2 + 0.75 * (i + 0.5) / holes;
    const double turn = 2.39996 * i;
    const double r = std::sqrt(1 - z * z);
    const Patient patient(
      { r * std::cos(turn), r * std::sin(turn), z }, i % 2 ? 0.35 : 0.6, {}, 4.5);
    const std::vector<SkullEstimate> estimates = Fill(patient, patient.Plane);
    const Score outer = RateOuter(patient, estimates);
    inside += outer.Inside / holes;
    insideThickness += RateThickness(patient, estimates).Inside / holes;
    square += outer.RMS * outer.RMS;
    predicted += outer.Predicted * outer.Predicted;
  }
  EXPECT_GT(inside, 0.9);
  EXPECT_GT(insideThickness, 0.9);
  EXPECT_LT(std::sqrt(predicted / square), 1.5);
}

TEST(SkullShape, MendsThePlane)
{
  const Patient patient({ -0.9, -0.2, 0.45 }, 0.5, Matrix4::Translation({ 20, -30, 400 }));
  lacuna::ThreadExecution execution(2);
  const MirrorPlane start = Disturbed(patient.Plane, patient.Bone.Center, 0.05, 3);
  const SkullShape shape(patient.Bone, patient.Defect, start, execution, nullptr, FewNodes);
  EXPECT_GT(Dot(shape.GetPlane().Normal, patient.Plane.Normal), std::cos(0.015));
  EXPECT_LT(std::abs(shape.GetPlane().Distance(patient.Bone.Center)), 0.7);
  const Score score = RateOuter(patient, shape.Predict(patient.Defect, execution));
  EXPECT_LT(score.RMS, 0.5);
}

TEST(SkullShape, DependsNeitherOnThreadsNorOnTheFrame)
{
  const Vec3 hole{ 0.7, 0.5, 0.5 };
  const Patient patient(hole, 0.4);
  const MirrorPlane start = Disturbed(patient.Plane, patient.Bone.Center, 0.03, 1);
  const std::vector<SkullEstimate> one = Fill(patient, start, 1);
  const std::vector<SkullEstimate> three = Fill(patient, start, 3);
  const Matrix4 turned =
    Matrix4::Translation({ 100, -250, 30 }) * Matrix4::Rotation({ 1, 2, -1 }, 2.1);
  const Patient elsewhere(hole, 0.4, turned);
  MirrorPlane turnedStart;
  turnedStart.Normal = turned.Vector(start.Normal);
  turnedStart.Offset = start.Offset + Dot(turnedStart.Normal, turned.Column(3));
  const std::vector<SkullEstimate> other = Fill(elsewhere, turnedStart, 2);
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t i = 0; i < one.size(); ++i)
  {
    EXPECT_EQ(one[i].Outer, three[i].Outer);
    EXPECT_EQ(one[i].OuterError, three[i].OuterError);
    EXPECT_EQ(one[i].Thickness, three[i].Thickness);
    EXPECT_EQ(one[i].ThicknessError, three[i].ThicknessError);
    EXPECT_NEAR(one[i].Outer, other[i].Outer, 1e-5);
    EXPECT_NEAR(one[i].Thickness, other[i].Thickness, 1e-5);
    EXPECT_NEAR(one[i].OuterError, other[i].OuterError, 1e-5);
  }
}

TEST(SkullShape, IsTheBoneWhereThereIsBone)
{
  const Patient patient({ 0.7, 0.5, 0.5 }, 0.4);
  lacuna::ThreadExecution execution(2);
  const SkullShape shape(patient.Bone, patient.Defect, patient.Plane, execution, nullptr, FewNodes);
  std::vector<Vec3> rim;
  std::vector<double> radii;
  for (std::size_t i = 0; i < patient.Bone.Outer.size(); ++i)
  {
    const Vec3& d = patient.Bone.Directions[i];
    if (Dot(d, lacuna::Normalized({ 0.7, 0.5, 0.5 })) > std::cos(0.5))
    {
      rim.push_back(d);
      radii.push_back(patient.Bone.Outer[i]);
    }
  }
  ASSERT_GT(rim.size(), 100u);
  const std::vector<SkullEstimate> estimates = shape.Predict(rim, execution);
  const std::vector<SkullEstimate> surfaces = shape.PredictSurfaces(rim, execution);
  for (std::size_t i = 0; i < rim.size(); ++i)
  {
    EXPECT_NEAR(estimates[i].Outer, radii[i], 0.2);
    EXPECT_LT(estimates[i].OuterError, 0.3);
    EXPECT_EQ(estimates[i].Outer, surfaces[i].Outer);
    EXPECT_EQ(estimates[i].Thickness, surfaces[i].Thickness);
  }
}

TEST(SkullShape, RefusesWhatIsNoSkull)
{
  lacuna::ThreadExecution execution(1);
  const Patient patient({ 0.7, 0.5, 0.5 }, 0.4, {}, 6);
  const auto make = [&](const Patient& p)
  { SkullShape(p.Bone, p.Defect, p.Plane, execution, nullptr, FewNodes); };
  Patient none = patient;
  none.Bone = {};
  EXPECT_THROW(make(none), std::invalid_argument);
  Patient shorter = patient;
  shorter.Bone.Thickness.pop_back();
  EXPECT_THROW(make(shorter), std::invalid_argument);
  for (const double wrong : { std::numeric_limits<double>::quiet_NaN(),
         std::numeric_limits<double>::infinity(), -5.0, 0.0 })
  {
    Patient radius = patient;
    radius.Bone.Outer[17] = wrong;
    EXPECT_THROW(make(radius), std::invalid_argument);
    Patient thickness = patient;
    thickness.Bone.Thickness[17] = wrong;
    EXPECT_THROW(make(thickness), std::invalid_argument);
    Patient direction = patient;
    direction.Bone.Directions[17][1] = wrong + 2;
    EXPECT_THROW(make(direction), std::invalid_argument);
  }
  Patient noDefect = patient;
  noDefect.Defect.clear();
  EXPECT_THROW(make(noDefect), std::invalid_argument);
  Patient noPlane = patient;
  noPlane.Plane.Normal = { 0, 0, 0 };
  EXPECT_THROW(make(noPlane), std::invalid_argument);
  // the same ray again and again
  Patient same = patient;
  std::fill(same.Bone.Directions.begin(), same.Bone.Directions.end(), same.Bone.Directions[0]);
  EXPECT_THROW(make(same), std::invalid_argument);
  const SkullShape shape(patient.Bone, patient.Defect, patient.Plane, execution, nullptr, FewNodes);
  EXPECT_THROW(shape.Predict({ { 1, 1, 0 } }, execution), std::invalid_argument);
  EXPECT_THROW(shape.Predict({ { 0, std::nan(""), 1 } }, execution), std::invalid_argument);
  EXPECT_TRUE(shape.Predict({}, execution).empty());
}
