// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What Lacuna and ParaView have to know of each other.
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaSliceStream.h"
#include "vtkPVCompositeDataPipeline.h"
#include "vtkPVPostFilter.h"
#include "vtkSMSettings.h"

#include <string>

namespace
{
// Files whose names say that they are tracked sequences are opened by Tracked Slice Reader without a
// question, while the plugin is loaded; otherwise ParaView asks each time whether to take its own
// reader, which drops the poses. What a user has set as default readers is of higher priority and wins.
// ParaView 5.11 reads the first group of settings, later versions the second.
bool Add(const std::string& group)
{
  return vtkSMSettings::GetInstance()->AddCollectionFromString(
    R"json({ "settings": { ")json" + group + R"json(": { "ReaderDetails": [
  "*.igs.mha *.igs.mhd *.igs.nrrd *.igs.nhdr *.seq.mha *.seq.mhd *.seq.nrrd *.seq.nhdr",
  "Tracked ultrasound sequence", "LacunaTrackedSliceReader"] } } })json",
    0.5);
}
const bool Added = Add("RepresentedArrayListSettings") && Add("IOSettings");

// ParaView executes its pipelines on all ranks. Algorithms that a script makes are on its rank alone.
bool ExecutesOnAllRanks(vtkAlgorithm* algorithm)
{
  return vtkPVCompositeDataPipeline::SafeDownCast(algorithm->GetExecutive()) != nullptr;
}

const bool Agreeing = (lacuna::Algorithm::SetExecutesOnAllRanks(ExecutesOnAllRanks), true);

// One is behind each proxy.
bool PassesOn(vtkAlgorithm* algorithm)
{
  return vtkPVPostFilter::SafeDownCast(algorithm) != nullptr;
}

const bool Passing = (vtkLacunaSliceStream::SetPassesOn(PassesOn), true);
}
