// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRadialSystem.h"

#include "lacunaExecution.h"
#include "lacunaFastRadialSum.h"
#include "lacunaMemory.h"
#include "lacunaSchwarzPreconditioner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace lacuna
{
namespace
{
// Directions that are kept, and how often one starts anew from the true residual.
constexpr int MaximumDirections = 40;
constexpr int MaximumCycles = 8;
// Error of the products in the iteration, relative to what the tolerance leaves room for. Bounds
// are far above the true errors, and the true residual is looked at in the end.
constexpr double ProductAccuracy = 1.0;
// Error bound of the sums that the true residual is made of, relative to the tolerance.
constexpr double ResidualAccuracy = 0.1;
// Of the residual at its start: farther down a cycle does not go, since what it thinks is left is
// not what is; the next one begins with the true residual.
constexpr double CycleReduction = 1e-7;

double Dot(const std::vector<double>& a, const std::vector<double>& b)
{
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    sum += a[i] * b[i];
  }
  return sum;
}

void AddMultiple(std::vector<double>& a, double factor, const std::vector<double>& b)
{
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    a[i] += factor * b[i];
  }
}

double MaximumNorm(const std::vector<double>& values)
{
  double norm = 0;
  for (const double v : values)
  {
    norm = std::max(norm, std::abs(v));
  }
  return norm;
}

// The Krylov space of GMRES: orthonormal directions, and what is left of a residual in terms of them.
class Directions
{
public:
  enum class Added
  {
    Nothing, // it lies in the space already
    One,
    Last // and the residual is 0 now
  };

  explicit Directions(const std::vector<double>& residual)
    : Left(std::sqrt(Dot(residual, residual)))
    , Right(1, this->Left)
    , V(1, residual)
  {
    for (double& x : this->V[0])
    {
      x /= this->Left;
    }
  }

  const std::vector<double>& GetLast() const { return this->V.back(); }
  double GetLeft() const { return this->Left; } // 2-norm of the residual

  // w: what the equations make of the preconditioned last direction.
  Added Add(std::vector<double> w)
  {
    const std::size_t k = this->Columns.size();
    std::vector<double> column = this->Orthogonalize(w);
    const double next = column[k + 1];
    for (std::size_t j = 0; j < k; ++j)
    {
      const std::array<double, 2>& turn = this->Rotations[j];
      const double upper = turn[0] * column[j] + turn[1] * column[j + 1];
      column[j + 1] = -turn[1] * column[j] + turn[0] * column[j + 1];
      column[j] = upper;
    }
    const double radius = std::hypot(column[k], column[k + 1]);
    if (radius == 0)
    {
      return Added::Nothing;
    }
    this->Rotations.push_back({ column[k] / radius, column[k + 1] / radius });
    column[k] = radius;
    this->Columns.push_back(std::move(column));
    this->Right.push_back(-this->Rotations[k][1] * this->Right[k]);
    this->Right[k] *= this->Rotations[k][0];
    this->Left = std::abs(this->Right[k + 1]);
    if (next == 0)
    {
      return Added::Last;
    }
    this->V.push_back(std::move(w));
    for (double& x : this->V.back())
    {
      x /= next;
    }
    return Added::One;
  }

  // The residual itself: the last of Right times the last column of the rotations in terms of V.
  void GetResidual(std::vector<double>& residual) const
  {
    const std::size_t k = this->Rotations.size();
    std::vector<double> factors(k + 1, 0.0);
    factors[k] = this->Right[k];
    for (std::size_t j = k; j-- > 0;)
    {
      factors[j] = -this->Rotations[j][1] * factors[j + 1];
      factors[j + 1] *= this->Rotations[j][0];
    }
    std::fill(residual.begin(), residual.end(), 0.0);
    for (std::size_t j = 0; j <= k; ++j)
    {
      AddMultiple(residual, factors[j], this->V[j]);
    }
  }

  // Of the preconditioned directions, so that the residual becomes least.
  std::vector<double> GetFactors() const
  {
    std::vector<double> y(this->Columns.size());
    for (std::size_t k = this->Columns.size(); k-- > 0;)
    {
      y[k] = this->Right[k];
      for (std::size_t j = k + 1; j < this->Columns.size(); ++j)
      {
        y[k] -= this->Columns[j][k] * y[j];
      }
      y[k] /= this->Columns[k][k];
    }
    return y;
  }

private:
  // Takes the directions out of w, twice. Their parts in it, then the length of what is left.
  std::vector<double> Orthogonalize(std::vector<double>& w) const
  {
    const std::size_t k = this->V.size() - 1;
    std::vector<double> column(k + 2, 0.0);
    for (int pass = 0; pass < 2; ++pass)
    {
      for (std::size_t j = 0; j <= k; ++j)
      {
        const double part = Dot(w, this->V[j]);
        column[j] += part;
        AddMultiple(w, -part, this->V[j]);
      }
    }
    column[k + 1] = std::sqrt(Dot(w, w));
    return column;
  }

  double Left;
  std::vector<double> Right;
  std::vector<std::vector<double>> V;
  // The upper triangle that Givens rotations leave of the Hessenberg matrix
  std::vector<std::vector<double>> Columns;
  std::vector<std::array<double, 2>> Rotations;
};

