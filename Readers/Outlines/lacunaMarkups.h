// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Closed curves of 3D Slicer: the thin layer over VTK's jsoncpp, which kernels do without.
#ifndef lacunaMarkups_h
#define lacunaMarkups_h

#include "lacunaOutlineSet.h"

#include <string>

namespace lacuna
{
/// The control points of the closed curves in a markups file (.mrk.json; Slicer's schema 1.0.0 to
/// 1.0.4) in patient coordinates (LPS, mm), an outline each, counted from 1. x and y of curves in RAS
/// change their signs. Points that are not placed are left out. A structure's name is that of the
/// curve, or else the file's, since Slicer writes none. Warnings name markups of other types. Throws
/// std::runtime_error naming path, line, curve and point.
OutlineSet ReadMarkups(const std::string& path);
}
#endif
