// SPDX-License-Identifier: BSD-3-Clause
/// The scan region is found on the screens of made-up scanners, in one frame and in several.
#include "lacunaScanRegion.h"

#include "lacunaDepthRuler.h"
#include "lacunaTestScreen.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>

using namespace lacuna;

namespace
{
struct Case
{
  const char* Name;
  Fan Truth;
};

const std::vector<Case>& GetSectors()
{
  static const std::vector<Case> cases{
    { "curved", { { 360, -60 }, { -34, 32 }, { 110, 540 } } },
    { "phased", { { 355, 40 }, { -42, 42 }, { 0, 440 } } },
    { "steered", { { 300, 20 }, { -22, 40 }, { 25, 460 } } },
    { "wide", { { 350, -10 }, { -58, 58 }, { 60, 280 } } },
  };
  return cases;
}

double GetOverlap(const TestScreen& screen, const DetectedFan& fan, const Vec2& spacing)
{
  std::optional<FanMask> mask;
  if (fan.IsSector)
  {
    mask.emplace(fan.Sector, screen.Width, screen.Height, spacing);
  }
  double both = 0, any = 0;
  for (int y = 0; y < screen.Height; ++y)
  {
    for (int x = 0; x < screen.Width; ++x)
    {
      const std::array<int, 4>& r = fan.Rectangle;
      const bool found =
        mask ? mask->Contains(x, y) : x >= r[0] && x < r[0] + r[2] && y >= r[1] && y < r[1] + r[3];
      const bool is = screen.Sees(x, y);
      both += found && is ? 1 : 0;
      any += found || is ? 1 : 0;
    }
  }
  return both / any;
}

void ExpectFound(TestScreen screen, const Case& c, int frames, double overlap, const char* what)
{
  const FanMask truth(c.Truth, screen.Width, screen.Height, { 1, 1 });
  screen.Sees = [&](double x, double y) { return truth.Contains(x, y); };
  const ScanRegion found = FindScanRegion(TestFrames(screen, frames).Frames, { 1, 1 });
  ASSERT_TRUE(found.IsFound) << c.Name << ", " << what << ": " << found.Text;
  ASSERT_TRUE(found.Fan.IsSector) << c.Name << ", " << what << ": " << found.Text;
  EXPECT_GT(GetOverlap(screen, found.Fan, { 1, 1 }), overlap)
    << c.Name << ", " << what << ": origin " << found.Fan.Sector.Origin[0] << ", "
    << found.Fan.Sector.Origin[1] << " angles " << found.Fan.Sector.Angles[0] << ", "
    << found.Fan.Sector.Angles[1] << " radii " << found.Fan.Sector.Radii[0] << ", "
    << found.Fan.Sector.Radii[1] << " confidence " << found.Confidence;
  EXPECT_GT(found.Confidence, 0.3) << c.Name << ", " << what;
  EXPECT_LE(found.Confidence, 1);
}

TestScreen GetLinear()
{
  TestScreen screen;
  screen.Sees = [](double x, double y) { return x >= 182 && x < 540 && y >= 50 && y < 470; };
  return screen;
}

std::string GetDoubt(const TestScreen& screen, int frames)
{
  const ScanRegion found = FindScanRegion(TestFrames(screen, frames).Frames, { 1, 1 });
  return found.IsFound ? "found " + found.Text : found.Text;
}
}

TEST(ScanRegion, SectorsInOneFrame)
{
  for (const Case& c : GetSectors())
  {
    TestScreen screen;
    ExpectFound(screen, c, 1, 0.98, "plain");
    screen.Noise = 2;
    screen.Blur = 0.7;
    ExpectFound(screen, c, 1, 0.96, "analogue video");
    screen.Noise = screen.Blur = 0;
    screen.Background = 40;
    ExpectFound(screen, c, 1, 0.97, "grey screen");
    screen.Window = { 52, 12, 620, 500 };
    ExpectFound(screen, c, 1, 0.98, "black window in a grey screen");
  }
}

TEST(ScanRegion, SectorsInSeveralFramesAreSurer)
{
  for (const Case& c : GetSectors())
  {
    TestScreen screen;
    ExpectFound(screen, c, 8, 0.98, "eight frames");
    const FanMask truth(c.Truth, screen.Width, screen.Height, { 1, 1 });
    screen.Sees = [&](double x, double y) { return truth.Contains(x, y); };
    const ScanRegion one = FindScanRegion(TestFrames(screen, 1).Frames, { 1, 1 });
    const ScanRegion eight = FindScanRegion(TestFrames(screen, 8).Frames, { 1, 1 });
    EXPECT_GT(eight.Confidence, one.Confidence) << c.Name;
    EXPECT_GT(eight.Confidence, 0.7) << c.Name;
    EXPECT_NE(eight.Text.find("which agree"), std::string::npos) << eight.Text;
  }
}

