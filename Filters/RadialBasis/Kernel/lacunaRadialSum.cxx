// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRadialSum.h"

#include "lacunaRadialKernels.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace lacuna
{
namespace
{
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

bool IsRadialShaped(RadialKernel kernel)
{
  return Visit(kernel, [](auto k) { return decltype(k)::Shaped; });
}
}
