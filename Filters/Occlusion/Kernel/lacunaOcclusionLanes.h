// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The busiest row operations of occluded angles in explicit vectors. What a compiler does not find:
/// the two rays beside a voxel are a vector and the same one lane later, and the powers of one
/// vector can be computed while the next is read.
///
/// lacunaOcclusionRows.cxx includes this once per instruction set (so there is no guard), with these
/// macros: LACUNA_LANES_SET, a name for it; LACUNA_LANES_TARGET, the attributes of its functions;
/// LACUNA_LANES_WIDEST, the lanes of its widest vectors: 4, 8 or 16.

#define LACUNA_LANES_FUNCTION LACUNA_LANES_TARGET __attribute__((always_inline)) static inline

namespace LACUNA_LANES_SET
{
/// A number of floats that are worked on together.
template <int Lanes>
struct Vector;

template <>
struct Vector<1>
{
  using Floats = float;
  using Integers = std::uint32_t;
  /// The lanes of current, one later; the first is the last of previous.
  LACUNA_LANES_FUNCTION Floats Delay(Floats previous, Floats) { return previous; }
  LACUNA_LANES_FUNCTION float Last(Floats vector) { return vector; }
};

template <>
struct Vector<4>
{
  using Floats = float __attribute__((vector_size(16)));
  using Integers = std::uint32_t __attribute__((vector_size(16)));
  LACUNA_LANES_FUNCTION Floats Delay(const Floats& previous, const Floats& current)
  {
    return __builtin_shufflevector(previous, current, 3, 4, 5, 6);
  }
  LACUNA_LANES_FUNCTION float Last(const Floats& vector) { return vector[3]; }
};

#if LACUNA_LANES_WIDEST >= 8
template <>
struct Vector<8>
{
  using Floats = float __attribute__((vector_size(32)));
  using Integers = std::uint32_t __attribute__((vector_size(32)));
  LACUNA_LANES_FUNCTION Floats Delay(const Floats& previous, const Floats& current)
  {
    return __builtin_shufflevector(previous, current, 7, 8, 9, 10, 11, 12, 13, 14);
  }
  LACUNA_LANES_FUNCTION float Last(const Floats& vector) { return vector[7]; }
};
#endif

#if LACUNA_LANES_WIDEST >= 16
template <>
struct Vector<16>
{
  using Floats = float __attribute__((vector_size(64)));
  using Integers = std::uint32_t __attribute__((vector_size(64)));
  LACUNA_LANES_FUNCTION Floats Delay(const Floats& previous, const Floats& current)
  {
    return __builtin_shufflevector(
      previous, current, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30);
  }
  LACUNA_LANES_FUNCTION float Last(const Floats& vector) { return vector[15]; }
};
#endif

/// 2^-x for x >= 0 to a relative error of 2e-7; exactly 1 at 0. Floats and Integers are of 32 bits,
/// single ones or vectors.
template <class Floats, class Integers>
LACUNA_LANES_FUNCTION Floats PowerOfTwo(const Floats& x)
{
  const Floats longest = Floats{} + LongestPath;
  const Floats bounded = x < longest ? x : longest;
  const float magic = 12582912.0F; // 1.5 * 2^23: the difference's low bits are -x rounded
  const Floats shifted = magic - bounded;
  const Floats f = bounded + (shifted - magic);
  // 2^-f for |f| <= 1/2, relative error 9e-8; in pairs, which do not wait for each other
  const Floats square = f * f;
  const Floats high = 0.00967151299F - 0.00132647250F * f;
  const Floats middle = 0.240222424F - 0.0555073358F * f;
  const Floats low = 1.0F - 0.693147004F * f;
  const Floats power = low + square * (middle + square * high);
  Integers bits;
  Integers exponent;
  std::memcpy(&bits, &power, sizeof bits);
  std::memcpy(&exponent, &shifted, sizeof exponent);
  bits += exponent << 23;
  Floats result;
  std::memcpy(&result, &bits, sizeof result);
  return result;
}

/// A fraction 0...2 as a number of HiddenUnits, rounded.
template <class Floats, class Integers>
LACUNA_LANES_FUNCTION Integers Count(const Floats& fraction)
{
  const Floats magic = Floats{} + 8388608.0F; // 2^23: the sum's low bits are the number
  const Floats shifted = magic + HiddenUnits * fraction;
  Integers bits;
  std::memcpy(&bits, &shifted, sizeof bits);
  return bits - 0x4B000000U; // of 2^23
}

/// Equal neighbours give exactly their value.
template <class Floats>
LACUNA_LANES_FUNCTION Floats Interpolate(const Floats& a, const Floats& b, float toB)
{
  return a + toB * (b - a);
}

/// What is done to a vector; Voxels is how many of them a ray passes in the layer.
template <int Lanes, int Voxels>
struct Step
{
  using Floats = typename Vector<Lanes>::Floats;

