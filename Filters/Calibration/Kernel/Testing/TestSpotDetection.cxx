// SPDX-License-Identifier: BSD-3-Clause
/// Wires in a water bath are found in B-scans and followed; speckle, echoes and specks are not.
#include "lacunaSpotTracking.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

using namespace lacuna;

namespace
{
// A B-scan of a bath with a wire: a spot wider along rows and askew, with a comet's tail that beats,
// an echo behind it, and the bright lines under the transducer.
struct Bath
{
  int Width = 400, Height = 320;
  double Speckle = 12;
  double Peak = 230; ///< above 255: saturated
  double Tail = 0.45;
  double Skew = 0.25; ///< columns by which a row of the spot lies beside the one above
  bool HasWire = true;
  int Specks = 0;
  bool HasFloor = false;
  std::vector<unsigned char> Pixels;

  GreyImage Draw(unsigned seed, const Vec2& wire)
  {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> u(1e-9, 1);
    this->Pixels.resize(std::size_t(this->Width * this->Height));
    std::vector<double> level(this->Pixels.size(), 0);
    for (std::size_t i = 1; i < level.size(); ++i) // grains two columns wide
    {
      const double grain = this->Speckle * std::sqrt(-2 * std::log(u(random)));
      level[i] += 0.5 * grain;
      level[i - 1] += 0.5 * grain;
    }
    const double wide = 3 + 1.5 * wire[1] / this->Height; // the beam spreads
    for (int row = 0; row < this->Height; ++row)
    {
      for (int column = 0; column < this->Width; ++column)
      {
        double& grey = level[std::size_t(row * this->Width + column)];
        grey += row < 8 ? 150 - 15 * row : 0;
        const double y = row - wire[1], x = column - wire[0] - this->Skew * y;
        if (this->HasWire)
        {
          const double across = std::exp(-0.5 * x * x / (wide * wide));
          const double tail = y <= 0
            ? 0
            : this->Tail * (1 - std::exp(-y / 2)) * std::exp(-y / 25) * (0.8 + 0.2 * std::cos(y));
          const double lobe = std::exp(-0.5 * y * y / 2.25);
          const double echo = 0.4 * std::exp(-0.5 * (y - 45) * (y - 45) / 4);
          grey += this->Peak * across * std::max({ lobe, tail, echo });
        }
        if (this->HasFloor)
        {
          const double floor = row - 270 + 0.2 * column;
          grey += 250 * std::exp(-0.5 * floor * floor / 9);
        }
      }
    }
    for (int speck = 0; speck < this->Specks; ++speck)
    {
      const Vec2 place{ 20 + (this->Width - 40) * u(random), 20 + (this->Height - 40) * u(random) };
      for (int dy = -4; dy <= 4; ++dy)
      {
        for (int dx = -4; dx <= 4; ++dx)
        {
          level[std::size_t((int(place[1]) + dy) * this->Width + int(place[0]) + dx)] +=
            100 * std::exp(-0.5 * (dx * dx + dy * dy) / 2.0);
        }
      }
    }
    for (std::size_t i = 0; i < level.size(); ++i)
    {
      this->Pixels[i] = static_cast<unsigned char>(std::clamp(level[i], 0.0, 255.0));
    }
    return { ScalarType::UInt8, this->Pixels.data(), this->Width, this->Width, this->Height };
  }
};

struct Errors
{
  double Missing = 0, Bias[2] = { 0, 0 }, Rms[2] = { 0, 0 }, Worst = 0, LeastScore = 1;
};

Errors Measure(Bath bath, unsigned seed, int count)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(0, 1);
  Errors errors;
  double found = 0;
  for (int n = 0; n < count; ++n)
  {
    const Vec2 wire{ 25 + 350 * u(random), 35 + 265 * u(random) };
    const std::vector<Spot> spots = FindSpots(bath.Draw(seed * 7919 + unsigned(n), wire));
    if (spots.empty() || std::hypot(spots[0].Pixel[0] - wire[0], spots[0].Pixel[1] - wire[1]) > 5)
    {
      errors.Missing += 1.0 / count;
      continue;
    }
    found += 1;
    for (std::size_t a = 0; a < 2; ++a)
    {
      const double e = spots[0].Pixel[a] - wire[a];
      errors.Bias[a] += e;
      errors.Rms[a] += e * e;
      errors.Worst = std::max(errors.Worst, std::abs(e));
    }
    errors.LeastScore = std::min(errors.LeastScore, spots[0].Score);
  }
  for (std::size_t a = 0; a < 2; ++a)
  {
    errors.Bias[a] /= found;
    errors.Rms[a] = std::sqrt(errors.Rms[a] / found);
  }
  std::printf("missing %.3f, bias %.3f %.3f, rms %.3f %.3f, worst %.2f pixels\n", errors.Missing,
    errors.Bias[0], errors.Bias[1], errors.Rms[0], errors.Rms[1], errors.Worst);
  return errors;
}
}

