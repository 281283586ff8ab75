// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaBonePath.h"

#include <algorithm>
#include <cstddef>

namespace lacuna
{
namespace
{
// The best sums of lines that end in a sample of a beam, or before it.
struct Sums
{
  std::vector<double> At;
  double None = 0;
};

// Where the best line to each sample of the next beam comes from, and the sum it has there. -1: it begins.
struct Origins
{
  std::vector<double> Sum;
  std::vector<int> From;

  void Take(int sample, double sum, int from)
  {
    if (sum > this->Sum[sample])
    {
      this->Sum[sample] = sum;
      this->From[sample] = from;
    }
  }
};

void Connect(const Sums& sums, const PathCosts& costs, int best, Origins& origins)
{
  const int samples = static_cast<int>(sums.At.size());
  origins.Sum = sums.At;
  for (int i = 0; i < samples; ++i)
  {
    origins.From[i] = i;
  }
  for (int i = 1; i < samples; ++i) // from above
  {
    origins.Take(i, origins.Sum[i - 1] - costs.Step, origins.From[i - 1]);
  }
  for (int i = samples - 2; i >= 0; --i) // from below
  {
    origins.Take(i, origins.Sum[i + 1] - costs.Step, origins.From[i + 1]);
  }
  for (int i = 0; i < samples; ++i)
  {
    origins.Take(i, sums.At[best] - costs.Jump, best);
    origins.Take(i, sums.None - costs.End, -1);
  }
}

int FindBest(const Sums& sums)
{
  return static_cast<int>(std::max_element(sums.At.begin(), sums.At.end()) - sums.At.begin());
}
}

std::vector<int> FindBestPath(const std::vector<float>& gains, int samples, const PathCosts& costs)
{
  const int beams = samples > 0 ? static_cast<int>(gains.size()) / samples : 0;
  if (beams == 0)
  {
    return {};
  }
  std::vector<int> from(gains.size());  // of each sample: the one in the beam before
  std::vector<int> fromNone(beams, -1); // of beams without any
  Sums sums;
  sums.At.assign(gains.begin(), gains.begin() + samples);
  Origins origins{ sums.At, std::vector<int>(samples) };
  for (int beam = 1; beam < beams; ++beam)
  {
    const int best = FindBest(sums);
    Connect(sums, costs, best, origins);
    if (sums.At[best] - costs.End > sums.None)
    {
      sums.None = sums.At[best] - costs.End;
      fromNone[beam] = best;
    }
    const std::size_t first = static_cast<std::size_t>(beam) * static_cast<std::size_t>(samples);
    std::copy(
      origins.From.begin(), origins.From.end(), from.begin() + static_cast<std::ptrdiff_t>(first));
    for (int i = 0; i < samples; ++i)
    {
      sums.At[i] = origins.Sum[i] + gains[first + static_cast<std::size_t>(i)];
    }
  }
  std::vector<int> path(beams);
  const int best = FindBest(sums);
  int sample = sums.At[best] > sums.None ? best : -1;
  for (int beam = beams - 1; beam >= 0; --beam)
  {
    path[beam] = sample;
    sample = sample < 0 ? fromNone[beam]
                        : from[static_cast<std::size_t>(beam) * static_cast<std::size_t>(samples) +
                            static_cast<std::size_t>(sample)];
  }
  return path;
}
}
