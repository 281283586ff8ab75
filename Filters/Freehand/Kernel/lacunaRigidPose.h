// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Whether a matrix is the pose of a rigid body.
#ifndef lacunaRigidPose_h
#define lacunaRigidPose_h

#include "lacunaMatrix4.h"

#include <string>

namespace lacuna
{
/// What keeps a matrix from being a rotation and a translation (products of its axes within 0.001), to
/// be put behind its name: "mirrors", say. Empty when it is one.
std::string DescribeNotRigid(const Matrix4& pose);
}
#endif