TEST(SpotDetection, CentresWithinAFractionOfAPixel)
{
  for (const double speckle : { 4.0, 12.0, 20.0 })
  {
    for (const double peak : { 160.0, 230.0, 400.0 })
    {
      Bath bath;
      bath.Speckle = speckle;
      bath.Peak = peak;
      const Errors errors = Measure(bath, 1, 30);
      EXPECT_EQ(errors.Missing, 0) << speckle << " " << peak;
      EXPECT_LT(std::abs(errors.Bias[0]), 0.1) << speckle << " " << peak;
      EXPECT_LT(std::abs(errors.Bias[1]), 0.2) << speckle << " " << peak;
      EXPECT_LT(errors.Rms[0], 0.25) << speckle << " " << peak;
      EXPECT_LT(errors.Rms[1], 0.25) << speckle << " " << peak;
      EXPECT_GT(errors.LeastScore, 0.7) << speckle << " " << peak;
    }
  }
}

TEST(SpotDetection, AmongSpecksAndBeforeTheFloor)
{
  Bath bath;
  bath.Specks = 15;
  EXPECT_LT(Measure(bath, 2, 40).Missing, 0.05);
  bath.Specks = 0;
  bath.HasFloor = true;
  bath.Peak = 200;
  EXPECT_LT(Measure(bath, 3, 40).Missing, 0.25); // behind it, or in its light
}

TEST(SpotDetection, OtherTypesAndStrides)
{
  Bath bath;
  GreyImage image = bath.Draw(4, { 210.3, 150.8 });
  const std::vector<Spot> spots = FindSpots(image);
  std::vector<float> wide(std::size_t(image.Height) * 500, 1e30F);
  for (int row = 0; row < image.Height; ++row)
  {
    for (int column = 0; column < image.Width; ++column)
    {
      wide[std::size_t(row) * 500 + std::size_t(column)] =
        0.01F * bath.Pixels[std::size_t(row * image.Width + column)] - 3;
    }
  }
  image.Type = ScalarType::Float32;
  image.Pixels = wide.data();
  image.RowStride = 500;
  const std::vector<Spot> same = FindSpots(image);
  ASSERT_FALSE(spots.empty());
  ASSERT_FALSE(same.empty());
  EXPECT_NEAR(same[0].Pixel[0], spots[0].Pixel[0], 0.01);
  EXPECT_NEAR(same[0].Score, spots[0].Score, 0.01);
  EXPECT_NEAR(same[0].Level, 0.01 * spots[0].Level, 0.01);
}

TEST(SpotDetection, NothingWhereThereIsNone)
{
  double worst = 0;
  for (unsigned seed = 0; seed < 40; ++seed)
  {
    Bath bath;
    bath.HasWire = false;
    bath.Speckle = 4 + seed;
    bath.HasFloor = seed % 2 == 0;
    GreyImage image = bath.Draw(seed, { 0, 0 });
    if (seed % 4 >= 2) // without the bright lines at the top
    {
      image.Pixels = bath.Pixels.data() + 12 * image.RowStride;
      image.Height -= 12;
    }
    for (const Spot& spot : FindSpots(image))
    {
      worst = std::max(worst, spot.Score);
    }
  }
  std::printf("best score in speckle %.2f\n", worst);
  EXPECT_LT(worst, 0.45);
  std::vector<unsigned char> grey(400 * 300, 7);
  GreyImage image{ ScalarType::UInt8, grey.data(), 400, 400, 300 };
  EXPECT_TRUE(FindSpots(image).empty());
  image.Width = 8;
  EXPECT_TRUE(FindSpots(image).empty());
  std::vector<float> bad(400 * 300, std::numeric_limits<float>::quiet_NaN());
  bad[70 * 400 + 99] = std::numeric_limits<float>::infinity();
  image = { ScalarType::Float32, bad.data(), 400, 400, 300 };
  EXPECT_TRUE(FindSpots(image).empty());
}

