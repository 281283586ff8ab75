// SPDX-License-Identifier: BSD-3-Clause
#include "OcclusionCases.h"
#include "lacunaSanitized.h"
#include "lacunaShapeGrowth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <string>
#include <vector>

namespace lacuna
{
namespace
{
struct Growth
{
  std::vector<float> Angle;
  std::vector<unsigned char> Object;
  std::vector<GrowthStatistics> Statistics;

  Growth(AttenuationField& field, const GrowthOptions& options, int threads = 0)
    : Angle(field.GetNumberOfVoxels())
    , Object(field.GetNumberOfVoxels())
  {
    ThreadExecution execution(threads);
    GrowShape(
      field, options, this->Angle.data(), this->Object.data(),
      [this](int, const GrowthStatistics& s) { this->Statistics.push_back(s); }, execution);
  }
};

// A 20-cube's surface voxels of which the given fraction is there (Carr 1996, section 5.8).
AttenuationField MakeCube(double present, std::uint64_t seed)
{
  AttenuationField field({ 40, 40, 40 }, { 1, 1, 1 });
  std::vector<float*> surface;
  for (std::int64_t k = 10; k < 30; ++k)
  {
    for (std::int64_t j = 10; j < 30; ++j)
    {
      for (std::int64_t i = 10; i < 30; ++i)
      {
        const auto end = [](std::int64_t c) { return c == 10 || c == 29; };
        if (end(i) || end(j) || end(k))
        {
          surface.push_back(field.Row(j, k) + i);
        }
      }
    }
  }
  Numbers numbers(seed);
  const auto count = static_cast<std::size_t>(present * static_cast<double>(surface.size()));
  for (std::size_t a = 0; a < count; ++a)
  {
    const auto b =
      a + static_cast<std::size_t>(numbers() * static_cast<double>(surface.size() - a));
    std::swap(surface[a], surface[b]);
    *surface[a] = 3;
  }
  return field;
}

bool InCube(std::int64_t voxel)
{
  for (std::int64_t c : { voxel % 40, voxel / 40 % 40, voxel / 1600 })
  {
    if (c < 10 || c > 29)
    {
      return false;
    }
  }
  return true;
}
}

// The thesis's schedule rebuilds the cube of which 80 % of the surface is missing, and adds nothing
// outside, if voxels may close gaps of a third of a voxel between them: as plain cubes they grow to
// 88 % only (90 % with exact rays), at an iteration's delay.
TEST(ShapeGrowth, RebuildsTheCube)
{
  std::vector<double> rebuilt;
  for (std::uint64_t seed = 0; seed < (Sanitized ? 2 : 20); ++seed)
  {
    AttenuationField field = MakeCube(0.2, seed);
    GrowthOptions options;
    options.Binary = true;
    options.Dilation = 1.0 / 3;
    options.Steps = { { 2.5 * Pi, 0 }, { 2.5 * Pi, 0 }, { 2 * Pi, 0 }, { 2 * Pi, 0 } };
    const Growth growth(field, options);
    int inside = 0;
    for (std::size_t i = 0; i < growth.Object.size(); ++i)
    {
      inside += growth.Object[i];
      ASSERT_FALSE(growth.Object[i] && !InCube(static_cast<std::int64_t>(i)));
    }
    EXPECT_EQ(inside, growth.Statistics.back().ObjectVoxels);
    rebuilt.push_back(inside / 8000.0);
    EXPECT_LT(growth.Statistics[1].ObjectVoxels, 2400); // small clusters
  }
  std::sort(rebuilt.begin(), rebuilt.end());
  EXPECT_GE(rebuilt[(rebuilt.size() - 1) / 2], 0.97);
  EXPECT_GE(rebuilt[0], 0.96);
}

// With 90 % missing the thesis's schedule does not grow; one of thresholds and radii does: it grows
// the data into a shell, fills it, shrinks it below the data and grows again up to them.
TEST(ShapeGrowth, RebuildsASparseCube)
{
  for (std::uint64_t seed = 0; seed < 5; ++seed)
  {
    AttenuationField field = MakeCube(0.1, seed);
    GrowthOptions options;
    options.Directions = 300;
    options.KeepData = true;
    options.Steps = { { 0.5 * Pi, 2 }, { 0.5 * Pi, 2 }, { 2.4 * Pi, 0 }, { 2.4 * Pi, 0 },
      { 3.9 * Pi, 3 }, { 3.9 * Pi, 3 } };
    options.Steps.resize(14, { 2.25 * Pi, 0 });
    const Growth growth(field, options);
    int inside = 0;
    for (std::size_t i = 0; i < growth.Object.size(); ++i)
    {
      inside += growth.Object[i];
      ASSERT_FALSE(growth.Object[i] && !InCube(static_cast<std::int64_t>(i)));
    }
    EXPECT_GE(inside, 0.97 * 8000);
  }
}

TEST(ShapeGrowth, DoesNotDependOnThreads)
{
  GrowthOptions options;
  options.Directions = 60;
  options.MedianKernel = 3;
  options.KeepData = true;
  options.Steps = { { 2.4 * Pi, 6 }, { 2 * Pi, 0 } };
  AttenuationField a = MakeCube(0.4, 1);
  AttenuationField b = MakeCube(0.4, 1);
  const Growth one(a, options, 1);
  const Growth five(b, options, 5);
  EXPECT_EQ(one.Angle, five.Angle);
  EXPECT_EQ(one.Object, five.Object);
  EXPECT_EQ(one.Statistics[1].MeanAngle, five.Statistics[1].MeanAngle);
}

TEST(ShapeGrowth, KeepsData)
{
  for (bool keep : { false, true })
  {
    AttenuationField field = MakeCube(0.1, 2);
    const AttenuationField data = field;
    GrowthOptions options;
    options.Directions = 60;
    options.KeepData = keep;
    options.Steps = { { 3.9 * Pi, 0 } };
    const Growth growth(field, options);
    std::int64_t lost = 0;
    FillField(field,
      [&](std::int64_t i, std::int64_t j, std::int64_t k)
      {
        lost += data.Row(j, k)[i] > 0 && !growth.Object[(k * 40 + j) * 40 + i];
        return 0;
      });
    EXPECT_EQ(lost == 0, keep);
  }
}

// 95 % per voxel (Carr 1996, section 5.6), over the shortest edge
TEST(ShapeGrowth, ObjectVoxelsAreNearlyOpaque)
{
  const AttenuationField field({ 4, 4, 4 }, { 2, 0.5, 1 });
  EXPECT_NEAR(std::exp(-0.5 * GetAttenuation(field, 0.95)), 0.05, 1e-12);
  EXPECT_EQ(GetAttenuation(field, 1), GetLargestAttenuation(field));
}

TEST(ShapeGrowth, MedianRemovesASpike)
{
  AttenuationField field({ 9, 9, 1 }, { 1, 1, 1 });
  field.Row(4, 0)[4] = 3;
  GrowthOptions options;
  options.Directions = 40;
  options.Steps = { { Pi, 0 } };
  EXPECT_EQ(Growth(field, options).Statistics[0].ObjectVoxels, 1);
  FillField(field, [](std::int64_t i, std::int64_t j, std::int64_t) { return i == 4 && j == 4; });
  options.MedianKernel = 3;
  const Growth smooth(field, options);
  EXPECT_EQ(smooth.Statistics[0].ObjectVoxels, 0);
}

TEST(ShapeGrowth, SuggestsTheMiddleBetweenTwoPeaks)
{
  std::vector<std::int64_t> counts(100, 0);
  for (int i = 0; i < 100; ++i)
  {
    counts[i] = std::llround(
      4000 * std::exp(-0.02 * (i - 15) * (i - 15)) + 900 * std::exp(-0.05 * (i - 80) * (i - 80)));
  }
  EXPECT_NEAR(SuggestThreshold(counts, 100), 49, 8);
  std::fill(counts.begin(), counts.end(), 0);
  counts[20] = 50;
  EXPECT_EQ(SuggestThreshold(counts, 100), 0);
}

// One rank is stopped by turns at all places, also after the last sum over ranks of an iteration: nobody
// waits for it.
TEST(ShapeGrowth, StopsOnAllRanks)
{
  GrowthOptions options;
  options.Directions = 60; // some for each rank
  options.Steps = { { Pi, 0 }, { Pi, 0 }, { Pi, 0 } };
  options.MedianKernel = 3;
  for (int place = 0; place < 30; ++place)
  {
    std::atomic<int> stopped(0);
    std::atomic<int> told(0);
    ThreadRanks::Run(2,
      [&](const Ranks& ranks)
      {
        AttenuationField field = MakeCube(0.5, 1);
        std::vector<float> angle(field.GetNumberOfVoxels());
        std::vector<unsigned char> object(field.GetNumberOfVoxels());
        ThreadExecution execution(
          1, [&](double done) { return ranks.GetRank() == 0 || done < (place + 0.5) / 30; });
        try
        {
          GrowShape(
            field, options, angle.data(), object.data(), [](int, const GrowthStatistics&) {},
            execution, ranks);
        }
        catch (const Aborted&)
        {
          ++stopped;
        }
        catch (const std::runtime_error& error)
        {
          told += std::string(error.what()).find("another rank") != std::string::npos;
        }
      });
    EXPECT_EQ(stopped, 1) << place;
    EXPECT_EQ(told, 1) << place;
  }
}

TEST(ShapeGrowth, RefusesBadOptions)
{
  AttenuationField field = MakeCube(0.5, 1);
  GrowthOptions good;
  good.Directions = 4;
  good.Steps = { { Pi, 0 } };
  EXPECT_NO_THROW(Growth(field, good));
  GrowthOptions bad = good;
  bad.Steps.clear();
  EXPECT_THROW(Growth(field, bad), std::invalid_argument);
  bad = good;
  bad.Steps[0].Threshold = 4.1 * Pi;
  EXPECT_THROW(Growth(field, bad), std::invalid_argument);
  bad.Steps[0].Threshold = std::nan("");
  EXPECT_THROW(Growth(field, bad), std::invalid_argument);
  bad = good;
  bad.ObjectOpacity = 0;
  EXPECT_THROW(Growth(field, bad), std::invalid_argument);
  bad = good;
  bad.MedianKernel = 4;
  EXPECT_THROW(Growth(field, bad), std::invalid_argument);
  AttenuationField empty({ 8, 8, 8 }, { 1, 1, 1 });
  EXPECT_THROW(Growth(empty, good), std::invalid_argument);
}
}
