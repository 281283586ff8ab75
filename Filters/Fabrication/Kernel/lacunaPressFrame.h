// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How a relief is turned so that a plane lies flat in a press.
#ifndef lacunaPressFrame_h
#define lacunaPressFrame_h

#include "lacunaMatrix4.h"
#include "lacunaSurfaceFit.h"

#include <vector>

namespace lacuna
{
/// Which way the mill's side of the press (+z) points.
enum class PressSide
{
  IntoBody, ///< away from the viewer of the relief: its outer face lies on the mould
  TowardsViewer
};

/// A rotation from a relief's axes (x, y, and z away from the viewer) to those of the press.
struct PressFrame
{
  /// Radians about the relief's x and y axes (Carr 1996, eq. 6.14): first Psi about y, then Theta
  /// about x make the plane horizontal.
  double Theta = 0;
  double Psi = 0;
  /// Rx(Theta) Ry(Psi); for TowardsViewer followed by half a turn about x. Determinant +1.
  Matrix4 Rotation;
  /// The plane's unit normal away from the viewer, in the relief's axes.
  Vec3 Inwards{};
};

/// The frame for a plane with the given normal, of any length and either sign. Throws
/// std::invalid_argument when it is not finite or perpendicular to the viewer's axis.
PressFrame MakePressFrame(const Vec3& normal, PressSide side);

/// The normal (c1, c2, -1)/length, towards the viewer, of the plane c0 + c1 x + c2 y that is nearest
/// to the depths where mask is not 0 (everywhere if mask is empty), in the sense of least squares.
/// The depths are finite there. Throws std::invalid_argument when those pixels lie on a line.
Vec3 FitPlaneNormal(GridSize size, const std::vector<double>& depths, const Vec2& spacing,
  const std::vector<unsigned char>& mask = {});
}
#endif
