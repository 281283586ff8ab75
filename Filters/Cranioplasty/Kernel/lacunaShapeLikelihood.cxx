// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaShapeLikelihood.h"

#include "lacunaSingleBlasThread.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>
#include <utility>

// Fortran interfaces; the last arguments are the lengths of the character arguments.
extern "C"
{
  void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info, std::size_t);
  void dpotri_(const char* uplo, const int* n, double* a, const int* lda, int* info, std::size_t);
  void dtrtrs_(const char* uplo, const char* trans, const char* diag, const int* n,
    const int* columns, const double* a, const int* lda, double* b, const int* ldb, int* info,
    std::size_t, std::size_t, std::size_t);
}

namespace lacuna
{
namespace
{
constexpr std::size_t Lengths = ShapeLengths.size();
// Of a variance in one iteration: what vanishes needs not vanish at once.
constexpr double LeastFactor = 0.03;
constexpr double LeastIndependence = 1e-10; // of a mean term from those before it
constexpr double LeastNoise = 1e-4;         // mm^2: keeps the covariance positive definite

int SizeOf(const SquareMatrix& matrix)
{
  return static_cast<int>(matrix.GetSize());
}

// A variance and the matrix that it multiplies; 0 is the identity.
double& Component(ShapeVariances& v, std::size_t i)
{
  return i < Lengths ? v.Common[i] : i < 2 * Lengths ? v.Own[i - Lengths] : v.Noise;
}
}

bool FactorCholesky(SquareMatrix& matrix)
{
  const SingleBlasThread single;
  const int n = SizeOf(matrix);
  int info = 0;
  dpotrf_("L", &n, matrix.Column(0), &n, &info, 1);
  return info == 0;
}

void InvertCholesky(SquareMatrix& factors)
{
  const SingleBlasThread single;
  const int n = SizeOf(factors);
  int info = 0;
  dpotri_("L", &n, factors.Column(0), &n, &info, 1);
}

void SolveCholeskyLower(const SquareMatrix& factors, double* columns, int count)
{
  const SingleBlasThread single;
  const int n = SizeOf(factors);
  int info = 0;
  dtrtrs_("L", "N", "N", &n, &count, factors.Column(0), &n, columns, &n, &info, 1, 1, 1);
}

void SolveCholeskyUpper(const SquareMatrix& factors, double* column)
{
  const SingleBlasThread single;
  const int n = SizeOf(factors);
  const int count = 1;
  int info = 0;
  dtrtrs_("L", "T", "N", &n, &count, factors.Column(0), &n, column, &n, &info, 1, 1, 1);
}

//------------------------------------------------------------------------------
ShapeLikelihood::ShapeLikelihood(std::vector<Vec3> places, std::vector<double> values,
  std::vector<double> terms, std::vector<double> roughness)
  : Places(std::move(places))
  , Values(std::move(values))
  , Terms(std::move(terms))
  , Roughness(std::move(roughness))
{
  const std::size_t n = this->Places.size();
  for (std::size_t l = 0; l < Lengths; ++l)
  {
    this->Direct.emplace_back(n);
    this->Across.emplace_back(n);
    for (std::size_t j = 0; j < n; ++j)
    {
      for (std::size_t i = j; i < n; ++i)
      {
        this->Direct[l].Column(j)[i] = this->GetFactor(l, i, j) *
          MaternCorrelation(Norm(this->Places[i] - this->Places[j]), ShapeLengths[l]);
      }
    }
  }
}

void ShapeLikelihood::SetPlane(const MirrorPlane& plane, Execution& execution)
{
  const std::size_t n = this->Places.size();
  std::vector<ShapePlace> places;
  for (const Vec3& place : this->Places)
  {
    places.emplace_back(place, plane, 1);
  }
  execution.For(static_cast<std::int64_t>(n), 16,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t j = begin; j < end; ++j)
      {
        for (std::size_t i = j; i < n; ++i)
        {
          const double distance = Norm(places[i].Point - places[j].Mirrored);
          for (std::size_t l = 0; l < Lengths; ++l)
          {
            this->Across[l].Column(j)[i] = places[i].Share[l] * places[j].Share[l] *
              (this->Direct[l].Column(j)[i] +
                this->GetFactor(l, i, j) * MaternCorrelation(distance, ShapeLengths[l]));
          }
        }
      }
    });
}

