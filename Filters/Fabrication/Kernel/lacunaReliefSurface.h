// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A depth field as a smooth surface: normals, curvature, offsets.
#ifndef lacunaReliefSurface_h
#define lacunaReliefSurface_h

#include "lacunaBSplineSurface.h"
#include "lacunaSurfaceFit.h"

namespace lacuna
{
/// The C2 surface z = f(x, y), x and y in mm from the first sample, z = depth away from a viewer who
/// looks along +z. An offset by t > 0 goes towards the viewer.
class ReliefSurface
{
public:
  /// Bicubic spline through all samples. Throws as FitHeights.
  ReliefSurface(
    Execution& execution, GridSize size, const std::vector<double>& depths, const Vec2& spacing);

  /// mm, of the last sample.
  Vec2 GetExtent() const { return this->Extent; }
  /// Whether p is on the surface (the spline is clamped beyond).
  bool Contains(const Vec2& p) const;

  Vec3 GetPoint(const Vec2& p) const;

  /// Differential geometry at a point.
  struct Frame
  {
    Vec3 Point;
    Vec3 AlongX; ///< derivative of Point by x
    Vec3 AlongY;
    Vec3 Normal; ///< unit, towards the viewer
    Vec3 NormalAlongX;
    Vec3 NormalAlongY;
    /// Principal curvatures, 1/mm, ascending; positive where the centre is on the viewer's side.
    double Curvatures[2];

    Vec3 Offset(double t) const { return this->Point + t * this->Normal; }
  };
  Frame GetFrame(const Vec2& p) const;

  /// The depth at p of the offset surface level mm towards the viewer. Returns false where that
  /// surface folds or does not reach.
  bool FindOffsetDepth(const Vec2& p, double level, double& depth) const;
  /// f and its partial derivatives at a point.
  struct Derivatives
  {
    double F;
    double X;
    double Y;
    double XX;
    double XY;
    double YY;
  };
  Derivatives GetDerivatives(const Vec2& p) const;
  /// The geometry of any surface z = f(x, y).
  static Frame MakeFrame(const Vec2& p, const Derivatives& f);

private:
  BSplineSurface Surface;
  Vec2 Spacing;
  Vec2 Extent;
};
}
#endif
