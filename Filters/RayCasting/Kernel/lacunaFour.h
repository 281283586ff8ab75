// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Four numbers side by side: the compiler's vectors, whose operators work element by element. They
/// are one register in functions that LACUNA_WIDE compiles for AVX2, and two elsewhere.
#ifndef lacunaFour_h
#define lacunaFour_h

#include "lacunaWide.h"

#if defined(__GNUC__)
// Functions that are inlined everywhere have no binary interface which could change.
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

namespace lacuna
{
using Four = double __attribute__((vector_size(32)));
/// Of comparisons: all bits of an element, or none.
using FourMask = long long __attribute__((vector_size(32)));

LACUNA_INLINE Four All(double a)
{
  return Four{ a, a, a, a };
}

LACUNA_INLINE Four LoadFour(const double* p)
{
  return Four{ p[0], p[1], p[2], p[3] };
}

LACUNA_INLINE Four Lesser(const Four& a, const Four& b)
{
  return a < b ? a : b;
}

LACUNA_INLINE Four Greater(const Four& a, const Four& b)
{
  return a > b ? a : b;
}

LACUNA_INLINE unsigned ToBits(const FourMask& mask)
{
  return static_cast<unsigned>((mask[0] & 1) | (mask[1] & 2) | (mask[2] & 4) | (mask[3] & 8));
}
}
#endif
