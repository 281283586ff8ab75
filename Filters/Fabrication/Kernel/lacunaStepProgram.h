// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// STEP files, which OpenCASCADE makes in a process of its own.
#ifndef lacunaStepProgram_h
#define lacunaStepProgram_h

#include "lacunaExecution.h"
#include "lacunaFacetedSolid.h"

#include <string>
#include <vector>

namespace lacuna
{
/// What a STEP file says about itself.
struct StepHeader
{
  std::string Title;                    ///< of the product
  std::string FileName;                 ///< without its folder
  std::string System;                   ///< program and version
  std::vector<std::string> Description; ///< lines for people
};

/// What the header says, with the solid, as the program lacuna-step (Program/lacunaStep.cxx) reads it. Lines
/// are broken at 250 bytes, since STEP has 256 at most. What is not printable ASCII becomes a question mark.
std::string MakeStepRequest(const FacetedSolid& solid, const StepHeader& header);

/// The content of a STEP file (AP214, unit mm) with a solid for each of solid's bodies. program, lacuna-step,
/// makes it in memory, after it looked whether the solids are valid (BRepCheck_Analyzer) and have their volume. Throws
/// std::runtime_error when they have not, or when there is no such program; Aborted when the user stops.
std::string MakeStep(const std::string& program, const FacetedSolid& solid,
  const StepHeader& header, Execution& execution);

/// Throws what MakeStep throws when there is no program.
void CheckStepProgram(const std::string& program);
}
#endif
