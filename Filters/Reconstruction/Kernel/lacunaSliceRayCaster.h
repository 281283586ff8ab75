// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A depth map made directly of slices, slice by slice (Carr 1996, 4.3).
///
/// The parallel ray of a pixel meets each slice at most once: that gives a sample, a depth and a
/// grey level. The surface lies where the samples, taken in the order of their depths, first turn
/// solid: between the nearest solid sample and the sample of the same sweep just in front of it. No
/// volume is made, and the slices of a sweep may come in any order and orientation.
///
/// A pixel's state is the nearest solid sample, the sample of its sweep just in front of it and the
/// depth of the nearest sample of all. A new slice changes only the pixels whose rays it meets in
/// front of what is solid there. When a new solid sample is in front of the front sample, or of
/// another sweep, then the sample in front of it may be one that was not kept (the nearest sample
/// of all tells whether there can be one): the earlier slices of the sweep are searched once more at
/// this pixel. The depths alone decide there, since all that lies in front of the nearest solid
/// sample is not solid. So this takes some nanoseconds per slice, and the state and the map depend
/// on the slices of each sweep only, bit by bit.
#ifndef lacunaSliceRayCaster_h
#define lacunaSliceRayCaster_h

#include "lacunaExecution.h"
#include "lacunaImagePlane.h"
#include "lacunaSliceImage.h"
#include "lacunaSolidSide.h"
#include "lacunaVoxelRegion.h" // for IndexInterval

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace lacuna
{
/// Smallest and largest finite grey level in the windows of slices, which may become more: each
/// slice is looked at once.
class GreyRange
{
public:
  /// slices: those of the last time, whose pixels are not looked at, and some more.
  void Update(const std::vector<SliceImage>& slices);

  /// False as long as no pixel is finite.
  bool HasLevels() const { return this->Low <= this->High; }
  bool Contains(double level) const { return level >= this->Low && level <= this->High; }
  double GetLow() const { return this->Low; }
  double GetHigh() const { return this->High; }

private:
  std::size_t Seen = 0; ///< slices
  double Low = std::numeric_limits<double>::infinity();
  double High = -std::numeric_limits<double>::infinity();
};

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

/// mm along the rays: how far apart the planes of consecutive slices of a sweep are at most, at the
/// corners of the two; 0 when there are no two. Slices seen edge-on do not count.
double GetWidestStepAlongRays(const std::vector<SliceImage>& slices, const ImagePlane& plane);

/// Rules. A grey level equal to the iso-value is solid. A ray that meets a slice, inside its fan if
/// it has one, samples it bilinearly; samples that are not finite do not exist. Of several samples
/// at the same depth of a ray only the most solid one of a sweep counts, and of solid ones the first
/// sweep's. Slices seen edge-on (SliceProjection::IsEdgeOn) are left out. Nothing was seen between
/// sweeps, which SliceImage::BeginsSweep separates: a solid sample with none of its sweep in front
/// of it is the surface.
class SliceRayCaster
{
public:
  /// extent: first and last column, first and last row of the part of the map that is wanted.
  /// Throws std::invalid_argument when it is not inside the map or isoValue is not a number,
  /// std::runtime_error when memory does not suffice.
  SliceRayCaster(
    const ImagePlane& plane, const std::array<int, 4>& extent, double isoValue, SolidSide side);

  /// Memory that this class takes per pixel.
  static constexpr std::int64_t GetBytesPerPixel()
  {
    return 5 * sizeof(double) + sizeof(std::int32_t);
  }

  /// Adds slices, in the order of their sweeps. Their pixels are referred to as long as there is this object, or until
  /// MoveSlices. Throws std::invalid_argument for unusable slices (none is added then), Aborted
  /// when stopped (this object is then to be thrown away).
  void AddSlices(const std::vector<SliceImage>& slices, Execution& execution);

  /// Says that the pixels of all slices so far, in the order in which they were added, now lie
  /// elsewhere: slices are the same slices, of which only Pixels may differ.
  void MoveSlices(const std::vector<SliceImage>& slices);

  std::int64_t GetNumberOfSlices() const { return this->NumberOfSlices; }
  /// How many of them were left out because they are seen edge-on.
  std::int64_t GetNumberOfEdgeOnSlices() const
  {
    return this->NumberOfSlices - static_cast<std::int64_t>(this->Projections.size());
  }

  /// Writes the depth map as it is now. Where the two samples are further apart than maximumGap mm
  /// (0 = no limit), or nothing lies in front of the solid one, the depth is that of the solid
  /// sample, otherwise the crossing of the iso-value on the straight line between them. Normals
  /// come from the slopes of the depth (lacunaDepthDiscontinuity.h), also across the border of the extent.
  /// pixels.Extent must be the extent of this object.
  void Write(double maximumGap, const DepthPixels& pixels, Execution& execution) const;

private:
  struct Row;

  Row GetRow(std::int64_t j);
  template <class T, bool HasFan>
  bool AddToRow(std::size_t slice, std::int64_t j);
  void FindFronts(std::int64_t j);
  double GetDepth(std::size_t pixel, double maximumGap) const;

  ImagePlane Plane;
  std::array<int, 4> Wanted;
  /// Wanted and one pixel more on each side where the map goes on: normals need the neighbours.
  std::array<int, 4> Extent;
  /// Grey levels times Sign are solid when they are at least Threshold.
  double Sign;
  double Threshold;
  std::int64_t NumberOfSlices = 0;
  std::vector<SliceProjection> Projections; ///< not those seen edge-on
  std::vector<std::int64_t> Numbers;        ///< of their slices
  std::vector<std::int32_t> Sweeps;         ///< of their slices, ascending
  std::int32_t LastSweep = 0;

  // The state of each pixel of Extent; grey levels times Sign.
  std::vector<double> SolidDepth, SolidLevel; ///< the nearest solid sample; NoDepth = none
  std::vector<double> FrontDepth, FrontLevel; ///< the sample just in front of it; -NoDepth = none
  std::vector<std::int32_t> Sweep;            ///< of both
  std::vector<double> NearestDepth;           ///< of all samples in front of or at the solid one
};
}
#endif
