// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The surface of a mould for pressing a plate.
#ifndef lacunaPressSurface_h
#define lacunaPressSurface_h

#include "lacunaPressLayout.h"

#include <vector>

namespace lacuna
{
/// What a node of the mould is.
enum class PressRegion : unsigned char
{
  Plane,  ///< of the press
  Flange, ///< the transition
  Plate   ///< the true surface
};

/// Half the height of the fillet at the press plane, of the flange's width.
constexpr double FilletPerWidth = 0.125;

/// The mould: a height field over the nodes of the layout's grid, i (x) fastest.
struct PressSurface
{
  /// Press to relief: x = y = 0 in the middle of the block, z = 0 the press plane.
  Matrix4 PressToRelief;
  std::vector<Vec3> Points; ///< in press coordinates
  std::vector<PressRegion> Regions;
  std::vector<unsigned char> Defect; ///< 1 where the true defect is
  std::vector<double> WallAngles;    ///< degrees from the press plane
  double Depth = 0;                  ///< mm, of the deepest (highest) node from the press plane
  double DraftAngle = 0;             ///< the largest of WallAngles
  Vec3 BlockSize{};
};

/// z = w m(s - s0): s is the true normal offset of the relief (levelled beyond plate and margin), found
/// for every node by its foot point, w the weight of a FlangeBlend around the outlines. m(h) is the
/// lesser of h and 0 (male: the greater) with a C2 fillet for |h| below FilletPerWidth FlangeWidth,
/// and s0, the press plane, that much above (male: below) layout.Top. So the plate is the true surface,
/// all is C2, a cavity has z <= 0 and a boss z >= 0. Throws std::runtime_error when the offset folds,
/// or the block is not high enough.
PressSurface MakePressSurface(Execution& execution, const ReliefSurface& surface, GridSize size,
  const Vec2& spacing, const std::vector<unsigned char>& mask, const PressLayout& layout,
  const PressOptions& options, const Matrix4& toWorld = {});
}
#endif
