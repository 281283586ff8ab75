// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A planned cut through a skull: what is taken out, and a guide for the saw.
#ifndef lacunaSkullResection_h
#define lacunaSkullResection_h

#include "lacunaExecution.h"
#include "lacunaImplantEdge.h"
#include "lacunaMatrix4.h"
#include "lacunaPlanarCurves.h"
#include "lacunaProperties.h"
#include "lacunaSkullImplant.h"
#include "lacunaVector.h"
#include "lacunaVoxelVolume.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace lacuna
{
struct ResectionOptions
{
  double Level = 300;          ///< grey level of bone
  double Bevel = 10;           ///< degrees: the cut opens outwards
  double GuideWidth = 10;      ///< mm; 0: no guide, for which SkullResection needs another value
  double GuideHeight = 5;      ///< mm, along the direction of the cut
  double GuideClearance = 0.2; ///< mm, between guide and bone
  double GuideHole = 1.5;      ///< mm, diameter of four holes for screws; 0: none

  void Describe(Properties& properties) const; ///< with the ranges, but for Level
};

/// Throws std::invalid_argument that names an option out of range.
void CheckResectionOptions(const ResectionOptions& options);

/// Margins are wider than points all over a tumour are apart.
constexpr ValueRange ResectionMargins = ValueRange::Between(1, 50, "mm");

/// A closed curve around points (world mm) such as those all over a tumour, at most 1 mm apart, margin mm away from them as
/// seen from outside: from the mean of bone through their middle. It is as high as the highest point. Throws
/// std::invalid_argument for no points, points around the middle of the head, parts that are farther apart than twice
/// the margin, and a margin that is none of ResectionMargins.
std::vector<Vec3> FindOutlineAround(
  const std::vector<Vec3>& points, double margin, const Vec3& middleOfBone);

/// The cut along a closed curve: a wall that leans by the bevel from the direction of the cut, through the curve on the
/// outer table.
class SkullResection
{
public:
  /// outline: world mm, on the skull or above it; it is moved onto the outer table along the direction of the cut. That is
  /// square to the plane that is nearest to the curve. Keeps a reference to volume. Throws std::invalid_argument for
  /// fewer than three points, a curve that crosses itself as seen along the direction, and std::runtime_error where no
  /// bone is below most of the curve.
  SkullResection(const VoxelVolume& volume, const std::vector<Vec3>& outline,
    const Vec3& middleOfBone, const ResectionOptions& options, Execution& execution);

  const std::vector<Vec3>& GetOutline() const { return this->Outline; } ///< on the outer table
  const Vec3& GetDirection() const { return this->Direction; }          ///< unit, inwards
  /// mm across the cut's wall, positive in what is cut out; large and negative far from the outer table.
  double GetInside(const Vec3& x) const;

  /// Values of the volume after the cut (kept), and of what is cut out alone. Both have the volume's type and as many
  /// voxels. The walls are where values cross the level.
  void Cut(void* kept, void* piece, Execution& execution) const;

  /// A ring on the outer table around the cut, whose inner wall goes on with the cut's. Throws std::runtime_error when the
  /// scan has no room for it.
  SkullImplant MakeGuide(Execution& execution) const;
  const std::vector<std::string>& GetWarnings() const { return this->Warnings; }

private:
  struct Wall
  {
    double Distance; ///< mm across the direction, positive inside
    double Height;   ///< of the nearest point of the outline
  };
  Wall FindWall(const Vec2& p) const;
  Vec2 ToPlane(const Vec3& x) const { return { Dot(x, this->U), Dot(x, this->V) }; }
  double HeightOf(const Vec3& x) const { return -Dot(x, this->Direction); }
  Vec3 ToWorld(const Vec2& p, double height) const
  {
    return p[0] * this->U + p[1] * this->V - height * this->Direction;
  }
  void FindTable(Execution& execution);
  // By how much bone along the wall is brighter than the level, or nearly all of it. So the wall is where it should be
  // between voxels of any brightness.
  template <class Sampler>
  double FindContrast(const Sampler& sample) const;
  double GetTable(const Vec2& p) const; // height of the outer table; NaN without bone
  double SmoothTable(std::int64_t i, std::int64_t j, double radius, bool isHighest) const;
  // Steps of MakeGuide.
  struct Guide;
  void FindFaces(Guide& guide, Execution& execution) const;
  void FindSupport(Guide& guide) const;
  void FindWalls(Guide& guide) const;
  Loop FindInnerWall(const Guide& guide, double depth) const;
  int AddScrewHoles(Guide& guide) const; // returns for how many there is room

  const VoxelVolume& Volume;
  ResectionOptions Options;
  double Slope; // tangent of the bevel
  Vec3 Direction{ 0, 0, 0 };
  Vec3 U{ 0, 0, 0 };
  Vec3 V{ 0, 0, 0 };
  double Top = 0; // height from where bone is looked for
  std::vector<Vec3> Outline;
  Loop Flat; // the same in the plane
  std::vector<double> Heights;
  PlanarGrid Grid;
  std::vector<double> Table; // heights of nodes
  std::vector<std::string> Warnings;
};
}
#endif
