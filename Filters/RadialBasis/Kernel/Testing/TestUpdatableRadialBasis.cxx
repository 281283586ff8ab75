// SPDX-License-Identifier: BSD-3-Clause
// Updates against new fits, and the reduction of centres.
#include "lacunaCenterReduction.h"
#include "lacunaExecution.h"
#include "lacunaUpdatableRadialBasis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

namespace
{
using lacuna::RadialBasis;
using lacuna::RadialBasisOptions;
using lacuna::RadialKernel;
using lacuna::UpdatableRadialBasis;

template <int Dimension>
using Points = std::vector<std::array<double, Dimension>>;

template <int Dimension>
Points<Dimension> Scatter(int count, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 80);
  Points<Dimension> points(count);
  for (auto& p : points)
  {
    for (double& x : p)
    {
      x = uniform(random);
    }
  }
  return points;
}

template <int Dimension>
double Value(const std::array<double, Dimension>& p)
{
  return 10 + std::sin(p[0] / 12) * 4 + p[1] / 10 - 3 * std::cos(p[Dimension - 1] / 17);
}

// Compares with a fit of the nodes there are.
template <int Dimension>
void Compare(UpdatableRadialBasis<Dimension>& s, const Points<Dimension>& nodes,
  const std::vector<double>& values, const RadialBasisOptions& options)
{
  lacuna::ThreadExecution execution(2);
  const RadialBasis<Dimension> fit(execution, nodes, values, options);
  const Points<Dimension> points = Scatter<Dimension>(50, 77);
  std::vector<double> a;
  std::vector<double> b;
  s.Evaluate(execution, points, a);
  fit.Evaluate(execution, points, b);
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    EXPECT_NEAR(a[i], b[i], 1e-8);
  }
  EXPECT_EQ(s.GetNumberOfNodes(), nodes.size());
}

template <int Dimension>
void CheckUpdates(RadialKernel kernel, double smoothing)
{
  lacuna::ThreadExecution execution(2);
  RadialBasisOptions options;
  options.Kernel = kernel;
  options.Smoothing = smoothing;
  options.Shape = 20;
  Points<Dimension> nodes = Scatter<Dimension>(60, 1);
  std::vector<double> values;
  for (const auto& p : nodes)
  {
    values.push_back(Value<Dimension>(p));
  }
  UpdatableRadialBasis<Dimension> s(execution, nodes, values, options);
  // The frame stays, so energies that depend on it are compared without smoothing only.
  Compare<Dimension>(s, nodes, values, options);
  for (const auto& p : Scatter<Dimension>(5, 2))
  {
    EXPECT_EQ(s.Add(p, 3), nodes.size());
    nodes.push_back(p);
    values.push_back(3);
  }
  Compare<Dimension>(s, nodes, values, options);
  s.SetValue(10, -4);
  values[10] = -4;
  nodes[20] = { 33, 44 };
  values[20] = 1;
  s.Move(20, nodes[20], 1);
  nodes[62] = { 12, 71 };
  s.Move(62, nodes[62], values[62]);
  Compare<Dimension>(s, nodes, values, options);
  // all of the first thirty, among them surely anchors
  for (std::size_t k = 0; k < 30; ++k)
  {
    s.Remove(k);
    if (k % 7 == 0)
    {
      Compare<Dimension>(s, Points<Dimension>(nodes.begin() + k + 1, nodes.end()),
        std::vector<double>(values.begin() + k + 1, values.end()), options);
    }
  }
  EXPECT_EQ(s.Add(Scatter<Dimension>(1, 9)[0], 1), 65U);
}
}

TEST(UpdatableRadialBasis, AgreesWithNewFits)
{
  for (const RadialKernel kernel : { RadialKernel::ThinPlate, RadialKernel::Linear,
         RadialKernel::Triharmonic, RadialKernel::Cubic, RadialKernel::Multiquadric })
  {
    CheckUpdates<2>(kernel, 0);
    CheckUpdates<3>(kernel, 0);
  }
  CheckUpdates<2>(RadialKernel::ThinPlate, 5);
}

