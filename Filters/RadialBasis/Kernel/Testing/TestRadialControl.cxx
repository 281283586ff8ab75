// SPDX-License-Identifier: BSD-3-Clause
// Control points against new fits of nodes and points together.
#include "lacunaExecution.h"
#include "lacunaRadialBasis.h"

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
using lacuna::RadialSolver;

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
std::vector<double> Values(const Points<Dimension>& points)
{
  std::vector<double> values;
  for (const auto& p : points)
  {
    values.push_back(
      10 + std::sin(p[0] / 12) * 4 + p[1] / 10 - 3 * std::cos(p[Dimension - 1] / 17));
  }
  return values;
}

template <int Dimension>
std::vector<double> At(const RadialBasis<Dimension>& s, const Points<Dimension>& points)
{
  lacuna::ThreadExecution execution(2);
  std::vector<double> values;
  s.Evaluate(execution, points, values);
  return values;
}

// With nodes released, moved points and several right-hand sides.
template <int Dimension>
void CheckAgainstNewFit(RadialKernel kernel, double smoothing)
{
  lacuna::ThreadExecution execution(2);
  RadialBasisOptions options;
  options.Kernel = kernel;
  options.Smoothing = smoothing;
  options.Shape = 8; // wider ones are hardly solvable, by either way
  options.Controllable = true;
  const Points<Dimension> nodes = Scatter<Dimension>(90, 1);
  const std::vector<double> values = Values<Dimension>(nodes);
  std::vector<double> others;
  for (const double v : values)
  {
    others.push_back(3 - v * v / 50);
  }
  RadialBasis<Dimension> s(execution, nodes, { values, others }, options);
  Points<Dimension> points = Scatter<Dimension>(4, 2);
  points[2] = nodes[17]; // on a node, which gives way
  std::vector<std::vector<double>> wanted{ { 12, 9, 21, 15 }, { -5, 0, 2, -1 } };
  s.SetControlPoints(execution, points, wanted, 1e-3);
  points[1][0] += 7;
  wanted[0][1] = 3;
  s.SetControlPoints(execution, points, wanted, 1e-3); // three columns are kept
  EXPECT_EQ(s.GetReport().NodeCount, 93U);

  // The same equations, fitted at once: errors of nodes weigh the smoothing.
  Points<Dimension> all = nodes;
  all.erase(all.begin() + 17);
  all.insert(all.end(), points.begin(), points.end());
  RadialBasisOptions fresh = options;
  fresh.Controllable = false;
  fresh.Errors.assign(89, 1);
  fresh.Errors.resize(93, 1e-9); // met exactly
  std::vector<double> list[2] = { values, others };
  for (int k = 0; k < 2; ++k)
  {
    list[k].erase(list[k].begin() + 17);
    list[k].insert(list[k].end(), wanted[k].begin(), wanted[k].end());
  }
  const RadialBasis<Dimension> fit(execution, all, { list[0], list[1] }, fresh);
  const Points<Dimension> places = Scatter<Dimension>(60, 77);
  for (int k = 0; k < 2; ++k)
  {
    std::vector<double> a;
    std::vector<double> b;
    std::vector<std::array<double, Dimension>> slopes;
    std::vector<std::array<double, Dimension>> wantedSlopes;
    s.Evaluate(execution, places, a, slopes, k);
    fit.Evaluate(execution, places, b, wantedSlopes, k);
    for (std::size_t i = 0; i < a.size(); ++i)
    {
      EXPECT_NEAR(a[i], b[i], 1e-8);
      EXPECT_NEAR(slopes[i][0], wantedSlopes[i][0], 1e-8);
    }
    s.Evaluate(execution, points, a, k);
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      EXPECT_NEAR(a[i], wanted[k][i], 1e-9);
    }
  }
  EXPECT_NEAR(s.GetReport().Energy, fit.GetReport().Energy, 1e-7 * fit.GetReport().Energy);
  for (int c = 0; kernel == RadialKernel::ThinPlate && c < 3; ++c)
  {
    EXPECT_NEAR(s.GetPolynomial()[c], fit.GetPolynomial()[c], 1e-7);
  }

  s.SetControlPoints(execution, {}, { {}, {} }, 1);
  EXPECT_EQ(At<Dimension>(s, places),
    At<Dimension>(RadialBasis<Dimension>(execution, nodes, { values, others }, options), places));
}
}

