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

/// 2^-x for x >= 0 to a relative error of 2e-7; exactly 1 at 0.
LACUNA_INLINE float PowerOfTwo(float x)
{
  const float bounded = x < LongestPath ? x : LongestPath;
  const float magic = 12582912.0F; // 1.5 * 2^23: the difference's low bits are -x rounded
  const float shifted = magic - bounded;
  const float f = bounded + (shifted - magic);
  // 2^-f for |f| <= 1/2, relative error 9e-8
  float p = -0.00132647250F;
  p = p * f + 0.00967151299F;
  p = p * f - 0.0555073358F;
  p = p * f + 0.240222424F;
  p = p * f - 0.693147004F;
  p = p * f + 1.0F;
  std::uint32_t bits;
  std::uint32_t exponent;
  std::memcpy(&bits, &p, sizeof bits);
  std::memcpy(&exponent, &shifted, sizeof exponent);
  bits += exponent << 23;
  float result;
  std::memcpy(&result, &bits, sizeof result);
  return result;
}

LACUNA_INLINE float LayerPath(const LayerCrossing& c, std::int64_t i)
{
  return (c.Weights[0] * c.Voxels[0][i] + c.Weights[1] * c.Voxels[1][i]) +
    c.Weights[2] * c.Voxels[2][i];
}

/// Equal neighbours give exactly their value.
LACUNA_INLINE float Interpolate(float a, float b, float toB)
{
  return a + toB * (b - a);
}

LACUNA_INLINE void AddPathBody(float* __restrict path, const LayerCrossing& layer, std::int64_t n)
{
  const LayerCrossing c = layer;
  for (std::int64_t i = 0; i < n; ++i)
  {
    path[i] += LayerPath(c, i);
  }
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

LACUNA_INLINE void SeeBothBody(float* __restrict path, const float* __restrict total,
  const LayerCrossing& layer, const OcclusionRows::View& after, const OcclusionRows::View& before,
  float fy, std::int64_t n)
{
  const LayerCrossing c = layer;
  float* __restrict afterRow = after.Row;
  float* __restrict afterBetween = after.Between;
  float* __restrict beforeRow = before.Row;
  float* __restrict beforeBetween = before.Between;
#pragma GCC ivdep
  for (std::int64_t i = 0; i < n; ++i)
  {
    const float beyond = path[i];
    const float with = beyond + LayerPath(c, i);
    path[i] = with;
    const float rest = total[i] - with;
    const float bounded = rest > 0 ? rest : 0.0F;
    afterBetween[i] = Interpolate(beyond, afterRow[i], fy);
    afterRow[i] = beyond;
    beforeBetween[i] = Interpolate(bounded, beforeRow[i], fy);
    beforeRow[i] = bounded;
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
  return 1.0F - PowerOfTwo(own + rest);
}

template <bool Binary>
LACUNA_INLINE void HideBody(float* __restrict hidden, const float* __restrict own, float half,
  const OcclusionRows::Side& before, const OcclusionRows::Side& after, float fx, float gain,
  std::int64_t n)
{
  const OcclusionRows::Side a = before;
  const OcclusionRows::Side b = after;
#pragma GCC ivdep
  for (std::int64_t i = 0; i < n; ++i)
  {
    const float path = half * own[i];
    hidden[i] += HiddenOn<Binary>(path, a, fx, gain, i) + HiddenOn<Binary>(path, b, fx, gain, i);
  }
}

template <bool Binary>
LACUNA_INLINE void HideSideBody(float* __restrict hidden, const float* __restrict own, float half,
  const OcclusionRows::Side& side, float fx, float gain, std::int64_t n)
{
  const OcclusionRows::Side a = side;
#pragma GCC ivdep
  for (std::int64_t i = 0; i < n; ++i)
  {
    hidden[i] += HiddenOn<Binary>(half * own[i], a, fx, gain, i);
  }
}

// One set of functions per instruction set, all from the bodies above.
#define LACUNA_ROWS(NAME, TARGET)                                                                  \
  template <bool Binary>                                                                           \
  struct NAME                                                                                      \
  {                                                                                                \
    TARGET static void AddPath(float* path, const LayerCrossing& layer, std::int64_t n)            \
    {                                                                                              \
      AddPathBody(path, layer, n);                                                                 \
    }                                                                                              \
    TARGET static void See(                                                                        \
      const float* first, const float* last, float* row, float* between, float fy, std::int64_t n) \
    {                                                                                              \
      SeeBody<Binary>(first, last, row, between, fy, n);                                           \
    }                                                                                              \
    TARGET static void SeeBoth(float* path, const float* total, const LayerCrossing& layer,        \
      const OcclusionRows::View& after, const OcclusionRows::View& before, float fy,               \
      std::int64_t n)                                                                              \
    {                                                                                              \
      SeeBothBody(path, total, layer, after, before, fy, n);                                       \
    }                                                                                              \
    TARGET static void Hide(float* hidden, const float* own, float half,                           \
      const OcclusionRows::Side& before, const OcclusionRows::Side& after, float fx, float gain,   \
      std::int64_t n)                                                                              \
    {                                                                                              \
      HideBody<Binary>(hidden, own, half, before, after, fx, gain, n);                             \
    }                                                                                              \
    TARGET static void HideSide(float* hidden, const float* own, float half,                       \
      const OcclusionRows::Side& side, float fx, float gain, std::int64_t n)                       \
    {                                                                                              \
      HideSideBody<Binary>(hidden, own, half, side, fx, gain, n);                                  \
    }                                                                                              \
    static OcclusionRows Get() { return { AddPath, See, SeeBoth, Hide, HideSide }; }               \
  };

LACUNA_ROWS(PlainRows, )
#ifdef LACUNA_WIDE_VECTORS
LACUNA_ROWS(Avx2Rows, __attribute__((target("avx2"))))
LACUNA_ROWS(
  Avx512Rows, __attribute__((target("avx512f,avx512vl,avx512dq,prefer-vector-width=512"))))
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
