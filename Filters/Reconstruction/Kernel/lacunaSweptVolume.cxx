// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSweptVolume.h"

#include "lacunaSliceImage.h"
#include "lacunaSlicePair.h"
#include "lacunaVolumeGrid.h"
#include "lacunaVoxelBlock.h"
#include "lacunaVoxelFilling.h"
#include "lacunaVoxelRegion.h"
#include "lacunaWide.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tuple>
#include <type_traits>
#include <utility>

namespace lacuna
{
namespace
{
// Pixels put into the voxels in which their centres lie.

// The nearest whole number of one that is at least -0.5 but for a tolerance.
LACUNA_INLINE int RoundPositive(double x)
{
  return static_cast<int>(x + 0.5);
}

// A voxel index along a row of pixels.
struct Line
{
  double Start, Step;
  LACUNA_INLINE double At(double i) const { return this->Start + this->Step * i; }
};

// Pixels that are placed before they are put: in two loops, the first one with vectors.
constexpr int PixelsAtATime = 128;

// Where count pixels from first on lie, rounded.
LACUNA_WIDE void RoundAlong(Line line, int first, int count, std::int32_t* indices)
{
  for (int n = 0; n < count; ++n)
  {
    indices[n] = RoundPositive(line.At(static_cast<double>(first + n)));
  }
}

template <Compounding compounding, class T, class Real>
void PutPixelsOf(const SliceImage& slice, const T* pixels, const VolumeGrid& grid,
  IndexInterval layers, VoxelBlock<Voxel<Real>>& voxels)
{
  const std::array<int, 6>& extent = voxels.GetExtent();
  const std::array<IndexInterval, 3> range{ IndexInterval{ extent[0], extent[1] },
    IndexInterval{ extent[2], extent[3] }, layers };
  // The voxel index along each axis, a function of the pixel's column and row.
  std::array<AffineFunction, 3> index;
  VoxelRegion region; // of pixels
  constexpr double margin = 1e-6;
  for (int a = 0; a < 3; ++a)
  {
    const double scale = 1 / grid.Spacing[a];
    index[a] = { scale * slice.PixelToReference(a, 0), scale * slice.PixelToReference(a, 1), 0,
      scale * (slice.PixelToReference(a, 3) - grid.Origin[a]) };
    region.Add(index[a] + (0.5 + margin - static_cast<double>(range[a].First)));
    region.Add(-index[a] + (0.5 + margin + static_cast<double>(range[a].Last)));
  }
  const VoxelRegion::Layer layer = region.GetLayer(0, { 0, slice.Height - 1 });
  const std::int64_t lineSize = voxels.GetSize(0);
  const std::int64_t layerSize = lineSize * voxels.GetSize(1);
  Voxel<Real>* const data = voxels.GetData();
  const std::int64_t start = extent[4] * layerSize + extent[2] * lineSize + extent[0];
  std::array<std::array<std::int32_t, PixelsAtATime>, 3> v;
  const IndexInterval rows = layer.GetRows();
  for (std::int64_t j = rows.First; j <= rows.Last; ++j)
  {
    const IndexInterval columns = layer.GetRow(j, { 0, slice.Width - 1 });
    const FanMask::Runs runs =
      slice.Fan ? slice.Fan->GetRuns(j) : FanMask::Runs{ &columns, &columns + 1 };
    const T* const line = pixels + slice.RowStride * j;
    std::array<Line, 3> along{};
    for (int a = 0; a < 3; ++a)
    {
      along[a] = { index[a].C + index[a].J * static_cast<double>(j), index[a].I };
    }
    const auto isInside = [&](std::int64_t i)
    {
      bool inside = true;
      for (int a = 0; a < 3; ++a)
      {
        const int v = RoundPositive(along[a].At(static_cast<double>(i)));
        inside &= v >= range[a].First && v <= range[a].Last;
      }
      return inside;
    };
    for (const IndexInterval& run : runs)
    {
      // indices grow or fall along the row: the margin is at its ends
      std::int64_t first = std::max(run.First, columns.First);
      std::int64_t last = std::min(run.Last, columns.Last);
      while (first <= last && !isInside(first))
      {
        ++first;
      }
      while (first <= last && !isInside(last))
      {
        --last;
      }
      while (first <= last)
      {
        const int count = static_cast<int>(std::min<std::int64_t>(last - first + 1, PixelsAtATime));
        for (int a = 0; a < 3; ++a)
        {
          RoundAlong(along[a], static_cast<int>(first), count, v[a].data());
        }
        const T* const pixel = line + first;
        for (int n = 0; n < count; ++n)
        {
          data[v[2][n] * layerSize + v[1][n] * lineSize + v[0][n] - start]
            .template Put<compounding>(static_cast<Real>(pixel[n]));
        }
        first += count;
      }
    }
  }
}

// Adds the pixels of slice whose nearest voxels lie in layers; slice has passed CheckSlice.
template <class Real>
void PutPixels(const SliceImage& slice, const VolumeGrid& grid, IndexInterval layers,
  Compounding compounding, VoxelBlock<Voxel<Real>>& voxels)
{
  DispatchScalars(slice.Type, slice.Pixels,
    [&](const auto* pixels)
    {
      if (compounding == Compounding::Mean)
      {
        PutPixelsOf<Compounding::Mean>(slice, pixels, grid, layers, voxels);
      }
      else
      {
        PutPixelsOf<Compounding::Maximum>(slice, pixels, grid, layers, voxels);
      }
    });
}

//------------------------------------------------------------------------------
// Slices whose rasters of footprint means are held at a time: enough to keep the threads busy.
constexpr std::size_t SlicesAtATime = 16;
// Layers that a thread takes at a time when it places pixels: each time it looks at all slices.
constexpr std::int64_t PixelLayersAtATime = 8;
constexpr const char* MixedFans = "either all slices of a sweep have a fan, or none has";

// Rounds half away from zero and cuts to the range of an integer type.
template <class T>
T Convert(double value)
{
  if constexpr (std::is_integral<T>::value)
  {
    constexpr auto lowest = static_cast<double>(std::numeric_limits<T>::min());
    constexpr auto highest = static_cast<double>(std::numeric_limits<T>::max());
    if (!(value > lowest)) // or not a number
    {
      return std::numeric_limits<T>::min();
    }
    if (!(value < highest))
    {
      return std::numeric_limits<T>::max();
    }
    // from 2^52 on all doubles are whole, and adding a half would round
    constexpr double whole = 4503599627370496;
    const double half = value < 0 ? -0.5 : 0.5;
    return static_cast<T>(value > -whole && value < whole ? value + half : value);
  }
  else
  {
    return static_cast<T>(value);
  }
}

template <class Real>
double GetIntensity(const Voxel<Real>& voxel, Compounding compounding)
{
  const double samples = compounding == Compounding::Mean && voxel.Count > 1 ? voxel.Count : 1;
  return static_cast<double>(voxel.Value) / samples;
}

template <class Real>
double GetIntensity(const WeightedVoxel<Real>& voxel, Compounding)
{
  return voxel.Count > 0 ? static_cast<double>(voxel.Value) / voxel.Weight : 0;
}

template <class T, class VoxelType>
std::int64_t WriteVoxels(const VoxelBlock<VoxelType>& voxels, Compounding compounding, T* intensity,
  unsigned int* contributions, char* mask, Execution& execution)
{
  constexpr std::int64_t grain = 65536;
  std::atomic<std::int64_t> faults{ 0 };
  execution.For(voxels.GetNumberOfVoxels(), grain,
    [&](std::int64_t begin, std::int64_t end)
    {
      std::int64_t own = 0;
      for (std::int64_t i = begin; i < end; ++i)
      {
        const VoxelType& voxel = voxels.GetData()[i];
        const double value = GetIntensity(voxel, compounding);
        const T grey = Convert<T>(value);
        // of integers, the number that they were made of
        const bool isFinite =
          std::is_integral<T>::value ? std::isfinite(value) : std::isfinite(double(grey));
        intensity[i] = isFinite ? grey : T(0);
        contributions[i] = isFinite ? voxel.Count : 0;
        mask[i] = isFinite && voxel.Count > 0 ? 1 : 0;
        own += isFinite ? 0 : 1;
      }
      faults += own;
    });
  return faults;
}

// Footprints that reach across slices collect weighted samples.
bool IsWeighted(const SweptVolume::Options& options)
{
  return options.FootprintAcrossSlices &&
    options.Interpolation == SweptVolume::Method::BetweenSlices &&
    options.Sampling == PixelSampling::Footprint && options.Compound == Compounding::Mean;
}

template <template <class> class VoxelType, class Variant>
void MakeVoxels(const std::array<int, 6>& extent, bool doublePrecision, Variant& voxels)
{
  if (doublePrecision)
  {
    voxels = VoxelBlock<VoxelType<double>>(extent);
  }
  else
  {
    voxels = VoxelBlock<VoxelType<float>>(extent);
  }
}

template <class Real>
void FillPair(const SlicePair& pair, std::int64_t k, const SweptVolume::Options& options,
  VoxelBlock<Voxel<Real>>& voxels)
{
  FillBetween(pair, k, options.Sampling, options.Compound, voxels);
}

template <class Real>
void FillPair(const SlicePair& pair, std::int64_t k, const SweptVolume::Options&,
  VoxelBlock<WeightedVoxel<Real>>& voxels)
{
  FillAcross(pair, k, voxels);
}
}

SweptVolume::SweptVolume(
  const VolumeGrid& grid, const std::array<int, 6>& extent, const Options& options)
  : Grid(grid)
  , Extent(extent)
  , Settings(options)
{
  for (std::size_t a = 0; a < 3; ++a)
  {
    if (extent[2 * a] < 0 || extent[2 * a] > extent[2 * a + 1] ||
      extent[2 * a + 1] >= grid.Dimensions[a])
    {
      throw std::invalid_argument("the requested extent is not a part of the volume");
    }
  }
  SweptVolume::FootprintScaleRange.Check("FootprintScale", options.FootprintScale);
  if (IsWeighted(options))
  {
    MakeVoxels<WeightedVoxel>(extent, options.DoublePrecision, this->Voxels);
  }
  else
  {
    MakeVoxels<Voxel>(extent, options.DoublePrecision, this->Voxels);
  }
}

std::int64_t SweptVolume::GetBytesPerVoxel(const Options& options)
{
  if (IsWeighted(options))
  {
    return options.DoublePrecision ? sizeof(WeightedVoxel<double>) : sizeof(WeightedVoxel<float>);
  }
  return options.DoublePrecision ? sizeof(Voxel<double>) : sizeof(Voxel<float>);
}

SweptVolume::~SweptVolume() = default;

void SweptVolume::BeginSweep()
{
  this->Previous.reset();
}

void SweptVolume::AddSlices(
  const std::vector<SliceImage>& slices, Execution& execution, double first, double last)
{
  for (const SliceImage& slice : slices)
  {
    CheckSlice(slice);
    if (NeedsDoublePrecision(slice.Type) && !this->Settings.DoublePrecision)
    {
      throw std::invalid_argument(slice.Label + ": grey levels of this type need double precision");
    }
    if (slice.Type != slices.front().Type)
    {
      throw std::invalid_argument(
        slice.Label + ": its grey levels are of another type than those of the slices before");
    }
    if (!slice.Fan != !slices.front().Fan)
    {
      throw std::invalid_argument(slice.Label + ": " + MixedFans);
    }
  }
  if (this->Settings.Interpolation == Method::NearestVoxel)
  {
    this->AddPixels(slices, execution, first, last);
  }
  else
  {
    this->AddPairs(slices, execution, first, last);
  }
}

void SweptVolume::AddPairs(
  const std::vector<SliceImage>& slices, Execution& execution, double first, double last)
{
  for (std::size_t begin = 0; begin < slices.size(); begin += SlicesAtATime)
  {
    const std::size_t count = std::min(SlicesAtATime, slices.size() - begin);
    const auto stage = [&](double part)
    {
      return first +
        (last - first) * (static_cast<double>(begin) + part * static_cast<double>(count)) /
        static_cast<double>(slices.size());
    };
    std::vector<SampledSlice> sampled(count);
    const Execution::Body sample = [&](std::int64_t b, std::int64_t e)
    {
      for (std::int64_t n = b; n < e; ++n)
      {
        sampled[n] = SampleSlice(slices[begin + n], this->Grid, this->Settings.Sampling,
          this->Settings.FootprintScale, this->Settings.DoublePrecision);
      }
    };
    if (this->Settings.Sampling == PixelSampling::Footprint && count > 1)
    {
      execution.SetStage(stage(0), stage(0.5));
      execution.For(static_cast<std::int64_t>(count), 1, sample);
    }
    else
    {
      sample(0, static_cast<std::int64_t>(count)); // no work, or too little to share
    }

    std::vector<SlicePair> pairs;
    const SampledSlice* previous = this->Previous.get();
    for (std::size_t n = 0; n < count; ++n)
    {
      const SampledSlice& slice = sampled[n];
      if (previous && !slices[begin + n].BeginsSweep)
      {
        if (!previous->Fan != !slice.Fan)
        {
          throw std::invalid_argument(slice.Label + ": " + MixedFans);
        }
        if (previous->Type != slice.Type)
        {
          throw std::invalid_argument(
            slice.Label + ": its grey levels are of another type than those of the slices before");
        }
        pairs.emplace_back(
          *previous, slice, this->Grid, this->Settings.MaximumSliceGap, IsWeighted(this->Settings));
        ++this->Counts.All;
        const SlicePair::Relation relation = pairs.back().GetRelation();
        this->Counts.Coincident += relation == SlicePair::Relation::Coincident ? 1 : 0;
        this->Counts.Turned += relation == SlicePair::Relation::Turned ? 1 : 0;
      }
      previous = &slice;
    }
    execution.SetStage(stage(0.5), stage(1));
    this->Fill(pairs, execution);

    OwnPixels(sampled.back());
    this->Previous = std::make_unique<SampledSlice>(std::move(sampled.back()));
  }
}

void SweptVolume::Fill(const std::vector<SlicePair>& pairs, Execution& execution)
{
  IndexInterval layers;
  for (const SlicePair& pair : pairs)
  {
    const IndexInterval own = pair.GetLayers();
    if (!own.IsEmpty())
    {
      layers = layers.IsEmpty()
        ? own
        : IndexInterval{ std::min(layers.First, own.First), std::max(layers.Last, own.Last) };
    }
  }
  layers = { std::max<std::int64_t>(layers.First, this->Extent[4]),
    std::min<std::int64_t>(layers.Last, this->Extent[5]) };
  // Each layer belongs to one thread, which visits the pairs in their order: so the sums do not
  // depend on the threads.
  execution.For(layers.Last - layers.First + 1, 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t k = layers.First + begin; k < layers.First + end; ++k)
      {
        this->FillLayer(pairs, k);
      }
    });
}

