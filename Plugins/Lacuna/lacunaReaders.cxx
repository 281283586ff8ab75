// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Files whose names say that they are tracked sequences are opened by Tracked Slice Reader without a
/// question, while the plugin is loaded; otherwise ParaView asks each time whether to take its own
/// reader, which drops the poses. What a user has set as default readers is of higher priority and wins.
#include "vtkSMSettings.h"

namespace
{
const bool Added = vtkSMSettings::GetInstance()->AddCollectionFromString(
  R"json({ "settings": { "RepresentedArrayListSettings": { "ReaderDetails": [
  "*.igs.mha *.igs.mhd *.igs.nrrd *.igs.nhdr *.seq.mha *.seq.mhd *.seq.nrrd *.seq.nhdr",
  "Tracked ultrasound sequence", "LacunaTrackedSliceReader"] } } })json",
  0.5);
}
