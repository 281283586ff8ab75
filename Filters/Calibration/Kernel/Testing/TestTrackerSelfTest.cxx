// SPDX-License-Identifier: BSD-3-Clause
/// Two receivers that are fixed to each other, measured by a tracker whose warp is known.
#include "lacunaTrackerSelfTest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>

using namespace lacuna;

namespace
{
constexpr double Degree = 3.14159265358979323846 / 180;
const double NoNumber = std::numeric_limits<double>::quiet_NaN();
using Pairs = std::vector<ReceiverPair>;
using Options = TrackerSelfTestOptions;

// The second receiver is 0.3 m off the first one and askew; nothing is symmetric.
const Matrix4 SecondToFirst =
  Matrix4::Translation({ 250, -120, 115 }) * Matrix4::Rotation({ 1, -2, 0.5 }, 75 * Degree);

// Poses all over a working volume in front of the transmitter, 250 to 550 mm along x; the same
// again in every round.
std::vector<Matrix4> Tour(int places, int rounds = 1, unsigned seed = 1)
{
  std::vector<Matrix4> poses;
  for (int round = 0; round < rounds; ++round)
  {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int i = 0; i < places; ++i)
    {
      const Vec3 place{ 400 + 150 * uniform(random), 200 * uniform(random), 150 * uniform(random) };
      const Vec3 axis{ uniform(random), uniform(random), uniform(random) };
      poses.push_back(
        Matrix4::Translation(place) * Matrix4::Rotation(axis, 60 * Degree * uniform(random)));
    }
  }
  return poses;
}

using Field = std::function<Vec3(const Vec3&)>;

// What a tracker says that shifts all that it sees.
Matrix4 Measure(const Matrix4& pose, const Field& shift)
{
  return Matrix4::Translation(shift(pose.Column(3))) * pose;
}

Pairs Record(const std::vector<Matrix4>& poses, const Field& shift)
{
  Pairs pairs;
  for (std::size_t i = 0; i < poses.size(); ++i)
  {
    pairs.push_back(
      { Measure(poses[i], shift), Measure(poses[i] * SecondToFirst, shift), NoNumber, 100 + i });
  }
  return pairs;
}

Vec3 NoShift(const Vec3&)
{
  return { 0, 0, 0 };
}

// Iron, on one side.
const Vec3 Iron{ 500, 300, -200 };
Vec3 NearIron(const Vec3& p)
{
  const double strength = std::exp(-0.5 * Dot(p - Iron, p - Iron) / (120.0 * 120.0));
  return strength * Vec3{ 13, -6, 8 };
}

std::string Join(const std::vector<std::string>& sentences)
{
  std::string text;
  for (const std::string& sentence : sentences)
  {
    text += sentence + "\n";
  }
  return text;
}

bool Says(const TrackerSelfTest& test, const std::string& words)
{
  return Join(test.GetAdvice()).find(words) != std::string::npos;
}
}

TEST(TrackerSelfTest, ExactReceiversDoNotDeviate)
{
  const TrackerSelfTest found = TrackerSelfTest::Solve(Record(Tour(60), NoShift));
  for (int i = 0; i < 16; ++i)
  {
    EXPECT_NEAR(found.SecondToFirst.Data()[i], SecondToFirst.Data()[i], 1e-9);
  }
  EXPECT_NEAR(found.Separation, Norm(SecondToFirst.Column(3)), 1e-9);
  EXPECT_LT(found.Rms.Position, 1e-9);
  EXPECT_LT(found.Rms.Angle, 1e-9);
  EXPECT_LT(found.SeparationRange, 1e-9);
  EXPECT_EQ(found.Samples.size(), 60u);
  EXPECT_EQ(found.Samples[7].Record, 107u);
  EXPECT_TRUE(Says(found, "the tracker is as specified: points 300 mm"));
  EXPECT_TRUE(Says(found, "no place was visited twice"));
  EXPECT_TRUE(std::isnan(found.Repeatability));
}

