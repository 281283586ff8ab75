// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where the pixels of a depth map lie in the world.
#ifndef lacunaImagePlane_h
#define lacunaImagePlane_h

#include "lacunaMatrix4.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lacuna
{
/// How data are looked at (parallel projection).
struct ViewSettings
{
  Vec3 Direction{ 0, 0, -1 }; ///< the way the viewer looks, any length
  Vec3 Up{ 0, 1, 0 };         ///< shown upwards; need not be perpendicular to Direction
  bool HasFocalPoint = false;
  /// What is shown in the middle of the image. Without it, the middle of the data.
  Vec3 FocalPoint{ 0, 0, 0 };
  bool HasPlaneOrigin = false;
  /// A point of the image plane, where depth is 0. Without it the plane goes through the corner of
  /// the data nearest the viewer, so that no depth is negative.
  Vec3 PlaneOrigin{ 0, 0, 0 };
  double PixelSpacing = 0;             ///< mm; 0 = the finest spacing of the data
  std::array<int, 2> Size{ { 0, 0 } }; ///< columns, rows; 0 = as many as show all data
};

/// The pixels of a depth map: W columns along Right, H rows along Down, (0,0) top left. Right, Down
/// and View are orthonormal and right-handed.
struct ImagePlane
{
  Vec3 Origin; ///< pixel (0,0), world mm
  Vec3 Right;
  Vec3 Down;
  Vec3 View;
  double PixelSpacing; ///< mm
  std::array<int, 2> Size;

  Vec3 PixelPosition(int column, int row) const
  {
    return this->Origin + (column * this->PixelSpacing) * this->Right +
      (row * this->PixelSpacing) * this->Down;
  }
};

/// Where a part of a depth map goes. Arrays are row-major over the extent.
struct DepthPixels
{
  std::array<int, 4> Extent; ///< first and last column, first and last row
  double* Depth;             ///< mm; NaN where nothing is hit
  char* Valid;               ///< 1 where Depth is a number; may be null
  float* Normals;            ///< x 3, 0 where nothing is hit; may be null
};

/// More pixels than this are refused: 2^28, a map of 16384 x 16384 and of 5.6 GB.
constexpr std::int64_t MaximumNumberOfPixels = std::int64_t(1) << 28;

/// The plane for looking at data within the convex hull of points (at least one), whose samples are
/// finestSpacing mm apart where they are closest. An image that fits the data has its first pixels
/// on their edge; one with a focal point has an odd number of pixels along each axis that it fits
/// to the data, the middle one on the focal point. An image of a given size is centred on the focal
/// point or on the data. Throws std::invalid_argument for what cannot be seen: a zero direction, Up
/// along Direction, a spacing or size that is negative, not finite or too large.
ImagePlane MakeImagePlane(
  const std::vector<Vec3>& points, double finestSpacing, const ViewSettings& view);
}
#endif
