// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Run-time choice of the vector width of inner loops. The binary is for baseline x86-64; loops
/// that pay are compiled again for wider vectors and picked by what the processor has. All
/// versions do the same operations on each sample, so their results are the same bit for bit.
#ifndef lacunaVectorUnit_h
#define lacunaVectorUnit_h

#include <cstring>

#if defined(__x86_64__) && defined(__GNUC__)
#define LACUNA_HAS_WIDE_VECTORS 1
#endif
#define LACUNA_INLINE inline __attribute__((always_inline))

namespace lacuna
{
/// In ascending order of width: a processor that has one has those before it.
enum class VectorUnit
{
  Baseline, ///< 16-byte vectors (SSE2 on x86-64)
  Avx2,     ///< 32-byte vectors
  Avx512    ///< 64-byte vectors (AVX-512 F, BW, DQ, VL)
};

/// The widest one this processor has.
VectorUnit BestVectorUnit();

/// A vector of Bytes / sizeof(T) elements with element-wise operators (a GCC and Clang extension).
template <class T, int Bytes>
struct Vector
{
  typedef T Type __attribute__((vector_size(Bytes)));
  static constexpr int Lanes = Bytes / static_cast<int>(sizeof(T));
};

/// Unaligned access. V is deduced from the vector, so that no vector is passed by value.
template <class V, class T>
LACUNA_INLINE void LoadVector(V& v, const T* from)
{
  std::memcpy(&v, from, sizeof(V));
}

template <class V, class T>
LACUNA_INLINE void StoreVector(T* to, const V& v)
{
  std::memcpy(to, &v, sizeof(V));
}

namespace detail
{
template <class Body, class Arguments>
void RunBaseline(Arguments& arguments)
{
  Body::template Run<16>(arguments);
}

#ifdef LACUNA_HAS_WIDE_VECTORS
template <class Body, class Arguments>
__attribute__((target("avx2"))) void RunAvx2(Arguments& arguments)
{
  Body::template Run<32>(arguments);
}

template <class Body, class Arguments>
__attribute__((target("avx512f,avx512bw,avx512dq,avx512vl"))) void RunAvx512(Arguments& arguments)
{
  Body::template Run<64>(arguments);
}
#endif
}

/// Calls Body::Run<bytes per vector>(arguments) compiled for the instruction set. Run and all that
/// it calls in its inner loops must be LACUNA_INLINE: only then are they compiled for that set.
template <class Body, class Arguments>
void RunWith(VectorUnit set, Arguments& arguments)
{
#ifdef LACUNA_HAS_WIDE_VECTORS
  switch (set)
  {
    case VectorUnit::Avx512:
      return detail::RunAvx512<Body>(arguments);
    case VectorUnit::Avx2:
      return detail::RunAvx2<Body>(arguments);
    case VectorUnit::Baseline:
      break;
  }
#endif
  detail::RunBaseline<Body>(arguments);
}
}
#endif
