// SPDX-License-Identifier: BSD-3-Clause
// Fast solutions against direct ones, and against the values that they are to meet.
#include "lacunaExecution.h"
#include "lacunaRadialBasis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{
using lacuna::RadialBasis;
using lacuna::RadialBasisOptions;
using lacuna::RadialKernel;
using lacuna::RadialSolver;
constexpr RadialKernel Kernels[] = { RadialKernel::ThinPlate, RadialKernel::Linear,
  RadialKernel::Triharmonic, RadialKernel::Cubic, RadialKernel::Gaussian,
  RadialKernel::Multiquadric, RadialKernel::Wendland };

template <int Dimension>
using Points = std::vector<std::array<double, Dimension>>;

// In a box of 100 x 60 (x 40) mm.
template <int Dimension>
Points<Dimension> Scatter(int count, double power = 1, unsigned seed = 1)
{
  constexpr double size[3] = { 100, 60, 40 };
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  Points<Dimension> points(count);
  for (auto& p : points)
  {
    for (int c = 0; c < Dimension; ++c)
    {
      p[c] = size[c] * std::pow(uniform(random), power);
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
    values.push_back(20 + 5 * std::sin(p[0] / 9 + 1) * std::cos(p[1] / 14) +
      3 * std::exp(-p[Dimension - 1] / 30) - 0.02 * p[0]);
  }
  return values;
}

double Largest(const std::vector<double>& a, const std::vector<double>& b)
{
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    largest = std::max(largest, std::abs(a[i] - b[i]));
  }
  return largest;
}

RadialBasisOptions Options(RadialKernel kernel, RadialSolver solver, double accuracy)
{
  RadialBasisOptions options;
  options.Kernel = kernel;
  options.Solver = solver;
  options.Accuracy = accuracy;
  return options;
}

template <int Dimension>
void CheckFit(RadialKernel kernel, const Points<Dimension>& nodes, double accuracy)
{
  lacuna::ThreadExecution execution(2);
  const std::vector<double> values = Values<Dimension>(nodes);
  const RadialBasis<Dimension> s(
    execution, nodes, values, Options(kernel, RadialSolver::Fast, accuracy));
  std::vector<double> at;
  s.Evaluate(execution, nodes, at); // direct sums
  EXPECT_LE(Largest(at, values), accuracy * s.GetRange())
    << "kernel " << static_cast<int>(kernel) << ", " << s.GetReport().Iterations << " iterations";
  EXPECT_LE(s.GetReport().Residual, accuracy * s.GetRange());
  EXPECT_GT(s.GetReport().Iterations, 0);
}

template <class Function>
std::string ErrorOf(const Function& function)
{
  try
  {
    function();
  }
  catch (const std::exception& e)
  {
    return e.what();
  }
  return "";
}
}

TEST(RadialSolver, MeetsTheValuesIn2D)
{
  for (const RadialKernel kernel : Kernels)
  {
    CheckFit<2>(kernel, Scatter<2>(4000), 1e-5);
  }
}

TEST(RadialSolver, MeetsTheValuesIn3D)
{
  for (const RadialKernel kernel : Kernels)
  {
    CheckFit<3>(kernel, Scatter<3>(2200), 1e-4);
  }
}

TEST(RadialSolver, MeetsTheValuesOfNodesOfUnevenDensity)
{
  CheckFit<2>(RadialKernel::ThinPlate, Scatter<2>(5000, 2.5), 1e-5);
  CheckFit<3>(RadialKernel::Linear, Scatter<3>(3000, 2.5), 1e-4);
  // in a thin shell, as points on a scanned surface are
  Points<3> shell = Scatter<3>(3000);
  for (std::size_t i = 0; i < shell.size(); ++i)
  {
    std::array<double, 3>& p = shell[i];
    const double length = std::hypot(p[0] - 50, p[1] - 30, p[2] - 20);
    for (int c = 0; c < 3; ++c)
    {
      p[c] = (p[c] - (c == 0 ? 50 : c == 1 ? 30 : 20)) * (40 + static_cast<double>(i % 3)) / length;
    }
  }
  CheckFit<3>(RadialKernel::Linear, shell, 1e-4);
  CheckFit<3>(RadialKernel::Cubic, shell, 1e-4);
  // along a curve, and on a regular grid
  Points<2> curve;
  Points<2> grid;
  for (int i = 0; i < 3600; ++i)
  {
    curve.push_back({ 100 * std::cos(i * 0.00173), 60 * std::sin(i * 0.00173) });
    const int row = i / 60;
    grid.push_back({ 1.5 * (i % 60), 1.5 * row });
  }
  CheckFit<2>(RadialKernel::ThinPlate, curve, 1e-4);
  CheckFit<2>(RadialKernel::ThinPlate, grid, 1e-6);
}

