// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSplineFilter.h"

#include "lacunaMemory.h"
#include "lacunaWide.h"

#include <algorithm>
#include <array>
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

/// Solves Lanes lines of n values side by side, in place (Thomas's algorithm): lane l of value i is
/// values[i * stride + l]. work: n * Lanes.
LACUNA_WIDE void SolveLanes(
  float* values, std::int64_t stride, int n, const double* factors, double* __restrict work)
{
  for (std::int64_t l = 0; l < Lanes; ++l)
  {
    work[l] = values[l];
  }
  for (int i = 1; i + 1 < n; ++i)
  {
    // row 0 and row n - 1 are c = f: no factor eliminates row 0 from row 1
    const float* in = values + i * stride;
    double* out = work + i * Lanes;
    for (std::int64_t l = 0; l < Lanes; ++l)
    {
      out[l] = (6.0 * in[l] - out[l - Lanes]) * factors[i];
    }
  }
  for (int i = n - 2; i > 0; --i)
  {
    float* out = values + i * stride;
    const double* solved = work + i * Lanes;
    for (std::int64_t l = 0; l < Lanes; ++l)
    {
      out[l] = static_cast<float>(solved[l] - factors[i] * out[stride + l]);
    }
  }
}

/// The memory of a thread.
struct Workspace
{
  std::vector<double> Work;
  std::vector<float> Block;
};

/// Solves count lines of n values; value i of line l is values[i * stride + l * step].
void Solve(float* values, std::int64_t stride, std::int64_t step, int n, std::int64_t count,
  const std::vector<double>& factors, Workspace& space)
{
  space.Work.resize(n * Lanes);
  for (std::int64_t first = 0; first < count; first += Lanes)
  {
    float* corner = values + first * step;
    const std::int64_t lanes = std::min(Lanes, count - first);
    if (step == 1 && lanes == Lanes)
    {
      SolveLanes(corner, stride, n, factors.data(), space.Work.data());
      continue;
    }
    space.Block.resize(n * Lanes);
    for (std::int64_t l = 0; l < lanes; ++l)
    {
      for (int i = 0; i < n; ++i)
      {
        space.Block[i * Lanes + l] = corner[i * stride + l * step];
      }
    }
    SolveLanes(space.Block.data(), Lanes, n, factors.data(), space.Work.data());
    for (std::int64_t l = 0; l < lanes; ++l)
    {
      for (int i = 0; i < n; ++i)
      {
        corner[i * stride + l * step] = space.Block[i * Lanes + l];
      }
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
      using Limits = std::numeric_limits<T>;
      T low = Limits::has_infinity ? Limits::infinity() : Limits::max();
      T high = Limits::has_infinity ? -Limits::infinity() : Limits::lowest();
      std::int64_t bad = 0;
      for (std::int64_t i = begin; i < end; ++i)
      {
        const T v = voxels[i];
        const bool finite = !Limits::has_infinity || std::isfinite(static_cast<double>(v));
        bad += !finite;
        low = finite && v < low ? v : low;
        high = finite && v > high ? v : high;
      }
      const std::lock_guard<std::mutex> lock(mutex);
      result.Minimum = std::min(result.Minimum, static_cast<double>(low));
      result.Maximum = std::max(result.Maximum, static_cast<double>(high));
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
      RequireMemory("the coefficients of the spline", static_cast<double>(count) * sizeof(float));
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

  const std::array<int, 3>& size = volume.Size;
  const std::int64_t row = size[0];
  const std::int64_t slice = row * size[1];
  float* values = result.Values.data();
  const std::vector<double> factors[3] = { Factors(size[0]), Factors(size[1]), Factors(size[2]) };
  execution.For((slice + Lanes - 1) / Lanes, 16,
    [&](std::int64_t begin, std::int64_t end)
    {
      Workspace space;
      const std::int64_t first = begin * Lanes;
      Solve(
        values + first, slice, 1, size[2], std::min(end * Lanes, slice) - first, factors[2], space);
    });
  // the other two while the slice is in the cache
  execution.For(size[2], 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      Workspace space;
      for (std::int64_t k = begin; k < end; ++k)
      {
        Solve(values + k * slice, row, 1, size[1], row, factors[1], space);
        Solve(values + k * slice, 1, row, size[0], size[1], factors[0], space);
      }
    });
  return result;
}
}
