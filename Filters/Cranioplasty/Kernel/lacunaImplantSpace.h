// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The space that an implant can fill: between the predicted surfaces of a skull, free of bone, also on the way in.
#ifndef lacunaImplantSpace_h
#define lacunaImplantSpace_h

#include "lacunaBoneDistance.h"
#include "lacunaExecution.h"
#include "lacunaImplantEdge.h"
#include "lacunaMatrix4.h"
#include "lacunaPlanarCurves.h"
#include "lacunaSkullChart.h"
#include "lacunaSkullImplant.h"
#include "lacunaSkullRays.h"
#include "lacunaSkullShape.h"
#include "lacunaVector.h"
#include "lacunaVoxelVolume.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace lacuna
{
/// Bone, and what is beyond two parallel planes: it bounds one part of an implant.
class PartBone : public BoneDistance
{
public:
  /// axis: unit. Free is what is between low and high along it, mm. Keeps a reference to bone.
  PartBone(const BoneDistance& bone, const Vec3& axis, double low, double high);
  NearestBone Find(const Vec3& x, double limit) const override;
  std::array<Vec3, 2> GetBounds() const override { return this->Bone.GetBounds(); }
  double GetDistanceOfCuts(const Vec3& x) const; ///< mm to the nearer plane, positive between them

private:
  const BoneDistance& Bone;
  Vec3 Axis;
  double Low;
  double High;
};

/// Keeps references to all that it is given. Its methods are to be called in their order here.
class ImplantSpace
{
public:
  /// Throws std::runtime_error for a defect that goes around the skull.
  ImplantSpace(const VoxelVolume& volume, const SkullRays& rays, const std::vector<int>& defect,
    const SkullShape& shape, const BoneDistance& bone, const SkullImplantOptions& options,
    Execution& execution);

  /// Outlines of the space that is free of bone, in the chart. Throws std::runtime_error when there is none.
  std::vector<Loop> FindHole();
  /// Moves both surfaces by the offsets of the options, which fade to the rim of the hole.
  void Offset(const std::vector<Loop>& hole);
  /// The outline of the hole that keeps the clearance on the inner surface, without narrow parts. Throws as FindHole does.
  std::vector<Loop> MoveInwards(const std::vector<Loop>& hole);
  /// The way in: as given, or that of the walls of bone along an outline.
  Vec3 ChooseDirection(const std::vector<Loop>& outline) const;
  /// Of each node the least clearance of both surfaces and what is between them, on the way out, without EdgeClearance.
  std::vector<double> FindFreeWays(const InsertionPath& path) const;
  /// Of that, what is between cuts along the way in.
  std::vector<double> FindPart(
    std::vector<double> free, const PartBone& cuts, double clearance) const;
  /// Around nodes with a free way, without narrow parts; empty: nothing is wide enough.
  std::vector<Loop> FindOutline(const std::vector<double>& free);

  const Chart& GetChart() const { return this->Plane; }
  const ImplantSlab& GetSlab() const { return this->Slab; }
  std::vector<Vec3> DirectionsOf(const std::vector<Vec2>& points) const;
  const std::vector<std::string>& GetWarnings() const { return this->Warnings; }

private:
  Vec3 PointAt(const Vec3& direction, double radius) const;
  bool IsInScan(const Vec3& x) const;
  void SetSlab(const std::vector<std::int64_t>& nodes);
  void SetSteps(); // by the slab's thickness
  // Of the rays next to the defect that leave the scan before they come to the skull, mm^2.
  double FindUnknownArea() const;
  // The outline where distances are a limit, without what is narrow (an opening). Empty: nothing is wide.
  std::vector<Loop> WithoutTongues(std::vector<double> distances, double limit);
  std::vector<std::vector<Vec3>> OnInner(const std::vector<Loop>& loops) const;
  // Unit, out of the wall of bone beside a place of the outline; zero where there is none.
  Vec3 FindWall(const Vec2& p, double depth) const;

  const VoxelVolume& Volume;
  Matrix4 WorldToIndex;
  const SkullRays& Rays;
  const SkullShape& Shape;
  const BoneDistance& Bone;
  const SkullImplantOptions& Options;
  Execution& Run;
  Chart Plane;
  std::vector<Vec2> Defect;
  PlanarGrid Grid;
  ImplantSlab Slab;
  std::vector<double> Free; // of each node; positive where no bone is
  // The same: mm from the rim on the inner surface, positive in the hole.
  std::vector<double> FromHole;
  std::vector<std::string> Warnings;
};
}
#endif