TEST(SpotDetection, WideThingsAreNoSpots)
{
  for (const Vec2& size : { Vec2{ 45, 2 }, Vec2{ 2, 30 }, Vec2{ 40, 30 } })
  {
    std::vector<unsigned char> pixels;
    for (int row = 0; row < 300; ++row)
    {
      for (int column = 0; column < 400; ++column)
      {
        const double x = (column - 200) / size[0], y = (row - 150) / size[1];
        pixels.push_back(static_cast<unsigned char>(220 * std::exp(-0.5 * (x * x + y * y))));
      }
    }
    EXPECT_TRUE(FindSpots({ ScalarType::UInt8, pixels.data(), 400, 400, 300 }).empty())
      << size[0] << " " << size[1];
  }
}

TEST(SpotDetection, AnyImageHasAnAnswer)
{
  std::mt19937 random(4);
  const float numbers[6] = { std::numeric_limits<float>::quiet_NaN(),
    -std::numeric_limits<float>::infinity(), std::numeric_limits<float>::max(),
    std::numeric_limits<float>::lowest(), 1e-40F, 100 };
  for (int n = 0; n < 200; ++n)
  {
    const int width = 16 + int(random() % 50), height = 16 + int(random() % 50);
    std::vector<float> pixels(std::size_t(width * height), 0);
    for (std::size_t k = random() % pixels.size(); k > 0; --k)
    {
      pixels[random() % pixels.size()] = numbers[random() % 6];
    }
    for (const Spot& spot : FindSpots({ ScalarType::Float32, pixels.data(), width, width, height }))
    {
      EXPECT_TRUE(spot.Score > 0 && spot.Score <= 1) << spot.Score;
      EXPECT_TRUE(spot.Pixel[0] >= 0 && spot.Pixel[0] <= width - 1) << spot.Pixel[0];
      EXPECT_TRUE(spot.Pixel[1] >= 0 && spot.Pixel[1] <= height - 1) << spot.Pixel[1];
    }
  }
}

// A sweep along a wire: out of sight at times, with specks.
TEST(SpotTracking, FollowsTheWireAndLeavesOutSlicesWithout)
{
  Bath bath;
  bath.Specks = 6;
  int wrong = 0, missing = 0, invented = 0, shown = 0;
  for (unsigned sweep = 0; sweep < 5; ++sweep)
  {
    std::vector<SpotSlice> slices;
    std::vector<Vec2> truth;
    for (int n = 0; n < 60; ++n)
    {
      truth.push_back({ 200 + 140 * std::sin(0.07 * n + sweep), 160 + 2.0 * n - 60 });
      bath.HasWire = n < 15 || (n > 22 && n % 13 != 0);
      bath.Peak = 190 + 40 * std::cos(0.5 * n);
      slices.push_back({ FindSpots(bath.Draw(sweep * 100 + unsigned(n), truth.back())), {} });
      if (!bath.HasWire)
      {
        truth.back() = { -1, -1 };
      }
    }
    const std::vector<std::optional<Spot>> track = TrackSpots(slices, 120);
    for (std::size_t n = 0; n < track.size(); ++n)
    {
      const bool isThere = truth[n][0] >= 0;
      shown += isThere ? 1 : 0;
      missing += isThere && !track[n] ? 1 : 0;
      invented += !isThere && track[n] ? 1 : 0;
      wrong += isThere && track[n] &&
          std::hypot(track[n]->Pixel[0] - truth[n][0], track[n]->Pixel[1] - truth[n][1]) > 3
        ? 1
        : 0;
    }
  }
  std::printf("of %d: wrong %d, missing %d; invented %d\n", shown, wrong, missing, invented);
  EXPECT_EQ(wrong, 0);
  EXPECT_LE(missing, shown / 20);
  EXPECT_LE(invented, 2);
}