template <int Dimension>
class IterativeEquations : public RadialEquations<Dimension>
{
public:
  IterativeEquations(Execution& execution, const RadialSystem<Dimension>& system)
    : System(system)
    , Sum(system.Kernel, system.Nodes, system.Nodes)
    , Projection(system.Polynomial, system.Nodes)
  {
    this->Sum.SetWords(system.Words);
    const auto n = static_cast<double>(system.GetSize());
    RequireMemory("the fast solution of " + std::to_string(system.GetSize()) + " equations",
      SchwarzPreconditioner<Dimension>::EstimateBytes(system.GetSize()) +
        n * sizeof(double) * (2 * MaximumDirections + 20));
    this->Preconditioner = std::make_unique<SchwarzPreconditioner<Dimension>>(execution, system);
  }

  std::vector<double> Solve(Execution& execution, const std::vector<double>& values,
    double tolerance, RadialSolution& found) override
  {
    const Execution::NestedStages stages(execution);
    this->Run = &execution;
    this->Tolerance = tolerance;
    const std::size_t n = this->System.GetSize();
    std::vector<double> weights(n, 0.0);
    std::vector<double> residual = values;
    this->Projection.Remove(residual);
    double norm = MaximumNorm(residual);
    this->Iterations = 0;
    std::vector<double> left = values; // values - (A + D) weights
    for (int cycle = 0; cycle < MaximumCycles && norm > this->Tolerance; ++cycle)
    {
      const double before = norm;
      this->Cycle(residual, weights);
      std::vector<double> product(n);
      const double bound =
        this->Sum.Apply(*this->Run, weights, ResidualAccuracy * this->Tolerance, product.data());
      this->AddDiagonal(weights, product);
      for (std::size_t i = 0; i < n; ++i)
      {
        left[i] = values[i] - product[i];
      }
      residual = left;
      this->Projection.Remove(residual);
      norm = MaximumNorm(residual) + bound;
      if (norm > 0.5 * before)
      {
        norm = std::min(norm, before);
        break; // round-off stands in the way
      }
    }
    if (!(norm <= this->Tolerance))
    {
      std::ostringstream message;
      message << "the interpolation equations could only be solved to " << norm << ", not to "
              << this->Tolerance << "; raise " << this->System.Words.Accuracy << ", "
              << (this->System.IsSmoothed() ? "change " : "add ") << this->System.Words.Smoothing
              << (IsRadialShaped(this->System.Kernel) ? ", or lower KernelLength" : "");
      throw std::runtime_error(message.str());
    }
    found.Residual = std::max(found.Residual, norm);
    found.Iterations = std::max(found.Iterations, this->Iterations);
    const std::vector<double> polynomial = this->Projection.GetCoefficients(left);
    weights.insert(weights.end(), polynomial.begin(), polynomial.end());
    return weights;
  }

private:
  void AddDiagonal(const std::vector<double>& weights, std::vector<double>& product) const
  {
    for (std::size_t i = 0; i < weights.size(); ++i)
    {
      product[i] += this->System.Diagonal[i] * weights[i];
    }
  }

  // One run of flexible GMRES on residual, which becomes what it thinks is left.
  void Cycle(std::vector<double>& residual, std::vector<double>& weights)
  {
    const double start = MaximumNorm(residual);
    Directions tried(residual);
    std::vector<std::vector<double>> z;
    for (int k = 0; k < MaximumDirections; ++k)
    {
      z.push_back(this->Preconditioner->Apply(*this->Run, tried.GetLast()));
      std::vector<double> w(residual.size());
      this->Sum.ApplyUpTo(ProductOrder, *this->Run, z[k],
        ProductAccuracy * this->Tolerance / tried.GetLeft(), w.data());
      this->AddDiagonal(z[k], w);
      this->Projection.Remove(w);
      const Directions::Added added = tried.Add(std::move(w));
      if (added == Directions::Added::Nothing)
      {
        z.pop_back();
        break;
      }
      ++this->Iterations;
      if (added == Directions::Added::Last)
      {
        break;
      }
      tried.GetResidual(residual);
      const double norm = MaximumNorm(residual);
      this->ReportProgress(norm / start, start);
      if (norm <= std::max(0.6 * this->Tolerance, CycleReduction * start))
      {
        break;
      }
    }
    const std::vector<double> y = tried.GetFactors();
    for (std::size_t k = 0; k < y.size(); ++k)
    {
      AddMultiple(weights, y[k], z[k]);
    }
  }

  void ReportProgress(double reduction, double start)
  {
    const double whole = std::log(std::min(0.5, this->Tolerance / start));
    const double done = std::min(1.0, std::max(0.0, std::log(std::max(reduction, 1e-300)) / whole));
    // Each product is a stage between this iteration and about where the next will be.
    this->Run->SetStage(done, std::min(1.0, done + 0.1));
    this->Run->Report(0);
  }

  static constexpr int ProductOrder = Dimension == 2 ? 12 : 8;

  const RadialSystem<Dimension>& System;
  FastRadialSum<Dimension> Sum;
  PolynomialProjection Projection;
  std::unique_ptr<SchwarzPreconditioner<Dimension>> Preconditioner;
  // of the solution at hand
  Execution* Run = nullptr;
  double Tolerance = 0;
  int Iterations = 0;
};
}

//------------------------------------------------------------------------------
template <int Dimension>
std::unique_ptr<RadialEquations<Dimension>> PrepareIteratively(
  Execution& execution, const RadialSystem<Dimension>& system)
{
  return std::make_unique<IterativeEquations<Dimension>>(execution, system);
}

template std::unique_ptr<RadialEquations<2>> PrepareIteratively<2>(
  Execution&, const RadialSystem<2>&);
template std::unique_ptr<RadialEquations<3>> PrepareIteratively<3>(
  Execution&, const RadialSystem<3>&);
}
