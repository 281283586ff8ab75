// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A ray in index coordinates, the part of it to follow, and the rays of all pixels of a map.
#ifndef lacunaRay_h
#define lacunaRay_h

#include "lacunaVector.h"

#include <array>
#include <limits>

namespace lacuna
{
/// The part of a ray to follow.
struct RaySpan
{
  double First = -std::numeric_limits<double>::infinity();
  double Last = std::numeric_limits<double>::infinity();
};

/// The line A + t B in index coordinates.
struct Ray
{
  Vec3 A;
  Vec3 B;
};

/// Where a ray passes into the solid.
struct RayEntry
{
  double T;
  Vec3 Gradient; ///< of the field towards the solid, per voxel step
};

/// The part of a ray within a volume, between the centres of the outermost voxels; false when there
/// is none. A line in a face of the volume may miss it by rounding only: the faces' tolerance counts
/// for the axes along which the line stands still.
bool ClipToVolume(const Ray& ray, const std::array<int, 3>& size, RaySpan& span);

/// How much further than the volume those axes reach, voxels.
constexpr double FaceTolerance = 1e-10;
/// A ray that moves less than this along an axis, in voxels, stands still.
constexpr double NoMove = 1e-6;

/// The rays of the pixels of an image, whose lines depend linearly on the column and the row: in a
/// parallel projection all have the same B, in a perspective one the same A.
struct RayGrid
{
  Ray First;     ///< of column 0, row 0
  Ray PerColumn; ///< what a column adds
  Ray PerRow;    ///< and a row
  bool Parallel;

  Ray Get(int column, int row) const
  {
    return { (this->First.A + row * this->PerRow.A) + column * this->PerColumn.A,
      (this->First.B + row * this->PerRow.B) + column * this->PerColumn.B };
  }
};
}
#endif