TEST(TrackerSelfTest, WarpOfOneCornerIsFoundWhereItIs)
{
  const std::vector<Matrix4> poses = Tour(400, 2);
  const TrackerSelfTest found = TrackerSelfTest::Solve(Record(poses, NearIron));
  // Most places are far from the iron, and the median is theirs.
  EXPECT_LT(Norm(found.SecondToFirst.Column(3) - SecondToFirst.Column(3)), 0.25);
  ASSERT_EQ(found.Samples.size(), 800u);
  double largest = 0;
  for (std::size_t i = 0; i < 800; ++i)
  {
    const Vec3 first = poses[i].Column(3), second = (poses[i] * SecondToFirst).Column(3);
    const Vec3 truth = NearIron(second) - NearIron(first);
    EXPECT_LT(Norm(found.Samples[i].Deviation - truth), 0.25);
    const double separation =
      Norm(second + NearIron(second) - first - NearIron(first)) - found.Separation;
    EXPECT_NEAR(found.Samples[i].SeparationError, separation, 1e-9);
    EXPECT_LT(found.Samples[i].AngleError, 1e-3);
    const Vec3 middle = 0.5 * (first + second + NearIron(first) + NearIron(second));
    EXPECT_LT(Norm(found.Samples[i].Middle - middle), 1e-9);
    largest = std::max(largest, Norm(truth));
  }
  EXPECT_NEAR(found.Largest.Position, largest, 0.25);
  EXPECT_GT(largest, 5);
  const Matrix4& worst = poses[found.Worst];
  EXPECT_LT(
    std::min(Norm(worst.Column(3) - Iron), Norm(worst.Point(SecondToFirst.Column(3)) - Iron)), 150);
  // the same in the second round
  EXPECT_EQ(found.Revisited, found.Places);
  EXPECT_LT(found.Repeatability, 0.5);
  EXPECT_GT(found.Warp, 3 * found.Repeatability);
  // Places side by side deviate alike, those far from each other do not.
  EXPECT_LT(found.ByApart.front().Position, 0.75 * found.ByApart[4].Position);
  EXPECT_TRUE(Says(found, "as specified but in some places")) << Join(found.GetAdvice());
  EXPECT_TRUE(Says(found, "the deviations come back to")) << Join(found.GetAdvice());
  EXPECT_TRUE(Says(found, "look for metal near that place")) << Join(found.GetAdvice());
}

TEST(TrackerSelfTest, RangesWithinWhichTheTrackerIsGood)
{
  // shifts grow as the field weakens
  const Field shift = [](const Vec3& p)
  {
    const double beyond = std::max(0.0, Norm(p) - 500) / 100;
    return Vec3{ 4 * beyond * beyond, -2 * beyond * beyond, 0 };
  };
  std::vector<Matrix4> poses = Tour(600, 2);
  for (Matrix4& pose : poses)
  {
    pose(0, 3) -= 150;
  }
  const TrackerSelfTest found = TrackerSelfTest::Solve(Record(poses, shift));
  EXPECT_TRUE(Says(found, "the tracker warps space here")) << Join(found.GetAdvice());
  EXPECT_TRUE(Says(found, "mm from the transmitter and larger beyond")) << Join(found.GetAdvice());
  EXPECT_TRUE(Says(found, "the deviations come back to"));
  std::size_t samples = 0;
  for (std::size_t row = 0; row < found.ByDistance.size(); ++row)
  {
    const TrackerSelfTest::DistanceRow& bin = found.ByDistance[row];
    EXPECT_NEAR(bin.To - bin.From, 100, 1e-9);
    EXPECT_TRUE(row == 0 || bin.From >= found.ByDistance[row - 1].To);
    samples += bin.Samples;
  }
  EXPECT_EQ(samples, 1200u);
  EXPECT_LT(found.ByDistance[1].Rms.Position, 0.5);
  EXPECT_GT(found.ByDistance.back().Rms.Position, 5);
  EXPECT_GT(found.ByDistance.back().From, 699);
  Options near;
  near.RangeLimit = 600;
  EXPECT_TRUE(Says(TrackerSelfTest::Solve(Record(poses, shift), near), "further than 600 mm"));
}

TEST(TrackerSelfTest, SpecifiedNoiseIsWhatIsExpected)
{
  // 0.8 mm and 0.15 degrees about each axis (Carr 1996, ch. 2.2.2.2)
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 1);
  const auto disturb = [&](const Matrix4& pose)
  {
    Vec3 turn{ normal(random), normal(random), normal(random) };
    const double angle = 0.15 * Degree * Norm(turn);
    const Vec3 shift{ 0.8 * normal(random), 0.8 * normal(random), 0.8 * normal(random) };
    const Vec3 origin = pose.Column(3);
    return Matrix4::Translation(origin + shift) * Matrix4::Rotation(turn, angle) *
      Matrix4::Translation(-1.0 * origin) * pose;
  };
  Pairs pairs;
  for (const Matrix4& pose : Tour(4000))
  {
    pairs.push_back({ disturb(pose), disturb(pose * SecondToFirst), NoNumber, pairs.size() });
  }
  const TrackerSelfTest found = TrackerSelfTest::Solve(pairs);
  EXPECT_NEAR(found.Expected.Separation, std::sqrt(2.0) * 0.8, 0.01);
  EXPECT_NEAR(found.Rms.Separation / found.Expected.Separation, 1, 0.04);
  EXPECT_NEAR(found.Rms.Position / found.Expected.Position, 1, 0.04);
  EXPECT_NEAR(found.Rms.Angle / found.Expected.Angle, 1, 0.04);
  // Carr's 1.95 mm is that of both receivers without their turns.
  EXPECT_NEAR(std::hypot(1.38, 1.38), 1.95, 0.005);
  EXPECT_GT(found.Expected.Position, 1.95);
  EXPECT_TRUE(Says(found, "the tracker is as specified")) << Join(found.GetAdvice());
}

