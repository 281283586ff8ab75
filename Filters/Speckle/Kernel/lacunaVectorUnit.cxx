// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaVectorUnit.h"

namespace lacuna
{
VectorUnit BestVectorUnit()
{
#ifdef LACUNA_HAS_WIDE_VECTORS
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
    __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
  {
    return VectorUnit::Avx512;
  }
  if (__builtin_cpu_supports("avx2"))
  {
    return VectorUnit::Avx2;
  }
#endif
  return VectorUnit::Baseline;
}
}
