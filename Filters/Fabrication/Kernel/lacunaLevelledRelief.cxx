// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaLevelledRelief.h"

#include <algorithm>

namespace lacuna
{
//------------------------------------------------------------------------------
LevelledRelief::LevelledRelief(
  const ReliefSurface& relief, const Vec2& slopes, const Vec2& low, const Vec2& high)
  : Relief(relief)
  , Slopes(slopes)
  , Low(low)
  , High(high)
{
}

//------------------------------------------------------------------------------
LevelledRelief::Argument LevelledRelief::GetArgument(int axis, double x) const
{
  if (x >= this->Low[axis] && x <= this->High[axis])
  {
    return { x, 1, 0 };
  }
  // The slope falls from 1 to 0 as a cubic with level ends, over twice the way there is.
  const bool above = x > this->High[axis];
  const double sign = above ? 1 : -1;
  const double from = above ? this->High[axis] : this->Low[axis];
  const double room = above ? this->Relief.GetExtent()[axis] - from : from;
  const double t = room > 0 ? std::min(1.0, sign * (x - from) / (2 * room)) : 1;
  return { from + sign * (t < 1 ? 2 * room * (t - t * t * t + 0.5 * t * t * t * t) : room),
    1 - t * t * (3 - 2 * t), t < 1 ? -sign * 6 * t * (1 - t) / (2 * room) : 0 };
}

//------------------------------------------------------------------------------
ReliefSurface::Frame LevelledRelief::GetFrame(const Vec2& p) const
{
  const Argument x = this->GetArgument(0, p[0]);
  const Argument y = this->GetArgument(1, p[1]);
  const auto f = this->Relief.GetDerivatives({ x.Value, y.Value });
  ReliefSurface::Derivatives g;
  g.F = f.F + this->Slopes[0] * (p[0] - x.Value) + this->Slopes[1] * (p[1] - y.Value);
  g.X = f.X * x.First + this->Slopes[0] * (1 - x.First);
  g.Y = f.Y * y.First + this->Slopes[1] * (1 - y.First);
  g.XX = f.XX * x.First * x.First + (f.X - this->Slopes[0]) * x.Second;
  g.XY = f.XY * x.First * y.First;
  g.YY = f.YY * y.First * y.First + (f.Y - this->Slopes[1]) * y.Second;
  return ReliefSurface::MakeFrame(p, g);
}
}
