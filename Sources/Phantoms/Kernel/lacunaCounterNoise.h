// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Noise as a function of a counter, so that it depends neither on threads nor on pieces.
#ifndef lacunaCounterNoise_h
#define lacunaCounterNoise_h

#include <cstdint>

namespace lacuna
{
/// Independent standard normal numbers, each a function of (seed, stream, counter) alone. The
/// counter is hashed by the finaliser of SplitMix64 (Steele, Lea & Flood 2014), the uniform number
/// becomes a normal one through NormalQuantile. Numbers lie within +-8.3.
class CounterNoise
{
public:
  /// Streams of one seed are independent of each other.
  CounterNoise(std::uint64_t seed, std::uint64_t stream);

  /// Uniform in the open interval (0, 1), a multiple of 2^-53 plus half of that.
  double Uniform(std::uint64_t counter) const;
  /// Standard normal.
  double Normal(std::uint64_t counter) const;

private:
  std::uint64_t Key;
};

/// The inverse of the standard normal distribution function for 0 < p < 1, relative accuracy about
/// 1e-16 (Wichura 1988, algorithm AS 241, PPND16).
double NormalQuantile(double p);
}
#endif
