// SPDX-License-Identifier: BSD-3-Clause
#include "OcclusionCases.h"
#include "lacunaOcclusionRows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace lacuna
{
namespace
{
std::vector<float> Random(std::size_t n, double scale, std::uint64_t seed)
{
  Numbers numbers(seed);
  std::vector<float> values(n);
  std::generate(values.begin(), values.end(),
    [&] { return static_cast<float>(scale * std::max(0.0, numbers() - 0.3)); });
  return values;
}

// 2^-x as the row operations see it: one voxel that sees through a path on one side.
double LetThrough(const OcclusionRows& rows, float path)
{
  const float own = 0;
  const float between[2] = { path, path };
  std::uint32_t hidden = 0;
  const OcclusionRows::Side side{ between + 1, { { &own, &own, &own }, { 0, 0, 0 } } };
  rows.HideSide(&hidden, &own, 1, side, 0, 1, 1);
  return 1 - hidden / static_cast<double>(HiddenUnits);
}

/// Of hidden fractions.
std::vector<std::uint32_t> RandomSums(std::size_t n, double scale, std::uint64_t seed)
{
  const std::vector<float> values = Random(n, scale * HiddenUnits, seed);
  return { values.begin(), values.end() };
}
}

TEST(OcclusionRows, PowerIsAccurate)
{
  for (const OcclusionRows& rows : GetAllOcclusionRows(false))
  {
    EXPECT_EQ(LetThrough(rows, 0), 1);
    for (double x = 1e-6; x < 300; x = x * 1.001 + 1e-5)
    {
      const auto path = static_cast<float>(x);
      const double rounding = 0.5 / HiddenUnits;
      ASSERT_NEAR(LetThrough(rows, path), std::exp2(-static_cast<double>(path)), 1.5e-7 + rounding)
        << x;
    }
  }
}

// By the definition, one value after the other.
TEST(OcclusionRows, DoWhatTheySay)
{
  for (bool binary : { false, true })
  {
    const OcclusionRows rows = GetAllOcclusionRows(binary).back();
    const int n = 40;
    const auto a = Random(n, 1, 1);
    const auto b = Random(n, 1, 2);
    const auto c = Random(n, 1, 3);
    const LayerCrossing layer{ { a.data(), b.data(), c.data() }, { 0.5F, 0.2F, 0.7F } };
    auto path = Random(n, 2, 4);
    const auto first = path;
    rows.AddPath(path.data(), { layer, n, 1, 0, 0, 0 });
    auto row = Random(n, 1, 5);
    const auto previous = row;
    std::vector<float> between(n);
    const auto from = Random(n, 2, 6);
    rows.See(from.data(), path.data(), row.data(), between.data(), 0.25F, n);
    auto hidden = RandomSums(n, 1, 7);
    const auto start = hidden;
    const OcclusionRows::Side one{ between.data() + 1, layer };
    const OcclusionRows::Side two{ previous.data() + 1, layer };
    rows.Hide(hidden.data() + 1, c.data() + 1, 0.3F, one, two, 0.6F, 1.25F, n - 1);
    auto hiddenSide = start;
    rows.HideSide(hiddenSide.data() + 1, c.data() + 1, 0.3F, one, 0.6F, 1.25F, n - 1);
    for (int i = 0; i < n; ++i)
    {
      EXPECT_NEAR(path[i], first[i] + 0.5 * a[i] + 0.2 * b[i] + 0.7 * c[i], 1e-5);
      const double length = std::max(0.0F, path[i] - from[i]);
      const double seen = binary ? (length > 0 ? 1 : 0) : length;
      EXPECT_NEAR(row[i], seen, 1e-5);
      EXPECT_NEAR(between[i], 0.75 * seen + 0.25 * previous[i], 1e-5);
      if (i == 0)
      {
        continue;
      }
      const auto side = [&](const std::vector<float>& rest)
      {
        const double between2 = 0.4 * rest[i] + 0.6 * rest[i - 1];
        const double own = 0.3 * c[i];
        const double next = 0.5 * a[i - 1] + 0.2 * b[i - 1] + 0.7 * c[i - 1];
        const double part = std::min(1.0, 1.25 * between2);
        return binary ? (own + next > 0 ? 1 : part) : 1 - std::exp2(-own - between2);
      };
      const double finest = HiddenUnits;
      EXPECT_NEAR((hidden[i] - start[i]) / finest, side(between) + side(previous), 1e-6);
      EXPECT_NEAR((hiddenSide[i] - start[i]) / finest, side(between), 1e-6);
    }
  }
}

namespace
{
/// Rows of rays and the voxels that they serve.
struct Plane
{
  static constexpr std::int64_t Stride = 300; // of rays; voxels have one more
  static constexpr std::int64_t Rows = 3;

  std::vector<float> Field = Random((Stride + 1) * (Rows + 1), 0.4, 1);
  std::vector<float> Total = Random(Stride * Rows, 9, 2);
  std::vector<float> Path = Random(Stride * Rows, 4, 3);
  std::vector<std::uint32_t> Hidden = RandomSums((Stride + 1) * Rows, 5, 4);
  std::vector<float> After = Random(Stride, 3, 5);
  std::vector<float> Before = Random(Stride, 3, 6);

  /// Rays that pass some voxels.
  LayerRays GetRays(int voxels, std::int64_t n) const
  {
    const float* first = this->Field.data();
    return { { { first + 1, first + Stride + 1, first + Stride + 2 },
               { 0.5F, voxels > 1 ? 0.25F : 0, voxels > 2 ? 0.4F : 0 } },
      n, Rows, Stride, Stride + 1, 0 };
  }

  OcclusionRows::Passage GetPassage(int voxels, std::int64_t n, bool firstServes)
  {
    return { this->GetRays(voxels, n), this->Path.data(), this->Total.data(), this->After.data(),
      this->Before.data(), 0.3F, 0.6F, this->Field.data(), 0.7F, this->Hidden.data(), Stride + 1, 0,
      firstServes };
  }

  std::vector<float> GetPaths() const
  {
    std::vector<float> all = this->Path;
    for (const auto* part : { &this->Total, &this->After, &this->Before })
    {
      all.insert(all.end(), part->begin(), part->end());
    }
    return all;
  }
};
}

// A layer is passed as by its steps, in other loops.
TEST(OcclusionRows, PassIsItsSteps)
{
  for (const OcclusionRows& rows : GetAllOcclusionRows(false))
  {
    for (std::int64_t n : { 1, 2, 5, 17, 33, 49, 250 })
    {
      for (int voxels : { 1, 2, 3 })
      {
        for (bool firstServes : { false, true })
        {
          Plane one;
          rows.Pass(one.GetPassage(voxels, n, firstServes));
          Plane two;
          std::vector<float> between[2]{ std::vector<float>(n), std::vector<float>(n) };
          const std::vector<float> zero(n, 0.0F);
          for (std::int64_t row = 0; row < Plane::Rows; ++row)
          {
            LayerRays rays = two.GetRays(voxels, n);
            rays.Rows = 1;
            for (const float*& voxel : rays.Layer.Voxels)
            {
              voxel += row * (Plane::Stride + 1);
            }
            float* path = two.Path.data() + row * Plane::Stride;
            rows.See(zero.data(), path, two.After.data(), between[0].data(), 0.3F, n);
            rows.AddPath(path, rays);
            rows.See(path, two.Total.data() + row * Plane::Stride, two.Before.data(),
              between[1].data(), 0.3F, n);
            if (row > 0 || firstServes)
            {
              const std::int64_t first = row * (Plane::Stride + 1) + 1;
              rows.Hide(two.Hidden.data() + first, two.Field.data() + first, 0.7F,
                { between[0].data() + 1, rays.Layer }, { between[1].data() + 1, rays.Layer }, 0.6F,
                1, n - 1);
            }
          }
          EXPECT_EQ(one.Path, two.Path);
          EXPECT_EQ(one.After, two.After);
          EXPECT_EQ(one.Before, two.Before);
          for (std::size_t i = 0; i < one.Hidden.size(); ++i)
          {
            // rounded in another order
            ASSERT_LE(std::abs(static_cast<std::int64_t>(one.Hidden[i]) - two.Hidden[i]), 2)
              << i << " of " << n;
          }
        }
      }
    }
  }
}

TEST(OcclusionRows, AllInstructionSetsPassTheSameBits)
{
  for (std::int64_t n : { 1, 2, 9, 17, 32, 45, 250 })
  {
    for (int voxels : { 1, 2, 3 })
    {
      std::vector<float> first;
      std::vector<std::uint32_t> firstHidden;
      for (const OcclusionRows& rows : GetAllOcclusionRows(false))
      {
        Plane plane;
        rows.AddPath(plane.Total.data(), plane.GetRays(voxels, n));
        rows.Pass(plane.GetPassage(voxels, n, false));
        if (first.empty())
        {
          first = plane.GetPaths();
          firstHidden = plane.Hidden;
        }
        EXPECT_EQ(plane.GetPaths(), first) << "n " << n << " voxels " << voxels;
        EXPECT_EQ(plane.Hidden, firstHidden) << "n " << n << " voxels " << voxels;
      }
    }
  }
}

TEST(OcclusionRows, AllInstructionSetsGiveTheSameBits)
{
  for (bool binary : { false, true })
  {
    for (std::int64_t n : { 1, 7, 16, 33, 250 })
    {
      const auto m0 = Random(n + 1, 0.4, 1);
      const auto m1 = Random(n + 1, 0.4, 2);
      const LayerCrossing layer{ { m0.data(), m0.data() + 1, m1.data() + 1 },
        { 0.5F, 0.25F, 0.4F } };
      std::vector<float> first;
      std::vector<std::uint32_t> firstHidden;
      for (const OcclusionRows& rows : GetAllOcclusionRows(binary))
      {
        std::vector<float> result = Random(n, 3, 5);
        rows.AddPath(result.data(), { layer, n, 1, 0, 0, 0 });
        std::vector<float> row = Random(n, 1, 3);
        std::vector<float> between(n + 1, 0.5F);
        rows.See(m1.data(), result.data(), row.data(), between.data() + 1, 0.2F, n);
        std::vector<std::uint32_t> hidden = RandomSums(n, 3, 6);
        const OcclusionRows::Side before{ between.data() + 1, layer };
        const OcclusionRows::Side after{ m1.data() + 1, layer };
        rows.Hide(hidden.data(), m0.data() + 1, 0.6F, before, after, 0.3F, 1.2F, n);
        rows.HideSide(hidden.data(), m0.data(), 0.8F, after, 0.1F, 1.0F, n);
        result.insert(result.end(), row.begin(), row.end());
        result.insert(result.end(), between.begin(), between.end());
        if (first.empty())
        {
          first = result;
          firstHidden = hidden;
        }
        EXPECT_EQ(hidden, firstHidden) << "binary " << binary << " n " << n;
        EXPECT_EQ(result, first) << "binary " << binary << " n " << n;
      }
    }
  }
}
}
