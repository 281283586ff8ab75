// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The part of a slice's image that a curved or rotating probe sees.
///
/// Such a probe sends its beams out from an arc: what it sees is a sector of a ring. The rest of
/// the image is black, or has the machine's texts on it, and must not be mixed into the volume.
#ifndef lacunaFan_h
#define lacunaFan_h

#include "lacunaVector.h"
#include "lacunaVoxelRegion.h"

#include <memory>
#include <vector>

namespace lacuna
{
/// A sector of a ring in a slice's image.
struct Fan
{
  /// Column and row, in pixels of the slice's window, of the point where all beams meet; it may lie
  /// outside of the window.
  Vec2 Origin{ 0, 0 };
  /// Directions of the first and the last beam, degrees: 0 is the depth axis (growing rows), and
  /// they grow towards growing columns, so -30, 30 opens downwards and 90 looks to the right.
  /// At most 360 apart, which is the whole ring.
  Vec2 Angles{ -180, 180 };
  /// Where beams begin and end, mm from Origin in the plane of the slice. Not pixels: those need
  /// not be square.
  Vec2 Radii{ 0, 0 };
};

/// Which pixels and which points between them lie in a fan. Made once for all slices of a sweep.
/// Borders belong to the fan, but for rounding.
class FanMask
{
public:
  /// width, height: of the slice's window, pixels. pixelSpacing: mm from column to column and from
  /// row to row, the lengths of the first two columns of PixelToReference; rows and columns are
  /// taken to be at right angles.
  /// Throws std::invalid_argument when a number is not finite, Angles or Radii are not first <
  /// last, a radius is negative, the opening is over 360 degrees, or no pixel lies in the fan.
  FanMask(const Fan& fan, int width, int height, const Vec2& pixelSpacing);

  int GetWidth() const { return this->Width; }
  int GetHeight() const { return static_cast<int>(this->Rows.size()) - 1; }
  const Fan& GetFan() const { return this->Shape; }
  const Vec2& GetPixelSpacing() const { return this->PixelSpacing; }

  /// True when the point lies in the fan, which does not end where the window does.
  bool Contains(double column, double row) const
  {
    return this->ContainsOffset(this->PixelSpacing[0] * (column - this->Shape.Origin[0]),
      this->PixelSpacing[1] * (row - this->Shape.Origin[1]));
  }
  /// The same for mm along columns and along rows from Origin.
  bool ContainsOffset(double x, double y) const
  {
    const double square = x * x + y * y;
    const double first = x * this->First[0] - y * this->First[1];
    const double last = x * this->Last[0] - y * this->Last[1];
    const bool afterFirst = first >= -this->Tolerance;
    const bool beforeLast = last <= this->Tolerance;
    return square >= this->Squares[0] && square <= this->Squares[1] &&
      (this->IsWide ? afterFirst || beforeLast : afterFirst && beforeLast);
  }

  /// Runs of pixels of a row, in their order, whose centres lie in the fan.
  struct Runs
  {
    const IndexInterval* First;
    const IndexInterval* Last;
    const IndexInterval* begin() const { return this->First; }
    const IndexInterval* end() const { return this->Last; }
  };
  Runs GetRuns(std::int64_t row) const
  {
    return { this->Columns.data() + this->Rows[row], this->Columns.data() + this->Rows[row + 1] };
  }

private:
  Fan Shape;
  int Width;
  Vec2 PixelSpacing;
  double Tolerance; ///< mm
  bool IsWide;      ///< opens by more than 180 degrees
  Vec2 First, Last; ///< cosine and sine of Angles
  Vec2 Squares;     ///< of Radii
  std::vector<IndexInterval> Columns;
  std::vector<std::size_t> Rows; ///< where each row's runs begin in Columns, and the end
};
}
#endif
