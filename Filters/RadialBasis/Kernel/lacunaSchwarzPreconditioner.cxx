// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSchwarzPreconditioner.h"

#include "lacunaExecution.h"
#include "lacunaNodePartition.h"
#include "lacunaSingleBlasThread.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

// Fortran interfaces; the last arguments are the lengths of the character arguments.
extern "C"
{
  void dgeqrf_(const int* m, const int* n, double* a, const int* lda, double* tau, double* work,
    const int* workLength, int* info);
  void dormqr_(const char* side, const char* trans, const int* m, const int* n, const int* k,
    const double* a, const int* lda, const double* tau, double* c, const int* ldc, double* work,
    const int* workLength, int* info, std::size_t, std::size_t);
  void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info, std::size_t);
  void dpotri_(const char* uplo, const int* n, double* a, const int* lda, int* info, std::size_t);
}

namespace lacuna
{
namespace
{
// Nodes of a group, with its surroundings, and nodes for one of the next coarser set: from trials
// with up to 10^6 nodes. A group that reaches farther costs more to invert and saves iterations.
template <int Dimension>
struct Sizes
{
  static constexpr int Own = Dimension == 2 ? 64 : 100;
  static constexpr std::size_t Surroundings = Dimension == 2 ? 160 : 400;
  static constexpr int Ratio = Dimension == 2 ? 6 : 8;
  static constexpr std::size_t Coarsest = 2000;
};

double Dot(const std::vector<double>& a, const std::vector<double>& b)
{
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    sum += a[i] * b[i];
  }
  return sum;
}

double GetRootMeanSquare(const std::vector<double>& a)
{
  return std::sqrt(Dot(a, a) / static_cast<double>(a.size()));
}

template <class T>
std::vector<T> Pick(const std::vector<T>& all, const std::vector<std::uint32_t>& which)
{
  std::vector<T> picked;
  picked.reserve(which.size());
  for (const std::uint32_t i : which)
  {
    picked.push_back(all[i]);
  }
  return picked;
}

// The equations of some nodes in a frame of their own, so that their extent does not count.
template <int Dimension>
struct LocalSystem : RadialSystem<Dimension>
{
  using Point = std::array<double, Dimension>;

  LocalSystem(
    const RadialSystem<Dimension>& whole, std::vector<Point> nodes, std::vector<double> diagonal)
  {
    this->Kernel = whole.Kernel;
    this->Polynomial = whole.Polynomial;
    this->Nodes = std::move(nodes);
    this->Diagonal = std::move(diagonal);
    Point low = this->Nodes[0];
    Point high = low;
    for (const Point& x : this->Nodes)
    {
      for (int c = 0; c < Dimension; ++c)
      {
        low[c] = std::min(low[c], x[c]);
        high[c] = std::max(high[c], x[c]);
      }
    }
    double extent = 0;
    for (int c = 0; c < Dimension; ++c)
    {
      extent = std::max(extent, high[c] - low[c]);
    }
    const bool shaped = IsRadialShaped(this->Kernel);
    const double unit = shaped ? 1.0 : extent;
    this->Polynomial.Length = shaped ? extent : 1.0;
    this->Scale = std::pow(unit, GetRadialPower(this->Kernel));
    for (std::size_t i = 0; i < this->Nodes.size(); ++i)
    {
      this->Diagonal[i] /= this->Scale;
      for (int c = 0; c < Dimension; ++c)
      {
        this->Nodes[i][c] = (this->Nodes[i][c] - low[c]) / unit;
        this->Axis[c].push_back(this->Nodes[i][c]);
      }
    }
  }

  // P, column after column.
  std::vector<double> GetMonomials() const
  {
    const std::size_t size = this->GetSize();
    std::vector<double> monomials(size * this->Polynomial.GetCount());
    double row[RadialPolynomial<Dimension>::MaximumCount];
    for (std::size_t i = 0; i < size; ++i)
    {
      this->Polynomial.Evaluate(this->Nodes[i], row);
      for (int k = 0; k < this->Polynomial.GetCount(); ++k)
      {
        monomials[i + size * k] = row[k];
      }
    }
    return monomials;
  }

  // A + diagonal.
  std::vector<double> GetMatrix() const
  {
    const std::size_t size = this->GetSize();
    const RadialLoops<Dimension> loops =
      GetRadialLoops<Dimension>(this->Kernel, BestInstructionSet());
    std::vector<double> matrix(size * size);
    for (std::size_t j = 0; j < size; ++j)
    {
      loops.Column(this->GetCoordinates(), size, this->Nodes[j].data(), matrix.data() + size * j);
      matrix[j + size * j] += this->Diagonal[j];
    }
    return matrix;
  }

