// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The part of its images that a probe sees, in the pixels of tracked slices. Not a part of the
/// module's interface.
#ifndef lacunaSliceFan_h
#define lacunaSliceFan_h

#include "lacunaFan.h"
#include "lacunaSliceImage.h"

#include <array>
#include <string>
#include <vector>

class vtkLacunaSliceAlgorithm;

namespace lacuna
{
/// A sector, or just a rectangle, in pixels of the original slices.
struct SliceFan
{
  /// How the pixels of slices' windows are counted in the original slices.
  struct Window
  {
    Vec2 Origin{ 0, 0 }; ///< column and row of the window's first pixel
    Vec2 Step{ 1, 1 };   ///< from pixel to pixel
    /// (column, row, 0, 1) in the window to those in the original slice.
    Matrix4 GetMatrix() const;
  };

  /// Origin in pixels of the original slices, angles in degrees, radii in mm; no fan when the radii
  /// are 0.
  Fan Sector;
  /// First column and row, width and height; 0 to the edge.
  std::array<int, 4> Clip{ 0, 0, 0, 0 };

  bool HasSector() const { return this->Sector.Radii[0] != 0 || this->Sector.Radii[1] != 0; }
  /// "FanOrigin=... FanAngles=... FanRadii=... ClipRectangle=...", as the properties would have it.
  std::string Describe() const;

  /// That of the properties of filter; without its ClipRectangle.
  static SliceFan Make(vtkLacunaSliceAlgorithm* filter);

  /// Finds it in the pixels of slices; its numbers are rounded so that they can be copied. Throws
  /// std::exception with a text for the user when it cannot be found for certain.
  static SliceFan Detect(const std::vector<SliceImage>& slices, const Window& window);

  /// Gives slices the fan, and cuts their windows to the box around it. slices: all windows are one
  /// window of the original slices. Returns the new window; the poses are still those of the old
  /// one. Throws std::exception when the fan does not meet it.
  Window Apply(const std::vector<SliceImage*>& slices, const Window& window) const;
};
}
#endif
