// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaReliefSurface.h"

#include <algorithm>
#include <cmath>

namespace lacuna
{
namespace
{
constexpr double LeastStretch = 0.02; // of an offset surface against the surface
constexpr int MaximumSteps = 50;
constexpr double Converged = 1e-10; // mm
}

//------------------------------------------------------------------------------
ReliefSurface::ReliefSurface(
  Execution& execution, GridSize size, const std::vector<double>& depths, const Vec2& spacing)
  : Spacing(spacing)
  , Extent{ static_cast<double>(size.Columns - 1) * spacing[0],
    static_cast<double>(size.Rows - 1) * spacing[1] }
{
  SurfaceFitOptions options;
  options.Tolerance = 0;
  this->Surface = FitHeights(execution, size, depths,
    Matrix4::FromColumns({ spacing[0], 0, 0 }, { 0, spacing[1], 0 }, { 0, 0, 1 }, { 0, 0, 0 }),
    options)
                    .Surface;
}

//------------------------------------------------------------------------------
bool ReliefSurface::Contains(const Vec2& p) const
{
  return p[0] >= 0 && p[0] <= this->Extent[0] && p[1] >= 0 && p[1] <= this->Extent[1];
}

//------------------------------------------------------------------------------
Vec3 ReliefSurface::GetPoint(const Vec2& p) const
{
  const Vec3 s = this->Surface.Evaluate(p[0] / this->Spacing[0], p[1] / this->Spacing[1]);
  return { p[0], p[1], s[2] };
}

//------------------------------------------------------------------------------
ReliefSurface::Frame ReliefSurface::GetFrame(const Vec2& p) const
{
  return MakeFrame(p, this->GetDerivatives(p));
}

//------------------------------------------------------------------------------
ReliefSurface::Derivatives ReliefSurface::GetDerivatives(const Vec2& p) const
{
  const double u = p[0] / this->Spacing[0];
  const double v = p[1] / this->Spacing[1];
  const auto derivative = [&](int i, int j)
  {
    double value = this->Surface.Evaluate(u, v, i, j)[2];
    for (; i > 0; --i)
    {
      value /= this->Spacing[0];
    }
    for (; j > 0; --j)
    {
      value /= this->Spacing[1];
    }
    return value;
  };
  return { derivative(0, 0), derivative(1, 0), derivative(0, 1), derivative(2, 0), derivative(1, 1),
    derivative(0, 2) };
}

//------------------------------------------------------------------------------
ReliefSurface::Frame ReliefSurface::MakeFrame(const Vec2& p, const Derivatives& f)
{
  const double w2 = 1 + f.X * f.X + f.Y * f.Y;
  const double w = std::sqrt(w2);
  Frame frame;
  frame.Point = { p[0], p[1], f.F };
  frame.AlongX = { 1, 0, f.X };
  frame.AlongY = { 0, 1, f.Y };
  frame.Normal = { f.X / w, f.Y / w, -1 / w };
  const double wx = (f.X * f.XX + f.Y * f.XY) / w;
  const double wy = (f.X * f.XY + f.Y * f.YY) / w;
  frame.NormalAlongX = (1 / w) * (Vec3{ f.XX, f.XY, 0 } - wx * frame.Normal);
  frame.NormalAlongY = (1 / w) * (Vec3{ f.XY, f.YY, 0 } - wy * frame.Normal);
  const double mean =
    ((1 + f.Y * f.Y) * f.XX - 2 * f.X * f.Y * f.XY + (1 + f.X * f.X) * f.YY) / (2 * w2 * w);
  const double gauss = (f.XX * f.YY - f.XY * f.XY) / (w2 * w2);
  const double half = std::sqrt(std::max(0.0, mean * mean - gauss));
  frame.Curvatures[0] = -mean - half;
  frame.Curvatures[1] = -mean + half;
  return frame;
}

//------------------------------------------------------------------------------
bool ReliefSurface::FindOffsetDepth(const Vec2& p, double level, double& depth) const
{
  Vec2 foot = p;
  for (int step = 0; step < MaximumSteps; ++step)
  {
    foot = { std::clamp(foot[0], 0.0, this->Extent[0]), std::clamp(foot[1], 0.0, this->Extent[1]) };
    const auto frame = this->GetFrame(foot);
    for (const double curvature : frame.Curvatures)
    {
      if (1 - level * curvature < LeastStretch)
      {
        return false;
      }
    }
    const Vec3 at = frame.Offset(level);
    const Vec3 x = frame.AlongX + level * frame.NormalAlongX;
    const Vec3 y = frame.AlongY + level * frame.NormalAlongY;
    const double determinant = x[0] * y[1] - x[1] * y[0];
    if (determinant <= 0)
    {
      return false;
    }
    const double missX = p[0] - at[0];
    const double missY = p[1] - at[1];
    const double dx = (missX * y[1] - missY * y[0]) / determinant;
    const double dy = (x[0] * missY - x[1] * missX) / determinant;
    depth = at[2] + dx * x[2] + dy * y[2];
    if (std::abs(dx) + std::abs(dy) < Converged)
    {
      return true;
    }
    foot = { foot[0] + dx, foot[1] + dy };
  }
  return false;
}
}