  double Scale; // its kernel is that of the whole, divided by this
};

// Q of the QR decomposition of a matrix.
class Orthogonal
{
public:
  Orthogonal(std::vector<double> matrix, int rows, int columns)
    : Rows(rows)
    , Columns(columns)
    , Reflectors(std::move(matrix))
    , Tau(columns)
    , Work(64 * static_cast<std::size_t>(rows))
    , WorkLength(static_cast<int>(this->Work.size()))
  {
    int info = 0;
    dgeqrf_(&this->Rows, &this->Columns, this->Reflectors.data(), &this->Rows, this->Tau.data(),
      this->Work.data(), &this->WorkLength, &info);
  }

  // Multiplies a square matrix from the left ("L") or right ("R") by Q ("N") or its transpose ("T").
  void Multiply(const char* side, const char* trans, std::vector<double>& matrix)
  {
    int info = 0;
    dormqr_(side, trans, &this->Rows, &this->Rows, &this->Columns, this->Reflectors.data(),
      &this->Rows, this->Tau.data(), matrix.data(), &this->Rows, this->Work.data(),
      &this->WorkLength, &info, 1, 1);
  }

private:
  int Rows;
  int Columns;
  std::vector<double> Reflectors;
  std::vector<double> Tau;
  std::vector<double> Work;
  int WorkLength;
};

// The inverse of a symmetric matrix without its first rows and columns, positive definite; these are 0 in
// it.
std::vector<double> InvertFrom(int first, const std::vector<double>& matrix, int m)
{
  const auto size = static_cast<std::size_t>(m);
  const int rest = m - first;
  double trace = 0;
  for (int i = first; i < m; ++i)
  {
    trace += std::abs(matrix[i + size * i]);
  }
  std::vector<double> inverse;
  double shift = 0;
  int info = 0;
  do
  {
    // Nodes very close together: round-off needs a little smoothing.
    inverse = matrix;
    for (int i = first; i < m; ++i)
    {
      inverse[i + size * i] += shift;
    }
    shift = std::max(10 * shift, 1e-14 * trace / m + 1e-300);
    dpotrf_("L", &rest, inverse.data() + first * (size + 1), &m, &info, 1);
  } while (info != 0 && shift < trace);
  dpotri_("L", &rest, inverse.data() + first * (size + 1), &m, &info, 1);
  for (std::size_t j = 0; j < size; ++j)
  {
    for (std::size_t i = 0; i < size; ++i)
    {
      if (static_cast<int>(std::min(i, j)) < first)
      {
        inverse[i + size * j] = 0;
      }
      else if (i < j)
      {
        inverse[i + size * j] = inverse[j + size * i];
      }
    }
  }
  return inverse;
}
}

//------------------------------------------------------------------------------
template <int Dimension>
PolynomialProjection::PolynomialProjection(const RadialPolynomial<Dimension>& polynomial,
  const std::vector<typename RadialPolynomial<Dimension>::Point>& nodes)
{
  const auto count = static_cast<std::size_t>(polynomial.GetCount());
  this->Basis.assign(count, std::vector<double>(nodes.size()));
  double monomials[RadialPolynomial<Dimension>::MaximumCount];
  for (std::size_t i = 0; i < nodes.size(); ++i)
  {
    polynomial.Evaluate(nodes[i], monomials);
    for (std::size_t k = 0; k < count; ++k)
    {
      this->Basis[k][i] = monomials[k];
    }
  }
  this->Triangle.assign(count, std::vector<double>(count, 0.0));
  for (std::size_t j = 0; j < count; ++j)
  {
    std::vector<double>& vector = this->Basis[j];
    const double length = std::sqrt(Dot(vector, vector));
    // Gram-Schmidt, twice for orthogonality to the last bit
    for (int pass = 0; pass < 2; ++pass)
    {
      for (std::size_t k = 0; k < j; ++k)
      {
        const double part = Dot(vector, this->Basis[k]);
        this->Triangle[j][k] += part;
        for (std::size_t i = 0; i < vector.size(); ++i)
        {
          vector[i] -= part * this->Basis[k][i];
        }
      }
    }
    const double rest = std::sqrt(Dot(vector, vector));
    // Of a coarse set all nodes may lie on a line: then there is one polynomial less.
    const bool independent = rest > 1e-12 * length;
    this->Triangle[j][j] = independent ? rest : 0;
    for (double& value : vector)
    {
      value = independent ? value / rest : 0;
    }
  }
}

