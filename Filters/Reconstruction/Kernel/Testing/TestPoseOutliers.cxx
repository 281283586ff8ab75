// SPDX-License-Identifier: BSD-3-Clause
/// Wild poses are found, and no sweep that a hand could make is touched.
#include "lacunaPoseOutliers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace lacuna;

namespace
{
// An image of 40 x 30 mm.
SlicePlace Place(std::int64_t number, const Matrix4& pose)
{
  SliceImage slice;
  slice.Width = 401;
  slice.Height = 301;
  slice.PixelToReference = pose * Matrix4::Scaling({ 0.1, 0.1, 1 });
  return { number, GetCorners(slice) };
}

std::vector<SlicePlace> Straight(int count, double step)
{
  std::vector<SlicePlace> places;
  for (int n = 0; n < count; ++n)
  {
    places.push_back(Place(n, Matrix4::Translation({ 0, 0, step * n })));
  }
  return places;
}

std::vector<std::size_t> Find(const std::vector<SlicePlace>& places)
{
  std::vector<std::size_t> indices;
  for (const PoseOutliers::Outlier& outlier : FindPoseOutliers(places).Outliers)
  {
    indices.push_back(outlier.Index);
  }
  return indices;
}

using Indices = std::vector<std::size_t>;
}

TEST(PoseOutliers, OneWildPose)
{
  for (const std::size_t wild : { 0, 1, 17, 39 })
  {
    std::vector<SlicePlace> places = Straight(40, 0.3);
    places[wild] =
      Place(static_cast<std::int64_t>(wild), Matrix4::Translation({ 0, 900, 0.3 * double(wild) }));
    const PoseOutliers found = FindPoseOutliers(places);
    ASSERT_EQ(found.Outliers.size(), 1u) << wild;
    EXPECT_EQ(found.Outliers[0].Index, wild);
    EXPECT_NEAR(found.Outliers[0].Distance, 900, 0.1);
    EXPECT_NEAR(found.MedianStep, 0.3, 1e-9);
    EXPECT_NEAR(found.LongestStep, 50, 1e-9); // the diagonal
  }
}

TEST(PoseOutliers, WildTurnAndWildScale)
{
  std::vector<SlicePlace> places = Straight(30, 0.5);
  // turned about a far point, as when the hemisphere of the tracker flips
  places[4] = Place(4, Matrix4::Rotation({ 0, 1, 0 }, 3) * Matrix4::Translation({ 300, 0, 0 }));
  places[9] = Place(9, Matrix4::Scaling({ 1e6, 1e6, 1 }));
  places[29] = Place(29, Matrix4::Translation({ -1e9, 0, 0 }));
  EXPECT_EQ(Find(places), (Indices{ 4, 9, 29 }));
}

TEST(PoseOutliers, ThreeInARowTogetherOrApart)
{
  std::vector<SlicePlace> places = Straight(60, 0.5);
  for (int n = 10; n < 13; ++n)
  {
    places[n] = Place(n, Matrix4::Translation({ 500, 0, 0.5 * n }));
  }
  for (int n = 30; n < 35; ++n)
  {
    places[n] = Place(n, Matrix4::Translation({ 500.0 * n, 0, 0 }));
  }
  EXPECT_EQ(Find(places), (Indices{ 10, 11, 12, 30, 31, 32, 33, 34 }));
}

TEST(PoseOutliers, SmallSweepWithOneWildPose)
{
  std::vector<SlicePlace> places = Straight(5, 1);
  places[4] = Place(4, Matrix4::Translation({ 0, 0, 1e9 }));
  EXPECT_EQ(Find(places), (Indices{ 4 }));
  places = Straight(4, 1);
  places[3] = Place(3, Matrix4::Translation({ 0, 0, 1e9 }));
  EXPECT_EQ(Find(places), Indices{}); // three slices are too few to say which one is wrong
}

