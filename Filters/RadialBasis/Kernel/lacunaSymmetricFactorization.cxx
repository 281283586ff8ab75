// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSymmetricFactorization.h"

#include "lacunaSingleBlasThread.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>
#include <utility>

// Fortran interfaces; the last arguments are the lengths of the character arguments.
extern "C"
{
  void dsytrf_(const char* uplo, const int* n, double* a, const int* lda, int* pivots, double* work,
    const int* workLength, int* info, std::size_t);
  void dsytrs_(const char* uplo, const int* n, const int* columns, const double* a, const int* lda,
    const int* pivots, double* b, const int* ldb, int* info, std::size_t);
  void dsycon_(const char* uplo, const int* n, const double* a, const int* lda, const int* pivots,
    const double* norm, double* reciprocal, double* work, int* intWork, int* info, std::size_t);
  double dlansy_(const char* norm, const char* uplo, const int* n, const double* a, const int* lda,
    double* work, std::size_t, std::size_t);
}

namespace lacuna
{
namespace
{
constexpr std::align_val_t Alignment{ 64 };

// Aligned as matrices are: where BLAS's vectors begin decides in what order it sums.
using Workspace = std::unique_ptr<double[], FreeAligned>;

Workspace MakeWorkspace(std::size_t length)
{
  return Workspace(new (Alignment) double[length]());
}
}

SquareMatrix::SquareMatrix(std::size_t size)
  : Size(size)
  , Elements(new (Alignment) double[size * size])
{
}

void FreeAligned::operator()(double* numbers) const
{
  ::operator delete[](numbers, Alignment);
}

SymmetricFactorization::SymmetricFactorization(SquareMatrix matrix)
  : Factors(std::move(matrix))
  , Pivots(Factors.GetSize())
{
  if (this->Factors.GetSize() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
  {
    throw std::length_error("matrix is too large for LAPACK");
  }
  const SingleBlasThread single;
  const int n = static_cast<int>(this->Factors.GetSize());
  double* a = this->Factors.Column(0);
  const Workspace work = MakeWorkspace(2 * this->Factors.GetSize());
  const double norm = dlansy_("1", "L", &n, a, &n, work.get(), 1, 1);

  int info = 0;
  const int query = -1;
  double workLength = 0;
  dsytrf_("L", &n, a, &n, this->Pivots.data(), &workLength, &query, &info, 1);
  const int length = static_cast<int>(workLength);
  const Workspace factorWork = MakeWorkspace(static_cast<std::size_t>(length));
  dsytrf_("L", &n, a, &n, this->Pivots.data(), factorWork.get(), &length, &info, 1);
  if (info > 0)
  {
    throw std::runtime_error("matrix is singular");
  }

  double reciprocal = 0;
  std::vector<int> intWork(this->Factors.GetSize());
  dsycon_(
    "L", &n, a, &n, this->Pivots.data(), &norm, &reciprocal, work.get(), intWork.data(), &info, 1);
  this->Condition = reciprocal > 0 ? 1 / reciprocal : std::numeric_limits<double>::infinity();
}

void SymmetricFactorization::Solve(std::vector<double>& rightHandSide) const
{
  if (rightHandSide.size() != this->Factors.GetSize())
  {
    throw std::invalid_argument("right-hand side and matrix differ in size");
  }
  const SingleBlasThread single;
  const int n = static_cast<int>(this->Factors.GetSize());
  const int columns = 1;
  int info = 0;
  const Workspace solution = MakeWorkspace(rightHandSide.size());
  std::copy(rightHandSide.begin(), rightHandSide.end(), solution.get());
  dsytrs_("L", &n, &columns, this->Factors.Column(0), &n, this->Pivots.data(), solution.get(), &n,
    &info, 1);
  std::copy_n(solution.get(), rightHandSide.size(), rightHandSide.begin());
}
}
