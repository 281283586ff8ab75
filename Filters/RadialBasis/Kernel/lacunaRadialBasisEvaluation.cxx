// SPDX-License-Identifier: BSD-3-Clause
// Values of a function that is fitted.
#include "lacunaExecution.h"
#include "lacunaFastRadialSum.h"
#include "lacunaRadialBasis.h"

#include <algorithm>
#include <cstddef>
#include <memory>

namespace lacuna
{
namespace
{
// Direct sums of so many functions take less time than to set up fast ones.
constexpr double FewEvaluations = 2e8;

template <class Part>
bool IsEmpty(const Part& part)
{
  return std::any_of(
    part.begin(), part.end(), [](const auto& range) { return range[0] >= range[1]; });
}
}

//------------------------------------------------------------------------------
template <int Dimension>
double RadialBasis<Dimension>::EvaluatePolynomial(
  const double* coefficients, const Point& u, Point* gradient) const
{
  const RadialPolynomial<Dimension>& polynomial = this->GetCenters().Polynomial;
  double monomials[RadialPolynomial<Dimension>::MaximumCount];
  polynomial.Evaluate(u, monomials);
  double value = 0;
  for (int k = 0; k < polynomial.GetCount(); ++k)
  {
    value += coefficients[k] * monomials[k];
  }
  if (gradient)
  {
    for (int c = 0; c < Dimension; ++c)
    {
      (*gradient)[c] = coefficients[1 + c] / polynomial.Length;
    }
    const double* quadratic = coefficients + Dimension + 1;
    const double square = polynomial.Length * polynomial.Length;
    for (int c = 0; c < Dimension && polynomial.Degree == 2; ++c)
    {
      for (int d = c; d < Dimension; ++d, ++quadratic)
      {
        (*gradient)[c] += *quadratic * u[d] / square;
        (*gradient)[d] += *quadratic * u[c] / square;
      }
    }
  }
  return value;
}

template <int Dimension>
void RadialBasis<Dimension>::EvaluateBlock(
  int component, const Point* points, std::size_t count, double* values, Point* gradients) const
{
  const std::size_t n = this->GetCenters().GetSize();
  const double* coefficients = this->Coefficients[component].data();
  alignas(64) double block[Dimension][RadialBlock] = {};
  alignas(64) double sums[RadialBlock];
  alignas(64) double slopes[Dimension][RadialBlock];
  Point scaled[RadialBlock];
  Coordinates<Dimension> at;
  for (int k = 0; k < Dimension; ++k)
  {
    at.Axis[k] = block[k];
  }
  for (std::size_t p = 0; p < count; ++p)
  {
    scaled[p] = this->Frame.ToScaled(points[p]);
    for (int k = 0; k < Dimension; ++k)
    {
      block[k][p] = scaled[p][k];
    }
  }
  if (gradients)
  {
    this->Loops.SumAndGradient(
      this->GetCenters().GetCoordinates(), coefficients, n, at, sums, slopes[0]);
  }
  else
  {
    this->Loops.Sum(this->GetCenters().GetCoordinates(), coefficients, n, at, sums);
  }
  for (std::size_t p = 0; p < count; ++p)
  {
    Point slope;
    values[p] = sums[p] +
      this->EvaluatePolynomial(coefficients + n, scaled[p], gradients ? &slope : nullptr) +
      this->Means[component];
    for (int k = 0; gradients && k < Dimension; ++k)
    {
      gradients[p][k] = this->Frame.Scale * (slopes[k][p] + slope[k]);
    }
  }
}

template <int Dimension>
void RadialBasis<Dimension>::EvaluateBlocks(Execution& execution, int component,
  const std::vector<Point>& points, double* values, Point* gradients) const
{
  constexpr auto size = static_cast<std::int64_t>(RadialBlock);
  const auto count = static_cast<std::int64_t>(points.size());
  execution.For((count + size - 1) / size, 4,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t i = begin * size; i < std::min(end * size, count); i += size)
      {
        this->EvaluateBlock(component, points.data() + i, std::min(size, count - i), values + i,
          gradients ? gradients + i : nullptr);
      }
    });
}

