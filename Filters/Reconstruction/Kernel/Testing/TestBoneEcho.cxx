// SPDX-License-Identifier: BSD-3-Clause
/// Bone is found where it is in made-up B-scans, and nothing else is.
#include "lacunaBoneEcho.h"

#include "lacunaBonePath.h"
#include "lacunaTestBone.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace lacuna;
using lacunaTestBone::None;
using lacunaTestBone::Scan;

namespace
{
BoneEcho Find(Scan& scan, const BoneEchoOptions& options = {}, int threads = 2)
{
  ThreadExecution execution(threads);
  return BoneEcho(scan.Draw(), options, execution);
}

constexpr double End = 0.8; // mm: there an echo is blurred across beams

// What was found beside the truth, of all beams that are not at an end of the bone.
struct Score
{
  int Found = 0, Missed = 0, False = 0;
  double Mean = 0, Largest = 0; ///< mm
};

Score Compare(const BoneEcho& bone, const Scan& scan)
{
  const BeamGrid& grid = bone.GetBeams();
  Score score;
  for (int k = 0; k < scan.Slices; ++k)
  {
    const std::vector<float>& surface = bone.GetSurface(k);
    for (int b = 0; b < grid.GetNumberOfBeams(); ++b)
    {
      const double x = b * grid.GetBeamStep();
      const bool isBone = scan.Bone(x, k) != None;
      if ((scan.Bone(x - End, k) != None) != isBone || (scan.Bone(x + End, k) != None) != isBone)
      {
        continue;
      }
      const bool isFound = surface[b] >= 0;
      score.Missed += isBone && !isFound ? 1 : 0;
      score.False += !isBone && isFound ? 1 : 0;
      if (isBone && isFound)
      {
        const double error = grid.GetSampleStep() * surface[b] - scan.Bone(x, k);
        ++score.Found;
        score.Mean += error;
        score.Largest = std::max(score.Largest, std::abs(error));
      }
    }
  }
  score.Mean /= std::max(1, score.Found);
  return score;
}

// The echo's highest level is 0.1 to 0.2 mm in front of its middle, because tissue is brighter than shadow.
void ExpectFound(const Score& score, const std::string& what)
{
  EXPECT_GT(score.Found, 300) << what;
  EXPECT_EQ(score.Missed, 0) << what;
  EXPECT_EQ(score.False, 0) << what;
  EXPECT_NEAR(score.Mean, -0.1, 0.1) << what;
  EXPECT_LT(score.Largest, 0.6) << what;
}

double GetLevel(const std::vector<float>& pixels, const Scan& scan, int column, int row)
{
  return pixels[static_cast<std::size_t>(row * scan.Width + column)];
}
}

TEST(BoneEcho, ArcIsFoundAndALayerWithoutShadowIsNot)
{
  Scan scan;
  const BoneEcho bone = Find(scan);
  ExpectFound(Compare(bone, scan), "arc");
  EXPECT_NEAR(bone.GetArea(), 16 * 5, 2 * End * 5); // mm across by mm between the slices
}

TEST(BoneEcho, GainDoesNotMatter)
{
  for (const auto& [gain, offset] : { std::pair{ 0.5, 0.0 }, { 1.5, 0.0 }, { 0.8, 40.0 } })
  {
    Scan scan;
    scan.Gain = gain;
    scan.Offset = offset;
    ExpectFound(Compare(Find(scan), scan), "gain " + std::to_string(gain));
  }
}

TEST(BoneEcho, BeamsOfASectorRunFromItsOrigin)
{
  Scan scan;
  scan.Width = 220;
  scan.PixelWidth = scan.PixelHeight = 0.15;
  scan.Fan = std::make_shared<const FanMask>(lacuna::Fan{ { 100, -60 }, { -35, 30 }, { 12, 46 } },
    scan.Width, scan.Height, Vec2{ 0.15, 0.15 });
  const BoneEcho bone = Find(scan);
  ExpectFound(Compare(bone, scan), "sector");
}

TEST(BoneEcho, NothingIsFoundWithoutBone)
{
  Scan tissue;
  tissue.Bone = [](double, int) { return None; };
  EXPECT_EQ(Find(tissue).GetNumberOfBeams(), 0u);
  Scan black;
  black.Gain = 0;
  EXPECT_EQ(Find(black).GetNumberOfBeams(), 0u);
}

