// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How far bone is from a point.
#ifndef lacunaBoneDistance_h
#define lacunaBoneDistance_h

#include "lacunaTriangleSurface.h"
#include "lacunaVector.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace lacuna
{
struct NearestBone
{
  double Distance; ///< mm to the surface of bone, negative within bone
  Vec3 Point;      ///< of that surface
};

class BoneDistance
{
public:
  virtual ~BoneDistance() = default;
  /// The nearest place within limit, mm > 0; without one, Distance is limit (or -limit) and Point is x. Many threads may
  /// call it.
  virtual NearestBone Find(const Vec3& x, double limit) const = 0;
  /// Opposite corners of a box (world axes) that holds all of the bone.
  virtual std::array<Vec3, 2> GetBounds() const = 0;
};

/// Bone whose surface is given as triangles.
class TriangleBone : public BoneDistance
{
public:
  /// isBone: whether a point is in bone; many threads call it.
  TriangleBone(TriangleSurface surface, std::function<bool(const Vec3&)> isBone);
  NearestBone Find(const Vec3& x, double limit) const override;
  std::array<Vec3, 2> GetBounds() const override { return { this->Low, this->High }; }

private:
  std::array<std::int64_t, 3> CellOf(const Vec3& x) const;

  TriangleSurface Surface;
  std::function<bool(const Vec3&)> IsBone;
  Vec3 Low{ 0, 0, 0 };
  Vec3 High{ 0, 0, 0 };
  std::array<std::int64_t, 3> Size{ 1, 1, 1 };
  std::vector<std::int64_t> First; ///< of each cell in Items
  std::vector<std::int32_t> Items; ///< triangles whose box meets the cell
};

/// The nearest point of a triangle.
Vec3 FindNearestOfTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);
}
#endif