  LACUNA_LANES_FUNCTION Floats Load(const float* values)
  {
    Floats result;
    std::memcpy(&result, values, sizeof result);
    return result;
  }

  LACUNA_LANES_FUNCTION void Store(float* values, const Floats& vector)
  {
    std::memcpy(values, &vector, sizeof vector);
  }

  LACUNA_LANES_FUNCTION Floats LayerPath(const LayerCrossing& c, std::int64_t i)
  {
    Floats path = c.Weights[0] * Load(c.Voxels[0] + i);
    if (Voxels > 1)
    {
      path += c.Weights[1] * Load(c.Voxels[1] + i);
    }
    if (Voxels > 2)
    {
      path += c.Weights[2] * Load(c.Voxels[2] + i);
    }
    return path;
  }

  LACUNA_LANES_FUNCTION void AddPath(float* path, const LayerCrossing& c, std::int64_t i)
  {
    Store(path + i, Load(path + i) + LayerPath(c, i));
  }

  /// Paths on both sides, of rays or of voxels.
  struct Sides
  {
    Floats After;
    Floats Before;
  };

  /// What lies between this row of rays and the one before.
  LACUNA_LANES_FUNCTION Sides See(const OcclusionRows::Passage& p, std::int64_t i)
  {
    const Floats beyond = Load(p.Path + i);
    const Floats with = beyond + LayerPath(p.Rays.Layer, i);
    Store(p.Path + i, with);
    const Floats rest = Load(p.Total + i) - with;
    const Floats none{};
    const Floats bounded = rest > none ? rest : none;
    const Sides between{ Interpolate(beyond, Load(p.After + i), p.FractionY),
      Interpolate(bounded, Load(p.Before + i), p.FractionY) };
    Store(p.After + i, beyond);
    Store(p.Before + i, bounded);
    return between;
  }

  /// The paths of voxels; between is what lies between the rows of rays, of the vector before.
  LACUNA_LANES_FUNCTION Sides Gather(
    const OcclusionRows::Passage& p, std::int64_t i, Sides& between)
  {
    const Sides here = See(p, i);
    const Floats after = Vector<Lanes>::Delay(between.After, here.After);
    const Floats before = Vector<Lanes>::Delay(between.Before, here.Before);
    between = here;
    const Floats own = p.Half * Load(p.Own + i);
    return { own + Interpolate(here.After, after, p.FractionX),
      own + Interpolate(here.Before, before, p.FractionX) };
  }

