// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSymmetricFactorization.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

extern "C"
{
  void openblas_set_num_threads(int threads);
  int openblas_get_num_threads(void);
}

namespace
{
// Indefinite, with a zero block, like the equations of a radial basis function.
lacuna::SquareMatrix MakeMatrix(std::size_t n)
{
  lacuna::SquareMatrix matrix(n);
  for (std::size_t j = 0; j < n; ++j)
  {
    for (std::size_t i = 0; i < n; ++i)
    {
      const bool corner = i + 3 >= n && j + 3 >= n;
      const double d = std::abs(static_cast<double>(i) - static_cast<double>(j));
      matrix.Column(j)[i] = corner ? 0 : std::sqrt(d) + std::cos(static_cast<double>(i + j));
    }
  }
  return matrix;
}

std::vector<double> Solve(std::size_t n)
{
  std::vector<double> b(n);
  for (std::size_t i = 0; i < n; ++i)
  {
    b[i] = std::sin(static_cast<double>(i));
  }
  lacuna::SymmetricFactorization(MakeMatrix(n)).Solve(b);
  return b;
}
}

TEST(SymmetricFactorization, SolvesAnIndefiniteSystem)
{
  constexpr std::size_t n = 150;
  const std::vector<double> x = Solve(n);
  const lacuna::SquareMatrix matrix = MakeMatrix(n);
  for (std::size_t i = 0; i < n; ++i)
  {
    double sum = 0;
    for (std::size_t j = 0; j < n; ++j)
    {
      sum += matrix.Column(j)[i] * x[j];
    }
    EXPECT_NEAR(sum, std::sin(static_cast<double>(i)), 1e-10);
  }
}

TEST(SymmetricFactorization, IsTheSameForAnyNumberOfBlasThreads)
{
  const int before = openblas_get_num_threads();
  openblas_set_num_threads(1);
  const std::vector<double> one = Solve(700);
  openblas_set_num_threads(2);
  const std::vector<double> two = Solve(700);
  EXPECT_EQ(openblas_get_num_threads(), 2) << "the program's number of threads is restored";
  openblas_set_num_threads(before);
  EXPECT_EQ(one, two);
}

// Where vectors lie, and in what order BLAS sums them, depends on what else the program has taken.
TEST(SymmetricFactorization, IsTheSameWhereverMemoryIsFree)
{
  constexpr std::size_t n = 401; // of fewer, sums have one order
  std::vector<double> solution;
  double condition = 0;
  std::vector<std::unique_ptr<char[]>> taken;
  for (int i = 0; i < 40; ++i)
  {
    const lacuna::SymmetricFactorization factorization(MakeMatrix(n));
    std::vector<double> b(n, 0.1);
    factorization.Solve(b);
    if (solution.empty())
    {
      solution = b;
      condition = factorization.GetConditionEstimate();
    }
    EXPECT_EQ(b, solution);
    EXPECT_EQ(factorization.GetConditionEstimate(), condition);
    // what was given back, and would be had again
    for (const std::size_t size : { 2 * n * sizeof(double), n * sizeof(double), std::size_t{ 24 } })
    {
      taken.emplace_back(new char[size]);
    }
  }
}

TEST(SymmetricFactorization, EstimatesTheConditionNumber)
{
  // diagonal 1, 2, ..., 10 with one tiny element: condition known exactly
  constexpr std::size_t n = 10;
  lacuna::SquareMatrix matrix(n);
  for (std::size_t j = 0; j < n; ++j)
  {
    for (std::size_t i = 0; i < n; ++i)
    {
      matrix.Column(j)[i] = i == j ? static_cast<double>(i + 1) : 0.0;
    }
  }
  matrix.Column(4)[4] = -1e-5;
  EXPECT_NEAR(lacuna::SymmetricFactorization(std::move(matrix)).GetConditionEstimate(), 1e6, 1e-3);
}

TEST(SymmetricFactorization, RefusesASingularMatrix)
{
  lacuna::SquareMatrix matrix(3);
  for (std::size_t j = 0; j < 3; ++j)
  {
    for (std::size_t i = 0; i < 3; ++i)
    {
      matrix.Column(j)[i] = 1;
    }
  }
  EXPECT_THROW(lacuna::SymmetricFactorization(std::move(matrix)), std::runtime_error);
}

TEST(SymmetricFactorization, RefusesARightHandSideOfAnotherSize)
{
  const lacuna::SymmetricFactorization factorization(MakeMatrix(10));
  std::vector<double> b(9);
  EXPECT_THROW(factorization.Solve(b), std::invalid_argument);
}
