// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSplineFilter.h"

#include "lacunaFieldBounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <vector>

namespace lacuna
{
namespace
{
/// Lines of a filter pass that are solved side by side, for the vector units and the cache.
constexpr std::int64_t Lanes = 16;

/// The elimination's factors 1 / (4 - previous), which converge to 2 - sqrt(3).
std::vector<double> Factors(int n)
{
  std::vector<double> factors(n, 0.0);
  for (int i = 1; i + 1 < n; ++i)
  {
    factors[i] = 1 / (4 - factors[i - 1]);
  }
  return factors;
}

/// Solves count adjacent lines of n values, stride apart, in place (Thomas's algorithm).
void Solve(float* values, std::int64_t stride, int n, std::int64_t count,
  const std::vector<double>& factors, std::vector<double>& work)
{
  work.resize(n * Lanes);
  for (std::int64_t l = 0; l < count; ++l)
  {
    work[l] = values[l];
  }
  for (int i = 1; i + 1 < n; ++i)
  {
    // row 0 and row n - 1 are c = f: no factor eliminates row 0 from row 1
    for (std::int64_t l = 0; l < count; ++l)
    {
      work[i * Lanes + l] = (6.0 * values[i * stride + l] - work[(i - 1) * Lanes + l]) * factors[i];
    }
  }
  for (int i = n - 2; i > 0; --i)
  {
    for (std::int64_t l = 0; l < count; ++l)
    {
      const double next = values[(i + 1) * stride + l];
      values[i * stride + l] = static_cast<float>(work[i * Lanes + l] - factors[i] * next);
    }
  }
}

template <class T>
void FindRange(
  const T* voxels, std::int64_t count, SplineCoefficients& result, Execution& execution)
{
  std::mutex mutex;
  result.Minimum = std::numeric_limits<double>::infinity();
  result.Maximum = -std::numeric_limits<double>::infinity();
  result.NumberOfNonFinite = 0;
  execution.For(count, 1 << 18,
    [&](std::int64_t begin, std::int64_t end)
    {
      double low = std::numeric_limits<double>::infinity();
      double high = -std::numeric_limits<double>::infinity();
      std::int64_t bad = 0;
      for (std::int64_t i = begin; i < end; ++i)
      {
        const double v = static_cast<double>(voxels[i]);
        const bool finite = std::isfinite(v);
        bad += !finite;
        low = finite && v < low ? v : low;
        high = finite && v > high ? v : high;
      }
      const std::lock_guard<std::mutex> lock(mutex);
      result.Minimum = std::min(result.Minimum, low);
      result.Maximum = std::max(result.Maximum, high);
      result.NumberOfNonFinite += bad;
    });
}
}

SplineCoefficients FilterToCoefficients(
  const VoxelVolume& volume, bool emptyIsLow, Execution& execution)
{
  SplineCoefficients result;
  const std::int64_t count = volume.NumberOfVoxels();
  DispatchScalars(volume.Type, volume.Voxels,
    [&](const auto* voxels)
    {
      FindRange(voxels, count, result, execution);
      result.Values.resize(count);
      const double empty = emptyIsLow ? result.Minimum : result.Maximum;
      execution.For(count, 1 << 18,
        [&](std::int64_t begin, std::int64_t end)
        {
          for (std::int64_t i = begin; i < end; ++i)
          {
            const double v = static_cast<double>(voxels[i]);
            result.Values[i] = static_cast<float>(std::isfinite(v) ? v : empty);
          }
        });
    });

  const std::int64_t row = volume.Size[0];
  const std::int64_t slice = row * volume.Size[1];
  float* values = result.Values.data();
  // along y and z neighbouring lines are adjacent in memory
  const auto pass = [&](int n, std::int64_t stride, std::int64_t outer, std::int64_t outerStride,
                      std::int64_t lines)
  {
    const std::vector<double> factors = Factors(n);
    const std::int64_t groups = (lines + Lanes - 1) / Lanes;
    execution.For(outer * groups, 16,
      [&](std::int64_t begin, std::int64_t end)
      {
        std::vector<double> work;
        for (std::int64_t g = begin; g < end; ++g)
        {
          const std::int64_t first = g % groups * Lanes;
          Solve(values + g / groups * outerStride + first, stride, n,
            std::min(Lanes, lines - first), factors, work);
        }
      });
  };
  pass(volume.Size[2], slice, 1, 0, slice);
  pass(volume.Size[1], row, volume.Size[2], slice, row);
  pass(volume.Size[0], 1, static_cast<std::int64_t>(volume.Size[1]) * volume.Size[2], row, 1);
  return result;
}
}
