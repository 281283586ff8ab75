// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The prepared volume behind the filters of this module that cast rays into one.
#ifndef lacunaVolumeCaster_h
#define lacunaVolumeCaster_h

#include "lacunaIsoRayCaster.h"
#include "vtkDataArray.h"
#include "vtkSmartPointer.h"

#include <array>
#include <memory>
#include <tuple>

class vtkImageData;
namespace lacuna
{
class AlgorithmExecution;
}

namespace lacuna
{
/// Keeps its caster until the volume or the way to read it changes: new views, iso-values and lights
/// need it unchanged.
class VolumeCaster
{
public:
  /// scalars: of the volume, one component per voxel; interpolation and solidSide: the numbers of
  /// FieldInterpolation and SolidSide. Throws what IsoRayCaster throws. The
  /// result holds until the next call, and while volume and scalars do.
  const IsoRayCaster& Prepare(vtkImageData* volume, vtkDataArray* scalars, int interpolation,
    int solidSide, AlgorithmExecution& execution);

private:
  using Key =
    std::tuple<vtkDataArray*, vtkMTimeType, std::array<int, 3>, std::array<double, 16>, int, int>;
  Key CasterKey{};
  /// What the caster refers to when the array's own memory layout does not serve.
  vtkSmartPointer<vtkDataArray> Copy;
  std::unique_ptr<IsoRayCaster> Caster;
};
}
#endif