TEST(UpdatableRadialBasis, RefusesBadChangesAndStaysAsItWas)
{
  lacuna::ThreadExecution execution(2);
  const Points<2> nodes = { { 0, 0 }, { 50, 0 }, { 0, 50 }, { 30, 30 } };
  const std::vector<double> values = { 1, 2, 3, 5 };
  const double infinity = std::numeric_limits<double>::infinity();
  UpdatableRadialBasis<2> s(execution, nodes, values, {});
  EXPECT_THROW(s.Add({ 30, 30 }, 4), std::invalid_argument);
  EXPECT_THROW(s.Add({ infinity, 30 }, 4), std::invalid_argument);
  EXPECT_THROW(s.Add({ 3, 30 }, infinity), std::invalid_argument);
  EXPECT_THROW(s.Remove(4), std::invalid_argument);
  EXPECT_THROW(s.Move(4, { 1, 1 }, 1), std::invalid_argument);
  EXPECT_THROW(s.Move(3, { 0, 50 }, 1), std::invalid_argument);
  EXPECT_THROW(s.SetValue(9, 1), std::invalid_argument);
  EXPECT_THROW(s.SetValue(1, infinity), std::invalid_argument);
  Compare<2>(s, nodes, values, {});
  s.Remove(3);
  EXPECT_THROW(s.Remove(0), std::invalid_argument); // two do not make a surface
  EXPECT_EQ(s.GetNumberOfNodes(), 3U);
  const Points<2> twice = { { 0, 0 }, { 50, 0 }, { 0, 50 }, { 0, 0 } };
  EXPECT_THROW(
    UpdatableRadialBasis<2>(execution, twice, { 1, 2, 3, 1 }, {}), std::invalid_argument);
}

TEST(CenterReduction, KeepsTheToleranceWithFewCentres)
{
  lacuna::ThreadExecution execution(2);
  const Points<2> nodes = Scatter<2>(5000, 4);
  std::vector<double> values;
  for (const auto& p : nodes)
  {
    values.push_back(Value<2>(p));
  }
  for (const double tolerance : { 0.1, 0.01 })
  {
    const lacuna::ReducedCenters<2> reduced =
      lacuna::ReduceCenters<2>(execution, nodes, { values }, {}, tolerance);
    const std::vector<std::size_t>& centers = reduced.Indices;
    EXPECT_EQ(reduced.NodeCount, nodes.size());
    EXPECT_LT(centers.size(), tolerance == 0.1 ? 250U : 900U);
    EXPECT_TRUE(std::is_sorted(centers.begin(), centers.end()));
    Points<2> own;
    std::vector<double> at;
    for (const std::size_t i : centers)
    {
      own.push_back(nodes[i]);
      at.push_back(values[i]);
    }
    const RadialBasis<2> s(execution, own, at, {});
    std::vector<double> fit;
    s.Evaluate(execution, nodes, fit);
    std::vector<double> ownFit;
    reduced.Function->Evaluate(execution, nodes, ownFit);
    EXPECT_EQ(ownFit, fit);
    double worst = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i)
    {
      worst = std::max(worst, std::abs(fit[i] - values[i]));
    }
    EXPECT_EQ(worst, reduced.Residual);
    EXPECT_LE(worst, tolerance);
  }
}

