// SPDX-License-Identifier: BSD-3-Clause
/// The goals for the analytic scene, on the first 60 of its 200 slices and at the spacing of 0.4 mm:
/// the same scene and score as in BenchmarkSweptVolume, whose figures are those of all slices.
#include "lacunaSweptScene.h"
#include "lacunaSweptVolume.h"

#include <gtest/gtest.h>

using namespace lacuna;

namespace
{
constexpr int Slices = 60;

template <class Out, class In>
SceneScore Score(const SceneSweep<In>& sweep, const SweptVolume::Options& options)
{
  const VolumeGrid grid = MakeSceneGrid(sweep.Slices, 0.4);
  const std::array<int, 6> extent{ 0, grid.Dimensions[0] - 1, 0, grid.Dimensions[1] - 1, 0,
    grid.Dimensions[2] - 1 };
  ThreadExecution execution;
  SweptVolume volume(grid, extent, options);
  volume.AddSlices(sweep.Slices, execution);
  const std::vector<char> region = MarkSweptRegion(sweep.TruePoses, grid);
  std::vector<Out> intensity(region.size());
  std::vector<unsigned int> contributions(region.size());
  std::vector<char> mask(region.size());
  volume.Write(intensity.data(), contributions.data(), mask.data(), execution);
  return GetScore(grid, region, intensity.data(), mask.data());
}

// What the guide recommends against noise.
SweptVolume::Options GetNoiseOptions()
{
  SweptVolume::Options options;
  options.FootprintScale = 3.5;
  options.FootprintAcrossSlices = true;
  return options;
}
}

TEST(SweptVolumeAccuracy, WithoutNoise)
{
  const SceneSweep<std::uint8_t> sweep(200, false, Slices);
  const SceneScore inFloat = Score<float>(sweep, {});
  EXPECT_LE(inFloat.Error, 0.12);
  EXPECT_LE(inFloat.All, 0.12);
  EXPECT_GE(inFloat.Filled, 0.999);
  // rounding alone makes 0.289
  const SceneScore inBytes = Score<std::uint8_t>(sweep, {});
  EXPECT_LE(inBytes.Error, 0.32);
  EXPECT_EQ(inBytes.Filled, inFloat.Filled);
  // slices alone or with what lies across them fill the same voxels
  SweptVolume::Options across;
  across.FootprintAcrossSlices = true;
  const SceneScore tall = Score<float>(sweep, across);
  EXPECT_LE(tall.Error, 0.12);
  EXPECT_EQ(tall.Filled, inFloat.Filled);
}

TEST(SweptVolumeAccuracy, WithNoise)
{
  const SceneSweep<float> sweep(200, true, Slices);
  const SceneScore plain = Score<float>(sweep, {});
  const SceneScore smooth = Score<float>(sweep, GetNoiseOptions());
  EXPECT_LE(smooth.Error, 1.5);
  EXPECT_LE(smooth.Error, plain.Error / 3);
  EXPECT_EQ(smooth.Filled, plain.Filled);
  // the first and the last slice are not where they are said to be
  EXPECT_GE(smooth.Filled, 0.99);
}

TEST(SweptVolumeAccuracy, WithNoiseInBytes)
{
  // of this, 0.7 is what speckle loses above 255
  const SceneSweep<std::uint8_t> sweep(200, true, Slices);
  EXPECT_LE(Score<float>(sweep, GetNoiseOptions()).Error, 1.5);
  EXPECT_LE(Score<std::uint8_t>(sweep, GetNoiseOptions()).Error, 1.5);
}
