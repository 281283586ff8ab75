// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Which triangles are near.
#ifndef lacunaTriangleTree_h
#define lacunaTriangleTree_h

#include "lacunaClosedMesh.h"

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace lacuna
{
/// The square of the distance of x to a triangle, mm^2.
double GetSquaredDistance(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c);

/// Boxes around the triangles of a mesh. All functions may be called by many threads.
class TriangleTree
{
public:
  /// Keeps a reference to mesh, which has triangles.
  explicit TriangleTree(const ClosedMesh& mesh);

  /// mm from x to the nearest point of the mesh.
  double GetDistance(const Vec3& x) const;

  /// A triangle with a higher number that passes through triangle; -1: none. Triangles that only touch, or
  /// that share an edge, do not.
  std::int32_t FindCrossing(std::int32_t triangle) const;

private:
  struct Node
  {
    Vec3 Low;
    Vec3 High;
    std::int32_t First; // of triangles in Order; of inner nodes the second child
    std::int32_t Count; // 0: an inner node, whose first child follows it
  };

  void Build(std::int32_t first, std::int32_t last);

  const ClosedMesh& Mesh;
  std::vector<std::int32_t> Order;
  std::vector<Node> Nodes;
};
}
#endif
