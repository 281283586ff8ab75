// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A relief that becomes a plane beyond its middle.
#ifndef lacunaLevelledRelief_h
#define lacunaLevelledRelief_h

#include "lacunaReliefSurface.h"

namespace lacuna
{
/// The C2 surface f(s(x), t(y)) + c1 (x - s(x)) + c2 (y - t(y)) over the whole plane. On a core, s and t
/// are the identity and the surface is the relief; beyond it they come to rest at the relief's border,
/// and the surface gets the slopes c1, c2.
class LevelledRelief
{
public:
  /// low and high are the corners of the core, within the relief; it must outlive this object.
  LevelledRelief(
    const ReliefSurface& relief, const Vec2& slopes, const Vec2& low, const Vec2& high);

  ReliefSurface::Frame GetFrame(const Vec2& p) const;

private:
  struct Argument
  {
    double Value;
    double First; ///< derivatives
    double Second;
  };
  Argument GetArgument(int axis, double x) const;

  const ReliefSurface& Relief;
  Vec2 Slopes;
  Vec2 Low;
  Vec2 High;
};
}
#endif