void SweptVolume::FillLayer(const std::vector<SlicePair>& pairs, std::int64_t k)
{
  for (const SlicePair& pair : pairs)
  {
    if (k >= pair.GetLayers().First && k <= pair.GetLayers().Last)
    {
      std::visit([&](auto& voxels) { FillPair(pair, k, this->Settings, voxels); }, this->Voxels);
    }
  }
}

void SweptVolume::AddPixels(
  const std::vector<SliceImage>& slices, Execution& execution, double first, double last)
{
  execution.SetStage(first, last);
  execution.For(this->Extent[5] - this->Extent[4] + 1, PixelLayersAtATime,
    [&](std::int64_t begin, std::int64_t end)
    {
      const IndexInterval layers{ this->Extent[4] + begin, this->Extent[4] + end - 1 };
      for (const SliceImage& slice : slices)
      {
        if (auto* const floats = std::get_if<VoxelBlock<Voxel<float>>>(&this->Voxels))
        {
          PutPixels(slice, this->Grid, layers, this->Settings.Compound, *floats);
        }
        else if (auto* const doubles = std::get_if<VoxelBlock<Voxel<double>>>(&this->Voxels))
        {
          PutPixels(slice, this->Grid, layers, this->Settings.Compound, *doubles);
        }
      }
    });
}

