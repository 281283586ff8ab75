// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What of a volume throws shadows on a depth map, for vtkLacunaDepthMapShader.
#ifndef lacunaShadows_h
#define lacunaShadows_h

#include "lacunaShadowCaster.h"
#include "lacunaVolumeCaster.h"

#include <memory>
#include <string>

class vtkImageData;
class vtkImplicitFunction;
namespace lacuna
{
class AlgorithmExecution;
}
class vtkObject;

namespace lacuna
{
class Shadows
{
public:
  struct Settings
  {
    std::string DepthArray;  ///< of the map
    std::string VolumeArray; ///< empty: the active scalars
    int Interpolation = 0;
    int SolidSide = 0;
    double Bias = 0; ///< mm; 0: a tenth of the smallest voxel edge
    vtkImplicitFunction* CutAway = nullptr;
    bool CapCutAway = true;
    bool CapBoundary = false;
  };

  /// Throws std::runtime_error when the volume has no grey levels or the map does not say at which of
  /// them it was made. An iso-value that the volume does not reach is owner's warning. The result
  /// refers to this object, and holds while volume does.
  ShadowCaster Prepare(vtkObject* owner, vtkImageData* map, vtkImageData* volume,
    const Settings& settings, AlgorithmExecution& execution);

private:
  VolumeCaster Caster;
  std::unique_ptr<CutRegion> CutAway;
};
}
#endif
