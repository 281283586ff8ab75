// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Moulds of depth fields, for tests.
#ifndef lacunaPressScene_h
#define lacunaPressScene_h

#include "lacunaPlateScene.h"
#include "lacunaPressSurface.h"

/// A PlateScene, pressed.
struct PressScene : PlateScene
{
  lacuna::ReliefSurface Surface;
  lacuna::PressLayout Layout;

  PressScene(const std::function<double(double, double)>& depth,
    const std::function<bool(double, double)>& inside, int threads = 0)
    : PlateScene(depth, inside, threads)
    , Surface(this->Execution, this->Size, this->Depths, this->Spacing)
  {
  }

  /// With the least squares plane.
  lacuna::PressSurface Press(const lacuna::PressOptions& options)
  {
    return this->Press(options, lacuna::FitPlaneNormal(this->Size, this->Depths, this->Spacing));
  }

  lacuna::PressSurface Press(const lacuna::PressOptions& options, const lacuna::Vec3& normal)
  {
    this->Layout = lacuna::PlanPress(
      this->Execution, this->Surface, this->Size, this->Spacing, this->Mask, normal, options);
    return lacuna::MakePressSurface(
      this->Execution, this->Surface, this->Size, this->Spacing, this->Mask, this->Layout, options);
  }

  /// The middle of the field in the relief's coordinates, plus (x, y, z).
  static lacuna::Vec3 At(double x, double y, double z) { return { Middle + x, Middle + y, z }; }
};
#endif
