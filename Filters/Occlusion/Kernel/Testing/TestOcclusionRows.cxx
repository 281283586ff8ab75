// SPDX-License-Identifier: BSD-3-Clause
#include "OcclusionCases.h"
#include "lacunaOcclusionRows.h"

#include <gtest/gtest.h>

#include <algorithm>

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

// exp(-x) as the row operations see it: a row without interpolation.
double LetThrough(const OcclusionRows& rows, double path)
{
  std::vector<float> paths{ static_cast<float>(2 * path) };
  const std::vector<float> zero(1, 0.0F);
  std::vector<float> root(1);
  rows.See(paths.data(), zero.data(), root.data(), 1);
  return root[0];
}
}

TEST(OcclusionRows, ExponentialIsAccurate)
{
  const OcclusionRows rows = GetAllOcclusionRows(false).front();
  EXPECT_EQ(LetThrough(rows, 0), 1);
  double worst = 0;
  double worstFar = 0;
  for (double x = 1e-6; x < 200; x = x * 1.001 + 1e-5)
  {
    const double path = static_cast<float>(2 * x) / 2.0;
    const double truth = std::exp(-std::min(path, 80.0));
    double& bound = x < 10 ? worst : worstFar;
    bound = std::max(bound, std::abs(LetThrough(rows, x) / truth - 1));
  }
  EXPECT_LT(worst, 1.5e-6);
  EXPECT_LT(worstFar, 1e-5);
}

TEST(OcclusionRows, AllInstructionSetsGiveTheSameBits)
{
  for (bool binary : { false, true })
  {
    for (std::int64_t n : { 1, 7, 16, 33, 250 })
    {
      const auto m0 = Random(n + 2, 0.4, 1);
      const auto m1 = Random(n + 2, 0.4, 2);
      const auto near = Random(n + 1, 1.4, 3);
      const auto far = Random(n + 1, 1.4, 4);
      const PathLengths lengths{ 0.5F, 0.25F, 0.0F, 0.4F };
      std::vector<float> first;
      for (const OcclusionRows& rows : GetAllOcclusionRows(binary))
      {
        std::vector<float> result = Random(n, 3, 5);
        rows.AddPath(result.data(), m0.data(), m1.data(), lengths, n);
        std::vector<float> root(n);
        rows.See(result.data(), m1.data(), root.data(), n);
        std::vector<float> hidden = Random(n, 3, 6);
        const OcclusionRows::Side before{ m0.data(), m1.data(), lengths, near.data() + 1,
          far.data() + 1 };
        const OcclusionRows::Side after{ m1.data(), m0.data(), lengths, far.data() + 1,
          near.data() + 1 };
        rows.Hide(hidden.data(), m0.data() + 1, 0.6F, before, after, 0.3F, 0.8F, n);
        rows.HideSide(hidden.data(), m0.data() + 1, 0.6F, after, 0.1F, 0.4F, n);
        result.insert(result.end(), root.begin(), root.end());
        result.insert(result.end(), hidden.begin(), hidden.end());
        if (first.empty())
        {
          first = result;
        }
        EXPECT_EQ(result, first) << "binary " << binary << " n " << n;
      }
    }
  }
}
}
