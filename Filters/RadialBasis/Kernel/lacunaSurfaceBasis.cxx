// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSurfaceBasis.h"

#include "lacunaExecution.h"
#include "lacunaSurfaceSpline.h"

#include <cblas.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <new>
#include <utility>

// Fortran interfaces; the last arguments are the lengths of the character arguments.
extern "C"
{
  void dgeqrf_(const int* rows, const int* columns, double* a, const int* lda, double* tau,
    double* work, const int* workLength, int* info);
  void dormqr_(const char* side, const char* transposed, const int* rows, const int* columns,
    const int* reflectors, const double* a, const int* lda, const double* tau, double* c,
    const int* ldc, double* work, const int* workLength, int* info, std::size_t, std::size_t);
  void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info, std::size_t);
}

namespace lacuna
{
//------------------------------------------------------------------------------
SurfaceBasis::Matrix::Matrix(std::size_t rows, std::size_t columns)
  : Rows(rows)
  , Columns(columns)
  , Elements(new (std::align_val_t(64)) double[rows * columns]())
{
}

//------------------------------------------------------------------------------
SurfaceBasis::SurfaceBasis(Execution& execution, std::vector<Vec3> centers, RadialKernel kernel)
  : Centers(std::move(centers))
  , Kernel(kernel)
{
  const std::size_t size = this->Centers.size();
  const int n = static_cast<int>(size);
  this->Reflectors = Matrix(size, Terms);
  for (std::size_t i = 0; i < size; ++i)
  {
    this->Reflectors.Column(0)[i] = 1;
    for (int c = 0; c < 3; ++c)
    {
      this->Reflectors.Column(c + 1)[i] = this->Centers[i][c];
    }
  }
  this->ReflectorScales.assign(Terms, 0.0);
  int info = 0;
  const int terms = Terms;
  std::vector<double> work(64 * size);
  const int length = static_cast<int>(work.size());
  dgeqrf_(&n, &terms, this->Reflectors.Column(0), &n, this->ReflectorScales.data(), work.data(),
    &length, &info);
  for (int c = 0; c < Terms; ++c)
  {
    if (std::abs(this->Reflectors.Column(c)[c]) < 1e-9)
    {
      throw SurfaceSpline::Unsolvable("all points lie on one line or in one place");
    }
  }
  Matrix energy(size, size);
  execution.For(static_cast<std::int64_t>(size), 16,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t j = begin; j < end; ++j)
      {
        this->FillColumn(this->Centers, this->Centers[j], energy.Column(j), nullptr);
      }
    });
  this->Reflect('L', 'T', energy);
  this->Reflect('R', 'N', energy);
  const std::size_t rest = size - Terms;
  this->Root = Matrix(rest, rest);
  double trace = 0;
  for (std::size_t j = 0; j < rest; ++j)
  {
    std::copy_n(energy.Column(j + Terms) + Terms, rest, this->Root.Column(j));
    trace += this->Root.Column(j)[j];
  }
  for (std::size_t j = 0; j < rest; ++j)
  {
    this->Root.Column(j)[j] += 1e-13 * trace / static_cast<double>(rest);
  }
  const int m = static_cast<int>(rest);
  dpotrf_("L", &m, this->Root.Column(0), &m, &info, 1);
  if (info != 0)
  {
    throw SurfaceSpline::Unsolvable(
      "nodes lie too close together for the equations to be solved; thin the points out");
  }
}

//------------------------------------------------------------------------------
// values[i] = phi(|points[i] - center|), gradients[c * count + i] its derivatives by points.
void SurfaceBasis::FillColumn(
  const std::vector<Vec3>& points, const Vec3& center, double* values, double* gradients) const
{
  const bool cubic = this->Kernel == RadialKernel::Cubic;
  const std::size_t count = points.size();
  for (std::size_t i = 0; i < count; ++i)
  {
    const Vec3 d = points[i] - center;
    const double r = Norm(d);
    values[i] = cubic ? r * r * r : -r;
    if (gradients)
    {
      const double slope = cubic ? 3 * r : (r > 0 ? -1 / r : 0);
      for (int c = 0; c < 3; ++c)
      {
        gradients[c * count + i] = slope * d[c];
      }
    }
  }
}

void SurfaceBasis::Reflect(char side, char transposed, Matrix& matrix) const
{
  const int rows = static_cast<int>(matrix.GetRows());
  const int columns = static_cast<int>(matrix.GetColumns());
  const int terms = Terms;
  const int size = static_cast<int>(this->Reflectors.GetRows());
  std::vector<double> work(64 * static_cast<std::size_t>(std::max(rows, columns)));
  const int length = static_cast<int>(work.size());
  // A copy, because LAPACK puts 1 into the diagonal meanwhile: threads would disturb each other.
  const double* first = this->Reflectors.Column(0);
  const std::vector<double> reflectors(first, first + this->Reflectors.GetRows() * Terms);
  int info = 0;
  dormqr_(&side, &transposed, &rows, &columns, &terms, reflectors.data(), &size,
    this->ReflectorScales.data(), matrix.Column(0), &rows, work.data(), &length, &info, 1, 1);
}

//------------------------------------------------------------------------------
SurfaceBasis::Matrix SurfaceBasis::MakeRows(const std::vector<Vec3>& points, bool gradients) const
{
  const std::size_t count = points.size();
  Matrix rows(count * (gradients ? 4 : 1), this->Centers.size());
  if (count == 0)
  {
    return rows;
  }
  for (std::size_t j = 0; j < this->Centers.size(); ++j)
  {
    double* column = rows.Column(j);
    this->FillColumn(points, this->Centers[j], column, gradients ? column + count : nullptr);
  }
  this->Reflect('R', 'N', rows);
  const int height = static_cast<int>(rows.GetRows());
  const int rest = static_cast<int>(this->Root.GetRows());
  cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, height, rest, 1.0,
    this->Root.Column(0), rest, rows.Column(Terms), height);
  for (int term = 0; term < Terms; ++term)
  {
    double* column = rows.Column(term);
    std::fill_n(column, rows.GetRows(), 0.0);
    for (std::size_t i = 0; i < count; ++i)
    {
      column[i] = term == 0 ? 1 : points[i][term - 1];
      if (gradients && term > 0)
      {
        column[static_cast<std::size_t>(term) * count + i] = 1;
      }
    }
  }
  return rows;
}

//------------------------------------------------------------------------------
std::vector<double> SurfaceBasis::GetCoefficients(const std::vector<double>& solution) const
{
  Matrix coefficients(this->Centers.size(), 1);
  std::copy(solution.begin() + Terms, solution.end(), coefficients.Column(0) + Terms);
  const int rest = static_cast<int>(this->Root.GetRows());
  cblas_dtrsv(CblasColMajor, CblasLower, CblasTrans, CblasNonUnit, rest, this->Root.Column(0), rest,
    coefficients.Column(0) + Terms, 1);
  this->Reflect('L', 'N', coefficients);
  return { coefficients.Column(0), coefficients.Column(0) + this->Centers.size() };
}
}