bool ShapeLikelihood::Factor(
  const ShapeVariances& v, SquareMatrix& matrix, SquareMatrix& small) const
{
  const std::size_t n = matrix.GetSize();
  for (std::size_t j = 0; j < n; ++j)
  {
    double* column = matrix.Column(j);
    std::fill(column + j, column + n, 0.0);
    for (std::size_t l = 0; l < Lengths; ++l)
    {
      const double* direct = this->Direct[l].Column(j);
      const double* across = this->Across[l].Column(j);
      for (std::size_t i = j; i < n; ++i)
      {
        column[i] += v.Own[l] * direct[i] + v.Common[l] * across[i];
      }
    }
    column[j] += this->Roughness[j] * this->Roughness[j] * std::max(v.Noise, LeastNoise);
  }
  if (!FactorCholesky(matrix))
  {
    return false;
  }
  const std::size_t q = this->GetNumberOfTerms();
  const std::unique_ptr<double[], FreeAligned> right(
    new (std::align_val_t{ 64 }) double[n * (q + 1)]);
  for (std::size_t i = 0; i < n; ++i)
  {
    for (std::size_t k = 0; k < q; ++k)
    {
      right[k * n + i] = this->Terms[i * q + k];
    }
    right[q * n + i] = this->Values[i];
  }
  SolveCholeskyLower(matrix, right.get(), static_cast<int>(q + 1));
  for (std::size_t k = 0; k <= q; ++k)
  {
    for (std::size_t m = k; m <= q; ++m)
    {
      double sum = 0;
      for (std::size_t i = 0; i < n; ++i)
      {
        sum += right[k * n + i] * right[m * n + i];
      }
      small.Column(k)[m] = sum;
    }
  }
  std::vector<double> before;
  for (std::size_t k = 0; k < q; ++k)
  {
    before.push_back(small.Column(k)[k]);
  }
  bool independent = FactorCholesky(small);
  for (std::size_t k = 0; k < q; ++k)
  {
    const double left = small.Column(k)[k];
    independent = independent && left * left > LeastIndependence * before[k];
  }
  return independent;
}

double ShapeLikelihood::Evaluate(const ShapeVariances& variances) const
{
  const std::size_t q = this->GetNumberOfTerms();
  SquareMatrix matrix(this->Places.size());
  SquareMatrix small(q + 1);
  if (!this->Factor(variances, matrix, small))
  {
    return std::numeric_limits<double>::infinity();
  }
  // the last diagonal element squared is y^T P y
  double sum = 0.5 * small.Column(q)[q] * small.Column(q)[q];
  for (std::size_t i = 0; i < matrix.GetSize(); ++i)
  {
    sum += std::log(matrix.Column(i)[i]);
  }
  for (std::size_t k = 0; k < q; ++k)
  {
    sum += std::log(small.Column(k)[k]);
  }
  return sum;
}

std::pair<double, double> ShapeLikelihood::GetLastFactor(const ShapeVariances& variances) const
{
  const std::size_t q = this->GetNumberOfTerms();
  SquareMatrix matrix(this->Places.size());
  SquareMatrix small(q + 1);
  if (!this->Factor(variances, matrix, small))
  {
    return { 0, std::numeric_limits<double>::infinity() };
  }
  const double* last = small.Column(q - 1);
  return { last[q] / last[q - 1], 1 / last[q - 1] };
}

