// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A slice seen along the parallel rays of an image plane.
#ifndef lacunaSliceProjection_h
#define lacunaSliceProjection_h

#include "lacunaImagePlane.h"
#include "lacunaSliceImage.h"
#include "lacunaVoxelRegion.h" // for IndexInterval

#include <algorithm>
#include <limits>

namespace lacuna
{
/// C + I i + J j, a function of the column i and the row j of a depth map. Always evaluated in this
/// way, so that a pixel's values do not depend on where a walk over the map began.
struct PixelFunction
{
  double C, I, J;

  /// A row's value at column 0.
  double AtRow(std::int64_t j) const { return this->C + this->J * static_cast<double>(j); }
  double At(double atRow, std::int64_t i) const { return atRow + this->I * static_cast<double>(i); }
};

/// Where the rays of a depth map's pixels meet a slice. A ray meets its window between the centres
/// of the outermost pixels, with a millionth of a pixel to spare for rounding.
class SliceProjection
{
public:
  /// A slice whose plane lies at less than this angle to the rays is seen edge-on: an error of its
  /// pose across its plane would be over 57 times as large along the rays.
  static constexpr double SmallestAngle = 1; // degree

  /// True when slice is seen edge-on; it has no projection then.
  static bool IsEdgeOn(const SliceImage& slice, const ImagePlane& plane);

  /// slice must be usable (CheckSlice) and not edge-on. Refers to its pixels.
  SliceProjection(const SliceImage& slice, const ImagePlane& plane);

  /// mm along the ray of a pixel to the slice's plane.
  const PixelFunction& GetDepth() const { return this->Depth; }

  /// The columns of row j whose rays meet the slice's window, cut to columns.
  IndexInterval GetRow(std::int64_t j, IndexInterval columns) const;
  /// True when the ray of one pixel meets the slice: its window, and its fan if it has one.
  bool Meets(std::int64_t i, std::int64_t j) const
  {
    const double column = this->Column.At(this->Column.AtRow(j), i);
    const double row = this->Row.At(this->Row.AtRow(j), i);
    return column >= -Tolerance && column <= this->LastColumn + Tolerance && row >= -Tolerance &&
      row <= this->LastRow + Tolerance &&
      (!this->Slice.Fan ||
        this->Slice.Fan->Contains(
          std::clamp(column, 0.0, this->LastColumn), std::clamp(row, 0.0, this->LastRow)));
  }

  const SliceImage& GetSlice() const { return this->Slice; }
  /// The same pixels at another place in memory.
  void SetPixels(const void* pixels) { this->Slice.Pixels = pixels; }

  /// Grey levels at the rays of one row of the map, interpolated bilinearly. Keeps copies of all
  /// that it needs, so that a loop over pixels has it in registers.
  template <class T>
  class RowSampler
  {
  public:
    RowSampler(const SliceProjection& projection, std::int64_t j)
      : Pixels(static_cast<const T*>(projection.Slice.Pixels))
      , RowStride(projection.Slice.RowStride)
      , Column{ projection.Column.AtRow(j), projection.Column.I, projection.LastColumn,
        projection.Slice.Width - 2 }
      , Row{ projection.Row.AtRow(j), projection.Row.I, projection.LastRow,
        projection.Slice.Height - 2 }
    {
    }

    /// Of a pixel whose ray meets the window of a slice without a fan. Not finite when a grey level
    /// that it needs is not.
    double operator()(std::int64_t i) const
    {
      const Place column = this->Column.At(i);
      const Place row = this->Row.At(i);
      const T* upper = this->Pixels + row.Start * this->RowStride + column.Start;
      const T* lower = upper + this->RowStride;
      return Mix(
        Mix(upper[0], upper[1], column.Rest), Mix(lower[0], lower[1], column.Rest), row.Rest);
    }

    /// The same for a slice with a fan; from the pixels in the fan alone. NaN when the ray does not
    /// meet the fan, or meets a tip of it between the pixels.
    double InFan(std::int64_t i, const FanMask& fan) const
    {
      const Place column = this->Column.At(i);
      const Place row = this->Row.At(i);
      double sum = 0;
      double weights = 0;
      int inside = 0;
      const int corners = fan.Contains(column.Whole, row.Whole) ? 4 : 0;
      for (int corner = 0; corner < corners; ++corner)
      {
        const int x = corner & 1;
        const int y = corner >> 1;
        if (fan.Contains(column.Start + x, row.Start + y))
        {
          const double weight = (x ? column.Rest : 1 - column.Rest) * (y ? row.Rest : 1 - row.Rest);
          const T* pixel = this->Pixels + (row.Start + y) * this->RowStride + column.Start + x;
          sum += weight * static_cast<double>(*pixel);
          weights += weight;
          ++inside;
        }
      }
      return inside == 4 ? (*this)(i)
        : weights > 0    ? sum / weights
                         : std::numeric_limits<double>::quiet_NaN();
    }

  private:
    /// A coordinate: the pixel before it and the way from there to the next one, 0 to 1.
    struct Place
    {
      double Whole;
      int Start;
      double Rest;
    };
    struct Coordinate
    {
      double AtRow, Step, Last;
      int LastStart;

      Place At(std::int64_t i) const
      {
        const double x =
          std::clamp(this->AtRow + this->Step * static_cast<double>(i), 0.0, this->Last);
        const int start = std::min(static_cast<int>(x), this->LastStart);
        return { x, start, x - start };
      }
    };

    template <class U>
    static double Mix(U a, U b, double t)
    {
      return static_cast<double>(a) + t * (static_cast<double>(b) - static_cast<double>(a));
    }

    const T* Pixels;
    std::int64_t RowStride;
    Coordinate Column, Row;
  };

private:
  static constexpr double Tolerance = 1e-6; // pixels

  SliceImage Slice;
  PixelFunction Column, Row; ///< pixels of the slice
  PixelFunction Depth;       ///< mm
  double LastColumn, LastRow;
};
}
#endif
