// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Neighbours of points, and normals estimated from them.
#ifndef lacunaPointNormals_h
#define lacunaPointNormals_h

#include "lacunaVector.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace lacuna
{
class Execution;

/// Finds the nearest of many points (a k-d tree).
class PointNeighbors
{
public:
  /// Keeps a reference to the points. Throws std::invalid_argument when there are none.
  explicit PointNeighbors(const std::vector<Vec3>& points);
  ~PointNeighbors();
  /// Indices of the nearest points, the nearest first; at most so many as there are. distances, if
  /// not null, in mm.
  void Find(const Vec3& x, std::size_t count, std::vector<std::size_t>& indices,
    std::vector<double>* distances = nullptr) const;
  double GetDistance(const Vec3& x) const; ///< from the nearest, mm

private:
  class Tree;
  std::unique_ptr<Tree> Search;
};

/// Edge of the squares that points would take each, if they were spread evenly over their surface, mm
/// (the median over the points); 0 when more than half of them repeat others.
double FindPointSpacing(Execution& execution, const std::vector<Vec3>& points);

struct PointNormals
{
  std::vector<Vec3> Normals; ///< unit
  std::int64_t Parts = 0;    ///< of points that neighbours connect, each oriented for itself
  /// Pairs of neighbours on one sheet whose normals still disagree: the surface has one side only,
  /// or sheets come closer than points. Where the first of them are, mm.
  std::int64_t Conflicts = 0;
  Vec3 ConflictAt{};
  /// Points whose neighbours lie on a line, so that their normals are arbitrary.
  std::int64_t Linear = 0;
  Vec3 LinearAt{};
};

/// Normals of points that have none: across the plane through the nearest points (Hoppe et al. 1992),
/// with signs that spread over a spanning tree of the neighbours, along the surface first. Each part
/// has its normals outwards where it is seen from outside. Parts within a closed part are turned
/// inwards: they are cavities.
///
/// Throws std::invalid_argument for fewer than 10 points, or all on one line.
PointNormals EstimateNormals(
  Execution& execution, const std::vector<Vec3>& points, std::size_t neighbors = 16);

/// A pair of points that are nearer than spacing and whose given normals are nearly opposite. Returns
/// how many points have such a neighbour; at is one of them, mm.
std::int64_t FindOpposedNormals(Execution& execution, const std::vector<Vec3>& points,
  const std::vector<Vec3>& normals, double spacing, Vec3& at);
}
#endif
