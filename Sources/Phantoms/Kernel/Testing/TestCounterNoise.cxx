// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCounterNoise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

using lacuna::CounterNoise;

TEST(CounterNoise, QuantileInvertsTheDistribution)
{
  for (double p = 1e-15; p < 0.5; p *= 1.07)
  {
    const double x = lacuna::NormalQuantile(p);
    EXPECT_NEAR(0.5 * std::erfc(-x / std::sqrt(2.0)) / p, 1, 2e-13) << p;
  }
  for (double p = 0.01; p < 1; p += 0.01)
  {
    EXPECT_NEAR(0.5 * std::erfc(-lacuna::NormalQuantile(p) / std::sqrt(2.0)), p, 1e-15);
  }
}

TEST(CounterNoise, HasTheMomentsOfIndependentNormalNumbers)
{
  constexpr int N = 1000000;
  const CounterNoise noise(7, 3);
  double sum[5] = {};
  double next = 0;
  double far = 0;
  double previous = 0;
  for (int i = 0; i < N; ++i)
  {
    const double x = noise.Normal(i);
    double power = 1;
    for (double& s : sum)
    {
      s += power;
      power *= x;
    }
    next += x * previous;
    previous = x;
    far += x * noise.Normal(i + 640); // one image row away
  }
  // Five standard errors of each moment.
  const double e = 5 / std::sqrt(static_cast<double>(N));
  EXPECT_NEAR(sum[1] / N, 0, e);
  EXPECT_NEAR(sum[2] / N, 1, e * std::sqrt(2.0));
  EXPECT_NEAR(sum[3] / N, 0, e * std::sqrt(15.0));
  EXPECT_NEAR(sum[4] / N, 3, e * std::sqrt(96.0));
  EXPECT_NEAR(next / N, 0, e);
  EXPECT_NEAR(far / N, 0, e);
}

TEST(CounterNoise, SeedsAndStreamsAreUnrelated)
{
  constexpr int N = 100000;
  const CounterNoise base(1, 0);
  for (const CounterNoise& other : { CounterNoise(2, 0), CounterNoise(1, 1), CounterNoise(0, 1) })
  {
    double correlation = 0;
    for (int i = 0; i < N; ++i)
    {
      correlation += base.Normal(i) * other.Normal(i);
    }
    EXPECT_NEAR(correlation / N, 0, 5 / std::sqrt(static_cast<double>(N)));
  }
  std::set<double> values;
  for (int i = 0; i < 1000; ++i)
  {
    values.insert(base.Uniform(i));
    EXPECT_EQ(base.Uniform(i), CounterNoise(1, 0).Uniform(i));
  }
  EXPECT_EQ(values.size(), 1000u);
  EXPECT_GT(*values.begin(), 0);
  EXPECT_LT(*values.rbegin(), 1);
}
