// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaExecution.h"
#include "lacunaFastRadialSum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{
using lacuna::RadialKernel;
constexpr RadialKernel Kernels[] = { RadialKernel::ThinPlate, RadialKernel::Linear,
  RadialKernel::Triharmonic, RadialKernel::Cubic, RadialKernel::Gaussian,
  RadialKernel::Multiquadric, RadialKernel::Wendland };

template <int Dimension>
using Points = std::vector<std::array<double, Dimension>>;

enum class Shape
{
  Uniform,
  Clustered, // ever denser towards a corner
  Surface,   // on a circle (sphere)
  Line,
  Lumps // a few places with all points within 1e-5
};
constexpr Shape Shapes[] = { Shape::Uniform, Shape::Clustered, Shape::Surface, Shape::Line,
  Shape::Lumps };

template <int Dimension>
Points<Dimension> Make(Shape shape, int count, double size = 1)
{
  std::mt19937 random(static_cast<unsigned>(shape) + 7);
  std::uniform_real_distribution<double> uniform(0, 1);
  Points<Dimension> points(count);
  for (std::array<double, Dimension>& p : points)
  {
    double length = 0;
    for (double& x : p)
    {
      x = uniform(random);
      x = shape == Shape::Clustered ? x * x * x * x * x * x : x;
      length += (x - 0.5) * (x - 0.5);
    }
    const double along = p[0];
    for (double& x : p)
    {
      if (shape == Shape::Surface)
      {
        x = 0.5 + 0.4 * (x - 0.5) / std::sqrt(length);
      }
      else if (shape == Shape::Line)
      {
        x = along;
      }
      else if (shape == Shape::Lumps)
      {
        x = std::floor(3 * along) / 3 + 1e-5 * x;
      }
      x *= size;
    }
  }
  return points;
}

// Alternating ones, as those of a fit, or all of one sign, where errors cannot cancel.
std::vector<double> Weights(std::size_t count, bool alternating)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(alternating ? -1 : 0, 1);
  std::vector<double> weights(count);
  for (double& w : weights)
  {
    w = uniform(random) / static_cast<double>(count);
  }
  return weights;
}

template <int Dimension>
std::vector<double> SumDirectly(RadialKernel kernel, const Points<Dimension>& sources,
  const std::vector<double>& weights, const Points<Dimension>& points)
{
  const auto loops = lacuna::GetRadialLoops<Dimension>(kernel, lacuna::BestInstructionSet());
  std::array<std::vector<double>, Dimension> axis;
  lacuna::Coordinates<Dimension> nodes;
  for (int c = 0; c < Dimension; ++c)
  {
    for (const auto& p : sources)
    {
      axis[c].push_back(p[c]);
    }
    nodes.Axis[c] = axis[c].data();
  }
  std::vector<double> values(points.size());
  for (std::size_t first = 0; first < points.size(); first += lacuna::RadialBlock)
  {
    const std::size_t count = std::min(lacuna::RadialBlock, points.size() - first);
    double block[Dimension][lacuna::RadialBlock] = {};
    lacuna::Coordinates<Dimension> at;
    for (int c = 0; c < Dimension; ++c)
    {
      for (std::size_t p = 0; p < count; ++p)
      {
        block[c][p] = points[first + p][c];
      }
      at.Axis[c] = block[c];
    }
    double sums[lacuna::RadialBlock];
    loops.Sum(nodes, weights.data(), sources.size(), at, sums);
    std::copy_n(sums, count, values.begin() + static_cast<std::ptrdiff_t>(first));
  }
  return values;
}

double Difference(const std::vector<double>& a, const std::vector<double>& b)
{
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    largest = std::max(largest, std::abs(a[i] - b[i]));
  }
  return largest;
}

template <int Dimension>
Points<Dimension> GridPoints(const lacuna::RegularGrid<Dimension>& grid)
{
  Points<Dimension> points;
  for (std::int64_t i = 0; i < grid.GetNumberOfPoints(); ++i)
  {
    std::array<double, Dimension> p;
    std::int64_t rest = i;
    for (int c = 0; c < Dimension; ++c)
    {
      p[c] = grid.Origin[c] + static_cast<double>(rest % grid.Size[c]) * grid.Spacing[c];
      rest /= grid.Size[c];
    }
    points.push_back(p);
  }
  return points;
}