TEST(PoseOutliers, SweepsOfOneFile)
{
  // the probe is put down 200 mm away for the second half, then again elsewhere
  std::vector<SlicePlace> places;
  for (int n = 0; n < 90; ++n)
  {
    const double x = n < 40 ? 0 : n < 80 ? 200 : 400;
    places.push_back(Place(n, Matrix4::Translation({ x, 0, 0.3 * (n % 40) })));
  }
  EXPECT_EQ(Find(places), Indices{});
  // two places of three slices each: neither is the odd one out
  places = Straight(6, 0.3);
  for (int n = 3; n < 6; ++n)
  {
    places[n] = Place(n, Matrix4::Translation({ 900, 0, 0.3 * n }));
  }
  EXPECT_EQ(Find(places), Indices{});
}

TEST(PoseOutliers, MotionsOfAHand)
{
  // steady, still with one quick move, pausing, speeding up
  EXPECT_EQ(Find(Straight(100, 80)), Indices{}); // steps longer than the image
  std::vector<SlicePlace> still(100);
  std::vector<SlicePlace> pausing(100);
  std::vector<SlicePlace> faster(100);
  std::mt19937 random(3);
  std::normal_distribution<double> jitter(0, 0.05);
  for (int n = 0; n < 100; ++n)
  {
    still[n] = Place(n, Matrix4::Translation({ jitter(random), 0, n == 50 ? 30.0 : 0.0 }));
    pausing[n] = Place(n, Matrix4::Translation({ jitter(random), 0, 3.0 * std::max(0, n - 80) }));
    faster[n] = Place(n, Matrix4::Translation({ 0, jitter(random), 1e-6 * std::pow(n, 4) }));
  }
  EXPECT_EQ(Find(still), Indices{});
  EXPECT_EQ(Find(pausing), Indices{});
  EXPECT_EQ(Find(faster), Indices{});

  // a fan by 120 degrees about the skin, a turn by 360 degrees about the depth axis
  std::vector<SlicePlace> fan;
  std::vector<SlicePlace> turn;
  for (int n = 0; n < 60; ++n)
  {
    fan.push_back(Place(n, Matrix4::Rotation({ 1, 0, 0 }, 0.035 * (n - 30))));
    turn.push_back(
      Place(n, Matrix4::Rotation({ 0, 1, 0 }, 0.105 * n) * Matrix4::Translation({ -20, 0, 0 })));
  }
  EXPECT_EQ(Find(fan), Indices{});
  EXPECT_EQ(Find(turn), Indices{});

  // slices here and there in a box of 300 mm, in no order
  std::uniform_real_distribution<double> anywhere(0, 300);
  for (int trial = 0; trial < 50; ++trial)
  {
    std::vector<SlicePlace> places;
    for (int n = 0; n < 40; ++n)
    {
      places.push_back(Place(n,
        Matrix4::Translation({ anywhere(random), anywhere(random), anywhere(random) }) *
          Matrix4::Rotation({ anywhere(random), 1, 50 }, anywhere(random))));
    }
    EXPECT_EQ(Find(places), Indices{}) << trial;
  }
}

TEST(PoseOutliers, MissingSlicesAreNoJump)
{
  // 5 mm a slice; the tracker lost the probe for 100 slices, then for 90 more
  std::vector<SlicePlace> places;
  for (int n = 0; n < 300; ++n)
  {
    if ((n < 60 || n > 160) && (n < 163 || n > 253))
    {
      places.push_back(Place(n, Matrix4::Translation({ 0, 0, 5.0 * n })));
    }
  }
  EXPECT_EQ(Find(places), Indices{});
}

TEST(PoseOutliers, NothingToCompare)
{
  EXPECT_EQ(Find({}), Indices{});
  EXPECT_EQ(Find(Straight(1, 1)), Indices{});
  EXPECT_EQ(Find(Straight(2, 1e6)), Indices{});
  EXPECT_EQ(Find(std::vector<SlicePlace>(20, Place(0, Matrix4()))), Indices{});
}
