// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// As many threads for VTK's filters as for Lacuna's.
#ifndef lacunaVTKThreads_h
#define lacunaVTKThreads_h

#include "vtkSMPTools.h"

#include <stdexcept>

namespace lacunaBenchmark
{
/// Debian's VTK has one thread, whatever it is told, until a back end is chosen.
inline void SetVTKThreads(int threads)
{
  if (!vtkSMPTools::SetBackend("STDThread"))
  {
    throw std::runtime_error("this VTK has no back end STDThread to compare with");
  }
  vtkSMPTools::Initialize(threads);
}
}
#endif