TEST(RadialSolver, AgreesWithTheDirectSolution)
{
  lacuna::ThreadExecution execution(2);
  const Points<2> nodes = Scatter<2>(2300);
  const std::vector<double> values = Values<2>(nodes);
  const Points<2> points = Scatter<2>(1000, 1, 9);
  for (const RadialKernel kernel : { RadialKernel::ThinPlate, RadialKernel::Linear })
  {
    for (const double smoothing : { 0.0, 10.0 })
    {
      RadialBasisOptions options = Options(kernel, RadialSolver::Fast, 1e-6);
      options.Smoothing = smoothing;
      for (std::size_t i = 0; smoothing > 0 && i < nodes.size(); ++i)
      {
        options.Errors.push_back(nodes[i][0] < 50 ? 0.5 : 2);
      }
      const RadialBasis<2> fast(execution, nodes, values, options);
      options.Solver = RadialSolver::Direct;
      const RadialBasis<2> direct(execution, nodes, values, options);
      std::vector<double> a;
      std::vector<double> b;
      fast.Evaluate(execution, points, a);
      direct.Evaluate(execution, points, b);
      EXPECT_LE(Largest(a, b), 1e-5 * fast.GetRange());
      EXPECT_NEAR(
        fast.GetReport().Energy, direct.GetReport().Energy, 1e-3 * direct.GetReport().Energy);
      for (int k = 0; k < 3; ++k)
      {
        EXPECT_NEAR(fast.GetPolynomial()[k], direct.GetPolynomial()[k], 1e-3 * (k == 0 ? 20 : 0.2));
      }
      EXPECT_EQ(direct.GetReport().Iterations, 0);
      EXPECT_GT(direct.GetReport().ConditionEstimate, 1);
      EXPECT_EQ(fast.GetReport().ConditionEstimate, 0);
    }
  }
}

TEST(RadialSolver, ValuesWithSmallErrorsAreMetBetter)
{
  lacuna::ThreadExecution execution(2);
  const Points<2> nodes = Scatter<2>(300);
  std::vector<double> values = Values<2>(nodes);
  RadialBasisOptions options;
  options.Smoothing = 100;
  double worst[2] = { 0, 0 };
  for (std::size_t i = 0; i < nodes.size(); ++i)
  {
    values[i] += i % 2 == 0 ? 0.3 : -0.3;
    options.Errors.push_back(i % 2 == 0 ? 0.01 : 1);
  }
  const RadialBasis<2> s(execution, nodes, values, options);
  std::vector<double> at;
  s.Evaluate(execution, nodes, at);
  for (std::size_t i = 0; i < nodes.size(); ++i)
  {
    worst[i % 2] = std::max(worst[i % 2], std::abs(at[i] - values[i]));
  }
  EXPECT_LT(worst[0], 0.02);
  EXPECT_GT(worst[1], 0.3);
  options.Errors.pop_back();
  EXPECT_NE(
    ErrorOf([&] { const RadialBasis<2> t(execution, nodes, values, options); }).find("node 299"),
    std::string::npos);
}