// Sums at the sources and at other points, with a length of 1 for the shaped kernels.
template <int Dimension>
void CheckBound(RadialKernel kernel, Shape shape, int count, const std::vector<double>& tolerances,
  double size = 1)
{
  const Points<Dimension> sources = Make<Dimension>(shape, count, size);
  Points<Dimension> others = Make<Dimension>(Shape::Uniform, count / 4, size);
  lacuna::ThreadExecution execution(2);
  for (const bool alternating : { true, false })
  {
    const std::vector<double> weights = Weights(sources.size(), alternating);
    for (const bool same : { true, false })
    {
      const Points<Dimension>& points = same ? sources : others;
      lacuna::FastRadialSum<Dimension> sum(kernel, sources, points);
      const std::vector<double> exact = SumDirectly<Dimension>(kernel, sources, weights, points);
      double scale = 0;
      for (const double v : exact)
      {
        scale = std::max(scale, std::abs(v));
      }
      for (const double tolerance : tolerances)
      {
        std::vector<double> values(points.size());
        const double bound = sum.Apply(execution, weights, tolerance * scale, values.data());
        EXPECT_LE(bound, tolerance * scale);
        EXPECT_LE(Difference(values, exact), tolerance * scale + 1e-13 * scale)
          << "kernel " << static_cast<int>(kernel) << " shape " << static_cast<int>(shape)
          << " tolerance " << tolerance << " order " << sum.GetOrder();
      }
    }
  }
}
}

TEST(FastRadialSum, KeepsItsBoundIn2D)
{
  for (const RadialKernel kernel : Kernels)
  {
    for (const Shape shape : Shapes)
    {
      CheckBound<2>(kernel, shape, 2000, { 1e-1, 1e-3, 1e-6, 1e-9 });
    }
  }
}

TEST(FastRadialSum, KeepsItsBoundIn3D)
{
  for (const RadialKernel kernel : Kernels)
  {
    for (const Shape shape : Shapes)
    {
      CheckBound<3>(kernel, shape, 2500, { 1e-2, 1e-4 });
    }
  }
  CheckBound<3>(RadialKernel::Linear, Shape::Uniform, 6000, { 1e-7 });
}

TEST(FastRadialSum, KeepsItsBoundForNarrowKernels)
{
  // The shaped kernels over many times their length: far away nothing is left of a Gaussian.
  for (const RadialKernel kernel :
    { RadialKernel::Gaussian, RadialKernel::Multiquadric, RadialKernel::Wendland })
  {
    CheckBound<2>(kernel, Shape::Uniform, 3000, { 1e-2, 1e-5, 1e-8 }, 30);
    CheckBound<3>(kernel, Shape::Uniform, 4000, { 1e-2, 1e-4 }, 8);
  }
}

TEST(FastRadialSum, KeepsItsBoundOnGrids)
{
  // Grids about the nodes, inside, far away, flat and of one point.
  const std::vector<lacuna::RegularGrid<2>> grids2 = {
    { { -0.3, -0.2 }, { 0.021, 0.013 }, { 83, 97 } },
    { { 0.31, 0.4 }, { 0.0021, 0.0013 }, { 70, 41 } },
    { { 40, -30 }, { 0.5, 0.25 }, { 30, 60 } },
    { { 0.5, -0.2 }, { 1, 0.001 }, { 1, 900 } },
    { { 0.5, 0.25 }, { 1, 1 }, { 1, 1 } },
  };
  const std::vector<lacuna::RegularGrid<3>> grids3 = {
    { { -0.3, -0.2, -0.1 }, { 0.06, 0.07, 0.05 }, { 26, 22, 31 } },
    { { 0.1, 0.2, 0.5 }, { 0.002, 0.003, 1 }, { 90, 80, 1 } },
  };
  lacuna::ThreadExecution execution(2);
  for (const RadialKernel kernel : Kernels)
  {
    for (const Shape shape : { Shape::Uniform, Shape::Clustered, Shape::Lumps })
    {
      const auto check = [&](const auto& sources, const auto& grid)
      {
        constexpr int dimension = std::tuple_size<decltype(grid.Origin)>::value;
        const std::vector<double> weights = Weights(sources.size(), false);
        const std::vector<double> exact =
          SumDirectly<dimension>(kernel, sources, weights, GridPoints<dimension>(grid));
        double scale = 1e-30;
        for (const double v : exact)
        {
          scale = std::max(scale, std::abs(v));
        }
        lacuna::FastRadialSum<dimension> sum(kernel, sources, grid);
        std::vector<double> values(exact.size());
        sum.Apply(execution, weights, 1e-5 * scale, values.data());
        EXPECT_LE(Difference(values, exact), 1e-5 * scale) << static_cast<int>(kernel);
      };
      for (const auto& grid : grids2)
      {
        check(Make<2>(shape, 2000), grid);
      }
      for (const auto& grid : grids3)
      {
        check(Make<3>(shape, 3000), grid);
      }
    }
  }
}

