// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaTensorCell.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace
{
using lacuna::FindFirstSignChange;
using lacuna::ScaledBernstein;

/// p (s - root)
ScaledBernstein TimesRoot(const ScaledBernstein& p, double root)
{
  ScaledBernstein product;
  product.Degree = p.Degree + 1;
  product.A.fill(0);
  for (int i = 0; i <= p.Degree; ++i)
  {
    product.A[i] -= p.A[i] * root;
    product.A[i + 1] += p.A[i] * (1 - root);
  }
  return product;
}

ScaledBernstein FromRoots(const std::vector<double>& roots, double factor)
{
  ScaledBernstein p;
  p.A[0] = factor;
  for (const double root : roots)
  {
    p = TimesRoot(p, root);
  }
  return p;
}
}

TEST(Bernstein, EvaluatesProducts)
{
  const ScaledBernstein p = FromRoots({ -0.5, 0.25, 0.75, 1.5, 2 }, 3);
  for (double s = 0; s <= 1; s += 0.0625)
  {
    const double expected = 3 * (s + 0.5) * (s - 0.25) * (s - 0.75) * (s - 1.5) * (s - 2);
    EXPECT_NEAR(p.Value(s), expected, 1e-14) << s;
  }
}

TEST(Bernstein, FindsTheFirstOfRandomRoots)
{
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-0.5, 1.5);
  std::uniform_int_distribution<int> degrees(1, 9);
  int found = 0;
  for (int trial = 0; trial < 20000; ++trial)
  {
    std::vector<double> roots(degrees(random));
    double first = 2;
    double gap = 1;
    for (double& root : roots)
    {
      root = uniform(random);
      if (root > 0 && root < 1)
      {
        gap = std::min(gap, std::abs(root - first));
        first = std::min(first, root);
      }
    }
    for (const double root : roots)
    {
      gap = root == first ? gap : std::min(gap, std::abs(root - first));
    }
    if (gap < 1e-3)
    {
      continue; // ill-conditioned; other tests
    }
    double s = -1;
    const bool hit = FindFirstSignChange(FromRoots(roots, trial % 2 ? 1 : -1), s);
    ASSERT_EQ(hit, first < 1) << trial;
    if (hit)
    {
      ++found;
      ASSERT_NEAR(s, first, 1e-9) << trial;
    }
  }
  EXPECT_GT(found, 5000);
}

TEST(Bernstein, SeesTwoRootsOfAHairsBreadth)
{
  // positive only within half of a crest
  for (const double half : { 1e-2, 1e-4, 1e-6 })
  {
    for (const double crest : { 0.1, 0.5, 1 / 3.0, 0.98 })
    {
      ScaledBernstein p = FromRoots({ crest - half, crest + half }, -1);
      double s = -1;
      ASSERT_TRUE(FindFirstSignChange(p, s)) << half << " " << crest;
      EXPECT_NEAR(s, crest - half, 1e-15 / half + 1e-14);
      for (const double other : { -0.3, 1.4, 2.5, -1.1 })
      {
        p = TimesRoot(p, other);
      }
      ASSERT_TRUE(FindFirstSignChange(p, s)) << half << " " << crest;
      EXPECT_NEAR(s, crest - half, 1e-13 / half + 1e-12);
    }
  }
}

TEST(Bernstein, PassesByWhatDoesNotTouch)
{
  // -(s - 1/2)^2 - gap
  for (const double gap : { 1e-3, 1e-8, 1e-13 })
  {
    ScaledBernstein p;
    p.Degree = 2;
    p.A = { -0.25 - gap, 0.5 - 2 * gap, -0.25 - gap };
    double s = -1;
    EXPECT_FALSE(FindFirstSignChange(p, s)) << gap;
    p.A = { 0.25 + gap, -0.5 + 2 * gap, 0.25 + gap };
    EXPECT_FALSE(FindFirstSignChange(p, s)) << gap;
  }
}

TEST(Bernstein, ZeroCountsAsPositive)
{
  ScaledBernstein zero;
  zero.Degree = 9;
  zero.A.fill(0);
  double s = -1;
  EXPECT_FALSE(FindFirstSignChange(zero, s)); // a plateau at the iso-value is solid throughout
  ScaledBernstein falling;
  falling.Degree = 1;
  falling.A = { 0, -1 };
  ASSERT_TRUE(FindFirstSignChange(falling, s));
  EXPECT_NEAR(s, 0, 1e-12);
  ScaledBernstein reaching;
  reaching.Degree = 3;
  reaching.A = { -1, -1, -1, 0 };
  ASSERT_TRUE(FindFirstSignChange(reaching, s));
  EXPECT_NEAR(s, 1, 1e-9);
}

TEST(Bernstein, TripleRoot)
{
  double s = -1;
  ASSERT_TRUE(FindFirstSignChange(FromRoots({ 0.3, 0.3, 0.3 }, 1), s));
  EXPECT_NEAR(s, 0.3, 1e-5);
}

TEST(Bernstein, IsNotDrawnToARootAtTheStart)
{
  // just below zero and falling: Newton's steps from there lead backwards
  ScaledBernstein p;
  p.Degree = 3;
  p.A = { -1e-300, -1, -1, 3 };
  double s = -1;
  ASSERT_TRUE(FindFirstSignChange(p, s));
  EXPECT_NEAR(p.Value(s), 0, 1e-14);
  EXPECT_GT(s, 0.3);
}