TEST(RadialControl, AgreesWithANewFit)
{
  for (const double smoothing : { 0.0, 5.0 })
  {
    CheckAgainstNewFit<2>(RadialKernel::ThinPlate, smoothing);
    CheckAgainstNewFit<2>(RadialKernel::Linear, smoothing);
    CheckAgainstNewFit<2>(RadialKernel::Cubic, smoothing);
    CheckAgainstNewFit<2>(RadialKernel::Triharmonic, smoothing);
    CheckAgainstNewFit<2>(RadialKernel::Multiquadric, smoothing);
    CheckAgainstNewFit<3>(RadialKernel::Linear, smoothing);
    CheckAgainstNewFit<3>(RadialKernel::Gaussian, smoothing);
  }
}

TEST(RadialControl, DoesNotDependOnWhatWasBefore)
{
  lacuna::ThreadExecution execution(2);
  RadialBasisOptions options;
  options.Controllable = true;
  const Points<2> nodes = Scatter<2>(300, 5);
  const Points<2> places = Scatter<2>(60, 6);
  RadialBasis<2> dragged(execution, nodes, Values<2>(nodes), options);
  Points<2> points{ { 40, 40 }, { 20, 60 } };
  for (int step = 0; step < 5; ++step)
  {
    points[1][0] += 1.7;
    dragged.SetControlPoints(execution, points, { { 15, 12 } }, 2);
  }
  RadialBasis<2> fresh(execution, nodes, Values<2>(nodes), options);
  fresh.SetControlPoints(execution, points, { { 15, 12 } }, 2);
  EXPECT_EQ(At<2>(dragged, places), At<2>(fresh, places));
}

TEST(RadialControl, FastSolutionKeepsTheAccuracy)
{
  lacuna::ThreadExecution execution(2);
  RadialBasisOptions options;
  options.Controllable = true;
  options.Accuracy = 1e-5;
  options.Solver = RadialSolver::Fast;
  Points<2> nodes = Scatter<2>(4000, 8);
  nodes.erase(
    std::remove_if(nodes.begin(), nodes.end(), // a hole of 15 mm
      [](const std::array<double, 2>& p) { return std::hypot(p[0] - 40, p[1] - 40) < 15; }),
    nodes.end());
  const std::vector<double> values = Values<2>(nodes);
  RadialBasis<2> s(execution, nodes, values, options);
  const double range = s.GetRange();
  const Points<2> points{ { 38, 42 }, { 45, 33 }, nodes[7] };
  s.SetControlPoints(execution, points, { { 16, 11, 12 } }, 1e-3);
  const double bound = s.GetReport().Residual;
  EXPECT_LT(bound, 2 * options.Accuracy * range);
  const std::vector<double> atNodes = At<2>(s, nodes);
  for (std::size_t i = 0; i < nodes.size(); ++i)
  {
    EXPECT_NEAR(atNodes[i], i == 7 ? 12 : values[i], bound + 1e-9) << i;
  }
  const std::vector<double> at = At<2>(s, points);
  EXPECT_NEAR(at[0], 16, bound);
  EXPECT_NEAR(at[1], 11, bound);
}

TEST(RadialControl, RefusesWhatHasNoAnswer)
{
  lacuna::ThreadExecution execution(2);
  RadialBasisOptions options;
  options.Controllable = true;
  const Points<2> nodes = Scatter<2>(50, 5);
  RadialBasis<2> s(execution, nodes, Values<2>(nodes), options);
  const Points<2> places = Scatter<2>(20, 6);
  const std::vector<double> before = At<2>(s, places);
  EXPECT_THROW(
    s.SetControlPoints(execution, { { 1, 2 }, { 1, 2 } }, { { 3, 4 } }, 0), std::invalid_argument);
  EXPECT_THROW(
    s.SetControlPoints(execution, { { 1, std::nan("") } }, { { 3 } }, 0), std::invalid_argument);
  EXPECT_THROW(s.SetControlPoints(execution, { nodes[3] }, { { 3 } }, 0), std::runtime_error);
  EXPECT_EQ(At<2>(s, places), before);
  s.SetControlPoints(execution, { { 1, 2 }, { 1, 2 } }, { { 3, 3 } }, 0); // merged
  EXPECT_NEAR(At<2>(s, { { 1, 2 } })[0], 3, 1e-9);
}
