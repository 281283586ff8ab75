// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A volume made of slices, slice by slice (Carr 1996, 4.2).
#ifndef lacunaSweptVolume_h
#define lacunaSweptVolume_h

#include "lacunaExecution.h"
#include "lacunaProperties.h"
#include "lacunaSampledSlice.h"
#include "lacunaSliceFingerprint.h"
#include "lacunaSliceImage.h"
#include "lacunaVolumeGrid.h"
#include "lacunaVoxelBlock.h"

#include <array>
#include <cstdint>
#include <memory>
#include <variant>
#include <vector>

namespace lacuna
{
class SlicePair;

/// Collects slices in the voxels of a grid, or of a part of it. Slices may be given all at once or
/// one by one: each pair of consecutive slices of a sweep touches only the voxels between the two.
/// The result is the same bit by bit, also for any number of threads and for any part of the grid.
class SweptVolume
{
public:
  enum class Method
  {
    /// Voxels between consecutive slices interpolate between the feet of their perpendiculars:
    /// V = (a X_second + b X_first) / (a + b), a and b the distances from the first and the second
    /// slice, X the grey levels at the feet. See lacunaSlicePair.h for what between means.
    BetweenSlices,
    /// Each pixel goes to the voxel in which its centre lies; nothing is interpolated.
    NearestVoxel
  };
  static constexpr std::array<const char*, 2> MethodNames{ "BetweenSlices", "NearestVoxel" };
  static constexpr ValueRange FootprintScaleRange = ValueRange::Above(0, "voxels");
  struct Options
  {
    Method Interpolation = Method::BetweenSlices;
    PixelSampling Sampling = PixelSampling::Footprint; ///< BetweenSlices only
    Compounding Compound = Compounding::Mean;
    /// Width of footprints in voxels, in FootprintScaleRange. More than 1 averages noise away, and detail.
    double FootprintScale = 1;
    /// Footprints have a height too, FootprintScale voxels along the slices' normals: voxels become
    /// the mean over this way of the grey levels that are interpolated between all slices it meets.
    /// Without it, each voxel sees the two slices next to it alone, also where slices are closer
    /// than voxels. The same voxels are filled. BetweenSlices of footprints and their mean only.
    bool FootprintAcrossSlices = false;
    /// mm; voxels at which two slices are further apart stay empty. 0 = no limit. BetweenSlices
    /// only.
    double MaximumSliceGap = 0;
    /// Collect in double; float is enough for 8 and 16 bit and for float grey levels.
    bool DoublePrecision = false;
  };

  /// extent: first and last voxel along x, y, z, of the part of grid to fill.
  /// Throws std::invalid_argument when it is not inside the grid or FootprintScale is out of range,
  /// std::bad_alloc without memory.
  SweptVolume(const VolumeGrid& grid, const std::array<int, 6>& extent, const Options& options);
  ~SweptVolume();
  SweptVolume(const SweptVolume&) = delete;
  SweptVolume& operator=(const SweptVolume&) = delete;

  /// Memory that this class takes per voxel.
  static std::int64_t GetBytesPerVoxel(const Options& options);

  /// The next slice starts a new sweep: it forms no pair with the one before.
  void BeginSweep();

  /// Adds slices in the order of the sweep, or of several ones, which their BeginsSweep tells apart. The pixels are not needed any more when it returns.
  /// Progress covers first..last of the whole. Throws std::invalid_argument for unusable slices
  /// (none is added then), Aborted when stopped (the volume is then to be thrown away).
  void AddSlices(
    const std::vector<SliceImage>& slices, Execution& execution, double first = 0, double last = 1);

  /// Pairs of consecutive slices so far, and those among them between which nothing was filled
  /// because they lie in the same plane or are turned by 90 degrees or more against each other.
  struct PairCounts
  {
    std::int64_t All = 0;
    std::int64_t Coincident = 0;
    std::int64_t Turned = 0;
  };
  const PairCounts& GetPairCounts() const { return this->Counts; }

  /// Writes the present state, x fastest: intensity (T is any arithmetic type; rounded once and cut
  /// to the range of T when T is an integer; 0 where nothing contributed), contributions (how many
  /// samples made a voxel) and mask (1 where there are any, else 0). A voxel whose grey level is not
  /// finite, because it needs pixels that are not or is beyond the range of T, is written as if
  /// nothing contributed. Returns the number of these.
  template <class T>
  std::int64_t Write(
    T* intensity, unsigned int* contributions, char* mask, Execution& execution) const;

private:
  void AddPairs(
    const std::vector<SliceImage>& slices, Execution& execution, double first, double last);
  void AddPixels(
    const std::vector<SliceImage>& slices, Execution& execution, double first, double last);
  void Fill(const std::vector<SlicePair>& pairs, Execution& execution);
  void FillLayer(const std::vector<SlicePair>& pairs, std::int64_t k);

  VolumeGrid Grid;
  std::array<int, 6> Extent;
  Options Settings;
  std::variant<VoxelBlock<Voxel<float>>, VoxelBlock<Voxel<double>>,
    VoxelBlock<WeightedVoxel<float>>, VoxelBlock<WeightedVoxel<double>>>
    Voxels;
  std::unique_ptr<SampledSlice> Previous; ///< of this sweep, with pixels of its own
  PairCounts Counts;
};

/// A swept volume that is asked for again and again. When the slices are those of the last time and
/// some more at the end of the last sweep (or new sweeps), and grid, extent and options are the
/// same, only what is new is added to the volume of the last time. Else it is made anew. The result
/// is the same bit by bit in either case.
///
/// Slices are the same when their poses, windows, types and fans are equal, number by number, and
/// the hashes of their pixels are (lacunaSliceFingerprint.h). Neither addresses nor times of
/// modification are trusted: sources reuse their memory, and copy it.
///
/// A volume is kept, and pixels are hashed, only if growth is expected, or when the slices grew for
/// the first time: so what does not grow costs neither memory nor time.
class GrowingVolume
{
public:
  /// The slices of each sweep, in order.
  using Sweeps = std::vector<const std::vector<SliceImage>*>;

  /// Brings the volume up to date. isGrowing: growth is expected. Pixels are not needed any more
  /// when it returns. Progress covers first..last of the whole. Throws what SweptVolume throws;
  /// nothing is kept then. The result is valid until the next call of any method.
  const SweptVolume& Update(const Sweeps& sweeps, const VolumeGrid& grid,
    const std::array<int, 6>& extent, const SweptVolume::Options& options, bool isGrowing,
    Execution& execution, double first = 0, double last = 1);

  /// Slices that the last update worked on: the new ones, or all.
  std::int64_t GetNumberOfSlicesAdded() const { return this->Added; }

  /// What is kept, which the next update uses or frees before it needs more.
  double GetBytes() const;

  /// Frees the volume, unless it is to be kept. Call it when the volume is written.
  void Finish();

private:
  struct Record
  {
    std::size_t Sweep = 0;
    SliceFingerprint Slice; ///< with its pixels when IsKept
  };
  static std::vector<Record> MakeRecords(const Sweeps& sweeps);
  bool HasPixelsOf(const std::vector<const SliceImage*>& slices, Execution& execution) const;

  std::unique_ptr<SweptVolume> Volume;
  std::vector<Record> Records; ///< of the slices in the volume, or of the last time
  bool IsKept = false;
  VolumeGrid Grid;
  std::array<int, 6> Extent{};
  SweptVolume::Options Options;
  std::int64_t Added = 0;
};
}
#endif
