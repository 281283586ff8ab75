// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaTensorCell.h"
#include "lacunaTestField.h"

#include <gtest/gtest.h>

namespace
{
using namespace lacuna;

template <int S>
TensorCell<S> RandomCell(std::mt19937& random)
{
  std::uniform_real_distribution<double> uniform(-1, 1);
  TensorCell<S> cell;
  for (double& p : cell.Points)
  {
    p = uniform(random);
  }
  return cell;
}

/// The field by its definition: weights in powers of x.
template <int S>
double Direct(const TensorCell<S>& cell, const Vec3& at)
{
  std::array<double, 4> w[3];
  for (int a = 0; a < 3; ++a)
  {
    w[a] =
      S == 4 ? TestField::CubicWeights(at[a]) : std::array<double, 4>{ 1 - at[a], at[a], 0, 0 };
  }
  double sum = 0;
  for (int n = 0; n < S * S * S; ++n)
  {
    sum += cell.Points[n] * w[0][n % S] * w[1][n / S % S] * w[2][n / S / S];
  }
  return sum;
}

template <int S>
void CheckCells()
{
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int trial = 0; trial < 300; ++trial)
  {
    const TensorCell<S> cell = RandomCell<S>(random);
    const Vec3 from{ uniform(random), uniform(random), uniform(random) };
    Vec3 to{ uniform(random), uniform(random), uniform(random) };
    int moving = 3;
    for (int a = 0; a < 3; ++a)
    {
      if (trial >> a & 1) // lines along faces and axes, and points
      {
        to[a] = from[a];
        --moving;
      }
    }
    const ScaledBernstein p = cell.Along(from, to);
    EXPECT_EQ(p.Degree, moving <= 1 ? S - 1 : 3 * (S - 1));
    for (double s = 0; s <= 1; s += 0.125)
    {
      const Vec3 at = from + s * (to - from);
      ASSERT_NEAR(p.Value(s), Direct(cell, at), 1e-14);
      ASSERT_NEAR(cell.Value(at), Direct(cell, at), 1e-14);
    }
    const Vec3 gradient = cell.Gradient(from);
    for (int a = 0; a < 3; ++a)
    {
      Vec3 step{ 0, 0, 0 };
      step[a] = 1e-5;
      const double difference = (Direct(cell, from + step) - Direct(cell, from - step)) / 2e-5;
      ASSERT_NEAR(gradient[a], difference, 1e-9);
    }
  }
}
}

TEST(TensorCell, CubicAgreesWithItsDefinition)
{
  CheckCells<4>();
}

TEST(TensorCell, TrilinearAgreesWithItsDefinition)
{
  CheckCells<2>();
}

TEST(TensorCell, CoefficientsStayInTheHullOfThePoints)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  constexpr double binomial[10] = { 1, 9, 36, 84, 126, 126, 84, 36, 9, 1 };
  for (int trial = 0; trial < 300; ++trial)
  {
    const TensorCell<4> cell = RandomCell<4>(random);
    const auto range = std::minmax_element(std::begin(cell.Points), std::end(cell.Points));
    const ScaledBernstein p = cell.Along({ uniform(random), uniform(random), uniform(random) },
      { uniform(random), uniform(random), uniform(random) });
    for (int i = 0; i <= 9; ++i)
    {
      ASSERT_GE(p.A[i] / binomial[i], *range.first - 1e-14);
      ASSERT_LE(p.A[i] / binomial[i], *range.second + 1e-14);
    }
  }
}
