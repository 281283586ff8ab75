// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The only place that knows how the supported VTK versions differ.
#ifndef vtkLacunaVersionCompat_h
#define vtkLacunaVersionCompat_h

#include "vtkAlgorithm.h"
#include "vtkVersionMacros.h"

/// True when the user asked algorithm (or, where VTK can tell, one upstream) to stop.
inline bool vtkLacunaCheckAbort(vtkAlgorithm* algorithm)
{
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 20220823)
  return algorithm->CheckAbort();
#else
  return algorithm->GetAbortExecute() != 0;
#endif
}

/// Forgets that the last execution was stopped, which VTK itself does only before the next one: what
/// asks vtkLacunaCheckAbort earlier would be stopped, too.
inline void vtkLacunaForgetAbort(vtkAlgorithm* algorithm)
{
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 20220823)
  algorithm->SetAbortOutput(false);
#else
  static_cast<void>(algorithm);
#endif
}
#endif