TEST(FastRadialSum, IsTheSameForAnyNumberOfThreads)
{
  const Points<3> sources = Make<3>(Shape::Clustered, 5000);
  const std::vector<double> weights = Weights(sources.size(), true);
  const lacuna::RegularGrid<3> grid{ { 0, 0, 0 }, { 0.03, 0.03, 0.03 }, { 30, 30, 30 } };
  std::vector<std::vector<double>> results;
  for (const int threads : { 1, 2, 5 })
  {
    lacuna::ThreadExecution execution(threads);
    lacuna::FastRadialSum<3> atNodes(RadialKernel::Linear, sources, sources);
    lacuna::FastRadialSum<3> onGrid(RadialKernel::Linear, sources, grid);
    std::vector<double> values(sources.size() + grid.GetNumberOfPoints());
    atNodes.Apply(execution, weights, 1e-5, values.data());
    onGrid.Apply(execution, weights, 1e-5, values.data() + sources.size());
    results.push_back(values);
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

TEST(FastRadialSum, WithLittleMemoryHasTheSameBits)
{
  lacuna::ThreadExecution execution(2);
  const auto check = [&](const auto& sources, const auto& grid, const auto& part, double least)
  {
    constexpr int dimension = std::tuple_size<decltype(grid.Origin)>::value;
    const std::vector<double> weights = Weights(sources.size(), true);
    std::size_t count = 1;
    for (const auto& range : part)
    {
      count *= range[1] - range[0];
    }
    std::vector<std::vector<double>> results;
    for (const double bytes : { 1e12, 1e6, least })
    {
      lacuna::FastRadialSum<dimension> sum(RadialKernel::Linear, sources, grid);
      sum.SetMemoryForInterpolants(bytes);
      results.emplace_back(count);
      sum.SetPart(part);
      sum.SetUpOnce(execution, weights, 1e-4);
      EXPECT_GT(sum.GetOrder(), 1);
      sum.EvaluatePart(execution, part, results.back().data());
      EXPECT_EQ(results.back(), results.front()) << bytes;
    }
  };
  const lacuna::RegularGrid<3> grid3{ { 0, 0, 0 }, { 0.02, 0.025, 0.02 }, { 50, 40, 50 } };
  check(Make<3>(Shape::Clustered, 1500), grid3, lacuna::WholeGrid(grid3), 3e5);
  // point by point
  check(Make<3>(Shape::Uniform, 1500), grid3,
    lacuna::GridPart<3>{ { { 30, 41 }, { 7, 8 }, { 20, 24 } } }, 0);
  const lacuna::RegularGrid<2> grid2{ { 0, 0 }, { 0.005, 0.004 }, { 200, 250 } };
  check(Make<2>(Shape::Clustered, 3000), grid2, lacuna::WholeGrid(grid2), 3e4);
}

TEST(FastRadialSum, UsesNoMoreThanItNeeds)
{
  const Points<2> sources = Make<2>(Shape::Uniform, 3000);
  const std::vector<double> weights = Weights(sources.size(), true);
  lacuna::ThreadExecution execution(2);
  std::vector<double> values(sources.size());
  lacuna::FastRadialSum<2> sum(RadialKernel::ThinPlate, sources, sources);
  sum.Apply(execution, weights, 1e-9, values.data());
  const int fine = sum.GetOrder();
  sum.Apply(execution, weights, 1e-2, values.data());
  EXPECT_LT(sum.GetOrder(), fine);
  std::vector<double> again(sources.size());
  lacuna::FastRadialSum<2> other(RadialKernel::ThinPlate, sources, sources);
  other.Apply(execution, weights, 1e-2, again.data());
  EXPECT_EQ(other.GetOrder(), sum.GetOrder());
  EXPECT_EQ(values, again); // what was summed before leaves no trace
}

TEST(FastRadialSum, SumsDirectlyWhereNoInterpolantIsGoodEnough)
{
  const Points<3> sources = Make<3>(Shape::Uniform, 2000);
  const std::vector<double> weights = Weights(sources.size(), true);
  lacuna::ThreadExecution execution(2);
  std::vector<double> values(sources.size());
  lacuna::FastRadialSum<3> sum(RadialKernel::Linear, sources, sources);
  sum.Apply(execution, weights, 1e-14, values.data());
  EXPECT_LT(
    Difference(values, SumDirectly<3>(RadialKernel::Linear, sources, weights, sources)), 1e-14);
}

TEST(FastRadialSum, RefusesWhatCannotBeSummed)
{
  const Points<2> sources = Make<2>(Shape::Uniform, 10);
  const Points<2> none;
  EXPECT_THROW(
    lacuna::FastRadialSum<2>(RadialKernel::Linear, none, sources), std::invalid_argument);
  EXPECT_THROW(
    lacuna::FastRadialSum<2>(RadialKernel::Linear, sources, none), std::invalid_argument);
  lacuna::FastRadialSum<2> sum(RadialKernel::Linear, sources, sources);
  lacuna::ThreadExecution execution(1);
  std::vector<double> values(10);
  EXPECT_THROW(
    sum.Apply(execution, std::vector<double>(10, 1.0), 0, values.data()), std::invalid_argument);
}

// What is refused for lack of memory is as many boxes as there would be, not a bound.
template <int Dimension>
void ExpectRoomForEachBox(const std::array<std::int64_t, Dimension>& size, int capacity)
{
  lacuna::RegularGrid<Dimension> grid;
  grid.Size = size;
  for (int c = 0; c < Dimension; ++c)
  {
    grid.Origin[c] = -0.3 * c;
    grid.Spacing[c] = (0.7 + 0.2 * c) / static_cast<double>(size[c]);
  }
  lacuna::RootCube<Dimension> root;
  root.Low.fill(-0.7);
  root.Size = 1.9;
  const lacuna::GridTree<Dimension> tree(root, grid, capacity);
  std::int64_t points = 0;
  for (const lacuna::TreeCell<Dimension>& cell : tree.Cells)
  {
    EXPECT_GT(cell.Count, 0);
    points += cell.Children == 0 ? cell.Count : 0;
  }
  EXPECT_EQ(points, grid.GetNumberOfPoints());
  EXPECT_EQ(tree.Cells.capacity(), tree.Cells.size()) << size[0] << " " << capacity;
}

TEST(FastRadialSum, CountsTheBoxesOfGrids)
{
  for (const int capacity : { 1, 7, 64, 300 })
  {
    for (const std::array<std::int64_t, 3>& size : { std::array<std::int64_t, 3>{ 1, 1, 1 },
           { 64, 64, 64 }, { 65, 63, 2 }, { 1, 900, 33 }, { 47, 51, 80 } })
    {
      ExpectRoomForEachBox<3>(size, capacity);
    }
    ExpectRoomForEachBox<2>({ 257, 90 }, capacity);
    ExpectRoomForEachBox<2>({ 1, 4000 }, capacity);
  }
}

// The boxes are those of the whole grid, of which parts may be wanted that fit.
TEST(FastRadialSum, RefusesGridsWithoutRoomForTheirBoxes)
{
  const Points<3> nodes = Make<3>(Shape::Uniform, 100);
  for (const std::int64_t size : { 100000, 1000000, 2000000 })
  {
    lacuna::RegularGrid<3> grid;
    grid.Size = { size, size, size };
    grid.Spacing.fill(1.0 / static_cast<double>(size));
    try
    {
      const lacuna::FastRadialSum<3> sum(RadialKernel::Linear, nodes, grid);
      ADD_FAILURE() << "boxes of " << size << "^3 points are there";
    }
    catch (const std::exception& error)
    {
      EXPECT_NE(std::string(error.what()).find("the boxes of a grid of"), std::string::npos);
      EXPECT_NE(std::string(error.what()).find("bytes"), std::string::npos);
    }
  }
}

// A landmark warp of a small volume: interpolants of a high order would take seconds to set up.
TEST(FastRadialSum, SumsOnceDirectlyWhereThatIsLessWork)
{
  lacuna::ThreadExecution execution(2);
  const Points<3> nodes = Make<3>(Shape::Uniform, 40);
  lacuna::RegularGrid<3> grid;
  grid.Size = { 40, 30, 12 };
  grid.Spacing = { 1.0 / 39, 1.0 / 29, 1.0 / 11 };
  const std::vector<double> weights = Weights(nodes.size(), true);
  std::vector<double> values(grid.GetNumberOfPoints());
  lacuna::FastRadialSum<3> few(RadialKernel::ThinPlate, nodes, grid);
  EXPECT_EQ(few.ApplyOnce(execution, weights, 1e-7, values.data()), 0);
  for (std::int64_t i = 0; i < grid.GetNumberOfPoints(); i += 77)
  {
    const double p[3] = { static_cast<double>(i % 40) / 39, static_cast<double>(i / 40 % 30) / 29,
      static_cast<double>(i / 1200) / 11 };
    double expected = 0;
    for (std::size_t k = 0; k < nodes.size(); ++k)
    {
      const double r = std::hypot(p[0] - nodes[k][0], p[1] - nodes[k][1], p[2] - nodes[k][2]);
      expected += r > 0 ? weights[k] * r * r * std::log(r) : 0;
    }
    EXPECT_NEAR(values[i], expected, 1e-12);
  }

  // where there is more to sum it stays fast
  const Points<2> many = Make<2>(Shape::Uniform, 700);
  lacuna::RegularGrid<2> picture;
  picture.Size = { 205, 205 };
  picture.Spacing = { 1.0 / 204, 1.0 / 204 };
  std::vector<double> fast(picture.GetNumberOfPoints());
  lacuna::FastRadialSum<2> sum(RadialKernel::ThinPlate, many, picture);
  const double bound = sum.ApplyOnce(execution, Weights(many.size(), true), 1e-4, fast.data());
  EXPECT_GT(bound, 0);
  EXPECT_LE(bound, 1e-4);
}