void PolynomialProjection::Remove(std::vector<double>& vector) const
{
  for (const std::vector<double>& basis : this->Basis)
  {
    const double part = Dot(vector, basis);
    for (std::size_t i = 0; i < vector.size(); ++i)
    {
      vector[i] -= part * basis[i];
    }
  }
}

std::vector<double> PolynomialProjection::GetCoefficients(const std::vector<double>& vector) const
{
  const std::size_t count = this->Basis.size();
  std::vector<double> coefficients(count, 0.0);
  for (std::size_t j = count; j-- > 0;)
  {
    double part = Dot(vector, this->Basis[j]);
    for (std::size_t k = j + 1; k < count; ++k)
    {
      part -= coefficients[k] * this->Triangle[k][j];
    }
    coefficients[j] = this->Triangle[j][j] > 0 ? part / this->Triangle[j][j] : 0;
  }
  return coefficients;
}

//------------------------------------------------------------------------------
template <int Dimension>
SchwarzPreconditioner<Dimension>::SchwarzPreconditioner(
  Execution& execution, const RadialSystem<Dimension>& system)
  : System(system)
{
  const Execution::NestedStages stages(execution);
  const SingleBlasThread single(execution.GetNumberOfThreads());
  this->Levels.emplace_back();
  this->Levels[0].Nodes = system.Nodes;
  this->Levels[0].Diagonal = system.Diagonal;
  while (true)
  {
    Level& level = this->Levels.back();
    level.Projection = std::make_unique<PolynomialProjection>(system.Polynomial, level.Nodes);
    const std::size_t n = level.Nodes.size();
    if (n <= Sizes<Dimension>::Coarsest)
    {
      break;
    }
    execution.SetStage(0.8 * (1 - static_cast<double>(n) / system.GetSize()),
      1 - 0.2 * static_cast<double>(n) / system.GetSize());
    const NodePartition<Dimension> partition(level.Nodes, Sizes<Dimension>::Own);
    level.Domains.resize(partition.GetNumberOfGroups());
    execution.For(static_cast<std::int64_t>(level.Domains.size()), 4,
      [&](std::int64_t begin, std::int64_t end)
      {
        for (std::int64_t d = begin; d < end; ++d)
        {
          Domain& domain = level.Domains[d];
          domain.Own = static_cast<std::uint32_t>(partition.GetGroup(d).size());
          domain.Nodes = partition.GetSurroundings(d, Sizes<Dimension>::Surroundings);
          this->Invert(level, domain);
        }
      });
    Level next;
    next.Indices =
      NodePartition<Dimension>(level.Nodes, Sizes<Dimension>::Ratio).GetRepresentatives();
    for (const std::uint32_t i : next.Indices)
    {
      next.Nodes.push_back(level.Nodes[i]);
      next.Diagonal.push_back(level.Diagonal[i]);
    }
    level.ToNext =
      std::make_unique<FastRadialSum<Dimension>>(system.Kernel, level.Nodes, next.Nodes);
    this->Levels.push_back(std::move(next));
  }

  const Level& last = this->Levels.back();
  const std::size_t n = last.Nodes.size();
  const auto monomials = static_cast<std::size_t>(system.Polynomial.GetCount());
  RadialSystem<Dimension> coarse;
  for (int c = 0; c < Dimension; ++c)
  {
    for (const Point& p : last.Nodes)
    {
      coarse.Axis[c].push_back(p[c]);
    }
  }
  const RadialLoops<Dimension> loops =
    GetRadialLoops<Dimension>(system.Kernel, BestInstructionSet());
  SquareMatrix matrix(n + monomials);
  for (std::size_t j = 0; j < n; ++j)
  {
    double* column = matrix.Column(j);
    loops.Column(coarse.GetCoordinates(j), n - j, last.Nodes[j].data(), column + j);
    column[j] += last.Diagonal[j];
    system.Polynomial.Evaluate(last.Nodes[j], column + n);
  }
  for (std::size_t j = n; j < n + monomials; ++j)
  {
    std::fill(matrix.Column(j) + j, matrix.Column(j) + n + monomials, 0.0);
  }
  this->Coarsest = std::make_unique<SymmetricFactorization>(std::move(matrix));
}

template <int Dimension>
double SchwarzPreconditioner<Dimension>::EstimateBytes(std::size_t n)
{
  return 1.2 * static_cast<double>(n) * Sizes<Dimension>::Surroundings * sizeof(float);
}

