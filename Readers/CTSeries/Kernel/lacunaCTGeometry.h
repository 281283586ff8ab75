// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Where the images of a series lie, and the grid of voxels made of them.
#ifndef lacunaCTGeometry_h
#define lacunaCTGeometry_h

#include "lacunaCTFrame.h"
#include "lacunaProperties.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace lacuna
{
/// Planes at First + k * Spacing, 0 <= k < Planes, in mm along the normal.
struct SliceSpacing
{
  double First = 0;
  double Spacing = 1;
  double Usual = 1; ///< distance from slice to slice; Spacing is this, unless gaps are unequal
  std::int64_t Planes = 1;
  double Tolerance = 0;              ///< how far from its plane a slice may lie
  double Deviation = 0;              ///< how far the slices on planes do lie from them, at most
  std::vector<std::int64_t> Missing; ///< planes without a slice, between slices that lie on planes
  /// Gap i is that between slices i and i + 1. These are no multiples of Usual.
  std::vector<std::size_t> UnequalGaps;

  double GetPosition(std::int64_t plane) const
  {
    return this->First + static_cast<double>(plane) * this->Spacing;
  }
};

/// positions: of at least two slices, ascending, no two within tolerance (mm). The usual distance is
/// the smallest distance from slice to slice that is frequent (a tenth of all, at least three), else
/// the median. Planes are at that distance where all slices lie on them within tolerance (at most a
/// quarter of the spacing). Else they are at the largest of its parts (a half to a fifth) of which
/// that is true. In both cases First and Spacing are the best fit. Where there is none, the first
/// and the last plane are the first and the last slice, at nearly the usual distance. Throws
/// std::runtime_error when there were more than a million planes.
SliceSpacing FindSliceSpacing(const std::vector<double>& positions, double tolerance);

struct CTGeometryOptions
{
  static constexpr ValueRange ToleranceRange = ValueRange::Between(1e-6, 10, "mm");

  /// Whether missing and displaced slices are interpolated; else they are an error.
  bool InterpolateMissing = false;
  /// Whether a tilted gantry is corrected; else it is an error.
  bool CorrectTilt = true;
  /// How far slices may lie from equal spacing or from a straight row, mm; for spacing
  /// and for images at one position at most a quarter of the usual distance of slices.
  double PositionTolerance = 0.05;
  /// Whether two images at one position show the same; then the second is left out. When it is
  /// empty, they never do.
  std::function<bool(const CTFrame&, const CTFrame&)> SameImage;
};

/// An image and where its pixel (0, 0) lies in the grid.
struct CTSlice
{
  CTFrame Frame;
  double Position = 0;    ///< mm along the normal, from the origin of patient coordinates
  double ColumnShift = 0; ///< column of the grid, not whole when the gantry was tilted
  double RowShift = 0;    ///< row of the grid
};

/// A plane of the grid: (1 - Weight) * slice First + Weight * slice Second.
struct CTPlane
{
  std::size_t First = 0;
  std::size_t Second = 0;
  double Weight = 0;
};

/// A right-handed grid in patient coordinates (LPS, mm).
struct CTGeometry
{
  std::int64_t Columns = 0;
  std::int64_t Rows = 0;
  std::int64_t FrameColumns = 0; ///< of one image; the grid has more when the gantry was tilted
  std::int64_t FrameRows = 0;
  Vec3 Origin{}; ///< centre of voxel (0, 0, 0)
  /// Unit vectors of growing column, row and plane; the third is the cross product of the first two.
  std::array<Vec3, 3> Axes{};
  Vec3 Spacing{};
  std::vector<CTSlice> Slices; ///< by position
  std::vector<CTPlane> Planes;
  std::vector<int> Interpolated; ///< planes that are not a measured slice
  double TiltDegrees = 0;        ///< between the normal and the row of slices; 0 within tolerance
  std::vector<std::string> Notes;
  std::vector<std::string> Warnings;
};

/// Sorts the images by position along their normal and finds the grid. The frames have passed
/// CheckSameVolume. The planes are parallel to the images, so correcting a tilt moves pixels only
/// within their image; the grid grows so that none is lost. Throws std::runtime_error naming
/// positions and files, std::invalid_argument for a tolerance out of range.
CTGeometry FindCTGeometry(const std::vector<CTFrame>& frames, const CTGeometryOptions& options);
}
#endif