template <class T>
std::int64_t SweptVolume::Write(
  T* intensity, unsigned int* contributions, char* mask, Execution& execution) const
{
  return std::visit(
    [&](const auto& voxels) {
      return WriteVoxels(
        voxels, this->Settings.Compound, intensity, contributions, mask, execution);
    },
    this->Voxels);
}

// NOLINTBEGIN(bugprone-macro-parentheses): a type
#define LACUNA_INSTANTIATE(T)                                                                      \
  template std::int64_t SweptVolume::Write(T*, unsigned int*, char*, Execution&) const
LACUNA_INSTANTIATE(char);
LACUNA_INSTANTIATE(signed char);
LACUNA_INSTANTIATE(unsigned char);
LACUNA_INSTANTIATE(short);
LACUNA_INSTANTIATE(unsigned short);
LACUNA_INSTANTIATE(int);
LACUNA_INSTANTIATE(unsigned int);
LACUNA_INSTANTIATE(long);
LACUNA_INSTANTIATE(unsigned long);
LACUNA_INSTANTIATE(long long);
LACUNA_INSTANTIATE(unsigned long long);
LACUNA_INSTANTIATE(float);
LACUNA_INSTANTIATE(double);
#undef LACUNA_INSTANTIATE
// NOLINTEND(bugprone-macro-parentheses)

