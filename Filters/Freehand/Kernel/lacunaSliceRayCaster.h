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
#include "lacunaSliceProjection.h"
#include "lacunaSolidSide.h"

#include <array>
#include <cstdint>
#include <vector>

namespace lacuna
{
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