TEST(TrackerSelfTest, TurnsOfTheFieldAreAngles)
{
  // A field that turns the second receiver by 2 degrees when it is on the left.
  Pairs pairs = Record(Tour(300), NoShift);
  for (ReceiverPair& pair : pairs)
  {
    if (pair.Second(1, 3) < -200)
    {
      const Vec3 place = pair.Second.Column(3);
      pair.Second = Matrix4::Translation(place) * Matrix4::Rotation({ 0, 0, 1 }, 2 * Degree) *
        Matrix4::Translation(-1.0 * place) * pair.Second;
    }
  }
  const TrackerSelfTest found = TrackerSelfTest::Solve(pairs);
  for (std::size_t i = 0; i < pairs.size(); ++i)
  {
    EXPECT_NEAR(found.Samples[i].AngleError, pairs[i].Second(1, 3) < -200 ? 2 : 0, 1e-6);
  }
  EXPECT_NEAR(found.Largest.Angle, 2, 1e-6);
  EXPECT_LT(found.Rms.Position, 1e-6);
}

TEST(TrackerSelfTest, EachPlaceCountsOnce)
{
  // Most of the time is spent in the one place that is wrong.
  std::vector<Matrix4> poses = Tour(50);
  Matrix4 wrong = Matrix4::Translation(Iron - Vec3{ 20, 20, 20 });
  poses.insert(poses.end(), 300, wrong);
  const TrackerSelfTest found = TrackerSelfTest::Solve(Record(poses, NearIron));
  EXPECT_EQ(found.Places, 51u);
  EXPECT_LT(Norm(found.SecondToFirst.Column(3) - SecondToFirst.Column(3)), 0.6);
  EXPECT_GT(found.Samples.back().Deviation[0], -12);
  EXPECT_LT(found.Rms.Position, 4);
  EXPECT_GT(Norm(found.Samples.back().Deviation), 8);
}

TEST(TrackerSelfTest, HemispheresAndHasteAreLeftOut)
{
  Pairs pairs = Record(Tour(100), NoShift);
  const auto turn = [](Matrix4& pose)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      pose(axis, 3) = -pose(axis, 3);
    }
  };
  turn(pairs[3].First);
  turn(pairs[40].Second);
  turn(pairs[41].First);
  turn(pairs[41].Second);
  TrackerSelfTest found = TrackerSelfTest::Solve(pairs);
  EXPECT_EQ(found.OtherHemisphere, 3u);
  EXPECT_EQ(found.Samples.size(), 97u);
  EXPECT_LT(found.Largest.Position, 1e-9);
  EXPECT_TRUE(Says(found, "3 pairs were left out, in which"));

  // 10 mm/s, and a jump of the second receiver's place at the turn
  pairs.clear();
  for (int i = 0; i < 50; ++i)
  {
    const Matrix4 pose =
      Matrix4::Translation({ 300.0 + i, 10, 20 }) * Matrix4::Rotation({ 0, 0, 1 }, i < 30 ? 0 : 1);
    pairs.push_back({ pose, pose * SecondToFirst, 0.1 * i, std::size_t(i) });
  }
  found = TrackerSelfTest::Solve(pairs);
  EXPECT_EQ(found.TooFast, 1u);
  EXPECT_EQ(found.Samples.size(), 49u);
  Options slow;
  slow.SpeedLimit = 5;
  EXPECT_THROW(TrackerSelfTest::Solve(pairs, slow), std::invalid_argument);
  slow.SpeedLimit = 0;
  EXPECT_EQ(TrackerSelfTest::Solve(pairs, slow).Samples.size(), 50u);
}

TEST(TrackerSelfTest, SaysWhatTheMeasurementLacks)
{
  // neither moved nor turned
  const Pairs still = Record(std::vector<Matrix4>(20, Tour(1)[0]), NoShift);
  const TrackerSelfTest found = TrackerSelfTest::Solve(still);
  EXPECT_EQ(found.Places, 1u);
  EXPECT_EQ(found.Extent, 0);
  EXPECT_TRUE(Says(found, "moved within 0 mm only"));
  EXPECT_TRUE(Says(found, "no place was visited twice"));
  // metres taken for millimetres
  Pairs metres = Record(Tour(50), NoShift);
  for (ReceiverPair& pair : metres)
  {
    for (Matrix4* pose : { &pair.First, &pair.Second })
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        (*pose)(axis, 3) /= 1000;
      }
    }
  }
  EXPECT_NE(TrackerSelfTest::Solve(metres).GetAdvice().front().find("check the unit of length"),
    std::string::npos);
  // a support that gives
  Pairs loose = Record(Tour(200, 3), NoShift);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-6, 6);
  for (ReceiverPair& pair : loose)
  {
    pair.Second = pair.Second * Matrix4::Translation({ uniform(random), uniform(random), 0 });
  }
  EXPECT_TRUE(Says(TrackerSelfTest::Solve(loose), "check that they cannot move"));
}

