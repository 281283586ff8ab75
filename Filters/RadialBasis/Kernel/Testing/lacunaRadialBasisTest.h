// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Scattered points, and functions fitted to them.
#ifndef lacunaRadialBasisTest_h
#define lacunaRadialBasisTest_h

#include "lacunaExecution.h"
#include "lacunaRadialBasis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <vector>

namespace lacunaRadialBasisTest
{
using lacuna::RadialKernel;
using Point2 = std::array<double, 2>;
using Point3 = std::array<double, 3>;
constexpr RadialKernel Kernels[] = { RadialKernel::ThinPlate, RadialKernel::Linear,
  RadialKernel::Cubic };

// function(element) of each element.
template <class Element, class Function>
auto Transformed(const std::vector<Element>& from, const Function& function)
{
  std::vector<decltype(function(from[0]))> to;
  to.reserve(from.size());
  std::transform(from.begin(), from.end(), std::back_inserter(to), function);
  return to;
}

inline double Fraction(double x)
{
  return x - std::floor(x);
}

// n quasi-random points in [0, 1)^3.
inline std::vector<Point3> Scatter(int n)
{
  std::vector<Point3> points;
  for (int i = 1; i <= n; ++i)
  {
    points.push_back({ Fraction(i * 0.7548776662466927), Fraction(i * 0.5698402909980532),
      Fraction(i * 0.8191725133961645) });
  }
  return points;
}

inline std::vector<Point2> Scatter2(int n, double width = 1, double height = 1)
{
  std::vector<Point2> points = Transformed(Scatter(n),
    [&](const Point3& p) {
      return Point2{ width * p[0], height * p[1] };
    });
  return points;
}

template <int Dimension>
lacuna::RadialBasis<Dimension> Fit(const std::vector<std::array<double, Dimension>>& nodes,
  const std::vector<double>& values, lacuna::RadialBasisOptions options = {}, int threads = 2)
{
  lacuna::ThreadExecution execution(threads);
  return lacuna::RadialBasis<Dimension>(execution, nodes, values, options);
}

template <int Dimension>
inline std::vector<double> Evaluate(const lacuna::RadialBasis<Dimension>& s,
  const std::vector<std::array<double, Dimension>>& points, int threads = 2)
{
  lacuna::ThreadExecution execution(threads);
  std::vector<double> values;
  s.Evaluate(execution, points, values);
  return values;
}

// Data of the comparison with scipy: 40 nodes in 80 x 50 x 30 mm.
inline std::vector<double> ReferenceValues(const std::vector<Point3>& nodes)
{
  std::vector<double> values;
  for (std::size_t i = 0; i < nodes.size(); ++i)
  {
    values.push_back(100 * nodes[i][0] / (80 + nodes[i][1]) +
      3 * Fraction(static_cast<double>(i + 1) * 0.3819660112501051));
  }
  return values;
}

inline std::vector<Point3> ReferenceNodes()
{
  std::vector<Point3> nodes = Scatter(40);
  for (Point3& p : nodes)
  {
    p = { 80 * p[0], 50 * p[1], 30 * p[2] };
  }
  return nodes;
}
}
#endif