TEST(BoneEcho, SmallPiecesAreLeftOut)
{
  Scan scan; // besides the arc: 5 mm by 2 slices
  scan.Bone = [](double x, int k)
  { return k >= 2 && k < 4 && x > 31 && x < 36 ? 9.0 : Scan::GetArc(x); };
  const BoneEcho all = Find(scan, { 10, 0.25, 3, 0, 4 });
  EXPECT_NEAR(all.GetArea(), 16 * 5 + 5 * 2, 2 * End * 7);
  const BoneEcho large = Find(scan, { 10, 0.25, 3, 30, 4 });
  EXPECT_NEAR(large.GetArea(), 16 * 5, 2 * End * 5);
  EXPECT_LT(large.GetSurface(2)[134], 0);
  EXPECT_GT(all.GetSurface(2)[134], 0);
  EXPECT_LT(all.GetSurface(1)[134], 0);
  Scan alone; // has no area
  alone.Slices = 1;
  EXPECT_GT(Find(alone).GetNumberOfBeams(), 50u);
  EXPECT_EQ(Find(alone).GetArea(), 0);
}

TEST(BoneEcho, GapsAreClosedByStraightLines)
{
  Scan scan;
  scan.Bone = [](double x, int) { return x > 16 && x < 20 ? None : Scan::GetArc(x); };
  const BoneEcho open = Find(scan, { 10, 0.25, 2, 10, 4 });
  const BoneEcho closed = Find(scan, { 10, 0.25, 6, 10, 4 });
  int last = 72; // 18 mm
  while (open.GetSurface(3)[last] < 0)
  {
    --last;
  }
  int next = 72;
  while (open.GetSurface(3)[next] < 0)
  {
    ++next;
  }
  EXPECT_NEAR(last, 64, 3);
  EXPECT_NEAR(next, 80, 3);
  const std::vector<float>& surface = closed.GetSurface(3);
  for (int b = last; b <= next; ++b)
  {
    EXPECT_NEAR(surface[b],
      surface[last] + (surface[next] - surface[last]) * (b - last) / (next - last), 1e-4);
  }
}

TEST(BoneEcho, IsWrittenAsDistances)
{
  Scan scan;
  scan.Bone = [](double x, int) { return x > 9 && x < 25 ? 12.0 : None; };
  const BoneEcho bone = Find(scan);
  std::vector<float> pixels(static_cast<std::size_t>(scan.Width * scan.Height), -1.0f);
  bone.Write(2, pixels.data(), scan.Width);
  const int column = 68; // 17 mm
  const double depth = bone.GetBeams().GetSampleStep() * bone.GetSurface(2)[column];
  for (int row = 0; row < scan.Height; ++row)
  {
    const double behind = (scan.PixelHeight * row - depth) / 4;
    const double truth = std::clamp(std::min(0.5 + behind, 1.5 - behind), 0.0, 1.0);
    EXPECT_NEAR(GetLevel(pixels, scan, column, row), truth, 0.03)
      << row; // the line is not quite straight
  }
  EXPECT_EQ(GetLevel(pixels, scan, 20, 100), 0); // 4 mm beside it
  EXPECT_EQ(GetLevel(pixels, scan, 140, 100), 0);
  const auto levels = std::minmax_element(pixels.begin(), pixels.end());
  EXPECT_EQ(*levels.first, 0);
  EXPECT_NEAR(*levels.second, 1, 0.02);
}

// A steep side is as thick as what lies flat: distances are those to the line, not along beams.
TEST(BoneEcho, StepsAreFilled)
{
  Scan scan;
  scan.Bone = [](double x, int) { return x < 9 || x > 25 ? None : x < 17 ? 10.0 : 20.0; };
  const BoneEcho bone = Find(scan, { 10, 0.25, 3, 10, 4 });
  std::vector<float> pixels(static_cast<std::size_t>(scan.Width * scan.Height));
  bone.Write(2, pixels.data(), scan.Width);
  EXPECT_GT(GetLevel(pixels, scan, 62, 120), 0.5); // 1.5 mm inside of the step, 5 mm behind its top
  EXPECT_LT(GetLevel(pixels, scan, 74, 120), 0.5); // outside of it
  EXPECT_LT(GetLevel(pixels, scan, 40, 140), 0.1); // 7 mm inside
}

TEST(BoneEcho, ThreadsDoNotMatter)
{
  Scan scan;
  const BoneEcho one = Find(scan, {}, 1);
  const BoneEcho five = Find(scan, {}, 5);
  for (int k = 0; k < scan.Slices; ++k)
  {
    EXPECT_EQ(one.GetSurface(k), five.GetSurface(k));
  }
}

TEST(BoneEcho, OptionsThatMakeNoSenseAreRefused)
{
  Scan scan;
  EXPECT_THROW(Find(scan, { 0, 0.25, 3, 50, 4 }), std::invalid_argument);
  EXPECT_THROW(Find(scan, { 10, 1.5, 3, 50, 4 }), std::invalid_argument);
  EXPECT_THROW(Find(scan, { 10, 0.25, -1, 50, 4 }), std::invalid_argument);
  EXPECT_THROW(Find(scan, { 10, 0.25, 3, 50, 0 }), std::invalid_argument);
  ThreadExecution execution(1);
  EXPECT_THROW(BoneEcho({}, {}, execution), std::invalid_argument);
}

