// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Straight motions of a mill joined to arcs and longer straight motions.
#ifndef lacunaArcFit_h
#define lacunaArcFit_h

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace lacuna
{
/// x, y, z in whole micrometres.
using Micrometres = std::array<std::int64_t, 3>;

/// Joins straight motions within an upright plane, x z or y z. What takes their place lies on them or
/// above, so that a tool that does not cut into a surface on its way does not on the new one; deeper
/// by at most LargestMismatch, since centres are whole micrometres.
class ArcFit
{
public:
  struct Motion
  {
    std::size_t Last;   ///< the point where it ends
    bool Straight;      ///< otherwise an arc of less than half a circle
    int Normal;         ///< axis that the plane is upright on: 0 (y z) or 1 (x z)
    bool Upper;         ///< whether the arc is above its centre, or else below
    Micrometres Centre; ///< of the arc
    double Highest;     ///< um, z
  };

  /// points: the path, not owned. tolerance: um by which the new motions may be above the old ones,
  /// along their normal, > 0.
  ArcFit(const std::vector<Micrometres>& points, double tolerance);

  /// The motion that takes the place of as many as possible from points[first] to at most
  /// points[last]: of two for a straight one, three for an arc. No value when there is none.
  std::optional<Motion> Find(std::size_t first, std::size_t last) const;

  /// um, between the arc's radii at its start and its end.
  static constexpr double LargestMismatch = 0.25;

private:
  const std::vector<Micrometres>& Points;
  double Tolerance;
};
}
#endif
