// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The radial functions, one small struct each, for use inside loops over packs of numbers.
///
/// A kernel is a type with
///   Power       the degree k of homogeneity: phi(r/L) = phi(r)/L^k, up to terms that the side
///               conditions of a linear polynomial annul;
///   Energy      the factor C of the smoothness energy C sum_ij a_i a_j phi(|x_i - x_j|), in 2-D;
///   Degree      the degree of the polynomial part;
///   Shaped      whether phi has a length of its own; then that is the unit of r, and Power is 0;
///   Phi(r2)     phi as a function of the squared distance;
///   Slope(r2)   phi'(r)/r, so that the gradient of phi(|x|) is Slope(|x|^2) x; finite at r2 = 0.
/// The sign of phi is such that the energy is positive. A pack is a vector type of the compiler
/// (vector_size); all operations are IEEE additions, multiplications, divisions and square roots of
/// each element, so results do not depend on how many elements a pack has.
#ifndef lacunaRadialKernels_h
#define lacunaRadialKernels_h

#include <cmath>
#include <cstdint>

namespace lacuna
{
template <int Width>
struct Packs;
template <>
struct Packs<2>
{
  using Real = double __attribute__((vector_size(16)));
  using Bits = std::uint64_t __attribute__((vector_size(16)));
};
template <>
struct Packs<4>
{
  using Real = double __attribute__((vector_size(32)));
  using Bits = std::uint64_t __attribute__((vector_size(32)));
};
template <>
struct Packs<8>
{
  using Real = double __attribute__((vector_size(64)));
  using Bits = std::uint64_t __attribute__((vector_size(64)));
};

// Forced inlining: a pack must not pass through a call compiled for another instruction set.
#define LACUNA_PACK_INLINE inline __attribute__((always_inline))

/// log x for positive normal x, within 2 units in the last place; finite (about -709) at x = 0.
template <int Width, class Real = typename Packs<Width>::Real>
LACUNA_PACK_INLINE Real PackLog(const Real& x)
{
  using Bits = typename Packs<Width>::Bits;
  // x = 2^k m with sqrt(1/2) <= m < sqrt(2)
  constexpr std::uint64_t one = 0x3ff0000000000000;
  constexpr std::uint64_t sqrtHalf = 0x3fe6a09e667f3bcd;
  constexpr std::uint64_t mantissa = 0x000fffffffffffff;
  constexpr std::uint64_t twoTo52 = 0x4330000000000000;
  // A cast between vector types keeps the bits.
  const Bits shifted = (Bits)x + (one - sqrtHalf);
  const Bits exponent = (shifted >> 52) | twoTo52; // as a number: 2^52 + biased k
  const Bits fraction = (shifted & mantissa) + sqrtHalf;
  const Real k = (Real)exponent - (4503599627370496.0 + 1023.0);
  const Real m = (Real)fraction;
  // log m = 2 atanh(s), s = (m - 1)/(m + 1), as a polynomial in z = s^2 that interpolates at
  // Chebyshev points of its range
  const Real s = (m - 1.0) / (m + 1.0);
  const Real z = s * s;
  Real p = 0.14616449820782476 * z + 0.15331721589574307;
  p = p * z + 0.181828891255921;
  p = p * z + 0.22222211134790545;
  p = p * z + 0.28571428625975515;
  p = p * z + 0.39999999999899505;
  p = p * z + 0.666666666666667;
  return k * 0.6931471805599453 + (s + s + s * (z * p));
}

/// exp(-x) for x >= 0, within 2 units in the last place; not below exp(-700).
template <int Width, class Real = typename Packs<Width>::Real>
LACUNA_PACK_INLINE Real PackExpMinus(const Real& x)
{
  using Bits = typename Packs<Width>::Bits;
  // -x = k log 2 + r, |r| <= log(2)/2; adding the magic number rounds k and leaves it in low bits
  constexpr double magic = 6755399441055744.0; // 1.5 x 2^52
  const Real y = x > 700.0 ? Real{} - 700.0 : -x;
  const Real shifted = y * 1.4426950408889634 + magic;
  const Real k = shifted - magic;
  const Real r = (y - k * 0.693147180369123816490) - k * 1.90821492927058770002e-10;
  Real p = r * (1.0 / 479001600.0) + 1.0 / 39916800.0;
  p = p * r + 1.0 / 3628800.0;
  p = p * r + 1.0 / 362880.0;
  p = p * r + 1.0 / 40320.0;
  p = p * r + 1.0 / 5040.0;
  p = p * r + 1.0 / 720.0;
  p = p * r + 1.0 / 120.0;
  p = p * r + 1.0 / 24.0;
  p = p * r + 1.0 / 6.0;
  p = p * r + 0.5;
  p = p * (r * r) + r + 1.0;
  const Bits power = ((Bits)shifted + std::uint64_t(1023)) << 52;
  return p * (Real)power;
}

template <int Width, class Real = typename Packs<Width>::Real>
LACUNA_PACK_INLINE Real PackSqrt(const Real& x)
{
  Real root;
  for (int i = 0; i < Width; ++i)
  {
    root[i] = std::sqrt(x[i]);
  }
  return root;
}

/// r^2 log r; its energy in 2-D is the bending energy of a thin plate.
struct ThinPlateKernel
{
  static constexpr int Power = 2;
  static constexpr int Degree = 1;
  static constexpr bool Shaped = false;
  static constexpr double Energy = 25.132741228718345; // 8 pi

