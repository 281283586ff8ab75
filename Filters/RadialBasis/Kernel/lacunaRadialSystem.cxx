// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRadialSystem.h"

#include "lacunaExecution.h"
#include "lacunaSingleBlasThread.h"
#include "lacunaSymmetricFactorization.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace lacuna
{
namespace
{
// Relative to the values: what one asks of a backward stable solve. Carr 1996, section 6.4 reports
// 2e-13.
constexpr double ResidualWanted = 1e-13;
// Above this no digit of the coefficients can be trusted.
constexpr double ConditionLimit = 4503599627370496.0; // 2^52

double MaximumNorm(const double* values, std::size_t count)
{
  double norm = 0;
  for (std::size_t i = 0; i < count; ++i)
  {
    norm = std::max(norm, std::abs(values[i]));
  }
  return norm;
}

template <int Dimension>
SquareMatrix MakeMatrix(Execution& execution, const RadialSystem<Dimension>& system)
{
  const std::size_t n = system.GetSize();
  const auto monomials = static_cast<std::size_t>(system.Polynomial.GetCount());
  const RadialLoops<Dimension> loops =
    GetRadialLoops<Dimension>(system.Kernel, BestInstructionSet());
  SquareMatrix matrix(n + monomials); // lower triangle only
  execution.For(static_cast<std::int64_t>(n), 16,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t j = begin; j < end; ++j)
      {
        double* column = matrix.Column(j);
        loops.Column(system.GetCoordinates(j), n - j, system.Nodes[j].data(), column + j);
        column[j] += system.Diagonal[j];
        system.Polynomial.Evaluate(system.Nodes[j], column + n);
      }
    });
  for (std::size_t j = n; j < n + monomials; ++j)
  {
    std::fill(matrix.Column(j) + j, matrix.Column(j) + n + monomials, 0.0);
  }
  return matrix;
}

// What the user can do against singular equations.
template <int Dimension>
std::string GetRemedy(const RadialSystem<Dimension>& system)
{
  const bool isShaped = IsRadialShaped(system.Kernel);
  if (system.IsSmoothed())
  {
    return "lower " + system.Words.Smoothing + (isShaped ? ", or change KernelLength" : "");
  }
  return (isShaped ? "change KernelLength to about the distance of nodes, use fewer nodes, or add "
                   : "nodes lie too close together for their extent, use fewer or add ") +
    system.Words.Smoothing;
}

template <int Dimension>
class DirectEquations : public RadialEquations<Dimension>
{
public:
  DirectEquations(Execution& execution, const RadialSystem<Dimension>& system)
    : System(system)
    , Factorization(MakeMatrix(execution, system))
  {
    execution.Report(1);
    if (!(this->Factorization.GetConditionEstimate() < ConditionLimit))
    {
      std::ostringstream message;
      message << "their condition number is " << this->Factorization.GetConditionEstimate();
      throw std::runtime_error(message.str());
    }
  }

  std::vector<double> Solve(
    Execution& execution, const std::vector<double>& values, double, RadialSolution& found) override
  {
    const std::size_t n = this->System.GetSize();
    std::vector<double> coefficients(n + this->System.Polynomial.GetCount(), 0.0);
    std::copy(values.begin(), values.end(), coefficients.begin());
    this->Factorization.Solve(coefficients);
    std::vector<double> residual = this->System.GetResidual(execution, values, coefficients);
    double norm = MaximumNorm(residual.data(), n);
    if (norm > ResidualWanted * MaximumNorm(values.data(), n))
    {
      std::vector<double> better = coefficients;
      this->Factorization.Solve(residual);
      for (std::size_t i = 0; i < better.size(); ++i)
      {
        better[i] += residual[i];
      }
      residual = this->System.GetResidual(execution, values, better);
      const double refined = MaximumNorm(residual.data(), n);
      if (refined < norm)
      {
        found.Refined = true;
        coefficients = std::move(better);
        norm = refined;
      }
    }
    found.Residual = std::max(found.Residual, norm);
    found.ConditionEstimate = this->Factorization.GetConditionEstimate();
    return coefficients;
  }

private:
  const RadialSystem<Dimension>& System;
  SymmetricFactorization Factorization;
};
}