TEST(CenterReduction, ServesSeveralValuesWithFastFits)
{
  const Points<3> nodes = Scatter<3>(6000, 5);
  std::vector<std::vector<double>> values(2);
  for (const auto& p : nodes)
  {
    values[0].push_back(Value<3>(p));
    values[1].push_back(7 + 2 * std::cos(p[0] / 20) * std::sin(p[2] / 25));
  }
  RadialBasisOptions options;
  options.Kernel = RadialKernel::Linear;
  options.Solver = lacuna::RadialSolver::Fast;
  options.Accuracy = 0.1; // coarser than the tolerance
  constexpr double tolerance = 0.1;
  std::vector<std::size_t> before;
  for (const int threads : { 1, 2, 5 })
  {
    lacuna::ThreadExecution execution(threads);
    const lacuna::ReducedCenters<3> reduced =
      lacuna::ReduceCenters<3>(execution, nodes, values, options, tolerance);
    EXPECT_GT(reduced.Function->GetReport().Iterations, 0);
    EXPECT_LT(reduced.Indices.size(), nodes.size() / 2);
    EXPECT_LE(reduced.Residual, tolerance);
    EXPECT_TRUE(before.empty() || reduced.Indices == before);
    before = reduced.Indices;
    double worst = 0;
    for (int k = 0; k < 2; ++k)
    {
      std::vector<double> fit;
      reduced.Function->Evaluate(execution, nodes, fit, k);
      for (std::size_t i = 0; i < nodes.size(); ++i)
      {
        worst = std::max(worst, std::abs(fit[i] - values[k][i]));
      }
    }
    EXPECT_EQ(worst, reduced.Residual);
  }
}

TEST(CenterReduction, FastSumsAtNodesKeepTheirBound)
{
  lacuna::ThreadExecution execution(2);
  const Points<2> nodes = Scatter<2>(3000, 6);
  std::vector<double> values;
  for (const auto& p : nodes)
  {
    values.push_back(Value<2>(p));
  }
  RadialBasisOptions options;
  options.Accuracy = 1e-4;
  const RadialBasis<2> s(execution, nodes, values, options);
  const Points<2> points = Scatter<2>(80000, 7);
  std::vector<double> direct;
  s.Evaluate(execution, points, direct);
  for (const double tolerance : { 1e-1, 1e-3, 1e-5 })
  {
    std::vector<double> fast;
    const double bound = s.EvaluateWithin(execution, tolerance, points, fast);
    EXPECT_GT(bound, 0) << "that was no fast sum";
    EXPECT_LE(bound, tolerance);
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      ASSERT_LE(std::abs(fast[i] - direct[i]), bound);
    }
  }
  // few: directly
  std::vector<double> few;
  EXPECT_EQ(s.EvaluateWithin(execution, 1e-3, nodes, few), 0);
  s.Evaluate(execution, nodes, direct);
  EXPECT_EQ(few, direct);
}

TEST(CenterReduction, StartsFromNodesThatDetermineThePolynomial)
{
  // All but two lie on one line, and at one end of it
  Points<2> nodes;
  std::vector<double> values;
  for (int i = 0; i < 4000; ++i)
  {
    nodes.push_back({ 0.01 * i, 0 });
  }
  nodes[1234][1] = 1;
  nodes[2345][1] = -3;
  for (const auto& p : nodes)
  {
    values.push_back(std::sin(p[0]) + p[1]);
  }
  lacuna::ThreadExecution execution(2);
  const auto reduced = lacuna::ReduceCenters<2>(execution, nodes, { values }, {}, 0.01);
  EXPECT_LE(reduced.Residual, 0.01);
  EXPECT_LT(reduced.Indices.size(), 500U);
}

TEST(CenterReduction, SaysWhatItCannotDo)
{
  lacuna::ThreadExecution execution(2);
  const Points<2> nodes = Scatter<2>(100, 4);
  std::vector<double> values(100, 0.0);
  values[50] = 1;
  EXPECT_THROW(
    lacuna::ReduceCenters<2>(execution, nodes, { values }, {}, 0), std::invalid_argument);
  RadialBasisOptions smooth;
  smooth.Smoothing = 1e6;
  EXPECT_THROW(
    lacuna::ReduceCenters<2>(execution, nodes, { values }, smooth, 1e-3), std::runtime_error);
}
