// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaInstructionSet.h"

namespace lacuna
{
InstructionSet BestInstructionSet()
{
#ifdef LACUNA_HAS_WIDE_VECTORS
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
    __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
  {
    return InstructionSet::Avx512;
  }
  if (__builtin_cpu_supports("avx2"))
  {
    return InstructionSet::Avx2;
  }
#endif
  return InstructionSet::Baseline;
}
}
