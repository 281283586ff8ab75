// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What MakeStep says to its program (Program/lacunaStep.cxx), and hears from it.
#ifndef lacunaStepProtocol_h
#define lacunaStepProtocol_h

namespace lacuna
{
/// The first line for the program. Both are of one build; this is to find out when they are not.
constexpr const char* StepProtocol = "lacuna-step 1";
/// All that the program says when the file is there and sound.
constexpr const char* StepDone = "done";
}
#endif
