// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCutRegion.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace lacuna
{
//------------------------------------------------------------------------------
CutRegion::CutRegion(const Matrix4& worldToLocal)
  : WorldToLocal(worldToLocal)
{
}

//------------------------------------------------------------------------------
std::vector<RaySpan> CutRegion::Find(
  const Vec3& origin, const Vec3& direction, const RaySpan& span) const
{
  std::vector<RaySpan> parts;
  if (span.First < span.Last)
  {
    this->FindLocal(
      this->WorldToLocal.Point(origin), this->WorldToLocal.Vector(direction), span, parts);
  }
  return parts;
}

//------------------------------------------------------------------------------
Vec3 CutRegion::Normal(const Vec3& point) const
{
  const Matrix4& m = this->WorldToLocal;
  const Vec3 g = this->LocalGradient(m.Point(point));
  // A gradient is a covector: it goes back with the transposed matrix.
  return Normalized(Vec3{ -(m(0, 0) * g[0] + m(1, 0) * g[1] + m(2, 0) * g[2]),
    -(m(0, 1) * g[0] + m(1, 1) * g[1] + m(2, 1) * g[2]),
    -(m(0, 2) * g[0] + m(1, 2) * g[1] + m(2, 2) * g[2]) });
}

//------------------------------------------------------------------------------
ConvexRegion::ConvexRegion(const Matrix4& worldToLocal, const std::vector<Plane>& planes)
  : CutRegion(worldToLocal)
  , Planes(planes)
{
  for (Plane& plane : this->Planes)
  {
    plane.Normal = Normalized(plane.Normal);
    if (!IsFinite(plane.Origin) || !(Norm(plane.Normal) > 0))
    {
      throw std::invalid_argument("a plane of the cut-away has no origin or no normal");
    }
  }
}

//------------------------------------------------------------------------------
void ConvexRegion::FindLocal(
  const Vec3& origin, const Vec3& direction, const RaySpan& span, std::vector<RaySpan>& parts) const
{
  RaySpan part = span;
  for (const Plane& plane : this->Planes)
  {
    const double height = Dot(plane.Normal, origin - plane.Origin);
    const double slope = Dot(plane.Normal, direction);
    if (slope == 0)
    {
      if (height >= 0)
      {
        return;
      }
      continue;
    }
    const double t = -height / slope;
    (slope > 0 ? part.Last : part.First) =
      slope > 0 ? std::min(part.Last, t) : std::max(part.First, t);
  }
  if (part.First < part.Last)
  {
    parts.push_back(part);
  }
}

//------------------------------------------------------------------------------
Vec3 ConvexRegion::LocalGradient(const Vec3& point) const
{
  Vec3 normal{ 0, 0, 0 };
  double highest = -std::numeric_limits<double>::infinity();
  for (const Plane& plane : this->Planes)
  {
    const double height = Dot(plane.Normal, point - plane.Origin);
    if (height > highest)
    {
      highest = height;
      normal = plane.Normal;
    }
  }
  return normal;
}

//------------------------------------------------------------------------------
RoundRegion::RoundRegion(
  const Matrix4& worldToLocal, const Vec3& centre, const Vec3& axis, double radius)
  : CutRegion(worldToLocal)
  , Centre(centre)
  , Axis(Normalized(axis))
  , Radius(radius)
{
  if (!IsFinite(centre) || !IsFinite(axis) || !std::isfinite(radius) || radius < 0)
  {
    throw std::invalid_argument("the cut-away's centre, axis and radius must be numbers, and the "
                                "radius not negative");
  }
}

//------------------------------------------------------------------------------
Vec3 RoundRegion::Across(const Vec3& v) const
{
  return v - Dot(v, this->Axis) * this->Axis;
}

//------------------------------------------------------------------------------
void RoundRegion::FindLocal(
  const Vec3& origin, const Vec3& direction, const RaySpan& span, std::vector<RaySpan>& parts) const
{
  const Vec3 a = this->Across(origin - this->Centre);
  const Vec3 b = this->Across(direction);
  const double bb = Dot(b, b);
  RaySpan part = span;
  if (bb == 0)
  {
    if (Norm(a) < this->Radius)
    {
      parts.push_back(part);
    }
    return;
  }
  // from the point nearest the centre: no digits are lost far from it
  const double middle = -Dot(a, b) / bb;
  const double distance = Norm(a + middle * b);
  if (!(distance < this->Radius))
  {
    return;
  }
  const double half = std::sqrt((this->Radius - distance) * (this->Radius + distance) / bb);
  part.First = std::max(part.First, middle - half);
  part.Last = std::min(part.Last, middle + half);
  if (part.First < part.Last)
  {
    parts.push_back(part);
  }
}

//------------------------------------------------------------------------------
Vec3 RoundRegion::LocalGradient(const Vec3& point) const
{
  return this->Across(point - this->Centre);
}

//------------------------------------------------------------------------------
FunctionRegion::FunctionRegion(const Function& function, double step)
  : CutRegion(Matrix4())
  , Value(function)
  , Step(step)
{
}

//------------------------------------------------------------------------------
void FunctionRegion::FindLocal(
  const Vec3& origin, const Vec3& direction, const RaySpan& span, std::vector<RaySpan>& parts) const
{
  const auto isInside = [&](double t) { return this->Value(origin + t * direction) < 0; };
  const double length = span.Last - span.First;
  const double steps = std::max(1.0, std::ceil(length * Norm(direction) / this->Step));
  bool inside = isInside(span.First);
  RaySpan part = span;
  double last = span.First;
  for (double n = 1; n <= steps; ++n)
  {
    const double t = span.First + length * (n / steps);
    if (isInside(t) != inside)
    {
      double low = last;
      double high = t;
      for (int i = 0; i < 50; ++i)
      {
        const double middle = 0.5 * (low + high);
        (isInside(middle) == inside ? low : high) = middle;
      }
      if (inside)
      {
        part.Last = high;
        parts.push_back(part);
      }
      part = { high, span.Last };
      inside = !inside;
    }
    last = t;
  }
  if (inside)
  {
    parts.push_back(part);
  }
}

//------------------------------------------------------------------------------
Vec3 FunctionRegion::LocalGradient(const Vec3& point) const
{
  Vec3 gradient;
  const double h = 1e-3 * this->Step;
  for (int a = 0; a < 3; ++a)
  {
    Vec3 step{ 0, 0, 0 };
    step[a] = h;
    gradient[a] = this->Value(point + step) - this->Value(point - step);
  }
  return gradient;
}
}
