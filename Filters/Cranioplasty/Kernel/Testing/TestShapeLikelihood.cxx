// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaShapeLikelihood.h"

#include "lacunaSkullTest.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

using lacuna::MirrorPlane;
using lacuna::ShapeLikelihood;
using lacuna::ShapeVariances;
using lacuna::Vec3;

namespace
{
// Places on a sphere of 80 mm with values, and the covariance written down element by element.
struct Small
{
  explicit Small(double spacing = 28)
  {
    const lacunaSkullTest::Waves waves(5, 40, 120);
    for (const Vec3& d : lacunaSkullTest::Spread(spacing))
    {
      this->Places.push_back(80.0 * d);
      this->Values.push_back(waves(this->Places.back()) + 3 + 2 * d[1]);
      this->Terms.insert(this->Terms.end(), { 1, d[0], d[1], d[2] });
      this->Roughness.push_back(1 + 0.4 * d[2]);
    }
    this->Plane.Normal = lacuna::Normalized({ 1, 0.1, 0.05 });
    this->Plane.Offset = 2;
    this->Variances.Common = { 0.1, 0.3, 0.7, 2 };
    this->Variances.Own = { 0.05, 0.2, 0.5, 0.1 };
    this->Variances.Noise = 0.02;
  }
  double Covariance(std::size_t i, std::size_t j) const
  {
    const double roughness = this->Roughness[i] * this->Roughness[j];
    double sum = i == j ? roughness * this->Variances.Noise : 0;
    for (int l = 0; l < 4; ++l)
    {
      const double length = lacuna::ShapeLengths[l];
      const double direct =
        lacuna::MaternCorrelation(Norm(this->Places[i] - this->Places[j]), length);
      const double across = lacuna::MaternCorrelation(
        Norm(this->Places[i] - this->Plane.Reflect(this->Places[j])), length);
      const auto share = [&](std::size_t k)
      {
        const double apart = Norm(this->Places[k] - this->Plane.Reflect(this->Places[k]));
        return 1 + lacuna::MaternCorrelation(apart, length);
      };
      sum += (l < 3 ? roughness : 1) *
        (this->Variances.Own[l] * direct +
          this->Variances.Common[l] * (direct + across) / std::sqrt(share(i) * share(j)));
    }
    return sum;
  }
  ShapeLikelihood Make() const
  {
    lacuna::ThreadExecution execution(1);
    ShapeLikelihood likelihood(this->Places, this->Values, this->Terms, this->Roughness);
    likelihood.SetPlane(this->Plane, execution);
    return likelihood;
  }

  std::vector<Vec3> Places;
  std::vector<double> Values;
  std::vector<double> Terms;
  std::vector<double> Roughness;
  MirrorPlane Plane;
  ShapeVariances Variances;
};

// Solves A x = b for each column of b by elimination with pivots; returns log |det A|.
double Eliminate(std::vector<std::vector<double>>& a, std::vector<std::vector<double>>& b)
{
  const std::size_t n = a.size();
  double logarithm = 0;
  for (std::size_t k = 0; k < n; ++k)
  {
    std::size_t pivot = k;
    for (std::size_t i = k; i < n; ++i)
    {
      pivot = std::abs(a[i][k]) > std::abs(a[pivot][k]) ? i : pivot;
    }
    std::swap(a[k], a[pivot]);
    std::swap(b[k], b[pivot]);
    logarithm += std::log(std::abs(a[k][k]));
    for (std::size_t i = 0; i < n; ++i)
    {
      const double f = i == k ? 0 : a[i][k] / a[k][k];
      for (std::size_t j = 0; f != 0 && j < n; ++j)
      {
        a[i][j] -= f * a[k][j];
      }
      for (std::size_t j = 0; f != 0 && j < b[i].size(); ++j)
      {
        b[i][j] -= f * b[k][j];
      }
    }
  }
  for (std::size_t k = 0; k < n; ++k)
  {
    for (double& x : b[k])
    {
      x /= a[k][k];
    }
  }
  return logarithm;
}
}

TEST(ShapeCovariance, TablesFollowTheFormula)
{
  const Small small;
  const lacuna::ShapeCovariance covariance(small.Variances, 250);
  for (std::size_t i = 0; i < small.Places.size(); i += 3)
  {
    for (std::size_t j = 0; j < small.Places.size(); j += 2)
    {
      const double roughness = small.Roughness[i] * small.Roughness[j];
      const double noise = i == j ? roughness * small.Variances.Noise : 0;
      EXPECT_NEAR(covariance(lacuna::ShapePlace(small.Places[i], small.Plane, small.Roughness[i]),
                    lacuna::ShapePlace(small.Places[j], small.Plane, small.Roughness[j])),
        small.Covariance(i, j) - noise, 1e-8);
    }
  }
}

