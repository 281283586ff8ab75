// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Scattered values to interpolate: Franke's function in the unit square (in 3-D times cos 3z), and
/// the direct sum of a thin plate that one would write first.
#ifndef lacunaScatteredProblem_h
#define lacunaScatteredProblem_h

#include "lacunaRadialBasis.h"

#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace lacunaScatteredProblem
{
using Point = std::array<double, 2>;

inline double Franke(const Point& p)
{
  const auto square = [](double a) { return a * a; };
  const double x = 9 * p[0];
  const double y = 9 * p[1];
  return 0.75 * std::exp(-(square(x - 2) + square(y - 2)) / 4) +
    0.75 * std::exp(-square(x + 1) / 49 - (y + 1) / 10) +
    0.5 * std::exp(-(square(x - 7) + square(y - 3)) / 4) -
    0.2 * std::exp(-square(x - 4) - square(y - 7));
}

/// Nodes spread evenly.
struct Problem
{
  std::vector<Point> Nodes;
  std::vector<double> Values;

  explicit Problem(std::int64_t count)
  {
    for (std::int64_t i = 1; i <= count; ++i)
    {
      const double x = static_cast<double>(i) * 0.7548776662466927;
      const double y = static_cast<double>(i) * 0.5698402909980532;
      this->Nodes.push_back({ x - std::floor(x), y - std::floor(y) });
      this->Values.push_back(Franke(this->Nodes.back()));
    }
  }
};

inline std::vector<Point> MakeGrid(std::int64_t size)
{
  std::vector<Point> points;
  for (std::int64_t j = 0; j < size; ++j)
  {
    for (std::int64_t i = 0; i < size; ++i)
    {
      points.push_back({ static_cast<double>(i) / static_cast<double>(size - 1),
        static_cast<double>(j) / static_cast<double>(size - 1) });
    }
  }
  return points;
}

constexpr std::int64_t ThinPlate = static_cast<std::int64_t>(lacuna::RadialKernel::ThinPlate);
constexpr std::int64_t Linear = static_cast<std::int64_t>(lacuna::RadialKernel::Linear);

inline lacuna::RadialBasisOptions MakeOptions(std::int64_t kernel)
{
  lacuna::RadialBasisOptions options;
  options.Kernel = static_cast<lacuna::RadialKernel>(kernel);
  return options;
}

/// Nodes at random places.
template <int Dimension>
struct Scattered
{
  std::vector<std::array<double, Dimension>> Nodes;
  std::vector<double> Values;

  explicit Scattered(std::int64_t count)
  {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (std::int64_t i = 0; i < count; ++i)
    {
      std::array<double, Dimension> p;
      for (double& x : p)
      {
        x = uniform(random);
      }
      this->Nodes.push_back(p);
      this->Values.push_back(
        Franke({ p[0], p[1] }) * (Dimension == 3 ? std::cos(3 * p[Dimension - 1]) : 1));
    }
  }
};

/// Arguments of the row: kernel, nodes, digits of the accuracy.
inline lacuna::RadialBasisOptions MakeFastOptions(const benchmark::State& state)
{
  lacuna::RadialBasisOptions options = MakeOptions(state.range(0));
  options.Accuracy = std::pow(10.0, -static_cast<double>(state.range(2)));
  return options;
}

/// The direct sum of a thin plate as one would write it first.
inline void SumPlainly(const std::vector<Point>& nodes, const std::vector<double>& weights,
  const std::vector<Point>& points, std::vector<double>& values)
{
  for (std::size_t p = 0; p < points.size(); ++p)
  {
    double sum = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i)
    {
      const double dx = points[p][0] - nodes[i][0];
      const double dy = points[p][1] - nodes[i][1];
      const double r2 = dx * dx + dy * dy;
      sum += r2 > 0 ? weights[i] * 0.5 * r2 * std::log(r2) : 0;
    }
    values[p] = sum;
  }
}
}
#endif
