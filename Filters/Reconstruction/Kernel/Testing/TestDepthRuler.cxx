// SPDX-License-Identifier: BSD-3-Clause
/// Rulers are measured on the screens of made-up scanners, and texts are not taken for rulers.
#include "lacunaDepthRuler.h"

#include "lacunaTestScreen.h"

#include <gtest/gtest.h>

#include <string>

using namespace lacuna;

namespace
{
const DetectedFan Linear = []()
{
  DetectedFan fan;
  fan.Rectangle = { 182, 50, 358, 420 };
  return fan;
}();

TestScreen GetScreen()
{
  TestScreen screen;
  screen.Sees = [](double x, double y) { return x >= 182 && x < 540 && y >= 50 && y < 470; };
  return screen;
}

DepthRuler Find(const TestScreen& screen, int frames = 1, const DetectedFan& fan = Linear)
{
  return FindDepthRuler(TestFrames(screen, frames).Frames, fan, { 1, 1 });
}
}

TEST(DepthRuler, TicksWithinTheStatedError)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<double> u(0, 1);
  double worst = 0;
  int within = 0;
  constexpr int cases = 40;
  for (int n = 0; n < cases; ++n)
  {
    TestScreen screen = GetScreen();
    screen.Seed = unsigned(n);
    screen.Depth.Pitch = 8 + 50 * u(random) * u(random);
    screen.Depth.First = 48 + 10 * u(random);
    screen.Depth.Count = 1 + int((465 - screen.Depth.First) / screen.Depth.Pitch);
    screen.Depth.LongEvery = std::array<int, 4>{ 0, 2, 5, 10 }[std::size_t(n % 4)];
    screen.Depth.HasAxis = n % 3 != 0;
    screen.Depth.IsSmooth = n % 5 == 0;
    screen.Depth.Length = 3 + n % 4;
    screen.Depth.Place = n % 7 == 0 ? 130 : 600;
    screen.Noise = n % 2 == 0 ? 0 : 2;
    screen.Blur = n % 6 == 1 ? 0.6 : 0;
    const TickRow row = Find(screen).Depth;
    ASSERT_TRUE(row.IsFound) << n << ": " << row.Text;
    const double error = std::abs(row.Pitch - screen.Depth.Pitch);
    EXPECT_LT(error, 0.5 * screen.Depth.Pitch / (screen.Depth.Count - 1)) << n << " " << row.Text;
    EXPECT_LT(error, 4 * row.PitchError) << n << " " << row.Text;
    within += error < 2 * row.PitchError ? 1 : 0;
    worst = std::max(worst, error / screen.Depth.Pitch);
    EXPECT_EQ(int(row.Ticks.size()), screen.Depth.Count) << n << " " << row.Text;
    if (screen.Depth.Count > 2 * std::max(1, screen.Depth.LongEvery))
    {
      EXPECT_EQ(row.LongEvery, screen.Depth.LongEvery) << n << " " << row.Text;
    }
    EXPECT_NEAR(row.GetSpacing(10), 10 / screen.Depth.Pitch, 1e-2 * 10 / screen.Depth.Pitch);
  }
  std::printf(
    "worst relative error %.4f, within twice the stated error %d of %d\n", worst, within, cases);
  EXPECT_LT(worst, 0.004);
  EXPECT_GE(within, 37);
}

TEST(DepthRuler, BothDirections)
{
  TestScreen screen = GetScreen();
  screen.Across.IsDrawn = true;
  screen.Across.First = 190.4;
  screen.Across.Pitch = 25.2;
  screen.Across.Count = 14;
  screen.Across.Length = 4;
  screen.Across.Place = 490;
  const DepthRuler ruler = Find(screen);
  ASSERT_TRUE(ruler.Depth.IsFound);
  ASSERT_TRUE(ruler.Width.IsFound) << ruler.Width.Text;
  EXPECT_NEAR(ruler.Depth.Pitch, 23.41, 0.04);
  EXPECT_NEAR(ruler.Width.Pitch, 25.2, 0.05);
  EXPECT_NEAR(ruler.Width.Ticks.front(), 190.4, 0.51);
  EXPECT_EQ(ruler.Depth.LongEvery, 5);
  EXPECT_EQ(ruler.Depth.FirstLong, 0);
  EXPECT_EQ(ruler.Depth.Text.find("ticks every 23.4"), 0U) << ruler.Depth.Text;
  EXPECT_NE(ruler.Depth.Text.find("if a tick is 10 mm, 0.42"), std::string::npos);
}

