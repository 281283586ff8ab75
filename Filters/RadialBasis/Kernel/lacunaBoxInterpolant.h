// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Points and nodes of a box, as the fast summation needs them.
#ifndef lacunaBoxInterpolant_h
#define lacunaBoxInterpolant_h

#include "lacunaChebyshevBasis.h"
#include "lacunaRadialSum.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lacuna
{
/// Points of which the Chebyshev polynomials are computed at once.
constexpr std::int64_t PointBatch = 128;

/// The nodes of a box's interpolant, padded to whole blocks by the last one.
template <int Dimension>
struct NodeLattice
{
  std::array<std::vector<double>, Dimension> Axis;

  void Set(const std::vector<double>& roots, double halfSize,
    const std::array<double, Dimension>& center, int size)
  {
    const std::size_t padded = (size + RadialBlock - 1) / RadialBlock * RadialBlock;
    const auto order = roots.size();
    std::size_t stride = 1;
    for (int c = 0; c < Dimension; ++c)
    {
      this->Axis[c].resize(padded);
      for (std::size_t k = 0; k < padded; ++k)
      {
        const std::size_t node = std::min<std::size_t>(k, size - 1);
        this->Axis[c][k] = center[c] + halfSize * roots[node / stride % order];
      }
      stride *= order;
    }
  }
  Coordinates<Dimension> Get(std::size_t first = 0) const
  {
    Coordinates<Dimension> coordinates;
    for (int c = 0; c < Dimension; ++c)
    {
      coordinates.Axis[c] = this->Axis[c].data() + first;
    }
    return coordinates;
  }
};

template <int Dimension>
std::array<const double*, Dimension> Repeat(const double* matrix)
{
  std::array<const double*, Dimension> all;
  all.fill(matrix);
  return all;
}

template <int Dimension>
std::array<int, Dimension> RepeatSize(int size)
{
  std::array<int, Dimension> all;
  all.fill(size);
  return all;
}

/// The Chebyshev polynomials at points of a box: of the first axis T[i + count j]; of the others
/// their products, Product[i + count (k1 + order k2)].
template <int Dimension>
struct PointBasis
{
  std::vector<double> First;
  std::vector<double> Product;
  std::vector<double> Position;
  std::vector<double> Other[2];

  void Set(int order, const Coordinates<Dimension>& points, std::size_t count,
    const std::array<double, Dimension>& center, double halfSize)
  {
    this->Position.resize(count);
    for (int c = 0; c < Dimension; ++c)
    {
      for (std::size_t i = 0; i < count; ++i)
      {
        this->Position[i] = (points.Axis[c][i] - center[c]) / halfSize;
      }
      std::vector<double>& values = c == 0 ? this->First : this->Other[c - 1];
      values.resize(count * order);
      ChebyshevBasis::Evaluate(order, this->Position.data(), count, values.data());
    }
    if (Dimension == 2)
    {
      this->Product = this->Other[0];
      return;
    }
    this->Product.resize(count * order * order);
    for (int l = 0; l < order; ++l)
    {
      for (int k = 0; k < order; ++k)
      {
        double* product = this->Product.data() + count * (k + order * l);
        const double* a = this->Other[0].data() + count * k;
        const double* b = this->Other[1].data() + count * l;
        for (std::size_t i = 0; i < count; ++i)
        {
          product[i] = a[i] * b[i];
        }
      }
    }
  }
};
}
#endif
