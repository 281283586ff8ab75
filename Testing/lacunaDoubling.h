// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Whether what a reader does grows as the bytes of its input, and not as their square.
#ifndef lacunaDoubling_h
#define lacunaDoubling_h

#include "lacunaSanitized.h"

#include <algorithm>
#include <ctime>
#include <functional>
#include <string>

namespace lacuna
{
/// How much longer three doublings take: 8 times as long by a work in proportion, 64 times by one of the
/// square. Of processor time, the least of several runs: other programs do not count. make(size) makes the
/// input, which is not measured, and returns the work. Under sanitizers sizes are an eighth.
inline double GetGrowthOfThreeDoublings(
  int size, const std::function<std::function<void()>(int)>& make)
{
  const auto measure = [&](int n)
  {
    const std::function<void()> work = make(n);
    double least = 1e9;
    for (int i = 0; i < 3; ++i)
    {
      const std::clock_t start = std::clock();
      work();
      least = std::min(least, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    }
    return least;
  };
  constexpr double Noise = 0.004; // s, of which nothing can be told
  size = Sanitized ? std::max(1, size / 8) : size;
  return measure(8 * size) / std::max(measure(size), Noise);
}

/// What such a growth must not reach.
constexpr double MostGrowth = 24;
}
#endif
