// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Interpolation in a box by tensor products of Chebyshev polynomials.
#ifndef lacunaChebyshevBasis_h
#define lacunaChebyshevBasis_h

#include <array>
#include <cstddef>
#include <vector>

namespace lacuna
{
/// Polynomials of degree < Order on [-1, 1], by their values at the Order roots of T_Order.
/// Matrices are stored column after column. S_k is the polynomial that is 1 at root k and 0 at the
/// others.
class ChebyshevBasis
{
public:
  /// order >= 1.
  explicit ChebyshevBasis(int order);

  int GetOrder() const { return this->Order; }
  /// The roots, falling; root k is minus root Order - 1 - k.
  const std::vector<double>& GetRoots() const { return this->Roots; }
  /// S_k(x) = sum_j m[k + Order j] T_j(x).
  const double* GetCoefficients() const { return this->Coefficients.data(); }
  /// Its transpose, from values at the roots to coefficients of T_j.
  const double* GetCoefficientsTransposed() const { return this->Transposed.data(); }
  /// m[k + Order c] = S_k(root c of the lower (0) or upper (1) half of the interval).
  const double* GetHalf(int side) const { return this->Halves[side].data(); }
  const double* GetHalfTransposed(int side) const { return this->HalvesTransposed[side].data(); }

  /// T_0(x) ... T_{order-1}(x) of count numbers: values[i + count j].
  static void Evaluate(int order, const double* x, std::size_t count, double* values);

private:
  int Order;
  std::vector<double> Roots;
  std::vector<double> Coefficients;
  std::vector<double> Transposed;
  std::array<std::vector<double>, 2> Halves;
  std::array<std::vector<double>, 2> HalvesTransposed;
};

/// Applies one matrix along each axis of an array: out[i] = sum_j prod_c m_c[i_c + rows_c j_c] in[j],
/// the first index fastest; in has columns^Dimension elements. scratch must have room for the
/// largest array on the way.
template <int Dimension>
void TransformTensor(const std::array<const double*, Dimension>& matrices,
  const std::array<int, Dimension>& rows, int columns, const double* in, double* out,
  std::vector<double>& scratch);
}
#endif