//------------------------------------------------------------------------------
namespace
{
bool AreEqual(const VolumeGrid& a, const VolumeGrid& b)
{
  return a.Origin == b.Origin && a.Spacing == b.Spacing && a.Dimensions == b.Dimensions;
}

// Names every member: one that is added to the options does not compile before it is compared.
auto Tie(const SweptVolume::Options& options)
{
  const auto& [interpolation, sampling, compound, footprintScale, footprintAcrossSlices, gap,
    doublePrecision] = options;
  return std::make_tuple(
    interpolation, sampling, compound, footprintScale, footprintAcrossSlices, gap, doublePrecision);
}

std::vector<const SliceImage*> Flatten(const GrowingVolume::Sweeps& sweeps)
{
  std::vector<const SliceImage*> slices;
  for (const std::vector<SliceImage>* sweep : sweeps)
  {
    for (const SliceImage& slice : *sweep)
    {
      slices.push_back(&slice);
    }
  }
  return slices;
}
}

std::vector<GrowingVolume::Record> GrowingVolume::MakeRecords(const Sweeps& sweeps)
{
  std::vector<Record> records;
  for (std::size_t s = 0; s < sweeps.size(); ++s)
  {
    for (const SliceImage& slice : *sweeps[s])
    {
      records.push_back({ s, SliceFingerprint(slice, false) });
    }
  }
  return records;
}

