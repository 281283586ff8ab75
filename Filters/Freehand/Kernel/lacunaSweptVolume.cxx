// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSweptVolume.h"

#include "lacunaPixelPlacing.h"
#include "lacunaSlicePair.h"
#include "lacunaVoxelFilling.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <type_traits>

namespace lacuna
{
namespace
{
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
  if (!(options.FootprintScale > 0) || !std::isfinite(options.FootprintScale))
  {
    throw std::invalid_argument("the footprint's scale must be positive");
  }
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
}
