// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Grey levels are shown in grey: the default colour map of arrays named Intensity, as tracked
/// slices and their volumes have them, while the plugin is loaded. Colour maps that a user has saved
/// for that name are of higher priority and win.
#include "vtkSMSettings.h"

namespace
{
const bool Added = vtkSMSettings::GetInstance()->AddCollectionFromString(
  R"({ "array_lookup_tables": { "Intensity": { "PVLookupTable": {
       "ColorSpace": "RGB", "RGBPoints": [0, 0, 0, 0, 1, 1, 1, 1], "NanColor": [1, 0, 0] } } } })",
  0.5);
}
