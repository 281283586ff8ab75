// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Direct sums of radial functions: the inner loops, with run-time choice of the vector width.
///
/// Each result is summed over the nodes in their order, by the same IEEE operations for each
/// instruction set: results are the same, bit for bit, on any x86-64 machine.
#ifndef lacunaRadialSum_h
#define lacunaRadialSum_h

#include "lacunaRadialKernel.h"

#include <cstddef>
#include <string>

namespace lacuna
{
/// What the user knows as the accuracy and the smoothing, for messages that say what would help.
struct RadialWords
{
  std::string Accuracy = "Accuracy";
  std::string Smoothing = "Smoothing";
};

enum class InstructionSet
{
  Baseline, ///< SSE2 on x86-64
  AVX2,
  AVX512
};

/// The widest instruction set that this machine and this build have.
InstructionSet BestInstructionSet();

/// Points are evaluated in blocks of so many.
constexpr std::size_t RadialBlock = 16;

/// Nodes or points as one array per coordinate.
template <int Dimension>
struct Coordinates
{
  const double* Axis[Dimension];
};

/// The loops for one kernel and one instruction set.
template <int Dimension>
struct RadialLoops
{
  /// values[p] = sum_i weights[i] phi(|points[p] - nodes[i]|) for RadialBlock points.
  void (*Sum)(const Coordinates<Dimension>& nodes, const double* weights, std::size_t count,
    const Coordinates<Dimension>& points, double* values);
  /// The same with gradients[c * RadialBlock + p] = the derivative along axis c.
  void (*SumAndGradient)(const Coordinates<Dimension>& nodes, const double* weights,
    std::size_t count, const Coordinates<Dimension>& points, double* values, double* gradients);
  /// values[i] = phi(|center - nodes[i]|) for 0 <= i < count.
  void (*Column)(
    const Coordinates<Dimension>& nodes, std::size_t count, const double* center, double* values);
};

/// Loops for an instruction set that the machine has. Dimension is 2 or 3.
template <int Dimension>
RadialLoops<Dimension> GetRadialLoops(RadialKernel kernel, InstructionSet set);

/// phi(|a - b|).
template <int Dimension>
double GetRadialValue(const RadialLoops<Dimension>& loops, const std::array<double, Dimension>& a,
  const std::array<double, Dimension>& b)
{
  Coordinates<Dimension> at;
  for (int c = 0; c < Dimension; ++c)
  {
    at.Axis[c] = &a[c];
  }
  double phi = 0;
  loops.Column(at, 1, b.data(), &phi);
  return phi;
}

/// k of phi(r/L) = phi(r)/L^k and the factor of the energy, see lacunaRadialSum.cxx.
int GetRadialPower(RadialKernel kernel);
double GetRadialEnergyFactor(RadialKernel kernel);
/// Degree of the polynomial part: 2 for the triharmonic, else 1.
int GetRadialDegree(RadialKernel kernel);
/// The length that is taken when none is given, in mean distances of neighbours; 0: the kernel has none.
double GetRadialLength(RadialKernel kernel);
inline bool IsRadialShaped(RadialKernel kernel)
{
  return GetRadialLength(kernel) > 0;
}
}
#endif