TEST(TrackerSelfTest, ManyPairsAreNoMatter)
{
  // A hundred thousand, in a room of many places.
  const TrackerSelfTest found = TrackerSelfTest::Solve(Record(Tour(25000, 4), NearIron));
  EXPECT_EQ(found.Samples.size(), 100000u);
  EXPECT_GT(found.Places, 10000u);
}

TEST(TrackerSelfTest, RefusesWhatCannotBe)
{
  const auto refused = [](const char* part, const std::function<void(Pairs&, Options&)>& spoil)
  {
    Pairs pairs = Record(Tour(20), NoShift);
    Options options;
    spoil(pairs, options);
    try
    {
      TrackerSelfTest::Solve(pairs, options);
      ADD_FAILURE() << "taken: " << part;
    }
    catch (const std::invalid_argument& error)
    {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  refused("only 0 of 0 pairs", [](Pairs& pairs, Options&) { pairs.clear(); });
  refused("only 9 of 9 pairs", [](Pairs& pairs, Options&) { pairs.resize(9); });
  refused("record 104: the pose of the second receiver has numbers that are not finite",
    [](Pairs& pairs, Options&) { pairs[4].Second(0, 3) = NoNumber; });
  refused("record 104: the pose of the first receiver mirrors",
    [](Pairs& pairs, Options&) {
      pairs[4].First = pairs[4].First * Matrix4::Scaling({ 1, -1, 1 });
    });
  refused("is not rigid", [](Pairs& pairs, Options&) { pairs[4].First(0, 0) += 0.1; });
  refused("last row", [](Pairs& pairs, Options&) { pairs[4].First(3, 0) = 1; });
  refused("more than a kilometre", [](Pairs& pairs, Options&) { pairs[4].First(0, 3) = 1e300; });
  refused("SpeedLimit", [](Pairs&, Options& options) { options.SpeedLimit = -1; });
  refused("SpeedLimit", [](Pairs&, Options& options) { options.SpeedLimit = NoNumber; });
  refused("RevisitDistance", [](Pairs&, Options& options) { options.RevisitDistance = 0; });
  refused("RevisitAngle", [](Pairs&, Options& options) { options.RevisitAngle = NoNumber; });
  refused("RevisitAngle", [](Pairs&, Options& options) { options.RevisitAngle = 181; });
  refused("RangeLimit", [](Pairs&, Options& options) { options.RangeLimit = 0; });
  refused("Accuracy", [](Pairs&, Options& options) { options.Accuracy.Angle = 0; });
}

TEST(ReceiverPlaces, VisitsEndWithAnExcursion)
{
  const auto at = [](double x, double degrees = 0)
  {
    return Matrix4::Translation({ x, -3 * x, 0 }) *
      Matrix4::Rotation({ 0, 1, 0 }, degrees * Degree);
  };
  // out of the place by a little and back: one visit; far away and back: two; turned: two
  const std::vector<Matrix4> poses{ at(0), at(1), at(4), at(0), at(40), at(41), at(0.5), at(0, 50),
    at(0), at(0, 8) };
  const ReceiverPlaces found(poses, 10, 15);
  const std::vector<std::size_t> places{ 0, 0, 1, 0, 2, 2, 0, 3, 0, 0 };
  const std::vector<std::size_t> visits{ 0, 0, 1, 0, 2, 2, 3, 4, 5, 5 };
  EXPECT_EQ(found.Place, places);
  EXPECT_EQ(found.Visit, visits);
  EXPECT_EQ(found.Middles, (std::vector<std::size_t>{ 0, 2, 4, 7 }));
  EXPECT_EQ(found.Visited, (std::vector<std::size_t>{ 0, 1, 2, 0, 3, 0 }));
}

TEST(ReceiverPlaces, TurnsAreExactAtBothEnds)
{
  const Matrix4 pose = Tour(1)[0];
  for (const double degrees : { 0.0, 1e-7, 0.26, 90.0, 179.999, 180.0 })
  {
    const Matrix4 turned = pose * Matrix4::Rotation({ 1, 2, -3 }, degrees * Degree);
    EXPECT_NEAR(GetTurn(pose, turned), degrees, 1e-6 * degrees + 1e-12) << degrees;
  }
}