void ShapeLikelihood::Project(
  const ShapeVariances& variances, SquareMatrix& matrix, std::vector<double>& py) const
{
  const std::size_t n = this->Places.size();
  const std::size_t q = this->GetNumberOfTerms();
  SquareMatrix small(q + 1);
  if (!this->Factor(variances, matrix, small))
  {
    throw std::runtime_error("the sound bone does not determine the shape of the skull: its points "
                             "coincide or are too few");
  }
  InvertCholesky(matrix);
  // columns of K^-1 H C^-T, with H^T K^-1 H = C C^T
  std::vector<double> side(n * q, 0.0);
  for (std::size_t j = 0; j < n; ++j)
  {
    const double* column = matrix.Column(j);
    for (std::size_t k = 0; k < q; ++k)
    {
      const double here = this->Terms[j * q + k];
      double sum = column[j] * here;
      for (std::size_t i = j + 1; i < n; ++i)
      {
        side[i * q + k] += column[i] * here;
        sum += column[i] * this->Terms[i * q + k];
      }
      side[j * q + k] += sum;
    }
  }
  for (std::size_t i = 0; i < n; ++i)
  {
    for (std::size_t k = 0; k < q; ++k)
    {
      double sum = side[i * q + k];
      for (std::size_t m = 0; m < k; ++m)
      {
        sum -= small.Column(m)[k] * side[i * q + m];
      }
      side[i * q + k] = sum / small.Column(k)[k];
    }
  }
  py.assign(n, 0.0);
  for (std::size_t j = 0; j < n; ++j)
  {
    double* column = matrix.Column(j);
    double sum = 0;
    for (std::size_t i = j; i < n; ++i)
    {
      double change = 0;
      for (std::size_t k = 0; k < q; ++k)
      {
        change += side[i * q + k] * side[j * q + k];
      }
      column[i] -= change;
      py[i] += i > j ? column[i] * this->Values[j] : 0;
      sum += column[i] * this->Values[i];
    }
    py[j] += sum;
  }
}

ShapeVariances ShapeLikelihood::Estimate(const ShapeVariances& start, int iterations) const
{
  const std::size_t n = this->Places.size();
  ShapeVariances v = start;
  SquareMatrix p(n);
  std::vector<double> py;
  for (int iteration = 0; iteration < iterations; ++iteration)
  {
    this->Project(v, p, py);
    for (std::size_t c = 0; c <= 2 * Lengths; ++c)
    {
      // y^T P K_c P y over the trace of P K_c
      double explained = 0;
      double expected = 0;
      for (std::size_t j = 0; j < n; ++j)
      {
        const double* column = p.Column(j);
        if (c == 2 * Lengths)
        {
          const double square = this->Roughness[j] * this->Roughness[j];
          explained += square * py[j] * py[j];
          expected += square * column[j];
          continue;
        }
        const double* k = (c < Lengths ? this->Across[c] : this->Direct[c - Lengths]).Column(j);
        double row = 0;
        double trace = 0;
        for (std::size_t i = j + 1; i < n; ++i)
        {
          row += k[i] * py[i];
          trace += k[i] * column[i];
        }
        explained += py[j] * (2 * row + k[j] * py[j]);
        expected += 2 * trace + k[j] * column[j];
      }
      const double ratio = expected > 0 ? std::max(explained, 0.0) / expected : 1;
      Component(v, c) *= std::max(ratio, LeastFactor);
    }
    v.Noise = std::max(v.Noise, LeastNoise);
  }
  return v;
}

std::vector<std::vector<double>> ShapeLikelihood::LeaveOut(
  const ShapeVariances& variances, const std::vector<std::vector<int>>& holes) const
{
  SquareMatrix p(this->Places.size());
  std::vector<double> py;
  this->Project(variances, p, py);
  std::vector<std::vector<double>> ratios(holes.size());
  for (std::size_t h = 0; h < holes.size(); ++h)
  {
    const std::vector<int>& hole = holes[h];
    // errors P_hh^-1 (P y)_h with the covariance P_hh^-1
    const std::size_t size = hole.size();
    SquareMatrix block(size);
    for (std::size_t j = 0; j < size; ++j)
    {
      for (std::size_t i = j; i < size; ++i)
      {
        block.Column(j)[i] = p.Column(std::min(hole[i], hole[j]))[std::max(hole[i], hole[j])];
      }
    }
    if (!FactorCholesky(block))
    {
      continue;
    }
    InvertCholesky(block);
    for (std::size_t j = 0; j < size; ++j)
    {
      double error = 0;
      for (std::size_t i = 0; i < size; ++i)
      {
        error += block.Column(std::min(i, j))[std::max(i, j)] * py[hole[i]];
      }
      ratios[h].push_back(std::abs(error) / std::sqrt(block.Column(j)[j]));
    }
  }
  return ratios;
}
}