  LACUNA_LANES_FUNCTION void Hide(
    const OcclusionRows::Passage& p, std::int64_t i, const Sides& path)
  {
    using Integers = typename Vector<Lanes>::Integers;
    const Floats through =
      PowerOfTwo<Floats, Integers>(path.After) + PowerOfTwo<Floats, Integers>(path.Before);
    Integers hidden;
    std::memcpy(&hidden, p.Hidden + i, sizeof hidden);
    hidden += Count<Floats, Integers>(2.0F - through);
    std::memcpy(p.Hidden + i, &hidden, sizeof hidden);
  }
};

/// The lanes of the vectors for what is left of a row.
template <int Lanes>
constexpr int Narrower = Lanes > 4 ? Lanes / 2 : 1;

template <int Lanes, int Voxels>
LACUNA_LANES_FUNCTION void AddRow(
  float* path, const LayerCrossing& c, const float* ahead, std::int64_t i, std::int64_t n)
{
  for (; i + Lanes <= n; i += Lanes)
  {
    __builtin_prefetch(ahead + i);
    Step<Lanes, Voxels>::AddPath(path, c, i);
  }
  if constexpr (Lanes > 1)
  {
    AddRow<Narrower<Lanes>, Voxels>(path, c, ahead, i, n);
  }
}

template <int Lanes, int Voxels>
LACUNA_LANES_FUNCTION void SeeRow(const OcclusionRows::Passage& p, std::int64_t i)
{
  for (; i + Lanes <= p.Rays.Count; i += Lanes)
  {
    Step<Lanes, Voxels>::See(p, i);
  }
  if constexpr (Lanes > 1)
  {
    SeeRow<Narrower<Lanes>, Voxels>(p, i);
  }
}

/// From ray i on; after and before lie between the rows of rays at the ray before.
template <int Lanes, int Voxels>
LACUNA_LANES_FUNCTION void PassRow(
  const OcclusionRows::Passage& p, std::int64_t i, float after, float before)
{
  using S = Step<Lanes, Voxels>;
  const typename S::Floats none{};
  typename S::Sides between{ none + after, none + before };
  if (i + Lanes <= p.Rays.Count)
  {
    typename S::Sides path = S::Gather(p, i, between);
    for (i += Lanes; i + Lanes <= p.Rays.Count; i += Lanes)
    {
      __builtin_prefetch(p.Own + p.Rays.FieldAhead + i);
      __builtin_prefetch(p.Hidden + p.HiddenAhead + i);
      const typename S::Sides next = S::Gather(p, i, between);
      S::Hide(p, i - Lanes, path);
      path = next;
    }
    S::Hide(p, i - Lanes, path);
  }
  if constexpr (Lanes > 1)
  {
    PassRow<Narrower<Lanes>, Voxels>(
      p, i, Vector<Lanes>::Last(between.After), Vector<Lanes>::Last(between.Before));
  }
}

LACUNA_LANES_FUNCTION void NextRow(LayerCrossing& c, std::int64_t stride)
{
  for (const float*& voxels : c.Voxels)
  {
    voxels += stride;
  }
}

template <int Voxels>
LACUNA_LANES_FUNCTION void AddRows(float* path, const LayerRays& rays)
{
  LayerCrossing c = rays.Layer;
  for (std::int64_t row = 0; row < rays.Rows; ++row)
  {
    AddRow<LACUNA_LANES_WIDEST, Voxels>(path, c, c.Voxels[0] + rays.FieldAhead, 0, rays.Count);
    path += rays.Stride;
    NextRow(c, rays.FieldStride);
  }
}

template <int Voxels>
LACUNA_LANES_FUNCTION void PassRows(const OcclusionRows::Passage& passage)
{
  OcclusionRows::Passage p = passage;
  for (std::int64_t row = 0; row < p.Rays.Rows; ++row)
  {
    if (row == 0 && !p.FirstServes)
    {
      SeeRow<LACUNA_LANES_WIDEST, Voxels>(p, 0);
    }
    else
    {
      const typename Step<1, Voxels>::Sides first = Step<1, Voxels>::See(p, 0);
      PassRow<LACUNA_LANES_WIDEST, Voxels>(p, 1, first.After, first.Before);
    }
    p.Path += p.Rays.Stride;
    p.Total += p.Rays.Stride;
    p.Own += p.Rays.FieldStride;
    p.Hidden += p.HiddenStride;
    NextRow(p.Rays.Layer, p.Rays.FieldStride);
  }
}

LACUNA_LANES_TARGET void AddPath(float* path, const LayerRays& rays)
{
  switch (CountVoxels(rays.Layer))
  {
    case 1:
      return AddRows<1>(path, rays);
    case 2:
      return AddRows<2>(path, rays);
    default:
      return AddRows<3>(path, rays);
  }
}

LACUNA_LANES_TARGET void Pass(const OcclusionRows::Passage& passage)
{
  switch (CountVoxels(passage.Rays.Layer))
  {
    case 1:
      return PassRows<1>(passage);
    case 2:
      return PassRows<2>(passage);
    default:
      return PassRows<3>(passage);
  }
}
}
#undef LACUNA_LANES_FUNCTION
#undef LACUNA_LANES_SET
#undef LACUNA_LANES_TARGET
#undef LACUNA_LANES_WIDEST
