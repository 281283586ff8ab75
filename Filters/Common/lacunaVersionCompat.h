// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The only place that knows how the supported VTK versions differ.
#ifndef lacunaVersionCompat_h
#define lacunaVersionCompat_h

#include "vtkAlgorithm.h"
#include "vtkInformation.h"
#include "vtkInformationIntegerKey.h"
#include "vtkVersionMacros.h"

namespace lacuna
{
/// True when the user asked algorithm (or, where VTK can tell, one upstream) to stop, or its input is of
/// one that was stopped.
inline bool CheckAbort(vtkAlgorithm* algorithm)
{
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 20220823)
  return algorithm->GetAbortOutput() || algorithm->CheckAbort();
#else
  return algorithm->GetAbortExecute() != 0;
#endif
}

/// True when what is upstream was stopped in the last update of the input that info is of: outside of
/// executions algorithms are not told.
inline bool WasStopped(vtkInformation* info)
{
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 20220823)
  return info->Get(vtkAlgorithm::ABORTED()) != 0;
#else
  static_cast<void>(info);
  return false;
#endif
}

/// Whether algorithms are told that one upstream was stopped, so that they give nothing, either.
constexpr bool TellsOfAbort =
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 20220823)
  true;
#else
  false;
#endif

/// Forgets that the last execution was stopped, which VTK itself does only before the next one: what
/// asks CheckAbort outside of executions would be stopped, too. Within one this would forget
/// that an algorithm upstream was stopped, and algorithms downstream would take half for all.
inline void ForgetAbort(vtkAlgorithm* algorithm)
{
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 20220823)
  algorithm->SetAbortOutput(false);
#else
  static_cast<void>(algorithm);
#endif
}
}
#endif
