// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Outlines and surfaces of which parts are missing, in voxels (Carr 1996, chapter 5).
#ifndef lacunaIncompleteShape_h
#define lacunaIncompleteShape_h

#include "lacunaExecution.h"
#include "lacunaProperties.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lacuna
{
/// A closed curve (Circle, Cavity, Blob; in the xy plane) or surface (Cube, Sphere, Kumara) in a
/// grid of voxels of edge 1 mm, centred in it. The shape fills the grid but for Margin voxels on every
/// side. Object voxels are those whose centres are within half a voxel of it.
class IncompleteShape
{
public:
  enum Kind : int
  {
    Circle, ///< of radius a = (smallest dimension - 1) / 2 - Margin
    Cavity, ///< a disc with a deep bay that opens towards +x
    Blob,   ///< a smooth, irregular outline
    Cube,   ///< faces through voxel centres
    Sphere, ///< of radius a
    Kumara  ///< a bent, tapered ellipsoid with a hollow side (+y), long in x
  };
  static constexpr std::array<const char*, 6> KindNames{ "Circle", "Cavity", "Blob", "Cube",
    "Sphere", "Kumara" };

  struct Parameters
  {
    Kind Shape = Circle;
    std::array<int, 3> Dimensions{ 200, 200, 200 }; ///< curves use the first two
    double PresentFraction = 1;                     ///< of the object voxels
    double GapAngle = 0;        ///< degrees, below 360: none in this wedge or cone about +x
    double TissueFraction = 0;  ///< of the voxels inside: echoes from the interior
    double OutlierFraction = 0; ///< of the present voxels, anywhere in the grid
    bool Patches = false;       ///< missing in patches, not voxel by voxel
    std::array<double, 2> PatchRadii{ 3, 8 }; ///< mm, evenly from the first to the second
    std::uint64_t Seed = 0;

    bool IsFlat() const { return this->Shape <= Blob; }
    void Describe(Properties& properties) const; ///< with the ranges; curves have two Dimensions
  };

  static constexpr int Margin = 12;

  /// Throws std::invalid_argument when a parameter is out of range, with what would be right.
  explicit IncompleteShape(const Parameters& parameters);

  bool IsFlat() const { return this->Values.IsFlat(); }
  /// Voxels in x, y, z; 1 in z for curves.
  const std::array<int, 3>& GetDimensions() const { return this->Dimensions; }

  /// Signed distance in voxels of a point (from the centre of the grid) to the complete shape,
  /// negative inside; exact for Circle, Cube and Sphere, else to first order near the shape.
  double GetDistance(double x, double y, double z) const;

  /// Area (curves) or volume of the complete shape in voxels, to 1e-3 of it.
  double GetContent() const;

  /// 1 for data, 0 for none, x fastest. The same for any number of threads.
  std::vector<unsigned char> Sample(Execution& execution) const;

private:
  class Draws;
  std::array<double, 3> GetPosition(std::int64_t voxel) const; // from the centre of the grid
  // Steps of Sample.
  void AddSurface(std::vector<unsigned char>& voxels, Execution& execution) const;
  // Until no more than so many voxels of the object are there; returns how many.
  std::int64_t RemovePatches(const std::vector<std::int64_t>& object, std::int64_t kept,
    Draws& draws, std::vector<unsigned char>& voxels, Execution& execution) const;
  void AddTissue(std::vector<unsigned char>& voxels, Execution& execution) const;

  Parameters Values;
  std::array<int, 3> Dimensions;
  std::array<double, 3> Half; ///< of the shape's box
};
}
#endif