//------------------------------------------------------------------------------
template <int Dimension>
void SchwarzPreconditioner<Dimension>::Invert(const Level& level, Domain& domain) const
{
  const LocalSystem<Dimension> local(
    this->System, Pick(level.Nodes, domain.Nodes), Pick(level.Diagonal, domain.Nodes));
  const std::size_t size = local.GetSize();
  const int monomials = std::min(local.Polynomial.GetCount(), static_cast<int>(size));
  Orthogonal q(local.GetMonomials(), static_cast<int>(size), monomials);
  std::vector<double> matrix = local.GetMatrix();
  q.Multiply("L", "T", matrix);
  q.Multiply("R", "N", matrix);
  // On the complement of the polynomials, the last columns of Q, the matrix is positive definite.
  std::vector<double> inverse = InvertFrom(monomials, matrix, static_cast<int>(size));
  q.Multiply("L", "N", inverse);
  q.Multiply("R", "T", inverse);
  domain.Inverse.resize(size * domain.Own);
  for (std::size_t j = 0; j < domain.Own; ++j)
  {
    for (std::size_t i = 0; i < size; ++i)
    {
      domain.Inverse[i + size * j] = static_cast<float>(inverse[i + size * j] / local.Scale);
    }
  }
}

template <int Dimension>
std::vector<double> SchwarzPreconditioner<Dimension>::SolveDomains(
  Execution& execution, const Level& level, const std::vector<double>& residual) const
{
  std::vector<double> weights(residual.size());
  execution.For(static_cast<std::int64_t>(level.Domains.size()), 16,
    [&](std::int64_t begin, std::int64_t end)
    {
      std::vector<float> local;
      for (std::int64_t d = begin; d < end; ++d)
      {
        const Domain& domain = level.Domains[d];
        const std::size_t size = domain.Nodes.size();
        local.resize(size);
        for (std::size_t i = 0; i < size; ++i)
        {
          local[i] = static_cast<float>(residual[domain.Nodes[i]]);
        }
        for (std::size_t j = 0; j < domain.Own; ++j)
        {
          const float* row = domain.Inverse.data() + size * j;
          // Partial sums that the compiler can keep in one vector
          float sums[16] = {};
          std::size_t i = 0;
          for (; i + 16 <= size; i += 16)
          {
            for (int k = 0; k < 16; ++k)
            {
              sums[k] += row[i + k] * local[i + k];
            }
          }
          double sum = 0;
          for (const float s : sums)
          {
            sum += s;
          }
          for (; i < size; ++i)
          {
            sum += row[i] * local[i];
          }
          weights[domain.Nodes[j]] = sum;
        }
      }
    });
  level.Projection->Remove(weights);
  return weights;
}

template <int Dimension>
std::vector<double> SchwarzPreconditioner<Dimension>::Apply(
  Execution& execution, const std::vector<double>& residual)
{
  // Of the residual that is passed on: it need not be exact.
  constexpr double accuracy = 0.05;
  constexpr int MaximumOrder = Dimension == 2 ? 10 : 7;
  const SingleBlasThread single(execution.GetNumberOfThreads());
  std::vector<std::vector<double>> weights;
  std::vector<double> rest = residual;
  for (std::size_t l = 0; l + 1 < this->Levels.size(); ++l)
  {
    Level& level = this->Levels[l];
    const Level& next = this->Levels[l + 1];
    weights.push_back(this->SolveDomains(execution, level, rest));
    std::vector<double> sums(next.Nodes.size());
    const double size = GetRootMeanSquare(rest);
    if (size > 0)
    {
      level.ToNext->ApplyUpTo(
        MaximumOrder, execution, weights.back(), accuracy * size, sums.data());
    }
    std::vector<double> left(next.Nodes.size());
    for (std::size_t i = 0; i < left.size(); ++i)
    {
      const std::uint32_t k = next.Indices[i];
      left[i] = rest[k] - sums[i] - level.Diagonal[k] * weights.back()[k];
    }
    rest = std::move(left);
  }
  const std::size_t n = rest.size();
  rest.resize(n + this->System.Polynomial.GetCount(), 0.0);
  this->Coarsest->Solve(rest);
  rest.resize(n);
  for (std::size_t l = this->Levels.size() - 1; l > 0; --l)
  {
    for (std::size_t i = 0; i < rest.size(); ++i)
    {
      weights[l - 1][this->Levels[l].Indices[i]] += rest[i];
    }
    rest = std::move(weights[l - 1]);
  }
  this->Levels[0].Projection->Remove(rest);
  return rest;
}

template PolynomialProjection::PolynomialProjection(
  const RadialPolynomial<2>&, const std::vector<std::array<double, 2>>&);
template PolynomialProjection::PolynomialProjection(
  const RadialPolynomial<3>&, const std::vector<std::array<double, 3>>&);
template class SchwarzPreconditioner<2>;
template class SchwarzPreconditioner<3>;
}