template <int Dimension>
void RadialBasis<Dimension>::Evaluate(Execution& execution, const std::vector<Point>& points,
  std::vector<double>& values, int component) const
{
  values.resize(points.size());
  this->EvaluateBlocks(execution, component, points, values.data(), nullptr);
}

template <int Dimension>
void RadialBasis<Dimension>::Evaluate(Execution& execution, const std::vector<Point>& points,
  std::vector<double>& values, std::vector<Point>& gradients, int component) const
{
  values.resize(points.size());
  gradients.resize(points.size());
  this->EvaluateBlocks(execution, component, points, values.data(), gradients.data());
}

template <int Dimension>
double RadialBasis<Dimension>::EvaluateWithin(Execution& execution, double tolerance,
  const std::vector<Point>& points, std::vector<double>& values, int component) const
{
  const std::size_t n = this->GetCenters().GetSize();
  if (static_cast<double>(n) * static_cast<double>(points.size()) < FewEvaluations)
  {
    this->Evaluate(execution, points, values, component);
    return 0;
  }
  std::vector<Point> scaled;
  scaled.reserve(points.size());
  for (const Point& p : points)
  {
    scaled.push_back(this->Frame.ToScaled(p));
  }
  values.resize(points.size());
  const std::vector<double>& coefficients = this->Coefficients[component];
  FastRadialSum<Dimension> sum(this->Options.Kernel, this->GetCenters().Nodes, scaled);
  sum.SetWords(this->Options.Words);
  const double bound = sum.ApplyOnce(execution,
    { coefficients.begin(), coefficients.begin() + static_cast<std::ptrdiff_t>(n) }, tolerance,
    values.data());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    values[i] += this->Means[component] +
      this->EvaluatePolynomial(coefficients.data() + n, scaled[i], nullptr);
  }
  return bound;
}

//------------------------------------------------------------------------------
template <int Dimension>
void RadialBasis<Dimension>::EvaluateGrid(Execution& execution, const RegularGrid<Dimension>& grid,
  const GridPart<Dimension>& part, double* values, int component) const
{
  if (IsEmpty(part))
  {
    return;
  }
  const Execution::NestedStages stages(execution);
  execution.SetStage(0, 0.6);
  const OnGrid on(execution, *this, grid, part, component);
  execution.SetStage(0.6, 1);
  on.Evaluate(execution, part, values);
}

template <int Dimension>
RadialBasis<Dimension>::OnGrid::OnGrid(Execution& execution, const RadialBasis& function,
  const RegularGrid<Dimension>& grid, const GridPart<Dimension>& region, int component,
  double memory)
  : Function(function)
  , Grid(grid)
  , Component(component)
  , Scaled(grid)
{
  this->Scaled.Origin = function.Frame.ToScaled(grid.Origin);
  for (double& spacing : this->Scaled.Spacing)
  {
    spacing *= function.Frame.Scale;
  }
  const double tolerance = function.Options.Accuracy * function.Ranges[component];
  if (!(tolerance > 0) || IsEmpty(region))
  {
    return;
  }
  const auto n = static_cast<std::ptrdiff_t>(function.GetCenters().GetSize());
  const std::vector<double>& coefficients = function.Coefficients[component];
  const auto sum = std::make_shared<FastRadialSum<Dimension>>(
    function.Options.Kernel, function.GetCenters().Nodes, this->Scaled);
  sum->SetWords(function.Options.Words);
  sum->SetPart(region);
  sum->SetMemoryForInterpolants(memory);
  sum->SetUpOnce(execution, { coefficients.begin(), coefficients.begin() + n }, tolerance);
  this->Sum = sum;
}

