// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How the FASTRAK tells an orientation, as rotations and back.
#ifndef lacunaFastrakOrientation_h
#define lacunaFastrakOrientation_h

#include "lacunaMatrix4.h"

#include <array>

namespace lacuna
{
/// R = Rz(azimuth) Ry(elevation) Rx(roll), degrees (Carr 1996, ch. 2).
Matrix4 FastrakRotation(const Vec3& angles);
/// Rotation of a quaternion w x y z, which need not have the length 1.
Matrix4 FastrakRotation(const std::array<double, 4>& quaternion);
/// Azimuth, elevation, roll in degrees of a rotation, elevation -90..90; roll 0 at its ends.
Vec3 FastrakAngles(const Matrix4& rotation);
/// Quaternion w x y z of a rotation, w >= 0.
std::array<double, 4> FastrakQuaternion(const Matrix4& rotation);
}
#endif
