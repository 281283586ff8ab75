// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaShadows.h"

#include "lacunaCutAway.h"
#include "lacunaDepthMap.h"
#include "lacunaFieldData.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkPointData.h"

#include <cstdlib>
#include <stdexcept>

namespace
{
constexpr double BiasPerVoxel = 0.1;

vtkDataArray* FindScalars(vtkImageData* volume, const std::string& name)
{
  vtkPointData* data = volume->GetPointData();
  vtkDataArray* scalars = name.empty() ? data->GetScalars() : data->GetArray(name.c_str());
  if (!scalars || scalars->GetNumberOfComponents() != 1 ||
    scalars->GetNumberOfTuples() != volume->GetNumberOfPoints())
  {
    throw std::runtime_error((name.empty() ? std::string("the volume has no active point scalars")
                                           : "the volume has no point array '" + name + "'") +
      " of one grey level per voxel, which shadows need");
  }
  return scalars;
}

/// The iso-value of the surface whose depths are in an array: number k of IsoValues for Depth_k, the
/// first for all others.
double IsoValueOf(vtkImageData* map, const std::string& depthArray)
{
  vtkDataArray* values = lacuna::FieldData::Find(map, lacuna::DepthMap::IsoValuesName, 1, -1);
  const std::string further = std::string(lacuna::DepthMap::DepthName) + "_";
  const long number =
    depthArray.rfind(further, 0) == 0 ? std::atol(depthArray.c_str() + further.size()) : 0;
  if (!values || number < 0 || number >= values->GetNumberOfTuples())
  {
    throw std::runtime_error(std::string("the depth map does not say in field data array '") +
      lacuna::DepthMap::IsoValuesName + "' at which grey level '" + depthArray +
      "' was found, which shadows need: disconnect the volume or turn CastShadows off");
  }
  return values->GetComponent(number, 0);
}
}

//------------------------------------------------------------------------------
lacuna::ShadowCaster lacuna::Shadows::Prepare(vtkObject* owner, vtkImageData* map,
  vtkImageData* volume, const Settings& settings, lacuna::AlgorithmExecution& execution)
{
  vtkDataArray* scalars = FindScalars(volume, settings.VolumeArray);
  const lacuna::IsoRayCaster& caster =
    this->Caster.Prepare(volume, scalars, settings.Interpolation, settings.SolidSide, execution);
  lacuna::ShadowCaster shadows;
  shadows.Caster = &caster;
  shadows.IsoValue = IsoValueOf(map, settings.DepthArray);
  if (caster.GetMinimum() > caster.GetMaximum())
  {
    vtkWarningWithObjectMacro(
      owner, "no voxel of the volume is a finite number: it throws no shadows");
  }
  else if (!(shadows.IsoValue >= caster.GetMinimum() && shadows.IsoValue <= caster.GetMaximum()))
  {
    const bool mayOvershoot =
      settings.Interpolation == static_cast<int>(lacuna::FieldInterpolation::InterpolatingBSpline);
    vtkWarningWithObjectMacro(owner,
      "the map's iso-value " << shadows.IsoValue
                             << " lies outside the volume's values, which range "
                             << "from " << caster.GetMinimum() << " to " << caster.GetMaximum()
                             << (mayOvershoot ? ": only the spline's overshoot throws shadows"
                                              : ": it throws no shadows"));
  }
  const lacuna::VoxelVolume& voxels = caster.GetVolume();
  const double edge = lacuna::SmallestEdgeOf(voxels.IndexToWorld);
  shadows.Bias = settings.Bias > 0 ? settings.Bias : BiasPerVoxel * edge;
  this->CutAway.reset();
  if (settings.CutAway)
  {
    this->CutAway = lacuna::CutAway::MakeRegion(
      settings.CutAway, 0.5 * edge, lacuna::CornersOf(voxels.IndexToWorld, voxels.Size));
  }
  shadows.CutAway = this->CutAway.get();
  shadows.CapCutAway = settings.CapCutAway;
  shadows.CapBoundary = settings.CapBoundary;
  return shadows;
}
