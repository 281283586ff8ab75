// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A face of a solid as a field of depths, seen from where it is least steep.
#ifndef lacunaFaceRelief_h
#define lacunaFaceRelief_h

#include "lacunaMatrix4.h"
#include "lacunaPlanarTriangulation.h"
#include "lacunaSurfaceFit.h"

#include <vector>

namespace lacuna
{
class Execution;

struct FaceRelief
{
  GridSize Size;
  std::vector<double> Depths;      ///< mm, column fastest, away from the viewer
  std::vector<unsigned char> Mask; ///< 1 on the face, and where there are holes through it
  /// mm along x, y and depth from the first sample to world mm; determinant +1, z is the view.
  Matrix4 ToWorld;
  double SteepestAngle =
    0;                  ///< degrees between the view and the normal, at most, of the face's points
  Vec3 SteepestPoint{}; ///< where that is, world mm
  double Deviation = 0; ///< mm, largest distance of the face's points from the surface
};

/// The view for which the steepest place of the face is least steep. normals: unit, at points that count alike.
Vec3 FindSquareView(const std::vector<Vec3>& normals);

/// triangles: of the face, counterclockwise from outside. The smooth surface goes on beyond it by margin (mm) with its
/// curvature. spacing: mm
/// between samples. Throws std::runtime_error, with the place, when no view sees all of the face.
FaceRelief MakeFaceRelief(Execution& execution, const std::vector<Vec3>& points,
  const std::vector<Triangle>& triangles, double spacing, double margin);
}
#endif