TEST(SpotTracking, NothingIsFollowedInMereSpeckle)
{
  Bath bath;
  bath.HasWire = false;
  bath.Speckle = 30;
  std::vector<SpotSlice> slices;
  for (unsigned n = 0; n < 30; ++n)
  {
    GreyImage image = bath.Draw(n, { 0, 0 });
    image.Pixels = bath.Pixels.data() + 12 * image.RowStride; // without the lines at the top
    image.Height -= 12;
    slices.push_back({ FindSpots(image), {} });
  }
  for (const std::optional<Spot>& spot : TrackSpots(slices, 120))
  {
    EXPECT_FALSE(spot) << spot->Score;
  }
}

TEST(SpotTracking, ScatteredScansAreTakenOneByOne)
{
  std::mt19937 random(9);
  std::uniform_real_distribution<double> u(0, 1);
  Bath bath;
  std::vector<SpotSlice> slices;
  std::vector<Vec2> truth;
  for (unsigned n = 0; n < 20; ++n)
  {
    truth.push_back({ 30 + 340 * u(random), 40 + 250 * u(random) });
    slices.push_back({ FindSpots(bath.Draw(n, truth.back())), {} });
  }
  const std::vector<std::optional<Spot>> track = TrackSpots(slices, 120);
  for (std::size_t n = 0; n < track.size(); ++n)
  {
    ASSERT_TRUE(track[n]) << n;
    EXPECT_NEAR(track[n]->Pixel[0], truth[n][0], 1.5);
    EXPECT_NEAR(track[n]->Pixel[1], truth[n][1], 1.5);
  }
}

// Two wires in sight: the known place says which.
TEST(SpotTracking, KnownPlacesLead)
{
  std::vector<SpotSlice> slices;
  for (int n = 0; n < 20; ++n)
  {
    slices.push_back(
      { { { { 100.0 + 2 * n, 50 }, 200, 0.9 }, { { 300.0 - n, 150 }, 200, 0.8 } }, {} });
  }
  std::vector<std::optional<Spot>> track = TrackSpots(slices, 120);
  EXPECT_EQ(track[5]->Pixel[1], 50);
  slices[10].Known = Vec2{ 289.5, 151 };
  track = TrackSpots(slices, 120);
  for (std::size_t n = 0; n < 20; ++n)
  {
    ASSERT_TRUE(track[n]);
    EXPECT_EQ(track[n]->Pixel[1], n == 10 ? 151 : 150);
  }
  EXPECT_EQ(track[10]->Score, 1);
  EXPECT_EQ(track[10]->Level, 0);
  // even if nothing is found anywhere else
  for (SpotSlice& slice : slices)
  {
    slice.Spots.clear();
  }
  track = TrackSpots(slices, 120);
  EXPECT_TRUE(track[10]);
  EXPECT_FALSE(track[9]);
}

TEST(SpotTracking, AfterALongTimeOutOfSightItMayBeAnywhere)
{
  std::vector<SpotSlice> slices(40);
  for (std::size_t n = 0; n < 40; ++n)
  {
    if (n < 10 || n >= 25)
    {
      const double column = n < 10 ? 40 : 360;
      slices[n].Spots = { { { column, 100.0 + double(n) }, 200, 0.9 } };
    }
  }
  const std::vector<std::optional<Spot>> track = TrackSpots(slices, 60);
  int found = 0;
  for (const std::optional<Spot>& spot : track)
  {
    found += spot ? 1 : 0;
  }
  EXPECT_EQ(found, 25);
}

TEST(SpotTracking, WeakSpotsAndEmptySweeps)
{
  EXPECT_TRUE(TrackSpots({}, 10).empty());
  EXPECT_THROW(TrackSpots({}, 0), std::invalid_argument);
  EXPECT_THROW(TrackSpots({}, std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
  std::vector<SpotSlice> slices(10);
  for (std::size_t n = 0; n < 10; ++n)
  {
    slices[n].Spots = { { { 50, 50 }, 100, n == 4 ? 0.3 : 0.9 } };
  }
  slices[7].Spots[0].Pixel = { 300, 200 }; // there and back: a speck
  slices[7].Spots[0].Score = 0.7;
  const std::vector<std::optional<Spot>> track = TrackSpots(slices, 20);
  EXPECT_TRUE(track[3]);
  EXPECT_FALSE(track[4]);
  EXPECT_FALSE(track[7]);
  EXPECT_TRUE(track[8]);
}
