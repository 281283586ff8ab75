// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaChebyshevBasis.h"

#include <cblas.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace lacuna
{
namespace
{
std::vector<double> Transpose(const std::vector<double>& matrix, int order)
{
  std::vector<double> transposed(matrix.size());
  for (int i = 0; i < order; ++i)
  {
    for (int j = 0; j < order; ++j)
    {
      transposed[j + order * i] = matrix[i + order * j];
    }
  }
  return transposed;
}
}

ChebyshevBasis::ChebyshevBasis(int order)
  : Order(order)
  , Roots(order)
  , Coefficients(static_cast<std::size_t>(order) * order)
{
  const double pi = std::acos(-1.0);
  for (int k = 0; k < order; ++k)
  {
    // so that they are symmetric to the last bit
    this->Roots[k] = std::sin(pi * (order - 1 - 2 * k) / (2.0 * order));
  }
  std::vector<double> values(this->Coefficients.size());
  Evaluate(order, this->Roots.data(), order, values.data());
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    this->Coefficients[i] = values[i] * (i < static_cast<std::size_t>(order) ? 1 : 2) / order;
  }
  this->Transposed = Transpose(this->Coefficients, order);
  for (int side = 0; side < 2; ++side)
  {
    std::vector<double> at(order);
    for (int c = 0; c < order; ++c)
    {
      at[c] = 0.5 * this->Roots[c] + (side - 0.5);
    }
    Evaluate(order, at.data(), order, values.data());
    std::vector<double>& half = this->Halves[side];
    half.assign(values.size(), 0.0);
    for (int c = 0; c < order; ++c)
    {
      for (int j = 0; j < order; ++j)
      {
        for (int k = 0; k < order; ++k)
        {
          half[k + order * c] += this->Coefficients[k + order * j] * values[c + order * j];
        }
      }
    }
    this->HalvesTransposed[side] = Transpose(half, order);
  }
}

void ChebyshevBasis::Evaluate(int order, const double* x, std::size_t count, double* values)
{
  std::fill_n(values, count, 1.0);
  if (order > 1)
  {
    std::copy_n(x, count, values + count);
  }
  for (int j = 2; j < order; ++j)
  {
    double* t = values + j * count;
    for (std::size_t i = 0; i < count; ++i)
    {
      t[i] = 2 * x[i] * t[i - count] - t[i - 2 * static_cast<std::ptrdiff_t>(count)];
    }
  }
}

template <int Dimension>
void TransformTensor(const std::array<const double*, Dimension>& matrices,
  const std::array<int, Dimension>& rows, int columns, const double* in, double* out,
  std::vector<double>& scratch)
{
  // Each step transforms the fastest axis and makes it the slowest.
  std::size_t largest = 1;
  for (int c = 0; c < Dimension; ++c)
  {
    largest *= std::max(rows[c], columns);
  }
  if (scratch.size() < 2 * largest)
  {
    scratch.resize(2 * largest);
  }
  int rest = 1;
  for (int c = 1; c < Dimension; ++c)
  {
    rest *= columns;
  }
  const double* from = in;
  for (int c = 0; c < Dimension; ++c)
  {
    double* to = c + 1 == Dimension ? out : scratch.data() + (c % 2) * largest;
    cblas_dgemm(CblasColMajor, CblasTrans, CblasTrans, rest, rows[c], columns, 1.0, from, columns,
      matrices[c], rows[c], 0.0, to, rest);
    rest = rest / columns * rows[c];
    from = to;
  }
}

template void TransformTensor<2>(const std::array<const double*, 2>&, const std::array<int, 2>&,
  int, const double*, double*, std::vector<double>&);
template void TransformTensor<3>(const std::array<const double*, 3>&, const std::array<int, 3>&,
  int, const double*, double*, std::vector<double>&);
}