namespace
{
double GetSum(const std::vector<float>& gains, int samples, const PathCosts& costs,
  const std::vector<int>& path)
{
  double sum = 0;
  for (std::size_t b = 0; b < path.size(); ++b)
  {
    sum += path[b] >= 0
      ? gains[b * static_cast<std::size_t>(samples) + static_cast<std::size_t>(path[b])]
      : 0;
    if (b > 0 && (path[b] >= 0 || path[b - 1] >= 0))
    {
      sum -= path[b] < 0 || path[b - 1] < 0
        ? costs.End
        : std::min(costs.Jump, costs.Step * std::abs(path[b] - path[b - 1]));
    }
  }
  return sum;
}
}

TEST(BonePath, IsTheBestOfAll)
{
  constexpr int beams = 5, samples = 4;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> gain(-1, 1);
  for (int trial = 0; trial < 40; ++trial)
  {
    std::vector<float> gains(static_cast<std::size_t>(beams * samples));
    for (float& each : gains)
    {
      each = gain(random);
    }
    const PathCosts costs{ 0.1 * (trial % 4), 0.35, 0.05 * (trial % 7) };
    double best = -100;
    for (int code = 0; code < std::pow(samples + 1, beams); ++code)
    {
      std::vector<int> path;
      for (int b = 0, rest = code; b < beams; ++b, rest /= samples + 1)
      {
        path.push_back(rest % (samples + 1) - 1);
      }
      best = std::max(best, GetSum(gains, samples, costs, path));
    }
    EXPECT_NEAR(GetSum(gains, samples, costs, FindBestPath(gains, samples, costs)), best, 1e-6)
      << trial;
  }
  EXPECT_TRUE(FindBestPath({}, 0, { 1, 1, 1 }).empty());
}

TEST(BeamGrid, PlacesOfASectorAreFoundAgain)
{
  Scan scan;
  scan.Slices = 1;
  scan.Fan = std::make_shared<const FanMask>(lacuna::Fan{ { 40, -30 }, { 20, 100 }, { 15, 30 } },
    scan.Width, scan.Height, Vec2{ scan.PixelWidth, scan.PixelHeight });
  const BeamGrid grid(scan.Draw().front());
  for (const int beam : { 0, 7, grid.GetNumberOfBeams() - 1 })
  {
    for (const double sample : { 0.0, 31.25 })
    {
      const Vec2 pixel = grid.GetPixel(beam, sample);
      const Vec2 found = grid.Find(pixel[0], pixel[1]);
      EXPECT_NEAR(found[0], beam, 1e-6);
      EXPECT_NEAR(found[1], sample, 1e-6);
    }
  }
  // the first beam leans by 20 degrees towards growing columns
  const Vec2 first = grid.GetPixel(0, 0);
  EXPECT_NEAR(first[0], 40 + 15 * std::sin(0.3490658503988659) / 0.25, 1e-9);
  EXPECT_NEAR(first[1], -30 + 15 * std::cos(0.3490658503988659) / 0.125, 1e-9);
}

TEST(BeamGrid, WhatTheWindowDoesNotHaveDoesNotCount)
{
  Scan scan;
  scan.Slices = 1;
  scan.Fan = std::make_shared<const FanMask>(lacuna::Fan{ { 150, -30 }, { -30, 60 }, { 5, 60 } },
    scan.Width, scan.Height, Vec2{ scan.PixelWidth, scan.PixelHeight });
  const SliceImage slice = scan.Draw().front();
  const BeamGrid grid(slice);
  std::vector<float> values(grid.GetSize(), 0);
  bool isCut = false;
  for (int b = 0; b < grid.GetNumberOfBeams(); ++b)
  {
    isCut |= grid.GetEnd(b) < grid.GetNumberOfSamples();
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(b) * grid.GetNumberOfSamples();
    std::fill(first + grid.GetBegin(b), first + grid.GetEnd(b), 70.0f);
  }
  EXPECT_TRUE(isCut);
  grid.Smooth(values, 0.3, 0.6);
  for (int b = 0; b < grid.GetNumberOfBeams(); ++b)
  {
    for (int s = grid.GetBegin(b); s < grid.GetEnd(b); ++s)
    {
      ASSERT_NEAR(values[static_cast<std::size_t>(b * grid.GetNumberOfSamples() + s)], 70, 1e-3);
    }
  }
}
