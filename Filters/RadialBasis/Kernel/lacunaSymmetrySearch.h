// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The plane in which data agree best with their mirror image, from coarse to fine.
#ifndef lacunaSymmetrySearch_h
#define lacunaSymmetrySearch_h

#include "lacunaExecution.h"
#include "lacunaMirrorPlane.h"

#include <array>
#include <memory>
#include <vector>

namespace lacuna
{
/// The equations of one step towards the least cost. Unknowns: turns of the normal (radians) towards
/// two directions, and a shift (mm).
struct SymmetryEquations
{
  double Count = 0; ///< pairs
  double Cost = 0;  ///< sum of the losses of all pairs, each 0..1
  std::array<double, 6> Matrix{ { 0, 0, 0, 0, 0, 0 } }; ///< upper triangle by rows
  std::array<double, 3> Right{ { 0, 0, 0 } };

  /// A pair with a residual, its derivatives by the unknowns, and the residual (> 0) from which pairs
  /// do not count at all (Tukey's biweight).
  void Add(double residual, const std::array<double, 3>& slopes, double limit);
  SymmetryEquations& operator+=(const SymmetryEquations& other);
};

/// The data at one resolution. Lengths in mm, in coordinates of its own.
class SymmetryLevel
{
public:
  virtual ~SymmetryLevel() = default;

  /// How far the data agree, 1 = perfectly; -1 where too little of the data has a counterpart.
  virtual double Rate(const MirrorPlane& plane) const = 0;
  /// Residuals of some pairs: from 0 for equal ones.
  virtual std::vector<double> GetResiduals(
    const MirrorPlane& plane, Execution& execution) const = 0;
  /// turns: directions in which the normal can turn, unit, perpendicular to it and to one another.
  virtual SymmetryEquations Linearize(const MirrorPlane& plane, const std::array<Vec3, 2>& turns,
    double limit, Execution& execution) const = 0;

  double CellSize = 0; ///< smallest
  Vec3 Center{ 0, 0, 0 };
  Vec3 HalfSize{ 0, 0, 0 }; ///< of the box around the data
  double CellResidual = 1;  ///< residual of a strong edge that is out of place by a cell
};

struct SymmetryResult
{
  MirrorPlane Plane;
  double Rating = 0; ///< of Plane at the third level (or the last), see SymmetryLevel::Rate
  /// What Rating lacks to 1, divided by what the rating of the best other plane lacks (other by more
  /// than 10 degrees or 5 % of the size): 0.5 when the other one is twice as asymmetric; towards 1 it
  /// is chance which of both was chosen. 0: there is no other.
  double Ambiguity = 0;
};

/// Evenly spread over half the sphere.
std::vector<Vec3> HemisphereDirections(int count);
/// Evenly spread over half the circle perpendicular to an axis of the coordinate system.
std::vector<Vec3> RingDirections(int axis, int count);

/// Rates planes with the normals in directions, at all offsets, at the first level (the coarsest);
/// improves the best ones at the first three by robust least squares, and the best of those at the
/// last. Throws std::runtime_error when no plane mirrors enough of the data onto
/// data.
SymmetryResult FindSymmetryPlane(const std::vector<std::unique_ptr<SymmetryLevel>>& levels,
  const std::vector<Vec3>& directions, Execution& execution);
}
#endif