  template <int Width, class Real = typename Packs<Width>::Real>
  static LACUNA_PACK_INLINE Real Phi(const Real& r2)
  {
    return (0.5 * r2) * PackLog<Width>(r2);
  }
  template <int Width, class Real = typename Packs<Width>::Real>
  static LACUNA_PACK_INLINE Real Slope(const Real& r2)
  {
    return PackLog<Width>(r2) + 1.0;
  }
};

/// -r; a cone at each node, the 3-D biharmonic.
struct LinearKernel
{
  static constexpr int Power = 1;
  static constexpr int Degree = 1;
  static constexpr bool Shaped = false;
  static constexpr double Energy = 1;

  template <int Width, class Real = typename Packs<Width>::Real>
  static LACUNA_PACK_INLINE Real Phi(const Real& r2)
  {
    return -PackSqrt<Width>(r2);
  }
  template <int Width, class Real = typename Packs<Width>::Real>
  static LACUNA_PACK_INLINE Real Slope(const Real& r2)
  {
    // The tip of the cone has no gradient: the bound makes it 0 there.
    return -1.0 / PackSqrt<Width>(r2 + 1e-290);
  }
};

/// r^3.
struct CubicKernel
{
  static constexpr int Power = 3;
  static constexpr int Degree = 1;
  static constexpr bool Shaped = false;
  static constexpr double Energy = 1;

  template <int Width, class Real = typename Packs<Width>::Real>
  static LACUNA_PACK_INLINE Real Phi(const Real& r2)
  {
    return r2 * PackSqrt<Width>(r2);
  }
  template <int Width, class Real = typename Packs<Width>::Real>
  static LACUNA_PACK_INLINE Real Slope(const Real& r2)
  {
    return 3.0 * PackSqrt<Width>(r2);
  }
};

/// -r^4 log r, the 2-D triharmonic: smooth to the third derivative.
struct TriharmonicKernel
{
  static constexpr int Power = 4;
  static constexpr int Degree = 2;
  static constexpr bool Shaped = false;
  static constexpr double Energy = 1;

  template <int Width, class Real = typename Packs<Width>::Real>
  static LACUNA_PACK_INLINE Real Phi(const Real& r2)
  {
    return (-0.5 * r2 * r2) * PackLog<Width>(r2);
  }
  template <int Width, class Real = typename Packs<Width>::Real>
  static LACUNA_PACK_INLINE Real Slope(const Real& r2)
  {
    return -r2 * (2.0 * PackLog<Width>(r2) + 1.0);
  }
};

/// exp(-r^2).
struct GaussianKernel
{
  static constexpr int Power = 0;
  static constexpr int Degree = 1;
  static constexpr bool Shaped = true;
  static constexpr double Energy = 1;

  template <int Width, class Real = typename Packs<Width>::Real>
  static LACUNA_PACK_INLINE Real Phi(const Real& r2)
  {
    return PackExpMinus<Width>(r2);
  }
  template <int Width, class Real = typename Packs<Width>::Real>
  static LACUNA_PACK_INLINE Real Slope(const Real& r2)
  {
    return -2.0 * PackExpMinus<Width>(r2);
  }
};

/// -sqrt(1 + r^2).
struct MultiquadricKernel
{
  static constexpr int Power = 0;
  static constexpr int Degree = 1;
  static constexpr bool Shaped = true;
  static constexpr double Energy = 1;

  template <int Width, class Real = typename Packs<Width>::Real>
  static LACUNA_PACK_INLINE Real Phi(const Real& r2)
  {
    return -PackSqrt<Width>(r2 + 1.0);
  }
  template <int Width, class Real = typename Packs<Width>::Real>
  static LACUNA_PACK_INLINE Real Slope(const Real& r2)
  {
    return -1.0 / PackSqrt<Width>(r2 + 1.0);
  }
};
}
#endif
