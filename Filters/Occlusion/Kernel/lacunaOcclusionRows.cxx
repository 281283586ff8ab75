// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaOcclusionRows.h"

#include <cstring>

#if defined(__x86_64__) && defined(__GNUC__)
#define LACUNA_WIDE_VECTORS 1
#endif

#define LACUNA_INLINE inline __attribute__((always_inline))

namespace lacuna
{
namespace
{
constexpr float LongestPath = 100; // beyond it nothing gets through that a float's angle could show

/// How many voxels each ray passes: the last weights are 0.
int CountVoxels(const LayerCrossing& c)
{
  const int upToTwo = c.Weights[1] != 0 ? 2 : 1;
  return c.Weights[2] != 0 ? 3 : upToTwo;
}

// One set of functions per instruction set, all from the same code.
#define LACUNA_AVX2 __attribute__((target("avx2")))
#ifdef __clang__ // knows neither the last target nor the pragma, and checks in the loop instead
#define LACUNA_AVX512 __attribute__((target("avx512f,avx512vl,avx512dq")))
#define LACUNA_INDEPENDENT
#else
#define LACUNA_AVX512 __attribute__((target("avx512f,avx512vl,avx512dq,prefer-vector-width=512")))
#define LACUNA_INDEPENDENT _Pragma("GCC ivdep")
#endif

#define LACUNA_LANES_SET Plain
#define LACUNA_LANES_TARGET
#define LACUNA_LANES_WIDEST 4
#include "lacunaOcclusionLanes.h"

#ifdef LACUNA_WIDE_VECTORS
#define LACUNA_LANES_SET Avx2
#define LACUNA_LANES_TARGET LACUNA_AVX2
#define LACUNA_LANES_WIDEST 8
#include "lacunaOcclusionLanes.h"

#define LACUNA_LANES_SET Avx512
#define LACUNA_LANES_TARGET LACUNA_AVX512
#define LACUNA_LANES_WIDEST 16
#include "lacunaOcclusionLanes.h"
#endif

// What follows is left to the compiler to vectorise.
using Plain::Count;
using Plain::Interpolate;
using Plain::PowerOfTwo;

LACUNA_INLINE float LayerPath(const LayerCrossing& c, std::int64_t i)
{
  return (c.Weights[0] * c.Voxels[0][i] + c.Weights[1] * c.Voxels[1][i]) +
    c.Weights[2] * c.Voxels[2][i];
}

template <bool Binary>
LACUNA_INLINE void SeeBody(const float* __restrict first, const float* __restrict last,
  float* __restrict row, float* __restrict between, float fy, std::int64_t n)
{
  for (std::int64_t i = 0; i < n; ++i)
  {
    const float path = last[i] - first[i];
    const float none = 0;
    const float all = Binary ? 1.0F : path;
    const float seen = path > 0 ? all : none;
    between[i] = Interpolate(seen, row[i], fy);
    row[i] = seen;
  }
}

/// How much of the ray of voxel i is hidden on one side.
template <bool Binary>
LACUNA_INLINE float HiddenOn(
  float own, const OcclusionRows::Side& side, float fx, float gain, std::int64_t i)
{
  const float rest = Interpolate(side.Between[i], side.Between[i - 1], fx);
  if (Binary)
  {
    const float part = gain * rest;
    const float bounded = part < 1.0F ? part : 1.0F;
    return own + LayerPath(side.Next, i) > 0 ? 1.0F : bounded;
  }
  return 1.0F - PowerOfTwo<float, std::uint32_t>(own + rest);
}

template <bool Binary>
LACUNA_INLINE void HideBody(std::uint32_t* __restrict hidden, const float* __restrict own,
  float half, const OcclusionRows::Side& before, const OcclusionRows::Side& after, float fx,
  float gain, std::int64_t n)
{
  const OcclusionRows::Side a = before;
  const OcclusionRows::Side b = after;
  LACUNA_INDEPENDENT
  for (std::int64_t i = 0; i < n; ++i)
  {
    const float path = half * own[i];
    hidden[i] += Count<float, std::uint32_t>(
      HiddenOn<Binary>(path, a, fx, gain, i) + HiddenOn<Binary>(path, b, fx, gain, i));
  }
}

template <bool Binary>
LACUNA_INLINE void HideSideBody(std::uint32_t* __restrict hidden, const float* __restrict own,
  float half, const OcclusionRows::Side& side, float fx, float gain, std::int64_t n)
{
  const OcclusionRows::Side a = side;
  LACUNA_INDEPENDENT
  for (std::int64_t i = 0; i < n; ++i)
  {
    hidden[i] += Count<float, std::uint32_t>(HiddenOn<Binary>(half * own[i], a, fx, gain, i));
  }
}

#define LACUNA_ROWS(SET, TARGET)                                                                   \
  template <bool Binary>                                                                           \
  struct SET##Rows                                                                                 \
  {                                                                                                \
    TARGET static void See(                                                                        \
      const float* first, const float* last, float* row, float* between, float fy, std::int64_t n) \
    {                                                                                              \
      SeeBody<Binary>(first, last, row, between, fy, n);                                           \
    }                                                                                              \
    TARGET static void Hide(std::uint32_t* hidden, const float* own, float half,                   \
      const OcclusionRows::Side& before, const OcclusionRows::Side& after, float fx, float gain,   \
      std::int64_t n)                                                                              \
    {                                                                                              \
      HideBody<Binary>(hidden, own, half, before, after, fx, gain, n);                             \
    }                                                                                              \
    TARGET static void HideSide(std::uint32_t* hidden, const float* own, float half,               \
      const OcclusionRows::Side& side, float fx, float gain, std::int64_t n)                       \
    {                                                                                              \
      HideSideBody<Binary>(hidden, own, half, side, fx, gain, n);                                  \
    }                                                                                              \
    static OcclusionRows Get() { return { SET::AddPath, SET::Pass, See, Hide, HideSide }; }        \
  };

LACUNA_ROWS(Plain, )
#ifdef LACUNA_WIDE_VECTORS
LACUNA_ROWS(Avx2, LACUNA_AVX2)
LACUNA_ROWS(Avx512, LACUNA_AVX512)
#endif

template <bool Binary>
std::vector<OcclusionRows> Available()
{
  std::vector<OcclusionRows> rows{ PlainRows<Binary>::Get() };
#ifdef LACUNA_WIDE_VECTORS
  if (__builtin_cpu_supports("avx2"))
  {
    rows.push_back(Avx2Rows<Binary>::Get());
  }
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
    __builtin_cpu_supports("avx512dq"))
  {
    rows.push_back(Avx512Rows<Binary>::Get());
  }
#endif
  return rows;
}
}

const OcclusionRows& GetOcclusionRows(bool binary)
{
  static const OcclusionRows Continuous = Available<false>().back();
  static const OcclusionRows Opaque = Available<true>().back();
  return binary ? Opaque : Continuous;
}

std::vector<OcclusionRows> GetAllOcclusionRows(bool binary)
{
  return binary ? Available<true>() : Available<false>();
}
}
