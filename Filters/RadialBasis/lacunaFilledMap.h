// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The depth map that vtkLacunaRBFHoleFiller makes of a lacuna::HoleFillResult.
#ifndef lacunaFilledMap_h
#define lacunaFilledMap_h

#include "lacunaHoleFill.h"

class vtkImageData;
namespace lacuna
{
class DepthMap;
}

namespace lacuna::FilledMap
{
/// Geometry, arrays and field data of filled, from map and result; arrays of the map that the
/// filling does not make are passed on, from the nearest pixel. Field data of the fit only with
/// hasFit.
void Make(vtkImageData* map, const DepthMap& contract, const HoleFillResult& result,
  RadialKernel kernel, bool hasFit, vtkImageData* filled);
}
#endif
