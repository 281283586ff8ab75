// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Regions that are cut away from what rays see.
#ifndef lacunaCutRegion_h
#define lacunaCutRegion_h

#include "lacunaMatrix4.h"
#include "lacunaRay.h"

#include <functional>
#include <vector>

namespace lacuna
{
/// A part of space, with coordinates of its own.
class CutRegion
{
public:
  virtual ~CutRegion() = default;

  /// The parts of the world line origin + t direction within the region between t = span.First and
  /// span.Last (finite), in order and disjoint.
  std::vector<RaySpan> Find(const Vec3& origin, const Vec3& direction, const RaySpan& span) const;

  bool Contains(const Vec3& point) const
  {
    return !this->Find(point, { 1, 0, 0 }, { -1e-9, 1e-9 }).empty();
  }

  /// At a point of the region's surface: unit, world, into the region, and so out of what is left.
  Vec3 Normal(const Vec3& point) const;

protected:
  /// worldToLocal: affine, not singular.
  explicit CutRegion(const Matrix4& worldToLocal);
  virtual void FindLocal(const Vec3& origin, const Vec3& direction, const RaySpan& span,
    std::vector<RaySpan>& parts) const = 0;
  /// Of a function that is negative in the region.
  virtual Vec3 LocalGradient(const Vec3& point) const = 0;

private:
  Matrix4 WorldToLocal;
};

/// Where all of some linear functions are negative: half-spaces, boxes, convex polyhedra.
class ConvexRegion : public CutRegion
{
public:
  struct Plane
  {
    Vec3 Origin;
    Vec3 Normal; ///< out of the region
  };
  ConvexRegion(const Matrix4& worldToLocal, const std::vector<Plane>& planes);

private:
  void FindLocal(const Vec3& origin, const Vec3& direction, const RaySpan& span,
    std::vector<RaySpan>& parts) const override;
  Vec3 LocalGradient(const Vec3& point) const override;

  std::vector<Plane> Planes;
};

/// A ball, or an infinite cylinder.
class RoundRegion : public CutRegion
{
public:
  /// axis: of a cylinder, any length; zero for a ball.
  RoundRegion(const Matrix4& worldToLocal, const Vec3& centre, const Vec3& axis, double radius);

private:
  Vec3 Across(const Vec3& v) const;
  void FindLocal(const Vec3& origin, const Vec3& direction, const RaySpan& span,
    std::vector<RaySpan>& parts) const override;
  Vec3 LocalGradient(const Vec3& point) const override;

  Vec3 Centre;
  Vec3 Axis;
  double Radius;
};

/// Where any continuous function of a world point is negative. Sampled each step mm along a line;
/// parts that fit between two samples are not seen.
class FunctionRegion : public CutRegion
{
public:
  using Function = std::function<double(const Vec3&)>;
  FunctionRegion(const Function& function, double step);

private:
  void FindLocal(const Vec3& origin, const Vec3& direction, const RaySpan& span,
    std::vector<RaySpan>& parts) const override;
  Vec3 LocalGradient(const Vec3& point) const override;

  Function Value;
  double Step;
};
}
#endif
