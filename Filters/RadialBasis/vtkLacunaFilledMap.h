// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The depth map that vtkLacunaRBFHoleFiller makes of a lacuna::HoleFillResult.
#ifndef vtkLacunaFilledMap_h
#define vtkLacunaFilledMap_h

#include "lacunaHoleFill.h"

class vtkImageData;
class vtkLacunaDepthMap;

namespace vtkLacunaFilledMap
{
/// Geometry, arrays and field data of filled, from map and result; arrays of the map that the
/// filling does not make are passed on, from the nearest pixel. Field data of the fit only with
/// hasFit.
void Make(vtkImageData* map, const vtkLacunaDepthMap& contract,
  const lacuna::HoleFillResult& result, lacuna::RadialKernel kernel, bool hasFit,
  vtkImageData* filled);
}
#endif