TEST(RadialSolver, GridsAreAsAccurateAsAsked)
{
  lacuna::ThreadExecution execution(2);
  const Points<3> nodes = Scatter<3>(3000);
  const std::vector<double> values = Values<3>(nodes);
  const lacuna::RegularGrid<3> grid{ { -5, -4, 3 }, { 4, 3, 2.5 }, { 29, 23, 13 } };
  Points<3> points;
  for (std::int64_t k = 0; k < grid.Size[2]; ++k)
  {
    for (std::int64_t j = 0; j < grid.Size[1]; ++j)
    {
      for (std::int64_t i = 0; i < grid.Size[0]; ++i)
      {
        points.push_back({ grid.Origin[0] + static_cast<double>(i) * grid.Spacing[0],
          grid.Origin[1] + static_cast<double>(j) * grid.Spacing[1],
          grid.Origin[2] + static_cast<double>(k) * grid.Spacing[2] });
      }
    }
  }
  for (const RadialKernel kernel : { RadialKernel::Linear, RadialKernel::Triharmonic })
  {
    const RadialBasis<3> s(execution, nodes, values, Options(kernel, RadialSolver::Direct, 1e-3));
    std::vector<double> exact;
    s.Evaluate(execution, points, exact);
    std::vector<double> fast(points.size());
    s.EvaluateGrid(execution, grid, fast.data());
    EXPECT_LE(Largest(fast, exact), 1e-3 * s.GetRange());

    const RadialBasis<3> t(execution, Points<3>(nodes.begin(), nodes.begin() + 500),
      std::vector<double>(values.begin(), values.begin() + 500),
      Options(kernel, RadialSolver::Auto, 0));
    t.Evaluate(execution, points, exact);
    t.EvaluateGrid(execution, grid, fast.data());
    EXPECT_LE(Largest(fast, exact), 1e-12 * t.GetRange());
  }
}

TEST(RadialSolver, GridsAboutAHoleKeepTheBound)
{
  // The cases of Carr 1996, section 6.4: nodes around a hole, evaluated in it and around it.
  lacuna::ThreadExecution execution(2);
  for (const int count : { 697, 578 })
  {
    Points<2> nodes;
    for (int i = 0; i < count; ++i)
    {
      const double r = std::sqrt(900 + 864 * (i + 0.5) / count);
      nodes.push_back({ r * std::cos(2.399963229728653 * i), r * std::sin(2.399963229728653 * i) });
    }
    const RadialBasis<2> s(execution, nodes, Values<2>(nodes),
      Options(RadialKernel::ThinPlate, RadialSolver::Auto, 1e-4));
    for (const int size : { 205, 512 })
    {
      const double step = 84.0 / (size - 1);
      const lacuna::RegularGrid<2> grid{ { -42, -42 }, { step, step }, { size, size } };
      Points<2> points;
      for (int i = 0; i < size * size; ++i)
      {
        points.push_back({ -42 + step * (i % size), -42 + step * (i / size) });
      }
      std::vector<double> direct;
      s.Evaluate(execution, points, direct);
      std::vector<double> fast(points.size());
      s.EvaluateGrid(execution, grid, fast.data());
      const double error = Largest(fast, direct);
      EXPECT_LE(error, 1e-4 * s.GetRange());
      EXPECT_GT(error, 0) << "that was no fast sum";
    }
  }
}

