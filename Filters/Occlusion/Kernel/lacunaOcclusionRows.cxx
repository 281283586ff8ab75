// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaOcclusionRows.h"

#include <cmath>
#include <cstring>

#if defined(__x86_64__) && defined(__GNUC__)
#define LACUNA_WIDE_VECTORS 1
#endif

#define LACUNA_INLINE inline __attribute__((always_inline))

namespace lacuna
{
namespace
{
/// exp(-x) for x >= 0 to a relative error of 2e-7 up to 10, 6e-6 up to LargestPath; exactly 1 at 0.
LACUNA_INLINE float ExpMinus(float x)
{
  const float bounded = x < LargestPath ? x : LargestPath;
  const float y = bounded * -1.44269504F; // exp(-x) = 2^y
  const float magic = 12582912.0F;        // 1.5 * 2^23: the sum's low bits are y rounded
  const float shifted = y + magic;
  const float f = y - (shifted - magic);
  // 2^f for |f| <= 1/2, relative error 9e-8
  float p = 0.00132647250F;
  p = p * f + 0.00967151299F;
  p = p * f + 0.0555073358F;
  p = p * f + 0.240222424F;
  p = p * f + 0.693147004F;
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

template <bool Binary>
LACUNA_INLINE float LetThrough(float path)
{
  return Binary ? (path > 0 ? 0.0F : 1.0F) : ExpMinus(path);
}

LACUNA_INLINE float LayerPath(
  const float* m0, const float* m1, const PathLengths& w, std::int64_t i)
{
  return (w[0] * m0[i] + w[1] * m0[i + 1]) + (w[2] * m1[i] + w[3] * m1[i + 1]);
}

LACUNA_INLINE void AddPathBody(float* __restrict path, const float* __restrict m0,
  const float* __restrict m1, const PathLengths& lengths, std::int64_t n)
{
  const PathLengths w = lengths;
  for (std::int64_t i = 0; i < n; ++i)
  {
    path[i] += LayerPath(m0, m1, w, i);
  }
}

template <bool Binary>
LACUNA_INLINE void SeeBody(const float* __restrict path, const float* __restrict first,
  float* __restrict root, std::int64_t n)
{
  for (std::int64_t i = 0; i < n; ++i)
  {
    const float length = 0.5F * (path[i] - first[i]);
    root[i] = LetThrough<Binary>(length > 0 ? length : 0.0F);
  }
}

/// What reaches voxel i from one side.
template <bool Binary>
LACUNA_INLINE float Reach(float ownPath, const float* m0, const float* m1, const PathLengths& w,
  const float* near, const float* far, float fx, float fy, std::int64_t i)
{
  // Written so that equal neighbours give exactly their value.
  const float left = near[i - 1] + fy * (far[i - 1] - near[i - 1]);
  const float right = near[i] + fy * (far[i] - near[i]);
  const float root = right + fx * (left - right);
  return LetThrough<Binary>(ownPath + LayerPath(m0, m1, w, i)) * (root * root);
}

template <bool Binary>
LACUNA_INLINE void HideBody(float* __restrict hidden, const float* __restrict own, float half,
  const OcclusionRows::Side& before, const OcclusionRows::Side& after, float fx, float fy,
  std::int64_t n)
{
  const OcclusionRows::Side a = before;
  const OcclusionRows::Side b = after;
#pragma GCC ivdep
  for (std::int64_t i = 0; i < n; ++i)
  {
    const float path = half * own[i];
    hidden[i] += (1.0F - Reach<Binary>(path, a.M0, a.M1, a.Lengths, a.Near, a.Far, fx, fy, i)) +
      (1.0F - Reach<Binary>(path, b.M0, b.M1, b.Lengths, b.Near, b.Far, fx, fy, i));
  }
}

template <bool Binary>
LACUNA_INLINE void HideSideBody(float* __restrict hidden, const float* __restrict own, float half,
  const OcclusionRows::Side& side, float fx, float fy, std::int64_t n)
{
  const OcclusionRows::Side a = side;
#pragma GCC ivdep
  for (std::int64_t i = 0; i < n; ++i)
  {
    hidden[i] +=
      1.0F - Reach<Binary>(half * own[i], a.M0, a.M1, a.Lengths, a.Near, a.Far, fx, fy, i);
  }
}

// One set of functions per instruction set, all from the bodies above.
#define LACUNA_ROWS(NAME, TARGET)                                                                  \
  template <bool Binary>                                                                           \
  struct NAME                                                                                      \
  {                                                                                                \
    TARGET static void AddPath(                                                                    \
      float* path, const float* m0, const float* m1, const PathLengths& lengths, std::int64_t n)   \
    {                                                                                              \
      AddPathBody(path, m0, m1, lengths, n);                                                       \
    }                                                                                              \
    TARGET static void See(const float* path, const float* first, float* root, std::int64_t n)     \
    {                                                                                              \
      SeeBody<Binary>(path, first, root, n);                                                       \
    }                                                                                              \
    TARGET static void Hide(float* hidden, const float* own, float half,                           \
      const OcclusionRows::Side& before, const OcclusionRows::Side& after, float fx, float fy,     \
      std::int64_t n)                                                                              \
    {                                                                                              \
      HideBody<Binary>(hidden, own, half, before, after, fx, fy, n);                               \
    }                                                                                              \
    TARGET static void HideSide(float* hidden, const float* own, float half,                       \
      const OcclusionRows::Side& side, float fx, float fy, std::int64_t n)                         \
    {                                                                                              \
      HideSideBody<Binary>(hidden, own, half, side, fx, fy, n);                                    \
    }                                                                                              \
    static OcclusionRows Get() { return { AddPath, See, Hide, HideSide }; }                        \
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