bool GrowingVolume::HasPixelsOf(
  const std::vector<const SliceImage*>& slices, Execution& execution) const
{
  std::atomic<bool> same{ true };
  execution.For(static_cast<std::int64_t>(this->Records.size()), 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t n = begin; n < end && same; ++n)
      {
        const auto i = static_cast<std::size_t>(n);
        if (!(HashPixels(*slices[i]) == this->Records[i].Slice.Pixels))
        {
          same = false;
        }
      }
    });
  return same;
}

const SweptVolume& GrowingVolume::Update(const Sweeps& sweeps, const VolumeGrid& grid,
  const std::array<int, 6>& extent, const SweptVolume::Options& options, bool isGrowing,
  Execution& execution, double first, double last)
{
  std::vector<Record> records = MakeRecords(sweeps);
  const std::vector<const SliceImage*> slices = Flatten(sweeps);
  const double middle = first + 0.05 * (last - first);
  const std::size_t before = this->Records.size();
  const bool isContinued = before > 0 && before <= records.size() &&
    std::equal(this->Records.begin(), this->Records.end(), records.begin(),
      [](const Record& a, const Record& b)
      { return a.Sweep == b.Sweep && a.Slice.HasGeometryOf(b.Slice); });
  // grown for the first time, grown again, or made of the same slices in another way
  const bool isKept = isGrowing || (isContinued && (before < records.size() || this->IsKept));
  const bool isReused = this->Volume && this->IsKept && isContinued && AreEqual(grid, this->Grid) &&
    extent == this->Extent && Tie(options) == Tie(this->Options);
  try
  {
    execution.SetStage(first, middle);
    std::size_t done = 0;
    if (isReused && this->HasPixelsOf(slices, execution))
    {
      done = before;
      std::copy(this->Records.begin(), this->Records.end(), records.begin());
    }
    else
    {
      this->Volume.reset(); // not two at a time
      this->Volume = std::make_unique<SweptVolume>(grid, extent, options);
    }
    this->Added = static_cast<std::int64_t>(records.size() - done);

    std::size_t begin = 0; // of the sweep
    const auto total = static_cast<double>(std::max<std::size_t>(1, records.size() - done));
    for (std::size_t s = 0; s < sweeps.size(); ++s)
    {
      const std::size_t end = begin + sweeps[s]->size();
      const std::size_t next = std::max(begin, done);
      if (next < end)
      {
        if (next == begin)
        {
          this->Volume->BeginSweep();
        }
        const std::vector<SliceImage> added(
          sweeps[s]->begin() + static_cast<std::ptrdiff_t>(next - begin), sweeps[s]->end());
        this->Volume->AddSlices(added, execution,
          middle + (last - middle) * static_cast<double>(next - done) / total,
          middle + (last - middle) * static_cast<double>(end - done) / total);
      }
      begin = end;
    }
    if (isKept && done < records.size())
    {
      execution.SetStage(last, last);
      execution.For(static_cast<std::int64_t>(records.size() - done), 1,
        [&](std::int64_t from, std::int64_t to)
        {
          for (std::int64_t n = from; n < to; ++n)
          {
            const std::size_t i = done + static_cast<std::size_t>(n);
            records[i].Slice.Pixels = HashPixels(*slices[i]);
          }
        });
    }
  }
  catch (...)
  {
    this->Volume.reset();
    this->Records.clear();
    this->IsKept = false;
    throw;
  }
  this->Records = std::move(records);
  this->IsKept = isKept;
  this->Grid = grid;
  this->Extent = extent;
  this->Options = options;
  return *this->Volume;
}

double GrowingVolume::GetBytes() const
{
  double bytes =
    this->Volume ? static_cast<double>(SweptVolume::GetBytesPerVoxel(this->Options)) : 0;
  for (std::size_t a = 0; a < 3; ++a)
  {
    bytes *= std::max(0.0, 1.0 + this->Extent[2 * a + 1] - this->Extent[2 * a]);
  }
  return bytes;
}

//------------------------------------------------------------------------------
void GrowingVolume::Finish()
{
  if (!this->IsKept)
  {
    this->Volume.reset();
  }
}
}