TEST(DepthRuler, BesideASector)
{
  DetectedFan fan;
  fan.IsSector = true;
  fan.Sector = { { 360, -60 }, { -34, 32 }, { 110, 540 } };
  fan.Rectangle = { 60, 31, 590, 450 };
  TestScreen screen;
  const FanMask mask(fan.Sector, screen.Width, screen.Height, { 1, 1 });
  screen.Sees = [&](double x, double y) { return mask.Contains(x, y); };
  for (const int frames : { 1, 6 })
  {
    // within the box around the sector
    screen.Depth.Place = 130;
    screen.Depth.First = 20;
    screen.Depth.Count = 10;
    const TickRow row = Find(screen, frames, fan).Depth;
    ASSERT_TRUE(row.IsFound) << row.Text;
    EXPECT_NEAR(row.Pitch, 23.41, 0.06);
  }
}

TEST(DepthRuler, MissingAndCoveredTicks)
{
  TestScreen screen = GetScreen();
  TestFrames frames(screen, 1);
  for (const int tick : { 4, 9 }) // a mark of the focus, an arrow
  {
    const int row = int(52.3 + tick * 23.41);
    for (int y = row - 6; y < row + 7; ++y)
    {
      std::fill_n(frames.Pixels[0].begin() + y * screen.Width + 599, 12,
        static_cast<std::uint8_t>(tick == 4 ? 0 : 220));
    }
  }
  const TickRow row = FindDepthRuler(frames.Frames, Linear, { 1, 1 }).Depth;
  ASSERT_TRUE(row.IsFound) << row.Text;
  EXPECT_NEAR(row.Pitch, 23.41, 0.05);
}

TEST(DepthRuler, TextsAndSpeckleAreNoRuler)
{
  for (unsigned seed = 0; seed < 12; ++seed)
  {
    TestScreen screen = GetScreen();
    screen.Seed = seed;
    screen.Depth.IsDrawn = false;
    screen.Noise = seed % 2;
    screen.Background = seed % 3 == 0 ? 40 : 0;
    const DepthRuler ruler = Find(screen, seed % 4 == 0 ? 5 : 1);
    EXPECT_FALSE(ruler.Depth.IsFound) << seed << ruler.Depth.Text;
    EXPECT_FALSE(ruler.Width.IsFound) << seed << ruler.Width.Text;
    EXPECT_EQ(ruler.Depth.Text.find("no ruler at the left or the right"), 0U);
    EXPECT_EQ(ruler.Width.Text.find("no ruler above or below"), 0U);
  }
}

TEST(DepthRuler, ThingsBetweenTheTicksMakeThemDoubtful)
{
  TestScreen screen = GetScreen();
  screen.Depth.HasAxis = false;
  screen.Depth.LongEvery = 0;
  TestFrames frames(screen, 1);
  EXPECT_TRUE(FindDepthRuler(frames.Frames, Linear, { 1, 1 }).Depth.IsFound);
  for (int k = 0; k < 12; ++k) // a dotted picture, rather
  {
    const int row = int(52.3 + k * 23.41) + 6 + 7 * k % 11;
    std::fill_n(frames.Pixels[0].begin() + row * screen.Width + 600, 6, std::uint8_t(180));
  }
  EXPECT_FALSE(FindDepthRuler(frames.Frames, Linear, { 1, 1 }).Depth.IsFound);
}

TEST(DepthRuler, NothingAroundTheRegion)
{
  TestScreen screen = GetScreen();
  DetectedFan all;
  all.Rectangle = { 0, 0, screen.Width, screen.Height };
  const DepthRuler ruler = Find(screen, 1, all);
  EXPECT_FALSE(ruler.Depth.IsFound);
  EXPECT_FALSE(ruler.Width.IsFound);
}
