// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Dense symmetric indefinite systems by LAPACK.
#ifndef lacunaSymmetricFactorization_h
#define lacunaSymmetricFactorization_h

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace lacuna
{
/// Gives back doubles that are aligned for BLAS.
struct FreeAligned
{
  void operator()(double* numbers) const;
};

/// A square array of doubles, column after column, aligned so that BLAS always takes the same path.
class SquareMatrix
{
public:
  /// Elements are not initialised. Throws std::bad_alloc.
  explicit SquareMatrix(std::size_t size);
  std::size_t GetSize() const { return this->Size; }
  double* Column(std::size_t column) { return this->Elements.get() + column * this->Size; }
  const double* Column(std::size_t column) const
  {
    return this->Elements.get() + column * this->Size;
  }
  /// Bytes that a matrix of this size takes.
  static std::uint64_t GetBytes(std::size_t size) { return std::uint64_t(8) * size * size; }

private:
  std::size_t Size;
  std::unique_ptr<double[], FreeAligned> Elements;
};

/// P L D L^T P^T of a symmetric matrix by the diagonal pivoting method of Bunch and Kaufman
/// (dsytrf). Runs on one BLAS thread, so that the result does not depend on how many there are;
/// while it does, OpenBLAS's number of threads is 1 for the whole program and is then restored.
class SymmetricFactorization
{
public:
  /// Takes the matrix, of which only the lower triangle is read. Throws std::runtime_error when it
  /// is exactly singular, std::length_error when its size does not fit LAPACK's int.
  explicit SymmetricFactorization(SquareMatrix matrix);

  /// Solves for one right-hand side, in place.
  void Solve(std::vector<double>& rightHandSide) const;

  /// Estimate of the condition number in the 1-norm (dsycon); infinite for a numerically singular
  /// matrix.
  double GetConditionEstimate() const { return this->Condition; }

private:
  SquareMatrix Factors;
  std::vector<int> Pivots;
  double Condition = 0;
};
}
#endif