TEST(ScanRegion, LinearProbe)
{
  for (const int frames : { 1, 8 })
  {
    for (const double background : { 0.0, 50.0 })
    {
      TestScreen screen = GetLinear();
      screen.Background = background;
      const ScanRegion found = FindScanRegion(TestFrames(screen, frames).Frames, { 1, 1 });
      ASSERT_TRUE(found.IsFound) << found.Text;
      EXPECT_FALSE(found.Fan.IsSector);
      EXPECT_EQ(found.Fan.Rectangle, (std::array<int, 4>{ 182, 50, 358, 420 }));
      EXPECT_GT(found.Confidence, 0.6);
    }
  }
  TestScreen screen = GetLinear();
  screen.Background = 60;
  screen.Window = { 140, 30, 440, 460 };
  const ScanRegion found = FindScanRegion(TestFrames(screen, 1).Frames, { 1, 1 });
  EXPECT_EQ(found.Fan.Rectangle, (std::array<int, 4>{ 182, 50, 358, 420 })) << found.Text;
}

TEST(ScanRegion, OblongPixelsAndUnits)
{
  const Fan truth{ { 360, -30 }, { -32, 30 }, { 110, 560 } };
  TestScreen screen;
  const Vec2 spacing{ 0.25, 0.3 };
  Fan inMm = truth;
  inMm.Radii = { 0.25 * truth.Radii[0], 0.25 * truth.Radii[1] };
  const FanMask mask(inMm, screen.Width, screen.Height, spacing);
  screen.Sees = [&](double x, double y) { return mask.Contains(x, y); };
  const ScanRegion found = FindScanRegion(TestFrames(screen, 1).Frames, spacing);
  ASSERT_TRUE(found.Fan.IsSector) << found.Text;
  EXPECT_GT(GetOverlap(screen, found.Fan, spacing), 0.98);
  EXPECT_NEAR(found.Fan.Sector.Radii[1], inMm.Radii[1], 0.6);
  const ScanRegion inPixels =
    FindScanRegion(TestFrames(screen, 1).Frames, { 1, spacing[1] / spacing[0] });
  EXPECT_NEAR(inPixels.Fan.Sector.Radii[1], truth.Radii[1], 2.4);
}

TEST(ScanRegion, CroppedPictureIsAllRegion)
{
  TestScreen screen;
  screen.HasTexts = screen.HasShadow = screen.Depth.IsDrawn = false;
  screen.Sees = [](double, double) { return true; };
  const ScanRegion found = FindScanRegion(TestFrames(screen, 1).Frames, { 1, 1 });
  ASSERT_TRUE(found.IsFound) << found.Text;
  EXPECT_EQ(found.Fan.Rectangle, (std::array<int, 4>{ 0, 0, screen.Width, screen.Height }));
}

// Random sectors: a confidence above 0.7 may be trusted.
TEST(ScanRegion, ConfidenceIsEarned)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(0, 1);
  int sure = 0, found = 0;
  for (int n = 0; n < 24; ++n)
  {
    Case c{ "random", {} };
    const double half = 18 + 35 * u(random);
    const double tilt = 12 * (u(random) - 0.5);
    c.Truth.Angles = { tilt - half, tilt + half };
    c.Truth.Radii[0] = 150 * u(random);
    c.Truth.Origin = { 340 + 40 * u(random), 40 - c.Truth.Radii[0] };
    c.Truth.Radii[1] = c.Truth.Radii[0] + 260 + 120 * u(random);
    TestScreen screen;
    screen.Seed = unsigned(n);
    screen.Gain = 20 + 60 * u(random);
    screen.Noise = n % 2 == 0 ? 0 : 1.5;
    const FanMask truth(c.Truth, screen.Width, screen.Height, { 1, 1 });
    screen.Sees = [&](double x, double y) { return truth.Contains(x, y) && x > 120 && x < 585; };
    const ScanRegion region = FindScanRegion(TestFrames(screen, 1).Frames, { 1, 1 });
    if (region.IsFound)
    {
      const double overlap = GetOverlap(screen, region.Fan, { 1, 1 });
      ++found;
      if (region.Confidence > 0.7)
      {
        ++sure;
        EXPECT_GT(overlap, 0.97) << n << " " << region.Text;
      }
      EXPECT_GT(overlap, 0.9) << n << " " << region.Text;
    }
  }
  std::printf("found %d, sure %d of 24\n", found, sure);
  EXPECT_GE(found, 18);
  EXPECT_GE(sure, 8);
}