TEST(ShapeLikelihood, IsTheRestrictedLikelihood)
{
  // of the errors' contrasts: y^T P y + log |K| + log |H^T K^-1 H|, halved
  const Small small;
  const std::size_t n = small.Places.size();
  std::vector<std::vector<double>> k(n, std::vector<double>(n));
  std::vector<std::vector<double>> right(n); // H, y
  for (std::size_t i = 0; i < n; ++i)
  {
    for (std::size_t j = 0; j < n; ++j)
    {
      k[i][j] = small.Covariance(i, j);
    }
    right[i].assign(small.Terms.begin() + 4 * i, small.Terms.begin() + 4 * (i + 1));
    right[i].push_back(small.Values[i]);
  }
  const std::vector<std::vector<double>> given = right;
  double expected = Eliminate(k, right);
  std::vector<std::vector<double>> normal(4, std::vector<double>(4, 0.0));
  std::vector<std::vector<double>> factors(4, std::vector<double>(1, 0.0));
  double square = 0;
  for (std::size_t i = 0; i < n; ++i)
  {
    square += given[i][4] * right[i][4];
    for (int a = 0; a < 4; ++a)
    {
      factors[a][0] += given[i][a] * right[i][4];
      for (int b = 0; b < 4; ++b)
      {
        normal[a][b] += given[i][a] * right[i][b];
      }
    }
  }
  const std::vector<std::vector<double>> sums = factors;
  expected += Eliminate(normal, factors);
  for (int a = 0; a < 4; ++a)
  {
    square -= sums[a][0] * factors[a][0];
  }
  EXPECT_NEAR(small.Make().Evaluate(small.Variances), 0.5 * (expected + square), 1e-7);
}

TEST(ShapeLikelihood, EachIterationRaisesTheLikelihood)
{
  const Small small;
  const ShapeLikelihood likelihood = small.Make();
  ShapeVariances v = small.Variances;
  double cost = likelihood.Evaluate(v);
  for (int i = 0; i < 10; ++i)
  {
    v = likelihood.Estimate(v, 1);
    const double next = likelihood.Evaluate(v);
    EXPECT_LT(next, cost) << i;
    cost = next;
  }
}

TEST(ShapeLikelihood, FindsOutWhatBothSidesShare)
{
  // waves of 40 to 120 mm and their mirror image, with the same variance everywhere: common; then waves
  // alone: own
  for (const bool common : { true, false })
  {
    Small small(14);
    const lacunaSkullTest::Waves waves(6, 40, 120);
    for (std::size_t i = 0; i < small.Places.size(); ++i)
    {
      const Vec3& x = small.Places[i];
      const Vec3 mirrored = small.Plane.Reflect(x);
      small.Values[i] = common
        ? (waves(x) + waves(mirrored)) / std::sqrt(1 + waves.GetCorrelation(x - mirrored))
        : waves(x);
    }
    const ShapeVariances v = small.Make().Estimate(small.Variances, 40);
    const double shared = v.Common[0] + v.Common[1] + v.Common[2];
    const double own = v.Own[0] + v.Own[1] + v.Own[2];
    EXPECT_GT(common ? shared : own, 5 * (common ? own : shared));
  }
}

TEST(ShapeLikelihood, LeavesOutAsIfTheHoleHadNoNodes)
{
  const Small small;
  std::vector<int> hole;
  for (std::size_t i = 0; i < small.Places.size(); ++i)
  {
    if (small.Places[i][0] > 40)
    {
      hole.push_back(static_cast<int>(i));
    }
  }
  ASSERT_GT(hole.size(), 5u);
  const std::vector<double> ratios =
    small.Make().LeaveOut(small.Variances, { { 0, 1, 2 }, hole })[1];
  ASSERT_EQ(ratios.size(), hole.size());
  // universal kriging without them: [K H; H^T 0] [w; l] = [k; h]
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < small.Places.size(); ++i)
  {
    if (small.Places[i][0] <= 40)
    {
      kept.push_back(i);
    }
  }
  const std::size_t m = kept.size();
  std::vector<std::vector<double>> a(m + 4, std::vector<double>(m + 4, 0.0));
  std::vector<std::vector<double>> b(m + 4, std::vector<double>(hole.size()));
  for (std::size_t i = 0; i < m; ++i)
  {
    for (std::size_t j = 0; j < m; ++j)
    {
      a[i][j] = small.Covariance(kept[i], kept[j]);
    }
    for (std::size_t t = 0; t < 4; ++t)
    {
      a[i][m + t] = a[m + t][i] = small.Terms[4 * kept[i] + t];
    }
    for (std::size_t h = 0; h < hole.size(); ++h)
    {
      b[i][h] = small.Covariance(kept[i], hole[h]);
    }
  }
  for (std::size_t h = 0; h < hole.size(); ++h)
  {
    for (std::size_t t = 0; t < 4; ++t)
    {
      b[m + t][h] = small.Terms[4 * hole[h] + t];
    }
  }
  const std::vector<std::vector<double>> given = b;
  Eliminate(a, b);
  for (std::size_t h = 0; h < hole.size(); ++h)
  {
    double estimate = 0;
    double variance = small.Covariance(hole[h], hole[h]);
    for (std::size_t i = 0; i < m + 4; ++i)
    {
      estimate += i < m ? b[i][h] * small.Values[kept[i]] : 0;
      variance -= b[i][h] * given[i][h];
    }
    EXPECT_NEAR(ratios[h], std::abs(small.Values[hole[h]] - estimate) / std::sqrt(variance), 1e-6);
  }
}

TEST(ShapeLikelihood, RefusesPlacesThatDoNotDetermineTheMean)
{
  Small small;
  for (std::size_t i = 0; i < small.Places.size(); ++i)
  {
    small.Terms[4 * i + 3] = small.Terms[4 * i + 2];
  }
  EXPECT_THROW(small.Make().Estimate(small.Variances, 1), std::runtime_error);
}