template <int Dimension>
void RadialBasis<Dimension>::OnGrid::Evaluate(
  Execution& execution, const GridPart<Dimension>& part, double* values) const
{
  if (IsEmpty(part))
  {
    return;
  }
  const std::int64_t columns = part[0][1] - part[0][0];
  std::int64_t rows = 1;
  for (int c = 1; c < Dimension; ++c)
  {
    rows *= part[c][1] - part[c][0];
  }
  // Where a row of the part starts.
  const auto getRow = [&](const RegularGrid<Dimension>& grid, std::int64_t row)
  {
    Point start = grid.Origin;
    for (int c = 1; c < Dimension; ++c)
    {
      const std::int64_t size = part[c][1] - part[c][0];
      start[c] += static_cast<double>(part[c][0] + row % size) * grid.Spacing[c];
      row /= size;
    }
    return start;
  };
  const RadialBasis& function = this->Function;
  if (!this->Sum)
  {
    execution.For(rows, 1,
      [&](std::int64_t begin, std::int64_t end)
      {
        Point points[RadialBlock];
        for (std::int64_t row = begin; row < end; ++row)
        {
          const Point start = getRow(this->Grid, row);
          for (std::int64_t first = 0; first < columns; first += RadialBlock)
          {
            const auto count =
              static_cast<std::size_t>(std::min<std::int64_t>(RadialBlock, columns - first));
            for (std::size_t i = 0; i < count; ++i)
            {
              points[i] = start;
              points[i][0] += static_cast<double>(part[0][0] + first + i) * this->Grid.Spacing[0];
            }
            function.EvaluateBlock(
              this->Component, points, count, values + row * columns + first, nullptr);
          }
        }
      });
    return;
  }
  const Execution::NestedStages stages(execution);
  execution.SetStage(0, 0.8);
  this->Sum->EvaluatePart(execution, part, values);
  execution.SetStage(0.8, 1);
  const double* polynomial =
    function.Coefficients[this->Component].data() + function.GetCenters().GetSize();
  execution.For(rows, 16,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t row = begin; row < end; ++row)
      {
        Point u = getRow(this->Scaled, row);
        for (std::int64_t i = 0; i < columns; ++i)
        {
          u[0] =
            this->Scaled.Origin[0] + static_cast<double>(part[0][0] + i) * this->Scaled.Spacing[0];
          values[row * columns + i] +=
            function.Means[this->Component] + function.EvaluatePolynomial(polynomial, u, nullptr);
        }
      }
    });
}

template double RadialBasis<2>::EvaluatePolynomial(const double*, const Point&, Point*) const;
template void RadialBasis<2>::Evaluate(
  Execution&, const std::vector<Point>&, std::vector<double>&, int) const;
template void RadialBasis<2>::Evaluate(
  Execution&, const std::vector<Point>&, std::vector<double>&, std::vector<Point>&, int) const;
template double RadialBasis<2>::EvaluateWithin(
  Execution&, double, const std::vector<Point>&, std::vector<double>&, int) const;
template void RadialBasis<2>::EvaluateGrid(
  Execution&, const RegularGrid<2>&, const GridPart<2>&, double*, int) const;
template class RadialBasis<2>::OnGrid;
template double RadialBasis<3>::EvaluatePolynomial(const double*, const Point&, Point*) const;
template void RadialBasis<3>::Evaluate(
  Execution&, const std::vector<Point>&, std::vector<double>&, int) const;
template void RadialBasis<3>::Evaluate(
  Execution&, const std::vector<Point>&, std::vector<double>&, std::vector<Point>&, int) const;
template double RadialBasis<3>::EvaluateWithin(
  Execution&, double, const std::vector<Point>&, std::vector<double>&, int) const;
template void RadialBasis<3>::EvaluateGrid(
  Execution&, const RegularGrid<3>&, const GridPart<3>&, double*, int) const;
template class RadialBasis<3>::OnGrid;
}