//------------------------------------------------------------------------------
template <int Dimension>
bool RadialSystem<Dimension>::IsSmoothed() const
{
  return std::any_of(this->Diagonal.begin(), this->Diagonal.end(), [](double d) { return d > 0; });
}

//------------------------------------------------------------------------------
template <int Dimension>
Coordinates<Dimension> RadialSystem<Dimension>::GetCoordinates(std::size_t first) const
{
  Coordinates<Dimension> nodes;
  for (int c = 0; c < Dimension; ++c)
  {
    nodes.Axis[c] = this->Axis[c].data() + first;
  }
  return nodes;
}

template <int Dimension>
std::vector<double> RadialSystem<Dimension>::GetResidual(Execution& execution,
  const std::vector<double>& values, const std::vector<double>& coefficients) const
{
  const std::size_t n = this->GetSize();
  const auto monomials = static_cast<std::size_t>(this->Polynomial.GetCount());
  const RadialLoops<Dimension> loops =
    GetRadialLoops<Dimension>(this->Kernel, BestInstructionSet());
  std::vector<double> residual(n + monomials, 0.0);
  const auto blocks = static_cast<std::int64_t>((n + RadialBlock - 1) / RadialBlock);
  const auto body = [&](std::int64_t begin, std::int64_t end)
  {
    alignas(64) double block[Dimension][RadialBlock] = {};
    alignas(64) double sums[RadialBlock];
    double basis[RadialPolynomial<Dimension>::MaximumCount];
    for (std::size_t i = begin * RadialBlock; i < std::min(end * RadialBlock, n); i += RadialBlock)
    {
      const std::size_t count = std::min(RadialBlock, n - i);
      Coordinates<Dimension> points;
      for (int k = 0; k < Dimension; ++k)
      {
        std::copy_n(this->Axis[k].data() + i, count, block[k]);
        points.Axis[k] = block[k];
      }
      loops.Sum(this->GetCoordinates(), coefficients.data(), n, points, sums);
      for (std::size_t p = i; p < i + count; ++p)
      {
        this->Polynomial.Evaluate(this->Nodes[p], basis);
        double sum = sums[p - i] + this->Diagonal[p] * coefficients[p];
        for (std::size_t k = 0; k < monomials; ++k)
        {
          sum += coefficients[n + k] * basis[k];
        }
        residual[p] = values[p] - sum;
      }
    }
  };
  execution.For(blocks, 4, body);
  double basis[RadialPolynomial<Dimension>::MaximumCount];
  for (std::size_t i = 0; i < n; ++i)
  {
    this->Polynomial.Evaluate(this->Nodes[i], basis);
    for (std::size_t k = 0; k < monomials; ++k)
    {
      residual[n + k] -= coefficients[i] * basis[k];
    }
  }
  return residual;
}

//------------------------------------------------------------------------------
template <int Dimension>
std::unique_ptr<RadialEquations<Dimension>> PrepareDirectly(
  Execution& execution, const RadialSystem<Dimension>& system, std::uint64_t maximumBytes)
{
  const std::size_t n = system.GetSize();
  const std::uint64_t bytes = SquareMatrix::GetBytes(n + system.Polynomial.GetCount());
  if (bytes > maximumBytes)
  {
    std::ostringstream message;
    message << n << " nodes need a matrix of " << bytes << " bytes, more than the limit of "
            << maximumBytes << " bytes";
    throw std::length_error(message.str());
  }
  const SingleBlasThread single; // no room for BLAS says nothing about the equations
  try
  {
    return std::make_unique<DirectEquations<Dimension>>(execution, system);
  }
  catch (const Aborted&)
  {
    throw;
  }
  catch (const std::runtime_error& e)
  {
    throw std::runtime_error(std::string("the interpolation equations cannot be solved: ") +
      e.what() + "; " + GetRemedy(system));
  }
}

template struct RadialSystem<2>;
template struct RadialSystem<3>;
template std::unique_ptr<RadialEquations<2>> PrepareDirectly<2>(
  Execution&, const RadialSystem<2>&, std::uint64_t);
template std::unique_ptr<RadialEquations<3>> PrepareDirectly<3>(
  Execution&, const RadialSystem<3>&, std::uint64_t);
}