// Ranks share a grid: together they have the bits of all of it, from fast sums and direct ones.
TEST(RadialSolver, PartsOfAGridAreTheWhole)
{
  lacuna::ThreadExecution execution(2);
  const Points<2> flat = Scatter<2>(2500);
  const lacuna::RegularGrid<2> square{ { 3, -2 }, { 0.63, 0.57 }, { 137, 173 } };
  const Points<3> nodes = Scatter<3>(2500);
  const lacuna::RegularGrid<3> cube{ { 0, 1, 2 }, { 3.4, 3.6, 3.8 }, { 29, 27, 26 } };
  for (const double accuracy : { 1e-4, 0.0 })
  {
    const auto check = [&](const auto& s, const auto& grid)
    {
      const double unset = -1e300;
      std::vector<double> whole(grid.GetNumberOfPoints());
      s.EvaluateGrid(execution, grid, whole.data());
      const auto all = lacuna::WholeGrid(grid);
      const typename std::decay_t<decltype(s)>::OnGrid parts(execution, s, grid, all);
      const std::int64_t middle = grid.Size[1] / 3;
      const std::int64_t column = grid.Size[0] / 2;
      for (int quarter = 0; quarter < 4; ++quarter)
      {
        auto part = all;
        part[0][quarter % 2] = column;
        part[1][quarter / 2] = middle;
        const std::int64_t columns = part[0][1] - part[0][0];
        const std::int64_t rows = part[1][1] - part[1][0];
        const auto count =
          static_cast<std::int64_t>(whole.size()) / (grid.Size[0] * grid.Size[1]) * columns * rows;
        std::vector<double> values(count + 1, unset);
        std::vector<double> again(count + 1, unset);
        s.EvaluateGrid(execution, grid, part, values.data());
        parts.Evaluate(execution, part, again.data());
        for (std::int64_t i = 0; i < count; ++i)
        {
          const std::int64_t x = part[0][0] + i % columns;
          const std::int64_t y = part[1][0] + i / columns % rows;
          const std::int64_t place = x + grid.Size[0] * (y + grid.Size[1] * (i / columns / rows));
          ASSERT_EQ(values[i], whole[place]) << accuracy << " at " << i;
          ASSERT_EQ(again[i], whole[place]) << accuracy << " at " << i;
        }
        EXPECT_EQ(values[count], unset);
        EXPECT_EQ(again[count], unset);
      }
      auto nothing = all;
      nothing[1] = { 4, 4 };
      std::vector<double> values(1, unset);
      s.EvaluateGrid(execution, grid, nothing, values.data());
      parts.Evaluate(execution, nothing, values.data());
      EXPECT_EQ(values.front(), unset);
    };
    check(RadialBasis<2>(execution, flat, Values<2>(flat),
            Options(RadialKernel::ThinPlate,
              accuracy > 0 ? RadialSolver::Fast : RadialSolver::Direct, accuracy)),
      square);
    check(RadialBasis<3>(execution, nodes, Values<3>(nodes),
            Options(RadialKernel::Linear, accuracy > 0 ? RadialSolver::Fast : RadialSolver::Direct,
              accuracy)),
      cube);
  }
}

