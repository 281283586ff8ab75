// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRadialSum.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>

namespace lacuna
{
namespace
{
// The radial functions, one small struct each, for use inside loops over packs of numbers.
//
// A kernel is a type with
//   Power       the degree k of homogeneity: phi(r/L) = phi(r)/L^k, up to terms that the side
//               conditions of a linear polynomial annul;
//   Energy      the factor C of the smoothness energy C sum_ij a_i a_j phi(|x_i - x_j|), in 2-D;
//   Degree      the degree of the polynomial part;
//   Length      0, or of a phi that has a length of its own, which is the unit of r then, what is taken when none is
//               given, in mean distances of neighbours; Power is 0;
//   Phi(r2)     phi as a function of the squared distance;
//   Slope(r2)   phi'(r)/r, so that the gradient of phi(|x|) is Slope(|x|^2) x; finite at r2 = 0.
// The sign of phi is such that the energy is positive. A pack is a vector type of the compiler
// (vector_size); all operations are IEEE additions, multiplications, divisions and square roots of
// each element, so results do not depend on how many elements a pack has.

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

// log x for positive normal x, within 2 units in the last place; finite (about -709) at x = 0.
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

// exp(-x) for x >= 0, within 2 units in the last place; not below exp(-700).
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

// r^2 log r; its energy in 2-D is the bending energy of a thin plate.
struct ThinPlateKernel
{
  static constexpr int Power = 2;
  static constexpr int Degree = 1;
  static constexpr double Length = 0;
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

// -r; a cone at each node, the 3-D biharmonic.
struct LinearKernel
{
  static constexpr int Power = 1;
  static constexpr int Degree = 1;
  static constexpr double Length = 0;
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

// r^3.
struct CubicKernel
{
  static constexpr int Power = 3;
  static constexpr int Degree = 1;
  static constexpr double Length = 0;
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

// -r^4 log r, the 2-D triharmonic: smooth to the third derivative.
struct TriharmonicKernel
{
  static constexpr int Power = 4;
  static constexpr int Degree = 2;
  static constexpr double Length = 0;
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

// exp(-r^2).
struct GaussianKernel
{
  static constexpr int Power = 0;
  static constexpr int Degree = 1;
  static constexpr double Length = 1.25;
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

// -sqrt(1 + r^2).
struct MultiquadricKernel
{
  static constexpr int Power = 0;
  static constexpr int Degree = 1;
  static constexpr double Length = 1.25;
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

// (1 - r)^4 (4 r + 1), 0 from r = 1 on: twice continuously differentiable, positive definite up to 3-D (Wendland 1995).
struct WendlandKernel
{
  static constexpr int Power = 0;
  static constexpr int Degree = 1;
  static constexpr double Length = 5;
  static constexpr double Energy = 1;

  template <int Width, class Real = typename Packs<Width>::Real>
  static LACUNA_PACK_INLINE Real Phi(const Real& r2)
  {
    const Real r = PackSqrt<Width>(r2);
    const Real rest = r < 1.0 ? 1.0 - r : Real{};
    return rest * rest * (rest * rest) * (4.0 * r + 1.0);
  }
  template <int Width, class Real = typename Packs<Width>::Real>
  static LACUNA_PACK_INLINE Real Slope(const Real& r2)
  {
    const Real r = PackSqrt<Width>(r2);
    const Real rest = r < 1.0 ? 1.0 - r : Real{};
    return -20.0 * (rest * rest * rest);
  }
};

//------------------------------------------------------------------------------
// The bodies below are inlined into wrappers that are compiled for one instruction set each.
template <int Width>
LACUNA_PACK_INLINE typename Packs<Width>::Real Load(const double* from)
{
  typename Packs<Width>::Real pack;
  std::memcpy(&pack, from, sizeof(pack));
  return pack;
}

template <class Kernel, int Dimension, int Width, bool WithGradient>
LACUNA_PACK_INLINE void SumBody(const Coordinates<Dimension>& nodes, const double* weights,
  std::size_t count, const Coordinates<Dimension>& points, double* values, double* gradients)
{
  using Real = typename Packs<Width>::Real;
  constexpr int packs = static_cast<int>(RadialBlock) / Width;
  Real x[Dimension][packs];
  Real sum[packs];
  Real gradient[Dimension][packs];
  for (int p = 0; p < packs; ++p)
  {
    sum[p] = Real{};
    for (int c = 0; c < Dimension; ++c)
    {
      x[c][p] = Load<Width>(points.Axis[c] + p * Width);
      gradient[c][p] = Real{};
    }
  }
  for (std::size_t i = 0; i < count; ++i)
  {
    for (int p = 0; p < packs; ++p)
    {
      Real d[Dimension];
      d[0] = x[0][p] - nodes.Axis[0][i];
      Real r2 = d[0] * d[0];
      for (int c = 1; c < Dimension; ++c)
      {
        d[c] = x[c][p] - nodes.Axis[c][i];
        r2 += d[c] * d[c];
      }
      sum[p] += weights[i] * Kernel::template Phi<Width>(r2);
      if (WithGradient)
      {
        const Real slope = weights[i] * Kernel::template Slope<Width>(r2);
        for (int c = 0; c < Dimension; ++c)
        {
          gradient[c][p] += slope * d[c];
        }
      }
    }
  }
  std::memcpy(values, sum, sizeof(sum));
  if (WithGradient)
  {
    std::memcpy(gradients, gradient, sizeof(gradient));
  }
}

template <class Kernel, int Dimension, int Width>
LACUNA_PACK_INLINE void ColumnBody(
  const Coordinates<Dimension>& nodes, std::size_t count, const double* center, double* values)
{
  using Real = typename Packs<Width>::Real;
  for (std::size_t i = 0; i < count; i += Width)
  {
    const std::size_t size = std::min<std::size_t>(Width, count - i) * sizeof(double);
    Real r2{};
    for (int c = 0; c < Dimension; ++c)
    {
      Real x{};
      std::memcpy(&x, nodes.Axis[c] + i, size);
      const Real d = x - center[c];
      r2 += d * d;
    }
    const Real phi = Kernel::template Phi<Width>(r2);
    std::memcpy(values + i, &phi, size);
  }
}

// The loops of one kernel in each instruction set.
template <class Kernel, int Dimension>
struct Compiled
{
  using Points = Coordinates<Dimension>;

// An attribute cannot be put in parentheses. NOLINTBEGIN(bugprone-macro-parentheses)
#define LACUNA_COMPILE_LOOPS(NAME, WIDTH, TARGET)                                                  \
  TARGET static void Sum##NAME(const Points& nodes, const double* weights, std::size_t count,      \
    const Points& points, double* values)                                                          \
  {                                                                                                \
    SumBody<Kernel, Dimension, WIDTH, false>(nodes, weights, count, points, values, nullptr);      \
  }                                                                                                \
  TARGET static void SumAndGradient##NAME(const Points& nodes, const double* weights,              \
    std::size_t count, const Points& points, double* values, double* gradients)                    \
  {                                                                                                \
    SumBody<Kernel, Dimension, WIDTH, true>(nodes, weights, count, points, values, gradients);     \
  }                                                                                                \
  TARGET static void Column##NAME(                                                                 \
    const Points& nodes, std::size_t count, const double* center, double* values)                  \
  {                                                                                                \
    ColumnBody<Kernel, Dimension, WIDTH>(nodes, count, center, values);                            \
  }