TEST(ScanRegion, SaysWhyNotFound)
{
  TestScreen screen;
  screen.Sees = [](double, double) { return false; };
  EXPECT_EQ(GetDoubt(screen, 1).find("the scan region is not found"), 0U) << GetDoubt(screen, 1);
  EXPECT_EQ(GetDoubt(screen, 5).find("the scan region is not found"), 0U) << GetDoubt(screen, 5);
  EXPECT_NE(GetDoubt(screen, 1).find("Give several frames"), std::string::npos);
  // a disc is no region of a probe
  screen.Sees = [](double x, double y) { return std::hypot(x - 350, y - 260) < 180; };
  EXPECT_NE(GetDoubt(screen, 1).find("cannot be found for certain"), std::string::npos);
  // a painted panel
  screen.Sees = {};
  screen.HasTexts = screen.Depth.IsDrawn = false;
  screen.Background = 30;
  screen.Window = { 150, 60, 400, 400 };
  EXPECT_NE(GetDoubt(screen, 1).find("grain"), std::string::npos) << GetDoubt(screen, 1);
  screen.Window = {};
  EXPECT_NE(GetDoubt(screen, 1).find("one grey"), std::string::npos) << GetDoubt(screen, 1);
}

TEST(ScanRegion, WrongFrames)
{
  EXPECT_THROW(FindScanRegion({}, { 1, 1 }), std::invalid_argument);
  TestFrames frames(GetLinear(), 2);
  EXPECT_THROW(FindScanRegion(frames.Frames, { 1, 0 }), std::invalid_argument);
  EXPECT_THROW(FindScanRegion(frames.Frames, { 1, std::numeric_limits<double>::quiet_NaN() }),
    std::invalid_argument);
  frames.Frames[1].Height -= 1;
  EXPECT_THROW(FindScanRegion(frames.Frames, { 1, 1 }), std::invalid_argument);
  frames.Frames[0].Height = 8;
  EXPECT_THROW(FindScanRegion({ frames.Frames[0] }, { 1, 1 }), std::invalid_argument);
}

// Blocks of noise, of one grey and of what is no number, in all sizes: an answer, whichever.
TEST(ScanRegion, AnyFramesHaveAnAnswer)
{
  std::mt19937 random(11);
  for (int n = 0; n < 150; ++n)
  {
    const int width = 16 + int(random() % 60), height = 16 + int(random() % 60);
    const std::size_t count = 1 + random() % 5;
    std::vector<std::vector<float>> pixels(
      count, std::vector<float>(std::size_t(width * height), float(random() % 3)));
    std::vector<SliceImage> frames;
    for (std::vector<float>& frame : pixels)
    {
      for (int block = int(random() % 4); block >= 0; --block)
      {
        const int left = int(random() % unsigned(width)), top = int(random() % unsigned(height));
        const int kind = int(random() % 5);
        for (int y = top; y < std::min(height, top + int(random() % 60)); ++y)
        {
          for (int x = left; x < std::min(width, left + 40); ++x)
          {
            frame[std::size_t(y * width + x)] = kind == 0 ? std::numeric_limits<float>::quiet_NaN()
              : kind == 1                                 ? std::numeric_limits<float>::infinity()
              : kind == 2                                 ? 3e38F * (random() % 2 ? 1 : -1)
                                                          : float(random() % 200);
          }
        }
      }
      SliceImage slice;
      slice.Type = ScalarType::Float32;
      slice.Pixels = frame.data();
      slice.RowStride = slice.Width = width;
      slice.Height = height;
      frames.push_back(slice);
    }
    const ScanRegion region = FindScanRegion(frames, { 1, 1 });
    EXPECT_FALSE(region.Text.empty());
    DetectedFan fan = region.Fan;
    if (region.IsFound)
    {
      EXPECT_TRUE(region.Confidence >= 0 && region.Confidence <= 1);
      EXPECT_GE(fan.Rectangle[0], 0);
      EXPECT_LE(fan.Rectangle[0] + fan.Rectangle[2], width);
      EXPECT_LE(fan.Rectangle[1] + fan.Rectangle[3], height);
    }
    else
    {
      fan.Rectangle = { int(random() % 10), 2, 5, height };
    }
    EXPECT_FALSE(FindDepthRuler(frames, fan, { 1, 1 }).Depth.Text.empty());
  }
}