TEST(RadialSolver, IsTheSameForAnyNumberOfThreads)
{
  const Points<2> nodes = Scatter<2>(3000);
  const std::vector<double> values = Values<2>(nodes);
  const lacuna::RegularGrid<2> grid{ { 0, 0 }, { 2, 2 }, { 50, 30 } };
  std::vector<std::vector<double>> results;
  for (const int threads : { 1, 2, 5 })
  {
    lacuna::ThreadExecution execution(threads);
    const RadialBasis<2> s(
      execution, nodes, values, Options(RadialKernel::ThinPlate, RadialSolver::Auto, 1e-4));
    EXPECT_GT(s.GetReport().Iterations, 0);
    std::vector<double> image(1500);
    s.EvaluateGrid(execution, grid, image.data());
    results.push_back(image);
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

TEST(RadialSolver, SolvesForSeveralValuesAtOnce)
{
  lacuna::ThreadExecution execution(2);
  for (const RadialSolver solver : { RadialSolver::Direct, RadialSolver::Fast })
  {
    const Points<2> nodes = Scatter<2>(2200);
    std::vector<std::vector<double>> values(3, Values<2>(nodes));
    for (std::size_t i = 0; i < nodes.size(); ++i)
    {
      values[1][i] = nodes[i][0] * nodes[i][1] / 500;
      values[2][i] = 7;
    }
    const RadialBasisOptions options = Options(RadialKernel::ThinPlate, solver, 1e-5);
    const RadialBasis<2> s(execution, nodes, values, options);
    ASSERT_EQ(s.GetNumberOfComponents(), 3);
    const lacuna::RegularGrid<2> grid{ { 0, 0 }, { 2, 2 }, { 50, 30 } };
    for (int k = 0; k < 3; ++k)
    {
      std::vector<double> at;
      s.Evaluate(execution, nodes, at, k);
      EXPECT_LE(Largest(at, values[k]), 1e-5 * (k == 2 ? 1e-6 : s.GetRange(k)));
      std::vector<double> image(1500);
      s.EvaluateGrid(execution, grid, image.data(), k);
      EXPECT_NEAR(image[0], s.GetPolynomial(k)[0], 1000); // finite, at least
    }
    EXPECT_NEAR(s.GetPolynomial(2)[0], 7, 1e-9);
  }
}

TEST(RadialSolver, TriharmonicsReproduceQuadratics)
{
  lacuna::ThreadExecution execution(2);
  for (const int count : { 200, 2500 })
  {
    const Points<2> nodes = Scatter<2>(count);
    std::vector<double> values;
    for (const auto& p : nodes)
    {
      values.push_back(3 + p[0] - 2 * p[1] + 0.01 * p[0] * p[0] - 0.03 * p[0] * p[1]);
    }
    const RadialBasis<2> s(
      execution, nodes, values, Options(RadialKernel::Triharmonic, RadialSolver::Auto, 1e-6));
    std::vector<double> at;
    Points<2> gradients;
    s.Evaluate(execution, { { 150, -40 } }, at, gradients);
    EXPECT_NEAR(at[0], 3 + 150 + 80 + 225 + 180, 1e-4 * s.GetRange());
    EXPECT_NEAR(gradients[0][0], 1 + 3 + 1.2, 1e-3);
    EXPECT_NEAR(gradients[0][1], -2 - 4.5, 1e-3);
  }
}

TEST(RadialSolver, SaysWhatItCannotDo)
{
  lacuna::ThreadExecution execution(2);
  const Points<2> nodes = Scatter<2>(2500);
  const std::vector<double> values = Values<2>(nodes);
  const auto fit = [&](const RadialBasisOptions& options)
  { return ErrorOf([&] { const RadialBasis<2> s(execution, nodes, values, options); }); };
  const auto expect = [](const std::string& text, const std::string& part)
  { EXPECT_NE(text.find(part), std::string::npos) << text; };
  const std::string below =
    fit(Options(RadialKernel::ThinPlate, RadialSolver::Fast, 1e-16)); // than round-off
  expect(below, "raise Accuracy, add Smoothing");
  RadialBasisOptions named = Options(RadialKernel::ThinPlate, RadialSolver::Fast, 1e-16);
  named.Words = { "Tolerance", "Stiffness" };
  expect(fit(named), "raise Tolerance, add Stiffness");
  const std::string reached = "could only be solved to ";
  const std::size_t at = below.find(reached);
  ASSERT_NE(at, std::string::npos) << below;
  EXPECT_LT(std::stod(below.substr(at + reached.size())), 1e-11) << below; // values of about 20
  expect(fit(Options(RadialKernel::ThinPlate, RadialSolver::Fast, 0)), "accuracy above 0");
  expect(fit(Options(RadialKernel::ThinPlate, RadialSolver::Auto, -1)),
    "Accuracy is -1; it must be from 0 to 1");
  expect(fit(Options(RadialKernel::ThinPlate, RadialSolver::Auto, 2)),
    "Accuracy is 2; it must be from 0 to 1");
  RadialBasisOptions wide = Options(RadialKernel::Gaussian, RadialSolver::Fast, 1e-6);
  wide.Shape = 500;
  expect(fit(wide), "lower KernelLength");
  wide.Shape = -1;
  expect(fit(wide), "KernelLength is ");
  wide.Shape = std::numeric_limits<double>::quiet_NaN();
  expect(fit(wide), "KernelLength is ");
  const Points<2> line = { { 0, 0 }, { 1, 0 }, { 2, 0 }, { 0, 1 }, { 0, 2 }, { 0, 3 } };
  expect(ErrorOf(
           [&]
           {
             const RadialBasis<2> s(execution, line, { 1, 2, 3, 4, 5, 7 },
               Options(RadialKernel::Triharmonic, RadialSolver::Auto, 0));
           }),
    "conic");
}

TEST(RadialSolver, StopsWhenAsked)
{
  const Points<3> nodes = Scatter<3>(6000);
  const std::vector<double> values = Values<3>(nodes);
  for (const double limit : { 0.05, 0.5 })
  {
    lacuna::ThreadExecution execution(2, [&](double done) { return done < limit; });
    EXPECT_THROW(RadialBasis<3>(execution, nodes, values,
                   Options(RadialKernel::Linear, RadialSolver::Fast, 1e-4)),
      lacuna::Aborted);
  }
}