  LACUNA_COMPILE_LOOPS(Baseline, 2, )
#if defined(__x86_64__)
  LACUNA_COMPILE_LOOPS(AVX2, 4, __attribute__((target("avx2"))))
  LACUNA_COMPILE_LOOPS(AVX512, 8, __attribute__((target("avx512f,avx512dq"))))
#endif
#undef LACUNA_COMPILE_LOOPS
  // NOLINTEND(bugprone-macro-parentheses)

  static RadialLoops<Dimension> Get(InstructionSet set)
  {
#if defined(__x86_64__)
    if (set == InstructionSet::AVX512)
    {
      return { SumAVX512, SumAndGradientAVX512, ColumnAVX512 };
    }
    if (set == InstructionSet::AVX2)
    {
      return { SumAVX2, SumAndGradientAVX2, ColumnAVX2 };
    }
#endif
    return { SumBaseline, SumAndGradientBaseline, ColumnBaseline };
  }
};

// Calls visit with a value of the kernel's type.
template <class Visitor>
auto Visit(RadialKernel kernel, const Visitor& visit)
{
  switch (kernel)
  {
    case RadialKernel::ThinPlate:
      return visit(ThinPlateKernel());
    case RadialKernel::Linear:
      return visit(LinearKernel());
    case RadialKernel::Triharmonic:
      return visit(TriharmonicKernel());
    case RadialKernel::Cubic:
      return visit(CubicKernel());
    case RadialKernel::Gaussian:
      return visit(GaussianKernel());
    case RadialKernel::Multiquadric:
      return visit(MultiquadricKernel());
    case RadialKernel::Wendland:
      return visit(WendlandKernel());
  }
  throw std::invalid_argument("unknown radial kernel");
}
}

InstructionSet BestInstructionSet()
{
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq"))
  {
    return InstructionSet::AVX512;
  }
  if (__builtin_cpu_supports("avx2"))
  {
    return InstructionSet::AVX2;
  }
#endif
  return InstructionSet::Baseline;
}

template <int Dimension>
RadialLoops<Dimension> GetRadialLoops(RadialKernel kernel, InstructionSet set)
{
  return Visit(kernel, [&](auto k) { return Compiled<decltype(k), Dimension>::Get(set); });
}

template RadialLoops<2> GetRadialLoops<2>(RadialKernel, InstructionSet);
template RadialLoops<3> GetRadialLoops<3>(RadialKernel, InstructionSet);

int GetRadialPower(RadialKernel kernel)
{
  return Visit(kernel, [](auto k) { return decltype(k)::Power; });
}

double GetRadialEnergyFactor(RadialKernel kernel)
{
  return Visit(kernel, [](auto k) { return decltype(k)::Energy; });
}

int GetRadialDegree(RadialKernel kernel)
{
  return Visit(kernel, [](auto k) { return decltype(k)::Degree; });
}

double GetRadialLength(RadialKernel kernel)
{
  return Visit(kernel, [](auto k) { return decltype(k)::Length; });
}
}
